//! Sparse stiffness and mass of a whole mesh, and the rigid tie of its bore to the hub.
