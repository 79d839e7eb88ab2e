//! Scenes of spur gears and racks of module 4 mm.

use crate::models_with_flanks;
use gearbench_models::error::BuildError;
use gearbench_models::geometry::{Gear, GearParams, Rack, RackParams, Side};
use gearbench_models::law::Damping;
use gearbench_models::scene::Scene;
use gearbench_models::spec::{
    Body, ContactSpec, FlankContact, GearSpec, MeshSpec, ModelSpec, Modelling, Mount, SceneSpec,
    Start, UPRIGHT,
};
use gearbench_models::stiffness::{
    Foundation, Hertz, Material, PairOrMesh, PairStiffness, ToothModel,
};

/// Returns the parameters of a spur gear of module 4 mm.
pub fn spur(teeth: u32) -> GearParams {
    GearParams {
        teeth,
        module: 4e-3,
        tip_radius: 0.3,
        bore_radius: 0.015,
        ..Default::default()
    }
}

/// Returns a gear at a position on the x axis that is free to rotate.
pub fn gear(name: &str, params: GearParams, x: f64, speed: f64) -> GearSpec {
    GearSpec {
        name: name.into(),
        body: Body::Gear(Gear::new(params).expect("the gear can be cut")),
        material: Material::STEEL,
        inertia: None,
        added_inertia: 0.0,
        mount: Mount::Revolute,
        guide: None,
        lateral: None,
        axes: UPRIGHT,
        position: [x, 0.0, 0.0],
        facing: 0.0,
        speed,
        loads: vec![],
    }
}

/// Returns a rack of module 4 mm in front of a gear at the origin, with its teeth towards it.
pub fn rack(name: &str, teeth: u32, distance: f64, speed: f64) -> GearSpec {
    let params = RackParams {
        teeth,
        module: 4e-3,
        tip_radius: 0.3,
        ..Default::default()
    };
    GearSpec {
        body: Body::Rack(Rack::new(params).expect("the rack can be cut")),
        mount: Mount::Prismatic,
        facing: std::f64::consts::PI,
        ..gear(name, spur(20), distance, speed)
    }
}

/// Returns the initial position of a tooth pair.
pub fn start(side: Side, gap: f64) -> Start {
    Start {
        side,
        gap,
        path_coordinate: None,
        loaded: false,
    }
}

/// Returns a mesh of two gears of a scene.
pub fn mesh(gears: [usize; 2], start: Start) -> MeshSpec {
    MeshSpec { gears, start }
}

/// Returns a scene of two gears in mesh.
pub fn pair_of(a: GearSpec, b: GearSpec, start: Start) -> SceneSpec {
    SceneSpec {
        duration: f64::INFINITY,
        gears: vec![a, b],
        meshes: vec![mesh([0, 1], start)],
        shafts: vec![],
        stages: Vec::new(),
    }
}

/// Returns the impact of reference case A: z = 20/30, m = 4 mm, 10 mm wide, 20 rad/s, inertias of the stored meshes.
pub fn case_a(gap: f64) -> SceneSpec {
    let mut a = gear("pinion", spur(20), 0.0, 20.0);
    a.inertia = Some(0.000_310_205_607_253_510_6);
    let mut b = gear(
        "wheel",
        GearParams {
            bore_radius: 0.025,
            ..spur(30)
        },
        0.1001,
        0.0,
    );
    b.inertia = Some(0.001_543_270_566_960_835_3);
    pair_of(a, b, start(Side::Left, gap))
}

/// Returns the gears of the FZG test rig, type C, with the pinion at a speed [rad/s], without loads.
pub fn fzg_c(speed: f64) -> SceneSpec {
    let params = |teeth, profile_shift| GearParams {
        teeth,
        module: 4.5e-3,
        face_width: 0.014,
        profile_shift,
        thinning: 5e-5,
        bore_radius: 0.015,
        ..Default::default()
    };
    let a = gear("pinion", params(16, 0.1817), 0.0, speed);
    let b = gear("wheel", params(24, 0.1715), 0.0915, -speed / 1.5);
    pair_of(a, b, start(Side::Left, 0.0))
}

/// Returns two gears of 30 teeth, module 2 mm, the first at a speed [rad/s], without loads.
pub fn s30(speed: f64) -> SceneSpec {
    let params = GearParams {
        teeth: 30,
        module: 2e-3,
        face_width: 0.015,
        thinning: 3e-5,
        bore_radius: 0.01,
        ..Default::default()
    };
    let a = gear("pinion", params.clone(), 0.0, speed);
    let b = gear("wheel", params, 0.06, -speed);
    pair_of(a, b, start(Side::Left, 0.0))
}

/// Returns the default stiffness of a tooth pair, which varies along the path: Weber and Banaschek's, on an elastic
/// ring.
pub fn weber_banaschek() -> PairStiffness {
    PairStiffness::Compliance {
        tooth: ToothModel::WeberBanaschek,
        foundation: Foundation::Ring,
        hertz: Hertz::WeberBanaschek {
            reference_load: None,
        },
    }
}

/// Returns a linear elastic contact of constant stiffness per width [N/m per m] of a tooth pair.
pub fn contact(per_width: f64) -> ContactSpec {
    ContactSpec {
        stiffness: PairStiffness::Constant {
            per_width,
            of: PairOrMesh::Pair,
        },
        exponent: 1.0,
        damping: Damping::None,
        normal_force: None,
        friction: None,
        slices: None,
        flanks: FlankContact::Toothing,
    }
}

/// Builds a scene with the joined table; returns an error if it is refused.
pub fn try_build(
    spec: &SceneSpec,
    gears: &[ModelSpec],
    contact: &ContactSpec,
) -> Result<Scene, BuildError> {
    let modelling = Modelling {
        gears: gears.to_vec(),
        contacts: vec![contact.clone(); spec.meshes.len()],
    };
    Scene::build(spec, &modelling, &models_with_flanks())
}

/// Builds a scene that must not be refused, with equal contacts.
pub fn build(spec: &SceneSpec, gears: &[ModelSpec], contact: &ContactSpec) -> Scene {
    try_build(spec, gears, contact).expect("the scene can be assembled")
}
