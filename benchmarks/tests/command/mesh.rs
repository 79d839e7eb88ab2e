//! `gearbench mesh`.

use super::{Folder, gearbench, is_empty, stderr, stdout};

#[test]
fn meshes_are_written_as_decks_and_for_paraview() {
    let folder = Folder::new();
    let dry = gearbench(folder.path(), &["mesh", "spur_impact"]);
    assert_eq!(dry.status.code(), Some(0), "{}", stderr(&dry));
    let said = stdout(&dry);
    assert!(
        said.contains("pinion") && said.contains("wheel") && said.contains("nothing was written"),
        "{said}"
    );
    assert!(is_empty(folder.path()));

    let arguments = [
        "mesh",
        "spur_impact",
        "--width",
        "1",
        "--flank",
        "5",
        "--element",
        "c3d20r",
    ];
    let out = gearbench(
        folder.path(),
        &[&arguments[..], &["--out", "g.inp", "--vtu", "g.vtu"]].concat(),
    );
    assert_eq!(out.status.code(), Some(0), "{}", stderr(&out));
    for (name, teeth) in [("pinion", 20), ("wheel", 30)] {
        let deck = gearbench_reference::deck::read(folder.at(&format!("g-{name}.inp"))).unwrap();
        let gears = gearbench_reference::deck::gears(&deck).unwrap();
        let mesh = &gears[0].mesh;
        assert_eq!((gears.len(), mesh.teeth), (1, teeth));
        assert_eq!(mesh.mesh.kind.name(), "C3D20R");
        assert!(mesh.flanks.iter().all(|f| (f.rows, f.columns) == (6, 2)));
        let counts = format!(
            "{}  {:>8}",
            mesh.mesh.nodes.len(),
            mesh.mesh.element_count()
        );
        assert!(stdout(&out).contains(&counts), "{}", stdout(&out));
        let page = std::fs::read_to_string(folder.at(&format!("g-{name}.vtu"))).unwrap();
        let head = format!(
            "NumberOfPoints=\"{}\" NumberOfCells=\"{}\"",
            mesh.mesh.nodes.len(),
            mesh.mesh.element_count()
        );
        assert!(page.contains(&head) && page.ends_with("</VTKFile>\n"));
    }
    // Four files and nothing else.
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 4);

    // A deck brings its own mesh.
    let again = gearbench(
        folder.path(),
        &["mesh", "g-pinion.inp", "--vtu", "again.vtu"],
    );
    assert_eq!(again.status.code(), Some(0), "{}", stderr(&again));
    assert!(folder.at("again.vtu").exists());
}

#[test]
fn a_sector_carries_the_cuts_in_matching_order() {
    let folder = Folder::new();
    let out = gearbench(
        folder.path(),
        &[
            "mesh",
            "spur_impact",
            "--gear",
            "wheel",
            "--sector",
            "--out",
            "s.inp",
        ],
    );
    assert_eq!(out.status.code(), Some(0), "{}", stderr(&out));
    let text = std::fs::read_to_string(folder.at("s.inp")).unwrap();
    let numbers = |block: &str| -> Vec<Vec<f64>> {
        let body = text
            .split_once(block)
            .unwrap()
            .1
            .split_once('\n')
            .unwrap()
            .1;
        let lines = body.lines().take_while(|l| !l.starts_with('*'));
        lines
            .map(|l| l.split(',').filter_map(|w| w.trim().parse().ok()).collect())
            .collect()
    };
    let nodes = numbers("*NODE,");
    let at = |n: &f64| &nodes[*n as usize - 1][1..4];
    let (low, high) = (
        numbers("NSET=cut_low").concat(),
        numbers("NSET=cut_high").concat(),
    );
    assert!(low.len() == high.len() && low.len() > 20);
    let (sin, cos) = (std::f64::consts::TAU / 30.0).sin_cos();
    for (a, b) in low.iter().zip(&high) {
        let (a, b) = (at(a), at(b));
        let turned = [cos * a[0] - sin * a[1], sin * a[0] + cos * a[1], a[2]];
        for k in 0..3 {
            assert!((turned[k] - b[k]).abs() < 1e-14, "{turned:?} {b:?}");
        }
    }
}

#[test]
fn meshes_that_cannot_be_made_are_refused_and_nothing_is_written() {
    let folder = Folder::new();
    let solid: String = include_str!("../../scenes/hammer.toml")
        .lines()
        .filter(|l| !l.starts_with("bore_radius_m"))
        .map(|l| format!("{l}\n"))
        .collect();
    std::fs::write(folder.at("solid.toml"), solid).unwrap();
    std::fs::write(folder.at("broken.inp"), "*NODE\n1, 2\n").unwrap();
    let cases: [(&[&str], &[&str]); 9] = [
        (
            &["solid.toml"],
            &["is solid", "bore_radius_m = 0.0", "[gears.pinion]"],
        ),
        (
            &["spur_impact", "--gear", "pinoin"],
            &["no gear `pinoin`", "pinion, wheel"],
        ),
        (
            &["spur_impact", "--element", "C3D4"],
            &["no element `C3D4`", "C3D20R"],
        ),
        (
            &["spur_impact", "--across", "2"],
            &["across the tooth is 2", "--across"],
        ),
        (
            &["spur_impact", "--fine-teeth", "1,31"],
            &["fine tooth 30 does not exist", "from 1"],
        ),
        (&["spur_impact", "--fine-teeth", "0"], &["--fine-teeth"]),
        (&["broken.inp"], &["broken.inp"]),
        (
            &["broken.inp", "--flank", "3"],
            &["--flank", "brings its own mesh"],
        ),
        (&["spur_impact", "--vtu", "x.inp"], &["asked for twice"]),
    ];
    for (arguments, expected) in cases {
        let all = [&["mesh"], arguments, &["--out", "x.inp"]].concat();
        let out = gearbench(folder.path(), &all);
        assert_eq!(out.status.code(), Some(2), "{all:?}: {}", stderr(&out));
        for words in expected {
            assert!(stderr(&out).contains(words), "{all:?}: {}", stderr(&out));
        }
        assert_eq!(
            std::fs::read_dir(folder.path()).unwrap().count(),
            2,
            "{all:?} wrote something"
        );
    }
    // The input itself is never overwritten, and a folder that does not exist is named.
    for out in ["broken.inp", "nowhere/x.inp"] {
        let o = gearbench(
            folder.path(),
            &["mesh", "spur_impact", "--gear", "pinion", "--out", out],
        );
        assert_eq!(
            o.status.code(),
            Some(if out == "broken.inp" { 0 } else { 2 })
        );
    }
    let own = gearbench(
        folder.path(),
        &["mesh", "broken.inp", "--out", "broken.inp"],
    );
    assert_eq!(own.status.code(), Some(2));
    assert!(stderr(&own).contains("is the input"), "{}", stderr(&own));
}
