//! Stored reductions in a scene: opened once, and compared with the gear that uses them. All studies of a process share
//! what is open: a file that has changed is opened again, so that none of them can see the content of another time.

use super::Toothing;
use super::mounting::mount_text;
use super::of_gear::{added_of, free_in_own_frame};
use super::store::{self, Motion, StoreError, Stored};
use gearbench_models::gear::table::GearContext;
use gearbench_models::spec::Body;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::SystemTime;

/// A file as it was when it was opened.
type Version = (PathBuf, Option<SystemTime>, u64);

static OPEN: Mutex<Option<HashMap<Version, Arc<Stored>>>> = Mutex::new(None);

/// Reads a file, or returns its content from an earlier call if it has not changed since.
pub fn open(path: &Path) -> Result<Arc<Stored>, StoreError> {
    let data = std::fs::metadata(path).ok();
    let version = (
        path.to_owned(),
        data.as_ref().and_then(|d| d.modified().ok()),
        data.map_or(0, |d| d.len()),
    );
    let mut all = OPEN.lock().unwrap_or_else(PoisonError::into_inner);
    let all = all.get_or_insert_default();
    if let Some(stored) = all.get(&version) {
        return Ok(stored.clone());
    }
    let stored = Arc::new(store::read_body(path)?);
    all.insert(version, stored.clone());
    Ok(stored)
}

/// Radii and widths of mesh and gear may differ by this part of the module.
const NEAR: f64 = 0.1;
/// Base radii may differ by this fraction: the normals of a coarse mesh are no better.
const NEAR_BASE: f64 = 0.01;

/// Inertias may differ by this factor.
const OTHER_BODY: f64 = 20.0;

/// Returns the first property of a stored reduction that does not suit a gear, with a remedy after a semicolon.
pub fn misfit(stored: &Stored, context: &GearContext<'_>) -> Option<String> {
    let (meta, basis) = (&stored.meta, &stored.basis);
    let (motion, teeth, tip, base, width, module) = match context.body {
        Body::Gear(g) => (
            Motion::Turn,
            g.teeth(),
            g.r_tip(),
            g.r_base(),
            g.face_width(),
            g.transverse_module(),
        ),
        Body::Rack(r) => (
            Motion::Slide,
            r.teeth(),
            r.tip_height(),
            0.5 * r.base_pitch() / std::f64::consts::PI,
            r.face_width(),
            r.pitch() / std::f64::consts::PI,
        ),
    };
    let kind = |m: Motion| match m {
        Motion::Turn => "gear",
        Motion::Slide => "rack",
    };
    let name = context.name;
    if (motion, teeth) != (meta.motion, meta.teeth) {
        return Some(format!(
            "it is of a {} with {} teeth, but `{name}` is a {} with {teeth}; reduce the mesh of this gear",
            kind(meta.motion),
            meta.teeth,
            kind(motion)
        ));
    }
    let shown = Toothing::of(basis, motion, teeth);
    let lengths = [
        ("tip radius", shown.tip, tip, NEAR * module),
        ("base radius", shown.base, base, NEAR_BASE * base),
        ("face width", shown.width, width, NEAR * module),
    ];
    for (what, found, expected, near) in lengths {
        let off = (found - expected).abs();
        if off.is_nan() || off > near {
            return Some(format!(
                "its {what} is {:.4} mm, that of `{name}` {:.4} mm; reduce the mesh of this gear, or give the scene the \
                 data of the mesh",
                1e3 * found,
                1e3 * expected
            ));
        }
    }
    let free = (context.hub.is_free(), free_in_own_frame(context));
    let of_basis = (
        basis.free,
        basis.lateral.as_ref().map_or([false; 6], |l| l.free),
    );
    if free != of_basis {
        let [own, of] = [free, of_basis].map(|(free, lateral)| mount_text(free, &lateral));
        let shown = |mount: &str| mount.replace(',', ", ");
        return Some(format!(
            "its hub is {}, but the mount of `{name}` leaves it {}; reduce the gear with `--mount {own}`",
            shown(&of),
            shown(&own)
        ));
    }
    let off = (basis.added_inertia - context.added_inertia).abs();
    if off > 1e-6 * basis.inertia {
        return Some(format!(
            "{:e} is added to its hub, but {:e} to that of `{name}`; reduce the gear with `--added-inertia {:e}`",
            basis.added_inertia, context.added_inertia, context.added_inertia
        ));
    }
    // A body may have a web, a rim or a shaft that the scene does not describe, but not be another one.
    let own = basis.inertia - basis.added_inertia;
    let density = context.material.density;
    let (of_gear, unit) = match context.body {
        Body::Gear(g) => (
            g.mass_properties(density).izz + g.core_inertia(density),
            "kg m^2",
        ),
        Body::Rack(_) => (context.body.mass(density), "kg"),
    };
    if own > OTHER_BODY * of_gear || own < of_gear / OTHER_BODY {
        return Some(format!(
            "its inertia is {own:.3e} {unit}, that of the body of `{name}` about {of_gear:.3e} {unit}; reduce the mesh of this gear"
        ));
    }
    if let Some(lateral) = &basis.lateral {
        let [mass, tilting] = match added_of(context) {
            Ok(added) => added,
            Err(e) => return Some(e.reason.to_string()),
        };
        let off = (basis.added[0] - mass).abs() > 1e-6 * lateral.mass
            || (basis.added[1] - tilting).abs() > 1e-6 * lateral.inertia[0];
        if off {
            return Some(format!(
                "{:e} kg and {:e} kg m^2 across its axis are added to its hub, but {mass:e} and {tilting:e} to that of `{name}`; \
                 reduce the gear with `--added-mass {mass:e} --added-tilting {tilting:e}`",
                basis.added[0], basis.added[1]
            ));
        }
    }
    let (a, b) = (&meta.material, &context.material);
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-3 * a.abs().max(b.abs());
    if !(near(a.young, b.young) && near(a.poisson, b.poisson) && near(a.density, b.density)) {
        return Some(format!(
            "its material has E = {:e} Pa, nu = {}, {} kg/m^3, that of `{name}` {:e} Pa, {}, {} kg/m^3; give the gear \
             `material = {{ young_pa = {:e}, poisson = {}, density_kg_m3 = {} }}`",
            a.young,
            a.poisson,
            a.density,
            b.young,
            b.poisson,
            b.density,
            a.young,
            a.poisson,
            a.density
        ));
    }
    None
}

#[cfg(test)]
mod tests;
