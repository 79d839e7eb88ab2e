//! The table of methods. A new method is one file and one line in [`METHODS`]; the command line, the conformance tests
//! and the studies use the table.

use crate::diffsol_adapter::{Diffsol, Solver};
use crate::explicit::runge_kutta::{self, RungeKutta};
use crate::explicit::semi_implicit_euler::{self, SemiImplicitEuler};
use crate::explicit::tsit45;
use crate::explicit::velocity_verlet::{self, VelocityVerlet};
use crate::implicit::diffsol_methods;
use crate::implicit::generalised_alpha::{self, GeneralisedAlpha};
use crate::linear_stability::{Flip, Impulses, Stability};
use crate::method::{Integrator, MethodInfo, Parameter};
use crate::modal::resonance::Filter;
use crate::modal::trigonometric::{self, Trigonometric};
use crate::spec::{MethodError, MethodSpec};
use crate::stepped::Stepped;

/// A row of the table: properties of a method and its constructor from parameters in declared order.
pub struct Method {
    /// Declared properties of the method.
    pub info: &'static MethodInfo,
    pub(crate) make: fn(&[f64]) -> Box<dyn Integrator>,
    pub(crate) stability: fn(&[f64]) -> Stability,
}

/// The parameter that all methods share.
pub static FREE_FLIGHT: Parameter = Parameter {
    name: "free_flight",
    default: 0.0,
    range: (0.0, 1.0),
    meaning: "1: flights, where nothing touches under steady loads, are crossed in one step of the system's own closed form, exact up to rounding; 0: they are stepped through. The trigonometric method always crosses them",
};

/// All methods, in the order of lists and reports.
pub const METHODS: &[Method] = &[
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
            Stability::Impulses(Impulses {
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
    /// Builds the method with its default parameters.
    pub fn build(&self) -> Box<dyn Integrator> {
        let defaults: Vec<f64> = self.info.parameters.iter().map(|p| p.default).collect();
        (self.make)(&defaults)
    }
}

/// Returns the row of an identifier in a constant expression; an unknown identifier does not compile.
const fn row(id: &str) -> MethodSpec {
    let id = id.as_bytes();
    let mut i = 0;
    loop {
        let known = METHODS[i].info.id.as_bytes();
        let mut same = 0;
        while same < id.len() && same < known.len() && id[same] == known[same] {
            same += 1;
        }
        if same == id.len() && same == known.len() {
            return MethodSpec::of(&METHODS[i]);
        }
        i += 1;
    }
}

/// Semi-implicit Euler method: first order, explicit, symplectic.
pub const SEMI_IMPLICIT_EULER: MethodSpec = row("semi-implicit-euler");
/// Velocity Verlet method: second order, explicit, symplectic.
pub const VELOCITY_VERLET: MethodSpec = row("velocity-verlet");
/// Classical Runge-Kutta method: fourth order, explicit, at fixed steps.
pub const RK4: MethodSpec = row("rk4");
/// Dormand-Prince method: fifth order, explicit, at fixed steps or under a tolerance.
pub const DOPRI5: MethodSpec = row("dopri5");
/// Trigonometric method: exact for the oscillators of a modal split.
pub const TRIGONOMETRIC: MethodSpec = row("trigonometric");
/// Newmark method: the trapezoidal rule of structural dynamics.
pub const NEWMARK: MethodSpec = row("newmark");
/// HHT-alpha method: Newmark with damping of high frequencies.
pub const HHT_ALPHA: MethodSpec = row("hht-alpha");
/// Generalised-alpha method: second order, implicit, with a given spectral radius at infinite frequency.
pub const GENERALISED_ALPHA: MethodSpec = row("generalised-alpha");

fn filter_of(parameter: f64) -> Filter {
    match parameter {
        x if x < 0.5 => Filter::None,
        x if x < 1.5 => Filter::Fast,
        _ => Filter::All,
    }
}

/// Builds the method of the text `id` or `id(name=value, ...)`; the error lists the known methods.
pub fn method(text: &str) -> Result<Box<dyn Integrator>, MethodError> {
    Ok(text.parse::<MethodSpec>()?.build())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spec::MOST_PARAMETERS;

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
            assert!(info.parameters.len() <= MOST_PARAMETERS);
            assert_eq!(m.build().info(), info);
        }
    }
}
