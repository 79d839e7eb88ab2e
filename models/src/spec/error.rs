//! Why a scene cannot be assembled.

/// Why a scene cannot be assembled.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{subject}: {message}")]
pub struct BuildError {
    /// What the error is about, a gear, a mesh or `gear NAME, parameter KEY`.
    pub subject: String,
    /// Gear it concerns, if one.
    pub gear: Option<String>,
    /// Parameter it concerns, if one.
    pub parameter: Option<String>,
    /// What is wrong and a way out.
    pub message: String,
}

impl BuildError {
    /// An error about a gear.
    pub fn gear(name: &str, message: impl Into<String>) -> Self {
        BuildError {
            subject: format!("gear `{name}`"),
            gear: Some(name.into()),
            parameter: None,
            message: message.into(),
        }
    }

    /// An error about a model's parameter.
    pub fn parameter(model: &str, key: &str, message: impl Into<String>) -> Self {
        BuildError {
            subject: format!("model `{model}`, parameter `{key}`"),
            gear: None,
            parameter: Some(key.into()),
            message: message.into(),
        }
    }

    /// An error about a mesh.
    pub fn mesh(a: &str, b: &str, message: impl Into<String>) -> Self {
        BuildError {
            subject: format!("mesh of `{a}` and `{b}`"),
            gear: None,
            parameter: None,
            message: message.into(),
        }
    }
}
