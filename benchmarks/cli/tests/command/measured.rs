//! Tests of the option `--measured`: measured curves compared with the tables of a study.

use super::{Folder, has};

/// Measured points are four fifths of the study's values, in other units and with decimal commas: the error of the
/// study is 25 %.
#[test]
fn measured_curves_are_compared_with_the_tables_of_a_study() {
    let folder = Folder::new();
    let study = "stiffness spur_impact --models rigid-iso6336 --positions 10";
    folder.says(&format!("{study} --out plain"));
    let table = folder.read("plain/cycle_rigid-iso6336.csv");
    let mut lines = table.lines().map(|l| l.split(',').collect::<Vec<_>>());
    let names = lines.next().unwrap();
    let at = |name: &str| names.iter().position(|n| *n == name).unwrap();
    let (place, error) = (at("position_base_pitches"), at("transmission_error_m"));
    let mut measured = String::from("position_base_pitches; transmission error [µm]\n");
    for row in lines {
        let x: f64 = row[place].parse().unwrap();
        let e: f64 = row[error].parse().unwrap();
        measured += &format!("{x}; {}\n", 0.8e6 * e).replace('.', ",");
    }
    folder.write("rig.csv", &measured);
    let said = folder.says(&format!("{study} --measured rig.csv --out here"));
    let line = said.lines().find(|l| l.contains("cycle_rigid-iso6336:"));
    let line = line.unwrap_or_else(|| panic!("{said}"));
    has(
        line,
        &[
            "rig.csv: transmission error over position base pitches",
            "at 10 of 10 measured points",
        ],
    );
    has(line, &[": 25.0 % off"]);
    has(
        &folder.read("here/index.html"),
        &["Measured curves", "rig.csv"],
    );
    super::as_documented(&folder.at("here"));
    // An error in a file is reported with its line, before anything is computed.
    folder.write(
        "bad.csv",
        "position_base_pitches,secant_n_per_m\n0.1,2e8\n0.2,soft\n",
    );
    folder.refuses(
        &format!("{study} --measured bad.csv --out there"),
        &["bad.csv", "line 3", "`soft`"],
    );
    folder.write(
        "unit.csv",
        "position_base_pitches,secant [furlong]\n0.1,2\n0.2,3\n",
    );
    folder.refuses(
        &format!("{study} --measured unit.csv --out there"),
        &["`furlong` is not known", "N/um"],
    );
    assert!(!folder.at("there").exists());
}
