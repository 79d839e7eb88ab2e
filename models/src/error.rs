//! Reasons why a scene cannot be built: the subject, the cause and the remedy, in separate fields, so that a user
//! interface can place the message.

pub use gearbench_involute::error::Reason;

use std::fmt;

/// Part of a gear that an error refers to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GearPart {
    /// The gear as a whole.
    Whole,
    /// The inertia or mass of the gear.
    Inertia,
    /// One of the loads of the gear.
    Load,
    /// The mount or prescribed motion of the gear.
    Mount,
    /// The gear model.
    Model,
}

/// Part of a mesh that an error refers to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshPart {
    /// The relative position of the gears.
    Layout,
    /// The initial position in the backlash.
    Start,
    /// The stiffness of the tooth pairs.
    Stiffness,
    /// The exponent of the normal law.
    Exponent,
    /// The normal force by a law of a program.
    NormalForce,
    /// The damping of the normal law.
    Damping,
    /// The friction law.
    Friction,
    /// The slices over the face width.
    Slices,
    /// The contact as a whole.
    Contact,
}

/// Subject of an error. Names of gears are unique in a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Subject {
    /// The scene as a whole.
    Scene,
    /// A gear, or a part of it.
    Gear {
        /// Name of the gear.
        name: String,
        /// Part of the gear.
        part: GearPart,
    },
    /// A mesh, or a part of it.
    Mesh {
        /// Names of the two gears.
        gears: [String; 2],
        /// Part of the mesh.
        part: MeshPart,
    },
    /// A shaft of the scene.
    Shaft {
        /// Name of the shaft.
        name: String,
    },
    /// A stage without teeth.
    Stage {
        /// Name of the stage.
        name: String,
    },
    /// A parameter of a gear model.
    Parameter {
        /// Name of the gear with the model, where it is known.
        gear: Option<String>,
        /// Identifier of the model.
        model: String,
        /// Key of the parameter.
        key: String,
        /// True if the parameter is required and missing.
        missing: bool,
    },
}

impl fmt::Display for Subject {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Subject::Scene => f.write_str("scene"),
            Subject::Gear { name, .. } => write!(f, "gear `{name}`"),
            Subject::Mesh { gears: [a, b], .. } => write!(f, "mesh of `{a}` and `{b}`"),
            Subject::Shaft { name } => write!(f, "shaft `{name}`"),
            Subject::Stage { name } => write!(f, "stage `{name}`"),
            Subject::Parameter {
                gear, model, key, ..
            } => {
                if let Some(gear) = gear {
                    write!(f, "gear `{gear}`, ")?;
                }
                write!(f, "model `{model}`, parameter `{key}`")
            }
        }
    }
}

/// Origin of an error: the scene, or a limit of one model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// A value of the scene is invalid for every model, or its key does not accept it.
    Value,
    /// The scene is valid, but this model cannot run it; other models may.
    Model,
}

/// Error of the assembly of a scene: subject, reason and origin.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{subject}: {reason}")]
pub struct BuildError {
    /// Subject of the error, boxed so that results stay small.
    pub subject: Box<Subject>,
    /// Cause and remedy.
    pub reason: Reason,
    /// Origin of the error: the scene or the model.
    pub fault: Fault,
}

impl BuildError {
    /// Marks the error as a limit of the model: a study refuses the model and runs the others.
    #[must_use]
    pub fn of_model(mut self) -> Self {
        self.fault = Fault::Model;
        self
    }

    /// Creates an error about the scene as a whole.
    pub fn scene(why: impl Into<Reason>) -> Self {
        Self::about(Subject::Scene, why)
    }

    /// Creates an error about a gear.
    pub fn gear(name: &str, part: GearPart, why: impl Into<Reason>) -> Self {
        let name = name.into();
        Self::about(Subject::Gear { name, part }, why)
    }

    /// Creates an error about a mesh, from the names of its gears.
    pub fn mesh(gears: [&str; 2], part: MeshPart, why: impl Into<Reason>) -> Self {
        let gears = gears.map(str::to_owned);
        Self::about(Subject::Mesh { gears, part }, why)
    }

    /// Creates an error about a shaft.
    pub fn shaft(name: &str, why: impl Into<Reason>) -> Self {
        let name = name.into();
        Self::about(Subject::Shaft { name }, why)
    }

    /// Creates an error about a stage.
    pub fn stage(name: &str, why: impl Into<Reason>) -> Self {
        let name = name.into();
        Self::about(Subject::Stage { name }, why)
    }

    /// Creates an error about a parameter of a model.
    pub fn parameter(model: &str, key: &str, why: impl Into<Reason>) -> Self {
        Self::of_parameter(model, key, false, why)
    }

    /// Creates an error about a missing parameter; `help` describes where to find its value.
    pub fn missing(model: &str, key: &str, help: &str) -> Self {
        Self::of_parameter(model, key, true, ("is missing", help))
    }

    /// Adds the name of the gear to an error about a parameter.
    #[must_use]
    pub fn of_gear(mut self, name: &str) -> Self {
        if let Subject::Parameter { gear, .. } = &mut *self.subject {
            *gear = Some(name.to_owned());
        }
        self
    }

    /// Returns true for the error of a missing parameter.
    pub fn is_missing(&self) -> bool {
        matches!(*self.subject, Subject::Parameter { missing: true, .. })
    }

    fn of_parameter(model: &str, key: &str, missing: bool, why: impl Into<Reason>) -> Self {
        let (model, key) = (model.into(), key.into());
        let subject = Subject::Parameter {
            gear: None,
            model,
            key,
            missing,
        };
        Self::about(subject, why)
    }

    fn about(subject: Subject, why: impl Into<Reason>) -> Self {
        let reason = why.into();
        let subject = Box::new(subject);
        BuildError {
            subject,
            reason,
            fault: Fault::Value,
        }
    }
}
