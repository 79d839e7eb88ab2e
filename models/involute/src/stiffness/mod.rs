//! Stiffness of one tooth pair along the path of contact, and the material of the gears.
//!
//! Computes from two gears and their material a curve `k(s)` (N/m) over the path coordinate `s` (see
//! [`crate::geometry`]), for the whole face width and for the gap along the normal of the flanks. In a spur pair that
//! is the line of action; in a helical one the gap is `cos(beta_b)` of the approach in the transverse plane, and so is
//! the part of the force there, so that the stiffness of the mesh in that plane is `cos^2(beta_b) k`. Elastic helical
//! gears agree (within 2 % up to 30 degrees). The compliances of a pair are in series,
//!
//! ```text
//! 1/k = 1/k_tooth1 + 1/k_body1 + 1/k_tooth2 + 1/k_body2 + 1/k_Hertz
//! ```
//!
//! and the pairs in contact share the load ([`mesh_stiffness`]). A stiffness always says whether it is that
//! of a pair or of the mesh ([`PairOrMesh`]): published values called "c" are both. A helical mesh is cut
//! into slices by the caller, each with its share of the width of the transverse curve; only the ISO
//! value contains `cos(beta)`.
//!
//! The pairs in contact deform the same two gear bodies: the approach of a pair is that of the series under its own
//! force and, for the force of each neighbour, a compliance through the common bodies ([`StiffnessCurve::coupling`];
//! module `ring`). [`mesh_stiffness`] and [`load_shares`] solve for both. Only analytic compliances include the
//! coupling. ISO 6336-1 gives a mean mesh stiffness `c_gamma_alpha = c' (0.75 epsilon_alpha + 0.25)`, which is less
//! than the sum of its pairs: the curve through it ([`IsoVariation::IsoMean`]) has the coupling in its mean and no
//! coupling of its own (the other two curves through c' leave it out). Tables are stiffnesses of pairs in parallel.
//!
//! Rack teeth are treated like gear teeth with their own profile and a body supported at its back. The fit of Sainsot
//! and Velex does not exist for a rack and is left out (with a warning). Teeth of internal gears are treated likewise,
//! on a rim that is supported outside (in place of the fit of Sainsot and Velex, too, with a warning); ISO 6336-1
//! treats an internal gear as a rack.
//!
//! | module | owns |
//! |---|---|
//! | [`mod@iso6336`] | c', c_gamma_alpha and their variation along the path |
//! | [`tooth`] | beam compliance of a tooth from its outline |
//! | [`foundation`] | compliance of the body under a tooth |
//! | `ring` | compliance of the body between teeth, bore and torsion of the disc included |
//! | [`hertz`] | line contact |
//! | [`pair`] | the series of all of them, as a table |
//! | [`path`] | the path of contact, and the pairs along it in parallel |
//! | [`curve`] | stiffness and coupling over the path, in constant time |

pub mod curve;
mod error;
pub mod foundation;
pub mod hertz;
pub mod iso6336;
mod material;
pub mod pair;
pub mod path;
mod ring;
mod spline;
pub mod tooth;

use std::f64::consts::PI;

pub use curve::{PairOrMesh, StiffnessCurve};
pub use error::{Property, StiffnessError, StiffnessWarning};
pub use foundation::{Foundation, RootLength};
pub use hertz::Hertz;
pub use iso6336::{Iso6336, IsoGear, IsoInput, IsoVariation, N_PER_MM_UM, iso6336};
pub use material::Material;
pub use pair::{ComplianceRow, Coupling, compliance_table};
pub use path::{Path, load_shares, mesh_stiffness};
pub use spline::{Ends, Interpolation};
pub use tooth::ToothModel;

use crate::geometry::{Gear, Mate, Pair};

/// Number of points at which a computed curve is sampled before it is interpolated.
const SAMPLES: usize = 97;

/// Specification of the stiffness of a tooth pair.
#[derive(Debug, Clone, PartialEq)]
pub enum PairStiffness {
    /// Constant stiffness along the path.
    Constant {
        /// Stiffness per face width (N/m per m); 1 N/(mm um) is 1e9.
        per_width: f64,
        /// Reference of the stiffness: a pair, or the mesh.
        of: PairOrMesh,
    },
    /// A parabola along the path, `k (1 + a xi + b xi^2)`, with `xi` from -1 at its start to 1 at its end.
    Parabola {
        /// Stiffness per face width in the middle of the path, `k` (N/m per m).
        per_width: f64,
        /// Slope `a` and curvature `b`.
        along: [f64; 2],
        /// Reference of the stiffness: a pair, or the mesh.
        of: PairOrMesh,
    },
    /// ISO 6336-1, solid gear bodies.
    Iso6336 {
        /// Curve through the values of the standard.
        variation: IsoVariation,
    },
    /// Tooth, foundation and Hertz contact in series.
    Compliance {
        /// Tooth above its root section.
        tooth: ToothModel,
        /// Model of the body below the tooth.
        foundation: Foundation,
        /// Model of the line contact.
        hertz: Hertz,
    },
    /// A table of the user, for the whole face width.
    Table {
        /// Path coordinates (m), increasing.
        s: Vec<f64>,
        /// Stiffness at these coordinates (N/m).
        k: Vec<f64>,
        /// Reference of the stiffness: a pair, or the mesh.
        of: PairOrMesh,
        /// Continuation outside the table.
        ends: Ends,
        /// Interpolation between its points.
        interpolation: Interpolation,
    },
}

impl PairStiffness {
    /// Returns the name in scenes and reports.
    pub fn id(&self) -> &'static str {
        match self {
            PairStiffness::Constant { .. } => "constant",
            PairStiffness::Parabola { .. } => "parabola",
            PairStiffness::Iso6336 { .. } => "iso6336",
            PairStiffness::Compliance { .. } => "compliance",
            PairStiffness::Table { .. } => "table",
        }
    }

    /// Returns a one-line description for reports, including conventions.
    pub fn describe(&self) -> String {
        let of = |of: &PairOrMesh| match of {
            PairOrMesh::Pair => "tooth pair",
            PairOrMesh::Mesh => "mesh",
        };
        match self {
            PairStiffness::Constant { per_width, of: o } => {
                format!(
                    "constant, {:.4} N/(mm um) of the {}",
                    per_width / N_PER_MM_UM,
                    of(o)
                )
            }
            PairStiffness::Parabola {
                per_width,
                along: [a, b],
                of: o,
            } => format!(
                "parabola, {:.4} N/(mm um) of the {} in the middle of the path, slope {a:.4}, curvature {b:.4}",
                per_width / N_PER_MM_UM,
                of(o)
            ),
            PairStiffness::Iso6336 { variation } => match variation {
                IsoVariation::IsoMean => {
                    "ISO 6336-1 c', parabola with the norm's mean mesh stiffness".to_owned()
                }
                IsoVariation::CaiHayashi => "ISO 6336-1 c', parabola of Cai and Hayashi".to_owned(),
                IsoVariation::Constant => "ISO 6336-1 c', constant".to_owned(),
            },
            PairStiffness::Compliance {
                tooth,
                foundation,
                hertz,
            } => {
                let load = match hertz {
                    Hertz::Log { reference_load } | Hertz::WeberBanaschek { reference_load } => {
                        match reference_load {
                            Some(load) => format!(" at {load} N"),
                            None => format!(" at {} N/mm", hertz::USUAL_LOAD / 1e3),
                        }
                    }
                    Hertz::Linear | Hertz::Rigid => String::new(),
                };
                format!(
                    "tooth {}; foundation {}; Hertz {}{load}",
                    tooth.id(),
                    foundation.describe(),
                    hertz.id()
                )
            }
            PairStiffness::Table { s, of: o, .. } => {
                format!("table of {} points of the {}", s.len(), of(o))
            }
        }
    }
}

/// A stiffness curve, and the warnings of its construction.
#[derive(Debug, Clone, PartialEq)]
pub struct BuiltStiffness {
    /// The curve over the path coordinate.
    pub curve: StiffnessCurve,
    /// Limits of the formulas that are exceeded.
    pub warnings: Vec<StiffnessWarning>,
}

/// Builds the stiffness of a gear and its mate with the common face width `width` (m). Warnings are dropped, see
/// [`build_with_warnings`].
///
/// # Errors
/// [`StiffnessError`] names the value or the formula that fails.
pub fn build<'a>(
    spec: &PairStiffness,
    gear: &Gear,
    mate: impl Into<Mate<'a>>,
    pair: &Pair,
    materials: [Material; 2],
    width: f64,
) -> Result<StiffnessCurve, StiffnessError> {
    build_with_warnings(spec, gear, mate, pair, materials, width).map(|b| b.curve)
}

/// Builds the stiffness of a gear and its mate, with warnings.
///
/// # Errors
/// [`StiffnessError`] names the value or the formula that fails.
pub fn build_with_warnings<'a>(
    spec: &PairStiffness,
    gear: &Gear,
    mate: impl Into<Mate<'a>>,
    pair: &Pair,
    materials: [Material; 2],
    width: f64,
) -> Result<BuiltStiffness, StiffnessError> {
    let mate = mate.into();
    error::positive("face width [m]", width)?;
    let path = Path::from(pair);
    path.check()?;
    let mut warnings = Vec::new();
    let curve = match spec {
        PairStiffness::Constant { per_width, of } => {
            error::positive("stiffness per width [N/m per m]", *per_width)?;
            StiffnessCurve::constant(per_width * width, *of)?
        }
        PairStiffness::Parabola {
            per_width,
            along,
            of,
        } => {
            error::positive("stiffness per width [N/m per m]", *per_width)?;
            parabola(per_width * width, *along, *of, &path)?
        }
        PairStiffness::Iso6336 { variation } => {
            let iso = iso_of(gear, (mate, pair), materials)?;
            warnings = iso.warnings;
            let drop = variation.drop_at_ends(path.contact_ratio());
            parabola(iso.c_prime * width, [0.0, -drop], PairOrMesh::Pair, &path)?
        }
        PairStiffness::Compliance {
            tooth,
            foundation,
            hertz,
        } => {
            let model = (*tooth, *foundation, *hertz);
            let table = compliance_table(gear, (mate, pair), model, materials, width, SAMPLES)?;
            warnings = table.warnings;
            let (s, k): (Vec<f64>, Vec<f64>) =
                table.rows.iter().map(|r| (r.s, r.stiffness())).unzip();
            let mut curve = StiffnessCurve::interpolate(
                &s,
                &k,
                PairOrMesh::Pair,
                Ends::Clamped,
                Interpolation::Cubic,
            )?;
            for c in &table.coupling {
                curve.couple(&c.s, &c.compliance)?;
            }
            curve
        }
        PairStiffness::Table {
            s,
            k,
            of,
            ends,
            interpolation,
        } => {
            let curve = StiffnessCurve::interpolate(s, k, *of, *ends, *interpolation)?;
            check_table(&curve, *ends, &path, &mut warnings);
            curve
        }
    };
    Ok(BuiltStiffness { curve, warnings })
}

/// Returns the ISO 6336-1 values of a gear and its mate, with solid bodies.
///
/// # Errors
/// [`StiffnessError`] names the value or the formula that fails.
pub fn iso_of(
    gear: &Gear,
    (mate, pair): (Mate<'_>, &Pair),
    materials: [Material; 2],
) -> Result<Iso6336, StiffnessError> {
    for m in &materials {
        m.check()?;
    }
    let p = gear.params();
    // The norm takes an internal gear for a rack.
    let iso_gear = |g: &Gear| IsoGear {
        virtual_teeth: match g.is_internal() {
            true => f64::INFINITY,
            false => {
                IsoGear::virtual_teeth_of(g.teeth(), g.params().helix_angle, g.base_helix_angle())
            }
        },
        profile_shift: g.params().profile_shift,
        dedendum: match g.is_internal() {
            true => (g.r_root() - g.r_reference()) / g.params().module + g.params().profile_shift,
            false => g.params().dedendum,
        },
    };
    let two = match mate {
        Mate::Gear(two) => iso_gear(two),
        Mate::Rack(rack) => IsoGear {
            virtual_teeth: f64::INFINITY,
            profile_shift: 0.0,
            dedendum: rack.params().dedendum,
        },
    };
    iso6336(&IsoInput {
        gears: [iso_gear(gear), two],
        pressure_angle: p.pressure_angle,
        helix_angle: p.helix_angle,
        contact_ratio: pair.contact_ratio(),
        young: materials.map(|m| m.young),
        body_factor: 1.0,
    })
}

/// Builds `k (1 + a xi + b xi^2)` with `k` (N/m) in the middle of the path, where `xi` is 0; three points define it
/// exactly. It is constant beyond the ends of the path.
fn parabola(
    k: f64,
    [slope, curvature]: [f64; 2],
    of: PairOrMesh,
    path: &Path,
) -> Result<StiffnessCurve, StiffnessError> {
    if slope == 0.0 && curvature == 0.0 {
        return StiffnessCurve::constant(k, of);
    }
    let factor = |xi: f64| 1.0 + xi * (slope + curvature * xi);
    // Least at an end, or where it is level between them.
    let level = -0.5 * slope / curvature;
    let level = if level.abs() < 1.0 { level } else { 1.0 };
    let least = [-1.0, 1.0, level].map(factor);
    if !least.iter().all(|x| x.is_finite() && *x > 0.0) {
        return Err(StiffnessError::Parabola { slope, curvature });
    }
    let (s, values): (Vec<f64>, Vec<f64>) = [-1.0, 0.0, 1.0]
        .map(|xi: f64| {
            let s = 0.5 * (path.start + path.end) + 0.5 * xi * (path.end - path.start);
            (s, k * factor(xi))
        })
        .into_iter()
        .unzip();
    StiffnessCurve::interpolate(&s, &values, of, Ends::Clamped, Interpolation::Cubic)
}

fn check_table(
    curve: &StiffnessCurve,
    ends: Ends,
    path: &Path,
    warnings: &mut Vec<StiffnessWarning>,
) {
    let Some([first, last]) = curve.range() else {
        return;
    };
    let slack = 1e-6 * (path.end - path.start);
    match ends {
        Ends::Clamped if first > path.start + slack || last < path.end - slack => {
            warnings.push(StiffnessWarning::TableShort {
                table: [first, last],
                path: [path.start, path.end],
            });
        }
        Ends::Periodic if ((last - first) / path.base_pitch - 1.0).abs() > 1e-3 => {
            warnings.push(StiffnessWarning::TablePeriod {
                period: last - first,
                base_pitch: path.base_pitch,
            });
        }
        Ends::Clamped | Ends::Periodic => {}
    }
}

/// Returns the stiffness per width (N/m per m) of the linear Hertz contact of two equal bodies, `pi E / (4 (1 -
/// nu^2))`, which no tooth pair can exceed.
pub fn hertz_limit(material: &Material) -> f64 {
    PI * material.plane_strain() / 4.0
}

#[cfg(test)]
mod coupling_tests;
#[cfg(test)]
mod internal_tests;
#[cfg(test)]
mod parabola_tests;
#[cfg(test)]
mod reference_tests;
