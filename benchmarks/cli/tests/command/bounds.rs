//! Tests of the bounds of memory and inputs, and of models that cannot run.

use super::{Folder, has, stderr};
use serde_json::Value;

const PAIR: &str = include_str!("../malformed/scene.toml");

/// The pair with full finite elements that take far more than a tenth of a gigabyte.
fn with_fe() -> String {
    let fe = "[[models]]\nmodel = \"fe\"\nparameters = { flank_elements = 20, width_elements = 8 }\n\
              contact = { penalty_pa_per_m = 1e15 }\nintegrators = [{ method = \"newmark\", step_s = 1e-6 }]\n\n[study]";
    PAIR.replace("[study]", fe)
}

/// The limit is read before models are built; the model that is beyond it is a row, the others run.
#[test]
fn a_model_beyond_the_memory_is_a_row_and_the_others_run() {
    let folder = Folder::new();
    folder.write("s.toml", &with_fe());
    let study = "compare s.toml --models rigid,movable-teeth,fe --integrators dopri5@1e-6 --repeats 1 --out o";
    let out = folder.ends(&format!("{study} --memory 0.05"), 3);
    has(
        &stderr(&out),
        &[
            "the model `fe` is refused, the others run",
            "s.toml:",
            "--memory",
        ],
    );
    let record: Value = serde_json::from_str(&folder.read("o/results.json")).unwrap();
    let rows = record["runs"].as_array().unwrap();
    let ended: Vec<[&str; 2]> = (rows.iter())
        .map(|r| ["model", "status"].map(|key| r[key].as_str().unwrap()))
        .collect();
    assert_eq!(ended[2], ["fe", "refused"], "{ended:?}");
    assert!(
        ended[..2].iter().all(|[_, status]| *status != "refused"),
        "{ended:?}"
    );
    let reason = rows[2]["message"].as_str().unwrap();
    assert!(reason.contains("would need about"), "{reason}");
    // Where none can run that is an error of the input, with the limit that was given.
    folder.refuses(
        "compare s.toml --models fe --repeats 1 --memory 0.05 --out p",
        &["would need about", "raise the limit with --memory"],
    );
    assert!(!folder.at("p").exists());
    // Commands without a folder have the limit as well.
    for command in ["mesh s.toml --out g.inp", "reduce s.toml --model elastic"] {
        folder.refuses(&format!("{command} --memory 1e-5"), &["--memory"]);
    }
}

/// Full finite elements with lumped mass take between two thirds and three halves of their estimate.
#[cfg(target_os = "linux")]
#[test]
fn lumped_finite_elements_take_what_is_estimated() {
    let folder = Folder::new();
    let fe = "parameters = { flank_elements = 10, fillet_elements = 4, across_elements = 6, rim_elements = 4, \
              width_elements = 4, mass = \"lumped\" }";
    let text = with_fe()
        .replace(
            "parameters = { flank_elements = 20, width_elements = 8 }",
            fe,
        )
        .replace("duration_s = 1e-4", "duration_s = 2e-9")
        .replace("step_s = 1e-6", "step_s = 1e-9");
    assert!(text.contains(fe));
    folder.write("s.toml", &text);
    let study = "compare s.toml --models fe --integrators velocity-verlet@1ns --repeats 1";
    // The larger gear has 65,250 unknowns.
    folder.refuses(
        &format!("{study} --memory 0.25 --out o"),
        &["65250 unknowns", "matrices", "need about 0.3 GB"],
    );
    let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_gearbench"))
        .args(format!("{study} --memory 0.3 --out o").split_whitespace())
        .current_dir(folder.at("."))
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::null())
        .spawn()
        .unwrap();
    let status = format!("/proc/{}/status", child.id());
    let mut most: f64 = 0.0;
    let code = loop {
        let text = std::fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|l| l.strip_prefix("VmHWM:"));
        let kilobytes = line.and_then(|l| l.split_whitespace().next()?.parse::<f64>().ok());
        most = most.max(1e-6 * kilobytes.unwrap_or(0.0));
        if let Some(ended) = child.try_wait().unwrap() {
            break ended.code();
        }
        std::thread::sleep(std::time::Duration::from_millis(2));
    };
    assert!(matches!(code, Some(0 | 1)), "{code:?}");
    let estimate = 0.274;
    assert!(
        (estimate / 1.5..1.5 * estimate).contains(&most),
        "{most} GB beside {estimate} GB"
    );
}

/// Errors that need no mesh are reported before meshing: this mesh would be refused for its size.
#[test]
fn a_half_space_between_conical_gears_is_refused_before_its_gears_are_meshed() {
    let folder = Folder::new();
    let elastic = "parameters = { modes = 4, flank_elements = 400, width_elements = 400 }\ncontact = { local = \"half-space\" }";
    let text = PAIR
        .replace("mount = \"revolute\"", "mount = \"revolute\"\nprofile_shift_angle_deg = 2.0")
        .replace("backlash_m = 80e-6", "centre_distance_m = 0.1002")
        .replace(
            "parameters = { modes = 4, flank_elements = 4, width_elements = 1 }\ncontact = { penalty_pa_per_m = 1e15 }",
            elastic,
        );
    assert!(text.contains("half-space") && text.contains("profile_shift_angle_deg"));
    folder.write("s.toml", &text);
    folder.refuses(
        "compare s.toml --models elastic --repeats 1 --out o",
        &["needs cylindrical gears"],
    );
    for study in ["modes", "stiffness", "response"] {
        folder.refuses(
            &format!("{study} s.toml --models elastic --out o"),
            &["needs cylindrical gears"],
        );
    }
}

#[test]
fn two_driven_gears_are_refused_at_the_line() {
    let folder = Folder::new();
    let driven = "mount = { driven = { speed_rad_s = 10.0 } }";
    let text = PAIR
        .replace("speed_rad_s = 20.0\nloads = [{ torque_nm = 1.0 }]", driven)
        .replace("mount = \"revolute\"", driven);
    folder.write("s.toml", &text);
    folder.refuses(
        "compare s.toml --out o",
        &["s.toml:19", "are both driven", "give the other `loads`"],
    );
}

/// Histories have an estimate, and a way out.
#[test]
fn histories_beyond_the_memory_are_refused() {
    let folder = Folder::new();
    folder.write(
        "s.toml",
        &PAIR.replace("[study]", "[study]\nsamples = 1000000"),
    );
    folder.refuses(
        "compare s.toml --models rigid --integrators dopri5@1e-6 --repeats 1 --memory 0.5 --out o",
        &[
            "none of the models can run",
            "1000000 samples",
            "fewer `samples`",
        ],
    );
}

/// Whatever is not a regular file of a bounded size is refused at once by every reader.
#[cfg(unix)]
#[test]
fn pipes_devices_and_folders_are_no_inputs() {
    let folder = Folder::new();
    let fifo = |name: &str| {
        let made = std::process::Command::new("mkfifo")
            .arg(folder.at(name))
            .status();
        assert!(made.unwrap().success());
    };
    fifo("fifo.toml");
    folder.refuses("compare fifo.toml --out o", &["regular file"]);
    folder.refuses("check fifo.toml", &["regular file"]);
    std::os::unix::fs::symlink("/dev/zero", folder.at("zero.toml")).unwrap();
    folder.refuses("compare zero.toml --out o", &["regular file"]);
    folder.write("s.toml", PAIR);
    std::fs::create_dir(folder.at("record")).unwrap();
    fifo("record/results.json");
    folder.refuses("report record", &["regular file"]);
    folder.refuses("rerun record", &["regular file"]);
    std::fs::create_dir(folder.at("o")).unwrap();
    fifo("o/journal.jsonl");
    folder.refuses(
        "compare s.toml --models rigid --out o",
        &["not a regular file"],
    );
    let large = std::fs::File::create(folder.at("large.toml")).unwrap();
    large.set_len(1 << 34).unwrap();
    folder.refuses("compare large.toml --out o", &["at most 16000000 are read"]);
}
