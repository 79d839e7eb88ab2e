//! Files that are refused, with their line, what was expected and found, and a remedy.

use super::*;

/// The refusal of matrices whose files are changed.
fn refusal(body: &Body, names: &[&str], files: &Files) -> String {
    match body.foreign(names, files) {
        Ok(_) => panic!("{names:?} are accepted"),
        Err(e) => e.to_string(),
    }
}

fn edited(files: &Files, name: &str, line: usize, text: &str) -> Files {
    let old = String::from_utf8(files.read(name).unwrap()).unwrap();
    let mut lines: Vec<&str> = old.lines().collect();
    lines[line - 1] = text;
    files.clone().with(name, lines.join("\n"))
}

/// Files, the stiffness and the damaged file, the line, its new text, and what the refusal says.
type Damaged<'a> = (&'a Files, &'a str, &'a str, usize, &'a str, &'a [&'a str]);

#[test]
fn damaged_lines_are_named() {
    let body = Body::small();
    let a = &body.assembly;
    let calculix = printed::calculix(a, "g");
    let abaqus = printed::abaqus(a, "j");
    let ansys = printed::ansys(a, "w");
    let market = printed::numbered(a, "m", "%%MatrixMarket matrix coordinate real general");
    let cases: Vec<Damaged<'_>> = vec![
        (
            &calculix,
            "g.sti",
            "g.sti",
            7,
            "1 2",
            &["g.sti:7", "a row, a column and a value", "`1 2`"],
        ),
        (
            &calculix,
            "g.sti",
            "g.sti",
            3,
            "0 2 1.0",
            &["g.sti:3", "count from 1", "`0`"],
        ),
        (
            &calculix,
            "g.sti",
            "g.sti",
            3,
            "-4 2 1.0",
            &["g.sti:3", "`-4`", "FORMAT=MATRIX INPUT"],
        ),
        (
            &calculix,
            "g.sti",
            "g.mas",
            2,
            "1 2 NaN",
            &["g.mas:2", "a finite value", "`NaN`"],
        ),
        (
            &calculix,
            "g.sti",
            "g.sti",
            2,
            "1 1 3.0",
            &["g.sti", "each entry once", "(1, 1) twice"],
        ),
        (
            &calculix,
            "g.sti",
            "g.dof",
            5,
            "2",
            &["g.dof:5", "`node.direction`"],
        ),
        (
            &calculix,
            "g.sti",
            "g.dof",
            5,
            "2.9",
            &["g.dof:5", "a direction 1 to 6"],
        ),
        (
            &calculix,
            "g.sti",
            "g.dof",
            5,
            "1.1",
            &["g.sti", "direction 1 of node 1 twice"],
        ),
        (
            &calculix,
            "g.sti",
            "g.dof",
            5,
            "2.4",
            &["rotation 1 of node 2", "solid elements"],
        ),
        (
            &calculix,
            "g.sti",
            "g.dof",
            5,
            "900.1",
            &["none in direction 2 of node 2", "boundary conditions"],
        ),
        (
            &abaqus,
            "j_STIF1.mtx",
            "j_STIF1.mtx",
            4,
            "1,1,2,1",
            &["j_STIF1.mtx:4", "node, direction, node, direction"],
        ),
        (
            &abaqus,
            "j_STIF1.mtx",
            "j_MASS1.mtx",
            4,
            "1,x,2,1,1.",
            &["j_MASS1.mtx:4", "a direction", "`x`"],
        ),
        (
            &market,
            "m_STIF2.mtx",
            "m_STIF2.mtx",
            1,
            "%%MatrixMarket matrix array complex",
            &["m_STIF2.mtx:1", "coordinate real"],
        ),
        (
            &ansys,
            "w_stiff.hb",
            "w_stiff.hb",
            2,
            "1 2",
            &["w_stiff.hb:2", "Harwell-Boeing", ".npz"],
        ),
        (
            &ansys,
            "w_stiff.hb",
            "w_stiff.hb",
            3,
            "CSA 3 3 3 0",
            &["w_stiff.hb:3", "RSA", "`CSA`"],
        ),
        (
            &ansys,
            "w_stiff.hb",
            "w_stiff.hb",
            3,
            "RSA 3 4 3 0",
            &["w_stiff.hb:3", "square"],
        ),
        (
            &ansys,
            "w_stiff.hb",
            "w_stiff.hb",
            4,
            "(8X10) (8I10) (3D25.16)",
            &["w_stiff.hb:4", "(8I10)"],
        ),
        (
            &ansys,
            "w_stiff.hb",
            "w_stiff.hb",
            5,
            "1 x",
            &["w_stiff.hb:5", "a whole number"],
        ),
        (
            &ansys,
            "w_stiff.hb",
            "w_stiff.mapping",
            9,
            "3 3 UX",
            &["w_stiff.mapping:9", "row 8"],
        ),
        (
            &ansys,
            "w_stiff.hb",
            "w_stiff.mapping",
            9,
            "8 3 TEMP",
            &["w_stiff.mapping:9", "UX", "structural"],
        ),
    ];
    for (files, first, name, line, text, words) in cases {
        let said = refusal(&body, &[first], &edited(files, name, line, text));
        for word in words {
            assert!(said.contains(word), "{name}:{line} `{text}`: {said}");
        }
    }
    // An incomplete file.
    let text = String::from_utf8(ansys.read("w_mass.hb").unwrap()).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let half = lines[..lines.len() / 2].join("\n");
    let cut = ansys.clone().with("w_mass.hb", half);
    let said = refusal(&body, &["w_stiff.hb"], &cut);
    assert!(said.contains("the end of the file after line"), "{said}");
    // A matrix that is not symmetric.
    let text = String::from_utf8(market.read("m_STIF2.mtx").unwrap()).unwrap();
    let (at, line) = (text.lines().enumerate())
        .find(|(_, l)| l.starts_with("2  1 "))
        .unwrap();
    let odd = edited(&market, "m_STIF2.mtx", at + 1, "2  1  1.0");
    let said = refusal(&body, &["m_STIF2.mtx"], &odd);
    assert!(said.contains("a symmetric matrix"), "{line}: {said}");
}

#[test]
fn files_that_do_not_belong_together_are_named() {
    let body = Body::small();
    let a = &body.assembly;
    let calculix = printed::calculix(a, "g");
    for (names, words) in [
        (
            vec!["g.sti", "other.mas"],
            ["other.mas", "readable file of the mass"],
        ),
        (
            vec!["none.sti"],
            ["none.sti", "readable file of the stiffness"],
        ),
    ] {
        let said = refusal(&body, &names, &calculix);
        assert!(words.iter().all(|w| said.contains(w)), "{said}");
    }
    // Names without a rule need the file of the mass.
    let plain = Files::default().with("k.mtx", calculix.read("g.sti").unwrap());
    let said = refusal(&body, &["k.mtx"], &plain);
    assert!(said.contains("--matrices STIFFNESS,MASS"), "{said}");
    let both = plain.with("m.mtx", calculix.read("g.mas").unwrap());
    assert!(body.foreign(&["k.mtx", "m.mtx"], &both).is_ok());
    // Too few rows for the deck; too few coordinates for the rows.
    let short = "1 1 1.0\n2 2 1.0\n";
    let said = refusal(
        &body,
        &["k.mtx", "m.mtx"],
        &both.clone().with("k.mtx", short).with("m.mtx", short),
    );
    assert!(said.contains("three for each node"), "{said}");
    let said = refusal(
        &body,
        &["g.sti"],
        &calculix.clone().with("g.dof", "1.1\n1.2\n"),
    );
    assert!(said.contains("a coordinate for each of the"), "{said}");
    // A spring to the ground, and a mass of one direction.
    let spring = |name: &str, factor: f64| {
        let text = String::from_utf8(calculix.read(name).unwrap()).unwrap();
        let value: f64 = text
            .lines()
            .next()
            .unwrap()
            .split_whitespace()
            .nth(2)
            .unwrap()
            .parse()
            .unwrap();
        edited(&calculix, name, 1, &format!("1 1 {:e}", factor * value))
    };
    let said = refusal(&body, &["g.sti"], &spring("g.sti", 2.0));
    assert!(
        said.contains("unconstrained body") && said.contains("displacement along x"),
        "{said}"
    );
    let said = refusal(&body, &["g.sti"], &spring("g.mas", 1.5));
    assert!(said.contains("same along all three axes"), "{said}");
    // Shapes without displacements.
    for (name, text, words) in [
        (
            "g.frd",
            "    1C\n 9999\n",
            ["displacements of the nodes in modes", "*NODE FILE"],
        ),
        (
            "g.dat",
            "\n",
            ["displacements of the nodes in modes", "*NODE PRINT"],
        ),
        (
            "g.frd",
            "  100CL  101 x           189  2    1MODAL\n",
            ["g.frd:1", "the frequency of a mode"],
        ),
        (
            "g.frd",
            "  100CL  101 1.0           1  2    1MODAL\n -4  DISP\n -1         1 1.0E+00\n",
            ["g.frd:3", "not binary"],
        ),
        ("g.txt", "", ["another ending", "docs/modal.md"]),
    ] {
        let files = Files::default().with(name, text);
        let e = read_shapes(name, &mut |name| files.read(name))
            .unwrap_err()
            .to_string();
        assert!(words.iter().all(|w| e.contains(w)), "{e}");
    }
    // Arrays.
    let e = refusal(
        &body,
        &["a.npz"],
        &Files::default().with("a.npz", "no archive"),
    );
    assert!(
        e.contains("a zip archive of arrays") && e.contains("docs/modal.md"),
        "{e}"
    );
    let mut w = crate::reduction::store::archive::Writer::new(Vec::new());
    w.i64s("coordinate_node", &[1], [1].into_iter()).unwrap();
    w.i64s("coordinate_direction", &[1], [9].into_iter())
        .unwrap();
    let bytes = w.finish().unwrap();
    let e = refusal(&body, &["a.npz"], &Files::default().with("a.npz", bytes));
    assert!(e.contains("node 1, direction 9"), "{e}");
}
