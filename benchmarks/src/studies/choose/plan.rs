//! Candidates for a scene: levels of the model hierarchy, each under several integrators and steps.
//!
//! Steps are halves of halves of the contact time `T = pi sqrt(m/k)` of rigid gears with the stiffness of the norm, so
//! that candidates of small and large gears resolve a contact alike.

use super::damping::MeshModeDamping;
use super::detail::Details;
use super::level::{Level, Stiffness};
use super::problem::{ElasticSettings, ModelWithConstants, Problem};
use super::run::ChooseError;
use super::statics::{self, MeshOscillator, StaticPairStiffness, calibrate};
use gearbench_integrators::Resolution;
use gearbench_integrators::table::{
    DOPRI5, RK4, SEMI_IMPLICIT_EULER, TRIGONOMETRIC, VELOCITY_VERLET,
};
use gearbench_integrators::{MethodSpec, Scheme};
use gearbench_models::error::BuildError;
use gearbench_models::gear::parameters::ModelParameters;
use gearbench_models::law::Damping;
use gearbench_models::spec::{Modelling, SceneSpec};
use gearbench_reference::full_order::FullOrderParameters;
use gearbench_reference::reduction::ElasticParameters;
use gearbench_reports::numbers::round_quantity;
use std::sync::Arc;

/// Numbers of modes per gear of the elastic levels.
pub const MODES: [usize; 9] = [10, 20, 35, 50, 75, 100, 150, 200, 300];
/// Steps per period of a tooth's first frequency of runs whose own error must not show.
const TOOTH_STEPS: f64 = 30.0;
/// Number of modes per gear of the densest elastic model, which is above the hierarchy.
pub const DENSEST: usize = 300;
/// Steps per contact time of the densest elastic model.
const DENSEST_STEPS: f64 = 1024.0;
/// Force for which the relaxation time of dampers is computed, over the largest force.
const MEAN_FORCE: f64 = 0.7;
/// Steps per contact time that carry the modes of an elastic run under a tolerance.
const TOLERANCE_STEPS: f64 = 128.0;

/// Combination of model, resolution, integrator and step that can be run.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// Level of the model hierarchy.
    pub level: Level,
    /// Gears and meshes of the candidate; a model of the scene may start with a gap of its own.
    pub scene: Arc<SceneSpec>,
    /// Gear models and contacts of the candidate.
    pub modelling: Arc<Modelling>,
    /// Integrator with its step or tolerance.
    pub method: Scheme,
}

impl Candidate {
    /// Returns the name of the candidate for tables: level, integrator, step or tolerance.
    pub fn name(&self) -> String {
        let resolution = match self.method.resolution {
            Resolution::Step(h) => round_quantity(h, "s", 4),
            Resolution::Tolerance(r) => format!("rtol {r:.0e}"),
        };
        format!("{}, {} {resolution}", self.level.name(), self.method.method)
    }
}

/// Integrators of a level: steps per contact time, and tolerances.
struct IntegratorOptions {
    method: MethodSpec,
    steps: &'static [f64],
    tolerances: &'static [f64],
}

const fn at_steps(method: MethodSpec, steps: &'static [f64]) -> IntegratorOptions {
    IntegratorOptions {
        method,
        steps,
        tolerances: &[],
    }
}

const RIGID: [IntegratorOptions; 5] = [
    at_steps(SEMI_IMPLICIT_EULER, &[16.0, 32.0, 64.0, 128.0, 256.0]),
    at_steps(VELOCITY_VERLET, &[8.0, 16.0, 32.0, 64.0, 128.0]),
    at_steps(RK4, &[4.0, 8.0, 16.0, 32.0]),
    IntegratorOptions {
        method: DOPRI5,
        steps: &[],
        tolerances: &[1e-2, 1e-3, 1e-4],
    },
    at_steps(TRIGONOMETRIC, &[8.0, 16.0, 32.0, 64.0, 128.0]),
];
/// Range of [`RIGID`] with the integrators for movable teeth, which need no modal oscillators.
const TEETH: std::ops::Range<usize> = 1..4;
const ELASTIC: IntegratorOptions =
    at_steps(TRIGONOMETRIC, &[8.0, 16.0, 32.0, 64.0, 128.0, 256.0, 512.0]);

impl IntegratorOptions {
    /// Returns the integrators with their steps or tolerances, the cheapest first.
    fn methods(&self, contact_time: f64) -> impl Iterator<Item = Scheme> + '_ {
        let steps = (self.steps.iter()).map(move |n| Resolution::Step(short(contact_time / n)));
        let tolerances = self.tolerances.iter().map(|r| Resolution::Tolerance(*r));
        steps.chain(tolerances).map(|r| self.method.at(r))
    }
}

/// Three digits, as people would write a step.
fn short(x: f64) -> f64 {
    let digits = 10f64.powf(2.0 - x.log10().floor());
    (x * digits).round() / digits
}

/// Returns full finite elements on the meshes of elastic gears, with their contact and the damping proportional to their
/// stiffness; other damping of their modes is left out.
pub fn full(flexible: &ElasticSettings) -> Modelling {
    let gears = (flexible.gears.iter())
        .map(|p| {
            FullOrderParameters {
                mass: None,
                rayleigh: p.rayleigh.map(|[_, beta]| [0.0, beta]),
                mesh: p.mesh.clone(),
            }
            .spec()
        })
        .collect();
    Modelling {
        gears,
        contacts: flexible.contacts.clone(),
    }
}

/// Returns elastic gears with a number of modes, for a fixed step [s] or for a tolerance.
pub fn elastic(flexible: &ElasticSettings, modes: usize, step: Option<f64>) -> Modelling {
    let gears = (flexible.gears.iter())
        .map(|p| {
            ElasticParameters {
                modes: Some(modes),
                step_s: step,
                ..p.clone()
            }
            .spec()
        })
        .collect();
    Modelling {
        gears,
        contacts: flexible.contacts.clone(),
    }
}

/// Level that is not elastic, with its scene and models, which are equal for all integrators.
#[derive(Clone, Debug)]
pub struct InelasticLevel {
    /// Level of the model hierarchy.
    pub level: Level,
    /// Gears and meshes of the level.
    pub scene: Arc<SceneSpec>,
    /// Gear models and contacts of the level.
    pub modelling: Arc<Modelling>,
}

/// Data from which candidates are built, computed once per scene.
#[derive(Clone, Debug)]
pub struct CandidateData {
    /// Oscillator of rigid gears on their mesh stiffness.
    pub oscillator: MeshOscillator,
    /// Levels of rigid gears and of movable teeth.
    pub fixed: Vec<InelasticLevel>,
    /// Stiffness from static solves, or the reason why there is none.
    pub statics: Result<StaticPairStiffness, String>,
    /// Mesh and contact of the elastic gears.
    pub details: Details,
}

impl CandidateData {
    /// Prepares the candidates of a scene: contact time, largest approach of a rigid run, static solves.
    pub fn of(problem: &Problem) -> Result<CandidateData, ChooseError> {
        CandidateData::with(problem, Details::of(problem, 0))
    }

    /// Prepares the candidates of a problem for elastic gears with the given details.
    pub fn with(problem: &Problem, details: Details) -> Result<CandidateData, ChooseError> {
        let oscillator = MeshOscillator::of(&problem.scene)?;
        let scene = Arc::new(problem.scene.clone());
        let of_mesh = MeshModeDamping::of(problem, &details);
        // Without a mesh mode dampers belong to a force, which the first run tells.
        let relaxation = |m: usize, force| match &of_mesh {
            Some(of_mesh) => of_mesh.relaxation,
            None => problem.relaxation(&details.lead, m, oscillator.stiffness, force),
        };
        let damped = |mut modelling: Modelling| {
            if let Some(of_mesh) = &of_mesh {
                of_mesh.give(problem, &mut modelling);
            }
            Arc::new(modelling)
        };
        let fixed = |stiffness: Stiffness, source: statics::Source<'_>, force: f64| {
            let contacts = (problem.flexible.contacts.iter().enumerate())
                .map(|(m, flexible)| {
                    let mut c = source.contact(relaxation(m, force), &oscillator);
                    c.friction = flexible.friction;
                    if let Damping::RatioAtLoad { ratio } = flexible.damping {
                        let of_modes = relaxation(m, force) / (2.0 * oscillator.lag());
                        c.damping = Damping::RatioAtLoad {
                            ratio: of_mesh.map_or(ratio + of_modes, |o| o.ratio),
                        };
                    }
                    c
                })
                .collect();
            InelasticLevel {
                level: Level::Rigid(stiffness),
                scene: scene.clone(),
                modelling: damped(statics::rigid(&problem.scene, contacts)),
            }
        };
        let first = fixed(Stiffness::Norm, statics::Source::Norm, 0.0);
        let approach = super::pilot::approach(problem, &first, &oscillator)?;
        let force = MEAN_FORCE * approach * oscillator.stiffness;
        let statics = calibrate(problem, details.judge(), approach).map_err(|e| e.to_string());
        let mut all = vec![
            fixed(Stiffness::Norm, statics::Source::Norm, force),
            fixed(Stiffness::Analytic, statics::Source::Analytic, force),
        ];
        if let Ok(c) = &statics {
            all.push(fixed(Stiffness::Static, statics::Source::Static(c), force));
        }
        let own = |o: &ModelWithConstants, level| InelasticLevel {
            level,
            scene: Arc::new(o.scene.clone()),
            modelling: Arc::new(o.modelling.clone()),
        };
        let of = |rigid: bool| problem.own.iter().filter(move |o| o.rigid == rigid);
        all.extend(of(true).map(|o| own(o, Level::Rigid(Stiffness::Own(o.label.clone())))));
        if problem.scene.meshes.len() == 1 {
            let tau = relaxation(0, force);
            let damping = match &statics {
                Ok(c) => statics::damper(tau, c.secant()),
                Err(_) => statics::damper(tau, oscillator.stiffness),
            };
            let derived = statics::movable_teeth(&problem.scene, statics.as_ref().ok(), damping);
            if let Ok(mut modelling) = derived {
                let flexible = &problem.flexible.contacts[0];
                modelling.contacts[0].friction = flexible.friction;
                if let (Some(o), Damping::RatioAtLoad { .. }) = (of_mesh, flexible.damping) {
                    modelling.contacts[0].damping = Damping::RatioAtLoad { ratio: o.ratio };
                }
                all.push(InelasticLevel {
                    level: Level::MovableTeeth(None),
                    scene: scene.clone(),
                    modelling: damped(modelling),
                });
            }
        }
        all.extend(of(false).map(|o| own(o, Level::MovableTeeth(Some(o.label.clone())))));
        Ok(CandidateData {
            oscillator,
            fixed: all,
            statics,
            details,
        })
    }

    /// Returns the rigid level that is nearest to the elastic gears.
    pub fn best_rigid(&self) -> &InelasticLevel {
        let is = |f: &&InelasticLevel| f.level == Level::Rigid(Stiffness::Static);
        self.fixed.iter().find(is).unwrap_or(&self.fixed[0])
    }

    /// Returns all candidates, the cheapest family first, within a level the longest step first.
    pub fn candidates(&self, problem: &Problem) -> Vec<Candidate> {
        let time = self.oscillator.contact_time();
        let mut all = Vec::new();
        for f in &self.fixed {
            let menus = match f.level {
                Level::MovableTeeth(_) => &RIGID[TEETH],
                _ => &RIGID[..],
            };
            for method in menus.iter().flat_map(|m| m.methods(time)) {
                all.push(Candidate {
                    level: f.level.clone(),
                    scene: f.scene.clone(),
                    modelling: f.modelling.clone(),
                    method,
                });
            }
        }
        let scene = Arc::new(problem.scene.clone());
        let finer = self.details.finer.as_ref().ok();
        for of in std::iter::once(&self.details.lead).chain(finer) {
            for modes in std::iter::once(0).chain(MODES) {
                let methods = ELASTIC.methods(time);
                all.extend(methods.map(|method| self.flexible(of, &scene, modes, method)));
            }
        }
        all
    }

    /// Elastic gears with some modes under a method.
    fn flexible(
        &self,
        of: &ElasticSettings,
        scene: &Arc<SceneSpec>,
        modes: usize,
        method: Scheme,
    ) -> Candidate {
        let usual = || short(self.oscillator.contact_time() / TOLERANCE_STEPS);
        let step = method.resolution.step().unwrap_or_else(usual);
        Candidate {
            level: Level::elastic(modes, of.detail),
            scene: scene.clone(),
            modelling: Arc::new(elastic(of, modes, Some(step))),
            method,
        }
    }

    /// Returns the candidate of elastic gears with a number of modes and at least so many steps per contact time, so
    /// that teeth are resolved as well.
    pub fn at_steps(
        &self,
        problem: &Problem,
        of: &ElasticSettings,
        modes: usize,
        steps: f64,
    ) -> Candidate {
        let method = TRIGONOMETRIC.at_step(resolving(problem, &self.oscillator, steps));
        self.flexible(of, &Arc::new(problem.scene.clone()), modes, method)
    }
}

/// Step with at least so many in a contact time that teeth are resolved as well [s].
fn resolving(problem: &Problem, oscillator: &MeshOscillator, steps: f64) -> f64 {
    let tooth = 1.0 / (TOOTH_STEPS * problem.tooth_frequency());
    short((oscillator.contact_time() / steps).min(tooth))
}

/// Returns the step [s] of refined gears with at least so many steps in a contact time, for a problem without prepared
/// levels.
///
/// # Errors
/// [`BuildError`] where rigid gears cannot be assembled.
pub fn fine_step(problem: &Problem, steps: f64) -> Result<f64, BuildError> {
    Ok(resolving(
        problem,
        &MeshOscillator::of(&problem.scene)?,
        steps,
    ))
}

/// Returns the densest elastic model of gears, finer than all levels of the hierarchy, against which choices are
/// validated.
pub fn densest(problem: &Problem, prepared: &CandidateData, of: &ElasticSettings) -> Candidate {
    prepared.at_steps(problem, of, DENSEST, DENSEST_STEPS)
}
