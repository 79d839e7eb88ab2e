//! Loaded tooth contact: load sharing, mesh stiffness, transmission error of two gears, or of gear and rack.
//!
//! Statics goes through the same [`Scene`](gearbench_models::scene::Scene) as dynamics, whatever its gear models:
//! both hubs are held at prescribed angles and the bodies between them come to equilibrium
//! ([`gearbench_integrators::equilibrium`](gearbench_integrators::equilibrium())). A gear is set up once, mesh and
//! factor of its clamped stiffness included; positions and loads turn its hub.
//!
//! Conventions, stated once:
//!
//! - **Position** `s` [m]: path coordinate of the reference pair, the one that the scene places at its start, from
//!   the first gear's tangent point towards the second gear, at zero approach. Pair `j` stands at `s + j p_b`.
//! - **Approach** `d` [m]: how far the first gear has turned ahead of the rigid, unmodified flanks in touch, on the line
//!   of action, `d = s_1 + s_2 - L`. Under load it is the static transmission error, the lag of the second gear;
//!   modifications and facets of the flanks are part of it.
//! - **Force** `F` [N]: torque of the contact forces about the first gear's axis over its base radius. That of a
//!   spur gear acts along the line of action; of a helical one it is the part in the transverse plane.
//! - **Stiffness** [N/m]: secant `F / d`, or tangent `dF / dd`. Of a pair: its part of the force over the approach
//!   that all pairs share. Over the face width, 1 N/(mm um) is 1e9 N/m^2.
//! - **Mesh cycle**: one base pitch about the pitch point; means are over the cycle.

mod cycle;
mod loaded;
#[cfg(test)]
mod tests;

pub use cycle::{Load, MeshCycle};
pub use loaded::{LoadedContact, LoadedPair, PairForce, StaticsError};
