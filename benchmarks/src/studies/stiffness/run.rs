//! Static equilibria over a mesh cycle, model by model.

use super::plan::{Entry, Plan};
use crate::experiment::error::StudyError;
use crate::experiment::key::Key;
use crate::experiment::run::RunError;
use crate::experiment::runner::Runner;
use gearbench_models::gear::table::Model;
use gearbench_reference::statics::{Load, LoadedPair, MeshCycle, StaticsError};
use gearbench_reports::record::{Part, Results};
use gearbench_reports::stiffness::{
    LinePressure, ModelStiffness, PairLoad, StiffnessPosition, StiffnessRecord,
};
use std::time::Instant;

/// Runs the study, one piece of work for each model and formula.
///
/// # Errors
/// [`StudyError`]; a model without equilibria is a row with the reason. Where no model has any, the reason of the first.
pub fn study(plan: &Plan, runner: &Runner<'_>) -> Result<Results, StudyError> {
    let total = plan.positions * plan.entries.len();
    let (mut all, mut first) = (Vec::new(), None);
    for (i, (entry, force)) in plan.entries.iter().enumerate() {
        if runner.is_interrupted() {
            return Err(RunError::Interrupted.into());
        }
        let done = plan.positions * i;
        let progress = |n: usize| runner.report_progress(done + n, total, &entry.label);
        progress(0);
        let key = Key::new("stiffness")
            .and_scene(&entry.spec, &entry.modelling)
            .and(&(&entry.label, &entry.stated, force, plan.positions));
        let made = runner.piece(key, || {
            solve(
                (entry, *force),
                &plan.conditions.context.models,
                plan.positions,
                progress,
            )
            .map_err(|e| StudyError::Statics(entry.label.clone(), e))
        });
        match made {
            Ok(made) => all.push(made),
            Err(StudyError::Statics(label, e)) if !matches!(e, StaticsError::Build(_)) => {
                all.push(ModelStiffness {
                    label: label.clone(),
                    message: e.to_string(),
                    includes: entry.includes.clone(),
                    ..ModelStiffness::default()
                });
                first.get_or_insert(StudyError::Statics(label, e));
            }
            Err(e) => return Err(e),
        }
    }
    if let Some(e) = first.filter(|_| all.iter().all(|m| m.positions.is_empty())) {
        return Err(e);
    }
    let part = StiffnessRecord { stiffness: all };
    Ok(plan.conditions.record(Part::Stiffness(part)))
}

/// The mesh cycle of a model under its load.
fn solve(
    (entry, force): (&Entry, f64),
    models: &[Model],
    positions: usize,
    progress: impl FnMut(usize),
) -> Result<ModelStiffness, StaticsError> {
    let start = Instant::now();
    let mut pair = LoadedPair::new(&entry.spec, &entry.modelling, models)?;
    let setup_s = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let cycle = MeshCycle::solve(&mut pair, Load::Force(force), positions, progress)?;
    let solve_s = start.elapsed().as_secs_f64();
    let [equilibria, newton_iterations] = pair.work();
    // Of helical gears the stiffnesses of a norm are no secants of a loaded mesh.
    let [single, mesh] =
        (entry.stated).unwrap_or_else(|| [cycle.single_stiffness(), cycle.mesh_stiffness()]);
    Ok(ModelStiffness {
        label: entry.label.clone(),
        message: String::new(),
        includes: entry.includes.clone(),
        limits: entry.limits(),
        force_n: force,
        face_width_m: cycle.face_width,
        base_pitch_m: cycle.base_pitch,
        pitch_point_m: cycle.pitch_point,
        path_m: cycle.path,
        single_stiffness_n_per_m2: single,
        at_pitch_point_n_per_m2: cycle.at_pitch_point(),
        mesh_stiffness_n_per_m2: mesh,
        mesh_tangent_n_per_m2: cycle.mesh_tangent(),
        error_mean_m: cycle.mean_error(),
        error_peak_to_peak_m: cycle.peak_to_peak(),
        unknowns: pair.unknowns(),
        equilibria,
        newton_iterations,
        setup_s,
        solve_s,
        positions: equilibria_of(&cycle),
    })
}

/// The equilibria of a cycle as the record has them.
fn equilibria_of(cycle: &MeshCycle) -> Vec<StiffnessPosition> {
    let positions = cycle.positions.iter().zip(&cycle.tangent);
    positions
        .map(|(p, tangent)| StiffnessPosition {
            path_coordinate_m: p.s,
            error_m: p.approach,
            force_n: p.force,
            tangent_n_per_m: *tangent,
            pairs: (p.pairs.iter())
                .map(|pair| PairLoad {
                    offset: pair.offset,
                    force_n: pair.force,
                })
                .collect(),
            pressure: p.pressure.map(|p| LinePressure {
                half_width_m: p.half_width,
                peak_pa: p.peak,
            }),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::plan::formulas;
    use super::*;
    use crate::context::Context;
    use crate::experiment::conditions::Conditions;
    use crate::experiment::journal::{JOURNAL, Journal, Subject};
    use crate::scene_file::load_unbuilt;
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// Models that an earlier, interrupted start has finished are read from its journal, with the same numbers.
    #[test]
    fn finished_models_are_not_solved_again() {
        let scene = load_unbuilt(&Context::default(), "spur_impact").unwrap();
        let choice = scene.model("rigid-iso6336").unwrap();
        let entries = formulas(&scene.spec_for(choice), &choice.modelling);
        let mut plan = Plan {
            conditions: Conditions::of(&scene),
            entries: entries.into_iter().map(|e| (e, 3000.0)).collect(),
            positions: 4,
        };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(JOURNAL);
        let open = || Journal::open(&path, &Subject::default(), false).unwrap();
        let solved = AtomicUsize::new(0);
        let progress = |done: usize, _: usize, _: &str| {
            solved.fetch_add(usize::from(!done.is_multiple_of(4)), Ordering::Relaxed);
        };
        let run =
            |plan: &Plan| study(plan, &Runner::new(Context::default(), open(), &progress)).unwrap();
        let first = run(&plan);
        // The last position of each ends a multiple of four.
        assert_eq!((solved.load(Ordering::Relaxed), open().len()), (6, 2));
        assert_eq!(run(&plan).stiffness(), first.stiffness());
        assert_eq!(solved.load(Ordering::Relaxed), 6);
        // Under another load they are other pieces.
        plan.entries[0].1 = 2000.0;
        assert_eq!(run(&plan).stiffness()[1], first.stiffness()[1]);
        assert_eq!((solved.load(Ordering::Relaxed), open().len()), (9, 3));
    }
}
