//! Plan of the study of mode counts: models and integrators of the scene, truncation variants, numbers of modes.

use super::arguments::Truncation;
use crate::cli::terminal::{Refusal, refuse_run};
use crate::experiment::conditions::Conditions;
use crate::experiment::configuration::Configuration;
use crate::experiment::run::RunError;
use crate::scene_file::{ModelChoice, SceneError, SceneFile};
use gearbench_integrators::table::{NEWMARK, TRIGONOMETRIC, VELOCITY_VERLET};
use gearbench_integrators::{MethodSpec, Resolution, Scheme};
use gearbench_models::gear::parameters::ModelParameters;
use gearbench_models::spec::{ModelSpec, Modelling};
use gearbench_reference::full_order::FullOrderParameters;
use gearbench_reference::reduction::ElasticParameters;
use gearbench_reference::reduction::choose::Criterion;
use gearbench_reports::record::ReferenceSeries;

/// Model whose modes are counted.
const ELASTIC: &str = ElasticParameters::MODEL;
/// Id of the full-order model, also its id as a reference.
pub(super) const FULL: &str = FullOrderParameters::MODEL;
/// Step of the full model over that of the scene.
const FINER: f64 = 0.2;
/// Steps when the scene's model has no fixed one [s].
const STEP: f64 = 1e-6;
const FULL_STEP: f64 = 5e-7;
const TRUNCATED_STEP: f64 = 2e-8;
/// Default numbers of modes per gear.
const COUNTS: [usize; 10] = [0, 10, 25, 35, 50, 75, 100, 150, 200, 300];
/// Frequency bound of the published truncation [Hz]: "modes up to 80 kHz" (GTM, SIMPACK User Meeting 2014; rack and
/// pinion of an electric power steering).
const PUBLISHED_HZ: f64 = 80e3;
/// Published number of elastic coordinates per body.
const PUBLISHED_MODES: usize = 200;

/// Variant of modal truncation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TruncationVariant {
    /// Label of the variant in the record.
    pub label: &'static str,
    /// Criterion of the mode selection, the parameter `choose`.
    pub choose: Criterion,
    /// True if the residual compliance is kept, the parameter `residual`.
    pub residual: bool,
    /// Factor of the step relative to that of the scene's integrator.
    pub step: f64,
}

/// Truncation variants that are compared.
pub(super) const VARIANTS: [TruncationVariant; 5] = [
    variant("by flank compliance", BY_COMPLIANCE, true, 1.0),
    // Cost of a smaller step, compared with the cost of the truncated modes.
    variant(
        "by flank compliance, a quarter of the step",
        BY_COMPLIANCE,
        true,
        0.25,
    ),
    variant("by frequency", Criterion::Frequency, true, 1.0),
    variant("truncated, by flank compliance", BY_COMPLIANCE, false, 1.0),
    variant("truncated, by frequency", Criterion::Frequency, false, 1.0),
];

const BY_COMPLIANCE: Criterion = Criterion::FlankCompliance;

const fn variant(
    label: &'static str,
    choose: Criterion,
    residual: bool,
    step: f64,
) -> TruncationVariant {
    TruncationVariant {
        label,
        choose,
        residual,
        step,
    }
}

/// Plan of the study of mode counts.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    pub conditions: Conditions,
    /// Elastic model; the study varies its modes, `choose` and `residual`.
    pub elastic: Configuration,
    pub method: Scheme,
    /// Integrator of plain truncation, whose contact is stiff.
    pub truncated: Scheme,
    /// Full-order model on the same mesh.
    pub full: Configuration,
    pub full_method: Scheme,
    pub counts: Vec<usize>,
    /// True if the fewest sufficient modes are refined by bisection.
    pub refine: bool,
    /// References from measurements or other programs.
    pub external: Vec<ReferenceSeries>,
}

/// Truncation variant and number of modes of a run.
#[derive(Clone, Copy, Debug)]
pub(super) struct Case {
    pub way: TruncationVariant,
    pub modes: ModeBound,
    pub mark: Option<&'static str>,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum ModeBound {
    /// Upper bound on the number of modes per gear.
    Count(usize),
    /// All modes below a frequency [Hz].
    Below(f64),
}

impl std::fmt::Display for ModeBound {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            ModeBound::Count(n) => write!(f, "{n} modes"),
            ModeBound::Below(hz) => write!(f, "modes to {:.0} kHz", 1e-3 * hz),
        }
    }
}

impl Plan {
    /// Plans the study of a scene under the given conditions and options of the command line.
    pub fn of(
        scene: &SceneFile,
        (elastic, full): (&ModelChoice, &ModelChoice),
        args: &Truncation,
        conditions: Conditions,
    ) -> Result<Plan, Refusal> {
        let mut counts: Vec<usize> = args.counts.iter().map(|n| *n as usize).collect();
        if counts.is_empty() {
            counts = COUNTS.to_vec();
        }
        counts.sort_unstable();
        counts.dedup();
        Ok(Plan {
            conditions,
            elastic: Configuration::of(scene, elastic),
            method: first(elastic, TRIGONOMETRIC, STEP),
            truncated: truncated(scene, elastic),
            full: Configuration::of(scene, full),
            full_method: full_method(scene, full, args)?,
            counts,
            refine: !args.no_refine,
            external: Vec::new(),
        })
    }

    /// Returns the runs of the grid, without refinement.
    pub fn cases(&self) -> Vec<Case> {
        let mut cases = Vec::new();
        for way in VARIANTS {
            let published = !way.residual && way.choose == Criterion::Frequency;
            for &modes in &self.counts {
                cases.push(Case {
                    way,
                    modes: ModeBound::Count(modes),
                    mark: (published && modes == PUBLISHED_MODES)
                        .then_some("plain truncation with 200 modes"),
                });
            }
            if published {
                cases.push(Case {
                    way,
                    modes: ModeBound::Below(PUBLISHED_HZ),
                    mark: Some("plain truncation at 80 kHz"),
                });
            }
        }
        cases
    }

    pub fn method(&self, case: &Case) -> Scheme {
        let scene = if case.way.residual {
            &self.method
        } else {
            &self.truncated
        };
        scene.method.at(match scene.resolution {
            Resolution::Step(h) => Resolution::Step(case.way.step * h),
            Resolution::Tolerance(r) => Resolution::Tolerance(case.way.step * r),
        })
    }

    /// Returns the elastic model with the modes of a case.
    pub fn modelling(&self, case: &Case) -> Modelling {
        let mut modelling = self.elastic.modelling.clone();
        // Modes that the step cannot carry are cut.
        let step = (self.method(case).resolution.step()).map(|h| h / case.way.step);
        ElasticParameters::change(&mut modelling, |p| {
            (p.modes, p.max_frequency_hz, p.target_error) = match case.modes {
                ModeBound::Count(n) => (Some(n), None, None),
                ModeBound::Below(hz) => (None, Some(hz), None),
            };
            p.choose = Some(case.way.choose);
            p.residual = Some(case.way.residual);
            p.step_s = step.or(p.step_s);
        });
        modelling
    }
}

/// The elastic and the full model of a scene that are compared: the first two on the same mesh with the same contact, so
/// that only the modes differ.
pub(super) fn sides<'s>(
    scene: &'s SceneFile,
    args: &Truncation,
) -> Result<(&'s ModelChoice, &'s ModelChoice), Refusal> {
    let named = match &args.models {
        Some(text) => scene.select(Some(text))?,
        None => scene.models.iter().collect(),
    };
    let of = |id: &str| {
        let whole = named
            .iter()
            .copied()
            .filter(|m| m.model == id && !is_truncated(m));
        let whole: Vec<&ModelChoice> = whole.collect();
        (!whole.is_empty()).then_some(whole).ok_or_else(|| {
            SceneError::plain(
                format!("the scene `{}` has no model of the kind `{id}`", scene.name),
                format!(
                    "the study compares `{ELASTIC}` with `{FULL}` on the same mesh; add a [[models]] with model = \"{id}\""
                ),
            )
        })
    };
    let (reduced, full) = (of(ELASTIC)?, of(FULL)?);
    let mut pairs = reduced
        .iter()
        .flat_map(|e| full.iter().map(move |f| (*e, *f)));
    let found = pairs.find(|(e, f)| differ_in_modes_alone(&e.modelling, &f.modelling));
    found.ok_or_else(|| {
        let (e, f) = (&reduced[0].label, &full[0].label);
        Refusal::from(SceneError::plain(
            format!("no elastic model of the scene `{}` has the mesh and the contact of a full one: `{e}` and `{f}` differ in more than their modes", scene.name),
            format!("give `{f}` the mesh parameters and the `contact` of `{e}`, or name two models that share them with --models"),
        ))
    })
}

/// True if an elastic and a full model have the same mesh of each gear and the same contact at their flanks.
fn differ_in_modes_alone(elastic: &Modelling, full: &Modelling) -> bool {
    let same_mesh = |(e, f): (&ModelSpec, &ModelSpec)| {
        ElasticParameters::of(e).map(|p| &p.mesh) == FullOrderParameters::of(f).map(|p| &p.mesh)
    };
    let contacts = elastic.contacts.iter().zip(&full.contacts);
    elastic.gears.iter().zip(&full.gears).all(same_mesh)
        && contacts.into_iter().all(|(e, f)| e.flanks == f.flanks)
}

fn is_truncated(choice: &ModelChoice) -> bool {
    let mut gears = choice.modelling.gears.iter();
    gears.any(|g| ElasticParameters::of(g).is_some_and(|p| !p.keeps_residual()))
}

/// The first integrator of a model, or one that fits it.
fn first(choice: &ModelChoice, usual: MethodSpec, step: f64) -> Scheme {
    let own = choice.integrators.as_ref().and_then(|m| m.first());
    own.copied().unwrap_or(usual.at_step(step))
}

/// The integrator of plain truncation: that of a truncated model of the scene.
fn truncated(scene: &SceneFile, elastic: &ModelChoice) -> Scheme {
    let own = (scene.models.iter()).find(|m| m.model == ELASTIC && is_truncated(m));
    own.map_or_else(
        || (first(elastic, TRIGONOMETRIC, STEP).method).at_step(TRUNCATED_STEP),
        |m| first(m, VELOCITY_VERLET, TRUNCATED_STEP),
    )
}

fn full_method(
    scene: &SceneFile,
    full: &ModelChoice,
    args: &Truncation,
) -> Result<Scheme, Refusal> {
    if let Some(text) = &args.reference_integrator {
        let methods = Scheme::list(text, &scene.study.integrators)
            .map_err(RunError::from)
            .map_err(refuse_run)?;
        if let Some(method) = methods.into_iter().next() {
            return Ok(method);
        }
    }
    let own = first(full, NEWMARK, FULL_STEP);
    let step = own.resolution.step().unwrap_or(FULL_STEP);
    Ok(NEWMARK.at_step(FINER * step))
}
