//! Processor time of the calling thread: the measure of every bound of time and of every cost, which other work on the
//! machine does not change.

use std::time::Duration;

/// Returns the processor time of the calling thread so far, or `None` where the operating system does not report it.
#[cfg(unix)]
#[must_use]
pub fn processor_time() -> Option<Duration> {
    duration(rustix::time::ClockId::ThreadCPUTime)
}

/// Returns the processor time of all threads of this process so far, including set-up on several threads, or `None`
/// where the operating system does not report it.
#[cfg(unix)]
#[must_use]
pub fn processor_time_of_all_threads() -> Option<Duration> {
    duration(rustix::time::ClockId::ProcessCPUTime)
}

#[cfg(unix)]
fn duration(clock: rustix::time::ClockId) -> Option<Duration> {
    let spent = rustix::time::clock_gettime(clock);
    let seconds = u64::try_from(spent.tv_sec).ok()?;
    Some(Duration::new(seconds, u32::try_from(spent.tv_nsec).ok()?))
}

/// Returns `None`: this operating system does not report processor time.
#[cfg(not(unix))]
#[must_use]
pub fn processor_time() -> Option<Duration> {
    None
}

/// Returns `None`: this operating system does not report processor time.
#[cfg(not(unix))]
#[must_use]
pub fn processor_time_of_all_threads() -> Option<Duration> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_takes_processor_time_and_waiting_takes_none() {
        let (Some(start), Some(all)) = (processor_time(), processor_time_of_all_threads()) else {
            return;
        };
        std::thread::sleep(Duration::from_millis(40));
        let waited = processor_time().unwrap_or(start) - start;
        assert!(waited < Duration::from_millis(20), "{waited:?}");
        let mut x = 0.5_f64;
        while processor_time().unwrap_or(Duration::MAX) - start < Duration::from_millis(10) {
            x = std::hint::black_box((x + 1.0).sin());
        }
        let spent = processor_time_of_all_threads().unwrap_or(all) - all;
        assert!(
            x.is_finite() && spent >= Duration::from_millis(10),
            "{spent:?}"
        );
    }
}
