//! Parameters of a stability map: their names, ranges and values.

use crate::experiment::conditions::logarithmic;

/// Parameter that an axis of a stability map varies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Deserialize, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Axis {
    /// Factor on stiffness or penalty of all contacts.
    ContactStiffness,
    /// Spring of a movable tooth [N/m].
    ToothStiffness,
    /// Damping ratio: of the modes of elastic gears, else of the contact.
    Damping,
    /// Factor on initial speeds and prescribed motions.
    Speed,
    /// Number of modes per gear of elastic gears.
    Modes,
    /// Spectral radius at infinite step of generalised-alpha.
    RhoInf,
    /// Parameter alpha of the HHT method.
    HhtAlpha,
}

impl Axis {
    /// All parameters that an axis can vary.
    pub const ALL: [Axis; 7] = [
        Axis::ContactStiffness,
        Axis::ToothStiffness,
        Axis::Damping,
        Axis::Speed,
        Axis::Modes,
        Axis::RhoInf,
        Axis::HhtAlpha,
    ];

    /// Returns the name of the parameter in scenes and on the command line.
    pub fn id(self) -> &'static str {
        match self {
            Axis::ContactStiffness => "contact-stiffness",
            Axis::ToothStiffness => "tooth-stiffness",
            Axis::Damping => "damping",
            Axis::Speed => "speed",
            Axis::Modes => "modes",
            Axis::RhoInf => "rho-inf",
            Axis::HhtAlpha => "hht-alpha",
        }
    }

    /// Returns the label of the parameter on axes of plots.
    pub fn name(self) -> &'static str {
        match self {
            Axis::ContactStiffness => "contact stiffness over the scene's",
            Axis::ToothStiffness => "tooth stiffness",
            Axis::Damping => "damping ratio",
            Axis::Speed => "speed over the scene's",
            Axis::Modes => "modes per gear",
            Axis::RhoInf => "rho_inf",
            Axis::HhtAlpha => "alpha",
        }
    }

    /// Returns the unit of the parameter, empty for ratios and counts.
    pub fn unit(self) -> &'static str {
        match self {
            Axis::ToothStiffness => "N/m",
            _ => "",
        }
    }

    /// Returns the smallest and largest valid value.
    pub fn range(self) -> [f64; 2] {
        match self {
            Axis::ContactStiffness | Axis::Speed => [1e-9, 1e9],
            Axis::ToothStiffness => [1.0, 1e18],
            Axis::Damping => [0.0, 0.999],
            Axis::Modes => [0.0, 2000.0],
            Axis::RhoInf => [0.0, 1.0],
            Axis::HhtAlpha => [0.0, 1.0 / 3.0],
        }
    }

    /// Returns the default values of the parameter; empty where no values suit every scene.
    pub fn defaults(self) -> Vec<f64> {
        match self {
            Axis::ContactStiffness => logarithmic(0.1, 100.0, 7),
            Axis::Speed => logarithmic(0.25, 4.0, 5),
            Axis::Damping => vec![0.0, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5],
            Axis::Modes => vec![0.0, 10.0, 25.0, 50.0, 100.0, 200.0],
            Axis::RhoInf => vec![0.0, 0.2, 0.4, 0.6, 0.8, 1.0],
            Axis::HhtAlpha => vec![0.0, 0.05, 0.1, 0.2, 0.3],
            Axis::ToothStiffness => Vec::new(),
        }
    }

    /// True if values of the parameter are whole numbers.
    pub fn is_count(self) -> bool {
        self == Axis::Modes
    }

    /// True if the parameter belongs to the integrator: the model's own solution does not depend on it.
    pub fn is_of_method(self) -> bool {
        matches!(self, Axis::RhoInf | Axis::HhtAlpha)
    }
}
