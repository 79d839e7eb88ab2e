//! Pairs of fixed gears and their contact.

use gearbench_models::geometry::{Gear, Side};
use gearbench_models::law::Damping;
use gearbench_models::spec::{
    Body, ContactSpec, FlankContact, GearSpec, MeshSpec, ModelSpec, Modelling, Mount, SceneSpec,
    Start, UPRIGHT,
};
use gearbench_models::stiffness::{Material, PairStiffness};

/// Returns a scene of two fixed gears at a distance.
pub fn scene(gears: [Gear; 2], material: Material, distance: f64) -> SceneSpec {
    let held = |(i, gear)| GearSpec {
        name: format!("gear {}", i + 1),
        body: Body::Gear(gear),
        material,
        inertia: None,
        added_inertia: 0.0,
        mount: Mount::Fixed,
        guide: None,
        lateral: None,
        axes: UPRIGHT,
        position: [i as f64 * distance, 0.0, 0.0],
        facing: 0.0,
        speed: 0.0,
        loads: vec![],
    };
    SceneSpec {
        duration: f64::INFINITY,
        gears: gears.into_iter().enumerate().map(held).collect(),
        meshes: vec![MeshSpec {
            gears: [0, 1],
            start: Start {
                side: Side::Left,
                gap: 0.0,
                path_coordinate: None,
                loaded: false,
            },
        }],
        shafts: vec![],
        stages: Vec::new(),
    }
}

/// Returns both gears of one model, with a linear contact without losses.
pub fn modelling(model: ModelSpec, stiffness: PairStiffness, flanks: FlankContact) -> Modelling {
    Modelling {
        gears: vec![model.clone(), model],
        contacts: vec![ContactSpec {
            stiffness,
            exponent: 1.0,
            damping: Damping::None,
            normal_force: None,
            friction: None,
            slices: None,
            flanks,
        }],
    }
}
