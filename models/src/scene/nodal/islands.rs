//! Islands of meshes that are solved together, and their buffers.

use crate::Vec3;
use crate::contact::nodal::{
    Block, DissipativeSolve, GearNodes, HardSolve, LineSlope, LineTerms, NodalPoint, NodalPoints,
    NodalSolve, Share, Spring,
};
use crate::gear::HubBody;
use crate::kinematics::{HubPose, Row};
use crate::law::{FrictionForce, LawForce, SeenBy};
use crate::scene::members::{SceneGear, SceneMesh};
use gearbench_integrators::system::{HalfStepImpulse, StateView};

/// A contact point with a force, or possibly with one.
#[derive(Clone, Copy, Debug)]
pub(in crate::scene) struct NodalActive {
    /// Index of the point.
    pub point: usize,
    /// Direction of the force on the slave, not exactly of unit length.
    pub direction: Vec3,
    /// Gap for which the direction was computed [m].
    pub tapered_gap: f64,
    /// Derivative of the gap of a [line](crate::contact::nodal::LineTerms) by the motion of the hubs, which does not
    /// follow from its direction; once forces are distributed, with the change of the energy with the places on the flanks.
    pub of_line: Option<LineSlope>,
    /// Derivative `dg/dtheta` for the hubs of gears that are rigid except for a field, free or not.
    pub effective_radii: [f64; 2],
    /// Gap with residual compliance [m].
    pub gap: f64,
    /// Rate of the gap before residual compliance [m/s]; 0 where no damper needs it.
    pub rate: f64,
    pub force: LawForce,
    /// Derivatives of the gap that the law sees.
    pub seen_by: SeenBy,
    /// Gap [m] and force [N] of the elastic law alone.
    pub elastic: (f64, f64),
    pub sliding: Sliding,
}

/// Sliding of a point; zero without friction.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::scene) struct Sliding {
    /// Direction of friction on the slave, of the length of the point's normal.
    pub direction: Vec3,
    /// Speed of the slave relative to the master along the direction, per unit speed of the hubs of gears that are
    /// rigid except for a field.
    pub effective_radii: [f64; 2],
    /// Sliding speed before residual compliance [m/s].
    pub speed: f64,
    /// Friction on the slave along the direction.
    pub force: FrictionForce,
}

impl NodalActive {
    /// Creates a point before its evaluation.
    pub fn new(point: usize, p: &NodalPoint) -> Self {
        NodalActive {
            point,
            direction: p.normal,
            tapered_gap: 0.0,
            of_line: None,
            effective_radii: [0.0; 2],
            gap: p.gap0,
            rate: 0.0,
            force: LawForce::default(),
            seen_by: SeenBy::default(),
            elastic: (p.gap0, 0.0),
            sliding: Sliding::default(),
        }
    }

    /// Returns the force on the slave [N], including friction.
    pub fn on_slave(&self) -> Vec3 {
        self.force.n * self.direction + self.sliding.force.f * self.sliding.direction
    }

    /// Returns the force on the second gear of the mesh [N], including friction.
    pub fn on_second(&self, p: &NodalPoint) -> Vec3 {
        let on_slave = self.on_slave();
        if p.slave == 0 { -on_slave } else { on_slave }
    }

    /// Returns the generalised force on the hub of a gear of the mesh: torque about the axis [N m], or force along the
    /// motion of a rack [N].
    pub fn on_hub(
        &self,
        (p, lines): (&NodalPoint, &[LineTerms]),
        (hub, at): (&HubBody, StateView<'_>),
        k: usize,
    ) -> f64 {
        if let (Some(_), Some(line)) = (self.of_line, p.line) {
            let with_nodes = self.effective_radii[k] + lines[line as usize].with_nodes[k];
            return with_nodes * self.force.n
                + self.sliding.effective_radii[k] * self.sliding.force.f;
        }
        let on_second = self.on_second(p);
        let force = if k == 0 { -on_second } else { on_second };
        hub.effective_radius_at(at.t, at.q, &p.x, &force)
    }
}

/// Meshes that are solved together, and their gears.
#[derive(Clone, Debug, Default)]
pub(in crate::scene) struct Island {
    pub meshes: Vec<usize>,
    /// Gears with residual compliance.
    pub compliant: Vec<usize>,
    /// Gears with a field, and hubs that are free to move.
    pub fields: Vec<usize>,
    pub hubs: Vec<usize>,
    /// True if a mesh has dashpots or friction.
    pub dissipates: bool,
    /// True if a mesh has dashpots.
    pub damped: bool,
    /// True if a mesh has friction.
    pub slides: bool,
}

/// Result of the solve of an island, for its tangent.
#[derive(Clone, Debug, Default)]
pub(in crate::scene) struct IslandSolution {
    /// Range of its points.
    pub points: std::ops::Range<usize>,
    pub solve: NodalSolve,
    /// Solve of hard contact, used in place of `solve`.
    pub hard: Option<HardSolve>,
    pub springs: Vec<Spring>,
    pub blocks: Vec<Block>,
    pub dissipative: DissipativeSolve,
    /// Ports and [impulse](Nodal::impulse) of the mobility in `dissipative`.
    pub(in crate::scene) mobile: (Vec<u32>, u64),
    /// Residual displacements of the nodes with dissipative forces [m].
    pub(in crate::scene) outward: Vec<f64>,
}

/// Gaps averaged at slave nodes.
#[derive(Default)]
pub(in crate::scene) struct Averages {
    /// Gear, slot, sum of `phi A`, sum of `phi A g`.
    pub(in crate::scene) nodes: Vec<(usize, u32, f64, f64)>,
    /// Node, point, `phi A`.
    pub(in crate::scene) entries: Vec<(usize, usize, f64)>,
    /// Index of each node's constraint, if it has one.
    pub(in crate::scene) number: Vec<Option<u32>>,
    pub(in crate::scene) closed: Vec<bool>,
    pub(in crate::scene) shares: Vec<Share>,
}

/// Buffers of the nodal contact, reused between evaluations.
#[derive(Default)]
pub(in crate::scene) struct Nodal {
    pub islands: Vec<Island>,
    /// Active nodes of each gear of the scene.
    pub gears: Vec<GearNodes>,
    /// Poses of the hubs of the gears.
    pub hub_poses: Vec<Option<HubPose>>,
    /// Torque (force along the motion) of the points on hubs of gears that are rigid except for a field.
    pub torque: Vec<f64>,
    pub active: Vec<NodalActive>,
    /// Rows of each active point: entries of gears without a field, along the normal and along the profile.
    pub rows: Vec<[Row; 2]>,
    /// Result of each island.
    pub solved: Vec<IslandSolution>,
    /// Points of all islands.
    pub found: NodalPoints,
    pub(in crate::scene) numbers: Vec<u32>,
    /// True for each gear whose nodes are compliant in the present solve.
    pub(in crate::scene) giving: Vec<bool>,
    pub(in crate::scene) ports: Vec<u32>,
    pub(in crate::scene) guess: Vec<f64>,
    pub(in crate::scene) averages: Averages,
    /// Velocities of nodes, outwards and along the profile.
    pub(in crate::scene) velocities: Vec<[Vec<f64>; 2]>,
    /// Velocities of the nodes of a block.
    pub(in crate::scene) of_block: Vec<f64>,
    pub(in crate::scene) impulse: Impulse,
    pub failed: bool,
}

/// Half-step impulse at whose end forces are evaluated.
#[derive(Default)]
pub(in crate::scene) struct Impulse {
    /// True during an impulse.
    pub acts: bool,
    /// Time over mass of each coordinate in the last impulse [s/kg].
    pub weights: Vec<f64>,
    /// Factor between acceleration and change of velocity of each coordinate in the last impulse [s].
    times: Vec<f64>,
    /// Counter of the changes of the weights.
    pub stamp: u64,
    /// Duration [s] and filter of the impulse that the weights belong to.
    made_for: (f64, Vec<f64>),
    /// Velocities before the contact forces act.
    pub velocities: Vec<f64>,
}

impl Impulse {
    /// Starts a half-step impulse on coordinates with given inverse masses, under forces without contact.
    pub fn set(&mut self, impulse: &HalfStepImpulse<'_>, without: &[f64], inverse_mass: &[f64]) {
        let n = inverse_mass.len();
        if self.made_for.0 != impulse.time
            || self.weights.len() != n
            || !equal(&self.made_for.1, impulse.filter)
        {
            self.stamp += 1;
            self.made_for.0 = impulse.time;
            self.made_for.1.clear();
            self.made_for.1.extend_from_slice(impulse.filter);
            self.times.clear();
            self.times.extend((0..n).map(|i| impulse.weight(i)));
            self.weights.clear();
            let weights = self.times.iter().zip(inverse_mass);
            self.weights.extend(weights.map(|(time, m)| time * m));
        }
        self.velocities.clear();
        self.velocities.extend_from_slice(impulse.before);
        let loads = without.iter().zip(&self.weights);
        for (v, (f, weight)) in self.velocities.iter_mut().zip(loads) {
            *v += weight * f;
        }
        let steady = impulse.steady.iter().zip(&self.times);
        for (v, (a, time)) in self.velocities.iter_mut().zip(steady) {
            *v -= time * a;
        }
    }
}

/// Returns true if all bits of two slices agree. All of them are compared, which takes less time than a comparison that
/// ends at the first difference.
fn equal(a: &[f64], b: &[f64]) -> bool {
    let bits = a.iter().zip(b);
    a.len() == b.len() && bits.fold(0, |all, (a, b)| all | (a.to_bits() ^ b.to_bits())) == 0
}

/// Returns the islands of the meshes that have a gear with a field.
pub(in crate::scene) fn islands(gears: &[SceneGear], meshes: &[SceneMesh]) -> Vec<Island> {
    let compliant = |g: usize| {
        gears[g]
            .model
            .displacement()
            .is_some_and(|f| f.is_compliant())
    };
    let of = |mesh: &SceneMesh, what: &dyn Fn(usize) -> bool| -> Vec<usize> {
        mesh.gears.into_iter().filter(|&g| what(g)).collect()
    };
    let shared = |a: &[usize], b: &[usize]| a.iter().any(|g| b.contains(g));
    let mut islands: Vec<Island> = Vec::new();
    for (m, mesh) in meshes.iter().enumerate().filter(|(_, m)| m.nodal) {
        let mut own = Island {
            meshes: vec![m],
            compliant: of(mesh, &compliant),
            fields: of(mesh, &|g| gears[g].model.displacement().is_some()),
            hubs: of(mesh, &|g| gears[g].model.hub().is_free()),
            dissipates: mesh.dissipates(),
            damped: mesh.law.is_dissipative(),
            slides: mesh.friction.is_some(),
        };
        // Dashpots and friction are also coupled by the masses that they share.
        let (joined, apart) = islands.into_iter().partition(|i: &Island| {
            shared(&i.compliant, &own.compliant)
                || (i.dissipates
                    && own.dissipates
                    && (shared(&i.fields, &own.fields) || shared(&i.hubs, &own.hubs)))
        });
        islands = apart;
        for other in joined {
            let other: Island = other;
            own.meshes.extend(other.meshes);
            own.dissipates |= other.dissipates;
            own.damped |= other.damped;
            own.slides |= other.slides;
            for (own, other) in [
                (&mut own.compliant, other.compliant),
                (&mut own.fields, other.fields),
                (&mut own.hubs, other.hubs),
            ] {
                for g in other {
                    if !own.contains(&g) {
                        own.push(g);
                    }
                }
            }
        }
        own.meshes.sort_unstable();
        islands.push(own);
    }
    islands
}

impl Nodal {
    pub(in crate::scene) fn new(gears: &[SceneGear], meshes: &[SceneMesh]) -> Self {
        let islands = islands(gears, meshes);
        Nodal {
            gears: vec![GearNodes::default(); gears.len()],
            torque: vec![0.0; gears.len()],
            velocities: vec![[vec![], vec![]]; gears.len()],
            solved: islands
                .iter()
                .map(|i| IslandSolution {
                    hard: i
                        .meshes
                        .iter()
                        .any(|m| meshes[*m].hard)
                        .then(HardSolve::default),
                    ..IslandSolution::default()
                })
                .collect(),
            islands,
            ..Nodal::default()
        }
    }

    /// Invalidates the compliances stored with the nodes in contact, at the start of another run.
    pub(in crate::scene) fn forget(&mut self) {
        for solved in &mut self.solved {
            solved.solve.forget();
            solved.mobile = Default::default();
        }
    }
}
