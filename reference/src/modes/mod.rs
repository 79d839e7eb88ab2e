//! Eigenmodes: shift-invert block Lanczos, and cyclic symmetry.
