//! Comparison of the choice and its yardstick with the references of the scene. The estimated error of a choice is one
//! against finer models; its distance to a measurement may be larger.
//!
//! Each is run over the whole scene, and for references of other speeds and loads once more under each of these. What the
//! references say of the metric that was asked for is the last word: a choice that is beyond its tolerance there is not
//! adequate, whatever was estimated between models. The yardstick's distance is reported.

use super::plan::Candidate;
use super::reasons::per_cent;
use super::requirement::Requirement;
use crate::experiment::conditions::Conditions;
use crate::experiment::reference_series::recorded;
use crate::experiment::run::{RunError, run};
use crate::scene_file::references::LoadedReference;
use gearbench_reports::Metric;
use gearbench_reports::metrics::compare_all;
use gearbench_reports::record::Run;

/// Model that is compared with the references of the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ComparedModel {
    /// The candidate that was chosen.
    Choice,
    /// The yardstick, the most detailed level of the hierarchy.
    Yardstick,
}

impl ComparedModel {
    /// The words with which settings of the record about this model begin.
    fn against(self) -> &'static str {
        match self {
            ComparedModel::Choice => "the choice against",
            ComparedModel::Yardstick => "the yardstick against",
        }
    }
}

/// Distances of a model to the references, with the settings of the record about them.
#[derive(Debug, Default)]
pub(super) struct ReferenceDistances {
    /// Settings of the record, one for each reference.
    pub(super) settings: Vec<(String, String)>,
    /// References with the distance of the model in the required metric; `None` where it cannot be evaluated.
    pub(super) distances: Vec<(String, Option<f64>)>,
    /// References against which the error in the required metric exceeds the tolerance.
    pub(super) beyond: Vec<String>,
}

/// Runs a model over the whole scene, at the speeds and loads of each reference, and computes its errors against them.
///
/// # Errors
/// [`RunError`] when it cannot run.
pub(super) fn against(
    (subject, candidate): (ComparedModel, &Candidate),
    references: &[LoadedReference],
    requirement: &Requirement,
) -> Result<ReferenceDistances, RunError> {
    let mut found = ReferenceDistances::default();
    // References of the scene's own conditions share a run.
    let mut own = None;
    for held in references {
        let of_the_scene = held.named.is_of_the_scene();
        let row = match &own {
            Some(row) if of_the_scene => Run::clone(row),
            _ => under(candidate, held, references)?,
        };
        let (told, distance, beyond) =
            compare_with_reference(&row, held, (subject, candidate), requirement);
        let id = &held.data.id;
        found.distances.push((id.clone(), distance));
        if beyond {
            found.beyond.push(id.clone());
        }
        let where_ = if of_the_scene {
            ""
        } else {
            " (at its own speeds and loads)"
        };
        found
            .settings
            .push((format!("{} {id}{where_}", subject.against()), told));
        if of_the_scene {
            own = Some(row);
        }
    }
    Ok(found)
}

/// A model at the speeds and loads of a reference.
fn under(
    candidate: &Candidate,
    held: &LoadedReference,
    all: &[LoadedReference],
) -> Result<Run, RunError> {
    let conditions = Conditions {
        repeats: 0,
        ..Conditions::of(&held.scene).compared_with(&held.scene.spec, all.iter().map(|h| &h.data))
    };
    let mut spec = held.scene.spec.clone();
    // The candidate's scene may have another gap than the file's; one that the reference has counts before it.
    let theirs = usize::from(held.named.conditions.gap.is_some());
    let own = candidate.scene.meshes.iter().map(|m| m.start.gap);
    for (mesh, gap) in spec.meshes.iter_mut().zip(own).skip(theirs) {
        mesh.start.gap = gap;
    }
    let grid = conditions.grid();
    run(&conditions.job((&spec, &candidate.modelling), &candidate.method, &grid))
}

/// Returns all errors against a reference in words, the one in the required metric, and whether that exceeds the
/// tolerance.
fn compare_with_reference(
    row: &Run,
    held: &LoadedReference,
    (subject, candidate): (ComparedModel, &Candidate),
    requirement: &Requirement,
) -> (String, Option<f64>, bool) {
    let run = match row.finished() {
        Ok(run) => run,
        Err(_) => {
            let why = row.message.as_deref().unwrap_or("no reason given");
            let told = format!("the run did not reach the end: {why}");
            return (told, None, true);
        }
    };
    let recorded = recorded(&held.data, &candidate.scene);
    let metrics = compare_all(run, &recorded.all_series(), &held.data.id);
    let errors = Metric::ALL
        .into_iter()
        .filter(|m| m.is_error() && *m != Metric::EnergyDrift);
    let mut all: Vec<String> = errors
        .filter_map(|m| Some(format!("{} {}", m.words(), per_cent(metrics.get(m)?.abs()))))
        .collect();
    // Histories of references do not contain the dissipated energy.
    let asked = match requirement.metric {
        Metric::EnergyDrift => None,
        metric => metrics.get(metric).map(f64::abs),
    };
    let allowed = per_cent(requirement.tolerance);
    let title = requirement.title();
    let beyond = asked.is_some_and(|e| e > requirement.tolerance);
    all.extend(match (asked, subject) {
        (None, _) => Some(format!("it says nothing of the {title} that was asked for")),
        (Some(_), ComparedModel::Yardstick) => None,
        (Some(_), ComparedModel::Choice) if beyond => Some(format!(
            "so the {title} is beyond the {allowed} asked for: the choice is not adequate"
        )),
        (Some(_), ComparedModel::Choice) => {
            Some(format!("so the {title} is within the {allowed} asked for"))
        }
    });
    (all.join(", "), asked, beyond)
}
