//! Loaded tooth contact: load sharing, mesh stiffness, transmission error.
