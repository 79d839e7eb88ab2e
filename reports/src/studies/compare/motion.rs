//! The viewer of moving gears of a comparison: which models it shows, and where it begins.

use crate::markup::gears::{MovingModel, Viewer};
use crate::record::{ContactSnapshot, Outline, Run};
use crate::view::{Group, View};

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

/// Returns the viewer and the labels of the models that do not fit into it; `None` of a record without motions.
pub fn viewer(view: &View<'_>, chart: &str) -> Option<(Viewer, Vec<String>)> {
    let with_motion = |run: &&Run| run.motion.as_ref().is_some_and(|m| !m.time_s.is_empty());
    let runs: Vec<(&Group<'_>, &Run)> = (view.groups.iter())
        .filter_map(|group| {
            let mut runs = group.runs.iter().map(|(_, run)| *run);
            Some((group, runs.find(with_motion)?))
        })
        .collect();
    let models = runs.iter().filter_map(|(group, run)| {
        Some(MovingModel {
            label: &group.label,
            integrator: &run.integrator,
            style: group.style,
            motion: run.motion.as_ref()?,
            modes: Vec::new(),
        })
    });
    let start = runs.iter().find_map(|(_, run)| run.contacts.as_ref());
    Viewer::fitting(chart, models.collect(), start.map_or(0.0, |c| c.time_s))
}
