//! Names of metrics on the command line and in scenes.

/// Metrics that are errors: name on the command line, key in the record.
pub const METRICS: [(&str, &str); 7] = [
    ("force", "force_l2"),
    ("force-aligned", "force_l2_aligned"),
    ("peak", "peak_force_rel"),
    ("impulse", "impulse_rel"),
    ("rebound", "rebound_rel"),
    ("transmission-error", "transmission_error_l2"),
    ("energy", "energy_drift_rel"),
];

/// Keys of the metrics named between commas, by name or by key, each once.
///
/// # Errors
/// A sentence that lists the names there are.
pub fn metric_keys(text: &str) -> Result<Vec<String>, String> {
    let mut keys: Vec<String> = Vec::new();
    for name in text.split(',').map(str::trim).filter(|n| !n.is_empty()) {
        let found = METRICS.iter().find(|(n, k)| [*n, *k].contains(&name));
        match found {
            Some((_, key)) if keys.iter().any(|k| k == key) => {}
            Some((_, key)) => keys.push((*key).to_owned()),
            None => return Err(format!("there is no metric `{name}`; {}", known())),
        }
    }
    if keys.is_empty() {
        return Err(format!("no metric is named; {}", known()));
    }
    Ok(keys)
}

fn known() -> String {
    let names: Vec<&str> = METRICS.iter().map(|(n, _)| *n).collect();
    format!("there are {}", names.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_keys() {
        assert_eq!(
            metric_keys("force-aligned, peak,force_l2_aligned,energy_drift_rel").unwrap(),
            ["force_l2_aligned", "peak_force_rel", "energy_drift_rel"]
        );
        assert!(metric_keys("farce").unwrap_err().contains("force-aligned"));
        assert!(metric_keys(" ,").unwrap_err().contains("no metric"));
    }
}
