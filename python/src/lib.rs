//! Extension module `gearbench._native` of the Python package gearbench.
//!
//! With the feature `extension` it has the functions and classes on which the Python modules of the package are built;
//! without it the library is empty, so that builds and tests of the workspace need no Python.
//!
//! | module | owns |
//! |---|---|
//! | `records` | records of studies as Python objects: a dataclass for each type, an array for each list of numbers |
//! | `values` | values of Python as TOML, and the reverse |
//! | `scenes` | scenes: read, written, checked, changed |
//! | `studies` | studies by name with their arguments, progress and interruption |
//! | `laws` | contact laws that are functions of Python |
//! | `simulation` | runs of one model under one integrator |
//! | `errors` | errors as exceptions with message, line and help |

#[cfg(feature = "extension")]
mod native;
