//! Properties of a model, whatever the values of its parameters: what studies ask before a gear is built.

use crate::spec::GearSpec;

/// What a study may or may not do with a model.
#[derive(Clone, Copy, Debug)]
pub struct Properties {
    /// A rigid body: the compliance is that of the contact law alone, forces on the flanks reach the mount undelayed.
    pub rigid: bool,
    /// Every node of a mesh moves: a run takes seconds to minutes, and other models are held against it.
    pub full_order: bool,
    /// Reduced to modes, for which a method that is exact for oscillators gives the converged solution.
    pub modes: bool,
    /// How its constants are fitted to a reference impact; `None` for models whose constants follow from the body.
    pub fit: Option<Fit>,
}

impl Properties {
    /// Those of a model that is nothing of all that.
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
    /// Keys of the parameters, each a positive number.
    pub parameters: &'static [&'static str],
    /// Starting points for a tooth pair of some stiffness per face width [N/m per m] and a gear.
    pub starts: fn(f64, &GearSpec) -> Vec<Start>,
}

/// Where a fit starts.
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    /// Stiffness of a tooth pair in the contact law, per face width [N/m per m].
    pub contact: f64,
    /// Values of the parameters.
    pub parameters: Vec<f64>,
}
