//! Decks as Abaqus/CAE writes them: parts, instances and an assembly.

use super::{none, read};
use crate::{DeckError, read_str};
use gearbench_solid_fe::Vec3;

/// A unit cube as a part, with sets and a section inside.
const PART: &str = "*Part, name=Cube\n*Node\n\
    1, 0., 0., 0.\n2, 1., 0., 0.\n3, 1., 1., 0.\n4, 0., 1., 0.\n\
    5, 0., 0., 1.\n6, 1., 0., 1.\n7, 1., 1., 1.\n8, 0., 1., 1.\n\
    *Element, type=C3D8R\n1, 1, 2, 3, 4, 5, 6, 7, 8\n\
    *Nset, nset=Low, generate\n1, 4, 1\n*Elset, elset=Set-1\n1,\n\
    ** Section: Section-1\n*Solid Section, elset=Set-1, material=Steel\n,\n*End Part\n";

fn two(first: &str, second: &str) -> String {
    format!(
        "*Heading\n** Job name: Job-1 Model name: Model-1\n*Preprint, echo=NO, model=NO\n** PARTS\n{PART}\
         ** ASSEMBLY\n*Assembly, name=Assembly\n\
         *Instance, name=Cube-1, part=Cube\n{first}*End Instance\n\
         *Instance, name=Cube-2, part=Cube\n{second}*End Instance\n\
         *Node\n1, 9., 9., 9.\n\
         *Nset, nset=Top, instance=Cube-2\n5, 6, 7, 8\n*Nset, nset=Ref, internal\n1,\n\
         *Nset, nset=Both\nCube-1.Low, Cube-2.3, Top\n\
         *Elset, elset=_Face_S2, internal, instance=Cube-1\n1,\n\
         *Surface, type=ELEMENT, name=Face\n_Face_S2, S2\n\
         *Surface, type=NODE, name=Point, internal\nRef, 1.\n\
         *Coupling, constraint name=C, ref node=Ref, surface=Face\n*Kinematic\n\
         *End Assembly\n*Material, name=Steel\n*Density\n7.85e-09,\n*Elastic\n210000., 0.3\n\
         ** STEP\n*Step, name=Step-1, nlgeom=NO\n*Static\n1., 1., 1e-05, 1.\n*Boundary\nCube-2.Low, ENCASTRE\n\
         *Cload\nCube-1.7, 1, 5.\n*Restart, write, frequency=0\n*Output, field, variable=PRESELECT\n*End Step\n"
    )
}

#[test]
fn instances_are_moved_turned_and_named() {
    // Moved by 3 along x first, then turned by 90 degrees about an axis along z through (1, 0, 0).
    let deck = read(&two("", "3., 0., 0.\n1., 0., 0., 1., 0., 1., 90.\n"));
    assert_eq!(deck.units.name, "mm-t-s");
    assert_eq!(deck.nodes.len(), 17);
    assert_eq!((deck.element_count(), deck.instances.len()), (2, 2));
    let near = |node: usize, x: [f64; 3]| (deck.nodes[node] - 1e-3 * Vec3::from(x)).norm() < 1e-15;
    assert!(near(1, [1.0, 0.0, 0.0]) && near(16, [9.0; 3]));
    // (1, 0, 0) -> (4, 0, 0) -> (1, 3, 0).
    assert!(near(9, [1.0, 3.0, 0.0]), "{:?}", deck.nodes[9]);
    assert_eq!(deck.node_sets["cube-1.low"], [0, 1, 2, 3]);
    assert_eq!(deck.node_sets["cube-2.low"], [8, 9, 10, 11]);
    assert_eq!(deck.node_sets["top"], [12, 13, 14, 15]);
    assert_eq!(deck.node_sets["ref"], [16]);
    assert_eq!(deck.node_sets["both"], [0, 1, 2, 3, 10, 12, 13, 14, 15]);
    assert_eq!(deck.surfaces["face"].len(), 1);
    assert_eq!(deck.section_materials(), [Some("steel"); 2]);
    assert_eq!(
        (deck.node_name(9), deck.node_name(16)),
        ("cube-2.2".into(), "1".into())
    );
    assert_eq!(deck.element_name(1), "cube-2.1");
    let m = deck.material("steel").unwrap();
    assert!((m.young / 2.1e11 - 1.0).abs() < 1e-12 && (m.density / 7850.0 - 1.0).abs() < 1e-12);
    let held = &deck.steps[0].boundaries[0];
    assert_eq!(
        (held.directions, deck.target(&held.target).len()),
        ([1, 3], 4)
    );
    let told = deck.told().join("\n");
    for words in [
        "units mm-t-s: from E = 2.1e5 and density 7.85e-9 of material `steel`",
        "ignored keywords without influence on the bodies: *CLOAD, *COUPLING, *KINEMATIC, *OUTPUT, *PREPRINT, *RESTART, *SURFACE",
        "C3D8R is read as C3D8I (2 elements)",
    ] {
        assert!(told.contains(words), "{words}\n{told}");
    }
}

#[test]
fn a_mesh_may_stand_in_the_instance() {
    // As CAE writes independent instances: the part is empty.
    let text = two("", "").replace(PART, "*Part, name=Cube\n*End Part\n");
    let own = PART
        .trim_start_matches("*Part, name=Cube\n")
        .trim_end_matches("*End Part\n");
    let text = text.replace(
        "part=Cube\n*End Instance",
        &format!("part=Cube\n{own}*End Instance"),
    );
    assert_eq!(read(&text).element_count(), 2);
    assert_eq!(read(&text).nodes, read(&two("", "")).nodes);
}

fn refused(text: &str) -> DeckError {
    read_str("a.inp", text, &mut none).unwrap_err()
}

#[test]
fn what_is_wrong_with_an_assembly_is_told() {
    for (text, words) in [
        (
            "*PART, NAME=a\n",
            "a.inp:1: *PART: expected *END PART, found the end of the deck after line 1",
        ),
        ("*END PART\n", "expected *PART before it"),
        (
            "*PART, NAME=a\n*END PART\n*PART, NAME=A\n",
            "a.inp:3: *PART, NAME=A: expected each part once",
        ),
        (
            "*PART, NAME=a\n*MATERIAL, NAME=m\n",
            "expected *END PART of `a` first",
        ),
        (
            "*INSTANCE, NAME=i, PART=p\n",
            "expected a defined part, found `p`",
        ),
        (&two("1, 2, 3, 4\n", ""), "expected at most 3 values"),
        (
            &two("0, 0, 0\n1, 1, 1, 1, 1, 1, 5.\n", ""),
            "two different points on the axis",
        ),
        (
            &two("0, 0, 0\n0,0,0, 0,0,1, 5.\n1\n", ""),
            "a line with a translation and one with a turn",
        ),
        (
            &two("", "").replace("instance=Cube-2", "instance=Cube-3"),
            "INSTANCE=name of an instance above",
        ),
        (
            &two("", "").replace("Cube-2.3", "Cube-2.33"),
            "expected a node defined above, found label Cube-2.33",
        ),
        (
            PART,
            "an *INSTANCE of this part in an *ASSEMBLY, found none of cube",
        ),
        (
            &two("", "").replace("4, 0., 1., 0.", "4, 0., -9., 0."),
            "element cube-1.1 with the Jacobian",
        ),
    ] {
        let shown = refused(text).to_string();
        assert!(shown.contains(words), "{words}\n{shown}");
    }
}
