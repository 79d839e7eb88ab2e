//! Tests of the study of stability on rigid gears: labels, threads, limits.

use super::study;
use crate::context::Context;
use crate::experiment::conditions::Conditions;
use crate::experiment::conditions::silent;
use crate::experiment::configuration::Configuration;
use crate::experiment::journal::{JOURNAL, Journal, Subject};
use crate::experiment::runner::Runner;
use crate::scene_file::{Selection, load_for};
use crate::studies::stability::axis::Axis;
use crate::studies::stability::cell::tolerance;
use crate::studies::stability::plan::{MapPlan, Plan, PlannedAxis};
use crate::studies::stability::setup::Setup;
use gearbench_integrators::MethodSpec;
use gearbench_integrators::table::{NEWMARK, VELOCITY_VERLET};
use gearbench_models::gear::parameters::ModelParameters;
use gearbench_models::spec::Body;
use gearbench_models::stiffness::Material;
use gearbench_reference::gear_mesh::{self, GearMeshParams};
use gearbench_reference::reduction::store::{Meta, write};
use gearbench_reference::reduction::{ElasticParameters, ModeSelection, Mounting, Request};
use gearbench_reports::record::{Results, Status};
use gearbench_reports::stability::Columns;

/// Returns a plan for rigid gears in an impact under some methods, with steps from ones that exceed the bound on their
/// number to unstable ones.
fn plan(methods: &[MethodSpec]) -> Plan {
    let scene = load_for(
        &Context::default(),
        "spur_impact",
        Selection::Labels(Some("rigid")),
    )
    .unwrap();
    let choice = scene.model("rigid").unwrap();
    let entry = Configuration::of(&scene, choice);
    let map = |method: MethodSpec| {
        let setup = Setup {
            scene: entry.scene.clone(),
            modelling: entry.modelling.clone(),
            method,
        };
        MapPlan {
            set: 0,
            entry: 0,
            method,
            implicit: method.info().implicit,
            columns: Columns::Step,
            at: crate::experiment::conditions::logarithmic(5e-7, 1.5e-4, 8),
            axes: vec![
                PlannedAxis::new(Axis::ContactStiffness, &[0.1, 0.99, 10.0], &setup).unwrap(),
            ],
            duration: scene.duration,
            max_steps: 200,
        }
    };
    Plan {
        conditions: Conditions {
            command: "gearbench".into(),
            samples: 200,
            events: true,
            ..Conditions::of(&scene)
        },
        maps: methods.iter().map(|m| map(*m)).collect(),
        entries: vec![entry.clone()],
        tolerance: tolerance(scene.tolerance.as_ref()),
        refine: true,
    }
}

fn run(plan: &Plan, threads: usize) -> Results {
    let (results, timings) = study(plan, &Runner::default(), threads).unwrap();
    let runs: usize = (results.maps().iter())
        .map(|m| m.cells.len() + m.refined.len())
        .sum();
    assert_eq!(timings.len(), runs, "every run has its time");
    results
}

#[test]
fn every_cell_has_a_label_whatever_the_threads() {
    let plan = plan(&[VELOCITY_VERLET, NEWMARK]);
    let results = run(&plan, 1);
    results.validate().unwrap();
    assert_eq!(results.maps(), run(&plan, 3).maps());
    for map in results.maps() {
        // The value next to the scene's own is the scene's own.
        assert_eq!(map.axes[0].values, [0.1, 1.0, 10.0]);
        assert_eq!(map.cells.len(), 24);
        assert!(
            map.references.iter().all(|r| r.checked.is_some()),
            "{map:?}"
        );
        for cell in &map.cells {
            assert!(
                cell.status == Status::Converged || cell.message.is_some(),
                "{cell:?}"
            );
        }
        // The smallest step takes more steps than are allowed, whatever the machine.
        assert_eq!(map.cells[0].status, Status::Timeout, "{:?}", map.cells[0]);
        assert!(map.counts()[0] > 3, "{:?}", map.counts());
    }
    let [verlet, newmark] = results.maps() else {
        panic!("{} maps", results.maps().len())
    };
    // One spring and two masses: omega h = 2. The run is called lost before, where its energy swings by 2 %: from
    // about a sixth of the limit on.
    let limit = verlet.limit().unwrap();
    let ratio = verlet.ratio().unwrap();
    assert!((0.1..1.1).contains(&ratio), "{limit:?}, {ratio}");
    let (a, b) = (limit.stable_s.unwrap(), limit.unstable_s.unwrap());
    assert!(b / a <= gearbench_reports::stability::BRACKET);
    assert!(!verlet.refined.is_empty());
    assert_eq!(newmark.limit().unwrap().unstable_s, None);
    assert!(newmark.theory(newmark.own_row()).is_none());
}

/// Ten times the stiffness brings the limit in by the root of ten, in theory and in the map.
#[test]
fn the_limit_goes_with_the_root_of_the_stiffness() {
    let mut plan = plan(&[VELOCITY_VERLET]);
    plan.refine = false;
    let results = run(&plan, 2);
    let map = &results.maps()[0];
    let [soft, own, stiff] = [0, 1, 2].map(|row| map.theory(row).unwrap().0);
    assert!(
        (soft / own / 10_f64.sqrt() - 1.0).abs() < 1e-3,
        "{soft} {own}"
    );
    assert!(
        (own / stiff / 10_f64.sqrt() - 1.0).abs() < 1e-3,
        "{own} {stiff}"
    );
    for row in 0..3 {
        let theory = map.theory(row).unwrap().0;
        for c in map.row(row).iter().filter(|c| c.at > 1.6 * theory) {
            assert!(c.status != Status::Converged, "{c:?} beyond {theory}");
        }
    }
}

/// A study that was interrupted after any line resumes to the same maps, and keeps the wall times of finished runs;
/// another plan reuses the runs that both have in common.
#[test]
fn a_study_that_was_cut_off_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(JOURNAL);
    let go = |plan: &Plan| {
        let journal = Journal::open(&path, &Subject::default(), false).unwrap();
        let before = journal.len();
        let made = study(plan, &Runner::new(Context::default(), journal, &silent), 2).unwrap();
        (
            made,
            before,
            Journal::open(&path, &Subject::default(), false)
                .unwrap()
                .len(),
        )
    };
    let first = plan(&[VELOCITY_VERLET]);
    let ((whole, times), none, all) = go(&first);
    assert_eq!(
        (none, all),
        (0, 4 + times.len()),
        "three converged solutions and the mesh mode"
    );
    let text = std::fs::read_to_string(&path).unwrap();
    for cut in [1, 4, all / 2, all] {
        let lines: String = text.split_inclusive('\n').take(1 + cut).collect();
        std::fs::write(&path, lines).unwrap();
        let ((resumed, again), before, after) = go(&first);
        assert_eq!((before, after), (cut, all));
        assert_eq!(resumed.maps(), whole.maps());
        let same = times.iter().zip(&again).filter(|(a, b)| a == b).count();
        assert!(same + 4 >= cut, "{same} of {cut} times are those of before");
    }
    let (_, before, after) = go(&plan(&[VELOCITY_VERLET, NEWMARK]));
    assert_eq!(before, all);
    assert!(after >= all + 24 && after < 2 * all, "{after}");
    let mut other = plan(&[VELOCITY_VERLET]);
    other.maps[0].at[3] *= 1.0 + 1e-15;
    let (_, before, more) = go(&other);
    assert!(before == after && more > before, "one column is another");
}

/// A stored reduction keeps all its modes by default: the scene's own value is that number, and a cell with another
/// number runs with that.
#[test]
fn modes_of_a_stored_reduction_are_its_own() {
    let scene = load_for(&Context::default(), "spur_impact", Selection::None).unwrap();
    let Body::Gear(gear) = &scene.spec.gears[0].body else {
        panic!("the pinion is a gear");
    };
    let mut params = GearMeshParams {
        width: 1,
        rim: 1,
        ..GearMeshParams::default()
    };
    (params.tooth.flank, params.tooth.fillet, params.tooth.across) = (3, 2, 4);
    let request = Request {
        along_profile: false,
        foreign: None,
        mesh: &gear_mesh::sector(gear, &params).unwrap(),
        sector: true,
        material: Material::STEEL,
        mounting: Mounting::gear(true, 0.0),
        wanted: ModeSelection::Count(7),
    };
    let basis = request.compute().unwrap();
    let stored = basis.omega.len();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pinion.npz");
    write(&path, &basis, &Meta::new(&request, "a test")).unwrap();
    let elastic = ElasticParameters {
        reduction: Some(path.to_string_lossy().into_owned()),
        ..ElasticParameters::default()
    };
    let mut modelling = scene.model("rigid").unwrap().modelling.clone();
    modelling.gears.fill(elastic.spec());
    let mut setup = Setup {
        scene: scene.spec.clone(),
        modelling,
        method: VELOCITY_VERLET,
    };
    assert_eq!(Axis::Modes.own(&setup).unwrap(), stored as f64);
    Axis::Modes.apply(100.0, &mut setup).unwrap();
    let asked = ElasticParameters::of(&setup.modelling.gears[0]).unwrap();
    assert_eq!(asked.modes, Some(100));
}
