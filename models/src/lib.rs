//! Gear geometry, gear models, contact, mounts and the assembled scene of gearbench.
//!
//! What differs between the fidelities is which coordinates a gear has, where its contact points are and
//! how soft each point is; that is the trait [`gear::GearModel`]. Everything else is common: one search
//! finds candidate points between any two gears ([`contact::search`]), one set of laws gives the normal
//! force ([`contact::law`]), one solve serves all points that share a compliance ([`contact::solve`]), and
//! one scene assembles gears, mounts, loads and meshes into a second-order system ([`scene::Scene`]).
//!
//! | room | owns |
//! |---|---|
//! | [`geometry`] | involute gears, racks, pairs and their derived quantities |
//! | [`stiffness`] | stiffness of a tooth pair along the path of contact |
//! | [`contact`] | search, gap, contact laws, friction, contact solve |
//! | [`gear`] | the trait and the gear models; [`gear::table`] lists them |
//! | [`mount`], [`load`] | how a hub may move and what drives it |
//! | [`scene`] | the assembled system |
//!
//! Conventions, stated once: SI units; the axis of every gear is z, angles count counter-clockwise;
//! `Left` is the counter-clockwise side of a tooth; the gap `g` is positive when open; the contact row is
//! `w = dg/dq`, and a normal force `N >= 0` adds `w N` to the generalised forces.

mod cholesky;
pub mod contact;
pub mod gear;
pub mod geometry;
pub mod load;
pub mod mount;
pub mod scene;
pub mod stiffness;

/// Position or direction in space [m or -].
pub type Vec3 = nalgebra::Vector3<f64>;
