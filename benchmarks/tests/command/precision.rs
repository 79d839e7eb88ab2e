//! `gearbench precision`.

use super::{Folder, gearbench, stderr};
use gearbench_reports::{Metric, Part, Study};

#[test]
fn precision_writes_its_table_and_takes_failures_as_data() {
    let folder = Folder::new();
    let arguments = [
        "precision",
        "spur_impact",
        "--models",
        "rigid-iso6336",
        "--integrators",
        "velocity-verlet@100us,rk4@1us,dopri5@1e-4",
        "--metric",
        "force-aligned,peak",
        "--out",
        "here",
    ];
    let out = gearbench(folder.path(), &arguments);
    // A step that fails is a point of the study, not a failure of the command.
    assert_eq!(out.status.code(), Some(0), "{}", stderr(&out));
    let record = gearbench_reports::load_results(&folder.at("here")).unwrap();
    assert_eq!((record.study(), record.runs.len()), (Study::Precision, 3));
    let Part::Precision(part) = &record.part else {
        panic!("{}", record.study())
    };
    assert_eq!(part.metrics, [Metric::ForceL2Aligned, Metric::PeakForceRel]);
    assert!(
        record.runs[0].status.is_failure(),
        "{:?}",
        record.runs[0].status
    );
    assert_eq!(record.runs[1].step, Some(1e-6));
    let table = std::fs::read_to_string(folder.at("here/precision.csv")).unwrap();
    // Two references each, CalculiX and the model's own converged solution; a run that failed has no errors.
    assert_eq!(table.lines().count(), 1 + 1 + 2 * 2, "{table}");
    assert!(folder.at("here/precision_model.svg").exists());
    let said = String::from_utf8_lossy(&out.stdout);
    assert!(said.contains("Pareto front against calculix"), "{said}");

    for (wrong, expected) in [
        (["rigid", "--metric", "farce"], "there is no metric `farce`"),
        (["rigid", "--against", "abaqus"], "`abaqus` is no reference"),
        (["rigid", "--integrators", "bdf@1us"], "chooses its steps"),
        (["rigd", "--metric", "peak"], "did you mean `rigid`"),
    ] {
        let all = [
            "precision",
            "spur_impact",
            "--out",
            "there",
            "--models",
            wrong[0],
            wrong[1],
            wrong[2],
        ];
        let out = gearbench(folder.path(), &all);
        assert_eq!(out.status.code(), Some(2), "{wrong:?}");
        assert!(stderr(&out).contains(expected), "{}", stderr(&out));
        assert!(!folder.at("there").exists());
    }
}
