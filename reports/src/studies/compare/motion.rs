//! The viewer of moving gears of a comparison: which models it shows, and where it begins.

use crate::drawing::canvas::Ink;
use crate::drawing::style::curve_style;
use crate::markup::gears::{MovingModel, Viewer};
use crate::record::{ContactSnapshot, GearMotion, Outline, Run};
use crate::view::View;

/// Largest number of models next to each other.
const MOST_MODELS: usize = 6;
/// Largest size of the data of all models, in a plane and in space [bytes].
const MOST_BYTES: [usize; 2] = [1_000_000, 3_000_000];
/// Displacement of an axis beyond which it is part of the picture, for example that of a planet [m].
const WANDERS: f64 = 1e-3;

/// True if gears are seen best in space: axes are not parallel, teeth are not straight, or gears are inside one another.
pub fn is_spatial(motion: &GearMotion) -> bool {
    let wanders = motion.paths.iter().any(|p| {
        let moved = p
            .shift_m
            .as_ref()
            .map_or(0.0, |q| q.step * 2f64.powi(q.bits.into()));
        moved > WANDERS
    });
    !motion.is_plane()
        || motion.bodies.iter().any(|b| b.is_internal)
        || (wanders && motion.bodies.len() > 2)
}

/// Returns the contact snapshot of a run with the outlines of its gears: those of the motion, in records of former
/// versions those of the snapshot.
pub fn still(run: &Run) -> Option<ContactSnapshot> {
    let Some(motion) = &run.motion else {
        return run.contacts.clone();
    };
    let mut snapshot = run.contacts.clone().unwrap_or_else(|| ContactSnapshot {
        time_s: motion.time_s.first().copied().unwrap_or(0.0),
        ..ContactSnapshot::default()
    });
    let frame = motion.nearest(snapshot.time_s)?;
    let dot = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| a[k] * b[k]).sum::<f64>();
    for (body, path) in motion.bodies.iter().zip(&motion.paths) {
        let pose = *path.poses().ok()?.get(frame)?;
        let middle = body.heights_m.len() / 2;
        let height = if body.is_prism {
            0.0
        } else {
            body.heights_m[middle]
        };
        let places = body.outline(middle).ok()?.into_iter().map(|[x, y]| {
            let p = pose.point([x, y, height]);
            [0, 1].map(|k| dot(motion.view[k], p))
        });
        snapshot.outlines.push(Outline {
            gear: body.gear.clone(),
            points: places.collect(),
        });
    }
    Some(snapshot)
}

/// Size of the data of a motion in the page, without its bodies [bytes].
fn bytes(motion: &GearMotion) -> usize {
    let of_teeth = motion
        .teeth
        .iter()
        .map(|t| t.displacements_m.data.len() + 4 * t.teeth.len());
    let of_paths = (motion.paths.iter()).map(|p| {
        let further = [&p.shift_m, &p.tilt]
            .into_iter()
            .flatten()
            .map(|q| q.data.len());
        p.turn_rad.data.len() + further.sum::<usize>()
    });
    let c = &motion.contacts;
    let of_contacts = [
        &c.points_m,
        &c.forces_n,
        &c.widths_m,
        &c.half_widths_m,
        &c.values,
    ];
    of_teeth.sum::<usize>()
        + of_paths.sum::<usize>()
        + of_contacts.map(|q| q.data.len()).iter().sum::<usize>()
        + 14 * c.meshes.len()
        + 20 * motion.time_s.len()
}

/// Returns the viewer and the labels of the models that do not fit into it; `None` of a record without motions.
pub fn viewer(view: &View<'_>, chart: &str) -> Option<(Viewer, Vec<String>)> {
    let mut models: Vec<MovingModel<'_>> = Vec::new();
    let mut left_out = Vec::new();
    let mut sum = 0;
    let mut spatial = false;
    let mut start_s = None;
    for group in &view.groups {
        let with_motion = |run: &&Run| run.motion.as_ref().is_some_and(|m| !m.time_s.is_empty());
        let Some(run) = group.runs.iter().map(|(_, run)| *run).find(with_motion) else {
            continue;
        };
        let Some(motion) = &run.motion else { continue };
        spatial |= is_spatial(motion);
        sum += bytes(motion);
        if !models.is_empty()
            && (models.len() == MOST_MODELS || sum > MOST_BYTES[usize::from(spatial)])
        {
            left_out.push(group.label.clone());
            continue;
        }
        start_s = start_s.or(run.contacts.as_ref().map(|c| c.time_s));
        let Ink(r, g, b, _) = curve_style(group.style).ink;
        models.push(MovingModel {
            label: &group.label,
            integrator: &run.integrator,
            ink: format!("#{r:02x}{g:02x}{b:02x}"),
            motion,
        });
    }
    let start = start_s.unwrap_or(0.0);
    let viewer = (!models.is_empty()).then(|| Viewer::new(chart, &models, (spatial, start)))?;
    Some((viewer, left_out))
}
