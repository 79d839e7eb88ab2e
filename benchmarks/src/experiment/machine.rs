//! Computer, program and time of a record.

pub use super::checkout::commit_of_checkout;
use gearbench_integrators::clock::processor_time;
use gearbench_reports::record::{Machine, StudyHeader};
use std::sync::OnceLock;
use std::time::Instant;

/// Commit of the program that runs. Its entry point knows it: were it part of this library, every commit would compile
/// the library and all that depends on it again.
static COMMIT: OnceLock<String> = OnceLock::new();

/// Sets the commit of the program, once; `+` at its end marks a tree with changes.
pub fn set_commit(commit: impl Into<String>) {
    let _ = COMMIT.set(commit.into());
}

/// Commit of the program; `unknown` before an entry point has set it.
pub fn commit() -> &'static str {
    COMMIT.get().map_or("unknown", String::as_str)
}

/// The header of a record that is made by this program on this computer now.
pub fn header(scene: &str, title: &str, command: &str) -> StudyHeader {
    StudyHeader {
        scene: scene.into(),
        title: title.into(),
        command: command.into(),
        machine: machine(),
        commit: commit().into(),
        created: now(),
        ..StudyHeader::default()
    }
}

/// Processor, operating system and program of this computer.
pub fn machine() -> Machine {
    let cpuinfo = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let cpu = cpuinfo
        .lines()
        .find_map(|l| l.strip_prefix("model name"))
        .and_then(|l| l.split_once(':'))
        .map_or_else(
            || "unknown".to_string(),
            |(_, name)| name.trim().to_string(),
        );
    Machine {
        cpu,
        cores: std::thread::available_parallelism().map_or(1, usize::from),
        os: std::env::consts::OS.to_string(),
        arch: Some(std::env::consts::ARCH.to_string()),
        profile: Some(
            if cfg!(debug_assertions) {
                "debug"
            } else {
                "release"
            }
            .to_string(),
        ),
        note: None,
    }
}

/// Processor time of this thread [s], where the system reports it ([`processor_time`]).
pub fn cpu_time() -> Option<f64> {
    processor_time().map(|t| t.as_secs_f64())
}

/// Does some work and measures its processor time [s]; its wall time where the system does not report that of a thread.
pub fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let (wall, start) = (Instant::now(), cpu_time());
    let done = work();
    let spent = match (start, cpu_time()) {
        (Some(from), Some(now)) => now - from,
        _ => wall.elapsed().as_secs_f64(),
    };
    (done, spent)
}

/// The present time in UTC, as RFC 3339 to the second.
pub fn now() -> String {
    let now = jiff::Timestamp::now();
    now.round(jiff::Unit::Second).unwrap_or(now).to_string()
}

#[cfg(test)]
mod tests {
    use super::now;

    /// The date has the form of existing records, `2026-11-22T10:09:15Z`.
    #[test]
    fn dates() {
        let now = now();
        assert!(now.len() == 20 && now.ends_with('Z'), "{now}");
        assert!(now.parse::<jiff::Timestamp>().is_ok(), "{now}");
    }
}
