//! Conversion of a choice into a record.

use super::problem::Problem;
use super::reasons::yardstick;
use super::requirement::Requirement;
use super::run::{CandidateResult, Choice, LevelResult};
use crate::experiment::budget::NOT_TRIED;
use crate::experiment::machine;
use gearbench_models::spec::{FlankContact, PointLaw};
use gearbench_reports::numbers::round_quantity;
use gearbench_reports::record::{Part, Results, Tolerance, finite};
use gearbench_reports::{CandidateRecord, ChoiceRecord, ChooseRecord, LevelRecord, Metric};

/// Returns the record of a choice.
pub fn results(
    problem: &Problem,
    (title, command): (&str, &str),
    requirement: &Requirement,
    choice: &Choice,
) -> Results {
    let place = |c: &super::plan::Candidate| {
        (choice.tried.iter())
            .position(|t| t.candidate.level == c.level && t.candidate.method == c.method)
    };
    let answer = ChoiceRecord {
        metric: requirement.name().into(),
        metric_title: requirement.title().into(),
        tolerance: requirement.tolerance,
        verdict: Some(choice.verdict),
        yardstick: yardstick(choice),
        yardstick_error: choice.own_error.and_then(finite),
        yardstick_integration_error: finite(choice.parts.top_integration),
        yardstick_mesh_error: choice.parts.mesh.and_then(finite),
        scatter: finite(choice.scatter).filter(|s| *s > 0.0),
        not_repeatable: choice.not_repeatable.clone(),
        references: choice.references.clone(),
        runs: choice.runs,
        total_cost_s: finite(choice.total_cost_s),
        chosen: choice.candidate.as_ref().and_then(place),
        predicted_error: finite(choice.predicted_error),
        model_error: finite(choice.parts.model),
        integration_error: finite(choice.parts.integration),
        top_error: finite(choice.parts.top),
        growth: finite(choice.parts.growth),
        predicted_cost_s: finite(choice.predicted_cost_s),
        setup_s: finite(choice.setup_s),
        window: choice.window.describe(),
        window_s: finite(choice.window.end),
        reason: choice.reason.clone(),
        outside: choice.outside.clone(),
        levels: (choice.levels.iter())
            .map(|r| level(r, r.cheapest.as_ref().and_then(|(c, _)| place(c))))
            .collect(),
        tried: choice.tried.iter().map(tried).collect(),
    };
    Results {
        header: machine::header(&problem.name, title, command),
        part: Part::Choose(Box::new(ChooseRecord { choice: answer })),
        settings: settings(problem, choice),
        // The energy lost is no metric of a record.
        tolerance: (requirement.metric != Metric::EnergyDrift).then(|| Tolerance {
            metric: requirement.metric,
            limit: requirement.tolerance,
            against: "top".into(),
            except: Vec::new(),
        }),
        ..Results::default()
    }
}

fn level(r: &LevelResult, cheapest: Option<usize>) -> LevelRecord {
    LevelRecord {
        name: r.level.name(),
        family: r.level.family().into(),
        modes: r.level.modes(),
        distance: finite(r.distance),
        step_up: r.step_up.and_then(finite),
        error: finite(r.error),
        adequate: r.adequate,
        statistics: r.statistics,
        cheapest,
        setup_s: finite(r.setup_s),
        failure: r.failure.clone(),
    }
}

fn tried(t: &CandidateResult) -> CandidateRecord {
    CandidateRecord {
        level: t.candidate.level.name(),
        family: t.candidate.level.family().into(),
        integrator: t.candidate.method.method.to_string(),
        step_s: t.candidate.method.resolution.step(),
        rtol: t.candidate.method.resolution.tolerance(),
        error: finite(t.error),
        cost_s: finite(t.cost_s),
        steps: t.work[0],
        force_evaluations: t.work[1],
        adequate: t.adequate,
        failure: t.failure.clone(),
    }
}

fn settings(problem: &Problem, choice: &Choice) -> Vec<(String, String)> {
    let elastic = match &problem.flexible.label {
        Some(label) => format!("meshes, contact and damping of the model `{label}` of the scene"),
        None => "generated meshes and a penalty: the scene has no elastic model".into(),
    };
    let mut all = vec![
        ("duration".into(), round_quantity(problem.duration, "s", 4)),
        ("elastic gears".into(), elastic),
        ("window".into(), choice.window.describe()),
    ];
    for (i, c) in problem.flexible.contacts.iter().enumerate() {
        all.extend(law(&c.flanks).map(|law| (format!("contact of mesh {}", i + 1), law)));
    }
    if !choice.not_tried.is_empty() {
        let rest = choice.not_tried.join("; ");
        let budget = problem.runner.budget().described();
        all.push((NOT_TRIED.into(), format!("{budget}: {rest}")));
    }
    all.push(("yardstick".into(), choice.details.describe_judge()));
    all
}

fn law(flanks: &FlankContact) -> Option<String> {
    Some(match flanks {
        FlankContact::Toothing => return None,
        FlankContact::HalfSpace => "half-spaces".into(),
        FlankContact::Points(points) => match points.law {
            PointLaw::Hard => "hard contact".into(),
            PointLaw::Penalty { stiffness, damping } => {
                format!("penalty {stiffness:.3e} Pa/m, dashpot {damping:.3e} N s/m^3")
            }
        },
    })
}
