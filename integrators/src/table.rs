//! The table of methods. A new method is one file and one line in [`METHODS`]; the command line, the
//! conformance tests and the studies iterate it.

use crate::diffsol_adapter::{Diffsol, Solver};
use crate::explicit::runge_kutta::{self, RungeKutta};
use crate::explicit::semi_implicit_euler::{self, SemiImplicitEuler};
use crate::explicit::tsit45;
use crate::explicit::velocity_verlet::{self, VelocityVerlet};
use crate::implicit::diffsol_methods;
use crate::implicit::generalised_alpha::{self, GeneralisedAlpha};
use crate::linear_stability::{Flip, Kicks, Stability};
use crate::method::{Integrator, MethodInfo, Parameter};
use crate::modal::trigonometric::{self, Filter, Trigonometric};
use crate::stepped::Stepped;

/// A row: what the method declares and how it is made from its parameters (in declared order).
pub struct Method {
    /// Declared facts.
    pub info: &'static MethodInfo,
    make: fn(&[f64]) -> Box<dyn Integrator>,
    stability: fn(&[f64]) -> Stability,
}

/// The parameter that all methods take beside their own.
pub static COAST: Parameter = Parameter {
    name: "coast",
    default: 0.0,
    range: (0.0, 1.0),
    meaning: "1: flights, where nothing touches under steady loads, are crossed in one step of the system's own closed form, exact up to rounding; 0: they are stepped through. The trigonometric method always crosses them",
};

/// All methods.
pub static METHODS: &[Method] = &[
    Method {
        info: &semi_implicit_euler::INFO,
        make: |_| Box::new(Stepped::new(SemiImplicitEuler::default())),
        stability: |_| Stability::Flip(Flip { d: 2.0, k: 1.0 }),
    },
    Method {
        info: &velocity_verlet::INFO,
        make: |_| Box::new(Stepped::new(VelocityVerlet::default())),
        stability: |_| Stability::Flip(Flip { d: 4.0, k: 1.0 }),
    },
    Method {
        info: &runge_kutta::RK4,
        make: |_| Box::new(Stepped::new(RungeKutta::rk4())),
        stability: |_| RungeKutta::rk4().stability(),
    },
    Method {
        info: &runge_kutta::DOPRI5,
        make: |_| Box::new(Stepped::new(RungeKutta::dopri5())),
        stability: |_| RungeKutta::dopri5().stability(),
    },
    Method {
        info: &trigonometric::INFO,
        make: |p| Box::new(Stepped::new(Trigonometric::new(filter_of(p[0])))),
        stability: |p| {
            Stability::Kicks(Kicks {
                filter_from: filter_of(p[0]).from(),
            })
        },
    },
    Method {
        info: &tsit45::INFO,
        make: |_| Box::new(Diffsol::new(&tsit45::INFO, Solver::Tsit45)),
        stability: |_| Stability::Controlled,
    },
    Method {
        info: &generalised_alpha::NEWMARK,
        make: |p| Box::new(Stepped::new(GeneralisedAlpha::newmark(p[0]))),
        stability: |p| GeneralisedAlpha::newmark(p[0]).stability(),
    },
    Method {
        info: &generalised_alpha::HHT,
        make: |p| Box::new(Stepped::new(GeneralisedAlpha::hht(p[0]))),
        stability: |p| GeneralisedAlpha::hht(p[0]).stability(),
    },
    Method {
        info: &generalised_alpha::GENERALISED_ALPHA,
        make: |p| Box::new(Stepped::new(GeneralisedAlpha::chung_hulbert(p[0]))),
        stability: |p| GeneralisedAlpha::chung_hulbert(p[0]).stability(),
    },
    Method {
        info: &diffsol_methods::BDF,
        make: |_| Box::new(Diffsol::new(&diffsol_methods::BDF, Solver::Bdf)),
        stability: |_| Stability::Controlled,
    },
    Method {
        info: &diffsol_methods::TR_BDF2,
        make: |_| Box::new(Diffsol::new(&diffsol_methods::TR_BDF2, Solver::TrBdf2)),
        stability: |_| Stability::Controlled,
    },
    Method {
        info: &diffsol_methods::ESDIRK34,
        make: |_| Box::new(Diffsol::new(&diffsol_methods::ESDIRK34, Solver::Esdirk34)),
        stability: |_| Stability::Controlled,
    },
];

impl Method {
    /// The method with its default parameters.
    pub fn build(&self) -> Box<dyn Integrator> {
        let defaults: Vec<f64> = self.info.parameters.iter().map(|p| p.default).collect();
        (self.make)(&defaults)
    }

    /// The method with some parameters given by name: its own, or [`COAST`].
    pub fn build_with(&self, given: &[(String, f64)]) -> Result<Box<dyn Integrator>, String> {
        self.with(&self.values(given)?)
    }

    /// All parameters in declared order and [`COAST`], some given by name.
    fn values(&self, given: &[(String, f64)]) -> Result<Given, String> {
        let mut values: Vec<f64> = self.info.parameters.iter().map(|p| p.default).collect();
        let mut coast = None;
        for (name, value) in given {
            if name == COAST.name {
                if *value != 0.0 && *value != 1.0 {
                    return Err(format!(
                        "{} coast = {value} is neither 0 nor 1",
                        self.info.id
                    ));
                }
                coast = Some(*value == 1.0);
                continue;
            }
            let Some(i) = self.info.parameters.iter().position(|p| p.name == name) else {
                let known: Vec<&str> = self.info.parameters.iter().map(|p| p.name).collect();
                return Err(if known.is_empty() {
                    format!(
                        "{} has no parameters of its own, but `{name}` was given; all methods take `{}`",
                        self.info.id, COAST.name
                    )
                } else {
                    format!(
                        "{} has no parameter `{name}`; it has {} and {}",
                        self.info.id,
                        known.join(", "),
                        COAST.name
                    )
                });
            };
            let (low, high) = self.info.parameters[i].range;
            if !(low..=high).contains(value) {
                return Err(format!(
                    "{} {name} = {value} lies outside [{low}, {high}]",
                    self.info.id
                ));
            }
            values[i] = *value;
        }
        Ok((values, coast))
    }

    /// Makes the method from what [`Self::values`] found.
    fn with(&self, (values, coast): &Given) -> Result<Box<dyn Integrator>, String> {
        let mut built = (self.make)(values);
        match coast {
            Some(on) if !built.coast(*on) => Err(format!(
                "{} {}; leave `coast` out",
                self.info.id,
                if *on {
                    "steps through flights"
                } else {
                    "always crosses flights in one step"
                }
            )),
            _ => Ok(built),
        }
    }
}

/// Parameters in declared order, and whether flights are to be crossed in one step where somebody says.
type Given = (Vec<f64>, Option<bool>);

fn filter_of(parameter: f64) -> Filter {
    match parameter {
        x if x < 0.5 => Filter::None,
        x if x < 1.5 => Filter::Fast,
        _ => Filter::All,
    }
}

/// Finds a method by `id` or `id(name=value, ...)` and builds it; the error says what is known.
pub fn method(text: &str) -> Result<(&'static Method, Box<dyn Integrator>), String> {
    let (row, given) = find(text)?;
    Ok((row, row.with(&given)?))
}

/// What decides the stability of a method that is named as [`method`] takes it; the error says what is known.
pub fn stability(text: &str) -> Result<(&'static Method, Stability), String> {
    let (row, (values, _)) = find(text)?;
    Ok((row, (row.stability)(&values)))
}

/// A row by name, and the values of its parameters.
fn find(text: &str) -> Result<(&'static Method, Given), String> {
    let text = text.trim();
    let (id, parameters) = match text.split_once('(') {
        Some((id, rest)) => {
            let inner = rest
                .strip_suffix(')')
                .ok_or_else(|| format!("`{text}`: the closing bracket is missing"))?;
            (id.trim(), inner)
        }
        None => (text, ""),
    };
    let row = METHODS.iter().find(|m| m.info.id == id).ok_or_else(|| {
        let known: Vec<&str> = METHODS.iter().map(|m| m.info.id).collect();
        format!(
            "there is no integrator `{id}`; there are {}",
            known.join(", ")
        )
    })?;
    let mut given = Vec::new();
    for part in parameters
        .split(',')
        .map(str::trim)
        .filter(|p| !p.is_empty())
    {
        let (name, value) = part
            .split_once('=')
            .ok_or_else(|| format!("`{part}`: expected name=value, for example rho_inf=0.8"))?;
        let value: f64 = value
            .trim()
            .parse()
            .map_err(|_| format!("`{part}`: `{}` is not a number", value.trim()))?;
        given.push((name.trim().to_string(), value));
    }
    let given = row.values(&given)?;
    Ok((row, given))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_distinct_and_admissible() {
        for (i, m) in METHODS.iter().enumerate() {
            let info = m.info;
            assert!(METHODS[..i].iter().all(|other| other.info.id != info.id));
            assert!(info.order >= 1 && !info.citation.is_empty());
            let adaptive = info.stepping != crate::Stepping::Fixed;
            assert_eq!(adaptive, info.tolerance_slope > 0.0, "{}", info.id);
            for p in info.parameters {
                assert!((p.range.0..=p.range.1).contains(&p.default), "{}", info.id);
            }
            assert_eq!(m.build().info(), info);
        }
    }

    #[test]
    fn methods_are_found_by_name_and_parameters() {
        for m in METHODS {
            assert_eq!(method(m.info.id).unwrap().1.info(), m.info);
        }
        assert!(method(" generalised-alpha( rho_inf = 0.5 ) ").is_ok());
        assert!(method("newmark()").is_ok());
        for m in METHODS {
            assert!(method(&format!("{}(coast=1)", m.info.id)).is_ok());
        }
    }

    #[test]
    fn refusals_say_what_is_known() {
        for (text, says) in [
            ("rk5", "semi-implicit-euler"),
            ("rk4(h=1)", "no parameters"),
            ("rk4(coast=0.5)", "neither 0 nor 1"),
            ("trigonometric(coast=0)", "always crosses"),
            ("newmark(gamma=0.5)", "it has beta"),
            ("newmark(beta=2)", "outside [0, 0.5]"),
            ("newmark(beta=NaN)", "outside"),
            ("newmark(beta)", "name=value"),
            ("newmark(beta=x)", "not a number"),
            ("newmark(beta=0.2", "closing bracket"),
        ] {
            let error = method(text).err().unwrap_or_default();
            assert!(error.contains(says), "{text}: {error}");
        }
    }
}
