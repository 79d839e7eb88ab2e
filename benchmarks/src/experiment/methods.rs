//! Integrators as the command line names them.

use super::run::Method;
use gearbench_integrators::{METHODS, Resolution};

/// Integrators asked for on the command line: `id`, `id(name=value)`, each optionally followed by `@` and a step with
/// its unit (`500ns`, `1us`, `2e-7s`) or a bare number, which is a step in seconds for methods of fixed steps and a
/// tolerance for adaptive ones. Without `@` the scene's own resolution for that method is taken, or that of its
/// nearest kin.
pub fn methods_from(text: &str, scene: &[Method]) -> Result<Vec<Method>, String> {
    let mut found = Vec::new();
    for part in split_outside_brackets(text) {
        let (name, resolution) = match part.split_once('@') {
            Some((name, value)) => {
                let x = Value::parse(value)
                    .ok_or_else(|| format!("`{part}`: `{value}` after @ is not a number"))?;
                (name.trim(), Some(x))
            }
            None => (part, None),
        };
        let (row, _) = gearbench_integrators::method(name)?;
        let adaptive = |r: &Resolution| matches!(r, Resolution::Tolerance(_));
        use gearbench_integrators::Stepping;
        let resolution = match resolution {
            Some(Value::Time(x) | Value::Bare(x)) if !(x > 0.0 && x.is_finite()) => {
                return Err(format!("`{part}`: a step or tolerance must be positive"));
            }
            Some(Value::Time(_)) if row.info.stepping == Stepping::Adaptive => {
                return Err(format!(
                    "`{part}`: {} chooses its steps; give a tolerance, for example {name}@1e-6",
                    row.info.id
                ));
            }
            Some(Value::Time(x)) => Resolution::Step(x),
            // Of a method that can do both a bare number is the tolerance.
            Some(Value::Bare(x)) => match row.info.stepping {
                Stepping::Fixed => Resolution::Step(x),
                Stepping::Adaptive | Stepping::Both if x < 1.0 => Resolution::Tolerance(x),
                Stepping::Adaptive | Stepping::Both => {
                    return Err(format!(
                        "`{part}`: a tolerance is less than 1; a step has a unit, as in @1us"
                    ));
                }
            },
            None => scene
                .iter()
                .find(|m| m.text == name)
                .or_else(|| scene.iter().find(|m| id_of(&m.text) == row.info.id))
                .map(|m| m.resolution)
                .or_else(|| {
                    let fixed = row.info.stepping == Stepping::Fixed;
                    scene
                        .iter()
                        .map(|m| m.resolution)
                        .find(|r| adaptive(r) != fixed)
                })
                .unwrap_or(match row.info.stepping {
                    Stepping::Fixed => Resolution::Step(1e-6),
                    _ => Resolution::Tolerance(1e-6),
                }),
        };
        found.push(Method {
            text: name.to_string(),
            resolution,
        });
    }
    if found.is_empty() {
        let known: Vec<&str> = METHODS.iter().map(|m| m.info.id).collect();
        return Err(format!(
            "no integrator named; there are {}",
            known.join(", ")
        ));
    }
    Ok(found)
}

/// What stands after an `@`.
enum Value {
    /// A number with a unit of time, in seconds.
    Time(f64),
    /// A number.
    Bare(f64),
}

impl Value {
    fn parse(text: &str) -> Option<Value> {
        let text = text.trim();
        match text.parse() {
            Ok(x) => Some(Value::Bare(x)),
            Err(_) => seconds(text).map(Value::Time),
        }
    }
}

/// A time with its unit: `500ns`, `1us`, `0.5 ms`, `2e-7s` [s].
pub fn seconds(text: &str) -> Option<f64> {
    const UNITS: [(&str, f64); 6] = [
        ("ns", 1e-9),
        ("us", 1e-6),
        ("\u{b5}s", 1e-6),
        ("\u{3bc}s", 1e-6),
        ("ms", 1e-3),
        ("s", 1.0),
    ];
    UNITS.iter().find_map(|(unit, factor)| {
        let number = text.trim().strip_suffix(unit)?.trim_end();
        Some(factor * number.parse::<f64>().ok()?)
    })
}

fn id_of(text: &str) -> &str {
    text.split('(').next().unwrap_or(text).trim()
}

/// Splits at commas that are not inside brackets.
pub fn split_outside_brackets(text: &str) -> Vec<&str> {
    let (mut parts, mut start, mut depth) = (Vec::new(), 0, 0i32);
    for (i, c) in text.char_indices() {
        match c {
            '(' => depth += 1,
            ')' => depth -= 1,
            ',' if depth == 0 => {
                parts.push(text[start..i].trim());
                start = i + 1;
            }
            _ => {}
        }
    }
    parts.push(text[start..].trim());
    parts.retain(|p| !p.is_empty());
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene() -> Vec<Method> {
        vec![
            Method {
                text: "rk4".into(),
                resolution: Resolution::Step(2e-6),
            },
            Method {
                text: "dopri5".into(),
                resolution: Resolution::Tolerance(1e-5),
            },
        ]
    }

    #[test]
    fn integrators_from_the_command_line() {
        let m = methods_from(
            "rk4, generalised-alpha(rho_inf=0.5), dopri5@1e-8,hht-alpha@1e-7",
            &scene(),
        )
        .unwrap();
        let want = [
            ("rk4", Resolution::Step(2e-6)),
            ("generalised-alpha(rho_inf=0.5)", Resolution::Step(2e-6)),
            ("dopri5", Resolution::Tolerance(1e-8)),
            ("hht-alpha", Resolution::Step(1e-7)),
        ];
        for (got, (text, resolution)) in m.iter().zip(want) {
            assert_eq!((got.text.as_str(), got.resolution), (text, resolution));
        }
    }

    #[test]
    fn a_unit_makes_it_a_step() {
        let m = methods_from(
            "trigonometric@1us,dopri5@2e-7s, rk4@500ns,hht-alpha@0.5 \u{b5}s,trigonometric@1e-4,bdf@1e-6",
            &scene(),
        )
        .unwrap();
        let want = [
            Resolution::Step(1e-6),
            Resolution::Step(2e-7),
            Resolution::Step(500.0 * 1e-9),
            Resolution::Step(0.5 * 1e-6),
            Resolution::Tolerance(1e-4),
            Resolution::Tolerance(1e-6),
        ];
        assert_eq!(m.iter().map(|m| m.resolution).collect::<Vec<_>>(), want);
        for (text, says) in [
            ("bdf@1us", "chooses its steps"),
            ("rk4@-1us", "positive"),
            ("dopri5@2", "less than 1"),
            ("rk4@1 furlong", "not a number"),
            ("rk4@us", "not a number"),
            ("rk4@infs", "positive"),
        ] {
            let e = methods_from(text, &scene()).unwrap_err();
            assert!(e.contains(says), "{text}: {e}");
        }
    }

    #[test]
    fn refusals_say_what_there_is() {
        assert!(methods_from("rk5", &scene()).unwrap_err().contains("rk4"));
        assert!(
            methods_from("rk4@-1", &scene())
                .unwrap_err()
                .contains("positive")
        );
        assert!(
            methods_from("rk4@x", &scene())
                .unwrap_err()
                .contains("not a number")
        );
        assert!(methods_from(",", &scene()).unwrap_err().contains("dopri5"));
    }
}
