//! `gearbench sweep SCENE`: loaded running over the speed.

use super::arguments::Sweep;
use super::pair::Pair;
use super::summary::summarise;
use super::{Plan, check, mesh_resonance, sweep};
use crate::cli::command_result::CommandResult;
use crate::cli::exit::Exit;
use crate::cli::study_folder::StudyFolder;
use crate::cli::terminal::{Refusal, refuse_study};
use crate::context::Context;
use crate::experiment::conditions::Conditions;
use crate::experiment::configuration::Configuration;
use crate::experiment::settings::settings;
use crate::scene_file::{self, ModelChoice, SceneFile, Selection};
use gearbench_integrators::table::VELOCITY_VERLET;
use gearbench_reports::Study;
use gearbench_reports::record::Results;

/// Default range of mesh frequencies over that of the resonance [-].
const AROUND: [f64; 2] = [0.06, 1.5];

/// Runs the sweep of one or several scenes and writes its folder.
pub fn run(context: &Context, args: &Sweep, command: &str) -> Result<CommandResult, Refusal> {
    if let (Some(from), Some(to)) = (args.from, args.to)
        && from >= to
    {
        return Err(Refusal::Input(miette::miette!(
            help = "give the lower mesh frequency with --from",
            "the sweep from {from} to {to} Hz is empty"
        )));
    }
    let names = std::iter::once(&args.scene).chain(&args.further);
    let prepared: Vec<(SceneFile, Plan)> = names
        .map(|name| prepare(context, name, args, command))
        .collect::<Result<_, _>>()?;
    let scenes: Vec<&SceneFile> = prepared.iter().map(|(scene, _)| scene).collect();
    let mut folder = StudyFolder::of_scenes(&args.run.output, &scenes, Study::Sweep.as_str())?;
    let count = prepared.iter().map(|(_, plan)| plan.count()).sum();
    let made = folder.run(count, |runner| {
        let records = (prepared.iter())
            .map(|(scene, plan)| sweep(plan, runner).map_err(|e| refuse_study(scene, e)));
        Ok(Results::joined(records.collect::<Result<Vec<_>, _>>()?))
    });
    folder.finish(
        made.map_err(|e| folder.refuse(e))?.unwrap_or_default(),
        Exit::of_every_run,
        summarise,
    )
}

/// Reads a scene and plans its sweep.
fn prepare(
    context: &Context,
    name: &str,
    args: &Sweep,
    command: &str,
) -> Result<(SceneFile, Plan), Refusal> {
    let unbuilt = scene_file::load_for(context, name, Selection::None)?;
    check(&unbuilt.name, &unbuilt.spec).map_err(|e| refuse_study(&unbuilt, e))?;
    let scene = scene_file::load_for(context, name, Selection::Labels(args.models.as_deref()))?;
    let choices = scene.select(args.models.as_deref())?;
    // Full finite elements run far too long; they serve for the static limit only.
    let full = |m: &ModelChoice| unbuilt.properties_of(&m.model).full_order;
    let mut standing: Vec<&ModelChoice> = choices.iter().copied().filter(|m| full(m)).collect();
    if args.models.is_none() {
        let more = scene.models.iter().filter(|m| full(m));
        standing.extend(more.filter(|m| !choices.iter().any(|c| c.label == m.label)));
    }
    let running: Vec<&ModelChoice> = choices.into_iter().filter(|m| !full(m)).collect();
    let entry = |c: &&ModelChoice| Configuration::of(&scene, c);
    let told = &scene.study.sweep;
    let mut shown = running.clone();
    shown.extend(&standing);
    let mut plan = Plan {
        conditions: Conditions {
            command: command.to_string(),
            settings: settings(&scene, &shown, false),
            events: true,
            repeats: 0,
            timeout: args.run.timeout(),
            ..Conditions::of(&scene)
        },
        entries: running.iter().map(entry).collect(),
        standing: standing.iter().map(entry).collect(),
        method: (scene.study.integrators.first().cloned()).unwrap_or(VELOCITY_VERLET.at_step(2e-7)),
        frequencies: Vec::new(),
        branches: match &args.branches {
            Some(asked) => {
                let mut branches = asked.clone();
                branches.dedup();
                branches
            }
            None => told.branches().to_vec(),
        },
        cycles: match (args.cycles, args.turns.map(|n| n as usize).or(told.turns())) {
            (Some(cycles), _) => cycles as usize,
            (None, Some(turns)) => Pair::cycles_of(&scene.spec, turns),
            (None, None) => told.cycles(),
        },
        settle: told.settle(),
        positions: args.positions,
    };
    let range = match (args.from, args.to, told.range()) {
        (Some(from), Some(to), _) => [from, to],
        (_, _, Some(range)) => range,
        _ => {
            // A model without an equilibrium is refused by the study itself.
            let mut entries = plan.entries.iter().chain(&plan.standing);
            let found = entries.find_map(|e| mesh_resonance(&plan, e).ok());
            let f = found.flatten().unwrap_or(1000.0);
            AROUND.map(|x| x * f)
        }
    };
    let points = args.points.map_or(told.points(), |n| n as usize).max(2);
    plan.frequencies = (0..points)
        .map(|i| range[0] + (range[1] - range[0]) * i as f64 / (points - 1) as f64)
        .collect();
    Ok((scene, plan))
}
