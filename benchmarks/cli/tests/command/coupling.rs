//! Tests of the command `gearbench coupling`.

use super::{Folder, has, stderr};

#[test]
fn a_coupling_writes_its_folder_and_says_how_far_it_holds() {
    let folder = Folder::new();
    let arguments = "coupling spur_impact --models rigid --steps 1e-6:6.4e-5:7 --out out";
    let said = folder.says(arguments);
    has(
        &said,
        &["rigid", "constant", "linear", "quadratic", "theory"],
    );
    let table = folder.read("out/coupling.csv");
    let column = |name: &str| {
        let at = table
            .lines()
            .next()
            .unwrap()
            .split(',')
            .position(|c| c == name);
        let cell = |l: &str| l.split(',').nth(at.unwrap()).unwrap().to_owned();
        // The first row is the model as one system.
        table.lines().skip(2).map(cell).collect::<Vec<String>>()
    };
    // Small steps converge, the largest fail, in between limits are closed in on.
    let status = column("status");
    assert!(status.len() > 21 && status.iter().any(|s| s == "energy growth"));
    let error: Vec<f64> = column("force_l2")
        .iter()
        .map_while(|x| x.parse().ok())
        .collect();
    assert!(status[0] == "converged" && error[0] < 0.02 && error[1] > 1.5 * error[0]);
    let record = folder.read("out/results.json");
    has(
        &record,
        &["\"name\": \"coupling\"", "theory_step_s", "energy_error_j"],
    );
    has(
        &folder.read("out/index.html"),
        &["How far the coupling holds", "Error of the coupling"],
    );
    // The record leads back to itself.
    has(&folder.says("rerun out --out again"), &["the same: all"]);
}

#[test]
fn what_cannot_be_coupled_is_refused_with_a_way_out() {
    let folder = Folder::new();
    let refused = |arguments: &str, told: &[&str]| {
        has(
            &stderr(&folder.ends(&format!("coupling {arguments}"), 2)),
            told,
        );
    };
    refused("driveline", &["shafts", "gearbench fmu"]);
    refused("spur_impact --models rigit", &["rigid"]);
    refused("spur_impact --steps 1e-4:1e-6", &["FROM < TO"]);
    refused(
        "spur_impact --models rigid --steps 1e-3:1e-2",
        &["--duration"],
    );
    refused("spur_impact --extrapolations cubic", &["quadratic"]);
    refused(
        "spur_impact --models movable-teeth --integrator trigonometric@1us",
        &["oscillators"],
    );
    refused(
        "spur_impact --models rigid --integrator rk4@1us,dopri5@1e-6",
        &["name one"],
    );
    assert_eq!(folder.files(), 0, "nothing is written");
}
