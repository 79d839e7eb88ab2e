//! The full-order gear model `fe`.
