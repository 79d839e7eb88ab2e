//! Meshes of a scene in quasi-static motion: closing, force, compliance and damping of each mesh over one mesh cycle.
//!
//! The loaded state is computed at each phase. With `N` the sum of the normal forces of a mesh, the results are
//!
//! ```text
//! w = dN/dq / k                          closing of the flanks by unit of a coordinate (at the first phase)
//! e, N_s                                 closing by the hubs under the loads, and force
//! C = de/dN                              along the loads, K x = f: total compliance between the hubs
//! k, c = dN/d(closing), dN/d(its rate)   with teeth and modes fixed to their gear
//! ```
//!
//! Meshes of one frequency are computed together, so that their relative phases are those of the scene. Motions are
//! relative to the carriers of planetary sets.
//!
//! **Resonance.** At each phase one undamped natural mode is the mesh mode of the meshes of a frequency: the mode in
//! which the hubs close them most, by `k (r x)^2 / omega^2` with the closing `r x` by the hubs and the stiffness `k`
//! between them. The strain energy of the contacts alone does not identify it: in elastic gears a contact that vibrates
//! on its own teeth, at ten times the frequency, has more. The resonance of these meshes is the root mean square of the
//! frequencies of the mesh mode over the cycle, for two gears the frequency of the mean tangent stiffness; its range is
//! from the least to the greatest. `modes`, `response`, `sweep` and the mesh modes of all other studies use this
//! resonance.

use super::equilibrium::normal_forces;
use super::{LoadedState, LoadedStateError, Patience, loaded};
use gearbench_integrators::system::{Events, SecondOrderSystem, State};
use gearbench_models::scene::{Scene, SceneGear};
use gearbench_models::spec::{Body, SceneSpec};
use nalgebra::DMatrix;
use std::f64::consts::TAU;

/// Step of the finite differences of forces, relative to a typical deflection or speed.
const STEP: f64 = 1e-3;
/// The message for a mesh without stiffness.
const NO_STIFFNESS: &str =
    "a mesh has no stiffness: it carries no load, or none of its gears can move";
/// Relative difference below which mesh frequencies count as equal.
const ALIKE: f64 = 1e-6;

/// State of a mesh at one phase of its cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MeshPhase {
    /// Closing of the flanks by the motion of the hubs since the first phase [m].
    pub closing: f64,
    /// Sum of the normal forces [N].
    pub force: f64,
    /// Compliance of the mesh between the hubs [m/N].
    pub compliance: f64,
    /// Share of the contact in the compliance: the compliance with teeth and modes fixed to their gear [m/N].
    pub contact: f64,
    /// Damping of the contact [N s/m].
    pub damping: f64,
}

/// Coupling of a mesh to the coordinates of its scene at the first phase: closing by coordinate, stiffness and damping.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshRow {
    /// Closing of the flanks by unit of each coordinate.
    pub flanks: Vec<f64>,
    /// Closing by unit of each coordinate through the hubs alone: teeth and modes count only as far as they turn the
    /// hub.
    pub hubs: Vec<f64>,
    /// Stiffness of the contact [N/m].
    pub stiffness: f64,
    /// Damping of the contact [N s/m].
    pub damping: f64,
    /// Mesh frequency at the speeds of the scene [Hz].
    pub frequency: f64,
}

impl MeshRow {
    /// True if the mesh carries a load, and so has a stiffness.
    fn carries(&self) -> bool {
        self.stiffness > 0.0 && self.stiffness.is_finite()
    }
}

/// Meshes of one mesh frequency over their cycle.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshCycle {
    /// Indices of the meshes in the scene.
    pub meshes: Vec<usize>,
    /// Frequency at the speeds of the scene [Hz].
    pub frequency: f64,
    /// States at equidistant phases, by mesh.
    pub phases: Vec<Vec<MeshPhase>>,
    /// Natural frequency of the mesh mode of these meshes, by phase [Hz].
    pub natural: Vec<f64>,
}

/// Number of phases for the resonance alone. As the stiffness of spur gears jumps, the mean has an error of a fraction
/// of one phase.
pub const PHASES: usize = 24;

/// Resonance frequency of meshes over their cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resonance {
    /// Root mean square of the frequencies of the mesh mode over the cycle [Hz].
    pub frequency: f64,
    /// Least and greatest frequency of the mesh mode over the cycle [Hz].
    pub range: [f64; 2],
}

impl MeshCycle {
    /// The resonance; `None` if the frequency is zero at some phase.
    pub fn resonance(&self) -> Option<Resonance> {
        let ends = (self.natural.iter())
            .fold([f64::INFINITY, 0.0_f64], |[a, b], f| [a.min(*f), b.max(*f)]);
        let squares: f64 = self.natural.iter().map(|f| f * f).sum();
        let mean = squares / self.natural.len() as f64;
        (mean > 0.0 && ends[0] > 0.0).then(|| Resonance {
            frequency: mean.sqrt(),
            range: ends,
        })
    }
}

/// A scene in quasi-static motion under its loads.
pub struct Running {
    /// The loaded state at the start.
    pub start: LoadedState,
    /// One row for each mesh of the scene.
    pub rows: Vec<MeshRow>,
    /// Mesh cycles, one for each mesh frequency.
    pub cycles: Vec<MeshCycle>,
}

/// Central difference of the forces of all meshes along a displacement and a velocity [N].
fn change(scene: &mut Scene, s: &State, [dq, dv]: [&[f64]; 2]) -> Vec<f64> {
    let mut at = |sign: f64| {
        let mut moved = s.clone();
        moved.q.iter_mut().zip(dq).for_each(|(q, x)| *q += sign * x);
        moved.v.iter_mut().zip(dv).for_each(|(v, x)| *v += sign * x);
        normal_forces(scene, &moved)
    };
    let (up, down) = (at(1.0), at(-1.0));
    up.iter().zip(&down).map(|(u, d)| 0.5 * (u - d)).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The gear of a mesh whose hub is free, and its position (0 or 1) in the mesh.
fn free_of(scene: &Scene, mesh: usize) -> Option<(usize, usize)> {
    let gears = scene.meshes()[mesh].gears;
    let free = |&(i, _): &(usize, usize)| scene.gears()[i].model.hub().is_free();
    gears.into_iter().zip(0..).find(free)
}

/// Quantities that all phases of a mesh cycle share.
struct Cycle<'a> {
    scene: &'a mut Scene,
    scales: Vec<f64>,
    speeds: Vec<f64>,
    /// Rigid-body rotation of each gear by the coordinate of its hub; `None` for a fixed gear.
    turns: Vec<Option<Vec<f64>>>,
    /// 1 if left flanks are in contact, -1 for right flanks, by mesh.
    sides: Vec<f64>,
    rows: Vec<MeshRow>,
}

/// A mesh as a spring between hubs: its closing by unit of each coordinate, and its stiffness [N/m].
pub(super) type HubSpring<'a> = (&'a [f64], f64);

/// The natural mode with the largest strain energy of some meshes as springs between hubs.
pub(super) fn of_meshes(found: &LoadedState, meshes: &[HubSpring<'_>]) -> Option<usize> {
    let (space, modes) = (&found.space, &found.modes);
    let mut strain = vec![0.0; modes.squares.len()];
    for (closing, stiffness) in meshes {
        let on = modes.vectors.tr_mul(&space.force(closing));
        for (sum, x) in strain.iter_mut().zip(on.iter()) {
            *sum += stiffness * x * x;
        }
    }
    // Energy of the meshes in the mode, over that of the mode.
    let share = |i: &usize| strain[*i] / modes.squares[*i].max(f64::MIN_POSITIVE);
    let floor = 1e-12 * modes.squares.last().map_or(0.0, |x| x.abs());
    let swinging = (0..strain.len()).filter(|i| modes.squares[*i] > floor);
    swinging.max_by(|a, b| share(a).total_cmp(&share(b)))
}

/// The index of the mesh mode of all loaded meshes among the natural modes.
///
/// # Errors
/// [`LoadedStateError`] where own coordinates of a gear have no stiffness, or no mesh has one.
pub(super) fn mesh_mode_at(
    scene: &mut Scene,
    found: &LoadedState,
) -> Result<usize, LoadedStateError> {
    let mut cycle = Cycle::of(scene, found)?;
    cycle.fill_rows(&found.state);
    let all = cycle.at(found, &vec![0.0; found.state.q.len()]);
    let springs: Vec<HubSpring<'_>> = (cycle.rows.iter().zip(&all))
        .filter(|(row, _)| row.carries())
        .map(|(row, phase)| (&row.hubs[..], 1.0 / phase.compliance))
        .collect();
    match springs.is_empty() {
        true => Err(LoadedStateError::Matrices(NO_STIFFNESS)),
        false => {
            of_meshes(found, &springs).ok_or(LoadedStateError::Matrices("nothing in it vibrates"))
        }
    }
}

/// Rigid-body rotation of each gear: its own coordinates follow the hub without strain.
fn turns(
    scene: &Scene,
    mechanism: &DMatrix<f64>,
) -> Result<Vec<Option<Vec<f64>>>, LoadedStateError> {
    let of = |g: &SceneGear| {
        let (hub, range) = (g.model.hub(), g.range());
        if !hub.is_free() {
            return Ok(None);
        }
        let mut turn = vec![0.0; mechanism.nrows()];
        turn[range.start] = 1.0;
        let own = range.start + hub.first()..range.end;
        if !own.is_empty() {
            let block = mechanism.view((own.start, own.start), (own.len(), own.len()));
            let by_hub = mechanism.view((own.start, range.start), (own.len(), 1));
            let solved = block.into_owned().lu().solve(&-by_hub);
            let solved = solved.ok_or(LoadedStateError::Matrices(
                "the internal coordinates of a gear have no stiffness",
            ))?;
            turn[own].copy_from_slice(solved.as_slice());
        }
        Ok(Some(turn))
    };
    scene.gears().iter().map(of).collect()
}

impl<'a> Cycle<'a> {
    /// Starts a mesh cycle at a loaded state, without rows.
    fn of(scene: &'a mut Scene, start: &LoadedState) -> Result<Cycle<'a>, LoadedStateError> {
        let n = start.state.q.len();
        let (mut scales, mut speeds) = (vec![0.0; n], vec![0.0; n]);
        scene.scales(&mut scales, &mut speeds);
        let mechanism = scene.mechanism(start.state.at(), &start.linear.mass);
        let meshes = scene.meshes().len();
        Ok(Cycle {
            turns: turns(scene, &mechanism.stiffness)?,
            sides: vec![1.0; meshes],
            rows: vec![MeshRow::default(); meshes],
            scene,
            scales,
            speeds,
        })
    }

    /// Stiffness or damping of a mesh by its rigid-body closing: difference quotient of the force by displacement, or
    /// by velocity.
    ///
    /// On the way of one gear the stiffness changes as teeth pass, on that of the other as much the other way.
    fn slope(&mut self, s: &State, mesh: usize, of_rate: bool) -> f64 {
        let (gears, towards) = (
            self.scene.meshes()[mesh].gears,
            self.scene.meshes()[mesh].towards,
        );
        let none = vec![0.0; s.q.len()];
        let (mut sum, mut count) = (0.0, 0.0);
        for (gear, towards) in gears.into_iter().zip(towards) {
            let Some(turn) = &self.turns[gear] else {
                continue;
            };
            let i = self.scene.gears()[gear].range().start;
            let size = STEP
                * if of_rate {
                    self.speeds[i]
                } else {
                    self.scales[i]
                };
            let moved: Vec<f64> = turn.iter().map(|x| size * x).collect();
            let by = match of_rate {
                true => change(self.scene, s, [&none, &moved]),
                false => change(self.scene, s, [&moved, &none]),
            };
            sum += self.sides[mesh] * by[mesh] / (size * towards);
            count += 1.0;
        }
        sum / count
    }

    /// Computes the rows of the meshes at the first phase. An unloaded mesh has no closing.
    fn fill_rows(&mut self, s: &State) {
        let n = s.q.len();
        let none = vec![0.0; n];
        let mut slopes = vec![vec![0.0; n]; self.rows.len()];
        for i in 0..n {
            let mut dq = none.clone();
            dq[i] = STEP * self.scales[i];
            let found = change(self.scene, s, [&dq, &none]);
            for (slopes, change) in slopes.iter_mut().zip(found) {
                slopes[i] = change / dq[i];
            }
        }
        for (mesh, slopes) in slopes.into_iter().enumerate() {
            // Right flanks close where left ones open.
            let slope = self.slope(s, mesh, false);
            self.sides[mesh] = if slope < 0.0 { -1.0 } else { 1.0 };
            let [stiffness, damping] = [false, true].map(|rate| self.slope(s, mesh, rate));
            let row = &mut self.rows[mesh];
            (row.stiffness, row.damping) = (stiffness, damping);
            if !row.carries() {
                (row.flanks, row.hubs) = (none.clone(), none.clone());
                continue;
            }
            let of_mesh = &self.scene.meshes()[mesh];
            let mut flanks: Vec<f64> = slopes.iter().map(|x| x / stiffness).collect();
            let mut hubs = flanks.clone();
            for (&gear, towards) in of_mesh.gears.iter().zip(of_mesh.towards) {
                let towards = self.sides[mesh] * towards;
                let Some(turn) = &self.turns[gear] else {
                    continue;
                };
                let g = &self.scene.gears()[gear];
                let (hub, range) = (g.model.hub(), g.range());
                // What a turn as a rigid body closes is known: by how stiffness changes along the path the slope is not quite it.
                flanks[range.start] += towards - dot(&flanks, turn);
                hubs[range.start] = towards;
                let own = &mut hubs[range.start + hub.first()..range.end];
                let shapes = hub.hub_shapes.iter().copied().chain(std::iter::repeat(0.0));
                own.iter_mut()
                    .zip(shapes)
                    .for_each(|(to, x)| *to = towards * x);
            }
            let row = &mut self.rows[mesh];
            (row.flanks, row.hubs) = (flanks, hubs);
        }
    }

    /// The states of the meshes at a loaded state that is displaced by `away` from the first, relative to carriers.
    fn at(&mut self, found: &LoadedState, away: &[f64]) -> Vec<MeshPhase> {
        let s = &found.state;
        let mut loads = Vec::new();
        self.scene.loads(s.at(), &mut loads);
        let (modes, space) = (&found.modes, &found.space);
        let floor = 1e-12 * modes.squares.last().map_or(0.0, |x| x.abs());
        let mut on = modes.vectors.tr_mul(&space.force(&loads));
        for (on, square) in on.iter_mut().zip(&modes.squares) {
            *on = if square.abs() > floor {
                *on / square
            } else {
                0.0
            };
        }
        let x = space.displacement(&(&modes.vectors * on));
        let moved = x.iter().zip(&self.scales).map(|(x, s)| (x / s).abs());
        let h = STEP / moved.fold(f64::MIN_POSITIVE, f64::max);
        let step: Vec<f64> = x.iter().map(|x| h * x).collect();
        let by_loads = change(self.scene, s, [&step, &vec![0.0; x.len()]]);
        let forces = normal_forces(self.scene, s);
        (0..self.rows.len())
            .map(|m| {
                let compliance = h * dot(&self.rows[m].hubs, &x) / by_loads[m];
                // All compliance of rigid gears is in the contact.
                let gears = self.scene.meshes()[m].gears;
                let own = |i: usize| self.scene.gears()[i].model.hub().own > 0;
                MeshPhase {
                    closing: dot(&self.rows[m].hubs, away),
                    force: forces[m],
                    compliance,
                    contact: match gears.into_iter().any(own) {
                        true => 1.0 / self.slope(s, m, false),
                        false => compliance,
                    },
                    damping: self.slope(s, m, true),
                }
            })
            .collect()
    }
}

/// Mesh frequencies from the speeds of free gears [Hz].
fn frequencies(scene: &Scene, spec: &SceneSpec, seen: &State) -> Vec<f64> {
    let of = |mesh| {
        let Some((gear, _)) = free_of(scene, mesh) else {
            return 0.0;
        };
        let speed = seen.v[scene.gears()[gear].range().start].abs();
        match &spec.gears[gear].body {
            Body::Gear(g) => f64::from(g.teeth()) * speed / TAU,
            Body::Rack(r) => speed / r.pitch(),
        }
    };
    (0..scene.meshes().len()).map(of).collect()
}

/// Follows a scene quasi-statically through the cycles of its meshes, with `phases` phases each.
///
/// # Errors
/// [`LoadedStateError`] if a loaded state is not found, if gears are at rest, or if a mesh carries no load.
pub fn running(
    scene: &mut Scene,
    spec: &SceneSpec,
    phases: usize,
    patience: &Patience<'_>,
) -> Result<Running, LoadedStateError> {
    let start = loaded(scene, true, patience)?;
    let seen = scene.relative_state(&start.state);
    let frequencies = frequencies(scene, spec, &seen);
    if frequencies.iter().any(|f| *f <= 0.0) {
        return Err(LoadedStateError::Matrices(
            "a mesh does not rotate at the initial speeds, so that its mesh frequency is zero",
        ));
    }
    let mut cycle = Cycle::of(scene, &start)?;
    cycle.fill_rows(&start.state);
    if !cycle.rows.iter().all(MeshRow::carries) {
        return Err(LoadedStateError::Matrices(NO_STIFFNESS));
    }
    let mut cycles: Vec<MeshCycle> = Vec::new();
    for (mesh, f) in frequencies.into_iter().enumerate() {
        cycle.rows[mesh].frequency = f;
        let alike = |c: &&mut MeshCycle| (c.frequency - f).abs() <= ALIKE * f;
        match cycles.iter_mut().find(alike) {
            Some(group) => group.meshes.push(mesh),
            None => cycles.push(MeshCycle {
                meshes: vec![mesh],
                frequency: f,
                ..MeshCycle::default()
            }),
        }
    }
    for group in &mut cycles {
        group.phases = vec![Vec::new(); group.meshes.len()];
        let dt = 1.0 / (group.frequency * phases as f64);
        let mut s = start.state.clone();
        for i in 0..phases {
            let mut note = |cycle: &mut Cycle<'_>, found: &LoadedState| {
                let now = cycle.scene.relative_state(&found.state);
                let t = found.state.t - start.state.t;
                let mut away: Vec<f64> = (now.q.iter().zip(&seen.q).zip(&seen.v))
                    .map(|((now, first), v)| now - first - v * t)
                    .collect();
                // In the frame of a carrier the motion of the carriers itself is zero.
                (cycle.scene.carrier_coordinates().into_iter()).for_each(|i| away[i] = 0.0);
                let all = cycle.at(found, &away);
                let of_group: Vec<HubSpring<'_>> = (group.meshes.iter())
                    .map(|m| (&cycle.rows[*m].hubs[..], 1.0 / all[*m].compliance))
                    .collect();
                let mode = of_meshes(found, &of_group);
                let frequency = |i: usize| found.modes.squares[i].sqrt() / TAU;
                group.natural.push(mode.map_or(0.0, frequency));
                for (to, mesh) in group.phases.iter_mut().zip(&group.meshes) {
                    to.push(all[*mesh]);
                }
            };
            if i == 0 {
                note(&mut cycle, &start);
                continue;
            }
            s.t += dt;
            s.q.iter_mut().zip(&s.v).for_each(|(q, v)| *q += v * dt);
            cycle.scene.commit(&mut s);
            cycle.scene.start_from(s);
            let found = loaded(cycle.scene, true, patience)?;
            note(&mut cycle, &found);
            s = found.state;
        }
    }
    let rows = cycle.rows;
    Ok(Running {
        start,
        rows,
        cycles,
    })
}
