//! Tests of the command `gearbench precision`.

use super::{Folder, has};
use gearbench_reports::record::Run;
use gearbench_reports::{Part, Study};

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
    assert_eq!((record.study(), record.runs.len()), (Study::Tabular, 3));
    let Part::Tabular(part) = &record.part else {
        panic!("{}", record.study())
    };
    // The metrics of the command line are those of the page.
    let shown = |key: &str| {
        part.columns
            .iter()
            .any(|c| c.key == key && !c.heading.is_empty())
    };
    assert!(shown("force_l2_aligned") && shown("peak_force_rel") && !shown("impulse_rel"));
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

/// A run has the error of its model, which stays, and that of its integration, which falls with the step.
#[test]
fn every_resolution_is_a_row_with_both_errors() {
    let folder = Folder::new();
    folder.says(
        "precision spur_impact --models rigid,rigid-iso6336 --integrators velocity-verlet,dopri5,rk4@1us \
         --steps 1e-4,2e-6,5e-7 --rtols 1e-3,1e-6 --repeats 1 --out p",
    );
    let results = gearbench_reports::load_results(&folder.at("p")).unwrap();
    assert_eq!(results.runs.len(), 2 * (3 + 2 + 1));
    assert_eq!(results.references[0].id, "calculix");
    let of = |variant: Option<&str>, integrator: &str| -> Vec<&Run> {
        let mine = |r: &&Run| r.variant.as_deref() == variant && r.integrator == integrator;
        results.runs.iter().filter(mine).collect()
    };
    for variant in [None, Some("iso6336")] {
        // Only the fitted model states the data of its fit.
        let fitted = variant.is_none().then(|| "calculix".to_owned());
        let verlet = of(variant, "velocity-verlet");
        assert!(verlet.iter().all(|r| r.fitted_to == fitted));
        let steps: Vec<_> = verlet.iter().map(|r| r.step.unwrap()).collect();
        assert_eq!(steps, [1e-4, 2e-6, 5e-7]);
        // The integration error falls with the square of the step, the model's error stays.
        let error = |r: &Run, id: &str| r.against(id).and_then(|m| m.force_l2).unwrap();
        let ratio = error(verlet[1], "self") / error(verlet[2], "self");
        assert!((8.0..32.0).contains(&ratio), "{ratio}");
        let (coarse, fine) = (error(verlet[1], "calculix"), error(verlet[2], "calculix"));
        assert!((coarse - fine).abs() < 0.05 * fine, "{coarse} {fine}");
        assert!(error(verlet[2], "self") < 0.01 * fine);
        assert!(error(of(variant, "dopri5")[1], "self") < 1e-4);
    }
    let own = |r: &Run| r.against("calculix").and_then(|m| m.force_l2_aligned);
    let errors = [None, Some("iso6336")].map(|v| own(of(v, "dopri5")[1]).unwrap());
    assert!(errors[0] < 0.06 && errors[1] > errors[0], "{errors:?}");
    // Without histories, and short runs are timed more often than asked for.
    let bare = |r: &Run| r.series.is_none() && r.contacts.is_none();
    assert!(results.runs.iter().all(bare));
    assert!(of(None, "dopri5").iter().all(|r| r.repeats > 2));
}
