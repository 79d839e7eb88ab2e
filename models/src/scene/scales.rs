//! Typical deflection, speed and time of the meshes of a scene.

use super::members::SceneGear;
use crate::gear::Magnitudes;
use crate::kinematics::Hub;
use crate::spec::{self, GearSpec, MeshSpec, SceneSpec, effective_radius, signed_effective_radius};

/// Typical deflection, speed and time of the meshes of a scene.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scales {
    pub(super) deflection: f64,
    pub(super) speed: f64,
    pub(super) characteristic_time: f64,
}

impl Default for Scales {
    fn default() -> Self {
        Scales {
            deflection: 0.0,
            speed: 0.0,
            characteristic_time: f64::INFINITY,
        }
    }
}

impl Scales {
    pub(super) fn add(&mut self, spec: &SceneSpec, mesh: &MeshSpec, gears: &[SceneGear], k: f64) {
        let sides = mesh.gears.map(|i| (&spec.gears[i], &gears[i]));
        let mass = reduced_mass(sides.map(|(s, g)| hub_mass(s, g.model.hub())));
        let own = reduced_mass(sides.map(|(_, g)| g.model.hub().contact_mass));
        let along = mesh.gears.map(|i| {
            let s = &spec.gears[i];
            let speed = initial_speed(s);
            let load: f64 = spec.loads_at(i).map(|l| l.greatest(0.0)).sum();
            let force = load / effective_radius(&s.body);
            (speed * signed_effective_radius(&s.body), force)
        });
        let fastest = along[0].0.abs().max(along[1].0.abs());
        let closing = (along[0].0 + along[1].0).abs();
        let force = along[0].1.max(along[1].1);
        let m = if mass.is_finite() { mass } else { 1.0 };
        let speed = closing
            .max(force / (k * m).sqrt())
            .max(1e-3 * fastest)
            .max(1e-6);
        self.speed = self.speed.max(speed);
        self.deflection = self.deflection.max(speed * (m / k).sqrt());
        let light = if own.is_finite() { own.min(m) } else { m };
        self.characteristic_time = self.characteristic_time.min((light / k).sqrt());
    }

    pub(super) fn magnitudes(&self) -> Magnitudes {
        Magnitudes {
            deflection: if self.deflection > 0.0 {
                self.deflection
            } else {
                1e-6
            },
            speed: if self.speed > 0.0 { self.speed } else { 1e-3 },
        }
    }
}

/// Returns the initial speed of a hub, which a prescribed motion defines itself.
pub(super) fn initial_speed(g: &GearSpec) -> f64 {
    spec::initial_speed(&g.mount, g.speed)
}

/// Returns the effective mass of a hub along the line of action [kg]; infinite when it is fixed or driven.
pub(super) fn hub_mass(spec: &GearSpec, hub: &Hub) -> f64 {
    if !hub.is_free() {
        f64::INFINITY
    } else {
        hub.inertia / effective_radius(&spec.body).powi(2)
    }
}

pub(super) fn reduced_mass(m: [f64; 2]) -> f64 {
    1.0 / (1.0 / m[0] + 1.0 / m[1])
}
