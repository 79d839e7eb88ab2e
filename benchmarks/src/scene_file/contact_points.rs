//! The keys of `contact = { .. }` for models that touch with the points of their flanks.

use super::contact::word_or;
use super::error::SceneError;
use super::reader::{Entry, Key, Section, key};
use gearbench_models::error::Reason;
use gearbench_models::spec::{MAX_POINTS, Passes, PointContact, PointRule, SurfaceKind};

/// Keys that only flank points have.
const OF_POINTS: [&str; 6] = [
    "law",
    "points",
    "surface",
    "passes",
    "damping_ns_per_m3",
    "reach_m",
];

pub(super) static POINTS: &[Key] = &[
    key("along", "quadrature points of a face along the profile"),
    key("across", "quadrature points of a face over the width"),
];

/// The contact of flank points; none without a penalty.
pub(super) fn points(s: &Section<'_>) -> Result<Option<PointContact>, SceneError> {
    if let Some(law) = s.get("law")
        && law.word(&[("penalty", false), ("hard", true)])?
    {
        return hard(s, &law).map(Some);
    }
    let per_node = s.get("penalty_n_per_m");
    if let (Some(a), Some(b)) = (s.get("penalty_pa_per_m"), &per_node) {
        return Err(s
            .source
            .error(
                b.key_range(),
                "two penalties are given",
                "and this",
                "give one: `penalty_pa_per_m` per area, or `penalty_n_per_m` per node",
            )
            .and(a.key_range(), "this"));
    }
    let Some(penalty) = s.get("penalty_pa_per_m").or(per_node) else {
        return match OF_POINTS.iter().find_map(|k| s.get(k)) {
            None => Ok(None),
            Some(e) => Err(e.error(
                format!(
                    "`{}` belongs to flank points, which have no penalty",
                    e.name
                ),
                "remove this",
                "or add `penalty_pa_per_m`, for steel for example 1e15",
            )),
        };
    };
    let rule = match s.get("points") {
        None => PointRule::default(),
        Some(e) if e.as_text().is_some() => e.word(&[
            ("quadrature", PointRule::default()),
            ("nodes", PointRule::Nodes),
        ])?,
        Some(e) => {
            let rule = e.section("`points`", POINTS)?;
            let count = |name: &str| -> Result<usize, SceneError> {
                let entry = rule.need(name)?;
                match entry.whole()? {
                    n if (1..=MAX_POINTS as i64).contains(&i64::from(n)) => Ok(n as usize),
                    n => Err(entry.error(
                        format!("`{name}` is {n}"),
                        format!("expected 1 to {MAX_POINTS}"),
                        "8 along the profile and 2 across are usual",
                    )),
                }
            };
            PointRule::Quadrature {
                along: count("along")?,
                across: count("across")?,
            }
        }
    };
    let rule = match (per_node.is_some(), rule) {
        (false, rule) => rule,
        (true, PointRule::Nodes) => PointRule::EachNode,
        (true, _) => {
            return Err(penalty.error(
                "`penalty_n_per_m` is the penalty of a node",
                "but the points are not nodes",
                "add points = \"nodes\", or give `penalty_pa_per_m`",
            ));
        }
    };
    let settings = PointContact {
        rule,
        surface: surface(s)?,
        passes: passes(s)?,
        damping: s.number_or("damping_ns_per_m3", 0.0)?,
        reach: s.get("reach_m").map(|e| e.number()).transpose()?,
        ..PointContact::new(penalty.number()?)
    };
    checked(settings, &penalty).map(Some)
}

fn checked(settings: PointContact, entry: &Entry<'_>) -> Result<PointContact, SceneError> {
    match settings.problem() {
        None => Ok(settings),
        Some(Reason { cause, help }) => Err(entry.error(cause, "in this contact", help)),
    }
}

/// Contact without a penalty.
fn hard(s: &Section<'_>, law: &Entry<'_>) -> Result<PointContact, SceneError> {
    for name in ["penalty_pa_per_m", "penalty_n_per_m"] {
        if let Some(e) = s.get(name) {
            return Err(e.error(
                format!("`{name}` belongs to a penalty law, but the law is hard"),
                "remove this",
                "or leave out law = \"hard\"",
            ));
        }
    }
    let rule = match s.get("points") {
        None => PointRule::default(),
        Some(e) if e.as_text().is_some_and(|t| t != "quadrature") => e.word(&[
            ("mortar", PointRule::default()),
            ("nodes", PointRule::Nodes),
        ])?,
        Some(e) => {
            return Err(e.error(
                "quadrature points have no forces of their own in hard contact: there are more of them than nodes that give way",
                "expected \"mortar\" or \"nodes\"",
                "\"mortar\" averages their gaps at the nodes",
            ));
        }
    };
    let settings = PointContact {
        surface: surface(s)?,
        passes: passes(s)?,
        damping: s.number_or("damping_ns_per_m3", 0.0)?,
        reach: s.get("reach_m").map(|e| e.number()).transpose()?,
        ..PointContact::hard(rule)
    };
    checked(settings, law)
}

fn surface(s: &Section<'_>) -> Result<SurfaceKind, SceneError> {
    word_or(
        s,
        "surface",
        &[
            ("smooth", SurfaceKind::Smooth),
            ("faceted", SurfaceKind::Faceted),
        ],
    )
}

fn passes(s: &Section<'_>) -> Result<Passes, SceneError> {
    match s.get("passes") {
        None => Ok(Passes::Auto),
        Some(e) => e.word(&[
            ("first", Passes::First),
            ("second", Passes::Second),
            ("both", Passes::Both),
        ]),
    }
}
