//! Constants of rigid gears and movable teeth without a fit: from the norm, from analytic tooth compliance, and from
//! static solves of the elastic gears without modes.
//!
//! The last costs some tens of equilibria and no time step. At positions over one base pitch both hubs are held at an
//! approach `d` of the size that the scene will see; the part of the force `F_j` that each tooth pair then carries
//! gives the coefficient of `N = k(s) d^n`, `k = F_j / d^n`, with one exponent `n` from a second approach: the penalty
//! touches on a patch that grows. Pairs carry what they do beside their neighbours, so the sum over the pairs in
//! contact is the mesh stiffness of the elastic gears at every position, coupling through the bodies included.

use super::problem::{ElasticSettings, Problem};
use gearbench_integrators::system::SecondOrderSystem;
use gearbench_models::error::{BuildError, MeshPart, Reason};
use gearbench_models::gear::movable_teeth::{MovableTeethParameters, PerTooth};
use gearbench_models::gear::parameters::ModelParameters;
use gearbench_models::gear::rigid;
use gearbench_models::gear::table::MODELS;
use gearbench_models::law::Damping;
use gearbench_models::scene::Scene;
use gearbench_models::spec::{
    Body, ContactSpec, FlankContact, GearSpec, Modelling, SceneSpec, effective_radius, mesh_layout,
};
use gearbench_models::stiffness::{
    ComplianceRow, Ends, Foundation, Hertz, Interpolation, IsoVariation, PairOrMesh, PairStiffness,
    ToothModel, compliance_table,
};
use gearbench_reference::statics::{LoadedPair, StaticsError};

/// Positions over one base pitch.
const POSITIONS: usize = 24;
/// Approaches that the exponent comes from, over the largest one of the scene.
const APPROACHES: [f64; 2] = [0.4, 0.85];
/// Largest exponent: a point contact of Hertz; more is a misread of a few points.
const EXPONENTS: [f64; 2] = [1.0, 1.5];
/// Part of the compliance of a tooth pair that springs of teeth may take.
const IN_TEETH: f64 = 0.8;
/// Mass that moves with the tip of a clamped bar over the mass of the bar.
const BAR: f64 = 33.0 / 140.0;

pub fn norm() -> PairStiffness {
    PairStiffness::Iso6336 {
        variation: IsoVariation::default(),
    }
}

const ANALYTIC: (ToothModel, Foundation, Hertz) = (
    ToothModel::WeberBanaschek,
    Foundation::Ring,
    Hertz::WeberBanaschek {
        reference_load: None,
    },
);

/// Returns the stiffness from analytic compliances of tooth, foundation and contact.
pub fn analytic() -> PairStiffness {
    let (tooth, foundation, hertz) = ANALYTIC;
    PairStiffness::Compliance {
        tooth,
        foundation,
        hertz,
    }
}

/// Returns rigid gears with one contact for each mesh.
pub fn rigid(scene: &SceneSpec, contacts: Vec<ContactSpec>) -> Modelling {
    Modelling {
        gears: vec![rigid::spec(); scene.gears.len()],
        contacts,
    }
}

/// Returns a contact between tooth pairs.
pub fn contact(stiffness: PairStiffness, exponent: f64, damping: Damping) -> ContactSpec {
    ContactSpec {
        stiffness,
        exponent,
        damping,
        normal_force: None,
        friction: None,
        slices: None,
        flanks: FlankContact::Toothing,
    }
}

/// Origin of the contact stiffness between rigid gears.
#[derive(Clone, Copy, Debug)]
pub enum Source<'a> {
    Norm,
    Analytic,
    Static(&'a StaticPairStiffness),
}

impl Source<'_> {
    /// Returns the contact with a damper of the relaxation time `tau` [s].
    pub fn contact(self, tau: f64, oscillator: &MeshOscillator) -> ContactSpec {
        match self {
            Source::Norm => contact(norm(), 1.0, damper(tau, oscillator.stiffness)),
            Source::Analytic => contact(analytic(), 1.0, damper(tau, oscillator.stiffness)),
            Source::Static(c) => contact(c.stiffness(), c.exponent, damper(tau, c.secant())),
        }
    }
}

/// Returns the damper of a tooth pair with a stiffness [N/m] and the relaxation time `tau` [s].
pub fn damper(tau: f64, stiffness: f64) -> Damping {
    if tau > 0.0 {
        Damping::KelvinVoigt { c: tau * stiffness }
    } else {
        Damping::None
    }
}

/// Mesh of rigid gears with the stiffness of ISO 6336 as an oscillator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshOscillator {
    /// Reduced mass along the line of action [kg].
    pub mass: f64,
    /// Stiffness of a tooth pair [N/m].
    pub stiffness: f64,
}

impl MeshOscillator {
    /// Computes the oscillator of the stiffest mesh of a scene.
    pub fn of(scene: &SceneSpec) -> Result<MeshOscillator, BuildError> {
        let contacts = vec![contact(norm(), 1.0, Damping::None); scene.meshes.len()];
        let built = Scene::build(scene, &rigid(scene, contacts), MODELS)?;
        let characteristic_time = built.characteristic_time(built.initial().at());
        let mass = |i: usize| built.gears()[i].model.hub().contact_mass;
        let of = |m: &gearbench_models::spec::MeshSpec| {
            1.0 / m.gears.map(|i| 1.0 / mass(i)).iter().sum::<f64>()
        };
        let mass = scene.meshes.iter().map(of).fold(f64::INFINITY, f64::min);
        // Between held gears nothing vibrates; the stiffness is then that of a unit mass.
        let mass = if mass.is_finite() { mass } else { 1.0 };
        Ok(MeshOscillator {
            mass,
            stiffness: mass / (characteristic_time * characteristic_time),
        })
    }

    /// Returns the inverse of the angular frequency, `sqrt(m/k)` [s].
    pub fn lag(&self) -> f64 {
        (self.mass / self.stiffness).sqrt()
    }

    /// Returns half a period, the contact time of a tooth pair in an impact [s].
    pub fn contact_time(&self) -> f64 {
        std::f64::consts::PI * self.lag()
    }
}

/// Returns the relaxation time `tau = c/k` of the damper of a tooth pair [s]; `None` for laws that are no dampers.
pub fn relaxation_of(scene: &SceneSpec, contact: &ContactSpec) -> Option<f64> {
    let oscillator = MeshOscillator::of(scene).ok()?;
    match contact.damping {
        Damping::None => Some(0.0),
        Damping::KelvinVoigt { c } | Damping::KelvinVoigtBounded { c } => {
            Some(c / oscillator.stiffness)
        }
        Damping::KelvinVoigtRatio { ratio } => {
            Some(2.0 * ratio * (oscillator.mass / oscillator.stiffness).sqrt())
        }
        _ => None,
    }
}

/// Stiffness of a tooth pair from static solves.
#[derive(Clone, Debug, PartialEq)]
pub struct StaticPairStiffness {
    /// Path coordinates of the table [m], ascending.
    pub s: Vec<f64>,
    /// Coefficients at the path coordinates [N/m^n].
    pub k: Vec<f64>,
    /// Exponent `n` of the force law.
    pub exponent: f64,
    /// Largest approach for which the table is valid [m].
    pub approach: f64,
    /// Equilibria and Newton iterations of the calibration.
    pub work: [u64; 2],
}

impl StaticPairStiffness {
    /// Returns the table as the stiffness of a contact.
    pub fn stiffness(&self) -> PairStiffness {
        table(self.s.clone(), self.k.clone())
    }

    /// Returns the secant stiffness of the pair in the middle of the path at the largest approach [N/m].
    pub fn secant(&self) -> f64 {
        self.k[self.k.len() / 2] * self.approach.powf(self.exponent - 1.0)
    }
}

fn table(s: Vec<f64>, k: Vec<f64>) -> PairStiffness {
    PairStiffness::Table {
        s,
        k,
        of: PairOrMesh::Pair,
        ends: Ends::Clamped,
        interpolation: Interpolation::Linear,
    }
}

/// Solves elastic gears without modes at an approach of the flanks that the scene will see [m].
///
/// # Errors
/// [`StaticsError`]: more than one mesh, no equilibrium, or no pair that presses on the path.
pub fn calibrate(
    problem: &Problem,
    of: &ElasticSettings,
    approach: f64,
) -> Result<StaticPairStiffness, StaticsError> {
    let modelling = super::plan::elastic(of, 0, None);
    let mut pair = LoadedPair::new(&problem.scene, &modelling, &problem.context.models)?;
    let (pitch, base, path) = {
        let l = pair.layout();
        (l.pitch_point, l.base_pitch, l.path)
    };
    // The contact law is that along the normal of the flanks, statics are those of the transverse plane.
    let first = problem.scene.meshes[0].gears[0];
    let cos = problem.scene.gears[first].body.base_helix_angle().cos();
    let [low, high] = APPROACHES.map(|part| part * approach / cos);
    let mut exponents = Vec::new();
    // Path coordinate and force of every pair at the larger approach.
    let mut forces: Vec<(f64, f64)> = Vec::new();
    for i in 0..POSITIONS {
        let s = pitch + base * (i as f64 / POSITIONS as f64 - 0.5);
        let small = pair.at_approach(s, low)?;
        let large = pair.at_approach(s, high)?;
        if small.force > 0.0 {
            exponents.push((large.force / small.force).ln() / (high / low).ln());
        }
        for p in &large.pairs {
            let at = s + p.offset as f64 * base;
            // Where teeth touch off the path, rigid ones do not.
            if p.force > 0.0 && at >= path[0] && at <= path[1] {
                forces.push((at, p.force / cos));
            }
        }
    }
    if forces.is_empty() {
        return Err(StaticsError::NoContact { approach: high });
    }
    forces.sort_by(|a, b| a.0.total_cmp(&b.0));
    forces.dedup_by(|b, a| b.0 - a.0 < 1e-9 * base);
    exponents.sort_by(f64::total_cmp);
    let exponent = exponents.get(exponents.len() / 2).copied().unwrap_or(1.0);
    let exponent = exponent.clamp(EXPONENTS[0], EXPONENTS[1]);
    let (s, k) = (forces.into_iter())
        .map(|(s, f)| (s, f / (cos * high).powf(exponent)))
        .unzip();
    Ok(StaticPairStiffness {
        s,
        k,
        exponent,
        approach,
        work: pair.work(),
    })
}

/// Movable teeth of a mesh without a fit: tooth and body compliance at the pitch point go into the springs, what is
/// left of the stiffness along the path into the contact, and a tooth weighs what moves with the tip of a clamped bar
/// of half a pitch and two and a quarter modules. `pair` is the stiffness along the path [m, N/m].
///
/// # Errors
/// A pair that the analytic compliance does not know.
pub fn movable_teeth(
    scene: &SceneSpec,
    pair: Option<&StaticPairStiffness>,
    damping: Damping,
) -> Result<Modelling, BuildError> {
    let [a, b] = scene.meshes[0].gears.map(|i| &scene.gears[i]);
    let layout = mesh_layout(a, b)?;
    let rows = compliances(a, b, &layout.pair, layout.face_width)?;
    let at_pitch = (rows.iter())
        .min_by(|x, y| {
            let off = |r: &ComplianceRow| (r.s - layout.pitch_point).abs();
            off(x).total_cmp(&off(y))
        })
        .ok_or_else(|| {
            BuildError::mesh(
                [&a.name, &b.name],
                MeshPart::Layout,
                "the path of contact is empty",
            )
        })?;
    // Secant compliance along the path.
    let total: Vec<(f64, f64)> = match pair {
        Some(c) => (c.s.iter().zip(&c.k))
            .map(|(s, k)| (*s, 1.0 / (k * c.approach.powf(c.exponent - 1.0))))
            .collect(),
        None => rows.iter().map(|r| (r.s, r.pair())).collect(),
    };
    let least = total.iter().map(|(_, c)| *c).fold(f64::INFINITY, f64::min);
    let teeth = [
        at_pitch.tooth1 + at_pitch.foundation1,
        at_pitch.tooth2 + at_pitch.foundation2,
    ];
    let part = (IN_TEETH * least / (teeth[0] + teeth[1])).min(1.0);
    let teeth = teeth.map(|c| part * c);
    let (s, k) = (total.into_iter())
        .map(|(s, c)| (s, 1.0 / (c - teeth[0] - teeth[1])))
        .unzip();
    let mut modelling = rigid(scene, vec![contact(table(s, k), 1.0, damping)]);
    for (i, (gear, c)) in [a, b].into_iter().zip(teeth).enumerate() {
        let spring = spring(gear, c);
        modelling.gears[scene.meshes[0].gears[i]] = MovableTeethParameters {
            tooth_stiffness_n_per_m: Some(PerTooth::All(spring)),
            tooth_mass_kg: Some(PerTooth::All(tooth_mass(gear))),
            ..MovableTeethParameters::default()
        }
        .spec();
    }
    Ok(modelling)
}

fn compliances(
    a: &GearSpec,
    b: &GearSpec,
    pair: &gearbench_models::geometry::Pair,
    width: f64,
) -> Result<Vec<ComplianceRow>, BuildError> {
    let error = |part, why: Reason| BuildError::mesh([&a.name, &b.name], part, why);
    let Body::Gear(one) = &a.body else {
        return Err(error(
            MeshPart::Layout,
            "the first gear of a mesh may not be a rack".into(),
        ));
    };
    let materials = [a.material, b.material];
    let mate = ((&b.body).into(), pair);
    compliance_table(one, mate, ANALYTIC, materials, width, 33)
        .map(|t| t.rows)
        .map_err(|e| error(MeshPart::Stiffness, e.reason()))
}

/// Spring of a tooth whose compliance along the line of action is given [N/m], on the radius that it acts at.
fn spring(gear: &GearSpec, compliance: f64) -> f64 {
    let radius = match &gear.body {
        Body::Gear(g) => g.r_root(),
        Body::Rack(_) => 1.0,
    };
    (effective_radius(&gear.body) / radius).powi(2) / compliance
}

fn tooth_mass(gear: &GearSpec) -> f64 {
    let (module, width) = (gear.body.module(), gear.body.face_width());
    let area = 0.5 * std::f64::consts::PI * module * 2.25 * module;
    BAR * gear.material.density * width * area
}
