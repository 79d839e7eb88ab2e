//! Names of metrics on the command line.

use gearbench_reports::Metric;

/// Metrics named between commas, by name or by key, each once.
///
/// # Errors
/// A sentence that lists the names there are.
pub fn metrics_of(text: &str) -> Result<Vec<Metric>, String> {
    let mut found: Vec<Metric> = Vec::new();
    for name in text.split(',').map(str::trim).filter(|n| !n.is_empty()) {
        match name.parse::<Metric>().ok().filter(|m| m.is_error()) {
            Some(metric) if found.contains(&metric) => {}
            Some(metric) => found.push(metric),
            None => return Err(format!("there is no metric `{name}`; {}", known())),
        }
    }
    if found.is_empty() {
        return Err(format!("no metric is named; {}", known()));
    }
    Ok(found)
}

fn known() -> String {
    let names: Vec<&str> = Metric::ALL.into_iter().filter_map(Metric::option).collect();
    format!("there are {}", names.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_keys() {
        assert_eq!(
            metrics_of("force-aligned, peak,force_l2_aligned,energy_drift_rel").unwrap(),
            [
                Metric::ForceL2Aligned,
                Metric::PeakForceRel,
                Metric::EnergyDrift
            ]
        );
        assert!(metrics_of("farce").unwrap_err().contains("force-aligned"));
        assert!(metrics_of(" ,").unwrap_err().contains("no metric"));
    }
}
