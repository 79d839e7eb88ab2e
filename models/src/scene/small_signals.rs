//! Small signals: linearisation of a scene about a state.
//!
//! ```text
//! M x'' + D x' + K x = 0,    C x = 0
//! ```
//!
//! with the constraints of rigid shafts and of the ground of planetary sets as rows of `C`; the distribution of the
//! strain energy `x^T K x / 2` of a displacement; and the stiffness of the scene as a mechanism, whose null space
//! consists of the rigid motions.
//!
//! The mechanism is what stays whatever the loads: bodies, bearings as if without clearance, shafts, and each mesh as a
//! spring between hubs, closed or not, along the line of action of the flanks that touch, or are nearest to touching. It
//! acts on all free directions of both hubs, so that a hub without a bearing floats on its meshes. Under load a rigid motion has a small stiffness of its own,
//! by how the stiffness of teeth changes along the path of contact, which is none of a train that runs.

use super::assembled::Scene;
use super::carriers::CarrierFrameState;
use super::contacts::ContactForce;
use super::shafts::{DeformationKind, Origin};
use crate::geometry::Side;
use gearbench_integrators::system::{SecondOrderSystem, State, StateView};
use nalgebra::DMatrix;
use std::collections::BTreeMap;

/// Displacement relative to a typical deflection by which contacts are tested for a response.
const STEP: f64 = 1e-3;
/// Step of the finite differences of a carrier-frame state [rad], [m].
const TURN: f64 = 1e-6;

/// Linearisation of a scene: mass, damping and stiffness matrix.
#[derive(Clone, Debug)]
pub struct LinearisedScene {
    /// Mass matrix.
    pub mass: DMatrix<f64>,
    /// Damping matrix `-df/dv`.
    pub damping: DMatrix<f64>,
    /// Stiffness matrix `-df/dq`; friction, and contacts that move along the path, cause a small skew part.
    pub stiffness: DMatrix<f64>,
}

/// A scene as a mechanism.
#[derive(Clone, Debug)]
pub struct Mechanism {
    /// Stiffness matrix of the mechanism.
    pub stiffness: DMatrix<f64>,
    /// Rate of the forces from driven hubs while all others are at rest.
    pub driven: Vec<f64>,
}

/// A mesh of the mechanism: the coordinates that close it, their weights, and its stiffness [N/m].
struct MeshSpring {
    row: Vec<(usize, f64)>,
    stiffness: f64,
}

/// Component with strain energy.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum StrainIn {
    /// A mesh: its contacts, and the compliance of bodies without coordinates.
    Mesh(usize),
    /// Own coordinates of a member: teeth, modes.
    Body(usize),
    /// The bearing of a member, or its guide.
    Bearing(usize),
    /// Torsion of a shaft.
    Twist(usize),
    /// Extension of a shaft.
    Stretch(usize),
    /// Bending of a shaft.
    Bend(usize),
    /// Torsion of a stage without teeth.
    Stage(usize),
}

/// Assembles a matrix column by column.
fn by_columns(n: usize, mut times: impl FnMut(&[f64], &mut [f64])) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(n, n);
    let (mut unit, mut column) = (vec![0.0; n], vec![0.0; n]);
    for j in 0..n {
        unit[j] = 1.0;
        times(&unit, &mut column);
        unit[j] = 0.0;
        matrix.column_mut(j).copy_from_slice(&column);
    }
    matrix
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

impl Scene {
    /// Linearises the scene about a state.
    pub fn linearised(&mut self, at: StateView<'_>) -> LinearisedScene {
        LinearisedScene {
            damping: self.damping_matrix(at),
            ..self.without_damping(at)
        }
    }

    /// Linearises the scene about a state, with a damping matrix of zeros, for searches that use mass and stiffness
    /// alone.
    pub fn without_damping(&mut self, at: StateView<'_>) -> LinearisedScene {
        let none = vec![0.0; self.n];
        LinearisedScene {
            mass: by_columns(self.n, |x, y| self.apply_mass(at, x, y)),
            damping: DMatrix::zeros(self.n, self.n),
            stiffness: -by_columns(self.n, |x, y| self.tangent_times(at, x, &none, y)),
        }
    }

    /// Computes the damping matrix at a state.
    pub fn damping_matrix(&mut self, at: StateView<'_>) -> DMatrix<f64> {
        let none = vec![0.0; self.n];
        -by_columns(self.n, |x, y| self.tangent_times(at, &none, x, y))
    }

    /// Returns the constraints `C x = 0` of rigid shafts and of the ground of planetary sets.
    pub fn constraints(&self) -> Vec<Vec<f64>> {
        let row = |l: &super::shafts::Link| {
            let mut row = vec![0.0; self.n];
            l.add_to(1.0, &mut row);
            row
        };
        self.shafts.rigid().iter().map(row).collect()
    }

    /// Returns the coordinates of the carriers of planetary sets.
    pub fn carrier_coordinates(&self) -> Vec<usize> {
        self.carriers.coordinates()
    }

    /// Returns the scene as a mechanism; the null space of its stiffness consists of the rigid motions. `mass` is the
    /// mass matrix.
    pub fn mechanism(&mut self, at: StateView<'_>, mass: &DMatrix<f64>) -> Mechanism {
        let none = vec![0.0; self.n];
        let at = StateView { v: &none, ..at };
        let mut stiffness = by_columns(self.n, |x, y| self.mechanism_times(at, x, &[], y));
        let own = (0..self.n).map(|i| stiffness[(i, i)] / mass[(i, i)]);
        let typical = Some(own.fold(0.0, f64::max)).filter(|x| *x > 0.0);
        // Meshes as stiff as the rest, so that neither is lost in rounding.
        let rows = self.closings(at);
        let meshes: Vec<MeshSpring> = (rows.into_iter())
            .map(|row| {
                let yielding: f64 = row.iter().map(|&(i, r)| r * r / mass[(i, i)]).sum();
                let stiffness = if yielding > 0.0 {
                    typical.unwrap_or(1.0) / yielding
                } else {
                    0.0
                };
                MeshSpring { row, stiffness }
            })
            .collect();
        stiffness = by_columns(self.n, |x, y| self.mechanism_times(at, x, &meshes, y));
        let mut driven = vec![0.0; self.n];
        for link in self.shafts.springs() {
            link.add_to(-link.stiffness * link.drift(&self.gears, at), &mut driven);
        }
        self.add_driven_bodies(at, &mut driven);
        for (mesh, spring) in self.meshes.iter().zip(&meshes) {
            let members = mesh.gears.map(|i| &self.gears[i]).into_iter();
            let along = members.zip(mesh.towards);
            let prescribed = along.filter(|(g, _)| !g.model.hub().is_free());
            let moved: f64 = prescribed
                .map(|(g, kind)| kind * g.model.hub().speed(at.t, &[]))
                .sum();
            for &(i, r) in &spring.row {
                driven[i] -= spring.stiffness * moved * r;
            }
        }
        Mechanism { stiffness, driven }
    }

    /// Adds the rate of the forces of driven hubs on the own coordinates of their gears, as on movable teeth.
    fn add_driven_bodies(&mut self, at: StateView<'_>, driven: &mut [f64]) {
        for (i, g) in self.gears.iter_mut().enumerate() {
            let own = g.at(at);
            let rates = g.model.hub().motion(own.t, own.q, &[]).v;
            let fastest = rates.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
            if !g.internal || fastest == 0.0 || self.carriers.carries(i) {
                continue;
            }
            let h = TURN / fastest;
            let mut ends = [own.t, own.t + h].map(|t| {
                let mut f = vec![0.0; g.n];
                g.model.forces(StateView { t, ..own }, &mut f);
                f
            });
            let [from, to] = &mut ends;
            let changes = to.iter().zip(from).map(|(to, from)| (to - *from) / h);
            (driven[g.range()].iter_mut().zip(changes)).for_each(|(d, x)| *d += x);
        }
    }

    /// Returns for each mesh the closing of its flanks by the free directions of both hubs, as coordinates and their
    /// weights. Signs are those of left flanks.
    pub fn closings(&mut self, at: StateView<'_>) -> Vec<Vec<(usize, f64)>> {
        let sides = self.acting_sides(at);
        let meshes = self.meshes.iter().zip(sides);
        meshes
            .map(|(mesh, side)| {
                let mut row = Vec::new();
                for (k, &i) in mesh.gears.iter().enumerate() {
                    let g = &self.gears[i];
                    let hub = &g.model.hub().hub;
                    for (j, d) in hub.free_directions().enumerate() {
                        let weight = if d == hub.moving() {
                            mesh.towards[k]
                        } else if let Some((x, n)) = &mesh.acting[side.index()].middle {
                            let sign = if k == 0 { side.sign() } else { -side.sign() };
                            sign * hub.component(d, x, n)
                        } else {
                            0.0
                        };
                        row.push((g.offset + j, weight));
                    }
                }
                row
            })
            .collect()
    }

    /// Returns the loaded flanks of each mesh, or otherwise those with the smallest gap at the assembled position.
    pub fn acting_sides(&mut self, at: StateView<'_>) -> Vec<Side> {
        let mut forces = vec![[0.0; 2]; self.meshes.len()];
        for contact in self.contact_forces(at) {
            forces[contact.mesh][contact.side.index()] += contact.normal_force;
        }
        let meshes = self.meshes.iter().zip(forces);
        meshes
            .map(|(mesh, [left, right])| {
                let gap = |side: Side| mesh.acting[side.index()].gap;
                let right_acts = if left == right {
                    gap(Side::Right) < gap(Side::Left)
                } else {
                    right > left
                };
                if right_acts { Side::Right } else { Side::Left }
            })
            .collect()
    }

    /// Computes `y = K x` of the mechanism.
    fn mechanism_times(
        &mut self,
        at: StateView<'_>,
        x: &[f64],
        meshes: &[MeshSpring],
        y: &mut [f64],
    ) {
        let n = self.n;
        let none = vec![0.0; n];
        y.fill(0.0);
        self.add_shaft_tangent(at, [x, &none], y);
        let along = self.relative_change(at, x);
        let mut carrier_state = CarrierFrameState::default();
        self.carriers.to_carrier_frame(at, &mut carrier_state);
        let mut f = vec![0.0; n];
        for (i, g) in self.gears.iter_mut().enumerate() {
            let range = g.range();
            let carried = self.carriers.carries(i);
            let relative = StateView {
                q: &carrier_state.q,
                v: &none,
                ..at
            };
            let (own, by, to) = match carried {
                true => (g.at(relative), &along[..], &mut f[range.clone()]),
                false => (g.at(at), x, &mut y[range.clone()]),
            };
            g.model
                .tangent(own, &by[range.clone()], &none[range.clone()], to);
            let hub = g.model.hub();
            if let Some(lateral) = hub.lateral.as_ref().filter(|l| l.bearing.clearance > 0.0) {
                for (k, d) in hub.free_directions().enumerate() {
                    to[k] -= lateral.bearing.stiffness[d][d] * by[range.start + k];
                }
            }
        }
        for MeshSpring { row, stiffness } in meshes {
            let moved: f64 = row.iter().map(|&(i, r)| r * along[i]).sum();
            for &(i, r) in row {
                f[i] -= stiffness * moved * r;
            }
        }
        carrier_state.f = f;
        self.carriers.pull_back(at, &carrier_state, y);
        y.iter_mut().for_each(|y| *y = -*y);
    }

    /// Returns the change of the carrier-frame state for a displacement.
    fn relative_change(&self, at: StateView<'_>, x: &[f64]) -> Vec<f64> {
        let largest = x.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        if self.carriers.is_empty() || largest == 0.0 {
            return x.to_vec();
        }
        let h = TURN / largest;
        let [up, down] = [h, -h].map(|h| {
            let q: Vec<f64> = at.q.iter().zip(x).map(|(q, x)| q + h * x).collect();
            let mut carrier_state = CarrierFrameState::default();
            self.carriers
                .to_carrier_frame(StateView { q: &q, ..at }, &mut carrier_state);
            carrier_state.q
        });
        let ends = up.iter().zip(&down);
        ends.map(|(up, down)| 0.5 * (up - down) / h).collect()
    }

    /// Distributes the strain energy `x^T K x / 2` of a displacement [J]; the energy that is in neither bodies,
    /// bearings nor shafts belongs to meshes, in the ratio of their contact energies.
    pub fn strain_in(
        &mut self,
        s: &State,
        stiffness: &DMatrix<f64>,
        x: &[f64],
    ) -> BTreeMap<StrainIn, f64> {
        let (n, at) = (self.n, s.at());
        let mut found = BTreeMap::new();
        let mut add = |place, energy: f64| *found.entry(place).or_insert(0.0) += energy;
        for link in self.shafts.springs() {
            if let Some((member, stiffness)) = self.guide_at(link, at) {
                add(
                    StrainIn::Bearing(member),
                    0.5 * stiffness * link.dot(x).powi(2),
                );
            }
            let place = match (link.origin(), link.kind) {
                (Origin::Guide | Origin::Ground(_), _) => continue,
                (Origin::Stage(stage), _) => StrainIn::Stage(*stage),
                (Origin::Shaft(shaft), DeformationKind::Torsion) => StrainIn::Twist(*shaft),
                (Origin::Shaft(shaft), DeformationKind::Stretching) => StrainIn::Stretch(*shaft),
                (Origin::Shaft(shaft), DeformationKind::Bending) => StrainIn::Bend(*shaft),
            };
            add(place, 0.5 * link.stiffness * link.dot(x).powi(2));
        }
        let (none, relative) = (vec![0.0; n], self.relative_state(s));
        let along = self.relative_change(at, x);
        for (i, g) in self.gears.iter_mut().enumerate() {
            if !g.internal {
                continue;
            }
            let (carrier_state, by) = match self.carriers.carries(i) {
                true => (relative.at(), &along[..]),
                false => (at, x),
            };
            let (own, range) = (g.at(carrier_state), g.range());
            let by = &by[range.clone()];
            let mut f = vec![0.0; g.n];
            g.model.tangent(own, by, &none[range], &mut f);
            let all = -0.5 * dot(by, &f);
            let in_bearing = g.model.hub().bearing_change(own, [by, &none[..by.len()]]);
            let in_bearing = -0.5 * dot(by, &in_bearing);
            if g.model.hub().lateral.is_some() {
                add(StrainIn::Bearing(i), in_bearing);
            }
            if g.model.hub().own > 0 {
                add(StrainIn::Body(i), all - in_bearing);
            }
        }
        let column = stiffness * DMatrix::from_column_slice(n, 1, x);
        let rest = 0.5 * dot(x, column.as_slice()) - found.values().sum::<f64>();
        for (mesh, share) in self.shares_of_meshes(s, x) {
            found.insert(StrainIn::Mesh(mesh), share * rest);
        }
        found
    }

    /// Returns the shares of meshes in the contact energy of a displacement, from force and gap of their contacts.
    fn shares_of_meshes(&mut self, s: &State, x: &[f64]) -> Vec<(usize, f64)> {
        let (mut scales, mut speeds) = (vec![0.0; self.n], vec![0.0; self.n]);
        self.scales(&mut scales, &mut speeds);
        let moved = x.iter().zip(&scales).map(|(x, s)| (x / s).abs());
        let h = STEP / moved.fold(f64::MIN_POSITIVE, f64::max);
        let mut of = |h: f64| {
            let mut moved = s.clone();
            moved.q.iter_mut().zip(x).for_each(|(q, x)| *q += h * x);
            by_pair(&self.contact_forces(moved.at()))
        };
        let (up, down) = (of(h), of(-h));
        let mut energies: BTreeMap<usize, [f64; 2]> = BTreeMap::new();
        for (key, [n, gap]) in &up {
            let [before, gap_before] = down.get(key).copied().unwrap_or([0.0; 2]);
            let sum = energies.entry(key.0).or_default();
            sum[0] += ((n - before) * (gap - gap_before)).abs();
            sum[1] += (n - before).abs();
        }
        // Hard contact has no gap that changes.
        let which = usize::from(energies.values().all(|e| e[0] == 0.0));
        let all: f64 = energies.values().map(|e| e[which]).sum();
        let even = 1.0 / energies.len().max(1) as f64;
        let share = |e: [f64; 2]| if all > 0.0 { e[which] / all } else { even };
        energies.into_iter().map(|(m, e)| (m, share(e))).collect()
    }
}

/// Groups force and gap of contacts by mesh, teeth, and number within these.
fn by_pair(contacts: &[ContactForce]) -> BTreeMap<(usize, [i64; 2], usize), [f64; 2]> {
    let mut found = BTreeMap::new();
    let mut count: BTreeMap<(usize, [i64; 2]), usize> = BTreeMap::new();
    for c in contacts {
        let pair = (c.mesh, c.teeth.map(|t| t.index));
        let which = count.entry(pair).or_insert(0);
        found.insert((pair.0, pair.1, *which), [c.normal_force, c.gap]);
        *which += 1;
    }
    found
}
