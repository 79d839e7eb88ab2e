//! Levels of the model hierarchy, from rigid gears to elastic ones with many modes and a finer mesh than that of the
//! scene.

use super::detail::Detail;
use gearbench_models::gear::movable_teeth::MovableTeethParameters;
use gearbench_models::gear::parameters::ModelParameters;
use gearbench_models::gear::rigid::RigidParameters;
use gearbench_reference::reduction::ElasticParameters;

/// Origin of the mesh stiffness of rigid gears.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Stiffness {
    /// Mesh stiffness according to ISO 6336-1.
    Norm,
    /// Analytic compliance of teeth, bodies and contact.
    Analytic,
    /// Static solves of the elastic gears without modes.
    Static,
    /// The scene's own model with this label.
    Own(String),
}

/// Level of the model hierarchy.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Level {
    /// Rigid gears with a mesh stiffness.
    Rigid(Stiffness),
    /// Movable teeth with derived constants, or the scene's own with this label.
    MovableTeeth(Option<String>),
    /// Elastic gears without modes: quasi-static compliance.
    QuasiStatic(Detail),
    /// Elastic gears with so many modes, and the compliance of the others.
    Elastic {
        /// Modes per gear, at most.
        modes: usize,
        /// Mesh density and kind of flank contact.
        detail: Detail,
    },
}

impl Level {
    /// Returns the name of the level for tables.
    pub fn name(&self) -> String {
        match self {
            Level::Rigid(Stiffness::Norm) => "rigid, ISO 6336".into(),
            Level::Rigid(Stiffness::Analytic) => "rigid, analytic compliance".into(),
            Level::Rigid(Stiffness::Static) => "rigid, static solves".into(),
            Level::Rigid(Stiffness::Own(label)) => format!("rigid, own `{label}`"),
            Level::MovableTeeth(None) => "movable teeth".into(),
            Level::MovableTeeth(Some(label)) => format!("movable teeth, own `{label}`"),
            Level::QuasiStatic(detail) => format!("quasi-static{}", detail.suffix()),
            Level::Elastic { modes, detail } => {
                format!("elastic, {modes} modes{}", detail.suffix())
            }
        }
    }

    /// Returns the model family for charts: the gear model, or `quasi-static`.
    pub fn family(&self) -> &'static str {
        match self {
            Level::Rigid(_) => RigidParameters::MODEL,
            Level::MovableTeeth(_) => MovableTeethParameters::MODEL,
            Level::QuasiStatic(_) => "quasi-static",
            Level::Elastic { .. } => ElasticParameters::MODEL,
        }
    }

    /// Returns the modes per gear of elastic gears, 0 for quasi-static ones; `None` for other models.
    pub fn modes(&self) -> Option<usize> {
        match self {
            Level::QuasiStatic(_) => Some(0),
            Level::Elastic { modes, .. } => Some(*modes),
            _ => None,
        }
    }

    /// Returns the detail (mesh and contact) of elastic gears; `None` for other models.
    pub fn detail(&self) -> Option<Detail> {
        match self {
            Level::QuasiStatic(detail) | Level::Elastic { detail, .. } => Some(*detail),
            _ => None,
        }
    }

    /// Returns the level of elastic gears with a number of modes and a detail.
    pub fn elastic(modes: usize, detail: Detail) -> Level {
        match modes {
            0 => Level::QuasiStatic(detail),
            modes => Level::Elastic { modes, detail },
        }
    }
}
