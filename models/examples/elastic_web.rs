//! A gear model of one's own in one file and one line: a toothed rim on an elastic web, one elastic mode.
//!
//! `cargo run --release -p gearbench-models --example elastic_web` prints the frequency that a pinion would have.
//!
//! ```text
//! J_r psi'' = sum_c N_c w_c - k (psi - phi) - d (psi' - phi')
//! J_h phi'' = T + k (psi - phi) + d (psi' - phi')
//! ```
//!
//! The teeth turn with the rim, by `psi`; the hub by `phi`, where its mount leaves it free. The table that a scene is
//! built from is a slice: `table.push(elastic_web::MODEL)` is all that another model takes.

use gearbench_integrators::system::{At, Coeffs, Energy, Singular};
use gearbench_models::Vec3;
use gearbench_models::error::BuildError;
use gearbench_models::gear::table::{GearContext, Model, ParameterInfo};
use gearbench_models::gear::{Coordinates, GearModel, HubState, Magnitudes};
use gearbench_models::kinematics::{Hub, Point, Row, Tooth, Wrench};
use gearbench_models::spec::Value;

/// The row that a table of models needs: this is the one line.
pub const MODEL: Model = Model {
    id: "elastic-web",
    title: "rim on an elastic web, one mode (example)",
    parameters: &[
        takes("frequency_hz", "natural frequency of the rim, hub held"),
        takes("rim_share", "share of the rim in the inertia"),
        takes("damping_ratio", "of the rim, hub held"),
    ],
    build,
};

const fn takes(key: &'static str, meaning: &'static str) -> ParameterInfo {
    ParameterInfo {
        key,
        meaning,
        required: true,
    }
}

/// A rim and a hub joined by a spring and a damper; all about the axis (along the slide of a rack).
#[derive(Clone, Debug)]
pub struct ElasticWeb {
    hub: Hub,
    lever: f64,
    rim: f64,
    body: f64,
    stiffness: f64,
    damping: f64,
}

fn build(context: &GearContext<'_>) -> Result<Box<dyn GearModel>, BuildError> {
    let number = |key: &str, most: f64| match context.parameters.get(key) {
        Some(Value::Number(x)) if *x >= 0.0 && *x < most => Ok(*x),
        _ => {
            let message = format!("expected a number from 0 to below {most}");
            Err(BuildError::parameter(MODEL.id, key, message))
        }
    };
    let omega = std::f64::consts::TAU * number("frequency_hz", f64::INFINITY)?;
    let rim = number("rim_share", 1.0)? * context.hub.inertia;
    Ok(Box::new(ElasticWeb {
        hub: context.hub.clone(),
        lever: context.lever,
        rim,
        body: context.hub.inertia - rim,
        stiffness: rim * omega * omega,
        damping: 2.0 * number("damping_ratio", 1.0)? * rim * omega,
    }))
}

impl ElasticWeb {
    fn first(&self) -> usize {
        self.hub.coordinates()
    }

    /// Stretch of the web and its rate.
    fn stretch(&self, at: At<'_>) -> [f64; 2] {
        let i = self.first();
        let hub = [self.hub.travel(at.t, at.q), self.hub.speed(at.t, at.v)];
        [at.q[i] - hub[0], at.v[i] - hub[1]]
    }

    /// Adds the torque of the web by its stretch.
    fn add(&self, [x, v]: [f64; 2], f: &mut [f64]) {
        let torque = self.stiffness * x + self.damping * v;
        f[self.first()] -= torque;
        if self.first() > 0 {
            f[0] += torque;
        }
    }
}

impl GearModel for ElasticWeb {
    fn id(&self) -> &'static str {
        MODEL.id
    }

    fn hub(&self) -> &Hub {
        &self.hub
    }

    fn hub_mut(&mut self) -> &mut Hub {
        &mut self.hub
    }

    fn coordinates(&self) -> Coordinates {
        Coordinates {
            n: self.first() + 1,
            memory: 0,
        }
    }

    fn scales(&self, m: Magnitudes, q: &mut [f64], v: &mut [f64]) {
        q.fill(m.deflection / self.lever);
        v.fill(m.speed / self.lever);
    }

    fn initialise(&self, speed: f64, q: &mut [f64], v: &mut [f64], _memory: &mut [f64]) {
        q.fill(0.0);
        v.fill(speed);
    }

    fn contact_mass(&self) -> f64 {
        self.rim / self.lever.powi(2)
    }

    fn pace(&self) -> f64 {
        (self.stiffness * (1.0 / self.rim + 1.0 / self.body))
            .sqrt()
            .recip()
    }

    fn tooth_travel(&self, at: At<'_>, _tooth: Tooth) -> f64 {
        at.q[self.first()]
    }

    fn row(&self, _at: At<'_>, p: &Point, n: &Vec3, row: &mut Row) {
        row.push(self.first(), self.hub.lever(&p.x, n));
    }

    fn drift(&self, _at: At<'_>, _p: &Point, _n: &Vec3) -> f64 {
        0.0
    }

    fn internal_force(&mut self, at: At<'_>, f: &mut [f64]) {
        self.add(self.stretch(at), f);
    }

    fn internal_tangent(&mut self, _at: At<'_>, dq: &[f64], dv: &[f64], df: &mut [f64]) {
        let i = self.first();
        let of_hub = |x: &[f64]| if i > 0 { x[0] } else { 0.0 };
        self.add([dq[i] - of_hub(dq), dv[i] - of_hub(dv)], df);
    }

    fn solve_mass(&mut self, _at: At<'_>, f_to_a: &mut [f64]) {
        let mut mass = vec![0.0; f_to_a.len()];
        self.constant_mass(&mut mass);
        f_to_a.iter_mut().zip(mass).for_each(|(f, m)| *f /= m);
    }

    fn apply_mass(&mut self, _at: At<'_>, x: &[f64], y: &mut [f64]) {
        self.constant_mass(y);
        y.iter_mut().zip(x).for_each(|(y, x)| *y *= x);
    }

    fn constant_mass(&self, diagonal: &mut [f64]) -> bool {
        diagonal.fill(self.body);
        diagonal[self.first()] = self.rim;
        true
    }

    fn correct(
        &mut self,
        _at: At<'_>,
        c: Coeffs,
        hub_damping: f64,
        x: &mut [f64],
    ) -> Result<(), Singular> {
        let web = c.k * self.stiffness + c.d * self.damping;
        let rim = c.m * self.rim + web;
        if self.first() > 0 {
            let hub = c.m * self.body + c.d * hub_damping + web - web * web / rim;
            x[0] = (x[0] + web * x[1] / rim) / hub;
            x[1] += web * x[0];
        }
        x[self.first()] /= rim;
        let finite = x.iter().all(|x| x.is_finite());
        if finite { Ok(()) } else { Err(Singular) }
    }

    fn energy(&self, at: At<'_>) -> Energy {
        let speed = self.hub.speed(at.t, at.v);
        let body = if self.first() > 0 { self.body } else { 0.0 };
        Energy {
            kinetic: 0.5 * (body * speed * speed + self.rim * at.v[self.first()].powi(2)),
            strain: 0.5 * self.stiffness * self.stretch(at)[0].powi(2),
            contact: 0.0,
        }
    }

    fn dissipated(&self, at: At<'_>) -> f64 {
        self.damping * self.stretch(at)[1].powi(2)
    }

    fn driven_power(&self, at: At<'_>) -> f64 {
        if self.first() > 0 {
            return 0.0;
        }
        let [x, v] = self.stretch(at);
        -(self.stiffness * x + self.damping * v) * self.hub.speed(at.t, at.v)
    }

    fn hub_state(&self, at: At<'_>) -> HubState {
        let speed = self.hub.speed(at.t, at.v);
        HubState {
            travel: self.hub.travel(at.t, at.q),
            speed,
            momentum: self.body * speed + self.rim * at.v[self.first()],
        }
    }

    fn mount_reaction(&self, at: At<'_>, _forces: &[f64], contact: &Wrench) -> Wrench {
        let mut reaction = self.hub.reaction(at.t, contact);
        if self.first() == 0 {
            let [x, v] = self.stretch(at);
            reaction.torque = self.body * self.hub.prescribed_acceleration(at.t)
                - self.stiffness * x
                - self.damping * v;
        }
        reaction
    }

    fn uses_engagement(&self) -> bool {
        false
    }
}

fn main() {}
