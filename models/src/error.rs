//! Why something cannot be built: what it is about, the cause and a way out, each apart, so that whoever shows it
//! can place it without reading its words.

use std::fmt;

/// A cause and a way out, in words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Reason {
    /// What is wrong.
    pub cause: String,
    /// A way out; empty when the cause says it all.
    pub help: String,
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.cause)?;
        match self.help.as_str() {
            "" => Ok(()),
            help => write!(f, "; {help}"),
        }
    }
}

impl From<String> for Reason {
    fn from(cause: String) -> Self {
        (cause, "").into()
    }
}

impl From<&str> for Reason {
    fn from(cause: &str) -> Self {
        (cause, "").into()
    }
}

impl<C: Into<String>, H: Into<String>> From<(C, H)> for Reason {
    fn from((cause, help): (C, H)) -> Self {
        Reason {
            cause: cause.into(),
            help: help.into(),
        }
    }
}

/// Errors that hold numbers and give them words by `reason()`: text and conversion follow from that.
macro_rules! reasoned {
    ($error:ty) => {
        impl std::fmt::Display for $error {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                self.reason().fmt(f)
            }
        }

        impl std::error::Error for $error {}

        impl From<&$error> for $crate::error::Reason {
            fn from(e: &$error) -> Self {
                e.reason()
            }
        }
    };
}
pub(crate) use reasoned;

/// What of a gear is meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GearPart {
    /// The gear as such.
    Whole,
    /// Its inertia or mass.
    Inertia,
    /// One of its loads.
    Load,
    /// Its mount or prescribed motion.
    Mount,
    /// The model that it takes.
    Model,
}

/// What of a mesh is meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshPart {
    /// Where its gears stand to each other.
    Layout,
    /// Where it starts.
    Start,
    /// Stiffness of its tooth pairs.
    Stiffness,
    /// Exponent of its normal law.
    Exponent,
    /// Damping of its normal law.
    Damping,
    /// Friction.
    Friction,
    /// Slices over the face width.
    Slices,
    /// Its contact as a whole.
    Contact,
}

/// What an error is about. Names of gears are unique in a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Subject {
    /// The scene as a whole.
    Scene,
    /// A gear.
    Gear {
        /// Its name.
        name: String,
        /// What of it.
        part: GearPart,
    },
    /// A mesh.
    Mesh {
        /// Names of its gears.
        gears: [String; 2],
        /// What of it.
        part: MeshPart,
    },
    /// A shaft.
    Shaft {
        /// Its name.
        name: String,
    },
    /// A parameter of a gear model.
    Parameter {
        /// Name of the gear that takes the model, where it is known.
        gear: Option<String>,
        /// Id of the model.
        model: String,
        /// Its key.
        key: String,
        /// It is not given, but has to be.
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

/// Who is at fault where a scene cannot be assembled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// A value of the scene is wrong for every model, or is none that its key takes.
    Value,
    /// The scene is sound, but this model cannot run it; other models may.
    Model,
}

/// Why a scene cannot be assembled.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{subject}: {reason}")]
pub struct BuildError {
    /// What the error is about; apart, so that results stay small.
    pub subject: Box<Subject>,
    /// What is wrong and a way out.
    pub reason: Reason,
    /// Whether the scene or the model is at fault.
    pub fault: Fault,
}

impl BuildError {
    /// The same error as a limit of the model: a study refuses the model and runs the others.
    #[must_use]
    pub fn of_model(mut self) -> Self {
        self.fault = Fault::Model;
        self
    }

    /// An error about the scene as a whole.
    pub fn scene(why: impl Into<Reason>) -> Self {
        Self::about(Subject::Scene, why)
    }

    /// An error about a gear.
    pub fn gear(name: &str, part: GearPart, why: impl Into<Reason>) -> Self {
        let name = name.into();
        Self::about(Subject::Gear { name, part }, why)
    }

    /// An error about a mesh, by the names of its gears.
    pub fn mesh(gears: [&str; 2], part: MeshPart, why: impl Into<Reason>) -> Self {
        let gears = gears.map(str::to_owned);
        Self::about(Subject::Mesh { gears, part }, why)
    }

    /// An error about a shaft.
    pub fn shaft(name: &str, why: impl Into<Reason>) -> Self {
        let name = name.into();
        Self::about(Subject::Shaft { name }, why)
    }

    /// An error about a model's parameter.
    pub fn parameter(model: &str, key: &str, why: impl Into<Reason>) -> Self {
        Self::of_parameter(model, key, false, why)
    }

    /// A parameter has to be given; `help` says where to find it.
    pub fn missing(model: &str, key: &str, help: &str) -> Self {
        Self::of_parameter(model, key, true, ("is missing", help))
    }

    /// The same, of a parameter that a gear takes.
    #[must_use]
    pub fn of_gear(mut self, name: &str) -> Self {
        if let Subject::Parameter { gear, .. } = &mut *self.subject {
            *gear = Some(name.to_owned());
        }
        self
    }

    /// Something is not given that has to be.
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
