//! Properties of a model that do not depend on the values of its parameters, for studies that need them before a gear
//! is built.

use crate::spec::GearSpec;

/// Properties of a model that determine the studies in which it can be used.
#[derive(Clone, Copy, Debug)]
pub struct Properties {
    /// True for a rigid body: the compliance is that of the contact law alone, and forces on the flanks reach the
    /// mount without delay.
    pub rigid: bool,
    /// True if every node of a mesh moves: a run takes seconds to minutes, and other models are compared with it.
    pub full_order: bool,
    /// True for a modal reduction, for which a method that is exact for oscillators gives the converged solution.
    pub modes: bool,
    /// Fit of the constants to a reference impact; `None` for models whose constants follow from the body.
    pub fit: Option<Fit>,
}

impl Properties {
    /// Properties of a model with no optional capability.
    pub const NONE: Properties = Properties {
        rigid: false,
        full_order: false,
        modes: false,
        fit: None,
    };
}

/// Constants to be fitted: the stiffness of a tooth pair in the contact law, parameters of the model, and the gap.
#[derive(Clone, Copy, Debug)]
pub struct Fit {
    /// Keys of the fitted parameters, each a positive number.
    pub parameters: &'static [&'static str],
    /// Starting points for a tooth pair of a given stiffness per face width [N/m per m] and a gear.
    pub starts: fn(f64, &GearSpec) -> Vec<Start>,
}

/// Starting point of a fit.
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    /// Stiffness of a tooth pair in the contact law, per face width [N/m per m].
    pub contact: f64,
    /// Values of the parameters at the start.
    pub parameters: Vec<f64>,
}
