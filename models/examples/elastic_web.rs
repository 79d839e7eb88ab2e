//! A user-defined gear model in one file and one line of the table: a toothed rim on an elastic web, with one elastic
//! mode.
//!
//! ```text
//! J_r psi'' = sum_c N_c w_c - k (psi - phi) - d (psi' - phi')
//! J_h phi'' = T + k (psi - phi) + d (psi' - phi')
//! ```
//!
//! The teeth turn with the rim, by `psi`; the hub by `phi`, where its mount leaves it free. The table that a scene is
//! built from is a slice: `table.push(elastic_web::MODEL)` is all that another model takes.

use gearbench_integrators::system::{Energy, Power, StateView};
use gearbench_models::Vec3;
use gearbench_models::error::BuildError;
use gearbench_models::gear::properties::Properties;
use gearbench_models::gear::table::{GearContext, Model};
use gearbench_models::gear::{GearModel, HubBody, HubState, ToothCoordinates};
use gearbench_models::kinematics::{Point, Row, Tooth, Wrench};

gearbench_models::declare_parameters! {
    /// Parameters of the model.
    pub struct ElasticWebParameters model "elastic-web" {
        /// natural frequency of the rim, hub held
        frequency_hz: f64,
        /// share of the rim in the inertia
        rim_share: f64,
        /// of the rim, hub held
        damping_ratio: f64,
    }
    required(frequency_hz, rim_share, damping_ratio)
}

/// Row of the model in a table of models.
pub const MODEL: Model = Model::of::<ElasticWebParameters>(
    "rim on an elastic web, one mode (example)",
    Properties::NONE,
    build,
);

/// Rim and hub joined by a spring and a damper; all quantities are about the axis (along the motion of a rack).
struct ElasticWeb {
    hub: HubBody,
    rim: f64,
    stiffness: f64,
    damping: f64,
}

fn build(context: &GearContext<'_>) -> Result<Box<dyn GearModel>, BuildError> {
    let given = context.parameters::<ElasticWebParameters>()?;
    let number = |key: &str, value: Option<f64>, most: f64| match value {
        Some(x) if x >= 0.0 && x < most => Ok(x),
        _ => {
            let message = format!("expected a number from 0 to below {most}");
            Err(BuildError::parameter(MODEL.id, key, message))
        }
    };
    let omega = std::f64::consts::TAU * number("frequency_hz", given.frequency_hz, f64::INFINITY)?;
    let share = number("rim_share", given.rim_share, 1.0)?;
    let rim = share * context.hub.inertia;
    let mut masses = vec![context.hub.inertia - rim; context.hub.coordinates()];
    masses.push(rim);
    Ok(Box::new(ElasticWeb {
        hub: HubBody {
            own: 1,
            contact_mass: rim / context.effective_radius.powi(2),
            characteristic_time: (1.0 - share).sqrt() / omega,
            masses,
            ..HubBody::new(context.hub.clone(), context.effective_radius)
        },
        rim,
        stiffness: rim * omega * omega,
        damping: 2.0 * number("damping_ratio", given.damping_ratio, 1.0)? * rim * omega,
    }))
}

impl ElasticWeb {
    /// Returns the twist of the web, its rate and its torque on the hub.
    fn stretch(&self, at: StateView<'_>) -> [f64; 3] {
        let rim = self.hub.first();
        let x = at.q[rim] - self.hub.displacement_at(at);
        let v = at.v[rim] - self.hub.speed_at(at);
        [x, v, self.stiffness * x + self.damping * v]
    }
}

impl ToothCoordinates for ElasticWeb {
    fn displacement(&self, at: StateView<'_>, _tooth: Tooth) -> f64 {
        at.q[self.hub.first()]
    }
}

impl GearModel for ElasticWeb {
    fn hub(&self) -> &HubBody {
        &self.hub
    }

    fn hub_mut(&mut self) -> &mut HubBody {
        &mut self.hub
    }

    fn teeth(&self) -> Option<&dyn ToothCoordinates> {
        Some(self)
    }

    fn initialise(&self, speed: f64, _q: &mut [f64], v: &mut [f64], _discrete: &mut [f64]) {
        v.fill(speed);
    }

    fn row(&self, _at: StateView<'_>, p: &Point, n: &Vec3, row: &mut Row) -> f64 {
        row.push(self.hub.first(), self.hub.effective_radius(&p.x, n));
        0.0
    }

    fn forces(&mut self, at: StateView<'_>, f: &mut [f64]) {
        let [_, _, torque] = self.stretch(at);
        f[self.hub.first()] -= torque;
        self.hub.add_load(torque, f);
    }

    fn energy(&self, at: StateView<'_>) -> Energy {
        let parts = self.hub.masses.iter().zip(at.v);
        Energy {
            kinetic: parts.map(|(m, v)| 0.5 * m * v * v).sum(),
            strain: 0.5 * self.stiffness * self.stretch(at)[0].powi(2),
            contact: 0.0,
        }
    }

    fn powers(&self, at: StateView<'_>) -> Power {
        let [_, v, torque] = self.stretch(at);
        let held = if self.hub.first() > 0 { 0.0 } else { 1.0 };
        Power {
            dissipated: self.damping * v * v,
            external: -held * torque * self.hub.speed_at(at),
            ..Power::default()
        }
    }

    fn hub_state(&self, at: StateView<'_>) -> HubState {
        let mut state = self.hub.state(at);
        state.momentum += self.rim * self.stretch(at)[1];
        state
    }

    fn mount_reaction(&self, at: StateView<'_>, _forces: &[f64], contact: &Wrench) -> Wrench {
        let mut reaction = self.hub.reaction(at.t, contact);
        if self.hub.first() == 0 {
            let body = self.hub.inertia - self.rim;
            reaction.torque = body * self.hub.prescribed_acceleration(at.t) - self.stretch(at)[2];
        }
        reaction
    }
}

fn main() {}
