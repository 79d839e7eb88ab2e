//! Units of columns: what headers write, and the factor to SI.
//!
//! A unit stands in brackets at the end of a header, `Fn [kN]` or `t (ms)`, after a slash, `t / ms` (DIN 1313), or as the
//! ending of gearbench's own columns, `omega1_rad_s`.

use std::f64::consts::{PI, TAU};

/// What a column is measured in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "the variants are the quantities")]
pub enum Dimension {
    Time,
    Force,
    Torque,
    Length,
    Angle,
    Turning,
    Velocity,
}

/// Units with their factors to SI, the unit of SI first; then what endings of names are written like.
type Row = (
    &'static [(&'static str, f64)],
    &'static [(&'static str, f64)],
);

fn row(dimension: Dimension) -> Row {
    match dimension {
        Dimension::Time => (
            &[
                ("s", 1.0),
                ("ms", 1e-3),
                ("us", 1e-6),
                ("ns", 1e-9),
                ("sec", 1.0),
                ("min", 60.0),
            ],
            &[("_ms", 1e-3), ("_us", 1e-6), ("_ns", 1e-9), ("_s", 1.0)],
        ),
        Dimension::Force => (
            &[
                ("N", 1.0),
                ("kN", 1e3),
                ("MN", 1e6),
                ("mN", 1e-3),
                ("daN", 10.0),
            ],
            &[("_kn", 1e3), ("_n", 1.0)],
        ),
        Dimension::Torque => (
            &[
                ("Nm", 1.0),
                ("kNm", 1e3),
                ("Nmm", 1e-3),
                ("mNm", 1e-3),
                ("MNm", 1e6),
                ("Ncm", 1e-2),
            ],
            &[("_knm", 1e3), ("_nmm", 1e-3), ("_nm", 1.0)],
        ),
        Dimension::Length => (
            &[
                ("m", 1.0),
                ("mm", 1e-3),
                ("um", 1e-6),
                ("cm", 1e-2),
                ("nm", 1e-9),
            ],
            &[("_mm", 1e-3), ("_um", 1e-6), ("_m", 1.0)],
        ),
        Dimension::Angle => (
            &[
                ("rad", 1.0),
                ("mrad", 1e-3),
                ("urad", 1e-6),
                ("deg", PI / 180.0),
                ("°", PI / 180.0),
                ("arcmin", PI / 10_800.0),
                ("arcsec", PI / 648_000.0),
                ("rev", TAU),
            ],
            &[
                ("_mrad", 1e-3),
                ("_urad", 1e-6),
                ("_rad", 1.0),
                ("_deg", PI / 180.0),
                ("_arcmin", PI / 10_800.0),
                ("_arcsec", PI / 648_000.0),
            ],
        ),
        Dimension::Turning => (
            &[
                ("rad/s", 1.0),
                ("1/min", PI / 30.0),
                ("rpm", PI / 30.0),
                ("min^-1", PI / 30.0),
                ("min-1", PI / 30.0),
                ("U/min", PI / 30.0),
                ("rev/min", PI / 30.0),
                ("rev/s", TAU),
                ("deg/s", PI / 180.0),
                ("°/s", PI / 180.0),
                ("mrad/s", 1e-3),
            ],
            &[("_rad_s", 1.0), ("_deg_s", PI / 180.0), ("_rpm", PI / 30.0)],
        ),
        Dimension::Velocity => (
            &[("m/s", 1.0), ("mm/s", 1e-3), ("km/h", 1.0 / 3.6)],
            &[("_mm_s", 1e-3), ("_m_s", 1.0)],
        ),
    }
}

/// The factor from a unit to SI; `None` where the quantity is not measured in it.
pub fn factor(unit: &str, dimension: Dimension) -> Option<f64> {
    let plain: String = (unit.chars())
        .filter(|c| !c.is_whitespace() && !['·', '*', '.', '\u{22c5}'].contains(c))
        .map(|c| if ['µ', 'μ'].contains(&c) { 'u' } else { c })
        .collect();
    // A dash joins newton and metre as well, but is the sign of an exponent elsewhere.
    let joined = plain.replace('-', "");
    let same = |known: &&(&str, f64)| {
        known.0 == plain || (dimension == Dimension::Torque && known.0 == joined)
    };
    row(dimension).0.iter().find(same).map(|(_, f)| *f)
}

/// The units that a quantity may have, in a line.
pub(super) fn known(dimension: Dimension) -> String {
    let names: Vec<&str> = row(dimension).0.iter().map(|(name, _)| *name).collect();
    names.join(", ")
}

/// A header without its unit in brackets or after a slash, and that unit.
pub(super) fn split(header: &str) -> (&str, Option<&str>) {
    let header = header.trim();
    for (open, close) in [('[', ']'), ('(', ')')] {
        if let Some(inner) = header.strip_suffix(close)
            && let Some((name, unit)) = inner.rsplit_once(open)
            && !name.trim().is_empty()
        {
            return (name.trim(), Some(unit.trim()));
        }
    }
    match header.rsplit_once(" / ") {
        Some((name, unit)) if !name.trim().is_empty() => (name.trim(), Some(unit.trim())),
        _ => (header, None),
    }
}

/// The ending of a name that is a unit: the name before it, the ending without its line, and the factor.
pub(super) fn ending(name: &str, dimension: Dimension) -> Option<(&str, &str, f64)> {
    row(dimension).1.iter().find_map(|(ending, factor)| {
        let start = name.len().checked_sub(ending.len())?;
        let (stem, found) = (name.get(..start)?, name.get(start..)?);
        let same = found.eq_ignore_ascii_case(ending) && !stem.is_empty();
        same.then(|| (stem, &found[1..], *factor))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_of_headers() {
        assert_eq!(split("Fn [kN]"), ("Fn", Some("kN")));
        assert_eq!(split(" t (ms) "), ("t", Some("ms")));
        assert_eq!(split("n1 / 1/min"), ("n1", Some("1/min")));
        assert_eq!(split("[kN]"), ("[kN]", None));
        assert_eq!(split("omega1_rad_s"), ("omega1_rad_s", None));
        let holds = |unit, dimension, wanted: Option<f64>| {
            assert_eq!(factor(unit, dimension), wanted, "{unit}");
        };
        holds("1/min", Dimension::Turning, Some(PI / 30.0));
        holds("µs", Dimension::Time, Some(1e-6));
        holds("N m", Dimension::Torque, Some(1.0));
        holds("N·mm", Dimension::Torque, Some(1e-3));
        holds("N-m", Dimension::Torque, Some(1.0));
        holds("mN", Dimension::Force, Some(1e-3));
        holds("MN", Dimension::Force, Some(1e6));
        holds("kg", Dimension::Force, None);
        holds("1/s", Dimension::Turning, None);
        holds("arcsec", Dimension::Angle, Some(PI / 648_000.0));
        let found = ending("omega1_rad_s", Dimension::Turning);
        assert_eq!(found, Some(("omega1", "rad_s", 1.0)));
        assert_eq!(
            ending("torque_a_nm", Dimension::Torque).map(|e| e.2),
            Some(1.0)
        );
        assert_eq!(ending("_s", Dimension::Time), None);
        assert_eq!(ending("zeitµ", Dimension::Time), None);
    }
}
