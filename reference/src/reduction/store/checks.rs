//! Consistency checks of a basis that is written or was read.

use super::Meta;
use super::error::{StoreError, StoreErrorKind, unusable, value};
use super::names::{
    ADDED, ADDED_MASS, BODY_CENTRE, BODY_INERTIA, BODY_MASS, COMPLIANCE, FAMILY, HUB, HUB_FLANK,
    HUB_HUB, INERTIA, LATERAL_HUB, MOMENTUM, NODES, NORMALS, OMEGA, PARTICIPATION, ROWS, SHAPES,
    TOOTH, UNBALANCE, YOUNG, sign,
};
use crate::reduction::Basis;
use gearbench_models::Vec3;
use gearbench_models::gear::elastic::reduced::FlankCompliance;
use gearbench_models::geometry::Flanks;

/// Returns the first inconsistency of a basis, if any.
pub(super) fn problem(b: &Basis, meta: &Meta) -> Option<StoreError> {
    let (nodes, rows) = (b.normals.len(), b.directions());
    let modes = b.omega.len();
    let lengths = [
        (FAMILY, b.family.len(), modes),
        (SHAPES, b.shapes.len(), rows.saturating_mul(modes)),
        (HUB, b.hub.len(), modes),
        (MOMENTUM, b.momentum.len(), modes),
        (PARTICIPATION, b.participation.len(), modes),
        (HUB_FLANK, b.compliance.hub.len(), rows),
    ];
    for (array, found, expected) in lengths {
        if found != expected {
            return Some(unusable(
                StoreErrorKind::Shape,
                array,
                format!("{expected} numbers"),
                found.to_string(),
            ));
        }
    }
    if let Some(problem) = lateral_problem(b) {
        return Some(problem);
    }
    if b.integrals.as_ref().is_some_and(|i| !i.fits(modes)) {
        return Some(value(
            "integrals",
            format!("inertia integrals of {modes} modes"),
            "others, or numbers that are not finite",
        ));
    }
    flanks_problem(&b.flanks, nodes, meta.teeth).or_else(|| numbers_problem(b, meta))
}

/// Checks a hub with out-of-plane freedom: lengths, finite numbers, a body.
fn lateral_problem(b: &Basis) -> Option<StoreError> {
    let l = b.lateral.as_ref()?;
    if l.hub.len() != b.omega.len() {
        let found = format!("{} rows", l.hub.len());
        let expected = format!("{} rows", b.omega.len());
        return Some(unusable(
            StoreErrorKind::Shape,
            LATERAL_HUB,
            expected,
            found,
        ));
    }
    let finite: [(&str, &[f64]); 5] = [
        (LATERAL_HUB, l.hub.as_flattened()),
        (BODY_MASS, &[l.mass]),
        (BODY_CENTRE, &l.centre),
        (BODY_INERTIA, &l.inertia),
        (ADDED_MASS, &b.added),
    ];
    for (array, x) in finite {
        if let Some(x) = x.iter().find(|x| !x.is_finite()) {
            return Some(value(array, "finite numbers", x.to_string()));
        }
    }
    let [mass, tilting] = b.added;
    if mass < 0.0 || tilting < 0.0 || mass >= l.mass {
        return Some(value(
            BODY_MASS,
            "a positive mass that holds what is added at the hub",
            format!("{} with {mass} added", l.mass),
        ));
    }
    let least = [0, 4, 8]
        .map(|k| l.inertia[k])
        .into_iter()
        .fold(f64::MAX, f64::min);
    (least <= 0.0).then(|| value(BODY_INERTIA, "positive inertias", least.to_string()))
}

/// Flank nodes are numbered through, tooth by tooth, left before right.
fn flanks_problem(flanks: &Flanks, nodes: usize, teeth: u32) -> Option<StoreError> {
    let mut next = 0_usize;
    let mut last = None;
    for g in flanks.grids() {
        let count = g.rows.checked_mul(g.columns);
        if g.rows < 2 || g.columns < 2 || count.is_none_or(|n| n > nodes - next) {
            return Some(value(
                ROWS,
                format!("at least 2 x 2 nodes per flank and {nodes} in all"),
                format!("{} x {} on tooth {}", g.rows, g.columns, g.tooth),
            ));
        }
        let n = count.unwrap_or(0);
        let numbered = g.nodes.iter().map(|k| *k as usize).eq(next..next + n);
        if !numbered || g.positions.len() != n {
            return Some(value(
                NODES,
                "nodes numbered through, flank by flank",
                format!("others on tooth {}", g.tooth),
            ));
        }
        let place = (g.tooth, -sign(g.side));
        if g.tooth >= teeth || last.is_some_and(|l| l >= place) {
            return Some(value(
                TOOTH,
                format!(
                    "teeth 0 to {} in order, left flanks before right",
                    teeth.saturating_sub(1)
                ),
                format!("tooth {}", g.tooth),
            ));
        }
        last = Some(place);
        next += n;
    }
    (next != nodes || nodes == 0).then(|| {
        value(
            NODES,
            format!("the {next} nodes of the flanks, at least 4"),
            nodes.to_string(),
        )
    })
}

fn numbers_problem(b: &Basis, meta: &Meta) -> Option<StoreError> {
    let (nodes, rows) = (b.normals.len(), b.directions());
    let c = match &b.compliance.flanks {
        FlankCompliance::Full(c) => {
            let expected = rows.checked_mul(rows);
            (expected != Some(c.len())).then(|| format!("({rows}, {rows})"))
        }
        FlankCompliance::Cyclic {
            teeth,
            per_tooth,
            blocks,
        } => {
            let fits = *teeth == meta.teeth as usize
                && teeth.checked_mul(*per_tooth) == Some(rows)
                && rows.checked_mul(*per_tooth) == Some(blocks.len());
            (!fits).then(|| {
                format!(
                    "({0}, {1}, {1})",
                    meta.teeth,
                    rows / (meta.teeth.max(1) as usize)
                )
            })
        }
        FlankCompliance::Deflated(_) => Some("all of it".to_owned()),
    };
    if let Some(expected) = c {
        return Some(unusable(
            StoreErrorKind::Shape,
            COMPLIANCE,
            expected,
            "another shape",
        ));
    }
    let blocks = match &b.compliance.flanks {
        FlankCompliance::Full(c) | FlankCompliance::Cyclic { blocks: c, .. } => c.as_slice(),
        FlankCompliance::Deflated(_) => &[],
    };
    let finite: [(&str, &[f64]); 11] = [
        (OMEGA, &b.omega),
        (SHAPES, &b.shapes),
        (HUB, &b.hub),
        (PARTICIPATION, &b.participation),
        (MOMENTUM, b.momentum.as_flattened()),
        (UNBALANCE, &b.unbalance),
        (COMPLIANCE, blocks),
        (HUB_FLANK, &b.compliance.hub),
        (HUB_HUB, &[b.compliance.hub_hub]),
        (INERTIA, &[b.inertia]),
        (ADDED, &[b.added_inertia]),
    ];
    for (array, x) in finite {
        if let Some(x) = x.iter().find(|x| !x.is_finite()) {
            return Some(value(array, "finite numbers", x.to_string()));
        }
    }
    let own = |node: u32| b.compliance_between(node, node);
    if let Some(c) = (0..nodes as u32).map(own).find(|c| *c <= 0.0) {
        return Some(value(
            COMPLIANCE,
            "a positive compliance of every node at itself",
            c.to_string(),
        ));
    }
    let far = |x: &Vec3| !x.iter().all(|x| x.is_finite());
    if b.flanks.grids().iter().any(|g| g.positions.iter().any(far)) {
        return Some(value(NODES, "finite numbers", "others"));
    }
    let unit = |n: &Vec3| (n.norm() - 1.0).abs() <= 1e-6;
    if let Some(n) = b.normals.iter().find(|n| !unit(n)) {
        return Some(value(
            NORMALS,
            "unit vectors",
            format!("a norm of {}", n.norm()),
        ));
    }
    if let Some(w) = b.omega.iter().find(|w| **w <= 0.0) {
        return Some(value(OMEGA, "positive frequencies", w.to_string()));
    }
    if let Some(w) = b.omega.windows(2).find(|w| w[0] > w[1]) {
        return Some(value(
            OMEGA,
            "ascending frequencies",
            format!("{} after {}", w[1], w[0]),
        ));
    }
    if b.inertia <= 0.0 || b.added_inertia < 0.0 || b.added_inertia > b.inertia {
        return Some(value(
            INERTIA,
            "a positive inertia that holds what is added at the hub",
            format!("{} with {} added", b.inertia, b.added_inertia),
        ));
    }
    meta.material
        .check()
        .err()
        .map(|e| value(YOUNG, "an elastic material", e.to_string()))
}
