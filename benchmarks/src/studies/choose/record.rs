//! A choice as a record.

use super::choice::{Choice, RungTried, Tried};
use super::situation::Situation;
use super::wish::Wish;
use crate::experiment::machine;
use gearbench_integrators::Resolution;
use gearbench_reports::record::{Part, Results, Tolerance, finite};
use gearbench_reports::{ChoiceRecord, ChooseRecord, RungRecord, TriedRecord};

/// The record of a choice.
#[must_use]
pub fn results(
    situation: &Situation,
    (title, command): (&str, &str),
    wish: &Wish,
    choice: &Choice,
) -> Results {
    let place = |c: &super::candidate::Candidate| {
        (choice.tried.iter())
            .position(|t| t.candidate.rung == c.rung && t.candidate.method == c.method)
    };
    let answer = ChoiceRecord {
        metric: wish.metric.name().into(),
        metric_title: wish.metric.title().into(),
        tolerance: wish.tolerance,
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
        rungs: (choice.rungs.iter())
            .map(|r| rung(r, r.cheapest.as_ref().and_then(|(c, _)| place(c))))
            .collect(),
        tried: choice.tried.iter().map(tried).collect(),
    };
    Results {
        header: machine::header(&situation.name, title, command),
        part: Part::Choose(Box::new(ChooseRecord { choice: answer })),
        settings: settings(situation, choice),
        tolerance: wish.metric.key().map(|key| Tolerance {
            metric: key,
            limit: wish.tolerance,
            against: "top".into(),
        }),
        ..Results::default()
    }
}

fn rung(r: &RungTried, cheapest: Option<usize>) -> RungRecord {
    RungRecord {
        name: r.rung.name(),
        family: r.rung.family().into(),
        modes: r.rung.modes(),
        distance: finite(r.distance),
        step_up: r.step_up.and_then(finite),
        error: finite(r.error),
        adequate: r.adequate,
        cheapest,
        setup_s: finite(r.setup_s),
        failure: r.failure.clone(),
    }
}

fn tried(t: &Tried) -> TriedRecord {
    let (step_s, rtol) = match t.candidate.method.resolution {
        Resolution::Step(h) => (Some(h), None),
        Resolution::Tolerance(r) => (None, Some(r)),
    };
    TriedRecord {
        rung: t.candidate.rung.name(),
        family: t.candidate.rung.family().into(),
        integrator: t.candidate.method.method.to_string(),
        step_s,
        rtol,
        error: finite(t.error),
        cost_s: finite(t.cost_s),
        steps: t.work[0],
        force_evaluations: t.work[1],
        adequate: t.adequate,
        failure: t.failure.clone(),
    }
}

fn settings(situation: &Situation, choice: &Choice) -> Vec<(String, String)> {
    let elastic = match &situation.flexible.label {
        Some(label) => format!("meshes, contact and damping of the model `{label}` of the scene"),
        None => "generated meshes and a penalty: the scene has no elastic model".into(),
    };
    let mut all = vec![
        ("duration".into(), format!("{:.6e} s", situation.duration)),
        ("elastic gears".into(), elastic),
        ("window".into(), choice.window.describe()),
    ];
    for (i, c) in situation.flexible.contacts.iter().enumerate() {
        if let Some(p) = c.points {
            let law = if p.hard {
                "hard contact".into()
            } else {
                format!(
                    "penalty {:.3e} Pa/m, dashpot {:.3e} N s/m^3",
                    p.penalty, p.damping
                )
            };
            all.push((format!("contact of mesh {}", i + 1), law));
        }
    }
    all
}
