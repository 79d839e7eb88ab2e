//! What a record says of where and when it was made.

use gearbench_reports::record::Machine;
use std::time::{SystemTime, UNIX_EPOCH};

/// Commit of gearbench at build time; `+` marks a tree with changes.
pub const COMMIT: &str = env!("GEARBENCH_COMMIT");

/// The computer.
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

/// Time that this thread has spent on a processor [s], where the system tells it: other work on the machine does not
/// count. It advances in ticks of some milliseconds.
pub fn cpu_time() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds: u64 = text.split_whitespace().next()?.parse().ok()?;
    Some(1e-9 * nanoseconds as f64)
}

/// Now, in UTC, as RFC 3339 to the second.
pub fn now() -> String {
    let seconds = SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .map_or(0, |d| d.as_secs());
    rfc3339(seconds)
}

/// Civil date of a Unix time (days since 1 March 0000 make leap days fall at the end of a year).
fn rfc3339(seconds: u64) -> String {
    let (days, rest) = (seconds / 86_400, seconds % 86_400);
    let z = days + 719_468;
    let era = z / 146_097;
    let day_of_era = z % 146_097;
    let year_of_era =
        (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let m = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * m + 2) / 5 + 1;
    let month = if m < 10 { m + 3 } else { m - 9 };
    let year = year_of_era + era * 400 + u64::from(month <= 2);
    let (h, min, s) = (rest / 3600, rest / 60 % 60, rest % 60);
    format!("{year:04}-{month:02}-{day:02}T{h:02}:{min:02}:{s:02}Z")
}

#[cfg(test)]
mod tests {
    use super::{cpu_time, rfc3339};

    #[test]
    fn work_takes_processor_time() {
        let Some(start) = cpu_time() else { return };
        let begin = std::time::Instant::now();
        let mut x = 0.5_f64;
        while begin.elapsed().as_secs_f64() < 0.05 {
            x = std::hint::black_box((x + 1.0).sin());
        }
        let spent = cpu_time().unwrap_or(start) - start;
        assert!(x.is_finite() && spent > 0.0 && spent < 0.5, "{spent} s");
    }

    #[test]
    fn dates() {
        assert_eq!(rfc3339(0), "1970-01-01T00:00:00Z");
        assert_eq!(rfc3339(951_782_400), "2000-02-29T00:00:00Z");
        assert_eq!(rfc3339(4_102_444_799), "2099-12-31T23:59:59Z");
    }
}
