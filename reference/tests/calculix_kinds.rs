//! Boxes of tetrahedra, of wedges, and of wedges with hexahedra, compared with CalculiX: the integration rules are
//! equal, so that the frequencies agree to all printed digits.
#![allow(clippy::print_stdout, reason = "observed figures")]

use gearbench_models::stiffness::Material;
use gearbench_reference::assembly::assemble;
use gearbench_reference::assembly::tie::{MassKind, Tie};
use gearbench_reference::deck;
use gearbench_reference::modes::{Options, lowest};
use std::path::PathBuf;

fn folder() -> PathBuf {
    [env!("CARGO_MANIFEST_DIR"), "calculix", "kinds"]
        .iter()
        .collect()
}

/// A column of printed numbers, each with the unit of its last digit: seven digits behind `0.`.
fn printed(column: &str) -> Vec<(f64, f64)> {
    let mut reader = csv::Reader::from_path(folder().join("frequencies.csv")).unwrap();
    let at = reader.headers().unwrap().iter().position(|h| h == column);
    let at = at.unwrap_or_else(|| panic!("no column {column}"));
    let cells = reader.records().map(|r| r.unwrap()[at].to_owned());
    cells
        .map(|cell| {
            let exponent: i32 = cell.split_once('E').unwrap().1.parse().unwrap();
            (cell.parse().unwrap(), 10.0_f64.powi(exponent - 7))
        })
        .collect()
}

#[test]
fn frequencies_of_all_kinds_are_those_of_calculix() {
    for (name, kinds) in [
        ("box_C3D4", "C3D4"),
        ("box_C3D10", "C3D10"),
        ("box_C3D6", "C3D6"),
        ("box_C3D15", "C3D15"),
        ("box_C3D6_C3D8", "C3D6, C3D8"),
        ("box_C3D15_C3D20R", "C3D15, C3D20R"),
    ] {
        let deck = deck::read(folder().join(format!("{name}.inp"))).unwrap();
        let mesh = deck.mesh();
        assert_eq!(mesh.kind_names(), kinds);
        let material: Material = deck.material("steel").unwrap();
        let assembly = assemble(&mesh, &material).unwrap();
        let tie = Tie::new(&mesh.nodes, &deck.node_sets["bore"], &[]);
        let reduced = tie.reduce(&assembly, &[], MassKind::Consistent);
        let expected = printed(&format!("{name}_hz"));
        let found = lowest(&reduced, expected.len(), &Options::default()).unwrap();
        let mut worst = 0.0_f64;
        for ((f, unit), own) in expected.iter().zip(found.frequencies()) {
            let digits = (own - f).abs() / unit;
            worst = worst.max(digits);
            assert!(digits < 1.0, "{name}: {own} Hz for {f} Hz");
        }
        println!("{name}: frequencies within {worst:.2} of the last printed digit");
    }
}
