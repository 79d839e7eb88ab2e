//! Keywords that do not change a body are ignored with a note; those that do are declined.

use super::{BRICKS, none, read};
use crate::{DeckError, Procedure, read_str};
use gearbench_solid_fe::mesh::ElementKind;

fn refused(text: &str) -> DeckError {
    read_str("a.inp", text, &mut none).unwrap_err()
}

const STEEL: &str = "*MATERIAL, NAME=m\n*ELASTIC\n2.1e11, .3, 20.\n*DENSITY\n7850.\n";
const SECTION: &str = "*SOLID SECTION, ELSET=low, MATERIAL=m, ORIENTATION=o\n";

#[test]
fn loads_steps_and_output_are_counted() {
    let deck = read(&format!(
        "{BRICKS}{STEEL}*EXPANSION\n1e-5\n*CONDUCTIVITY\n50., 0.\n60., 100.\n{SECTION}*ORIENTATION, NAME=o\n1,0,0,0,1,0\n\
         *AMPLITUDE, NAME=a\n0,0,1,1\n*INITIAL CONDITIONS, TYPE=TEMPERATURE\nall, 20\n\
         *BOUNDARY\n1, 1, 6\n2, 11, 11, 300.\n3, ZASYMM\n\
         *STEP, PERTURBATION\n*MODAL DYNAMIC\n1e-3, 1.\n*CLOAD, AMPLITUDE=a\n1, 1, 2.\n*CLOAD\n2, 1, 2.\n*END STEP\n\
         *STEP\n*STEADY STATE DYNAMICS\n1, 2, 3\n*BOUNDARY, OP=NEW\n1, 3\n*END STEP\n"
    ));
    let passed = deck.passed_over.clone();
    assert_eq!(passed["*CLOAD"], 2);
    assert_eq!(passed["*BOUNDARY of directions beyond 3"], 1);
    for keyword in [
        "*EXPANSION",
        "*ORIENTATION",
        "*INITIAL CONDITIONS",
        "*MODAL DYNAMIC",
        "*STEADY STATE DYNAMICS",
    ] {
        assert_eq!(passed[keyword], 1, "{keyword}");
    }
    assert_eq!(deck.boundaries[0].directions, [1, 3]);
    assert_eq!(deck.boundaries[1].directions, [1, 2]);
    assert_eq!(
        (deck.steps[0].procedure, deck.steps[0].perturbation),
        (Procedure::Other, true)
    );
    assert!(deck.steps[1].boundaries_anew && !deck.steps[0].boundaries_anew);
    assert!(deck.told().iter().any(|l| l.contains("2 *CLOAD")));
}

#[test]
fn what_changes_a_body_is_declined() {
    let solid = format!("{BRICKS}{STEEL}{SECTION}");
    let beyond = |line: &str| format!("{BRICKS}{STEEL}{line}{SECTION}");
    for (text, words) in [
        (
            beyond("*PLASTIC\n300.,0.\n"),
            "a.inp:24: *PLASTIC: expected linear elasticity of material `m`: E and nu, found more; the material is linear elastic",
        ),
        (
            beyond("*ELASTIC, TYPE=ORTHO\n1,2,3,4,5,6,7,8\n9\n"),
            "*ELASTIC, TYPE=ORTHO: expected linear elasticity",
        ),
        (
            beyond("*ELASTIC\n2e11,.3,20\n1e11,.3,500\n"),
            "does not depend on temperature",
        ),
        (
            format!("{solid}*EQUATION\n2\n1,1,1.,2,1,-1.\n"),
            "*EQUATION: expected nodes that are connected by their elements only",
        ),
        (
            format!("{solid}*TIE, NAME=t\na, b\n"),
            "found `*TIE`; let connected parts share their nodes",
        ),
        (
            format!("{solid}*CYCLIC SYMMETRY MODEL, N=5\n"),
            "mesh the whole body",
        ),
        (
            format!("{solid}*SPRING, ELSET=low\n\n1.\n"),
            "give masses and springs in the scene",
        ),
        (
            format!(
                "{solid}*ELEMENT, TYPE=S3, ELSET=skin\n7, 1, 2, 3\n*SHELL SECTION, ELSET=skin, MATERIAL=m\n1.\n"
            ),
            "expected solid elements only, found `*SHELL SECTION`",
        ),
        (
            format!(
                "{solid}*ELEMENT, TYPE=CPS3, ELSET=skin\n7, 1, 2, 3\n*SOLID SECTION, ELSET=skin, MATERIAL=m\n1.\n"
            ),
            "expected solid elements in its set, found element 7 of another type",
        ),
        (
            format!("{solid}*STEP\n*MODEL CHANGE, TYPE=ELEMENT, REMOVE\nlow\n*END STEP\n"),
            "elements that are added or removed",
        ),
        (
            format!("{solid}*NGEN\n1, 5\n"),
            "let the preprocessor write the whole mesh",
        ),
        (
            format!("{BRICKS}*ELEMENT, TYPE=C3D27\n7,1\n"),
            "found `C3D27`",
        ),
        (
            format!("{BRICKS}*ELEMENT, TYPE=C3D4\n7,1,3,2,5\n"),
            "element 7 with the Jacobian -1.000e0",
        ),
    ] {
        let shown = refused(&text).to_string();
        assert!(shown.contains(words), "{words}\n{shown}");
    }
    // A material that no body has may be anything.
    read(&format!(
        "{solid}*MATERIAL, NAME=other\n*PLASTIC\n300.,0.\n"
    ));
}

#[test]
fn conditions_in_axes_of_their_own_are_marked() {
    let axes =
        format!("{BRICKS}*NSET, NSET=few\n1, 2\n*TRANSFORM, NSET=few, TYPE=C\n0,0,0,0,0,1\n");
    let deck = read(&format!(
        "{axes}*BOUNDARY\nall, 1\nall, 1, 3\n5, 1\n*STEP\n*BOUNDARY\n2, 3\n*END STEP\n"
    ));
    let own: Vec<bool> = deck.boundaries.iter().map(|b| b.own_axes).collect();
    assert_eq!(own, [true, false, false]);
    assert!(deck.steps[0].boundaries[0].own_axes);
    assert!(
        deck.told()
            .iter()
            .any(|l| l.contains("2 conditions are in local axes"))
    );
}

/// Lines and surfaces that Gmsh writes to `.inp` with solids, without section or material, become node sets.
#[test]
fn lines_and_surfaces_give_node_sets() {
    let deck = read(
        "*Heading\n cube.inp\n*NODE\n1, 0, 0, 0\n2, 20, 0, 0\n3, 0, 20, 0\n4, 0, 0, 20\n\
         ******* E L E M E N T S *************\n\
         *ELEMENT, type=T3D2, ELSET=Line1\n1, 1, 2\n\
         *ELEMENT, type=CPS3, ELSET=Surface1\n2, 1, 3, 2\n*ELEMENT, type=CPS3, ELSET=Surface2\n3, 1, 2, 4\n\
         *ELEMENT, type=C3D4, ELSET=Volume1\n4, 1, 2, 3, 4\n\
         *ELSET,ELSET=bore\n2, 3,\n*NSET,NSET=back\n1, 3, 4,\n",
    );
    assert_eq!(
        (deck.element_count(), deck.blocks[0].kind),
        (1, ElementKind::C3D4)
    );
    assert_eq!(deck.node_sets["line1"], [0, 1]);
    assert_eq!(deck.node_sets["surface2"], [0, 1, 3]);
    assert_eq!(deck.node_sets["bore"], [0, 2, 1, 3]);
    assert_eq!(deck.node_sets["back"], [0, 2, 3]);
    assert_eq!(deck.element_sets.keys().collect::<Vec<_>>(), ["volume1"]);
    assert_eq!(deck.units.name, "mm-t-s");
    let told = deck.told().join("\n");
    let words = "not solids and have no section: 2 CPS3, 1 T3D2; their nodes are the node sets bore, line1, surface1, surface2";
    assert!(told.contains(words), "{told}");
}

#[test]
fn ranges_may_have_gaps_and_elements_more_values() {
    let deck = read(&format!(
        "{BRICKS}*NSET, NSET=a, GENERATE\n2, 4000000000, 5\n*ELSET, ELSET=b, GENERATE\n1, 50\n\
         *NSET, NSET=c, ELSET=low\n"
    ));
    assert_eq!(deck.node_sets["a"], [1, 6, 11]);
    assert_eq!(deck.element_sets["b"], [0, 1]);
    assert_eq!(deck.node_sets["c"].len(), 8);
    // CalculiX takes the nodes that it needs and leaves the rest.
    let more = read(&BRICKS.replace("1,1,2,3,4,5,6,7,8\n", "1,1,2,3,4,5,6,7,8,9,10\n"));
    assert!(
        more.told()
            .iter()
            .any(|l| l.contains("values after the 8 nodes of C3D8"))
    );
    assert_eq!(more.blocks[0], read(BRICKS).blocks[0]);
}
