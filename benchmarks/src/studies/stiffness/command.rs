//! `gearbench stiffness SCENE`: static mesh stiffness, load sharing and transmission error of its models.

use super::arguments::Stiffness;
use super::plan::{Entry, Plan, formulas, includes};
use super::run::study;
use super::summary::summarise;
use crate::cli::command_result::CommandResult;
use crate::cli::exit::Exit;
use crate::cli::study_folder::StudyFolder;
use crate::cli::terminal::{Refusal, refuse_study};
use crate::cli::values::DEFAULT_LOAD;
use crate::context::Context;
use crate::experiment::conditions::Conditions;
use crate::experiment::settings::settings;
use crate::scene_file::{self, Selection};
use gearbench_models::scene::Scene;
use gearbench_models::spec::{Load, base_radius, initial_speed, signed_base_radius};
use gearbench_reports::Study;
use gearbench_reports::numbers::{round_quantity, short};
use gearbench_reports::record::Results;

/// Name of the setting with the static load.
pub(super) const STATIC_LOAD: &str = "static load";

/// Loads the models of a scene over a mesh cycle and writes a folder.
pub fn run(context: &Context, args: &Stiffness, command: &str) -> Result<CommandResult, Refusal> {
    let scene = scene_file::load_for(
        context,
        &args.scene,
        Selection::Labels(args.models.as_deref()),
    )?;
    let choices = scene.select(args.models.as_deref())?;
    let mut entries: Vec<Entry> = choices
        .iter()
        .map(|c| Entry {
            label: c.label.clone(),
            includes: includes(&c.modelling, &context.models),
            spec: scene.spec_for(c),
            modelling: c.modelling.clone(),
            stated: None,
        })
        .collect();
    let first = &entries[0];
    if first.spec.gears.len() != 2 || first.spec.meshes.len() != 1 {
        return Err(Refusal::Input(miette::miette!(
            help = "use a scene with one mesh of two gears",
            "the scene `{}` has {} gears and {} meshes",
            scene.name,
            first.spec.gears.len(),
            first.spec.meshes.len()
        )));
    }
    entries.extend(formulas(&first.spec, &first.modelling));
    let mut told = settings(&scene, &choices, false);
    told.retain(|(what, _)| what != "simulated time");
    // The formulas replace rigid gears of the same scene.
    let own = entries.last().and_then(|rigid| own_force(context, rigid));
    let loads: Result<Vec<StaticLoad>, Refusal> = entries
        .iter()
        .map(|e| StaticLoad::of(args, e, own))
        .collect();
    let loads = loads?;
    told.push((STATIC_LOAD.into(), loads[0].to_text()));
    let plan = Plan {
        conditions: Conditions {
            command: command.to_string(),
            settings: told,
            ..Conditions::of(&scene)
        },
        entries: entries
            .into_iter()
            .zip(loads.iter().map(|l| l.force))
            .collect(),
        positions: args.positions,
    };
    let mut folder = StudyFolder::of(&args.output, &scene, Study::Stiffness.as_str())?;
    let total = plan.positions * plan.entries.len();
    let made = folder.run(total, |runner| study(&plan, runner));
    let results = made.map_err(|e| folder.refuse(refuse_study(&scene, e)))?;
    folder.finish(results, ended, summarise)
}

/// A model without equilibria could not be solved.
fn ended(results: &Results) -> Exit {
    match results.stiffness().iter().any(|m| m.positions.is_empty()) {
        true => Exit::FailedRun,
        false => Exit::Done,
    }
}

/// Computes the contact force in the transverse plane under the loads of the scene [N]; `None` where they do not load
/// the flank of the start.
///
/// Loads are those at the end of their ramps. Between gears that the loads accelerate the force is that of rigid gears:
///
/// ```text
/// F = (F_1/m_1 + F_2/m_2) / (1/m_1 + 1/m_2),    F_i = T_i / r_bi,    m_i = I_i / r_bi^2,  infinite where the hub is held
/// ```
fn own_force(context: &Context, rigid: &Entry) -> Option<f64> {
    let built = Scene::build(&rigid.spec, &rigid.modelling, &context.models).ok()?;
    let mesh = &rigid.spec.meshes[0];
    let sign = mesh.start.side.sign();
    let (mut sum, mut inverse) = (0.0, 0.0);
    for i in mesh.gears {
        let gear = &rigid.spec.gears[i];
        let radius = signed_base_radius(&gear.body);
        let torque: f64 = (rigid.spec.loads_at(i))
            .map(|load| match load {
                Load::Applied(profile) => profile.settled(),
                Load::Viscous(c) => -c * initial_speed(&gear.mount, gear.speed),
            })
            .sum();
        let hub = &built.gears()[i].model.hub().hub;
        if hub.is_free() {
            sum += sign * torque / radius * radius.powi(2) / hub.inertia;
            inverse += radius.powi(2) / hub.inertia;
        }
    }
    Some(sum / inverse).filter(|force| *force > 0.0 && force.is_finite())
}

/// The static load of a model.
struct StaticLoad {
    /// Force along the line of action in the transverse plane [N].
    force: f64,
    /// Common face width [m].
    face_width: f64,
    /// Origin of the force in words.
    origin: &'static str,
}

impl StaticLoad {
    /// Returns the load of the command line, else `own`, that of the scene, else the default.
    ///
    /// # Errors
    /// [`Refusal::Failed`] where the gears do not mesh.
    fn of(args: &Stiffness, entry: &Entry, own: Option<f64>) -> Result<Self, Refusal> {
        let gears = &entry.spec.gears;
        let [a, b] = entry.spec.meshes[0].gears;
        let layout = gearbench_models::spec::mesh_layout(&gears[a], &gears[b])
            .map_err(|e| Refusal::Failed(e.to_string()))?;
        let face_width = layout.face_width;
        let over_width = |load: f64| 1e3 * load * face_width;
        let (force, origin) = match (args.torque, args.load, own) {
            (Some(torque), ..) => (torque.abs() / base_radius(&gears[a].body), "from --torque"),
            (None, Some(load), _) => (over_width(load), "from --load"),
            (None, None, Some(force)) => (force, "from the loads of the scene"),
            (None, None, None) => (over_width(DEFAULT_LOAD), "the default"),
        };
        Ok(StaticLoad {
            force,
            face_width,
            origin,
        })
    }

    /// The load in words, for the settings of the record.
    fn to_text(&self) -> String {
        format!(
            "{} along the line of action in the transverse plane, {} N/mm, {}",
            round_quantity(self.force, "N", 4),
            short(1e-3 * self.force / self.face_width, 4),
            self.origin
        )
    }
}
