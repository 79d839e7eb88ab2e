//! A gear with fixed bore, by finite elements, under loads distributed over its flanks.

use gearbench_models::geometry::{Gear, Side};
use gearbench_models::stiffness::Material;
use gearbench_reference::gear_mesh::{self, GearMeshParams, Tooth};
use gearbench_reference::reduction::{Basis, ModeSelection, Mounting, Request};
use std::f64::consts::PI;

/// Elements along the flank; all other counts follow.
fn params(flank: usize) -> GearMeshParams {
    GearMeshParams {
        tooth: Tooth {
            flank,
            fillet: flank / 3,
            root: (flank / 8).max(2),
            across: 2 * (flank / 4),
        },
        layers: flank / 6,
        rim: flank / 3,
        width: 2,
        ..GearMeshParams::default()
    }
}

/// A gear with fixed bore, by finite elements.
pub struct Elements<'a> {
    gear: &'a Gear,
    basis: Basis,
    material: Material,
    /// Half length of the spread load [m].
    spread: f64,
}

/// Load spread over flank nodes: node, part.
type Spread = Vec<(u32, f64)>;

impl Elements<'_> {
    pub fn new(gear: &Gear, material: Material, flank: usize, spread: f64) -> Elements<'_> {
        let mesh = gear_mesh::sector(gear, &params(flank)).unwrap();
        let basis = Request {
            along_profile: false,
            foreign: None,
            mesh: &mesh,
            sector: true,
            material,
            mounting: Mounting::gear(false, 0.0),
            wanted: ModeSelection::Count(0),
        }
        .compute()
        .unwrap();
        Elements {
            gear,
            basis,
            material,
            spread,
        }
    }

    /// Length of the involute up to the path coordinate `s`.
    pub fn arc(&self, s: f64) -> f64 {
        s * s / (2.0 * self.gear.r_base())
    }

    /// The raised cosine about the path coordinate `s` on the left flank of a tooth, evenly over the width, and the
    /// double integral of the logarithm under it.
    pub fn load(&self, tooth: u32, s: f64) -> (Spread, f64) {
        let flanks = &self.basis.flanks;
        let grid = &flanks.grids()[flanks.find(tooth, Side::Left).unwrap()];
        let first: usize = (flanks.grids().iter())
            .take_while(|g| (g.tooth, g.side) != (tooth, Side::Left))
            .map(|g| g.rows * g.columns)
            .sum();
        let x: Vec<f64> = (0..grid.rows)
            .map(|row| {
                let at = grid.positions[row * grid.columns];
                let r2 = at.x * at.x + at.y * at.y;
                (r2 - self.gear.r_base().powi(2)).max(0.0) / (2.0 * self.gear.r_base())
            })
            .collect();
        let centre = self.arc(s);
        // The weights of the nodes by fine quadrature of cosine times shape function.
        let n = 4000;
        let mut weights = vec![0.0; grid.rows];
        let mut places = Vec::new();
        for i in 0..n {
            let u = (2.0 * f64::from(i) + 1.0) / f64::from(n) - 1.0;
            let w = (1.0 + (PI * u).cos()) / f64::from(n);
            let at = centre + u * self.spread;
            let row = x.partition_point(|y| *y <= at).clamp(1, grid.rows - 1);
            assert!(
                x[0] <= at && at <= x[grid.rows - 1],
                "load beyond the flank"
            );
            let part = (at - x[row - 1]) / (x[row] - x[row - 1]);
            weights[row - 1] += w * (1.0 - part);
            weights[row] += w * part;
            if i % 10 == 5 {
                places.push((u * self.spread, 10.0 * w));
            }
        }
        let columns = grid.columns as f64 - 1.0;
        let mut spread = Vec::new();
        for (row, w) in weights.iter().enumerate().filter(|(_, w)| **w > 0.0) {
            for column in 0..grid.columns {
                let end = column == 0 || column + 1 == grid.columns;
                let share = if end { 0.5 } else { 1.0 } / columns;
                spread.push(((first + row * grid.columns + column) as u32, w * share));
            }
        }
        let cell = 20.0 * self.spread / f64::from(n);
        let log = (places.iter())
            .flat_map(|a| places.iter().map(move |b| (a, b)))
            .map(|((x, v), (y, w))| {
                let d = (x - y).abs();
                // The mean of the logarithm over two equal cells that coincide.
                let ln = if d < 0.5 * cell {
                    cell.ln() - 1.5
                } else {
                    d.ln()
                };
                v * w * ln
            })
            .sum();
        (spread, log)
    }

    pub fn between(&self, a: &Spread, b: &Spread) -> f64 {
        let flanks = &self.basis.compliance.flanks;
        let nodes = self.basis.normals.len();
        let row = |i: u32, v: f64| -> f64 {
            b.iter()
                .map(|&(j, w)| v * w * flanks.between(i, j, nodes))
                .sum()
        };
        self.gear.face_width() * a.iter().map(|&(i, v)| row(i, v)).sum::<f64>()
    }

    /// Half-plane constant A [m^2/N].
    pub fn a(&self) -> f64 {
        2.0 / (PI * self.material.plane_strain())
    }

    /// Path coordinates between which the spread load fits the flank.
    pub fn reach(&self) -> [f64; 2] {
        let roll = |r: f64| (r * r - self.gear.r_base().powi(2)).max(0.0).sqrt();
        let back = |arc: f64| (2.0 * self.gear.r_base() * arc).max(0.0).sqrt();
        let edge = 1.001 * self.spread;
        [
            back(self.arc(roll(self.gear.r_form())) + edge),
            back(self.arc(roll(self.gear.r_tip())) - edge),
        ]
    }

    /// `T_i` at `s` [m^2/N]; where the load does not fit, continued by the parabola through three places inside.
    pub fn own(&self, s: f64) -> f64 {
        self.continued(s, &|s| {
            let (load, log) = self.load(0, s);
            self.between(&load, &load) + self.a() * log
        })
    }

    /// Returns the compliance between a tooth loaded at `low` and the one `m` pitches on, loaded at `high` [m^2/N].
    pub fn coupling(&self, m: u32, low: f64, high: f64) -> f64 {
        let outer = |high: f64| {
            self.continued(low, &|low| {
                self.between(&self.load(0, low).0, &self.load(m, high).0)
            })
        };
        self.continued(high, &outer)
    }

    fn continued(&self, s: f64, f: &dyn Fn(f64) -> f64) -> f64 {
        let [low, high] = self.reach();
        if (low..=high).contains(&s) {
            return f(s);
        }
        let step = 0.15 * (high - low);
        let (edge, inward) = if s < low { (low, step) } else { (high, -step) };
        let [a, b, c] = [0.0, 1.0, 2.0].map(|i| f(edge + i * inward));
        let t = (s - edge) / inward;
        a * (1.0 - t) * (2.0 - t) / 2.0 + b * t * (2.0 - t) + c * t * (t - 1.0) / 2.0
    }
}
