//! Tests of the command `gearbench mesh`.

use super::{Folder, has};

#[test]
fn meshes_are_written_as_decks_and_for_paraview() {
    let folder = Folder::new();
    let said = folder.says("mesh spur_impact");
    has(&said, &["pinion", "wheel", "no file was written"]);
    assert_eq!(folder.files(), 0);

    let arguments = "--width 1 --flank 5 --element c3d20r --out g.inp --vtu g.vtu";
    let said = folder.says(&format!("mesh spur_impact {arguments}"));
    for (name, teeth) in [("pinion", 20), ("wheel", 30)] {
        let deck = gearbench_reference::deck::read(folder.at(&format!("g-{name}.inp"))).unwrap();
        let gears = gearbench_reference::gear_deck::gears(&deck).unwrap();
        let mesh = &gears[0].mesh;
        assert_eq!((gears.len(), mesh.teeth), (1, teeth));
        assert_eq!(mesh.mesh.kind_names(), "C3D20R");
        assert!(mesh.flanks.iter().all(|f| (f.rows, f.columns) == (6, 2)));
        let (nodes, elements) = (mesh.mesh.nodes.len(), mesh.mesh.element_count());
        has(&said, &[&format!("{nodes}  {elements:>8}")]);
        let page = folder.read(&format!("g-{name}.vtu"));
        let head = format!("NumberOfPoints=\"{nodes}\" NumberOfCells=\"{elements}\"");
        assert!(page.contains(&head) && page.contains("\n</VTKFile>\n"));
    }
    // Four files and nothing else.
    assert_eq!(folder.files(), 4);

    // A deck contains a mesh.
    folder.says("mesh g-pinion.inp --vtu again.vtu");
    assert!(folder.at("again.vtu").exists());
}

#[test]
fn a_sector_carries_the_cuts_in_matching_order() {
    let folder = Folder::new();
    folder.says("mesh spur_impact --gear wheel --sector --out s.inp");
    let text = folder.read("s.inp");
    let numbers = |block: &str| -> Vec<Vec<f64>> {
        let (_, body) = text.split_once(block).unwrap();
        let lines = (body.lines().skip(1)).take_while(|l| !l.starts_with('*'));
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
    folder.write("broken.inp", "*NODE\n1, 2\n");
    let cases: [(&str, &[&str]); 8] = [
        (
            "spur_impact --gear pinoin",
            &["no gear `pinoin`", "pinion, wheel"],
        ),
        (
            "spur_impact --element C3D4",
            &["no element `C3D4`", "C3D20R"],
        ),
        (
            "spur_impact --across 2",
            &["across the tooth is 2", "--across"],
        ),
        (
            "spur_impact --fine-teeth 1,31",
            &["fine tooth 30 does not exist", "start at 1"],
        ),
        ("spur_impact --fine-teeth 0", &["--fine-teeth"]),
        ("broken.inp", &["broken.inp"]),
        ("broken.inp --flank 3", &["--flank", "contains a mesh"]),
        (
            "spur_impact --vtu x.inp",
            &["has to end in .vtu", "write --vtu x.vtu"],
        ),
    ];
    for (arguments, words) in cases {
        folder.refuses(&format!("mesh {arguments} --out x.inp"), words);
        assert_eq!(folder.files(), 1, "{arguments} wrote something");
    }
    // The input itself is never overwritten, and a folder that does not exist is named.
    folder.refuses(
        "mesh spur_impact --gear pinion --out broken.inp",
        &["exists already", "--force"],
    );
    folder.says("mesh spur_impact --gear pinion --out broken.inp --force");
    folder.ends("mesh spur_impact --gear pinion --out nowhere/x.inp", 2);
    folder.refuses("mesh broken.inp --out broken.inp", &["is an input"]);
}

/// Decks with a modal analysis for three programs: gearbench reads them again, and the body is the same.
#[test]
fn modal_decks_write_matrices_and_modes() {
    let folder = Folder::new();
    let sizes = "--gear pinion --flank 3 --fillet 2 --across 4 --layers 1 --rim 1 --width 1";
    for (program, file, words) in [
        (
            "calculix",
            "c.inp",
            [
                "*FREQUENCY, SOLVER=SPOOLES\n30\n",
                "OP=NEW\n*FREQUENCY, SOLVER=MATRIXSTORAGE",
            ],
        ),
        (
            "abaqus",
            "a.inp",
            ["*MATRIX GENERATE, STIFFNESS, MASS", "FORMAT=MATRIX INPUT"],
        ),
        (
            "ansys",
            "my-job.cdb",
            [
                "MODOPT,LANB,30",
                "HBMAT,my_job_stiff,hb,,ASCII,STIFF,NO,YES",
            ],
        ),
    ] {
        folder.says(&format!(
            "mesh spur_impact {sizes} --modal {program} --modes 30 --out {file}"
        ));
        has(&folder.read(file), &words);
        // A second time: the file is one of this command.
        folder.says(&format!(
            "mesh spur_impact {sizes} --modal {program} --modes 30 --out {file}"
        ));
    }
    let read = |file: &str| {
        let deck = gearbench_reference::deck::read(folder.at(file)).unwrap();
        gearbench_reference::gear_deck::gears(&deck)
            .unwrap()
            .swap_remove(0)
    };
    let [a, b, c] = ["c.inp", "a.inp", "my-job.cdb"].map(read);
    assert!(a.mesh.mesh.nodes == c.mesh.mesh.nodes && a.mesh.mesh == b.mesh.mesh);
    assert!(a.mesh.mesh.blocks == c.mesh.mesh.blocks && a.mesh.flanks == c.mesh.flanks);
    has(
        &folder.says("mesh my-job.cdb"),
        &["C3D8I", "no file was written"],
    );
    let cases: [(&str, &[&str]); 4] = [
        ("--modal ansys --out p.inp", &["--out p.inp", "end in .cdb"]),
        (
            "--modal calculix --sector --out p.inp",
            &["whole gear", "remove --sector"],
        ),
        ("--modal nastran", &["calculix, abaqus, ansys"]),
        ("--modes 30", &["--modal"]),
    ];
    for (arguments, words) in cases {
        folder.refuses(
            &format!("mesh spur_impact --gear pinion {arguments}"),
            words,
        );
    }
}
