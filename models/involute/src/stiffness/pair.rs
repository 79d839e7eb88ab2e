//! The compliances of a tooth pair in series, tabulated along the path of contact.
//!
//! At the path coordinate `s` the flanks touch at the radii `r_1 = sqrt(r_b1^2 + s^2)` and
//! `r_2 = sqrt(r_b2^2 + (L - s)^2)` and have the curvature radii `s` and `L - s`. A rack is touched at
//! the height `h = D - r_b cos(alpha) - s sin(alpha)` above its reference line and is flat. Path coordinates, and so radii of
//! curvature, are negative on an internal gear.

use crate::geometry::{Gear, Mate, Pair, Rack};

use super::error::{StiffnessError, StiffnessWarning, positive};
use super::foundation::{Foundation, RingFit};
use super::hertz::{Hertz, HertzPoint};
use super::material::Material;
use super::path::Path;
use super::ring::RingBody;
use super::tooth::{ToothLoad, ToothModel, ToothProfile};

/// Compliances of a tooth pair at one point of the path (m/N), for the whole face width.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ComplianceRow {
    /// Path coordinate (m).
    pub s: f64,
    /// Compliance of the tooth of gear 1.
    pub tooth1: f64,
    /// Compliance of the body of gear 1.
    pub foundation1: f64,
    /// Compliance of the tooth of gear 2 or of the rack.
    pub tooth2: f64,
    /// Compliance of the body of gear 2 or of the rack.
    pub foundation2: f64,
    /// Compliance of the line contact.
    pub hertz: f64,
}

impl ComplianceRow {
    /// Returns the compliance of the pair (m/N).
    pub fn pair(&self) -> f64 {
        self.tooth1 + self.foundation1 + self.tooth2 + self.foundation2 + self.hertz
    }

    /// Returns the stiffness of the pair (N/m).
    pub fn stiffness(&self) -> f64 {
        1.0 / self.pair()
    }
}

/// Compliances over the path, and the warnings of their computation.
#[derive(Debug, Clone, PartialEq)]
pub struct ComplianceTable {
    /// Rows, equally spaced from the start to the end of contact.
    pub rows: Vec<ComplianceRow>,
    /// Compliances between pairs one, two, ... base pitches apart.
    pub coupling: Vec<Coupling>,
    /// Limits of the formulas that are exceeded.
    pub warnings: Vec<StiffnessWarning>,
}

/// Compliance between two pairs a given number of base pitches apart.
#[derive(Debug, Clone, PartialEq)]
pub struct Coupling {
    /// Means of their path coordinates (m), equally spaced where both are on the path.
    pub s: Vec<f64>,
    /// Approach of one pair per force on the other (m/N).
    pub compliance: Vec<f64>,
}

/// Computes the compliances at `points` (at least two) equally spaced points of the path, for reports.
///
/// # Errors
/// [`StiffnessError`] names the value or the formula that fails.
pub fn compliance_table(
    gear: &Gear,
    (mate, pair): (Mate<'_>, &Pair),
    model: (ToothModel, Foundation, Hertz),
    materials: [Material; 2],
    width: f64,
    points: usize,
) -> Result<ComplianceTable, StiffnessError> {
    positive("face width [m]", width)?;
    let path = Path::from(pair);
    path.check()?;
    for m in &materials {
        m.check()?;
    }
    let (tooth, foundation, hertz) = model;
    let pitches = path.contact_ratio().ceil() as usize;
    let mut warnings = Vec::new();
    let one = Side::of_gear(
        gear,
        foundation,
        (materials[0], width),
        pitches,
        1,
        &mut warnings,
    );
    let two = match mate {
        Mate::Gear(two) => Side::of_gear(
            two,
            foundation,
            (materials[1], width),
            pitches,
            2,
            &mut warnings,
        ),
        Mate::Rack(rack) => Side::of_rack(
            rack,
            foundation,
            (materials[1], width),
            pitches,
            &mut warnings,
        ),
    };
    let loads = |s: f64| {
        let first = one.profile.load_on_gear(gear, gear.r_base().hypot(s));
        let (second, curvature) = match mate {
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
        ([first, second], curvature)
    };
    let rows = spaced(path.start, path.end, points)
        .map(|s| {
            let ([load1, load2], curvature) = loads(s);
            let point = HertzPoint {
                curvature: [s, curvature],
                depth: [load1.depth(), load2.depth()],
            };
            Ok(ComplianceRow {
                s,
                tooth1: one.tooth(tooth, &load1),
                foundation1: one.body(&load1)?,
                tooth2: two.tooth(tooth, &load2),
                foundation2: two.body(&load2)?,
                hertz: hertz.compliance(&materials, width, &point)?,
            })
        })
        .collect::<Result<Vec<_>, StiffnessError>>()?;
    let coupling = (1..=pitches)
        .map(|m| {
            let half = 0.5 * m as f64 * path.base_pitch;
            // Neighbours that cannot both be on the path touch beyond its ends, as its ends do.
            let middle = 0.5 * (path.start + path.end);
            let reach = (0.5 * (path.end - path.start) - half).max(1e-3 * half);
            let s: Vec<f64> = spaced(middle - reach, middle + reach, points).collect();
            let compliance = s
                .iter()
                .map(|s| {
                    let on_path = |s: f64| loads(s.clamp(path.start, path.end)).0;
                    let ([a1, a2], [b1, b2]) = (on_path(s - half), on_path(s + half));
                    // The path coordinate of gear 2 runs the other way.
                    Ok(one.between(m, &a1, &b1)? + two.between(m, &b2, &a2)?)
                })
                .collect::<Result<_, StiffnessError>>()?;
            Ok(Coupling { s, compliance })
        })
        .collect::<Result<_, StiffnessError>>()?;
    Ok(ComplianceTable {
        rows,
        coupling,
        warnings,
    })
}

/// Returns `points` (at least two) equally spaced values from `first` to `last`.
fn spaced(first: f64, last: f64, points: usize) -> impl Iterator<Item = f64> {
    let steps = points.max(2) - 1;
    (0..=steps).map(move |i| first + (last - first) * i as f64 / steps as f64)
}

/// One gear or rack of a pair: its tooth and its body.
struct Side {
    profile: ToothProfile,
    foundation: Foundation,
    fit: Option<RingFit>,
    /// Body shared by all teeth; `None` for a rigid one.
    body: Option<RingBody>,
    material: Material,
    width: f64,
}

impl Side {
    fn of_gear(
        gear: &Gear,
        foundation: Foundation,
        (material, width): (Material, f64),
        pitches: usize,
        number: usize,
        warnings: &mut Vec<StiffnessWarning>,
    ) -> Side {
        let fit = match foundation {
            Foundation::SainsotVelex(_) if gear.is_internal() => {
                warnings.push(StiffnessWarning::RimInPlaceOfFit { gear: number });
                None
            }
            Foundation::SainsotVelex(convention) => {
                Some(RingFit::new(gear, convention, &material, number, warnings))
            }
            _ => None,
        };
        Side {
            profile: ToothProfile::of_gear(gear),
            foundation,
            fit,
            body: (foundation != Foundation::Rigid)
                .then(|| RingBody::of_gear(gear, &material, pitches)),
            material,
            width,
        }
    }

    fn of_rack(
        rack: &Rack,
        foundation: Foundation,
        (material, width): (Material, f64),
        pitches: usize,
        warnings: &mut Vec<StiffnessWarning>,
    ) -> Side {
        // The fit has no rack, whose body then has no compliance.
        let none = matches!(foundation, Foundation::SainsotVelex(_) | Foundation::Rigid);
        if matches!(foundation, Foundation::SainsotVelex(_)) {
            warnings.push(StiffnessWarning::RackFoundationOmitted);
        }
        Side {
            profile: ToothProfile::of_rack(rack),
            foundation,
            fit: None,
            body: (!none).then(|| RingBody::of_rack(rack, &material, pitches)),
            material,
            width,
        }
    }

    fn tooth(&self, model: ToothModel, load: &ToothLoad) -> f64 {
        let from = self.foundation.root_section(&self.profile);
        self.profile
            .compliance(model, &self.material, self.width, load, from)
    }

    /// Returns the compliance of the body under one tooth (m/N).
    fn body(&self, load: &ToothLoad) -> Result<f64, StiffnessError> {
        if let Some(fit) = &self.fit {
            return fit.compliance(&self.material, self.width, load.beta);
        }
        Ok(self
            .foundation
            .half_plane(&self.profile, &self.material, self.width, load)
            .unwrap_or_else(|| self.ring(0, load, load)))
    }

    /// Returns the compliance of the elastic ring (m/N) between two teeth `pitches` apart.
    fn ring(&self, pitches: usize, lower: &ToothLoad, upper: &ToothLoad) -> f64 {
        self.body.as_ref().map_or(0.0, |body| {
            let root = |load: &ToothLoad| body.root_load(self.profile.lever(load), load.beta);
            body.between(pitches, &root(lower), &root(upper), self.width)
        })
    }

    /// Returns the compliance of the body between two teeth (m/N): that of the ring, scaled by the compliances of the
    /// chosen formula under either tooth, so that the whole stays positive definite.
    fn between(
        &self,
        pitches: usize,
        lower: &ToothLoad,
        upper: &ToothLoad,
    ) -> Result<f64, StiffnessError> {
        if self.body.is_none() {
            return Ok(0.0);
        }
        let own = |load: &ToothLoad| Ok(self.body(load)? / self.ring(0, load, load));
        let scale: f64 = own(lower)? * own(upper)?;
        Ok(self.ring(pitches, lower, upper) * scale.sqrt())
    }
}
