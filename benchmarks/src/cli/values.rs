//! Values that several commands take, and what they are when nobody says.

use gearbench_reports::Metric;

/// The scene that is compared when none is named.
pub const DEFAULT_SCENE: &str = "spur_impact";
/// Timed repeats when the command line does not say.
pub const DEFAULT_REPEATS: u32 = 3;

/// Wall-clock bound of one integration [s] when the command line does not say.
pub const DEFAULT_TIMEOUT: f64 = 120.0;

/// A positive number of seconds.
pub fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if x > 0.0 && x <= 1e6 => Ok(x),
        _ => Err("expected a positive number of seconds".into()),
    }
}

/// Load over the width [N/mm] when the command line does not say.
pub const DEFAULT_LOAD: f64 = 300.0;
/// Positions over a base pitch when the command line does not say.
pub const DEFAULT_POSITIONS: usize = 24;

/// A positive number.
pub fn positive_load(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if x > 0.0 && x <= 1e9 => Ok(x),
        _ => Err("expected a positive number".into()),
    }
}

/// Positions over a base pitch.
pub fn positions(text: &str) -> Result<usize, String> {
    match text.parse::<usize>() {
        Ok(n) if (2..=2000).contains(&n) => Ok(n),
        _ => Err("expected a whole number from 2 to 2000".into()),
    }
}

/// A relative error, by its name on the command line or by its key in records.
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
