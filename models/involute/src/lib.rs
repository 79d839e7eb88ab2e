//! Involute gears by themselves: geometry, stiffness of teeth, and laws of contact.
//!
//! The crate has no knowledge of scenes, gear models or time integration. `gearbench-models` builds those on it and
//! passes its modules on under the same names.
//!
//! | module | owns |
//! |---|---|
//! | [`geometry`] | involute gears, racks, pairs and their derived quantities; flanks as grids of nodes |
//! | [`stiffness`] | stiffness of a tooth pair along the path of contact; the material |
//! | [`law`] | laws of normal force and of friction, with lubricating films |
//! | [`error`] | cause of an error and its remedy |
//!
//! Conventions: SI units; the axis of every gear is z, angles count counter-clockwise; `Left` is the counter-clockwise
//! side of a tooth; a gap is positive when open. [`geometry`] has the details.
//!
//! # Example
//!
//! Contact ratio and mesh stiffness of a spur pair, against the closed form and the mean value of ISO 6336-1:
//!
//! ```
//! use gearbench_involute::geometry::{Gear, GearParams, Mate, Pair};
//! use gearbench_involute::stiffness::{
//!     IsoVariation, Material, PairStiffness, build, iso_of, mesh_stiffness,
//! };
//!
//! let gear = |teeth| Gear::new(GearParams { teeth, module: 4e-3, ..GearParams::default() });
//! let (pinion, wheel) = (gear(20)?, gear(30)?);
//! let pair = Pair::new(&pinion, &wheel, 0.1)?;
//!
//! let alpha = 20f64.to_radians();
//! let roll = |teeth: f64| (teeth / 2.0 + 1.0).powi(2) - (teeth / 2.0 * alpha.cos()).powi(2);
//! let path = roll(20.0).sqrt() + roll(30.0).sqrt() - 25.0 * alpha.sin();
//! let closed_form = path / (std::f64::consts::PI * alpha.cos());
//! assert!((pair.contact_ratio() - closed_form).abs() < 1e-12);
//!
//! let steel = [Material::STEEL_ISO; 2];
//! let spec = PairStiffness::Iso6336 { variation: IsoVariation::IsoMean };
//! let curve = build(&spec, &pinion, &wheel, &pair, steel, 10e-3)?;
//! let iso = iso_of(&pinion, (Mate::Gear(&wheel), &pair), steel)?;
//! let pitch = pair.base_pitch();
//! let positions = (0..1000).map(|i| pair.s_start() + pitch * (f64::from(i) + 0.5) / 1000.0);
//! let mean = positions.map(|s| mesh_stiffness(&curve, &pair, s)).sum::<f64>() / 1000.0;
//! assert!((mean / (iso.c_gamma_alpha * 10e-3) - 1.0).abs() < 1e-3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod error;
pub mod geometry;
pub mod law;
pub mod stiffness;

/// Position [m] or direction [-] in space.
pub type Vec3 = nalgebra::Vector3<f64>;
