//! Tangent and Newton correction with contacts of gears with fields.
//!
//! Contacts see few combinations `y = E x` of the coordinates: the hub and the displacements of active nodes of a gear
//! with a field, the touched coordinates of any other. In these
//!
//! ```text
//! dN = h + D_g W z,    z = (I + R S)^-1 R W^T h,    h = D_g V dy + D_r V dy',    df = E^T V^T dN
//! ```
//!
//! with the derivatives `D` of the laws and the points' rows `V`. With the weights of a Newton matrix `h = D_c V y`,
//! `D_c = c.k D_g + c.d D_r`, so forces answer with `T = V^T D_c V + (W^T D_g V)^T (I + R S)^-1 R (W^T D_c V)`, and
//! the correction is
//!
//! ```text
//! (I - G T) y = y0,    G = E A0^-1 E^T,    x = x0 + A0^-1 E^T T y
//! ```
//!
//! How directions turn with the state is left out: a part `g / rho` of what is kept.

use super::contacts::Active;
use super::nodal::Nodal;
use super::{Scene, SceneGear, SceneMesh};
use crate::contact::nodal::UNUSED;
use crate::gear::capabilities::{add_response, condensed};
use crate::kinematics::Row;
use gearbench_integrators::dense_solve::solve_in_place;
use gearbench_integrators::system::{At, Coeffs, Singular};

const NONE: u32 = u32::MAX;

/// One row of `V` or of a contact without a field: entries `(index in y, value)`.
type Entry = (u32, f64);

/// Buffers of the tangent.
#[derive(Default)]
pub(super) struct Reduced {
    /// Per coordinate of the scene: its place in `y`.
    mark: Vec<u32>,
    /// Per gear: own numbers of the touched coordinates, where they begin in `y`, where its nodes do.
    touched: Vec<(Vec<u32>, usize, usize)>,
    /// Per gear with a field: place in `y` of each node, or none.
    places: Vec<Vec<u32>>,
    /// Per gear with a field: node numbers in the order of `y`.
    nodes: Vec<Vec<u32>>,
    size: usize,
    entries: Vec<Entry>,
    begins: Vec<usize>,
    /// `T`, row-major.
    response: Vec<f64>,
    /// `G` of one gear.
    block: Vec<f64>,
    /// `A0^-1 E^T` of gears with a field, one column after the other.
    columns: Vec<f64>,
    matrix: Vec<f64>,
    y: Vec<f64>,
    forces: Vec<f64>,
    /// `W^T D_g V`, `W^T D_c V`, by node.
    elastic: Vec<f64>,
    weighted: Vec<f64>,
    column: Vec<f64>,
}

impl Reduced {
    /// Numbers the coordinates and nodes that contacts see.
    fn collect(
        &mut self,
        gears: &[SceneGear],
        nodal: &Nodal,
        rows: &[[Row; 3]],
        coordinates: usize,
    ) {
        self.mark.clear();
        self.mark.resize(coordinates, NONE);
        self.touched.resize_with(gears.len(), Default::default);
        self.places.resize_with(gears.len(), Default::default);
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
        for row in &nodal.rows[..nodal.active.len()] {
            row.for_each(|i, _| touch(i));
        }
        for row in rows.iter().flatten() {
            row.for_each(|i, _| touch(i));
        }
        for (g, torque) in gears.iter().zip(&nodal.torque) {
            let turns = g.model.displacement().is_some() || *torque != 0.0;
            if turns && g.model.hub().coordinates() > 0 {
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
            }
        }
        self.size = size;
    }

    /// Rows `V` of the nodal points.
    fn rows(&mut self, gears: &[SceneGear], scene_meshes: &[SceneMesh], nodal: &Nodal) {
        self.entries.clear();
        self.begins.clear();
        self.begins.push(0);
        for (a, row) in nodal.active.iter().zip(&nodal.rows) {
            if a.force.n != 0.0 {
                row.for_each(|i, value| self.entries.push((self.mark[i], value)));
                let p = &nodal.found.points[a.point];
                for (k, &g) in scene_meshes[p.mesh as usize].gears.iter().enumerate() {
                    if a.effective_radii[k] != 0.0 && gears[g].model.hub().coordinates() > 0 {
                        self.entries
                            .push((self.mark[gears[g].offset], a.effective_radii[k]));
                    }
                    if p.slots[k][0] == UNUSED {
                        continue;
                    }
                    for (&slot, w) in p.slots[k].iter().zip(p.weights[k]) {
                        let place = self.places[g][slot as usize];
                        if place != NONE {
                            self.entries.push((place, -w));
                        }
                    }
                }
            }
            self.begins.push(self.entries.len());
        }
    }

    fn row(&self, i: usize) -> &[Entry] {
        &self.entries[self.begins[i]..self.begins[i + 1]]
    }

    /// `T` of the nodal points and of other contacts.
    fn respond(&mut self, nodal: &mut Nodal, c: Coeffs) -> Result<(), Singular> {
        let size = self.size;
        let mut response = std::mem::take(&mut self.response);
        response.clear();
        response.resize(size * size, 0.0);
        for (i, a) in nodal.active.iter().enumerate() {
            let weight = c.k * a.force.dn_dg + c.d * a.force.dn_dgdot;
            add_outer(&mut response, size, self.row(i), self.row(i), weight);
        }
        for s in nodal.solved.iter_mut().filter(|s| !s.points.is_empty()) {
            if let Some(hard) = &mut s.hard {
                // Column by column: few contacts are hard, and fewer still are solved implicitly.
                for j in 0..size {
                    let entry = |i: usize| -> f64 {
                        let row = &self.entries[self.begins[i]..self.begins[i + 1]];
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
                        for &(k, value) in &self.entries[self.begins[i]..self.begins[i + 1]] {
                            response[k as usize * size + j] += value * dn;
                        }
                    }
                }
                continue;
            }
            s.solve.linearise(&s.springs)?;
            let n = s.solve.nodes();
            for (out, weights) in [
                (&mut self.elastic, (1.0, 0.0)),
                (&mut self.weighted, (c.k, c.d)),
            ] {
                out.clear();
                out.resize(n * size, 0.0);
                for (spring, i) in s.springs.iter().zip(s.points.clone()) {
                    let d = weights.0 * spring.force.dn_dg + weights.1 * spring.force.dn_dgdot;
                    let row = &self.entries[self.begins[i]..self.begins[i + 1]];
                    for (&node, w) in spring.nodes.iter().zip(spring.weights) {
                        for &(j, value) in row {
                            out[j as usize * n + node as usize] += d * w * value;
                        }
                    }
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

    /// Adds `T` of a contact without fields, its friction included.
    fn add_contact(&mut self, a: &Active, along_path: f64, rows: &[Row; 3], c: Coeffs) {
        let (mut normal, mut first, mut sliding) = (vec![], vec![], vec![]);
        rows[0].for_each(|i, x| normal.push((self.mark[i], x)));
        rows[0].for_each_first(|i, x| first.push((self.mark[i], x)));
        rows[1].for_each(|i, x| sliding.push((self.mark[i], x)));
        let per_gap = c.k * a.force.dn_dg + c.d * a.force.dn_dgdot;
        let per_path = c.k * a.force.dn_dk * along_path;
        let (t, n) = (&mut self.response, self.size);
        for (row, factor) in [(&normal, 1.0), (&sliding, a.friction.df_dn)] {
            add_outer(t, n, row, &normal, factor * per_gap);
            add_outer(t, n, row, &first, factor * per_path);
        }
        add_outer(t, n, &sliding, &sliding, c.d * a.friction.df_dv);
    }
}

/// `T += factor left right^T`.
fn add_outer(t: &mut [f64], size: usize, left: &[Entry], right: &[Entry], factor: f64) {
    for &(i, x) in left {
        for &(j, y) in right {
            t[i as usize * size + j as usize] += factor * x * y;
        }
    }
}

impl Scene {
    /// Adds the contacts to `x0 = A0^-1 rhs`.
    pub(super) fn correct_nodal(
        &mut self,
        at: At<'_>,
        c: Coeffs,
        x: &mut [f64],
    ) -> Result<(), Singular> {
        if self.work.nodal.failed {
            return Err(Singular);
        }
        let mut b = std::mem::take(&mut self.work.reduced);
        let result = self.correct_reduced(at, c, x, &mut b);
        self.work.reduced = b;
        result
    }

    fn correct_reduced(
        &mut self,
        at: At<'_>,
        c: Coeffs,
        x: &mut [f64],
        b: &mut Reduced,
    ) -> Result<(), Singular> {
        let Scene {
            gears,
            meshes,
            work,
            ..
        } = self;
        let contacts = work.active.len();
        b.collect(gears, &work.nodal, &work.rows[..contacts], x.len());
        b.rows(gears, meshes, &work.nodal);
        b.respond(&mut work.nodal, c)?;
        for (a, rows) in work.active.iter().zip(&work.rows) {
            let candidate = &work.candidates[a.candidate];
            let along_path = -candidate.stiffness_s / candidate.scale[0];
            b.add_contact(a, along_path, rows, c);
        }
        let size = b.size;
        if size == 0 {
            return Ok(());
        }
        // I - G T, gear by gear, and y0.
        b.matrix.clear();
        b.matrix.resize(size * size, 0.0);
        b.y.clear();
        b.y.resize(size, 0.0);
        b.columns.clear();
        for (i, g) in gears.iter_mut().enumerate() {
            let (touched, start, of_nodes) = &b.touched[i];
            let (start, n) = (*start, of_nodes - start + b.nodes[i].len());
            if n == 0 {
                continue;
            }
            b.block.clear();
            b.block.resize(n * n, 0.0);
            let (own, viscous, range) = (g.at(at), g.viscous(), g.range());
            if g.model.displacement().is_some() {
                let hub = touched.len();
                for j in 0..n {
                    b.column.clear();
                    b.column.resize(range.len(), 0.0);
                    if j < hub {
                        b.column[0] = 1.0;
                    } else if let Some(field) = g.model.displacement() {
                        field.apply_nodal_forces(&[b.nodes[i][j - hub]], &[-1.0], &mut b.column);
                    }
                    g.model.correct(own, c, viscous, &mut b.column)?;
                    if hub > 0 {
                        b.block[j * n] = b.column[0];
                    }
                    if let Some(field) = g.model.displacement() {
                        field.displacements(
                            &b.column,
                            &b.nodes[i],
                            &mut b.block[j * n + hub..][..n - hub],
                        );
                    }
                    b.columns.extend_from_slice(&b.column);
                }
                let y = &mut b.y[start..][..n];
                if hub > 0 {
                    y[0] = x[range.start];
                }
                if let Some(field) = g.model.displacement() {
                    field.displacements(&x[range], &b.nodes[i], &mut y[hub..]);
                }
            } else {
                for (y, &t) in b.y[start..].iter_mut().zip(touched) {
                    *y = x[range.start + t as usize];
                }
                condensed(g.model.as_mut(), own, c, viscous, touched, &mut b.block)?;
            }
            // The block is symmetric.
            for (k, line) in b.block.chunks_exact(n).enumerate() {
                let out = &mut b.matrix[(start + k) * size..][..size];
                for (j, g) in line.iter().enumerate() {
                    let of_j = &b.response[(start + j) * size..][..size];
                    for (out, t) in out.iter_mut().zip(of_j) {
                        *out -= g * t;
                    }
                }
            }
        }
        for k in 0..size {
            b.matrix[k * size + k] += 1.0;
        }
        solve_in_place(&mut b.matrix, &mut b.y)?;
        b.forces.clear();
        for line in b.response.chunks_exact(size) {
            b.forces
                .push(line.iter().zip(&b.y).map(|(t, y)| t * y).sum());
        }
        let mut columns = b.columns.as_slice();
        for (i, g) in gears.iter_mut().enumerate() {
            let (touched, start, of_nodes) = &b.touched[i];
            let n = of_nodes - start + b.nodes[i].len();
            let forces = &b.forces[*start..][..n];
            let (own, viscous, range) = (g.at(at), g.viscous(), g.range());
            if g.model.displacement().is_some() {
                for force in forces {
                    let (column, rest) = columns.split_at(range.len());
                    columns = rest;
                    for (x, z) in x[range.clone()].iter_mut().zip(column) {
                        *x += force * z;
                    }
                }
            } else if n > 0 {
                let touched = (touched.as_slice(), forces);
                add_response(g.model.as_mut(), own, c, viscous, touched, &mut x[range])?;
            }
        }
        Ok(())
    }

    /// Adds what the nodal contacts' forces change by along a direction of coordinates and velocities.
    pub(super) fn add_nodal_tangent(&mut self, [dq, dv]: [&[f64]; 2], df: &mut [f64]) {
        let mut b = std::mem::take(&mut self.work.reduced);
        let Scene {
            gears,
            meshes,
            work,
            ..
        } = self;
        let nodal = &mut work.nodal;
        b.collect(gears, nodal, &[], df.len());
        b.rows(gears, meshes, nodal);
        let along = |b: &mut Reduced, x: &[f64]| -> Vec<f64> {
            let mut y = vec![0.0; b.size];
            for (i, g) in gears.iter().enumerate() {
                let (touched, start, of_nodes) = &b.touched[i];
                for (y, &t) in y[*start..].iter_mut().zip(touched) {
                    *y = x[g.offset + t as usize];
                }
                if let Some(field) = g.model.displacement() {
                    let n = b.nodes[i].len();
                    field.displacements(&x[g.range()], &b.nodes[i], &mut y[*of_nodes..][..n]);
                }
            }
            y
        };
        let (y, rate) = (along(&mut b, dq), along(&mut b, dv));
        let dot = |row: &[Entry], y: &[f64]| -> f64 {
            row.iter().map(|&(i, value)| value * y[i as usize]).sum()
        };
        let mut of_points: Vec<f64> = (nodal.active.iter().enumerate())
            .map(|(i, a)| {
                a.force.dn_dg * dot(b.row(i), &y) + a.force.dn_dgdot * dot(b.row(i), &rate)
            })
            .collect();
        let mut failed = nodal.failed;
        for s in nodal.solved.iter_mut().filter(|s| !s.points.is_empty()) {
            if let Some(hard) = &mut s.hard {
                let points = &mut of_points[s.points.clone()];
                for (i, h) in s.points.clone().zip(&mut *points) {
                    *h = dot(b.row(i), &y);
                }
                failed |= hard.tangent(points).is_err();
                continue;
            }
            failed |= s.solve.linearise(&s.springs).is_err();
            let mut z = vec![0.0; s.solve.nodes()];
            let points = &mut of_points[s.points.clone()];
            for (spring, h) in s.springs.iter().zip(&*points) {
                spring.add(*h, &mut z);
            }
            s.solve.apply_compliance(&mut z);
            for (spring, h) in s.springs.iter().zip(points) {
                *h += spring.force.dn_dg * spring.along(&z);
            }
        }
        let mut forces = vec![0.0; b.size];
        for (i, dn) in of_points.iter().enumerate() {
            for &(j, value) in b.row(i) {
                forces[j as usize] += value * dn;
            }
        }
        for (i, g) in gears.iter().enumerate() {
            let (touched, start, of_nodes) = &b.touched[i];
            for (f, &t) in forces[*start..].iter().zip(touched) {
                df[g.offset + t as usize] += f;
            }
            if let Some(field) = g.model.displacement() {
                let n = b.nodes[i].len();
                // Forces on nodes press inwards, these act outwards.
                let inward: Vec<f64> = forces[*of_nodes..][..n].iter().map(|f| -f).collect();
                field.apply_nodal_forces(&b.nodes[i], &inward, &mut df[g.range()]);
            }
        }
        if failed {
            df.fill(f64::NAN);
        }
        self.work.reduced = b;
    }
}
