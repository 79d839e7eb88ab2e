//! Units of columns: notations in headers, and the factors to SI.
//!
//! A unit stands in brackets at the end of a header, `Fn [kN]` or `t (ms)`, after a slash, `t / ms` (DIN 1313), or as the
//! ending of gearbench's own columns, `omega1_rad_s`.

use std::f64::consts::{PI, TAU};

/// Physical dimension of a column.
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
    Frequency,
    Stiffness,
}

impl Dimension {
    /// Dimensions of histories.
    pub const OF_HISTORIES: [Dimension; 7] = [
        Dimension::Time,
        Dimension::Force,
        Dimension::Torque,
        Dimension::Length,
        Dimension::Angle,
        Dimension::Turning,
        Dimension::Velocity,
    ];
    /// Dimensions of all columns of tables.
    const ALL: [Dimension; 9] = [
        Dimension::Time,
        Dimension::Force,
        Dimension::Torque,
        Dimension::Length,
        Dimension::Angle,
        Dimension::Turning,
        Dimension::Velocity,
        Dimension::Frequency,
        Dimension::Stiffness,
    ];
}

/// Units with their factors to SI, the SI unit first; then the notations of name endings.
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
        Dimension::Frequency => (&[("Hz", 1.0), ("kHz", 1e3)], &[("_khz", 1e3), ("_hz", 1.0)]),
        Dimension::Stiffness => (
            &[("N/m", 1.0), ("N/mm", 1e3), ("N/um", 1e6)],
            &[("_n_per_um", 1e6), ("_n_per_mm", 1e3), ("_n_per_m", 1.0)],
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

/// Returns the longest ending of a name that is a unit of one of some dimensions: the name before it, the ending
/// without its underscore, the factor, and the dimension.
pub(super) fn longest_ending<'n>(
    name: &'n str,
    among: &[Dimension],
) -> Option<(&'n str, &'n str, f64, Dimension)> {
    let found = among.iter().filter_map(|&d| {
        let (stem, ending, factor) = ending(name, d)?;
        Some((stem, ending, factor, d))
    });
    found.max_by_key(|(_, ending, ..)| ending.len())
}

/// Units of ratios.
const OF_RATIOS: [&str; 2] = ["-", "1"];

/// All units, in a line.
pub(super) fn all() -> String {
    let of_dimensions = Dimension::ALL.map(known).join(", ");
    format!("{of_dimensions}, {}", OF_RATIOS.join(", "))
}

/// A heading as a name in SI units, whose ending is the unit, and the factor to it.
///
/// # Errors
/// The unit in the heading, where it is not known.
pub(super) fn in_si(heading: &str) -> Result<(String, f64), String> {
    let (name, unit) = split(heading);
    let si = |dimension: Dimension| {
        let endings = row(dimension).1.iter();
        let mut of_si = endings.filter(|(_, factor)| *factor == 1.0);
        of_si.next().map_or("", |(ending, _)| *ending)
    };
    let Some(unit) = unit else {
        return Ok(match longest_ending(name, &Dimension::ALL) {
            Some((stem, _, factor, d)) if factor != 1.0 => (format!("{stem}{}", si(d)), factor),
            _ => (name.to_owned(), 1.0),
        });
    };
    let stem = name.replace(' ', "_");
    if OF_RATIOS.contains(&unit) {
        return Ok((stem, 1.0));
    }
    let mut known = Dimension::ALL
        .iter()
        .filter_map(|&d| Some((d, factor(unit, d)?)));
    match known.next() {
        Some((d, factor)) => Ok((format!("{stem}{}", si(d)), factor)),
        None => Err(unit.to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headings_are_columns_of_the_study_in_si_units() {
        for (heading, name, factor) in [
            ("mesh_frequency_hz", "mesh_frequency_hz", 1.0),
            ("mesh_frequency [kHz]", "mesh_frequency_hz", 1e3),
            (
                "transmission error rms (µm)",
                "transmission_error_rms_m",
                1e-6,
            ),
            (
                "transmission_error_rms_um",
                "transmission_error_rms_m",
                1e-6,
            ),
            ("position_base_pitches", "position_base_pitches", 1.0),
            ("speed [1/min]", "speed_rad_s", PI / 30.0),
            ("secant [N/um]", "secant_n_per_m", 1e6),
            ("omega1_rad_s", "omega1_rad_s", 1.0),
        ] {
            assert_eq!(in_si(heading), Ok((name.to_owned(), factor)), "{heading}");
        }
        assert_eq!(in_si("speed [furlong]"), Err("furlong".into()));
        // The unit of SI of every dimension is that of its factor, and no unit is of two.
        for d in Dimension::ALL {
            assert_eq!(row(d).0[0].1, 1.0);
            assert!(row(d).1.iter().any(|(_, factor)| *factor == 1.0));
            for (unit, _) in row(d).0 {
                let of = Dimension::ALL
                    .iter()
                    .filter(|&&d| factor(unit, d).is_some());
                assert_eq!(of.count(), 1, "{unit}");
            }
        }
    }

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
