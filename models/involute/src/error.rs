//! Cause of an error and its remedy, in separate fields, so that a user interface can place the message.

use std::fmt;

/// Cause of an error and its remedy, as text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Reason {
    /// Text of the cause.
    pub cause: String,
    /// Text of the remedy; empty when the cause implies it.
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

/// Implements text and conversion of errors that store numbers, from their `reason()`.
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
