//! Tests of the command `gearbench precision`.

use super::{Folder, has};
use gearbench_reports::{Metric, Part, Study};

#[test]
fn precision_writes_its_table_and_takes_failures_as_data() {
    let folder = Folder::new();
    let models = "precision spur_impact --models rigid-iso6336";
    let methods = "--integrators velocity-verlet@100us,rk4@1us,dopri5@1e-4";
    // A step that fails is a point of the study, not a failure of the command.
    let said = folder.says(&format!(
        "{models} {methods} --metric force-aligned,peak --out here"
    ));
    let record = gearbench_reports::load_results(&folder.at("here")).unwrap();
    assert_eq!((record.study(), record.runs.len()), (Study::Precision, 3));
    let Part::Precision(part) = &record.part else {
        panic!("{}", record.study())
    };
    assert_eq!(part.metrics, [Metric::ForceL2Aligned, Metric::PeakForceRel]);
    assert!(record.runs[0].status.is_failure());
    assert_eq!(record.runs[1].step, Some(1e-6));
    let table = folder.read("here/precision.csv");
    // Three references each, CalculiX twice and the model's own converged solution; a run that failed has no errors.
    assert_eq!(table.lines().count(), 1 + 1 + 2 * 3, "{table}");
    assert!(folder.at("here/precision_model.svg").exists());
    has(&said, &["Pareto front against calculix"]);

    for (wrong, expected) in [
        ("rigid --metric farce", "there is no metric `farce`"),
        ("rigid --against abaqus", "`abaqus` is not a reference"),
        ("rigid --integrators bdf@1us", "chooses its steps"),
        ("rigd --metric peak", "did you mean `rigid`"),
    ] {
        folder.refuses(
            &format!("precision spur_impact --out there --models {wrong}"),
            &[expected],
        );
        assert!(!folder.at("there").exists());
    }
}
