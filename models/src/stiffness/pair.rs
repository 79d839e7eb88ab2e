//! The compliances of a tooth pair in series, tabulated along the path of contact, and the pairs in
//! contact in parallel.
//!
//! At the path coordinate `s` the flanks touch at the radii `r_1 = sqrt(r_b1^2 + s^2)` and
//! `r_2 = sqrt(r_b2^2 + (L - s)^2)` and have the curvature radii `s` and `L - s`. A rack is touched at
//! the height `h = D - r_b cos(alpha) - s sin(alpha)` above its reference line and is flat.

use crate::geometry::{Gear, Mate, Pair, Rack};

use super::curve::{PairOrMesh, StiffnessCurve};
use super::error::{StiffnessError, StiffnessWarning, positive};
use super::foundation::{Foundation, Ring};
use super::hertz::{Hertz, HertzPoint};
use super::material::Material;
use super::tooth::{ToothLoad, ToothModel, ToothProfile};

/// The path of contact: what a stiffness curve needs of a pair.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Path {
    /// Start of contact (m).
    pub start: f64,
    /// End of contact (m).
    pub end: f64,
    /// Transverse base pitch, the distance of successive pairs (m).
    pub base_pitch: f64,
}

impl From<&Pair> for Path {
    fn from(pair: &Pair) -> Self {
        Path {
            start: pair.s_start(),
            end: pair.s_end(),
            base_pitch: pair.base_pitch(),
        }
    }
}

impl Path {
    /// Transverse contact ratio.
    pub fn contact_ratio(&self) -> f64 {
        (self.end - self.start) / self.base_pitch
    }

    /// Path coordinates (m) of all pairs in contact when one pair stands at `s` (m).
    pub fn pairs_in_contact(&self, s: f64) -> impl Iterator<Item = f64> + use<> {
        let Path {
            start,
            end,
            base_pitch,
        } = *self;
        let before = ((s - start) / base_pitch).floor();
        let first = s - before * base_pitch;
        (0..)
            .map(move |j| first + f64::from(j) * base_pitch)
            .take_while(move |&at| at <= end)
    }

    pub(super) fn check(&self) -> Result<(), StiffnessError> {
        positive("base pitch [m]", self.base_pitch)?;
        if self.start.is_finite() && self.end.is_finite() && self.end > self.start {
            return Ok(());
        }
        Err(StiffnessError::Path {
            start: self.start,
            end: self.end,
        })
    }
}

/// Stiffness of the mesh (N/m) when one pair stands at `s` (m): the force of all pairs in contact per
/// common approach, or the curve itself when it is that of the mesh.
pub fn mesh_stiffness(curve: &StiffnessCurve, path: impl Into<Path>, s: f64) -> f64 {
    match curve.of() {
        PairOrMesh::Mesh => curve.eval(s).0,
        PairOrMesh::Pair => {
            let at: Vec<f64> = path.into().pairs_in_contact(s).collect();
            pressed_together(curve, &at).iter().sum()
        }
    }
}

/// Path coordinate (m) and share of the load of every pair in contact when one pair stands at `s` (m),
/// flanks without deviations; equal shares for the stiffness of a mesh.
pub fn load_shares(curve: &StiffnessCurve, path: impl Into<Path>, s: f64) -> Vec<(f64, f64)> {
    let at: Vec<f64> = path.into().pairs_in_contact(s).collect();
    let weights = match curve.of() {
        PairOrMesh::Mesh => vec![1.0; at.len()],
        PairOrMesh::Pair => pressed_together(curve, &at),
    };
    let total: f64 = weights.iter().sum();
    at.into_iter()
        .zip(weights.iter().map(|w| w / total))
        .collect()
}

/// Forces (N/m) of the pairs at the path coordinates `at` (m), successive by one base pitch, per common
/// approach: the solution of `C N = 1` with the compliances of the pairs and between them, over the
/// pairs that press.
fn pressed_together(curve: &StiffnessCurve, at: &[f64]) -> Vec<f64> {
    let mut pressing: Vec<usize> = (0..at.len()).collect();
    loop {
        let n = pressing.len();
        let mut c = vec![0.0; n * n];
        for (row, &i) in pressing.iter().enumerate() {
            c[row * n + row] = 1.0 / curve.eval(at[i]).0;
            for (column, &j) in pressing.iter().enumerate().take(row) {
                let (between, _) = curve.coupling(i - j, 0.5 * (at[i] + at[j]));
                c[row * n + column] = between;
                c[column * n + row] = between;
            }
        }
        let mut forces = vec![1.0; n];
        eliminate(&mut c, &mut forces);
        // A pair that its neighbours bend away from its mate carries nothing.
        let lifted = (0..n).min_by(|&i, &j| forces[i].total_cmp(&forces[j]));
        match lifted {
            Some(row) if forces[row] < 0.0 && n > 1 => {
                pressing.remove(row);
            }
            _ => {
                let mut all = vec![0.0; at.len()];
                for (&i, force) in pressing.iter().zip(forces) {
                    all[i] = force;
                }
                return all;
            }
        }
    }
}

/// Gaussian elimination of a small symmetric positive definite system, row by row.
fn eliminate(c: &mut [f64], b: &mut [f64]) {
    let n = b.len();
    for k in 0..n {
        for i in k + 1..n {
            let factor = c[i * n + k] / c[k * n + k];
            for j in k..n {
                c[i * n + j] -= factor * c[k * n + j];
            }
            b[i] -= factor * b[k];
        }
    }
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|j| c[k * n + j] * b[j]).sum();
        b[k] = (b[k] - known) / c[k * n + k];
    }
}

/// Compliances of a tooth pair at one point of the path (m/N), for the whole face width.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ComplianceRow {
    /// Path coordinate (m).
    pub s: f64,
    /// Tooth of gear 1.
    pub tooth1: f64,
    /// Body of gear 1.
    pub foundation1: f64,
    /// Tooth of gear 2 or of the rack.
    pub tooth2: f64,
    /// Body of gear 2 or of the rack.
    pub foundation2: f64,
    /// Line contact.
    pub hertz: f64,
}

impl ComplianceRow {
    /// Compliance of the pair (m/N).
    pub fn pair(&self) -> f64 {
        self.tooth1 + self.foundation1 + self.tooth2 + self.foundation2 + self.hertz
    }

    /// Stiffness of the pair (N/m).
    pub fn stiffness(&self) -> f64 {
        1.0 / self.pair()
    }
}

/// Rows over the path and the warnings met on the way.
#[derive(Debug, Clone, PartialEq)]
pub struct ComplianceTable {
    /// Equally spaced from the start to the end of contact.
    pub rows: Vec<ComplianceRow>,
    /// Limits of the formulas that are not kept.
    pub warnings: Vec<StiffnessWarning>,
}

/// The compliances at `points` (at least two) equally spaced points of the path, for reports.
///
/// # Errors
/// [`StiffnessError`] names the value or the formula that fails.
pub fn compliance_table(
    gear: &Gear,
    mate: (Mate<'_>, &Pair),
    model: (ToothModel, Foundation, Hertz),
    materials: [Material; 2],
    width: f64,
    points: usize,
) -> Result<ComplianceTable, StiffnessError> {
    positive("face width [m]", width)?;
    Path::from(mate.1).check()?;
    table(gear, mate, model, materials, width, points)
}

pub(super) fn table(
    gear: &Gear,
    (mate, pair): (Mate<'_>, &Pair),
    (tooth, foundation, hertz): (ToothModel, Foundation, Hertz),
    materials: [Material; 2],
    width: f64,
    points: usize,
) -> Result<ComplianceTable, StiffnessError> {
    for m in &materials {
        m.check()?;
    }
    let mut warnings = Vec::new();
    let one = Side::of_gear(gear, foundation, materials[0], 1, &mut warnings);
    let two = match mate {
        Mate::Gear(two) => Side::of_gear(two, foundation, materials[1], 2, &mut warnings),
        Mate::Rack(rack) => Side::of_rack(rack, foundation, materials[1], &mut warnings),
    };
    let path = Path::from(pair);
    let last = points.max(2) - 1;
    let rows = (0..=last)
        .map(|i| {
            let s = path.start + (path.end - path.start) * i as f64 / last as f64;
            let load1 = one.profile.load_on_gear(gear, gear.r_base().hypot(s));
            let (load2, curvature) = match mate {
                Mate::Gear(two_gear) => {
                    let s2 = pair.line_length() - s;
                    let r2 = two_gear.r_base().hypot(s2);
                    (two.profile.load_on_gear(two_gear, r2), s2)
                }
                Mate::Rack(rack) => {
                    let (sin, cos) = pair.working_pressure_angle().sin_cos();
                    let height = pair.centre_distance() - gear.r_base() * cos - s * sin;
                    (two.profile.load_on_rack(rack, height), f64::INFINITY)
                }
            };
            let point = HertzPoint {
                curvature: [s, curvature],
                depth: [load1.depth(), load2.depth()],
            };
            Ok(ComplianceRow {
                s,
                tooth1: one.tooth(tooth, width, &load1),
                foundation1: one.body(width, &load1)?,
                tooth2: two.tooth(tooth, width, &load2),
                foundation2: two.body(width, &load2)?,
                hertz: hertz.compliance(&materials, width, &point)?,
            })
        })
        .collect::<Result<Vec<_>, StiffnessError>>()?;
    Ok(ComplianceTable { rows, warnings })
}

/// One gear or rack of a pair: its tooth and its body.
struct Side {
    profile: ToothProfile,
    foundation: Foundation,
    ring: Option<Ring>,
    material: Material,
}

impl Side {
    fn of_gear(
        gear: &Gear,
        foundation: Foundation,
        material: Material,
        number: usize,
        warnings: &mut Vec<StiffnessWarning>,
    ) -> Side {
        let ring = match foundation {
            Foundation::SainsotVelex(convention) => {
                Some(Ring::new(gear, convention, &material, number, warnings))
            }
            _ => None,
        };
        Side {
            profile: ToothProfile::of_gear(gear),
            foundation,
            ring,
            material,
        }
    }

    fn of_rack(
        rack: &Rack,
        foundation: Foundation,
        material: Material,
        warnings: &mut Vec<StiffnessWarning>,
    ) -> Side {
        if matches!(foundation, Foundation::SainsotVelex(_)) {
            warnings.push(StiffnessWarning::RackFoundationOmitted);
        }
        Side {
            profile: ToothProfile::of_rack(rack),
            foundation,
            ring: None,
            material,
        }
    }

    fn tooth(&self, model: ToothModel, width: f64, load: &ToothLoad) -> f64 {
        let from = self.foundation.root_section(&self.profile);
        self.profile
            .compliance(model, &self.material, width, load, from)
    }

    fn body(&self, width: f64, load: &ToothLoad) -> Result<f64, StiffnessError> {
        if let Some(ring) = &self.ring {
            return ring.compliance(&self.material, width, load.beta);
        }
        Ok(self
            .foundation
            .half_plane(&self.profile, &self.material, width, load)
            .unwrap_or(0.0))
    }
}
