//! Parameters of meshes, and agreement of files with scenes.

use super::{MeshParameters, Reader, Source, Stored};
use crate::mesh::Mesh;
use crate::{deck, gear_deck, gear_mesh, test_support};
use gearbench_models::Vec3;
use gearbench_models::gear::rigid;
use gearbench_models::geometry::{GearParams, Side};
use gearbench_models::spec::{Body, Mount};
use gearbench_models::stiffness::Material;

/// Given and default counts are multiplied by the same factor, and other settings are preserved.
#[test]
fn counts_are_multiplied() {
    let given = MeshParameters {
        element: Some("C3D8".into()),
        flank_elements: Some(5),
        width_elements: Some(1),
        ..MeshParameters::default()
    };
    let [_, fillet, across, rim, _] = MeshParameters::default().counted();
    assert_eq!(given.counted(), [5, fillet, across, rim, 1]);
    let twice = given.times(2);
    assert_eq!(twice.counted(), [10, 2 * fillet, 2 * across, 2 * rim, 2]);
    assert_eq!((twice.element, twice.mesh), (given.element, None));
}

/// The gear of `gmsh/spur_gear.py`: 20 teeth of 4 mm in millimetres, axis along x.
const GMSH: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/gmsh/spur_z20.msh.gz");

fn of_gmsh(change: impl FnOnce(&mut GearParams)) -> Body {
    Body::Gear(test_support::gear(20, 4e-3, |p| {
        p.tip_radius = 0.3;
        p.bore_radius = 15e-3;
        p.face_width = 10e-3;
        change(p);
    }))
}

fn read(body: &Body, given: &MeshParameters) -> Result<Box<Stored>, String> {
    let (hub, none) = (test_support::hub(Mount::Revolute, None), rigid::spec());
    let context = test_support::context(body, &hub, &none);
    let reader = Reader {
        model: "elastic",
        context: &context,
    };
    match Source::read(&reader, given) {
        Ok(Source::Deck(stored)) => Ok(stored),
        Ok(Source::Generated(_)) => panic!("a generated mesh"),
        Err(e) => Err(e.to_string()),
    }
}

fn of_file(path: &str) -> MeshParameters {
    MeshParameters {
        mesh: Some(path.to_owned()),
        ..MeshParameters::default()
    }
}

/// The specification of a file in the scene is used where it agrees, including the sense of the axis and the ends of
/// the flanks.
#[test]
fn what_a_scene_says_of_a_file_is_taken() {
    let body = of_gmsh(|_| {});
    let plain = read(&body, &of_file(GMSH)).unwrap();
    let found = plain.found.as_ref().unwrap().gear().unwrap();
    assert!((found.axis.direction - Vec3::x()).norm() < 1e-6);
    assert!(plain.notes[0].contains("mm-t-s"), "{:?}", plain.notes);
    let middle = 0.5 * (found.active[0] + found.tip.radius);
    let given = MeshParameters {
        units: Some("MM-T-S".into()),
        // Few digits, and from the other end.
        axis: Some([-1.0, 0.0, 0.01]),
        axis_point_m: Some([0.0, 0.0301, -0.012]),
        flank_radii_m: Some([middle, found.tip.radius]),
        ..of_file(GMSH)
    };
    let said = read(&body, &given).unwrap();
    let other = said.found.as_ref().unwrap().gear().unwrap();
    assert!((other.axis.direction + Vec3::x()).norm() < 1e-6);
    assert!(said.notes[0].contains("as given"), "{:?}", said.notes);
    assert_eq!(said.mesh.flanks.len(), 40);
    let low = said.mesh.flanks.iter().flat_map(|f| &f.positions);
    let low = low.map(|x| x.xy().norm()).fold(f64::MAX, f64::min);
    assert!(low >= middle - 1e-6, "{low} {middle}");
}

/// Disagreement is refused with both figures and the remedy.
#[test]
fn what_does_not_agree_is_refused() {
    let body = of_gmsh(|_| {});
    type Change<'a> = &'a dyn Fn(&mut MeshParameters);
    let cases: [(Change<'_>, &[&str]); 10] = [
        (
            &|g| g.units = Some("m-kg-s".into()),
            &[
                "base radius",
                "37.5877 mm",
                "show 37587.7",
                "read in m-kg-s (as given)",
                "units = \"mm-t-s\"",
            ],
        ),
        (
            &|g| g.units = Some("inch".into()),
            &["`units`", "inch", "mm-kg-ms"],
        ),
        (&|g| g.axis = Some([0.0; 3]), &["`axis`", "other than zero"]),
        (
            &|g| g.axis = Some([0.0, 0.0, 1.0]),
            &[
                "`axis` says (0.0000, 0.0000, 1.0000)",
                "(1.0000, 0.0000, 0.0000)",
                "leave it out",
            ],
        ),
        (
            &|g| g.axis_point_m = Some([0.0, 0.035, -0.012]),
            &[
                "`axis_point_m` says (0.0000, 35.0000, -12.0000) mm",
                "(0.0000, 30.0000, -12.0000) mm",
            ],
        ),
        (&|g| g.axis_point_m = Some([f64::NAN; 3]), &["a position"]),
        (
            &|g| g.flank_radii_m = Some([0.030, 0.044]),
            &["`flank_radii_m` says 30.0000 to 44.0000 mm", "reach from 3"],
        ),
        (
            &|g| g.flank_radii_m = Some([0.05, 0.06]),
            &["`flank_radii_m` says 50.0000 to 60.0000 mm", "reach from 3"],
        ),
        (
            &|g| g.flank_radii_m = Some([0.04, 0.03]),
            &["two radii", "the smaller one"],
        ),
        (
            &|g| {
                g.mesh = None;
                g.units = Some("mm-t-s".into());
            },
            &["`units`", "this one is generated", "remove it"],
        ),
    ];
    for (change, words) in cases {
        let mut given = of_file(GMSH);
        change(&mut given);
        let told = read(&body, &given).unwrap_err();
        for word in words {
            assert!(told.contains(word), "{word}\n{told}");
        }
    }
    let stored = MeshParameters {
        units: Some("mm-t-s".into()),
        ..of_file("calculix/case-a-fine")
    };
    let told = read(&body, &stored).unwrap_err();
    assert!(told.contains("in m-kg-s"), "{told}");
    // Meshes whose flanks are named by sets have to be of the gear, too.
    for (change, word) in [
        (
            &(|p: &mut GearParams| p.face_width = 8e-3) as &dyn Fn(&mut GearParams),
            "face width",
        ),
        (&|p| p.bore_radius = 10e-3, "bore radius"),
    ] {
        let told = read(&of_gmsh(|p| change(p)), &of_file("calculix/case-a-fine")).unwrap_err();
        assert!(
            told.contains(word) && told.contains("calculix/case-a-fine"),
            "{told}"
        );
    }
    type Other<'a> = &'a dyn Fn(&mut GearParams);
    let gears: [(Other<'_>, &[&str]); 5] = [
        (
            &|p| p.module = 4.2e-3,
            &["base radius", "`module_m`", "37.58"],
        ),
        (&|p| p.profile_shift = 0.3, &["of gear `pinion`", "mm, but"]),
        (
            &|p| (p.profile_shift, p.addendum) = (0.3, 0.7),
            &[
                "tooth thickness at the base circle",
                "`profile_shift` and `thinning_m`",
            ],
        ),
        (
            &|p| p.bore_radius = 12e-3,
            &["bore radius", "12.0000 mm", "15.0000 mm", "`bore_radius_m`"],
        ),
        (
            &|p| p.face_width = 12e-3,
            &["face width", "12.0000 mm", "10.0000 mm"],
        ),
    ];
    for (change, words) in gears {
        let told = read(&of_gmsh(|p| change(p)), &of_file(GMSH)).unwrap_err();
        for word in words {
            assert!(told.contains(word), "{word}\n{told}");
        }
    }
}

/// A mesh as a deck without sets or materials, in millimetres.
fn written(mesh: &Mesh) -> tempfile::NamedTempFile {
    let mut text = String::from("*NODE\n");
    for (i, x) in mesh.nodes.iter().enumerate() {
        let [x, y, z] = [x.x, x.y, x.z].map(|c| 1e3 * c);
        text += &format!("{}, {x:.12e}, {y:.12e}, {z:.12e}\n", i + 1);
    }
    text += &format!("*ELEMENT, TYPE={}\n", mesh.kind().unwrap().name());
    for (i, nodes) in mesh.elements().enumerate() {
        let nodes: Vec<String> = nodes.iter().map(|n| (n + 1).to_string()).collect();
        text += &format!("{}, {}\n", i + 1, nodes.join(", "));
    }
    let file = tempfile::Builder::new().suffix(".inp").tempfile().unwrap();
    std::fs::write(file.path(), text).unwrap();
    file
}

fn deck_of(mesh: &Mesh) -> MeshParameters {
    // Kept until the test ends: the file goes with its handle.
    let path = written(mesh).into_temp_path().keep().unwrap();
    of_file(&path.to_string_lossy())
}

fn without(given: &MeshParameters) {
    std::fs::remove_file(given.mesh.as_deref().unwrap()).unwrap();
}

/// A flank with a dent has no grid: a note says so, and a scene refuses the mesh instead of omitting the flank.
#[test]
fn flanks_that_cannot_touch_are_refused() {
    let gear = test_support::gear(18, 4e-3, |p| p.bore_radius = 15e-3);
    let mut mesh = gear_mesh::gear(&gear, &test_support::coarse(2, 4)).unwrap();
    let dented = mesh
        .flanks
        .iter()
        .find(|f| f.tooth == 2 && f.side == Side::Left);
    let dented = dented.unwrap().clone();
    for row in dented.nodes.chunks_exact(dented.columns) {
        let x = &mut mesh.mesh.nodes[row[2] as usize];
        *x = crate::vector::turned(*x, -0.01);
    }
    let given = deck_of(&mesh.mesh);
    let read_again = deck::read(given.mesh.as_deref().unwrap()).unwrap();
    let found = gear_deck::gears_with(&read_again, Some(Material::STEEL)).unwrap();
    let [why] = &found[0].missing[..] else {
        panic!("{:?}", found[0].missing)
    };
    assert!(why.contains("the left flank of tooth 3"), "{why}");
    assert_eq!(found[0].mesh.flanks.len(), 35);
    let told = read(&Body::Gear(gear), &given).unwrap_err();
    without(&given);
    for word in ["the left flank of tooth 3", "`flank_radii_m`", "`flank_1l`"] {
        assert!(told.contains(word), "{word}\n{told}");
    }
}

/// Racks are read without their sets, and compared with that of the scene.
#[test]
fn racks_have_to_agree() {
    let own = test_support::rack(6, 3e-3, |p| p.face_width = 8e-3);
    let mesh = gear_mesh::rack(&own, &test_support::coarse(2, 2)).unwrap();
    let given = deck_of(&mesh.mesh);
    let of = |change: &dyn Fn(&mut gearbench_models::geometry::RackParams)| {
        let body = Body::Rack(test_support::rack(6, 3e-3, |p| {
            p.face_width = 8e-3;
            change(p);
        }));
        read(&body, &given)
    };
    let found = of(&|_| {}).unwrap();
    assert_eq!(found.mesh.flanks.len(), 12);
    assert_eq!(found.mesh.bore.len(), mesh.bore.len());
    for (a, b) in found.mesh.mesh.nodes.iter().zip(&mesh.mesh.nodes) {
        assert!((a - b).norm() < 1e-10);
    }
    type Change<'a> = &'a dyn Fn(&mut gearbench_models::geometry::RackParams);
    let cases: [(Change<'_>, &str); 5] = [
        (
            &|p| p.teeth = 7,
            "number of teeth of gear `pinion` is 7, but the flanks of",
        ),
        (&|p| p.module = 3.3e-3, "pitch"),
        (&|p| p.pressure_angle = 0.3, "transverse pressure angle"),
        (&|p| p.addendum = 0.8, "tip height"),
        (&|p| p.face_width = 9e-3, "`face_width_m`"),
    ];
    for (change, word) in cases {
        let told = of(change).unwrap_err();
        assert!(told.contains(word), "{word}\n{told}");
    }
    without(&given);
    // A gear is not found in it.
    let given = deck_of(&mesh.mesh);
    let told = read(&of_gmsh(|_| {}), &given).unwrap_err();
    without(&given);
    assert!(told.contains("has 20 teeth, but"), "{told}");
}
