//! References of a study of accuracy against cost (full models on a fine step, the stored reference, the densest
//! reduced model), and their assignment to contacts.

use super::arguments::PrecisionOptions;
use super::plan::{FULL, Full, Variant};
use crate::experiment::configuration::Configuration;
use crate::scene_file::{ModelChoice, SceneFile};
use gearbench_integrators::table::NEWMARK;
use gearbench_models::gear::parameters::ModelParameters;
use gearbench_models::spec::{FlankContact, Modelling, PointContact, PointLaw, PointRule};
use gearbench_reference::assembly::tie::MassKind;
use gearbench_reference::full_order::FullOrderParameters;
use gearbench_reports::record::ReferenceSeries;

/// Step of a full model that is a reference over that of the scene.
const FINER: f64 = 0.2;
/// Step of a full model whose integrator has none in the scene [s].
const FULL_STEP: f64 = 5e-7;

fn is_lumped(choice: &ModelChoice) -> bool {
    let mut gears = (choice.modelling.gears.iter()).filter_map(FullOrderParameters::of);
    gears.any(|p| p.mass == Some(MassKind::Lumped))
}

/// Returns the references to compute: full models among those that run or selected by label; without any other
/// reference, the elastic model with the most modes.
pub(super) fn references(
    scene: &SceneFile,
    choices: &[&ModelChoice],
    variants: &[Variant],
    external: &[ReferenceSeries],
    asked: &PrecisionOptions,
) -> Result<Vec<Full>, String> {
    let densest = |label: Option<&str>| {
        let all = variants.iter().filter(|v| v.modes.is_some());
        let named = all.filter(|v| label.is_none_or(|l| v.entry.label == l));
        named.max_by_key(|v| v.modes).map(|v| Full {
            id: v.entry.label.clone(),
            entry: v.entry.clone(),
            method: None,
            title: format!(
                "{} with {} modes per gear, converged: the densest reduced model, no full finite elements",
                v.entry.label,
                v.modes.unwrap_or(0)
            ),
        })
    };
    let is_full = |m: &ModelChoice| m.model == FULL && !is_lumped(m);
    if asked.against.is_empty() {
        let mut fulls: Vec<Full> = (choices.iter())
            .filter(|m| is_full(m))
            .map(|m| full(scene, m))
            .collect();
        if fulls.is_empty() && external.is_empty() {
            fulls.extend(densest(None));
        }
        return Ok(fulls);
    }
    let mut fulls = Vec::new();
    for id in &asked.against {
        if external.iter().any(|e| e.id == *id) {
            continue;
        }
        let found = match scene.model(id) {
            Some(m) if is_full(m) => Some(full(scene, m)),
            _ => densest(Some(id)),
        };
        fulls.push(found.ok_or_else(|| {
            let full = scene
                .models
                .iter()
                .filter(|m| is_full(m))
                .map(|m| m.label.as_str());
            let elastic = variants.iter().filter(|v| v.modes.is_some());
            let mut known: Vec<&str> = (external.iter())
                .map(|e| e.id.as_str())
                .chain(full)
                .collect();
            known.extend(elastic.map(|v| v.entry.label.as_str()));
            known.dedup();
            let known = if known.is_empty() {
                "none".into()
            } else {
                known.join(", ")
            };
            format!(
                "`{id}` is not a reference of the scene `{}`; it has {known}",
                scene.name
            )
        })?);
    }
    Ok(fulls)
}

/// A full model at a fraction of its step.
fn full(scene: &SceneFile, choice: &ModelChoice) -> Full {
    let own = choice.integrators.as_ref().and_then(|m| m.first());
    let step = own.and_then(|m| m.resolution.step()).unwrap_or(FULL_STEP);
    Full {
        id: choice.label.clone(),
        entry: Configuration::of(scene, choice),
        method: Some(NEWMARK.at_step(FINER * step)),
        title: format!("full finite elements ({}{})", choice.label, penalty(choice)),
    }
}

/// The penalty of a model in words: references with another one are another contact.
fn penalty(choice: &ModelChoice) -> String {
    match flanks(&choice.modelling) {
        Some(FlankContact::HalfSpace) => ", half-spaces".into(),
        Some(FlankContact::Points(p)) => match p.law {
            PointLaw::Hard => ", hard contact".into(),
            PointLaw::Penalty { stiffness, .. } if p.rule == PointRule::EachNode => {
                format!(", penalty {stiffness:.1e} N/m per node")
            }
            PointLaw::Penalty { stiffness, .. } => format!(", penalty {stiffness:.1e} Pa/m"),
        },
        Some(FlankContact::Toothing) | None => String::new(),
    }
}

/// True if two contacts of flanks have the same physics: the penalty, and its unit. The positions of the points are a
/// matter of resolution.
fn has_same_physics(a: &FlankContact, b: &FlankContact) -> bool {
    match (a, b) {
        (FlankContact::Points(a), FlankContact::Points(b)) => {
            let each = |c: &PointContact| c.rule == PointRule::EachNode;
            a.law == b.law && each(a) == each(b) && a.surface == b.surface
        }
        (a, b) => a == b,
    }
}

/// The contact of flanks that are those of finite elements.
fn flanks(modelling: &Modelling) -> Option<&FlankContact> {
    let mut all = modelling.contacts.iter().map(|c| &c.flanks);
    all.find(|f| **f != FlankContact::Toothing)
}

/// Returns the references of a variant: for models with flank points the ones with the same contact. Lines of action
/// have no penalty and are compared with references whose penalty is one per area.
pub(super) fn references_for(
    scene: &SceneFile,
    variant: &Variant,
    fulls: &[Full],
    external: &[ReferenceSeries],
) -> Vec<String> {
    let own = flanks(&variant.entry.modelling);
    let per_area = |c: &FlankContact| c.points().is_none_or(|p| p.rule != PointRule::EachNode);
    let fits = |other: &Configuration| match (own, flanks(&other.modelling)) {
        (Some(a), Some(b)) => has_same_physics(a, b),
        (None, Some(b)) => per_area(b),
        _ => true,
    };
    let mut ids = Vec::new();
    let stored = |id: &str| (scene.references.iter()).any(|r| r.name == id && r.stored().is_some());
    for e in external {
        // Measurements contain the real contact, so that all models are compared with them.
        if !stored(&e.id) {
            ids.push(e.id.clone());
            continue;
        }
        // A stored reference has the contact of the scene's full model with a penalty per area, if it has one.
        let full = |m: &&ModelChoice| m.model == FULL;
        let entries: Vec<Configuration> = (scene.models.iter().filter(full))
            .map(|m| Configuration::of(scene, m))
            .filter(|m| flanks(&m.modelling).is_some_and(per_area))
            .collect();
        if entries.is_empty() || entries.iter().any(fits) {
            ids.push(e.id.clone());
        }
    }
    ids.extend(
        fulls
            .iter()
            .filter(|f| fits(&f.entry))
            .map(|f| f.id.clone()),
    );
    if ids.is_empty() && own.is_none() {
        ids.extend(fulls.iter().map(|f| f.id.clone()));
    }
    ids
}
