//! Tests of the yardstick of `compare` (refined elastic gears, the most detailed model, or a named model), and of its
//! verdict, which follows from the numbers of the record.

use super::{Folder, has, stdout};
use gearbench_reports::comparison::{Kind, Yardstick};
use gearbench_reports::record::{Part, SELF, Status};
use gearbench_reports::{Adequacy, Metric, Results};

/// Returns a scene with one impact of coarse gears, whose reduction takes a fraction of a second.
fn scene(tolerance: &str) -> String {
    let gear = "module_m = 0.002\nface_width_m = 0.006\n";
    format!(
        "schema = 1\nname = \"small\"\nduration_s = 1.2e-4\n{tolerance}\n\
         [gears.a]\nteeth = 18\n{gear}bore_radius_m = 0.007\nspeed_rad_s = 20.0\n\
         [gears.b]\nteeth = 24\n{gear}bore_radius_m = 0.01\n\
         [[models]]\nmodel = \"rigid\"\ncontact = {{ stiffness = \"iso6336\" }}\n\
         [[models]]\nmodel = \"elastic\"\nparameters = {{ flank_elements = 4, fillet_elements = 2, across_elements = 6, \
         rim_elements = 2, width_elements = 1, modes = 30 }}\ncontact = {{ penalty_pa_per_m = 2e15 }}\n\
         integrators = [{{ method = \"trigonometric\", step_s = 5e-7 }}]\n\
         [[meshes]]\ngears = [\"a\", \"b\"]\nbacklash_m = 80e-6\nstart = {{ flank = \"left\", gap_m = 1e-6 }}\n\
         [study]\nintegrators = [{{ method = \"dopri5\", rtol = 1e-6 }}]\nsamples = 400\n"
    )
}

fn record(folder: &Folder, name: &str) -> (Results, Option<Yardstick>) {
    let record = gearbench_reports::load_results(&folder.at(name)).unwrap();
    let Part::Compare(part) = &record.part else {
        panic!("another study");
    };
    let yardstick = part.yardstick.clone();
    (record, yardstick)
}

/// Status of each run, exit code and finding follow from the error of the run, that of the yardstick and the tolerance; the
/// answer of `choose` on the same scene does not contradict them.
#[test]
fn models_are_judged_by_refined_gears_with_their_own_error() {
    let folder = Folder::new();
    for limit in [0.02, 0.3] {
        let tolerance = format!("tolerance = {{ metric = \"peak_force_rel\", limit = {limit} }}");
        folder.write("small.toml", &scene(&tolerance));
        let name = format!("o{limit}");
        let out = folder
            .command(&format!("compare small.toml --out {name}"))
            .output()
            .unwrap();
        let (record, yardstick) = record(&folder, &name);
        let yardstick = yardstick.unwrap();
        assert_eq!(yardstick.kind, Kind::Refined);
        let parts = [
            yardstick.integration_error,
            yardstick.modes_error,
            yardstick.mesh_error,
        ]
        .map(Option::unwrap);
        let own = yardstick.error.unwrap();
        assert!((parts.iter().sum::<f64>() - own).abs() < 1e-12, "{parts:?}");
        assert!(own < 0.15, "{parts:?}");
        let mut adequate = Vec::new();
        for run in &record.runs {
            let error = run.against(&yardstick.id).unwrap();
            let error = error.get(Metric::PeakForceRel).unwrap().abs();
            let (wanted, found) = (Adequacy::of(error, own, limit), run.status);
            let fits = match wanted {
                Adequacy::Adequate => found == Status::Converged,
                Adequacy::NotDecided => found == Status::Unchecked,
                Adequacy::NotAdequate => found == Status::Inaccurate,
            };
            assert!(fits, "{} {error} {own} {found}", run.model);
            adequate.extend((wanted == Adequacy::Adequate).then(|| run.model_label()));
        }
        let said = stdout(&out);
        has(&said, &["Models are compared with refined elastic gears"]);
        let crowned = said.contains("The cheapest run within the scene's tolerance");
        assert_eq!(crowned, !adequate.is_empty(), "{said}");
        assert_eq!(out.status.code(), Some(i32::from(adequate.is_empty())));
        let page = folder.read(&format!("{name}/index.html"));
        has(
            &page,
            &["refined elastic gears", "Integration", "Rms force"],
        );

        let name = format!("c{limit}");
        let command = format!("choose small.toml --metric peak --tolerance {limit} --out {name}");
        let _ = folder.command(&command).output().unwrap();
        let chosen = gearbench_reports::load_results(&folder.at(&name)).unwrap();
        let Part::Choose(choice) = chosen.part else {
            panic!("another study");
        };
        let levels = &choice.choice.levels;
        let Some(level) = levels.iter().find(|l| l.name == "rigid, own `rigid`") else {
            panic!("{:?}", levels.iter().map(|l| &l.name).collect::<Vec<_>>());
        };
        let rigid = |r: &gearbench_reports::Run| r.model_label() == "rigid";
        let contradicts = match level.adequate {
            Adequacy::Adequate => {
                (record.runs.iter()).any(|r| rigid(r) && r.status == Status::Inaccurate)
            }
            Adequacy::NotAdequate => adequate.iter().any(|m| m == "rigid"),
            Adequacy::NotDecided => false,
        };
        assert!(!contradicts, "{:?}, {adequate:?}", level.adequate);
    }
}

/// Without a tolerance the most detailed model is the yardstick, and nothing is called adequate; a tolerance against `self`
/// is one of integration.
#[test]
fn without_a_tolerance_of_models_nothing_is_adequate() {
    let folder = Folder::new();
    let own = "tolerance = { metric = \"force_l1\", limit = 0.05, against = \"self\" }";
    for (tolerance, words) in [("", "has no `tolerance`"), (own, "one of integration")] {
        folder.write("small.toml", &scene(tolerance));
        let said = folder.says("compare small.toml --out o --fresh");
        has(
            &said,
            &["elastic, the most detailed model of the scene", words],
        );
        assert!(!said.contains("The cheapest run"), "{said}");
        let (record, yardstick) = record(&folder, "o");
        let yardstick = yardstick.unwrap();
        assert_eq!((yardstick.kind, yardstick.error), (Kind::Model, None));
        // Rigid gears have an error of the model and one of integration, of different sizes.
        let rigid = record.runs.iter().find(|r| r.model == "rigid").unwrap();
        let error = |id: &str| rigid.against(id).unwrap().force_l1.unwrap();
        assert!(error("elastic") > 100.0 * error(SELF), "{said}");
    }
}

/// `--yardstick` names a model, which then counts as exact, and a tolerance of models follows it.
#[test]
fn a_model_can_be_named_as_the_yardstick() {
    let folder = Folder::new();
    folder.write("small.toml", &scene("tolerance = 0.9"));
    let said = folder.says("compare small.toml --models rigid --yardstick elastic --out o");
    has(
        &said,
        &["the model that was named for it", "taken as exact"],
    );
    let (record, yardstick) = record(&folder, "o");
    assert_eq!(yardstick.unwrap().kind, Kind::Named);
    assert_eq!(record.tolerance.unwrap().against, "elastic");
    assert!(record.runs.iter().any(|r| r.model == "elastic"));
    folder.refuses("compare small.toml --yardstick elstic", &["elstic"]);
}
