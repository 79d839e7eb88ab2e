use super::*;
use crate::test_support::{calculix, parsed};

fn seed(name: &str) -> String {
    let folder = format!("{}/fuzz/corpus/deck", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(format!("{folder}/{name}")).unwrap()
}

fn findings(text: &str) -> Vec<Finding> {
    check_gtm(&parsed("g.inp", text))
}

/// The only finding there is.
fn only(text: &str, requirement: GtmRequirement, words: &[&str]) {
    let all = findings(text);
    assert_eq!(all.len(), 1, "{all:#?}");
    assert_eq!(all[0].requirement, requirement);
    let shown = all[0].to_string();
    for w in words {
        assert!(shown.contains(w), "`{w}` in {shown}");
    }
}

#[test]
fn a_good_deck_has_no_findings() {
    assert_eq!(findings(&seed("gear.inp")), []);
    let deck = calculix("modal/impA_g1_C3D8.inp.gz");
    assert_eq!(check_gtm(&deck), []);
}

#[test]
fn each_requirement_is_found_alone() {
    let good = seed("gear.inp");
    use GtmRequirement as R;
    only(
        &good.replace("2.1e11", "2.1e5"),
        R::Units,
        &[
            "g.inp:",
            "E = 2.1e5 of material `steel`, which looks like MPa",
            "1e6",
        ],
    );
    only(
        &good.replace("7850.", "7.85e-9"),
        R::Units,
        &["t/mm^3", "7850"],
    );
    only(&good.replace("7850.", "7.85"), R::Units, &["g/cm^3"]);
    only(
        &good
            .replace("NSET=bore", "NSET=bore1")
            .replace("bore, 1, 3", "bore1, 1, 3"),
        R::Bore,
        &["g.inp:", "found `bore1`; name it `bore`"],
    );
    only(
        &good
            .replace("NSET=bore", "NSET=hub")
            .replace("bore, 1, 3", "hub, 1, 3"),
        R::Bore,
        &["a node set `bore`: found none"],
    );
    only(
        &good.replace("NSET=flank_3l", "NSET=tooth_3l"),
        R::Flanks,
        &["1 of 8 flanks", "flank_3l"],
    );
    only(
        &good.replace("NSET=flank_", "NSET=flank1_"),
        R::Flanks,
        &["`flank1_1l`", "as in `flank_1l`"],
    );
    // Left called right.
    only(
        &good
            .replace("NSET=flank_2l", "NSET=flank_x")
            .replace("NSET=flank_2r", "NSET=flank_2l")
            .replace("NSET=flank_x", "NSET=flank_2r"),
        R::Flanks,
        &["set `flank_2l`", "the other side", "swap l and r"],
    );
    // Teeth numbered clockwise.
    only(
        &good
            .replace("NSET=flank_2", "NSET=flank_x")
            .replace("NSET=flank_4", "NSET=flank_2")
            .replace("NSET=flank_x", "NSET=flank_4"),
        R::Flanks,
        &["counter-clockwise", "on the tooth with number"],
    );
    only(
        &good.replace("*SOLID SECTION, ELSET=gear, MATERIAL=STEEL\n", ""),
        R::Material,
        &["*SOLID SECTION"],
    );
    only(
        &good.replace("*DENSITY\n7850.\n", ""),
        R::Material,
        &["*DENSITY"],
    );
    only("*NODE\n1\n", R::Hexahedra, &["no elements"]);
}

/// Positions changed line by line.
fn moved(text: &str, change: impl Fn([f64; 3]) -> [f64; 3]) -> String {
    let mut nodes = false;
    let lines = text.lines().map(|line| {
        if line.starts_with('*') {
            nodes = line.starts_with("*NODE,");
        } else if nodes {
            let cells: Vec<f64> = line.split(',').map(|c| c.trim().parse().unwrap()).collect();
            let [x, y, z] = change([cells[1], cells[2], cells[3]]);
            return format!("{}, {x}, {y}, {z}\n", cells[0]);
        }
        format!("{line}\n")
    });
    lines.collect()
}

#[test]
fn size_place_and_axis() {
    let good = seed("gear.inp");
    use GtmRequirement as R;
    let mm = moved(&good, |x| x.map(|v| 1e3 * v));
    only(
        &mm,
        R::Units,
        &["looks like millimetres", "divide all coordinates by 1000"],
    );
    let away = moved(&good, |[x, y, z]| [x + 0.1, y, z]);
    only(&away, R::Origin, &["(1.000000e-1, "]);
    let up = moved(&good, |[x, y, z]| [x, y, z + 5e-3]);
    only(&up, R::Origin, &["5.000000e-3)"]);
    for (axis, turned) in [
        ("about x", moved(&good, |[x, y, z]| [z, x, y])),
        ("about y", moved(&good, |[x, y, z]| [y, z, x])),
    ] {
        only(&turned, R::AxisZ, &[axis, "turn the model"]);
    }
    let oval = moved(&good, |[x, y, z]| [1.2 * x, y, z]);
    only(&oval, R::AxisZ, &["no circle about a coordinate axis"]);
    let two = findings(&seed("pair.inp"));
    assert_eq!(two[0].requirement, R::OneGear);
    assert!(two[0].found.starts_with("2 bodies"));
}

#[test]
fn a_flank_with_holes_is_no_grid() {
    let mut deck = calculix("modal/impA_g1_C3D8.inp.gz");
    deck.node_sets.get_mut("flank_3l").unwrap().remove(2);
    let all = check_gtm(&deck);
    assert_eq!(all.len(), 1);
    assert_eq!(all[0].requirement, GtmRequirement::Structured);
    assert!(all[0].to_string().contains("set `flank_3l`"), "{}", all[0]);
}

#[test]
fn millimetres_and_tetrahedra_are_told() {
    let good = seed("gear.inp")
        .replace("2.1e11", "2.1e5")
        .replace("7850.", "7.85e-9");
    let mm = moved(&good, |x| x.map(|v| 1e3 * v));
    only(
        &mm,
        GtmRequirement::Units,
        &["found mm-t-s (from E = 2.1e5", "which converts units"],
    );
    let found =
        findings("*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*ELEMENT, TYPE=C3D4\n1,1,2,3,4\n");
    let shown = found[0].to_string();
    assert!(
        shown.contains("g.inp:6: ") && shown.contains("found C3D4"),
        "{shown}"
    );
}
