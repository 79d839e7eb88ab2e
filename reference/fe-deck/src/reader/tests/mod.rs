use crate::test_support::parsed;
use crate::{
    ContactKind, Deck, DeckErrorKind, Label, MAX_INCLUDE_DEPTH, Procedure, Target, read_bytes,
    read_str,
};
use gearbench_solid_fe::Vec3;
use gearbench_solid_fe::mesh::{ElementKind, Face};
use std::io;

mod bounds;
mod parts;
mod passed;

fn read(text: &str) -> Deck {
    parsed("a.inp", text)
}

fn none(name: &str) -> io::Result<String> {
    Err(io::Error::other(format!("asked for {name}")))
}

/// Two bricks above each other, 12 nodes.
const BRICKS: &str = "*NODE, NSET=all\n\
    1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n\
    9,0,0,2\n10,1,0,2\n11,1,1,2\n12,0,1,2\n\
    *ELEMENT, TYPE=C3D8, ELSET=low\n1,1,2,3,4,5,6,7,8\n\
    *ELEMENT, TYPE=C3D8, ELSET=high\n40,5,6,7,8,\n9,10,11,12\n";

#[test]
fn free_format_is_read() {
    let deck = read(
        "** a comment\r\n\
         * Heading\r\n  two, words\r\n\r\n\
         *NODE ,\r\n** in between\r\n nset = \"My Set\"\r\n\
         \t7 , 1.5D-3 , -.5 , +2.E0\r\n3\r\n\
         *nset, NSET=other, unsorted\r\n my set, 3,\r\n",
    );
    assert_eq!(deck.heading, ["two, words"]);
    assert_eq!(deck.nodes, [Vec3::new(1.5e-3, -0.5, 2.0), Vec3::zeros()]);
    assert_eq!(deck.node_labels.get_index_of(&Label::from(7)), Some(0));
    assert_eq!(deck.node_name(1), "3");
    assert_eq!(deck.node_sets["my set"], [0, 1]);
    assert_eq!(deck.node_sets["other"], [0, 1]);
}

#[test]
fn elements_sets_and_surfaces() {
    let deck = read(&format!(
        "{BRICKS}*ELSET, ELSET=both\nlow, high\n*ELSET, ELSET=both\n1\n\
         *NSET, NSET=odd, GENERATE\n1, 12, 2\n*NSET, NSET=two, GENERATE\n1, 2\n\
         *SURFACE, NAME=S, TYPE=ELEMENT\n1, S1\nhigh, s2\nboth, S4\n"
    ));
    assert_eq!(deck.element_count(), 2);
    assert_eq!(deck.blocks[1].kind, ElementKind::C3D8);
    assert_eq!(deck.element(1), [4, 5, 6, 7, 8, 9, 10, 11]);
    assert_eq!(deck.element_labels.get_index_of(&Label::from(40)), Some(1));
    assert_eq!(deck.element_sets["both"], [0, 1]);
    assert_eq!(deck.node_sets["odd"], [0, 2, 4, 6, 8, 10]);
    assert_eq!(deck.node_sets["two"], [0, 1]);
    let face = |element, face| Face { element, face };
    assert_eq!(
        deck.surfaces["s"],
        [face(0, 0), face(1, 1), face(0, 3), face(1, 3)]
    );
}

#[test]
fn contact_conditions_and_steps() {
    let deck = read(&format!(
        "{BRICKS}*SURFACE, NAME=A\n1, S1\n*SURFACE, NAME=B\n40, S2\n\
         *SURFACE INTERACTION, NAME=I\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n1e12\n\
         *CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE\nA, B\n\
         *Contact Pair, interaction=i, type=node to surface\nb, a\n\
         *RIGID BODY, NSET=all, REF NODE=1, ROT NODE=2\n\
         *MATERIAL, NAME=M\n*ELASTIC, TYPE=ISO\n2e11, .3\n*DENSITY\n7800\n\
         *SOLID SECTION, ELSET=low, MATERIAL=m\n*SOLID SECTION, ELSET=high, MATERIAL=M\n1.\n\
         *BOUNDARY\nall, 1, 3\n2, 2\n\
         *INITIAL CONDITIONS, TYPE=VELOCITY\nall, 3, -2.5\n\
         *STEP, NLGEOM=NO\n*STATIC\n*BOUNDARY\n1, 1, 1, 1e-3\n*OUTPUT, FIELD, FREQUENCY=3\n\
         *NODE OUTPUT\nU, V\n*END STEP\n\
         *STEP, NLGEOM, INC=50\n*DYNAMIC, DIRECT, ALPHA=-.1\n1e-6, 1e-4\n*END STEP\n"
    ));
    assert_eq!(deck.contact_pairs.len(), 2);
    assert_eq!(deck.contact_pairs[0].kind, ContactKind::SurfaceToSurface);
    assert_eq!(deck.contact_pairs[1].kind, ContactKind::NodeToSurface);
    assert_eq!(deck.interactions["i"].stiffness, Some(1e12));
    assert_eq!(deck.rigid_bodies[0].rotation, Some(1));
    assert_eq!(deck.section_materials(), [Some("m"), Some("m")]);
    let m = deck.material("m").unwrap();
    assert_eq!((m.young, m.poisson, m.density), (2e11, 0.3, 7800.0));
    assert_eq!(deck.boundaries[0].directions, [1, 3]);
    assert_eq!(deck.boundaries[1].directions, [2, 2]);
    assert_eq!(deck.boundaries[1].target, Target::Node(1));
    assert_eq!(deck.target(&deck.boundaries[0].target).len(), 12);
    assert_eq!(deck.initial_velocities[0].value, -2.5);
    let [first, second] = deck.steps.as_slice() else {
        panic!("{:?}", deck.steps)
    };
    assert!(!first.nlgeom && second.nlgeom);
    assert_eq!(
        first.procedure,
        Procedure::Static {
            direct: false,
            times: None
        }
    );
    assert_eq!(first.boundaries[0].value, 1e-3);
    assert_eq!(
        first.requests,
        ["*OUTPUT, FIELD, FREQUENCY=3", "*NODE OUTPUT"]
    );
    assert_eq!(second.increments, Some(50));
    assert_eq!(
        second.procedure,
        Procedure::Dynamic {
            direct: true,
            explicit: false,
            alpha: Some(-0.1),
            times: Some([1e-6, 1e-4])
        }
    );
}

#[test]
fn includes_count_from_the_including_file() {
    let mut asked = Vec::new();
    let deck = read_str(
        "folder/main.inp",
        "*INCLUDE, INPUT=parts/nodes.inp\n*NSET, NSET=s\n1\n*INCLUDE, INPUT=/all/rest.inp\n",
        &mut |name| {
            asked.push(name.to_owned());
            match name {
                "folder/parts/nodes.inp" => {
                    Ok("*NODE\n1, 0, 0, 0\n*INCLUDE, INPUT=more.inp".into())
                }
                "folder/parts/more.inp" => Ok("2, 1, 0, 0".into()),
                "/all/rest.inp" => Ok("3\n".into()),
                other => none(other),
            }
        },
    );
    assert_eq!(
        asked,
        [
            "folder/parts/nodes.inp",
            "folder/parts/more.inp",
            "/all/rest.inp"
        ]
    );
    // The data of the set goes on in the last file, where node 3 is not defined; of a file outside the deck's folder no text
    // is shown.
    let text = deck.unwrap_err().to_string();
    assert!(
        text.starts_with("/all/rest.inp:1: expected a node defined above"),
        "{text}"
    );

    let mut depth = 0;
    let text = read_str("self.inp", "*INCLUDE, INPUT=self.inp", &mut |_| {
        depth += 1;
        Ok("*INCLUDE, INPUT=self.inp".into())
    })
    .unwrap_err();
    assert_eq!(
        (text.kind, depth),
        (DeckErrorKind::Limit, MAX_INCLUDE_DEPTH)
    );
}

/// Each refusal with its place and the words that matter.
#[test]
fn refusals_say_where_what_and_how() {
    let cases: &[(&str, &str)] = &[
        ("1, 2\n", "a.inp:1: expected a keyword line"),
        (
            "*NODE,\n*ELEMENT\n",
            "a.inp:1: *NODE,: expected a further line of options",
        ),
        ("*\n", "a.inp:1: *: expected a keyword after the star"),
        ("*NODE, NSET=a, NSET=b\n", "`NSET` twice"),
        (
            "*NODE, SYSTEM=C\n1\n",
            "a.inp:1: *NODE, SYSTEM=C: expected options among NSET, found `SYSTEM`",
        ),
        ("*NODE\n0, 1\n", "a.inp:2: *NODE: expected a label"),
        (
            "*NODE\n4294967296, 1\n",
            "expected a label from 1 to 4294967295, found `4294967296`",
        ),
        (
            "*NODE\n1, x\n",
            "a.inp:2: *NODE: expected a finite number, found `x`",
        ),
        ("*NODE\n1, inf\n", "expected a finite number"),
        ("*NODE\n1, 1e999\n", "expected a finite number"),
        ("*NODE\n1\n1\n", "a.inp:3: *NODE: expected each node once"),
        (
            "*NODE\n1, 0, 0, 0, 0, 0, 1, 0\n",
            "expected at most 7 values in the line, found 8",
        ),
        (
            "*ELEMENT, TYPE=C3D5\n",
            "a.inp:1: *ELEMENT, TYPE=C3D5: expected an element among C3D8, C3D8I, C3D20, C3D20R, C3D4, C3D10, C3D6, C3D15, found `C3D5`; mesh",
        ),
        ("*ELEMENT\n", "expected TYPE=name"),
        (
            "*ELEMENT, TYPE=C3D8\n1, 1\n",
            "a.inp:2: *ELEMENT, TYPE=C3D8: expected a node defined above, found label 1",
        ),
        ("*NSET\n", "expected NSET=name"),
        (
            "*NSET, NSET=a\nb\n",
            "expected a defined node set, found `b`; there is no node set yet",
        ),
        ("*NODE, NSET=q\n1\n*NSET, NSET=a\nb\n", "there are `q`"),
        (
            "*NODE\n1\n*NSET, NSET=a, GENERATE\n2, 4000000000\n",
            "expected some of 2 to 4000000000 by 1 defined above, found none of them",
        ),
        (
            "*NODE\n1\n*NSET, NSET=a, GENERATE\n2, 1\n",
            "put the smaller label first",
        ),
        (
            "*NODE\n1\n*NSET, NSET=a, GENERATE\n1, 1, 0\n",
            "an increment from 1",
        ),
        (
            "*SURFACE, NAME=a\n1, S7\n",
            "expected a face S1 to S6, found `S7`",
        ),
        (
            "*SURFACE, NAME=a\n*SURFACE, NAME=A\n",
            "a.inp:2: *SURFACE, NAME=A: expected each surface once",
        ),
        ("*ELASTIC\n1, 0\n", "expected *MATERIAL before it"),
        (
            "*MATERIAL, NAME=m\n*ELASTIC\n",
            "a data line with Young's modulus",
        ),
        ("*MATERIAL, NAME=m\n*ELASTIC\n2e11, .5\n", "-1 < nu < 0.5"),
        ("*MATERIAL, NAME=m\n*DENSITY\n-1\n", "a density above 0"),
        ("*PLASTIC\n1\n", "expected *MATERIAL before it"),
        (
            "*HUMIDITY\n1\n",
            "a.inp:1: *HUMIDITY: expected a keyword whose influence on the body is known",
        ),
        (
            "*SOLID SECTION, ELSET=e, MATERIAL=m\n",
            "a.inp:1: *SOLID SECTION: expected a defined element set, found `e`",
        ),
        (
            "*NODE, NSET=n\n1\n*RIGID BODY, NSET=n\n",
            "expected a label",
        ),
        (
            "*NODE, NSET=n\n1\n*RIGID BODY, NSET=n, REF NODE=5\n",
            "found label 5",
        ),
        (
            "*NODE\n1\n*BOUNDARY\n1, x\n",
            "expected a direction from 1 on, found `x`",
        ),
        ("*NODE\n1\n*BOUNDARY\n1, 2, 1\n", "directions 2 to 1"),
        (
            "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n1\n",
            "*SURFACE INTERACTION before it",
        ),
        (
            "*CONTACT PAIR, INTERACTION=i, TYPE=NODE TO SURFACE\na, b\n",
            "a.inp:2: *CONTACT PAIR: expected a defined surface, found `a`",
        ),
        (
            "*STEP\n*STATIC\n",
            "a.inp:1: *STEP: expected *END STEP, found the end of the deck after line 2",
        ),
        ("*STEP\n*STATIC\n*STATIC\n", "one procedure in a step"),
        ("*STEP\n*STEP\n", "a.inp:2: *STEP: expected"),
        ("*STEP\n*NODE\n", "move them in front of *STEP"),
        ("*STEP, NLGEOM=MAYBE\n", "found `MAYBE`"),
        (
            "*STEP\n*STATIC\n0, 1\n",
            "an increment and a period above 0",
        ),
        ("*STEP\n*DYNAMIC, ALPHA=1\n", "between -1/3 and 0"),
        ("*STEP\n*FREQUENCY\n0\n", "a number of modes"),
        ("*STATIC\n", "found the keyword outside a step"),
        ("*END STEP\n", "found the keyword outside a step"),
        ("*INCLUDE\n", "expected *INCLUDE, INPUT=file"),
        (
            "*INCLUDE, INPUT=b.inp\n",
            "found `b.inp`: asked for b.inp; the path is relative",
        ),
    ];
    for (text, expected) in cases {
        let error = read_str("a.inp", text, &mut none).unwrap_err();
        let shown = error.to_string();
        assert!(
            shown.contains(expected),
            "{text:?}\n  {shown}\n  {expected}"
        );
        assert!(shown.starts_with("a.inp:"), "{shown}");
        assert!(error.line > 0);
    }
    let missing = format!("{BRICKS}*ELEMENT, TYPE=C3D8\n2, 1, 2\n*NSET, NSET=a\n");
    let shown = read_str("a.inp", &missing, &mut none)
        .unwrap_err()
        .to_string();
    assert!(
        shown.contains("expected 8 nodes of element 2, found 2; an element continues"),
        "{shown}"
    );
    let wedge = format!("{BRICKS}*ELEMENT, TYPE=C3D8\n2, 1,2,3,3,5,6,7,7\n");
    let shown = read_str("a.inp", &wedge, &mut none)
        .unwrap_err()
        .to_string();
    assert!(
        shown.contains("a collapsed hexahedron is a wedge"),
        "{shown}"
    );
    assert!(read_bytes("a.inp.gz", &[0x1f, 0x8b, 0, 1]).is_err());
    assert!(
        crate::read("no/such/deck.inp")
            .unwrap_err()
            .to_string()
            .starts_with("no/such/deck.inp: ")
    );
}

/// The size of a deck grows with its text, not by repetition of sets.
#[test]
fn sets_of_sets_do_not_explode() {
    let mut text = String::from("*NODE, NSET=s0\n1\n2\n3\n");
    for i in 1..200 {
        let row = vec![format!("s{}", i - 1); 50].join(",");
        text += &format!("*NSET, NSET=s{i}\n{row}\n");
    }
    let deck = read(&text);
    assert_eq!(deck.node_sets["s199"], [0, 1, 2]);
}

/// The seeds of the fuzz target: the same calls, and no panic.
#[test]
fn fuzz_seeds_are_read_or_declined() {
    let folder = format!("{}/../fuzz/corpus/deck", env!("CARGO_MANIFEST_DIR"));
    let mut seen = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let bytes = std::fs::read(&path).unwrap();
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let found = read_str(&name, &text, &mut |_| Ok(text.clone())).map(|_| ());
        seen.push((name, found));
    }
    let of = |name: &str| &seen.iter().find(|s| s.0 == name).unwrap().1;
    assert_eq!(
        of("include.inp").as_ref().unwrap_err().kind,
        DeckErrorKind::Limit
    );
    for name in [
        "gear.inp",
        "pair.inp",
        "rack.inp",
        "cae.inp",
        "gmsh_tet10.inp",
        "gmsh_wedge15.inp",
        "gmsh_hex20.inp",
    ] {
        assert!(of(name).is_ok(), "{:?}", of(name));
    }
    assert!(of("generate.inp").is_ok() && of("options.inp").is_err());
}
