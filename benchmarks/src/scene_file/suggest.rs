//! "Did you mean": nearest known word, and keys whose unit is not the one of the scene format.

/// Units that people write, what the format takes instead, and the factor between them.
const UNITS: &[(&str, &str, f64)] = &[
    ("mm", "m", 1e-3),
    ("um", "m", 1e-6),
    ("cm", "m", 1e-2),
    ("in", "m", 0.0254),
    ("rad", "deg", 180.0 / std::f64::consts::PI),
    ("rpm", "rad_s", std::f64::consts::PI / 30.0),
    ("deg_s", "rad_s", std::f64::consts::PI / 180.0),
    ("mm_s", "m_s", 1e-3),
    ("ms", "s", 1e-3),
    ("us", "s", 1e-6),
    ("ns", "s", 1e-9),
    ("nmm", "nm", 1e-3),
    ("knm", "nm", 1e3),
    ("kn", "n", 1e3),
    ("g", "kg", 1e-3),
    ("gmm2", "kgm2", 1e-9),
    ("kgmm2", "kgm2", 1e-6),
    ("gcm2", "kgm2", 1e-7),
    ("kg_m2", "kgm2", 1.0),
    ("gpa", "pa", 1e9),
    ("mpa", "pa", 1e6),
    ("g_cm3", "kg_m3", 1e3),
    ("kgm3", "kg_m3", 1.0),
    ("n_per_mm", "n_per_m", 1e3),
    ("n_per_um", "n_per_m", 1e6),
    ("n_m", "n_per_m", 1.0),
    ("n_per_mm2", "n_per_m2", 1e6),
    ("n_per_mm_um", "n_per_m2", 1e9),
    ("ns_per_mm", "ns_per_m", 1e3),
    ("nm_per_rad_s", "nms_per_rad", 1.0),
];

/// Known key for an unknown one that differs in its unit only, with the factor to the known unit.
pub(super) fn other_unit<'k>(unknown: &str, known: &[&'k str]) -> Option<(&'k str, f64)> {
    for &key in known {
        for (from, to, factor) in UNITS {
            let stem = unknown.strip_suffix(from).and_then(|s| s.strip_suffix('_'));
            let known_stem = key.strip_suffix(to).and_then(|s| s.strip_suffix('_'));
            if stem.is_some() && stem == known_stem {
                return Some((key, *factor));
            }
        }
    }
    None
}

/// Known key for an unknown one that lacks the unit: `module` for `module_m`.
pub(super) fn without_unit<'k>(unknown: &str, known: &[&'k str]) -> Option<&'k str> {
    let mut found = known.iter().filter(|k| {
        k.strip_prefix(unknown).is_some_and(|rest| {
            rest.strip_prefix('_')
                .is_some_and(|unit| UNITS.iter().any(|(_, to, _)| unit == *to) || unit == "deg")
        })
    });
    match (found.next(), found.next()) {
        (Some(key), None) => Some(key),
        _ => None,
    }
}

/// The known word that is nearest to an unknown one, if any is near.
pub(super) fn nearest<'k>(unknown: &str, known: &[&'k str]) -> Option<&'k str> {
    known
        .iter()
        .map(|&k| (distance(&unknown.to_lowercase(), &k.to_lowercase()), k))
        .filter(|(d, k)| *d <= (k.len().max(unknown.len()) / 3).max(1))
        .min_by_key(|(d, _)| *d)
        .map(|(_, k)| k)
}

/// Restricted Damerau-Levenshtein distance (F. J. Damerau, Comm. ACM 7 (1964) 171-176); words longer
/// than any key count as far away.
fn distance(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) =
        (a.chars().take(64).collect(), b.chars().take(64).collect());
    let mut before: Vec<usize> = Vec::new();
    let mut last: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut row = vec![i; b.len() + 1];
        for j in 1..=b.len() {
            let change = usize::from(a[i - 1] != b[j - 1]);
            row[j] = (last[j] + 1).min(row[j - 1] + 1).min(last[j - 1] + change);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                row[j] = row[j].min(before[j - 2] + 1);
            }
        }
        before = std::mem::replace(&mut last, row);
    }
    last[b.len()]
}

/// Words in a sentence: `a`, `b` or `c`.
pub(super) fn words(known: &[&str]) -> String {
    match known {
        [] => "nothing".into(),
        [one] => format!("`{one}`"),
        [most @ .., last] => {
            let most: Vec<String> = most.iter().map(|k| format!("`{k}`")).collect();
            format!("{} or `{last}`", most.join(", "))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances() {
        assert_eq!(distance("teeth", "teeth"), 0);
        assert_eq!(distance("teht", "teeth"), 2);
        assert_eq!(distance("mesh", "mehs"), 1);
        assert_eq!(distance("", "abc"), 3);
    }

    #[test]
    fn suggestions() {
        let known = [
            "module_m",
            "speed_rad_s",
            "teeth",
            "inertia_kgm2",
            "pressure_angle_deg",
        ];
        assert_eq!(other_unit("module_mm", &known), Some(("module_m", 1e-3)));
        assert_eq!(other_unit("speed_rpm", &known).unwrap().0, "speed_rad_s");
        assert_eq!(
            other_unit("pressure_angle_rad", &known).unwrap().0,
            "pressure_angle_deg"
        );
        assert_eq!(other_unit("teeth", &known), None);
        assert_eq!(without_unit("module", &known), Some("module_m"));
        assert_eq!(without_unit("speed", &known), Some("speed_rad_s"));
        assert_eq!(nearest("tetth", &known), Some("teeth"));
        assert_eq!(nearest("colour", &known), None);
        assert_eq!(words(&["a", "b", "c"]), "`a`, `b` or `c`");
    }
}
