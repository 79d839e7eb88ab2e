//! Refuses counts, ratios and webs that no mesh can have.

use super::error::MeshError;
use super::params::{GearMeshParams, Tooth, Web};
use crate::mesh::ElementKind;
use gearbench_models::geometry::Gear;

/// Greatest count of anything.
const MOST: usize = 1000;

fn check_count(
    what: &'static str,
    value: usize,
    least: usize,
    expected: &'static str,
) -> Result<(), MeshError> {
    if (least..=MOST).contains(&value) {
        Ok(())
    } else {
        Err(MeshError::Invalid {
            what,
            value: value as f64,
            expected,
        })
    }
}

fn check_tooth(tooth: Tooth) -> Result<(), MeshError> {
    check_count("elements along the flank", tooth.flank, 1, "1 to 1000")?;
    check_count("elements along the fillet", tooth.fillet, 2, "2 to 1000")?;
    check_count("elements on the root arc", tooth.root, 1, "1 to 1000")?;
    check_count(
        "elements across the tooth",
        tooth.across,
        3,
        "3 to 1000: a skin on both sides and a core",
    )
}

/// Checks that the elements are hexahedra.
pub(super) fn check_kind(kind: ElementKind) -> Result<(), MeshError> {
    if ElementKind::HEXAHEDRA.contains(&kind) {
        return Ok(());
    }
    Err(MeshError::NoHexahedron {
        kind: kind.name(),
        known: ElementKind::HEXAHEDRA.map(ElementKind::name).join(", "),
    })
}

/// Checks all counts and gives the layers of the skin that every tooth has room for.
pub(super) fn check_counts(p: &GearMeshParams) -> Result<usize, MeshError> {
    check_count("layers of the skin", p.layers, 1, "1 to 1000")?;
    check_count("layers of the rim", p.rim, 1, "1 to 1000")?;
    check_count("layers over the width", p.width, 1, "1 to 1000")?;
    let mut across = p.tooth.across;
    check_tooth(p.tooth)?;
    if let Some(f) = &p.fine_teeth {
        check_tooth(f.others)?;
        across = across.min(f.others.across);
    }
    Ok(p.layers.min((across - 1) / 2))
}

pub(super) fn check_ratios(p: &GearMeshParams) -> Result<(), MeshError> {
    for (what, value) in [
        ("grading of the flank", p.flank_grading),
        ("growth in the skin", p.skin_growth),
        ("growth in the rim", p.rim_growth.unwrap_or(1.0)),
    ] {
        if !(0.1..=10.0).contains(&value) {
            return Err(MeshError::Invalid {
                what,
                value,
                expected: "a ratio from 0.1 to 10; 1 is uniform",
            });
        }
    }
    let Some(focus) = p.flank_focus else {
        return Ok(());
    };
    for (what, value, least) in [
        ("place of the focus", focus.place, 0.0),
        ("reach of the focus", focus.reach, 1e-6),
    ] {
        if !(least..=1.0).contains(&value) {
            return Err(MeshError::Invalid {
                what,
                value,
                expected: "a part of the flank, at most 1 (the reach above 0)",
            });
        }
    }
    Ok(())
}

pub(super) fn check_web(w: &Web, gear: &Gear, width: usize) -> Result<(), MeshError> {
    check_count("layers of the web", w.layers, 1, "1 to 1000")?;
    check_count("layers of the hub", w.hub_layers, 1, "1 to 1000")?;
    check_count(
        "layers over the width of a gear with a web",
        width,
        3,
        "3 to 1000",
    )?;
    let (low, high, b) = (gear.seat_radius(), gear.r_root(), gear.face_width());
    let fits = low < w.inner_radius
        && w.inner_radius < w.outer_radius
        && w.outer_radius < high
        && w.thickness > 0.0
        && w.thickness < b;
    if fits {
        Ok(())
    } else {
        Err(MeshError::Web {
            inner: w.inner_radius,
            outer: w.outer_radius,
            thickness: w.thickness,
            low,
            high,
            width: b,
        })
    }
}
