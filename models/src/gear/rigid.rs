//! The rigid gear: it has the coordinate of the mount only; all compliance is in the contact law.
//!
//! `J phi'' = T + sum_c N_c d(x_c . n_c)/dphi`, on the line of action the effective base radius arm is the base radius.

use super::capabilities::{CoupledMass, LinearMotion, Oscillators};
use super::capability_functions::work_on_hub;
use super::free_flight::FreeFlight;
use super::hub_body::HubBody;
use super::model::GearModel;
use super::parameters::ModelParameters;
use super::properties::{Fit, Start};
use crate::Vec3;
use crate::kinematics::{Hub, Point, Row};
use crate::spec::ModelSpec;
use gearbench_integrators::FlightPath;
use gearbench_integrators::system::{Coeffs, Singular, StateView};

crate::declare_parameters! {
    /// Parameters of the model: it has none.
    pub struct RigidParameters model "rigid" {}
}

/// Fit of the contact law, the only constant of the model.
pub const FIT: Fit = Fit {
    parameters: &[],
    starts: |contact, _| {
        vec![Start {
            contact,
            parameters: Vec::new(),
        }]
    },
};

/// Creates a gear of this model for a scene.
pub fn spec() -> ModelSpec {
    RigidParameters {}.spec()
}

/// A rigid gear or rack.
#[derive(Clone, Debug)]
pub struct Rigid {
    hub: HubBody,
    /// Angular frequencies and damping ratios of the coordinates, where they are independent.
    oscillators: Option<[Vec<f64>; 2]>,
}

impl Rigid {
    /// Creates a rigid body on its hub with the base radius [m], or `cos(alpha)` for a rack.
    pub fn new(hub: Hub, effective_base_radius: f64) -> Self {
        let own = vec![0.0; usize::from(hub.is_free())];
        let oscillators = match &hub.lateral {
            None => Some([own.clone(), own]),
            Some(lateral) => lateral.oscillators(hub.moving()).map(|of| {
                [0, 1].map(|k| own.iter().copied().chain(of.iter().map(|o| o[k])).collect())
            }),
        };
        Rigid {
            hub: HubBody::new(hub, effective_base_radius),
            oscillators,
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
    fn row(&self, at: StateView<'_>, p: &Point, n: &Vec3, row: &mut Row) -> f64 {
        self.hub.row(at, &p.x, n, row)
    }

    fn correct(
        &mut self,
        at: StateView<'_>,
        c: Coeffs,
        hub_damping: f64,
        rhs_to_x: &mut [f64],
    ) -> Result<(), Singular> {
        self.hub.correct(at, c, hub_damping, rhs_to_x)
    }

    fn coupled_mass(&self) -> Option<&dyn CoupledMass> {
        let spins = self.hub.lateral.as_ref().is_some_and(|l| l.spins);
        spins.then_some(self)
    }

    fn linear(&self) -> Option<&dyn LinearMotion> {
        Some(self)
    }
}

impl CoupledMass for Rigid {
    fn solve(&self, at: StateView<'_>, f_to_a: &mut [f64]) {
        let unit = Coeffs {
            m: 1.0,
            d: 0.0,
            k: 0.0,
        };
        // The mass matrix of a body is regular but where the tilt is singular, which must not pass for an acceleration.
        if self.hub.correct(at, unit, 0.0, f_to_a).is_err() {
            f_to_a.fill(f64::NAN);
        }
    }

    fn apply(&self, at: StateView<'_>, x: &[f64], y: &mut [f64]) {
        self.hub.apply_mass(at, x, y);
    }
}

impl LinearMotion for Rigid {
    fn oscillators(&self) -> Option<Oscillators<'_>> {
        let [omega, zeta] = self.oscillators.as_ref()?;
        Some(Oscillators { omega, zeta })
    }

    fn free_flight(&self, at: StateView<'_>, load: f64) -> Option<FreeFlight> {
        // How far flanks are apart is linear in one displacement alone.
        self.hub.lateral.is_none().then(|| FreeFlight {
            frame: self.hub.frame(at, load),
            ..FreeFlight::default()
        })
    }

    fn add_to_path(&self, at: StateView<'_>, load: f64, first: usize, path: &mut FlightPath) {
        self.hub.add_to_path(at, load, first, path);
    }

    fn steady_work(&self, from: StateView<'_>, to: StateView<'_>, load: f64) -> f64 {
        work_on_hub(self, from, to, load)
    }
}
