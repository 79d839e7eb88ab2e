//! Reasons why a contact law is refused.

use crate::error::{Reason, reasoned};

/// Error of a contact law.
#[derive(Debug, Clone, PartialEq)]
#[expect(missing_docs, reason = "what the fields are the messages say")]
pub enum LawError {
    /// The penetration exponent is outside `[1, 3]`.
    Exponent { value: f64 },
    /// The coefficient of restitution is outside `(0, 1]`.
    Restitution { law: &'static str, value: f64 },
    /// A Kelvin-Voigt coefficient or ratio is negative or not finite.
    KelvinVoigt { what: &'static str, value: f64 },
    /// A damping ratio at load was given for a mesh without load.
    NoLoad,
    /// A damping ratio was not converted to a coefficient.
    UnresolvedRatio,
    /// A damping ratio was given for a nonlinear law.
    RatioOfNonlinearLaw { exponent: f64 },
    /// A quantity that must be positive is not.
    NotPositive { what: &'static str, value: f64 },
    /// A friction parameter is out of range.
    Friction {
        what: &'static str,
        value: f64,
        rule: &'static str,
    },
}

impl LawError {
    /// Returns cause and remedy.
    pub fn reason(&self) -> Reason {
        let (cause, help) = match self {
            Self::Exponent { value } => (
                format!("exponent of the contact law is {value}"),
                "it must lie in [1, 3] (1 linear, 10/9 line, 3/2 point contact)".to_owned(),
            ),
            Self::Restitution { law, value } => (
                format!("coefficient of restitution of {law} is {value}"),
                "it must lie in (0, 1]".to_owned(),
            ),
            Self::KelvinVoigt { what, value } => (
                format!("Kelvin-Voigt damping {what} is {value}"),
                "it must be finite and not negative".to_owned(),
            ),
            Self::NoLoad => (
                "a damping ratio at the load of the mesh needs a load, but no gear of the scene has one"
                    .to_owned(),
                "give a gear a torque, or take the law kelvin-voigt-ratio, or one with a restitution"
                    .to_owned(),
            ),
            Self::UnresolvedRatio => (
                "a damping ratio needs stiffness and reduced mass".to_owned(),
                "call Damping::resolved first, or give c in N s/m".to_owned(),
            ),
            Self::RatioOfNonlinearLaw { exponent } => (
                format!(
                    "a damping ratio is defined for the linear law only, the exponent is \
                     {exponent}"
                ),
                "give c in N s/m, or a restitution law".to_owned(),
            ),
            Self::NotPositive { what, value } => (
                format!("{what} is {value}"),
                "it must be finite and positive".to_owned(),
            ),
            Self::Friction { what, value, rule } => {
                (format!("friction {what} is {value}"), (*rule).to_owned())
            }
        };
        Reason { cause, help }
    }
}

reasoned!(LawError);
