//! Gears for tests of studies: a coarse pair, which reduces in a fraction of a second, and one whose stiffness is a wave.

use crate::context::Context;
use crate::scene_file::format::*;
use crate::scene_file::{Origin, SceneFile};
use gearbench_models::geometry::Side;
use gearbench_models::spec::mesh_layout;
use gearbench_models::stiffness::{Ends, PairOrMesh};

/// Numbers of elements of the coarse mesh.
const MESH: [(&str, f64); 5] = [
    ("flank_elements", 4.0),
    ("fillet_elements", 2.0),
    ("across_elements", 6.0),
    ("rim_elements", 2.0),
    ("width_elements", 1.0),
];

fn read(scene: &SceneTable) -> SceneFile {
    let text = scene.to_toml().expect("a text");
    let name = format!("{}.toml", scene.name.0);
    SceneFile::unbuilt(&Context::default(), &name, &text, Origin::Shipped, false).expect("a scene")
}

/// Returns a coarse pair with a model, the coarse mesh and further parameters.
fn pair(model: &str, parameters: &[(&str, ParameterValue)], damping: Option<f64>) -> SceneTable {
    let gear = |teeth, bore_radius_m, speed_rad_s| GearTable {
        teeth,
        module_m: 2e-3,
        face_width_m: 6e-3,
        bore_radius_m,
        speed_rad_s,
        ..GearTable::default()
    };
    let mesh = MESH.into_iter().map(|(key, x)| (key, x.into()));
    let all = mesh.chain(parameters.iter().cloned());
    SceneTable {
        name: SceneName("coarse".into()),
        duration_s: Positive(1.2e-4),
        gears: [
            ("a", gear(18, 7e-3, Some(20.0))),
            ("b", gear(24, 10e-3, None)),
        ]
        .into_iter()
        .collect(),
        meshes: vec![MeshTable {
            gears: ["a".into(), "b".into()],
            backlash_m: Some(80e-6),
            start: Some(StartTable {
                flank: Some(Side::Left),
                gap_m: 1e-6,
                ..StartTable::default()
            }),
            ..MeshTable::default()
        }],
        models: vec![ModelTable {
            model: model.into(),
            parameters: all.collect(),
            contact: OneOrMany::One(ContactTable {
                penalty_pa_per_m: Some(2e15),
                damping_ns_per_m3: damping,
                ..ContactTable::default()
            }),
            ..ModelTable::default()
        }],
        ..SceneTable::default()
    }
}

/// Returns the pair as full finite elements.
pub fn coarse_full() -> SceneFile {
    read(&pair("fe", &[], None))
}

/// Returns the pair with elastic gears and the given further parameters.
pub fn coarse(parameters: &[(&str, ParameterValue)]) -> SceneFile {
    read(&pair("elastic", parameters, Some(2e9)))
}

/// Returns the first gear with a rack in place of the second gear.
pub fn coarse_rack(parameters: &[(&str, ParameterValue)]) -> SceneFile {
    let mut scene = pair("elastic", parameters, Some(2e9));
    scene.gears.0[1].1 = ToothedTable::from(RackTable {
        teeth: 6,
        module_m: 2e-3,
        face_width_m: 6e-3,
        ..RackTable::default()
    });
    scene.meshes[0].backlash_m = None;
    scene.meshes[0].centre_distance_m = Some(Positive(0.01805));
    read(&scene)
}

/// Returns gears with a mesh stiffness `k0 (1 + depth cos)` of one wave per base pitch, and some damping.
pub fn waves(depth: f64, ratio: f64, wheel_torque: f64) -> SceneFile {
    let gear = |teeth, speed, torque| GearTable {
        teeth,
        module_m: 4e-3,
        face_width_m: 10e-3,
        speed_rad_s: Some(speed),
        loads: Some(vec![GearLoad::torque_nm(torque)]),
        ..GearTable::default()
    };
    let scene = |stiffness: StiffnessTable| SceneTable {
        name: SceneName("wave".into()),
        duration_s: Positive(1e-3),
        gears: [
            ("pinion", gear(20, 100.0, 10.0)),
            ("wheel", gear(30, -66.666_666_666_666_67, wheel_torque)),
        ]
        .into_iter()
        .collect(),
        meshes: vec![MeshTable {
            gears: ["pinion".into(), "wheel".into()],
            centre_distance_m: Some(Positive(0.1001)),
            ..MeshTable::default()
        }],
        models: vec![ModelTable {
            model: "rigid".into(),
            contact: OneOrMany::One(ContactTable {
                stiffness: Some(stiffness),
                damping: Damping::KelvinVoigtRatio { ratio },
                ..ContactTable::default()
            }),
            ..ModelTable::default()
        }],
        ..SceneTable::default()
    };
    let load = |scene: &SceneTable| scene.load(&Context::default()).unwrap();
    let plain = load(&scene(StiffnessTable::Iso6336(IsoTable::default())));
    let [a, b] = [&plain.spec.gears[0], &plain.spec.gears[1]];
    let l = mesh_layout(a, b).unwrap();
    let places = (0..=64).map(|i| f64::from(i) / 64.0);
    load(&scene(StiffnessTable::Table(TabulatedTable {
        path_coordinate_m: (places.clone())
            .map(|u| l.pitch_point + (u - 0.5) * l.base_pitch)
            .collect(),
        stiffness_n_per_m: places
            .map(|u| 1e8 * (1.0 + depth * (std::f64::consts::TAU * u).cos()))
            .collect(),
        of: PairOrMesh::Mesh,
        ends: Ends::Periodic,
        interpolation: Default::default(),
    })))
}
