//! Units of REXS as factors to SI. Versions until 1.3 write degrees as `°`; some files leave the unit of numbers without one
//! empty.

/// Quantity and factor to SI of a unit.
fn unit(text: &str) -> Option<(&'static str, f64)> {
    let text = text.trim();
    Some(match text {
        "" | "none" => ("", 1.0),
        "%" => ("", 0.01),
        "deg" | "\u{b0}" => ("angle", std::f64::consts::PI / 180.0),
        "rad" => ("angle", 1.0),
        "m" => ("length", 1.0),
        "mm" => ("length", 1e-3),
        "mum" | "\u{b5}m" | "\u{3bc}m" => ("length", 1e-6),
        "1 / min" => ("speed", std::f64::consts::PI / 30.0),
        "rad / s" => ("speed", 1.0),
        "N m" => ("torque", 1.0),
        "N mm" => ("torque", 1e-3),
        "kN m" => ("torque", 1e3),
        "N" => ("force", 1.0),
        "kN" => ("force", 1e3),
        "N / m" => ("stiffness", 1.0),
        "N / mm" => ("stiffness", 1e3),
        "N / rad" => ("force", 1.0),
        "N mm / rad" => ("tilting stiffness", 1e-3),
        "N m / rad" => ("tilting stiffness", 1.0),
        "N / (mm mum)" => ("stiffness over width", 1e9),
        "MPa" | "N / mm^2" => ("pressure", 1e6),
        "GPa" => ("pressure", 1e9),
        "Pa" => ("pressure", 1.0),
        "kg / dm^3" => ("density", 1e3),
        "kg / m^3" => ("density", 1.0),
        _ => return None,
    })
}

/// Factor from a unit of a file to SI, if it is one of the quantity that `expected` measures.
pub fn factor(given: &str, expected: &str) -> Option<f64> {
    let (quantity, _) = unit(expected)?;
    let (found, factor) = unit(given)?;
    (found == quantity).then_some(factor)
}

#[cfg(test)]
mod tests {
    use super::factor;
    use crate::rexs::attributes::{ALL, OPERATING_STIFFNESS};

    #[test]
    fn units_are_those_of_their_quantity() {
        assert_eq!(factor("N / mm^2", "MPa"), Some(1e6));
        assert_eq!(factor("\u{b0}", "deg"), factor("deg", "deg"));
        assert_eq!(factor("", "none"), Some(1.0));
        assert_eq!(factor("mm", "deg"), None);
        assert_eq!(factor("furlong", "mm"), None);
        for attribute in ALL
            .iter()
            .copied()
            .chain(OPERATING_STIFFNESS.iter().flatten())
        {
            let own = factor(attribute.unit, attribute.unit);
            assert!(own.is_some(), "{:?}", attribute.names);
        }
    }
}
