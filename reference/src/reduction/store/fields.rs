//! Which array holds what, and what has to fit.

use super::archive::{Axis, Reader, Writer};
use super::error::{MAKE_AGAIN, StoreError, StoreErrorKind};
use super::{Meta, Motion, SCHEMA, Stored, inertia};
use crate::mesh::ElementKind;
use crate::reduction::Basis;
use crate::reduction::hash::Hash;
use gearbench_models::Vec3;
use gearbench_models::gear::elastic::reduced::{FlankCompliance, Residual};
use gearbench_models::geometry::{FlankGrid, Flanks, Side};
use gearbench_models::stiffness::Material;
use serde_json::{Value, json};
use std::io::{self, Write};
use std::sync::Arc;

const META: &str = "meta";
const TOOTH: &str = "flank_tooth";
const SIDE: &str = "flank_side";
const ROWS: &str = "flank_rows";
const COLUMNS: &str = "flank_columns";
const NODES: &str = "flank_nodes_m";
const NORMALS: &str = "flank_normals";
const OMEGA: &str = "omega_rad_s";
const FAMILY: &str = "mode_family";
const SHAPES: &str = "shapes_per_sqrt_kg";
const HUB: &str = "hub_shapes";
const PARTICIPATION: &str = "participation";
const MOMENTUM: &str = "modal_momentum_sqrt_kg";
const UNBALANCE: &str = "unbalance_kg_m";
const COMPLIANCE: &str = "flank_compliance_m_per_n";
const HUB_FLANK: &str = "hub_flank_compliance";
const HUB_HUB: &str = "hub_compliance";
const INERTIA: &str = "inertia";
const ADDED: &str = "added_inertia";
const YOUNG: &str = "young_pa";
const POISSON: &str = "poisson";
const DENSITY: &str = "density_kg_m3";

/// Most flank nodes, modes or teeth that a file may name.
const MOST: usize = u32::MAX as usize;

fn value(array: &str, expected: impl Into<String>, found: impl Into<String>) -> StoreError {
    StoreError::new(StoreErrorKind::Value, array, expected, found, MAKE_AGAIN)
}

fn sign(side: Side) -> i64 {
    match side {
        Side::Left => 1,
        Side::Right => -1,
    }
}

/// What of a basis does not fit together, if anything.
pub(super) fn problem(b: &Basis, meta: &Meta) -> Option<StoreError> {
    let nodes = b.normals.len();
    let modes = b.omega.len();
    let lengths = [
        (FAMILY, b.family.len(), modes),
        (SHAPES, b.shapes.len(), nodes.saturating_mul(modes)),
        (HUB, b.hub.len(), modes),
        (MOMENTUM, b.momentum.len(), modes),
        (PARTICIPATION, b.participation.len(), modes),
        (HUB_FLANK, b.compliance.hub.len(), nodes),
    ];
    for (array, found, expected) in lengths {
        if found != expected {
            return Some(StoreError::new(
                StoreErrorKind::Shape,
                array,
                format!("{expected} numbers"),
                found.to_string(),
                MAKE_AGAIN,
            ));
        }
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
    let nodes = b.normals.len();
    let c = match &b.compliance.flanks {
        FlankCompliance::Full(c) => {
            let expected = nodes.checked_mul(nodes);
            (expected != Some(c.len())).then(|| format!("({nodes}, {nodes})"))
        }
        FlankCompliance::Cyclic {
            teeth,
            per_tooth,
            blocks,
        } => {
            let fits = *teeth == meta.teeth as usize
                && teeth.checked_mul(*per_tooth) == Some(nodes)
                && nodes.checked_mul(*per_tooth) == Some(blocks.len());
            (!fits).then(|| {
                format!(
                    "({0}, {1}, {1})",
                    meta.teeth,
                    nodes / (meta.teeth.max(1) as usize)
                )
            })
        }
    };
    if let Some(expected) = c {
        return Some(StoreError::new(
            StoreErrorKind::Shape,
            COMPLIANCE,
            expected,
            "another shape",
            MAKE_AGAIN,
        ));
    }
    let blocks = match &b.compliance.flanks {
        FlankCompliance::Full(c) | FlankCompliance::Cyclic { blocks: c, .. } => c,
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

/// Writes the arrays.
pub(super) fn write<W: Write>(out: W, b: &Basis, meta: &Meta) -> io::Result<W> {
    let (nodes, modes) = (b.normals.len(), b.omega.len());
    let grids = b.flanks.grids();
    let mut w = Writer::new(out);
    w.bytes(META, meta_text(b, meta).as_bytes())?;
    let flanks = [grids.len()];
    w.i64s(TOOTH, &flanks, grids.iter().map(|g| i64::from(g.tooth)))?;
    w.i64s(SIDE, &flanks, grids.iter().map(|g| sign(g.side)))?;
    w.i64s(ROWS, &flanks, grids.iter().map(|g| g.rows as i64))?;
    w.i64s(COLUMNS, &flanks, grids.iter().map(|g| g.columns as i64))?;
    let positions = grids.iter().flat_map(|g| &g.positions);
    let coordinates = |x: &Vec3| [x.x, x.y, x.z];
    w.f64s(NODES, &[nodes, 3], positions.flat_map(coordinates))?;
    w.f64s(NORMALS, &[nodes, 3], b.normals.iter().flat_map(coordinates))?;
    w.f64s(OMEGA, &[modes], b.omega.iter().copied())?;
    w.i64s(FAMILY, &[modes], b.family.iter().map(|f| i64::from(*f)))?;
    w.f64s(SHAPES, &[nodes, modes], b.shapes.iter().copied())?;
    w.f64s(HUB, &[modes], b.hub.iter().copied())?;
    w.f64s(PARTICIPATION, &[modes], b.participation.iter().copied())?;
    let momentum = b.momentum.iter().flatten().copied();
    w.f64s(MOMENTUM, &[modes, 2], momentum)?;
    w.f64s(UNBALANCE, &[2], b.unbalance.iter().copied())?;
    let (shape, blocks) = match &b.compliance.flanks {
        FlankCompliance::Full(c) => (vec![nodes, nodes], c),
        FlankCompliance::Cyclic {
            teeth,
            per_tooth,
            blocks,
        } => (vec![*teeth, *per_tooth, *per_tooth], blocks),
    };
    w.f64s(COMPLIANCE, &shape, blocks.iter().copied())?;
    w.f64s(HUB_FLANK, &[nodes], b.compliance.hub.iter().copied())?;
    for (name, x) in [
        (HUB_HUB, b.compliance.hub_hub),
        (INERTIA, b.inertia),
        (ADDED, b.added_inertia),
        (YOUNG, meta.material.young),
        (POISSON, meta.material.poisson),
        (DENSITY, meta.material.density),
    ] {
        w.f64s(name, &[], std::iter::once(x))?;
    }
    if let Some(integrals) = &b.integrals {
        inertia::write(&mut w, integrals)?;
    }
    w.finish()
}

fn meta_text(b: &Basis, meta: &Meta) -> String {
    json!({
        "format": "gearbench reduction",
        "schema": SCHEMA,
        "program": meta.program,
        "source": meta.source,
        "mesh": meta.mesh.to_string(),
        "key": meta.key.to_string(),
        "mount": if b.free { "free" } else { "held" },
        "motion": match meta.motion {
            Motion::Turn => "turn",
            Motion::Slide => "slide",
        },
        "element": meta.element.name(),
        "teeth": meta.teeth,
        "nodes": meta.nodes,
        "elements": meta.elements,
        "unknowns": b.unknowns,
        "asked": meta.asked,
        "integrals": b.integrals.is_some(),
    })
    .to_string()
}

/// Entries of `meta`.
struct Entries(Value);

impl Entries {
    fn read(bytes: &[u8]) -> Result<Self, StoreError> {
        let text = serde_json::from_slice(bytes);
        let entries = Entries(text.map_err(|e| value(META, "JSON text", e.to_string()))?);
        match entries.0.get("schema").and_then(Value::as_u64) {
            Some(SCHEMA) => Ok(entries),
            Some(newer) if newer > SCHEMA => Err(StoreError::new(
                StoreErrorKind::Newer,
                META,
                format!("schema {SCHEMA}"),
                format!("schema {newer}"),
                "a newer gearbench reads it; or make it again with this one: `gearbench reduce`",
            )),
            other => Err(value(
                META,
                format!("schema {SCHEMA}"),
                other.map_or("none".to_owned(), |s| format!("schema {s}")),
            )),
        }
    }

    fn get<T>(
        &self,
        name: &str,
        what: &str,
        as_t: impl Fn(&Value) -> Option<T>,
    ) -> Result<T, StoreError> {
        let found = self.0.get(name);
        found.and_then(as_t).ok_or_else(|| {
            StoreError::new(
                match found {
                    Some(_) => StoreErrorKind::Value,
                    None => StoreErrorKind::Missing,
                },
                META,
                format!("`{name}`, {what}"),
                found.map_or("no such entry".to_owned(), |v| {
                    v.to_string().chars().take(60).collect()
                }),
                MAKE_AGAIN,
            )
        })
    }

    fn text(&self, name: &str) -> Result<String, StoreError> {
        self.get(name, "a text", |v| v.as_str().map(str::to_owned))
    }

    fn count(&self, name: &str) -> Result<usize, StoreError> {
        self.get(name, "a count", |v| {
            v.as_u64().filter(|n| *n <= MOST as u64).map(|n| n as usize)
        })
    }

    fn word<T: Copy>(&self, name: &str, words: &[(&str, T)]) -> Result<T, StoreError> {
        let known: Vec<&str> = words.iter().map(|w| w.0).collect();
        self.get(name, &format!("one of {}", known.join(", ")), |v| {
            let text = v.as_str()?;
            words.iter().find(|w| w.0 == text).map(|w| w.1)
        })
    }

    fn hash(&self, name: &str) -> Result<Hash, StoreError> {
        self.get(name, "32 hexadecimal digits", |v| {
            v.as_str().and_then(Hash::from_hex)
        })
    }
}

fn pairs(x: &[f64]) -> Vec<[f64; 2]> {
    x.chunks_exact(2).map(|x| [x[0], x[1]]).collect()
}

fn vectors(x: &[f64]) -> Vec<Vec3> {
    x.chunks_exact(3)
        .map(|x| Vec3::new(x[0], x[1], x[2]))
        .collect()
}

/// Reads the arrays and finds them fit.
pub(super) fn read(r: &Reader<'_>) -> Result<Stored, StoreError> {
    let entries = Entries::read(&r.bytes(META)?)?;
    let teeth = entries.count("teeth")?;
    let (shape, positions) = r.f64s(NODES, &[Axis::Any("flank nodes"), Axis::Is(3)])?;
    let nodes = shape[0];
    let (_, normals) = r.f64s(NORMALS, &[Axis::Is(nodes), Axis::Is(3)])?;
    let flanks = read_flanks(r, &vectors(&positions))?;
    let (_, omega) = r.f64s(OMEGA, &[Axis::Any("modes")])?;
    let modes = omega.len();
    let family = r.i64s(FAMILY, Axis::Is(modes))?;
    if let Some(f) = family.iter().find(|f| **f < 0) {
        return Err(value(FAMILY, "numbers of families from 0", f.to_string()));
    }
    let basis = Basis {
        flanks,
        normals: vectors(&normals),
        free: entries.word("mount", &[("free", true), ("held", false)])?,
        inertia: r.number(INERTIA)?,
        added_inertia: r.number(ADDED)?,
        unknowns: entries.count("unknowns")?,
        omega,
        family: family.into_iter().map(|f| f as u32).collect(),
        shapes: r.f64s(SHAPES, &[Axis::Is(nodes), Axis::Is(modes)])?.1,
        hub: r.f64s(HUB, &[Axis::Is(modes)])?.1,
        participation: r.f64s(PARTICIPATION, &[Axis::Is(modes)])?.1,
        momentum: pairs(&r.f64s(MOMENTUM, &[Axis::Is(modes), Axis::Is(2)])?.1),
        unbalance: {
            let x = r.f64s(UNBALANCE, &[Axis::Is(2)])?.1;
            [x[0], x[1]]
        },
        compliance: read_compliance(r, nodes, teeth)?,
        integrals: match entries.0.get("integrals").and_then(Value::as_bool) {
            Some(true) => Some(Arc::new(inertia::read(r, modes)?)),
            _ => None,
        },
    };
    let elements = ElementKind::ALL.map(|k| (k.name(), k));
    let meta = Meta {
        program: entries.text("program")?,
        source: entries.text("source")?,
        mesh: entries.hash("mesh")?,
        key: entries.hash("key")?,
        motion: entries.word(
            "motion",
            &[("turn", Motion::Turn), ("slide", Motion::Slide)],
        )?,
        material: Material {
            young: r.number(YOUNG)?,
            poisson: r.number(POISSON)?,
            density: r.number(DENSITY)?,
        },
        element: entries.word("element", &elements)?,
        teeth: teeth as u32,
        nodes: entries.count("nodes")?,
        elements: entries.count("elements")?,
        asked: entries.text("asked")?,
    };
    match problem(&basis, &meta) {
        Some(problem) => Err(problem),
        None => Ok(Stored {
            basis: Arc::new(basis),
            meta,
        }),
    }
}

/// Static compliance: of all nodes, or three axes deep by teeth.
fn read_compliance(r: &Reader<'_>, nodes: usize, teeth: usize) -> Result<Residual, StoreError> {
    let flanks = if r.axes(COMPLIANCE)? == 3 {
        let per_tooth = nodes / teeth.max(1);
        let axes = [teeth, per_tooth, per_tooth].map(Axis::Is);
        FlankCompliance::Cyclic {
            teeth,
            per_tooth,
            blocks: r.f64s(COMPLIANCE, &axes)?.1,
        }
    } else {
        FlankCompliance::Full(r.f64s(COMPLIANCE, &[Axis::Is(nodes); 2])?.1)
    };
    Ok(Residual {
        flanks,
        hub: r.f64s(HUB_FLANK, &[Axis::Is(nodes)])?.1,
        hub_hub: r.number(HUB_HUB)?,
    })
}

/// Grids of nodes that are numbered through.
fn read_flanks(r: &Reader<'_>, positions: &[Vec3]) -> Result<Flanks, StoreError> {
    let tooth = r.i64s(TOOTH, Axis::Any("flanks"))?;
    let count = Axis::Is(tooth.len());
    let (side, rows, columns) = (
        r.i64s(SIDE, count)?,
        r.i64s(ROWS, count)?,
        r.i64s(COLUMNS, count)?,
    );
    let mut grids = Vec::with_capacity(tooth.len());
    let mut first = 0_usize;
    for (((&tooth, &side), &rows), &columns) in tooth.iter().zip(&side).zip(&rows).zip(&columns) {
        let side = match side {
            1 => Side::Left,
            -1 => Side::Right,
            other => return Err(value(SIDE, "1 (left) or -1 (right)", other.to_string())),
        };
        let n = (rows >= 2 && columns >= 2)
            .then(|| (rows as usize).checked_mul(columns as usize))
            .flatten();
        let after = n
            .and_then(|n| first.checked_add(n))
            .filter(|after| *after <= positions.len());
        let (Ok(tooth), Some(after)) = (u32::try_from(tooth), after) else {
            return Err(value(
                ROWS,
                format!(
                    "at least 2 x 2 nodes per flank and {} in all",
                    positions.len()
                ),
                format!("{rows} x {columns} on tooth {tooth}"),
            ));
        };
        grids.push(FlankGrid {
            tooth,
            side,
            rows: rows as usize,
            columns: columns as usize,
            nodes: (first as u32..after as u32).collect(),
            positions: positions[first..after].to_vec(),
        });
        first = after;
    }
    Ok(Flanks::new(grids))
}
