//! Assignment of the data of a basis to arrays.

use super::archive::{Axis, Reader, Writer};
use super::error::{StoreError, value};
use super::meta::{self, Entries};
use super::names::{
    ADDED, COLUMNS, COMPLIANCE, DENSITY, FAMILY, HUB, HUB_FLANK, HUB_HUB, INERTIA, META, MOMENTUM,
    NEAR_FIELD, NODES, NORMALS, OMEGA, PARTICIPATION, POISSON, ROWS, SHAPES, SIDE, TOOTH,
    UNBALANCE, YOUNG, sign,
};
use super::{Meta, Motion, Stored, checks, inertia, out_of_plane};
use crate::reduction::Basis;
use gearbench_models::Vec3;
use gearbench_models::gear::elastic::reduced::{FlankCompliance, Residual};
use gearbench_models::geometry::{FlankGrid, Flanks, Side};
use gearbench_models::stiffness::Material;
use std::io::{self, Write};
use std::sync::Arc;

/// Writes all arrays.
pub(super) fn write<W: Write>(out: W, b: &Basis, meta: &Meta) -> io::Result<W> {
    let (nodes, rows, modes) = (b.normals.len(), b.directions(), b.omega.len());
    let grids = b.flanks.grids();
    let mut w = Writer::new(out);
    w.bytes(META, meta::text(b, meta).as_bytes())?;
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
    w.f64s(SHAPES, &[rows, modes], b.shapes.iter().copied())?;
    w.f64s(HUB, &[modes], b.hub.iter().copied())?;
    w.f64s(PARTICIPATION, &[modes], b.participation.iter().copied())?;
    let momentum = b.momentum.iter().flatten().copied();
    w.f64s(MOMENTUM, &[modes, 2], momentum)?;
    w.f64s(UNBALANCE, &[2], b.unbalance.iter().copied())?;
    let (shape, blocks) = match &b.compliance.flanks {
        FlankCompliance::Full(c) => (vec![rows, rows], c),
        FlankCompliance::Cyclic {
            teeth,
            per_tooth,
            blocks,
        } => (vec![*teeth, *per_tooth, *per_tooth], blocks),
        FlankCompliance::Deflated(_) => {
            return Err(io::Error::other(
                "a basis holds the compliance of the whole mesh, but modes were taken from this one",
            ));
        }
    };
    w.f64s(COMPLIANCE, &shape, blocks.iter().copied())?;
    w.f64s(HUB_FLANK, &[rows], b.compliance.hub.iter().copied())?;
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
    if let Some(fields) = &b.near_field {
        let numbers: usize = fields.iter().map(Vec::len).sum();
        w.f64s(NEAR_FIELD, &[numbers], fields.iter().flatten().copied())?;
    }
    if let Some(integrals) = &b.integrals {
        inertia::write(&mut w, integrals)?;
    }
    if let Some(l) = &b.lateral {
        out_of_plane::write(&mut w, l, b.added)?;
    }
    w.finish()
}

fn vectors(x: &[f64]) -> Vec<Vec3> {
    x.chunks_exact(3).map(Vec3::from_column_slice).collect()
}

/// Reads the arrays and finds them fit.
pub(super) fn read(r: &Reader<'_>) -> Result<Stored, StoreError> {
    let entries = Entries::read(&r.bytes(META)?)?;
    let teeth = entries.count("teeth")?;
    let (shape, positions) = r.f64s(NODES, &[Axis::Any("flank nodes"), Axis::Is(3)])?;
    let nodes = shape[0];
    let along_profile = entries.flag(meta::ALONG_PROFILE) == Some(true);
    let rows = nodes * (1 + usize::from(along_profile));
    let (_, normals) = r.f64s(NORMALS, &[Axis::Is(nodes), Axis::Is(3)])?;
    let flanks = read_flanks(r, &vectors(&positions))?;
    let (_, omega) = r.f64s(OMEGA, &[Axis::Any("modes")])?;
    let modes = omega.len();
    let family = r.i64s(FAMILY, Axis::Is(modes))?;
    if let Some(f) = family.iter().find(|f| **f < 0) {
        return Err(value(FAMILY, "numbers of families from 0", f.to_string()));
    }
    let near_field = match entries.flag(meta::NEAR_FIELD) {
        Some(true) => Some(Arc::new(read_near_field(r, &flanks)?)),
        _ => None,
    };
    let (lateral, added) = match entries.flag(meta::LATERAL) {
        Some(true) => {
            let (lateral, added) = out_of_plane::read(r, modes)?;
            (Some(Arc::new(lateral)), added)
        }
        _ => (None, [0.0; 2]),
    };
    let basis = Basis {
        flanks,
        lateral,
        added,
        near_field,
        normals: vectors(&normals),
        along_profile,
        free: entries.word("mount", &[("free", true), ("held", false)])?,
        inertia: r.number(INERTIA)?,
        added_inertia: r.number(ADDED)?,
        unknowns: entries.count("unknowns")?,
        omega,
        family: family.into_iter().map(|f| f as u32).collect(),
        shapes: r.f64s(SHAPES, &[Axis::Is(rows), Axis::Is(modes)])?.1,
        hub: r.f64s(HUB, &[Axis::Is(modes)])?.1,
        participation: r.f64s(PARTICIPATION, &[Axis::Is(modes)])?.1,
        momentum: (r
            .f64s(MOMENTUM, &[Axis::Is(modes), Axis::Is(2)])?
            .1
            .as_chunks()
            .0)
            .to_vec(),
        unbalance: {
            let x = r.f64s(UNBALANCE, &[Axis::Is(2)])?.1;
            [x[0], x[1]]
        },
        compliance: read_compliance(r, rows, teeth)?,
        integrals: match entries.flag("integrals") {
            Some(true) => Some(Arc::new(inertia::read(r, modes)?)),
            _ => None,
        },
    };
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
        element: entries.kinds("element")?,
        teeth: teeth as u32,
        nodes: entries.count("nodes")?,
        elements: entries.count("elements")?,
        asked: entries.text("asked")?,
    };
    match checks::problem(&basis, &meta) {
        Some(problem) => Err(problem),
        None => Ok(Stored {
            basis: Arc::new(basis),
            meta,
        }),
    }
}

/// Static compliance: of all nodes in all their directions, or three axes deep by teeth.
fn read_compliance(r: &Reader<'_>, rows: usize, teeth: usize) -> Result<Residual, StoreError> {
    let flanks = if r.axes(COMPLIANCE)? == 3 {
        let per_tooth = rows / teeth.max(1);
        let axes = [teeth, per_tooth, per_tooth].map(Axis::Is);
        FlankCompliance::Cyclic {
            teeth,
            per_tooth,
            blocks: r.f64s(COMPLIANCE, &axes)?.1,
        }
    } else {
        FlankCompliance::Full(r.f64s(COMPLIANCE, &[Axis::Is(rows); 2])?.1)
    };
    Ok(Residual {
        flanks,
        hub: r.f64s(HUB_FLANK, &[Axis::Is(rows)])?.1,
        hub_hub: r.number(HUB_HUB)?,
    })
}

/// Reads the displacements of rows of nodes under line loads, flank by flank.
fn read_near_field(r: &Reader<'_>, flanks: &Flanks) -> Result<Vec<Vec<f64>>, StoreError> {
    let sizes = flanks.grids().iter().map(|g| g.rows.saturating_mul(g.rows));
    let all = sizes.clone().fold(0, usize::saturating_add);
    let (_, numbers) = r.f64s(NEAR_FIELD, &[Axis::Is(all)])?;
    let mut rest = numbers.as_slice();
    let of_flank = |n: usize| {
        let (own, others) = rest.split_at(n);
        rest = others;
        own.to_vec()
    };
    Ok(sizes.map(of_flank).collect())
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
