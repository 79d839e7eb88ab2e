//! `gearbench penalty SCENE`: results over the penalty of the contact.

use super::arguments::Penalty;
use super::run::TAKE_POINTS;
use super::summary::summarise;
use super::{Plan, study};
use crate::cli::command_result::CommandResult;
use crate::cli::exit::Exit;
use crate::cli::study_folder::StudyFolder;
use crate::cli::terminal::{Refusal, refuse_study};
use crate::context::Context;
use crate::experiment::conditions::Conditions;
use crate::experiment::configuration::Configuration;
use crate::experiment::settings::settings;
use crate::scene_file::{self, ModelChoice, SceneError};
use gearbench_integrators::table::VELOCITY_VERLET;
use gearbench_models::spec::{ContactSpec, mesh_layout};
use gearbench_reports::Study;
use gearbench_reports::numbers::{round_quantity, short};

/// Runs the study and writes its folder.
pub fn run(context: &Context, args: &Penalty, command: &str) -> Result<CommandResult, Refusal> {
    let scene = scene_file::load(context, &args.scene)?;
    let twin = |m: &&ModelChoice| scene.model(&format!("{}-hard", m.label)).is_some();
    let soft = |c: &ContactSpec| c.points.is_some_and(|p| p.has_penalty());
    let penalty = |m: &&ModelChoice| m.modelling.contacts.iter().any(soft);
    let found = (scene.models.iter().find(twin)).or_else(|| scene.models.iter().find(penalty));
    let choice = match (&args.model, found) {
        (Some(label), _) => scene.select(Some(label))?[0],
        (None, Some(found)) => found,
        (None, None) => {
            let why = format!("no model of the scene `{}` has a penalty", scene.name);
            return Err(SceneError::plain(why, TAKE_POINTS).into());
        }
    };
    let hard: Option<&ModelChoice> = match &args.hard {
        Some(label) => Some(scene.select(Some(label))?[0]),
        None => scene.model(&format!("{}-hard", choice.label)),
    };
    if args.to <= args.from {
        return Err(Refusal::Input(miette::miette!(
            help = "give the softer penalty with --from",
            "the penalties from {:e} to {:e} Pa/m do not increase",
            args.from,
            args.to
        )));
    }
    let points = args.points as usize;
    let ratio = (args.to / args.from).ln() / (points - 1) as f64;
    let gears = &scene.spec.gears;
    // Static equilibria are those of one mesh of two gears.
    let load = match scene.spec.meshes.as_slice() {
        [mesh] if gears.len() == 2 => {
            let [a, b] = mesh.gears;
            let layout = mesh_layout(&gears[a], &gears[b]);
            layout.ok().map(|l| 1e3 * args.load * l.face_width)
        }
        _ => None,
    };
    let mut told = settings(&scene, &[choice], false);
    if let Some(force) = load {
        told.push((
            "static load".into(),
            format!(
                "{} along the line of action in the transverse plane, {} N/mm",
                round_quantity(force, "N", 4),
                short(args.load, 4)
            ),
        ));
    }
    let plan = Plan {
        conditions: Conditions {
            command: command.to_string(),
            settings: told,
            events: true,
            timeout: args.run.timeout(),
            ..Conditions::of(&scene)
        },
        entry: Configuration::of(&scene, choice),
        hard: hard.map(|c| Configuration::of(&scene, c)),
        method: scene
            .study
            .integrators
            .first()
            .cloned()
            .unwrap_or(VELOCITY_VERLET.at_step(1e-7)),
        penalties: (0..points)
            .map(|i| args.from * (ratio * i as f64).exp())
            .collect(),
        load,
        positions: args.positions,
    };
    let mut folder = StudyFolder::of(&args.run.output, &scene, Study::Penalty.as_str())?;
    let made = folder.run(plan.penalties.len(), |runner| study(&plan, runner));
    folder.finish(
        made.map_err(|e| folder.refuse(refuse_study(&scene, e)))?,
        Exit::of_every_run,
        summarise,
    )
}
