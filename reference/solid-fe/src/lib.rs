//! Solid finite elements for linear dynamics: meshes, matrices, sparse solves, modes.
//!
//! The crate has no knowledge of gears in a scene. It takes two small types from `gearbench-involute`: the [`Material`]
//! and the cells of surfaces for pictures.
//!
//! | module | owns |
//! |---|---|
//! | [`mesh`] | meshes of hexahedra, wedges and tetrahedra, their surface and quality, files for ParaView |
//! | [`element`] | stiffness and mass of one element |
//! | [`assembly`] | sparse stiffness and mass of a mesh, a bore tied to a rigid hub |
//! | [`solve`] | sparse Cholesky factors: nested dissection, supernodes, sweeps |
//! | [`modes`] | modes by block Lanczos with a proof that none is missing, and by cyclic symmetry |
//! | [`limits`] | limit of memory of a thread |
//! | [`vector`], [`hash`] | rotation about z; mixing of bits |
//!
//! Conventions: SI units; coordinates of a mesh are `3 node + axis`; symmetric matrices are lower triangles in compressed
//! columns with sorted rows.
//!
//! # Example
//!
//! The first bending frequency of a clamped steel beam, against that of Euler and Bernoulli:
//!
//! ```
//! use gearbench_solid_fe::assembly::assemble;
//! use gearbench_solid_fe::assembly::tie::{MassKind, Tie};
//! use gearbench_solid_fe::mesh::{ElementKind, brick};
//! use gearbench_solid_fe::modes::{Options, lowest};
//! use gearbench_solid_fe::Material;
//!
//! let (length, height, steel) = (0.2, 0.004, Material::STEEL);
//! let mesh = brick(ElementKind::C3D20, [20, 1, 1], [length, height, 2.0 * height]);
//! let clamped: Vec<u32> = (0..).zip(&mesh.nodes).filter(|(_, x)| x.x == 0.0).map(|(n, _)| n).collect();
//!
//! let tie = Tie::new(&mesh.nodes, &clamped, &[]);
//! let matrices = tie.reduce(&assemble(&mesh, &steel)?, &[], MassKind::Consistent);
//! let modes = lowest(&matrices, 3, &Options::default())?;
//!
//! let speed = (steel.young / (12.0 * steel.density)).sqrt() * height;
//! let beam = 1.8751_f64.powi(2) * speed / (std::f64::consts::TAU * length * length);
//! assert!((modes.frequencies()[0] / beam - 1.0).abs() < 0.01);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod assembly;
pub mod element;
pub mod hash;
pub mod limits;
pub mod mesh;
pub mod modes;
pub mod solve;
#[cfg(test)]
mod test_support;
pub mod vector;

pub use gearbench_involute::Vec3;
pub use gearbench_involute::stiffness::Material;
