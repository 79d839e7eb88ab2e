//! Gear geometry, gear models, contact and the assembled scene of gearbench.
//!
//! What differs between the fidelities is which coordinates a gear has, where its contact points are and
//! how soft each point is; that is the trait [`gear::GearModel`]. Everything else is common: one search
//! finds candidate points between any two gears ([`contact`]), one set of laws gives the normal force ([`law`]), and
//! one scene assembles gears, mounts, loads and meshes into a second-order system ([`scene::Scene`]).
//!
//! Modules in layers: each imports those above it in this table only. The crate [`gearbench_involute`] owns `geometry`,
//! `stiffness` and `law`; they have their names here as well, and so has its [`Vec3`].
//!
//! | module | owns |
//! |---|---|
//! | [`error`] | why something cannot be built: what it is about, cause, way out |
//! | [`geometry`] | involute gears, racks, pairs and their derived quantities; flanks as grids of nodes |
//! | [`stiffness`] | stiffness of a tooth pair along the path of contact |
//! | [`law`] | laws of normal force and of friction |
//! | [`spec`] | what a scene is made of: bodies, mounts, loads, meshes, contacts; why it is refused |
//! | [`kinematics`] | teeth and points, poses, hubs, rows over the coordinates |
//! | [`gear`] | the trait and the gear models; [`gear::table`] lists them |
//! | [`contact`] | search for candidate points, gaps, contact of nodes |
//! | [`scene`] | the assembled system |
//!
//! Conventions, stated once: SI units; the axis of every gear is z, angles count counter-clockwise;
//! `Left` is the counter-clockwise side of a tooth; the gap `g` is positive when open; the contact row is
//! `w = dg/dq`, and a normal force `N >= 0` adds `w N` to the generalised forces.

mod cholesky;
pub mod contact;
pub mod error;
pub mod gear;
pub mod kinematics;
pub mod scene;
pub mod spec;

pub use gearbench_involute::{Vec3, geometry, law, stiffness};
