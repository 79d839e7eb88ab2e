//! The rigid gear: the mount's coordinate only; all compliance sits in the contact law.
//!
//! `J phi'' = T + sum_c N_c d(x_c . n_c)/dphi`, on the line of action the effective base radius arm is the base radius.

use super::any::work_on_hub;
use super::capabilities::{LinearMotion, Oscillators};
use super::free_flight::FreeFlight;
use super::hub_body::HubBody;
use super::model::GearModel;
use super::properties::{Fit, Start};
use crate::Vec3;
use crate::kinematics::{Hub, Point, Row};
use crate::spec::{ModelSpec, Parameters};
use gearbench_integrators::FlightPath;
use gearbench_integrators::system::{At, Coeffs, Singular};

/// Id of the model.
pub const MODEL: &str = "rigid";

/// Its contact law is all there is to fit.
pub const FIT: Fit = Fit {
    parameters: &[],
    starts: |contact, _| {
        vec![Start {
            contact,
            parameters: Vec::new(),
        }]
    },
};

/// A gear of this model in a scene.
pub fn spec() -> ModelSpec {
    ModelSpec {
        id: MODEL.into(),
        parameters: Parameters::new(),
    }
}

/// A rigid gear or rack.
#[derive(Clone, Debug)]
pub struct Rigid {
    hub: HubBody,
}

impl Rigid {
    /// A rigid body on its hub with the base radius [m], or `cos(alpha)` for a rack.
    pub fn new(hub: Hub, effective_base_radius: f64) -> Self {
        Rigid {
            hub: HubBody::new(hub, effective_base_radius),
        }
    }
}

impl GearModel for Rigid {
    fn hub(&self) -> &HubBody {
        &self.hub
    }

    fn hub_mut(&mut self) -> &mut HubBody {
        &mut self.hub
    }

    #[inline]
    fn row(&self, at: At<'_>, p: &Point, n: &Vec3, row: &mut Row) -> f64 {
        self.hub.row(at, &p.x, n, row)
    }

    fn correct(
        &mut self,
        _at: At<'_>,
        c: Coeffs,
        hub_damping: f64,
        rhs_to_x: &mut [f64],
    ) -> Result<(), Singular> {
        let a = c.m * self.hub.inertia + c.d * hub_damping;
        for x in rhs_to_x {
            if a == 0.0 {
                return Err(Singular);
            }
            *x /= a;
        }
        Ok(())
    }

    fn linear(&self) -> Option<&dyn LinearMotion> {
        Some(self)
    }
}

impl LinearMotion for Rigid {
    fn oscillators(&self) -> Option<Oscillators<'_>> {
        const NONE: &[f64] = &[0.0];
        let own = &NONE[..self.hub.first()];
        Some(Oscillators {
            omega: own,
            zeta: own,
        })
    }

    fn free_flight(&self, at: At<'_>, load: f64) -> Option<FreeFlight> {
        Some(FreeFlight {
            frame: self.hub.frame(at, load),
            ..FreeFlight::default()
        })
    }

    fn add_to_path(&self, at: At<'_>, load: f64, first: usize, path: &mut FlightPath) {
        self.hub.add_to_path(at, load, first, path);
    }

    fn steady_work(&self, from: At<'_>, to: At<'_>, load: f64) -> f64 {
        work_on_hub(self, from, to, load)
    }
}
