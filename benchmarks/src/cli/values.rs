//! Parsers and default values of options that several commands share.

use gearbench_integrators::scheme::seconds;
use gearbench_reports::Metric;

/// The scene of a comparison without scene argument.
pub const DEFAULT_SCENE: &str = "spur_impact";
/// Default number of timed repeats.
pub const DEFAULT_REPEATS: u32 = 3;

/// Default bound on the processor time of one integration [s].
pub const DEFAULT_TIMEOUT: f64 = 30.0;
/// Default budget of processor time of a study [s].
pub const DEFAULT_BUDGET: f64 = 600.0;
/// Default bound on the memory of a command [GB].
pub const DEFAULT_MEMORY: f64 = 2.0;

/// Parses a number that fulfils a condition.
pub fn number(text: &str, holds: impl Fn(&f64) -> bool, expected: &str) -> Result<f64, String> {
    let x = text.trim().parse().ok();
    x.filter(holds).ok_or_else(|| expected.to_owned())
}

/// Parses a positive number of seconds.
pub fn positive(text: &str) -> Result<f64, String> {
    let holds = |x: &f64| *x > 0.0 && *x <= 1e6;
    number(
        text,
        holds,
        "expected a positive number of seconds, at most 1e6",
    )
}

/// Parses a positive time with a unit, or in seconds.
pub fn time(text: &str) -> Result<f64, String> {
    let value = text.trim().parse().ok().or_else(|| seconds(text));
    match value {
        Some(x) if x > 0.0 && x < 1e3 => Ok(x),
        _ => Err("expected a positive time, for example 500ns, 1us or 1e-6 (seconds)".into()),
    }
}

/// Parses a positive number of gigabytes.
pub fn gigabytes(text: &str) -> Result<f64, String> {
    let holds = |x: &f64| *x > 0.0 && *x <= 1e6;
    number(text, holds, "expected a positive number of gigabytes")
}

/// Default load per face width [N/mm].
pub const DEFAULT_LOAD: f64 = 300.0;
/// Parses a torque that loads a pair of gears [N m]. Either sign loads the flank in contact at the start.
pub fn torque(text: &str) -> Result<f64, String> {
    let holds = |x: &f64| *x != 0.0 && x.abs() <= 1e9;
    number(
        text,
        holds,
        "expected a number of N m other than zero, at most 1e9",
    )
}

/// Default number of positions over a base pitch.
pub const DEFAULT_POSITIONS: usize = 24;

/// Parses a positive load of at most 1e9, in the unit of its option.
pub fn positive_load(text: &str) -> Result<f64, String> {
    let holds = |x: &f64| *x > 0.0 && *x <= 1e9;
    number(text, holds, "expected a positive number, at most 1e9")
}

/// Parses a number of positions over a base pitch.
pub fn positions(text: &str) -> Result<usize, String> {
    let n = text.parse().ok().filter(|n| (2..=2000).contains(n));
    n.ok_or_else(|| "expected a whole number from 2 to 2000".into())
}

/// Parses a metric by its name on the command line or its key in records.
pub fn metric(text: &str) -> Result<Metric, String> {
    let found = text.trim().parse::<Metric>().ok();
    found.filter(|m| m.is_error()).ok_or_else(|| {
        let names: Vec<&str> = Metric::ALL.into_iter().filter_map(Metric::option).collect();
        format!(
            "there is no metric `{text}`; there are {}",
            names.join(", ")
        )
    })
}

/// Parses a frequency [Hz].
pub fn frequency(text: &str) -> Result<f64, String> {
    number(
        text,
        |x| *x > 0.0 && x.is_finite(),
        "expected a positive number of Hz, for example 5000",
    )
}
