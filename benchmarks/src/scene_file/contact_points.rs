//! The keys of `contact` for models with contact at points of their flanks.

use super::contact::ContactTable;
use super::error::SceneError;
use super::reading::Place;
use super::reading::keys::keys;
use super::reading::values::Count;
use gearbench_models::error::Reason;
use gearbench_models::spec::{FlankContact, MAX_POINTS, PointContact, PointLaw, PointRule};
use serde::{Deserialize, Serialize};

/// Keys that are valid for flank points only.
const OF_POINTS: [&str; 6] = [
    "law",
    "points",
    "surface",
    "passes",
    "damping_ns_per_m3",
    "reach_m",
];

/// Local compliance of the contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum LocalContact {
    /// The elements of the mesh: points of the flanks with a penalty or without.
    Mesh,
    /// Half-spaces in their place.
    HalfSpace,
}

/// Law of the contact at points of flanks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum LawWord {
    /// A pressure that grows with the penetration.
    Penalty,
    /// Gaps that do not become negative.
    Hard,
}

/// Contact points of an element face.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum PointsChoice {
    /// Quadrature points of the faces.
    Quadrature,
    /// The nodes.
    Nodes,
    /// Gaps that are averaged at the nodes, for hard contact.
    Mortar,
    /// Quadrature points by their numbers.
    #[serde(rename = "<table>")]
    Grid(PointTable),
}

keys! {
    /// Numbers of quadrature points of a face.
    struct PointTable {
        /// quadrature points of a face along the profile, 8 are usual
        along: Count<1, { MAX_POINTS as u32 }>,
        /// quadrature points of a face over the width, 2 are usual
        across: Count<1, { MAX_POINTS as u32 }>,
    }
}

/// Reads the contact of the flanks: that of the toothing without a penalty.
pub(super) fn flanks(keys: &ContactTable, at: &Place<'_>) -> Result<FlankContact, SceneError> {
    if keys.local == Some(LocalContact::HalfSpace) {
        return half_space(at);
    }
    let (base, key) = if keys.law == Some(LawWord::Hard) {
        (hard(keys, at)?, "law")
    } else {
        match (keys.penalty_pa_per_m, keys.penalty_n_per_m) {
            (Some(_), Some(_)) => {
                return Err(at.key("penalty_n_per_m").against(
                    (&at.key("penalty_pa_per_m"), "this"),
                    "two penalties are given",
                    "and this",
                    "give one: `penalty_pa_per_m` per area, or `penalty_n_per_m` per node",
                ));
            }
            (Some(penalty), None) => {
                let rule = rule(keys, at)?;
                let contact = PointContact::new(penalty);
                (PointContact { rule, ..contact }, "penalty_pa_per_m")
            }
            (None, Some(penalty)) => (per_node(penalty, keys, at)?, "penalty_n_per_m"),
            (None, None) => {
                return match OF_POINTS.into_iter().find(|key| at.has(key)) {
                    None => Ok(FlankContact::Toothing),
                    Some(key) => at.key(key).refuse(
                        format!("`{key}` belongs to flank points, which have no penalty"),
                        "remove this",
                        "or add `penalty_pa_per_m`, for steel for example 1e15",
                    ),
                };
            }
        }
    };
    let settings = PointContact {
        surface: keys.surface.unwrap_or_default(),
        passes: keys.passes.unwrap_or_default(),
        reach: keys.reach_m,
        ..base.damped(keys.damping_ns_per_m3.unwrap_or(0.0))
    };
    match settings.problem() {
        None => Ok(FlankContact::Points(settings)),
        Some(Reason { cause, help }) => at.key(key).refuse(cause, "in this contact", help),
    }
}

/// Returns the keys of a contact of flanks.
pub(super) fn of_flanks(flanks: &FlankContact) -> ContactTable {
    let spec = match flanks {
        FlankContact::Toothing => return ContactTable::default(),
        FlankContact::HalfSpace => {
            return ContactTable {
                local: Some(LocalContact::HalfSpace),
                ..ContactTable::default()
            };
        }
        FlankContact::Points(points) => points,
    };
    let hard = spec.law == PointLaw::Hard;
    let points = match spec.rule {
        PointRule::Nodes | PointRule::EachNode => Some(PointsChoice::Nodes),
        PointRule::Quadrature { .. } if hard => None,
        PointRule::Quadrature { along, across } => Some(PointsChoice::Grid(PointTable {
            along: Count(along),
            across: Count(across),
        })),
    };
    let penalty = spec.penalty().map(|[penalty, _]| penalty);
    let of_node = spec.rule == PointRule::EachNode;
    ContactTable {
        law: hard.then_some(LawWord::Hard),
        penalty_pa_per_m: penalty.filter(|_| !of_node),
        penalty_n_per_m: penalty.filter(|_| of_node),
        points,
        surface: given(spec.surface),
        passes: given(spec.passes),
        damping_ns_per_m3: spec.penalty().and_then(|[_, dashpot]| given(dashpot)),
        reach_m: spec.reach,
        ..ContactTable::default()
    }
}

/// A value that is not the default.
fn given<T: Default + PartialEq>(value: T) -> Option<T> {
    Some(value).filter(|v| *v != T::default())
}

/// Contact of elastic half-spaces, which has no options.
fn half_space(at: &Place<'_>) -> Result<FlankContact, SceneError> {
    let mut others = OF_POINTS
        .into_iter()
        .chain(["penalty_pa_per_m", "penalty_n_per_m"]);
    match others.find(|key| at.has(key)) {
        None => Ok(FlankContact::HalfSpace),
        Some(key) => at.key(key).refuse(
            format!("`{key}` belongs to the points of a mesh, but the contact uses half-spaces"),
            "remove this",
            "or give local = \"mesh\"",
        ),
    }
}

/// Reads the point rule of a penalty law.
fn rule(keys: &ContactTable, at: &Place<'_>) -> Result<PointRule, SceneError> {
    Ok(match &keys.points {
        None | Some(PointsChoice::Quadrature) => PointRule::default(),
        Some(PointsChoice::Nodes) => PointRule::Nodes,
        Some(PointsChoice::Grid(keys)) => PointRule::Quadrature {
            along: keys.along.0,
            across: keys.across.0,
        },
        Some(PointsChoice::Mortar) => {
            return at.key("points").refuse(
                "\"mortar\" belongs to hard contact, but the law is a penalty",
                "expected \"quadrature\", \"nodes\" or { along, across }",
                "or add law = \"hard\" and remove the penalty",
            );
        }
    })
}

/// Contact with the same penalty at every node [N/m].
fn per_node(penalty: f64, keys: &ContactTable, at: &Place<'_>) -> Result<PointContact, SceneError> {
    match rule(keys, at)? {
        PointRule::Nodes => Ok(PointContact {
            rule: PointRule::EachNode,
            ..PointContact::new(penalty)
        }),
        _ => at.key("penalty_n_per_m").refuse(
            "`penalty_n_per_m` is a penalty per node",
            "the points are not nodes",
            "add points = \"nodes\", or give `penalty_pa_per_m`",
        ),
    }
}

/// Hard contact, without a penalty.
fn hard(keys: &ContactTable, at: &Place<'_>) -> Result<PointContact, SceneError> {
    let penalties = ["penalty_pa_per_m", "penalty_n_per_m"];
    if let Some(key) = penalties.into_iter().find(|key| at.has(key)) {
        return at.key(key).refuse(
            format!("`{key}` belongs to a penalty law, but the law is hard"),
            "remove this",
            "or remove law = \"hard\"",
        );
    }
    if keys.damping_ns_per_m3.is_some_and(|c| c != 0.0) {
        return at.key("damping_ns_per_m3").refuse(
            "hard contact has no dashpot",
            "in this contact",
            "remove the damping",
        );
    }
    match keys.points {
        None | Some(PointsChoice::Mortar) => Ok(PointContact::hard(PointRule::default())),
        Some(PointsChoice::Nodes) => Ok(PointContact::hard(PointRule::Nodes)),
        Some(PointsChoice::Quadrature | PointsChoice::Grid(_)) => at.key("points").refuse(
            "hard contact cannot use quadrature points: they outnumber the nodes, so that their forces are not unique",
            "expected \"mortar\" or \"nodes\"",
            "\"mortar\" averages their gaps at the nodes",
        ),
    }
}
