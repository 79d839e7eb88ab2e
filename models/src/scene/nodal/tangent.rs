//! Tangent and Newton correction of contacts of gears with fields.
//!
//! Contacts see few combinations `y = E x` of the coordinates: the hub and the displacements of active nodes of a gear
//! with a field, the touched coordinates of any other. In these
//!
//! ```text
//! dN = h + D_g W z,    z = (I + R S)^-1 R W^T h,    h = D_g V dy + D_r D V dy',    df = E^T V^T dN
//! ```
//!
//! with the derivatives `D_g`, `D_r` of the laws, the points' rows `V`, and `D` by which the nodes follow
//! ([`DissipativeSolve`](crate::contact::nodal::DissipativeSolve)); with a retardation time `beta`, `h` has `D_g beta V
//! dy'` as well. With the weights of a Newton matrix `h = D_c V y`, `D_c = (c.k + c.d beta) D_g + c.d D_r D`, so forces
//! respond with `T = V^T D_c V + (W^T D_g V)^T (I + R S)^-1 R (W^T D_c V)`, and the correction is
//!
//! ```text
//! (I - G T) y = y0,    G = E A0^-1 E^T,    x = x0 + A0^-1 E^T T y
//! ```
//!
//! Points with friction have a second row each, along the profile, and neighbours that their friction moves as well: the
//! changes of both forces come out of [`DissipativeSolve::tangent`](crate::contact::nodal::DissipativeSolve::tangent).
//!
//! How directions turn with the state is left out: a part `g / rho` of what is kept; and how `D` changes as points close.

mod direct;

use super::islands::{IslandSolution, Nodal};
use crate::contact::nodal::{Spring, UNUSED};
use crate::kinematics::Row;
use crate::law::{LawForce, SeenBy};
use crate::scene::members::{SceneGear, SceneMesh};
use gearbench_integrators::system::{Coeffs, Singular};

const NONE: u32 = u32::MAX;

/// Entry of a row of `V` or of a contact without a field: `(index in y, value)`.
pub(in crate::scene) type Entry = (u32, f64);

/// Rows of points: their entries, and the start of each row.
#[derive(Default)]
pub(in crate::scene) struct Rows {
    entries: Vec<Entry>,
    begins: Vec<usize>,
}

impl Rows {
    fn clear(&mut self) {
        self.entries.clear();
        self.begins.clear();
        self.begins.push(0);
    }

    fn end(&mut self) {
        self.begins.push(self.entries.len());
    }

    pub(in crate::scene) fn row(&self, i: usize) -> &[Entry] {
        &self.entries[self.begins[i]..self.begins[i + 1]]
    }
}

/// Buffers of the tangent.
#[derive(Default)]
pub(in crate::scene) struct ReducedTangent {
    /// Index in `y` of each coordinate of the scene.
    pub(in crate::scene) mark: Vec<u32>,
    /// Affected coordinates of each gear in its own numbering, the start of these in `y`, and the start of its nodes.
    pub(in crate::scene) touched: Vec<(Vec<u32>, usize, usize)>,
    /// Index in `y` of each node of gears with a field, or none.
    pub(in crate::scene) places: Vec<Vec<u32>>,
    /// Index in `y` of each node along the profile; empty where that is not available.
    pub(in crate::scene) along: Vec<Vec<u32>>,
    /// Node numbers of each gear with a field, in the order of `y`.
    pub(in crate::scene) nodes: Vec<Vec<u32>>,
    pub(in crate::scene) size: usize,
    /// Rows of the points along the normal, then along the profile.
    pub(in crate::scene) rows: [Rows; 2],
    /// Response `T`, row-major.
    pub(in crate::scene) response: Vec<f64>,
    /// Block of `G` of one gear.
    pub(in crate::scene) block: Vec<f64>,
    /// Columns of `A0^-1 E^T` of gears with a field.
    pub(in crate::scene) columns: Vec<f64>,
    pub(in crate::scene) matrix: Vec<f64>,
    pub(in crate::scene) y: Vec<f64>,
    pub(in crate::scene) forces: Vec<f64>,
    /// Matrices `W^T D_g V` and `W^T D_c V`, by node.
    pub(in crate::scene) elastic: Vec<f64>,
    pub(in crate::scene) weighted: Vec<f64>,
    pub(in crate::scene) column: Vec<f64>,
    /// Quasi-static motion of the nodes in the rates of an island's points, column by column.
    pub(in crate::scene) followed: Vec<f64>,
}

impl ReducedTangent {
    /// Numbers the coordinates and nodes of the contacts.
    pub(in crate::scene) fn collect(
        &mut self,
        gears: &[SceneGear],
        nodal: &Nodal,
        rows: &[[Row; 4]],
        coordinates: usize,
    ) {
        self.mark.clear();
        self.mark.resize(coordinates, NONE);
        self.touched.resize_with(gears.len(), Default::default);
        self.places.resize_with(gears.len(), Default::default);
        self.along.resize_with(gears.len(), Default::default);
        self.nodes.resize_with(gears.len(), Default::default);
        for (touched, ..) in &mut self.touched {
            touched.clear();
        }
        let mut touch = |i: usize| {
            if self.mark[i] == NONE {
                let gear = gears.partition_point(|g| g.range().end <= i);
                self.mark[i] = 0;
                self.touched[gear].0.push((i - gears[gear].offset) as u32);
            }
        };
        for row in nodal.rows[..nodal.active.len()].iter().flatten() {
            row.for_each(|i, _| touch(i));
        }
        for row in rows.iter().flatten() {
            row.for_each(|i, _| touch(i));
        }
        for (g, torque) in gears.iter().zip(&nodal.torque) {
            let turns = g.model.displacement().is_some() || *torque != 0.0;
            if turns && g.model.hub().is_free() {
                touch(g.range().start);
            }
        }
        let mut size = 0;
        for (i, g) in gears.iter().enumerate() {
            let (touched, start, of_nodes) = &mut self.touched[i];
            *start = size;
            for &t in touched.iter() {
                self.mark[g.offset + t as usize] = size as u32;
                size += 1;
            }
            *of_nodes = size;
            let places = &mut self.places[i];
            places.clear();
            self.nodes[i].clear();
            if g.model.displacement().is_some() {
                for (&node, force) in nodal.gears[i].nodes.iter().zip(&nodal.gears[i].force) {
                    if *force == 0.0 {
                        places.push(NONE);
                    } else {
                        places.push(size as u32);
                        self.nodes[i].push(node);
                        size += 1;
                    }
                }
                let along = &mut self.along[i];
                along.clear();
                for (&number, place) in nodal.gears[i].along.iter().zip(&*places) {
                    if *place == NONE {
                        along.push(NONE);
                    } else {
                        along.push(size as u32);
                        self.nodes[i].push(number);
                        size += 1;
                    }
                }
            }
        }
        self.size = size;
    }

    /// Computes the rows `V` of the nodal points.
    pub(in crate::scene) fn rows(
        &mut self,
        gears: &[SceneGear],
        scene_meshes: &[SceneMesh],
        nodal: &Nodal,
    ) {
        for rows in &mut self.rows {
            rows.clear();
        }
        for (a, rows) in nodal.active.iter().zip(&nodal.rows) {
            if a.force.n != 0.0 {
                let p = &nodal.found.points[a.point];
                let mesh = &scene_meshes[p.mesh as usize];
                let radii = [a.effective_radii, a.sliding.effective_radii];
                let directions = 1 + usize::from(mesh.friction.is_some());
                for d in 0..directions {
                    let entries = &mut self.rows[d].entries;
                    rows[d].for_each(|i, value| entries.push((self.mark[i], value)));
                    for (k, &g) in mesh.gears.iter().enumerate() {
                        if radii[d][k] != 0.0 && gears[g].model.hub().is_free() {
                            entries.push((self.mark[gears[g].offset], radii[d][k]));
                        }
                        let places = [&self.places[g], &self.along[g]][d];
                        if p.slots[k][0] == UNUSED || places.is_empty() {
                            continue;
                        }
                        for (&slot, w) in p.slots[k].iter().zip(p.weights[k]) {
                            let place = places[slot as usize];
                            if place != NONE {
                                entries.push((place, -w));
                            }
                        }
                    }
                }
            }
            for rows in &mut self.rows {
                rows.end();
            }
        }
    }

    /// Computes `T` of the nodal points and of other contacts.
    pub(in crate::scene) fn respond(
        &mut self,
        nodal: &mut Nodal,
        c: Coeffs,
    ) -> Result<(), Singular> {
        let size = self.size;
        let mut response = std::mem::take(&mut self.response);
        response.clear();
        response.resize(size * size, 0.0);
        for (s, island) in nodal.solved.iter_mut().zip(&nodal.islands) {
            if s.points.is_empty() {
                continue;
            }
            if island.slides {
                self.respond_sliding(s, c, &mut response)?;
                continue;
            }
            for i in s.points.clone() {
                let weight = changes_by(&nodal.active[i].force, nodal.active[i].seen_by, c);
                let row = self.rows[0].row(i);
                add_outer(&mut response, size, row, row, weight);
            }
            if let Some(hard) = &mut s.hard {
                // Column by column: few contacts are hard, and fewer still are solved implicitly.
                for j in 0..size {
                    let entry = |i: usize| -> f64 {
                        let row = self.rows[0].row(i);
                        let of_j = row.iter().filter(|(k, _)| *k as usize == j);
                        of_j.map(|(_, value)| c.k * value).sum()
                    };
                    self.column.clear();
                    self.column.extend(s.points.clone().map(entry));
                    if self.column.iter().all(|x| *x == 0.0) {
                        continue;
                    }
                    hard.tangent(&mut self.column)?;
                    for (i, dn) in s.points.clone().zip(&self.column) {
                        for &(k, value) in self.rows[0].row(i) {
                            response[k as usize * size + j] += value * dn;
                        }
                    }
                }
                continue;
            }
            let damped = s.springs.iter().any(|s| s.force.dn_dgdot != 0.0);
            if damped && c.d != 0.0 {
                self.follow(s)?;
            } else {
                self.followed.clear();
            }
            let points = s.points.clone();
            // c.d D_r of the part of the rates that nodes follow.
            let of_followed = |spring: &Spring| c.d * spring.force.dn_dgdot;
            for (j, column) in self.followed.chunks_exact(points.len()).enumerate() {
                for ((i, spring), x) in points.clone().zip(&s.springs).zip(column) {
                    for &(k, value) in self.rows[0].row(i) {
                        response[k as usize * size + j] += value * of_followed(spring) * x;
                    }
                }
            }
            s.solve.linearise(&s.springs)?;
            let n = s.solve.nodes();
            for (out, elastic) in [(&mut self.elastic, true), (&mut self.weighted, false)] {
                out.clear();
                out.resize(n * size, 0.0);
                for (spring, i) in s.springs.iter().zip(s.points.clone()) {
                    let d = match elastic {
                        true => spring.force.dn_dg,
                        false => changes_by(&spring.force, spring.seen_by, c),
                    };
                    let row = self.rows[0].row(i);
                    for (&node, w) in spring.nodes.iter().zip(spring.weights) {
                        for &(j, value) in row {
                            out[j as usize * n + node as usize] += d * w * value;
                        }
                    }
                }
            }
            for (j, column) in self.followed.chunks_exact(points.len()).enumerate() {
                for (spring, x) in s.springs.iter().zip(column) {
                    spring.add(of_followed(spring) * x, &mut self.weighted[j * n..][..n]);
                }
            }
            for j in 0..size {
                let column = &mut self.weighted[j * n..][..n];
                if column.iter().all(|x| *x == 0.0) {
                    continue;
                }
                s.solve.apply_compliance(column);
                for i in 0..size {
                    let of_i = &self.elastic[i * n..][..n];
                    response[i * size + j] +=
                        of_i.iter().zip(&*column).map(|(x, y)| x * y).sum::<f64>();
                }
            }
        }
        self.response = response;
        Ok(())
    }

    /// Adds `T` of the points of an island with friction.
    fn respond_sliding(
        &mut self,
        s: &mut IslandSolution,
        c: Coeffs,
        response: &mut [f64],
    ) -> Result<(), Singular> {
        self.followed.clear();
        if c.d != 0.0 && s.springs.iter().any(|s| s.force.dn_dgdot != 0.0) {
            self.follow(s)?;
        }
        s.dissipative.factorise(&s.springs)?;
        let (size, points) = (self.size, s.points.len());
        // What the forces of all points change by with each entry of `y`, were their neighbours to stay.
        let mut changes = vec![[0.0; 2]; size * points];
        for (k, i) in s.points.clone().enumerate() {
            let spring = &s.springs[k];
            let by = [
                changes_by(&spring.force, spring.seen_by, c),
                c.d * spring.friction_force.df_dv,
            ];
            for (d, rows) in self.rows.iter().enumerate() {
                for &(j, value) in rows.row(i) {
                    changes[j as usize * points + k][d] += by[d] * value;
                }
            }
        }
        for (i, (changes, followed)) in changes.iter_mut().zip(&self.followed).enumerate() {
            changes[0] += c.d * s.springs[i % points].force.dn_dgdot * followed;
        }
        for (j, changes) in changes.chunks_exact_mut(points).enumerate() {
            if changes.iter().all(|x| *x == [0.0; 2]) {
                continue;
            }
            s.dissipative.tangent(&s.springs, changes);
            for (i, change) in s.points.clone().zip(changes) {
                for (rows, dn) in self.rows.iter().zip(change) {
                    for &(k, value) in rows.row(i) {
                        response[k as usize * size + j] += value * *dn;
                    }
                }
            }
        }
        Ok(())
    }

    /// Computes the quasi-static motion of the nodes of an island in the rates of its points, `(D - I) V`, in
    /// `followed`, column by column.
    fn follow(&mut self, s: &mut IslandSolution) -> Result<(), Singular> {
        s.solve.linearise_holding(&s.springs)?;
        self.followed.clear();
        self.followed.resize(self.size * s.springs.len(), 0.0);
        let mut columns = self.followed.chunks_exact_mut(s.springs.len());
        let mut rows: Vec<&mut [f64]> = columns.by_ref().collect();
        for (at, i) in s.points.clone().enumerate() {
            for &(j, value) in self.rows[0].row(i) {
                rows[j as usize][at] += value;
            }
        }
        for column in rows {
            if column.iter().all(|x| *x == 0.0) {
                continue;
            }
            self.column.clear();
            self.column.extend_from_slice(column);
            s.solve.follow(&s.springs, column, &mut self.weighted);
            for (x, own) in column.iter_mut().zip(&self.column) {
                *x -= own;
            }
        }
        Ok(())
    }
}

/// Returns the change of the normal force of a point, were its neighbours to stay, by its gap and rate before residual
/// compliance with the weights of a Newton matrix.
fn changes_by(force: &LawForce, seen_by: SeenBy, c: Coeffs) -> f64 {
    let seen = c.k * seen_by.gap + c.d * seen_by.rate;
    seen * force.dn_dg + c.d * force.dn_dgdot
}

/// Adds an outer product: `T += factor left right^T`.
fn add_outer(t: &mut [f64], size: usize, left: &[Entry], right: &[Entry], factor: f64) {
    for &(i, x) in left {
        for &(j, y) in right {
            t[i as usize * size + j as usize] += factor * x * y;
        }
    }
}
