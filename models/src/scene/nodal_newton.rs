//! Tangent and Newton correction of a scene with displacement fields, in the coordinates of [`ReducedTangent`].

use super::assembled::Scene;
use super::members::SceneMesh;
use super::nodal::{Entry, NodalActive, ReducedTangent, line_rows, rows_of};
use crate::Vec3;
use crate::contact::nodal::LineSlope;
use crate::gear::{add_response, condensed};
use crate::kinematics::{HubPose, Row};
use gearbench_integrators::dense_solve::solve_in_place;
use gearbench_integrators::system::{Coeffs, Singular, StateView};

impl Scene {
    /// Adds the contacts to `x0 = A0^-1 rhs`.
    pub(super) fn correct_nodal(
        &mut self,
        at: StateView<'_>,
        c: Coeffs,
        x: &mut [f64],
    ) -> Result<(), Singular> {
        if self.work.nodal.failed {
            return Err(Singular);
        }
        self.tangents_of_contacts(at)?;
        let mut b = std::mem::take(&mut self.work.reduced);
        let result = self.correct_reduced(at, c, x, &mut b);
        self.work.reduced = b;
        result
    }

    fn correct_reduced(
        &mut self,
        at: StateView<'_>,
        c: Coeffs,
        x: &mut [f64],
        b: &mut ReducedTangent,
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
        for ((a, rows), t) in work.active.iter().zip(&work.rows).zip(&work.tangents) {
            b.add_contact(a, t, rows, c);
        }
        for coupling in &work.couplings {
            let to = (&work.tangents[coupling.to], &work.rows[coupling.to][0]);
            b.add_coupling(
                coupling,
                &work.rows[coupling.of],
                to,
                &work.active[coupling.of],
                c,
            );
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
                        b.column[touched[j] as usize] = 1.0;
                    } else if let Some(field) = g.model.displacement() {
                        field.apply_nodal_forces(&[b.nodes[i][j - hub]], &[-1.0], &mut b.column);
                    }
                    g.model.correct(own, c, viscous, &mut b.column)?;
                    for (out, &t) in b.block[j * n..].iter_mut().zip(touched) {
                        *out = b.column[t as usize];
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
                for (y, &t) in y.iter_mut().zip(touched) {
                    *y = x[range.start + t as usize];
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

    /// Adds the change of the nodal contact forces along a direction of coordinates and velocities.
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
        let along = |b: &mut ReducedTangent, x: &[f64]| -> Vec<f64> {
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
        let [normal, sliding] = &b.rows;
        let mut rates: Vec<f64> = (0..nodal.active.len())
            .map(|i| dot(normal.row(i), &rate))
            .collect();
        let before = rates.clone();
        let mut failed = nodal.failed;
        let solved = nodal.solved.iter_mut().filter(|s| s.hard.is_none());
        for s in solved.filter(|s| s.springs.iter().any(|s| s.force.dn_dgdot != 0.0)) {
            failed |= s.solve.linearise_holding(&s.springs).is_err();
            let rates = &mut rates[s.points.clone()];
            s.solve.follow(&s.springs, rates, &mut Vec::new());
        }
        // Changes of the forces of all points, along the normal and of friction.
        let mut of_points: Vec<[f64; 2]> = (nodal.active.iter().zip(&rates).enumerate())
            .map(|(i, (a, by_rate))| {
                let seen = a.seen_by.gap * dot(normal.row(i), &y) + a.seen_by.rate * before[i];
                [
                    a.force.dn_dg * seen + a.force.dn_dgdot * by_rate,
                    a.sliding.force.df_dv * dot(sliding.row(i), &rate),
                ]
            })
            .collect();
        for (s, island) in nodal.solved.iter_mut().zip(&nodal.islands) {
            let points = &mut of_points[s.points.clone()];
            if points.is_empty() {
                continue;
            }
            if island.slides {
                failed |= s.dissipative.factorise(&s.springs).is_err();
                s.dissipative.tangent(&s.springs, points);
                continue;
            }
            if let Some(hard) = &mut s.hard {
                let mut changes: Vec<f64> =
                    (s.points.clone()).map(|i| dot(normal.row(i), &y)).collect();
                failed |= hard.tangent(&mut changes).is_err();
                for (h, change) in points.iter_mut().zip(changes) {
                    h[0] = change;
                }
                continue;
            }
            failed |= s.solve.linearise(&s.springs).is_err();
            let mut z = vec![0.0; s.solve.nodes()];
            for (spring, h) in s.springs.iter().zip(&*points) {
                spring.add(h[0], &mut z);
            }
            s.solve.apply_compliance(&mut z);
            for (spring, h) in s.springs.iter().zip(points) {
                h[0] += spring.force.dn_dg * spring.along(&z);
            }
        }
        let mut forces = vec![0.0; b.size];
        for (i, changes) in of_points.iter().enumerate() {
            for (rows, change) in b.rows.iter().zip(changes) {
                for &(j, value) in rows.row(i) {
                    forces[j as usize] += value * change;
                }
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

    /// Returns the prescribed part of the rate of a point along a direction [m/s]; the direction comes with the gap in
    /// its tip taper.
    pub(super) fn nodal_drift(
        &self,
        a: &NodalActive,
        along: (Vec3, f64),
        at: StateView<'_>,
    ) -> f64 {
        let p = &self.work.nodal.found.points[a.point];
        let mesh = &self.meshes[p.mesh as usize];
        let hub_poses = self.poses_of(mesh, at);
        let (effective_radii, mut drift) = rows_of(
            &self.gears,
            mesh,
            p,
            along,
            (
                &self.work.nodal.found,
                hub_poses.each_ref().map(Option::as_ref),
            ),
            at,
            &mut Row::default(),
        );
        drift += self.driven_drift(mesh, effective_radii, at);
        drift
    }

    /// Returns the prescribed part of the rate of a line [m/s] for a derivative of its gap by the motion of the hubs.
    pub(super) fn line_drift(
        &self,
        a: &NodalActive,
        of_line: &LineSlope,
        at: StateView<'_>,
    ) -> f64 {
        let found = &self.work.nodal.found;
        let p = &found.points[a.point];
        let mesh = &self.meshes[p.mesh as usize];
        let hub_poses = self.poses_of(mesh, at);
        let (effective_radii, drift) = line_rows(
            &self.gears,
            mesh,
            (p, found, of_line),
            hub_poses.each_ref().map(Option::as_ref),
            at,
            &mut Row::default(),
        );
        drift + self.driven_drift(mesh, effective_radii, at)
    }

    /// Returns the poses of the hubs of a mesh.
    fn poses_of(&self, mesh: &SceneMesh, at: StateView<'_>) -> [Option<HubPose>; 2] {
        mesh.gears.map(|g| {
            let own = self.gears[g].at(at);
            self.gears[g].model.hub().hub.hub_pose(own.t, own.q)
        })
    }

    /// Returns the part of the rate from driven hubs [m/s].
    fn driven_drift(&self, mesh: &SceneMesh, effective_radii: [f64; 2], at: StateView<'_>) -> f64 {
        let of_gear = |(radius, &g): (&f64, &usize)| {
            let hub = self.gears[g].model.hub();
            if !hub.is_free() {
                radius * hub.speed(at.t, &[])
            } else {
                0.0
            }
        };
        effective_radii.iter().zip(&mesh.gears).map(of_gear).sum()
    }
}
