//! Internal gears as elastic bodies: flank points of concave flanks, one potential behind all forces, statics and impacts
//! beside full finite elements of the same mesh, exchanged and turned pairs, sets of planets.
//!
//! Figures: `cargo test --release -p gearbench-tests --test rings -- --nocapture --include-ignored`.
#![allow(clippy::print_stdout)]

mod friction;
mod impact;
mod points;
mod potential;
mod set;
mod statics;

use gearbench_integrators::{Outputs, Report, SecondOrderSystem, State};
use gearbench_models::geometry::{GearParams, Internal, Side};
use gearbench_models::scene::Scene;
use gearbench_models::spec::{
    ContactSpec, FlankContact, GearSpec, ModelSpec, Modelling, PointContact, SceneSpec,
    signed_effective_radius,
};
use gearbench_tests::{contact, gear, model_of, pair_of, spur, start};

/// Centre distance of the pair [m].
const DISTANCE: f64 = 0.078;

/// Returns the parameters of pinion and ring of the scene `ring_pair`, 22 and 61 teeth.
fn params(helix_angle: f64) -> [GearParams; 2] {
    let of = |teeth, profile_shift| GearParams {
        module: 4e-3 * helix_angle.cos(),
        profile_shift,
        thinning: 4e-5,
        helix_angle,
        face_width: 0.02,
        ..spur(teeth)
    };
    let ring = GearParams {
        addendum: 0.8,
        tip_radius: 0.25,
        bore_radius: 0.0,
        internal: Some(Internal {
            cutter_teeth: Some(23),
            rim_radius: Some(0.15),
            ..Internal::default()
        }),
        ..of(61, -0.2)
    };
    [of(22, 0.2), ring]
}

/// Returns the pair with the axis of the ring offset from that of the pinion in a direction [rad].
fn pair_in(direction: f64, [pinion, ring]: [GearParams; 2], side: Side, gap: f64) -> SceneSpec {
    let off = [DISTANCE * direction.cos(), DISTANCE * direction.sin(), 0.0];
    pair_of(
        gear("pinion", pinion, 0.0, 0.0),
        GearSpec {
            position: off,
            ..gear("ring", ring, 0.0, 0.0)
        },
        start(side, gap),
    )
}

fn pair(gap: f64) -> SceneSpec {
    pair_in(0.0, params(0.0), Side::Left, gap)
}

fn exchanged(mut spec: SceneSpec) -> SceneSpec {
    spec.gears.swap(0, 1);
    spec
}

/// Returns a model with a number of elements along a flank and over the width, with further parameters.
fn meshed(id: &str, [flank, width]: [f64; 2], further: &[(&str, f64)]) -> ModelSpec {
    let counts = [("flank_elements", flank), ("width_elements", width)];
    let all = counts.iter().chain(further);
    model_of(id, all.copied())
}

fn elastic(elements: [f64; 2], modes: f64) -> ModelSpec {
    meshed("elastic", elements, &[("modes", modes)])
}

fn touching(flanks: impl Into<FlankContact>, slices: Option<usize>) -> ContactSpec {
    ContactSpec {
        flanks: flanks.into(),
        slices,
        ..contact(1.5e10)
    }
}

fn modelling(spec: &SceneSpec, model: &ModelSpec, contact: &ContactSpec) -> Modelling {
    Modelling {
        gears: vec![model.clone(); spec.gears.len()],
        contacts: vec![contact.clone(); spec.meshes.len()],
    }
}

fn built(spec: &SceneSpec, model: &ModelSpec, contact: &ContactSpec) -> Scene {
    let modelling = modelling(spec, model, contact);
    Scene::build(spec, &modelling, gearbench::models::models()).unwrap()
}

/// Returns the gears of a pair rolled by an angle of the first, with an overlap on the flank of a side [m].
fn rolled(scene: &Scene, spec: &SceneSpec, roll: f64, (side, press): (Side, f64)) -> State {
    let mut s = scene.initial();
    let radii = [0, 1].map(|i| signed_effective_radius(&spec.gears[i].body));
    for (i, g) in scene.gears().iter().enumerate() {
        let turn = if i == 0 {
            roll
        } else {
            -roll * radii[0] / radii[1]
        };
        s.q[g.range().start] += turn + 0.5 * side.sign() * press / radii[i];
    }
    s
}

/// Returns the energy of contact and elements [J].
fn potential_energy(scene: &mut Scene, s: &State) -> f64 {
    let mut out = Outputs::default();
    scene.output(s.at(), &mut out);
    out.energy.contact + out.energy.strain
}
