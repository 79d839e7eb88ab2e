//! Small signals: a scene to first order about a state,
//!
//! ```text
//! M x'' + D x' + K x = 0,    C x = 0
//! ```
//!
//! with what rigid shafts and the ground of planetary sets hold as rows of `C`; where the strain energy `x^T K x / 2` of a
//! displacement lies; and the stiffness of the scene as a mechanism, whose null space are its rigid motions.
//!
//! The mechanism is what stays whatever the loads: bodies, bearings as if without clearance, shafts, and each mesh as a
//! spring along its line of action between hubs, closed or not. Under load a rigid motion has a small stiffness of its own,
//! by how the stiffness of teeth changes along the path of contact, which is none of a train that runs.

use super::assembled::Scene;
use super::carriers::RelativeState;
use super::contacts::ContactForce;
use super::members::SceneMesh;
use super::shafts::Way;
use crate::gear::HubBody;
use gearbench_integrators::system::{At, SecondOrderSystem, State};
use nalgebra::DMatrix;
use std::collections::BTreeMap;

/// Part of a typical deflection that contacts are moved by to see which of them answer.
const STEP: f64 = 1e-3;
/// Step that a relative state is differenced by [rad], [m].
const TURN: f64 = 1e-6;

/// A scene to first order.
#[derive(Clone, Debug)]
pub struct Linearised {
    /// Mass.
    pub mass: DMatrix<f64>,
    /// `-df/dv`.
    pub damping: DMatrix<f64>,
    /// `-df/dq`; friction, and contacts that move along the path, leave a small skew part.
    pub stiffness: DMatrix<f64>,
}

/// A scene as a mechanism.
#[derive(Clone, Debug)]
pub struct Mechanism {
    /// Its stiffness.
    pub stiffness: DMatrix<f64>,
    /// Rate of the forces that driven hubs make in it while all others stand still.
    pub driven: Vec<f64>,
}

/// Where strain energy lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum StrainIn {
    /// A mesh: its contacts, and what bends with them without coordinates of its own.
    Mesh(usize),
    /// Own coordinates of a member: teeth, modes.
    Body(usize),
    /// The bearing of a member, or its guide.
    Bearing(usize),
    /// A shaft that twists.
    Twist(usize),
    /// A shaft that stretches.
    Stretch(usize),
    /// A shaft that bends.
    Bend(usize),
}

/// Way of the flanks of a gear of a mesh along the line of action by a unit of its hub's own motion.
fn along_path(mesh: &SceneMesh, k: usize, hub: &HubBody) -> f64 {
    mesh.senses[k] * hub.effective_base_radius
}

/// A matrix column by column.
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
    /// The scene to first order about a state.
    pub fn linearised(&mut self, at: At<'_>) -> Linearised {
        let none = vec![0.0; self.n];
        Linearised {
            mass: by_columns(self.n, |x, y| self.apply_mass(at, x, y)),
            damping: -by_columns(self.n, |x, y| self.tangent_times(at, &none, x, y)),
            stiffness: -by_columns(self.n, |x, y| self.tangent_times(at, x, &none, y)),
        }
    }

    /// Rows of what rigid shafts, and the ground of planetary sets, hold: `C x = 0` in every motion.
    pub fn constraints(&self) -> Vec<Vec<f64>> {
        let row = |l: &super::shafts::Link| {
            let mut row = vec![0.0; self.n];
            l.add_to(1.0, &mut row);
            row
        };
        self.shafts.rigid().iter().map(row).collect()
    }

    /// The scene as a mechanism; the null space of its stiffness are the rigid motions. `mass` is the mass matrix.
    pub fn mechanism(&mut self, at: At<'_>, mass: &DMatrix<f64>) -> Mechanism {
        let none = vec![0.0; self.n];
        let at = At { v: &none, ..at };
        let mut stiffness = by_columns(self.n, |x, y| self.mechanism_times(at, x, &[], y));
        let own = (0..self.n).map(|i| stiffness[(i, i)] / mass[(i, i)]);
        let typical = Some(own.fold(0.0, f64::max)).filter(|x| *x > 0.0);
        // Meshes as stiff as the rest, so that neither is lost beside the other.
        let meshes: Vec<f64> = (self.meshes.iter())
            .map(|m| {
                let yielding = |&i: &usize| {
                    let g = &self.gears[i];
                    let r = g.model.hub().effective_base_radius;
                    if g.model.hub().is_free() {
                        r * r / mass[(g.offset, g.offset)]
                    } else {
                        0.0
                    }
                };
                let all: f64 = m.gears.iter().map(yielding).sum();
                if all > 0.0 {
                    typical.unwrap_or(1.0) / all
                } else {
                    0.0
                }
            })
            .collect();
        stiffness = by_columns(self.n, |x, y| self.mechanism_times(at, x, &meshes, y));
        let mut driven = vec![0.0; self.n];
        for link in self.shafts.springs() {
            link.add_to(-link.stiffness * link.drift(&self.gears, at), &mut driven);
        }
        for (mesh, k) in self.meshes.iter().zip(&meshes) {
            let hubs = [0, 1].map(|k| {
                let g = &self.gears[mesh.gears[k]];
                (g, g.model.hub(), along_path(mesh, k, g.model.hub()))
            });
            let prescribed = hubs.iter().filter(|(_, hub, _)| !hub.is_free());
            let moved: f64 = prescribed
                .map(|(_, hub, along)| along * hub.speed(at.t, &[]))
                .sum();
            for (g, _, along) in hubs.iter().filter(|(_, hub, _)| hub.is_free()) {
                driven[g.offset] -= k * moved * along;
            }
        }
        Mechanism { stiffness, driven }
    }

    /// `y = K x` of the mechanism with meshes of some stiffness [N/m].
    fn mechanism_times(&mut self, at: At<'_>, x: &[f64], meshes: &[f64], y: &mut [f64]) {
        let n = self.n;
        let none = vec![0.0; n];
        y.fill(0.0);
        self.add_shaft_tangent(at, [x, &none], y);
        let along = self.relative_change(at, x);
        let mut seen = RelativeState::default();
        self.carriers.see(at, &mut seen);
        let mut f = vec![0.0; n];
        for (i, g) in self.gears.iter_mut().enumerate() {
            let range = g.range();
            let carried = self.carriers.carries(i);
            let relative = At {
                q: &seen.q,
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
        for (mesh, k) in self.meshes.iter().zip(meshes) {
            let row = [0, 1].map(|k| {
                let g = &self.gears[mesh.gears[k]];
                let hub = g.model.hub();
                (hub.is_free()).then_some((g.offset, along_path(mesh, k, hub)))
            });
            let moved: f64 = row.iter().flatten().map(|&(i, r)| r * along[i]).sum();
            for &(i, r) in row.iter().flatten() {
                f[i] -= k * moved * r;
            }
        }
        seen.f = f;
        self.carriers.pull_back(at, &seen, y);
        y.iter_mut().for_each(|y| *y = -*y);
    }

    /// How the relative state moves by a displacement.
    fn relative_change(&self, at: At<'_>, x: &[f64]) -> Vec<f64> {
        let largest = x.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        if self.carriers.is_empty() || largest == 0.0 {
            return x.to_vec();
        }
        let h = TURN / largest;
        let [up, down] = [h, -h].map(|h| {
            let q: Vec<f64> = at.q.iter().zip(x).map(|(q, x)| q + h * x).collect();
            let mut seen = RelativeState::default();
            self.carriers.see(At { q: &q, ..at }, &mut seen);
            seen.q
        });
        let ends = up.iter().zip(&down);
        ends.map(|(up, down)| 0.5 * (up - down) / h).collect()
    }

    /// Where the strain energy `x^T K x / 2` of a displacement lies [J]; what neither bodies, bearings nor shafts hold is that
    /// of meshes, in the ratio of what their contacts do.
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
            let Some(shaft) = link.shaft() else { continue };
            let place = match link.way {
                Way::Torsion => StrainIn::Twist(shaft),
                Way::Stretching => StrainIn::Stretch(shaft),
                Way::Bending => StrainIn::Bend(shaft),
            };
            add(place, 0.5 * link.stiffness * link.dot(x).powi(2));
        }
        let (none, relative) = (vec![0.0; n], self.relative_state(s));
        let along = self.relative_change(at, x);
        for (i, g) in self.gears.iter_mut().enumerate() {
            if !g.internal {
                continue;
            }
            let (seen, by) = match self.carriers.carries(i) {
                true => (relative.at(), &along[..]),
                false => (at, x),
            };
            let (own, range) = (g.at(seen), g.range());
            let by = &by[range.clone()];
            let mut f = vec![0.0; g.n];
            g.model.tangent(own, by, &none[range], &mut f);
            let all = -0.5 * dot(by, &f);
            let in_bearing = g.model.hub().bearing_change(own, by);
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

    /// What part meshes have in the energy of contacts that a displacement changes: by force and gap of their contacts.
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

/// Force and gap of contacts by mesh, teeth and which of these they are.
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
