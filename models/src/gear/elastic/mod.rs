//! The elastic gear: rigid motion of a floating frame, a few modes, and the static compliance of the truncated modes.
//!
//! Generalised coordinates: the turn `theta` of the mean-axis frame where the mount leaves it free (a rack: its
//! displacement), then one coordinate `q_i` per kept mode, shapes orthonormal in the mass. Modes of a hub that is free
//! to move hold no momentum about the mount's axis, so frame and modes are decoupled to first order (A. A. Shabana,
//! *Dynamics of Multibody Systems*, ch. 5; W. Schiehlen, P. Eberhard, *Technische Dynamik*):
//!
//! ```text
//! J theta'' = T + sum_c N_c l_c
//! q_i'' + 2 zeta_i omega_i q_i' + omega_i^2 q_i = h_i T - sum_k b_ki F_k
//! a_k = sum_i b_ki q_i - sum_l R_kl F_l + r_k T
//! ```
//!
//! `a_k` is the outward displacement of flank node `k` from the rigid flank, `b_ki` the shape of mode `i` there, `F_k`
//! the contact force on the node, `h_i` the rotation of the hub by mode `i`, `R` and `r` the residual compliance
//! between the flank nodes and towards the hub. Only displacements along the normals enter a gap: displacements along
//! the flank change it in second order, by `u_t^2 / (2 rho)`, a part in a thousand of the deflection of a steel tooth.
//! For contact on half-spaces the nodes are [`lines`] over strips of the width. Gears at high speed have the
//! centrifugal and Coriolis terms of [`inertia`] as well.

mod body;
pub mod deflated;
mod displaced_mesh;
mod free_flight;
mod gear;
pub mod inertia;
mod kernels;
pub mod lines;
mod out_of_plane;
mod quasi_static;
pub mod reduced;
mod spin;

pub use body::Elastic;
pub use inertia::SpinTerms;
