//! A method with its step or tolerance, and its text form: `trigonometric@1us`, `dopri5@1e-6`, and lists separated by
//! commas. This module has the only parser of that form.

use crate::method::{Resolution, Stepping};
use crate::spec::{MethodError, MethodSpec};
use std::fmt;
use std::str::FromStr;

/// A method with its fixed step or tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scheme {
    /// Method and parameters.
    pub method: MethodSpec,
    /// Fixed step or tolerance.
    pub resolution: Resolution,
}

impl Scheme {
    /// Parses a list separated by commas, as on a command line: `id` or `id(name=value)`, each optionally followed by
    /// `@` and a step with its unit (`500ns`, `1us`, `2e-7s`) or a bare number. The number is a step in seconds for
    /// methods with fixed steps and a tolerance for adaptive ones. Without `@` the resolution of that method among
    /// `known` applies, or that of the most closely related method.
    pub fn list(text: &str, known: &[Scheme]) -> Result<Vec<Scheme>, MethodError> {
        let asked = SchemeRequest::list(text)?;
        if asked.is_empty() {
            return Err(MethodError::Empty);
        }
        Ok(asked.iter().map(|a| a.or_known(known)).collect())
    }

    /// Formats method and step or tolerance for readers.
    pub fn described(&self) -> String {
        match self.resolution {
            Resolution::Step(h) => format!("{}, step {h:.0e} s", self.method),
            Resolution::Tolerance(rtol) => format!("{}, rtol {rtol:.0e}", self.method),
        }
    }
}

/// The form that [`Scheme::list`] parses: `rk4@1e-6s`, `dopri5@1e-6`.
impl fmt::Display for Scheme {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.resolution {
            Resolution::Step(h) => write!(f, "{}@{h:e}s", self.method),
            Resolution::Tolerance(rtol) => write!(f, "{}@{rtol:e}", self.method),
        }
    }
}

/// A method, and optionally a requested step or tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SchemeRequest {
    /// Method and parameters.
    pub method: MethodSpec,
    /// Step or tolerance after the `@`, if any.
    pub resolution: Option<Resolution>,
}

impl SchemeRequest {
    /// Parses a list separated by commas; see [`Scheme::list`].
    pub fn list(text: &str) -> Result<Vec<SchemeRequest>, MethodError> {
        split_outside_brackets(text).map(str::parse).collect()
    }

    /// Completes a missing resolution with that of the same method among `known`, or of the most closely related
    /// method.
    pub fn or_known(&self, known: &[Scheme]) -> Scheme {
        let Self { method, resolution } = *self;
        let fixed = method.info().stepping == Stepping::Fixed;
        let adaptive = |s: &&Scheme| matches!(s.resolution, Resolution::Tolerance(_));
        let nearest = (known.iter().find(|s| s.method == method))
            .or_else(|| known.iter().find(|s| s.method.id() == method.id()))
            .or_else(|| known.iter().find(|s| adaptive(s) != fixed));
        let usual = match fixed {
            true => Resolution::Step(1e-6),
            false => Resolution::Tolerance(1e-6),
        };
        Scheme {
            method,
            resolution: resolution
                .or(nearest.map(|s| s.resolution))
                .unwrap_or(usual),
        }
    }
}

impl FromStr for SchemeRequest {
    type Err = MethodError;

    fn from_str(part: &str) -> Result<Self, MethodError> {
        let Some((name, value)) = part.split_once('@') else {
            let method = part.parse()?;
            return Ok(Self {
                method,
                resolution: None,
            });
        };
        let wrong = |why: String| Err(MethodError::Resolution(format!("`{part}`: {why}")));
        // A number with a unit of time, or a bare one.
        let bare = value.trim().parse::<f64>().ok();
        let Some(x) = bare.or_else(|| seconds(value)) else {
            return wrong(format!("`{value}` after @ is not a number"));
        };
        let method: MethodSpec = name.parse()?;
        let (id, stepping) = (method.id(), method.info().stepping);
        if !(x > 0.0 && x.is_finite()) {
            return wrong("a step or tolerance must be positive".into());
        }
        let resolution = match (bare.is_some(), stepping) {
            (false, Stepping::Adaptive) => {
                let name = name.trim();
                return wrong(format!(
                    "{id} chooses its steps; give a tolerance, for example {name}@1e-6"
                ));
            }
            (false, _) | (true, Stepping::Fixed) => Resolution::Step(x),
            // For a method with fixed and adaptive steps a bare number is the tolerance.
            (true, _) if x < 1.0 => Resolution::Tolerance(x),
            (true, _) => {
                return wrong("a tolerance is less than 1; a step has a unit, as in @1us".into());
            }
        };
        Ok(Self {
            method,
            resolution: Some(resolution),
        })
    }
}

/// Parses a time with its unit, such as `500ns`, `1us`, `0.5 ms` or `2e-7s`, and returns it in seconds.
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

/// Splits a text at the commas outside brackets.
fn split_outside_brackets(text: &str) -> impl Iterator<Item = &str> {
    let mut depth = 0i32;
    let parts = text.split(move |c| {
        depth += i32::from(c == '(') - i32::from(c == ')');
        c == ',' && depth == 0
    });
    parts.map(str::trim).filter(|p| !p.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::{DOPRI5, RK4};

    fn scene() -> [Scheme; 2] {
        [RK4.at_step(2e-6), DOPRI5.at_tolerance(1e-5)]
    }

    fn list(text: &str) -> Vec<(String, Resolution)> {
        let all = Scheme::list(text, &scene()).unwrap();
        all.iter()
            .map(|s| (s.method.to_string(), s.resolution))
            .collect()
    }

    #[test]
    fn integrators_from_the_command_line() {
        let found = list("rk4, generalised-alpha(rho_inf=0.5), dopri5@1e-8,hht-alpha@1e-7");
        let want = [
            ("rk4", Resolution::Step(2e-6)),
            ("generalised-alpha(rho_inf=0.5)", Resolution::Step(2e-6)),
            ("dopri5", Resolution::Tolerance(1e-8)),
            ("hht-alpha", Resolution::Step(1e-7)),
        ];
        assert_eq!(found, want.map(|(text, r)| (text.to_owned(), r)));
    }

    #[test]
    fn a_unit_makes_it_a_step() {
        let found = list(
            "trigonometric@1us,dopri5@2e-7s, rk4@500ns,hht-alpha@0.5 \u{b5}s,trigonometric@1e-4,bdf@1e-6",
        );
        let want = [
            Resolution::Step(1e-6),
            Resolution::Step(2e-7),
            Resolution::Step(500.0 * 1e-9),
            Resolution::Step(0.5 * 1e-6),
            Resolution::Tolerance(1e-4),
            Resolution::Tolerance(1e-6),
        ];
        assert_eq!(found.iter().map(|(_, r)| *r).collect::<Vec<_>>(), want);
        for (text, says) in [
            ("rk5", "rk4"),
            ("bdf@1us", "chooses its steps"),
            ("rk4@-1us", "positive"),
            ("rk4@-1", "positive"),
            ("dopri5@2", "less than 1"),
            ("rk4@x", "not a number"),
            ("rk4@1 furlong", "not a number"),
            ("rk4@us", "not a number"),
            ("rk4@infs", "positive"),
            (",", "dopri5"),
        ] {
            let e = Scheme::list(text, &scene()).unwrap_err().to_string();
            assert!(e.contains(says), "{text}: {e}");
        }
    }
}
