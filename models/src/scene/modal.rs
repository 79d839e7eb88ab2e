//! The scene as independent oscillators and a rest, for methods that are exact for the linear part, and how long
//! nothing touches.
//!
//! **Flight.** Under steady loads the hubs move as `theta = theta_0 + theta' t + theta'' t^2 / 2` and facing flanks of
//! rigid gears are apart by at least `c + p . theta` ([`LineClearance`](crate::contact::lines_of_action::LineClearance)). An elastic flank stands outward of the rigid one
//! by `B q + r T`. About the deflection `q_s = g / omega^2` of steady loads `g` the modes keep (with damping lose) the
//! energy `E = sum (v^2 + omega^2 (q - q_s)^2) / 2`, so that by Cauchy and Schwarz
//!
//! ```text
//! |B q + r T| <= sqrt(2 c E) + sqrt(c sum omega^2 q_s^2) + max |r| |T|,   c = max over the nodes of sum b^2 / omega^2
//! ```
//!
//! ([`NormalField::bound`]). No contact can be earlier than the first zero of the clearance less these bounds.

use super::{Scene, SceneGear};
use crate::gear::elastic::NormalField;
use crate::load::Load;
use crate::mount::Mount;
use gearbench_integrators::system::{At, ModalSplit, SecondOrderSystem, State};

/// What the split needs beside the gears.
#[derive(Clone, Debug, Default)]
pub(super) struct Split {
    /// Largest displacement of a flank node by unit load on the hub, per gear.
    hub: Vec<f64>,
    /// How far a flank stands outward at most, per gear.
    reach: Vec<f64>,
    /// Per coordinate: squared frequency, acceleration by steady loads, largest swing.
    square: Vec<f64>,
    steady: Vec<f64>,
    swing: Vec<f64>,
}

impl Split {
    /// `None` where a gear's coordinates are no oscillators.
    pub(super) fn of(gears: &[SceneGear], n: usize) -> Option<Split> {
        let mut split = Split {
            square: vec![0.0; n],
            steady: vec![0.0; n],
            swing: vec![0.0; n],
            hub: Vec::with_capacity(gears.len()),
            reach: vec![0.0; gears.len()],
        };
        for g in gears {
            let oscillators = g.model.oscillators()?;
            for (square, w) in split.square[g.range()].iter_mut().zip(oscillators.omega) {
                *square = w * w;
            }
            let field = g.model.field();
            split
                .hub
                .push(field.map_or(0.0, |f| f.largest_hub_compliance()));
        }
        Some(split)
    }
}

impl SceneGear {
    /// True when the load on its hub is constant from `t` until the next knot.
    fn is_steady(&self, t: f64) -> bool {
        let constant = |l: &Load| match l {
            Load::Applied(p) => p.slope(t) == 0.0,
            Load::Viscous(c) => *c == 0.0,
        };
        self.model.hub().coordinates() == 0 || self.loads.iter().all(constant)
    }

    /// Travel, speed and acceleration of its frame while all loads are steady.
    fn frame(&self, at: At<'_>, steady: &[f64]) -> [f64; 3] {
        let hub = self.model.hub();
        let own = self.at(at);
        let acceleration = match &hub.mount {
            Mount::Revolute | Mount::Prismatic => steady[self.offset],
            Mount::Driven(_) | Mount::Fixed => hub.prescribed_acceleration(at.t),
        };
        [
            hub.travel(at.t, own.q),
            hub.speed(at.t, own.v),
            acceleration,
        ]
    }
}

/// The first positive zero of `c + b t + a t^2 / 2` for `c > 0`, infinite where there is none.
fn first_zero(c: f64, b: f64, a: f64) -> f64 {
    // c + b t + a t^2/2 = 0 with u = 1/t: c u^2 + b u + a/2 = 0, whose largest root is the first zero.
    let disc = b * b - 2.0 * a * c;
    if disc < 0.0 {
        return f64::INFINITY;
    }
    let root = disc.sqrt();
    let u = if b <= 0.0 {
        (root - b) / (2.0 * c)
    } else {
        -a / (b + root)
    };
    if u > 0.0 { 1.0 / u } else { f64::INFINITY }
}

impl ModalSplit for Scene {
    fn oscillators(&self, omega: &mut [f64], zeta: &mut [f64]) {
        for g in &self.gears {
            if let Some(o) = g.model.oscillators() {
                omega[g.range()].copy_from_slice(o.omega);
                zeta[g.range()].copy_from_slice(o.zeta);
            }
        }
    }

    fn prepare(&mut self, lag: &[f64]) {
        for g in &mut self.gears {
            let own = g.range();
            g.model.set_lag(Some(&lag[own]));
        }
        self.work.nodal.forget();
    }

    fn rest(&mut self, at: At<'_>, a: &mut [f64]) {
        a.fill(0.0);
        for g in &self.gears {
            g.add_load(at, a);
            g.model.add_inertia_force(at.t, &mut a[g.range()]);
        }
        self.evaluate_contacts(at);
        self.add_contact_forces(a);
        self.solve_mass(at, a);
    }

    fn steady(&mut self, at: At<'_>, a: &mut [f64]) -> f64 {
        a.fill(0.0);
        for g in &self.gears {
            if !g.is_steady(at.t) {
                return at.t;
            }
            g.add_load(at, a);
            g.model.add_inertia_force(at.t, &mut a[g.range()]);
        }
        self.solve_mass(at, a);
        self.next_knot(at.t)
    }

    fn free_until(&mut self, s: &State) -> f64 {
        let at = s.at();
        let Some(mut split) = self.split.take() else {
            return s.t;
        };
        let steady_until = self.steady(at, &mut split.steady);
        let until = if steady_until > s.t {
            steady_until.min(s.t + self.flight(at, &mut split))
        } else {
            s.t
        };
        self.split = Some(split);
        until
    }
}

impl Scene {
    /// Time for which nothing touches under the loads in `split.steady` [s].
    fn flight(&self, at: At<'_>, split: &mut Split) -> f64 {
        for (i, g) in self.gears.iter().enumerate() {
            split.reach[i] = match g.model.field() {
                Some(field) => split.reach(g, field, at) + split.hub[i] * g.load(at.t, 0.0).abs(),
                None => 0.0,
            };
        }
        let mut shortest = f64::INFINITY;
        for mesh in &self.meshes {
            if mesh.clearances.is_empty() {
                return 0.0;
            }
            let frames = mesh.gears.map(|i| self.gears[i].frame(at, &split.steady));
            let reach: f64 = mesh.gears.iter().map(|&i| split.reach[i]).sum();
            for c in &mesh.clearances {
                let [a, b] = c.per_travel;
                let along = |d: usize| a * frames[0][d] + b * frames[1][d];
                let gap = c.assembled + along(0) - reach - mesh.margin;
                if gap <= 0.0 {
                    return 0.0;
                }
                shortest = shortest.min(first_zero(gap, along(1), along(2)));
            }
        }
        // What rounding may make of the root.
        shortest * (1.0 - 1e-9)
    }
}

impl Split {
    /// How far a flank of a gear may stand outward by its modes during flight [m].
    fn reach(&mut self, g: &SceneGear, field: &dyn NormalField, at: At<'_>) -> f64 {
        let range = g.range();
        let (square, steady) = (&self.square[range.clone()], &self.steady[range.clone()]);
        let own = g.at(at);
        let swing = &mut self.swing[range];
        for i in 0..swing.len() {
            swing[i] = 0.0;
            if square[i] > 0.0 {
                let q = own.q[i] - steady[i] / square[i];
                swing[i] = (q * q + own.v[i] * own.v[i] / square[i]).sqrt();
            }
        }
        let swinging = field.bound(At { q: swing, ..own });
        for i in 0..swing.len() {
            swing[i] = if square[i] > 0.0 {
                steady[i] / square[i]
            } else {
                0.0
            };
        }
        swinging + field.bound(At { q: swing, ..own })
    }
}
