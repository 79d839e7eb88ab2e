//! Initial positions of gears: angles mesh by mesh, and the views of the gears from their meshes.

use crate::contact::pairs::{Engagement, LinesOfAction};
use crate::error::{BuildError, MeshPart};
use crate::geometry::{Gear, Side};
use crate::kinematics::MeshView;
use crate::spec::{Body, GearSpec, MeshLayout, MeshSpec, SceneSpec, effective_radius};

/// Returns the views of gear a and gear b from a mesh, for given phases (angle or displacement of tooth 0).
pub(super) fn views(l: &MeshLayout, a: &GearSpec, b: &GearSpec, phase: [f64; 2]) -> [MeshView; 2] {
    let conical = l.conical.as_deref();
    let gear_view = |g: &Gear, k: usize, path: [f64; 2], assembled: f64| MeshView {
        base_radius: Some(g.sign() * g.r_base()),
        direction: l.towards[k],
        working_pressure_angle: l.working_pressure_angle,
        half_angle_base: conical.map_or([g.sign() * g.half_angle_base(); 2], |c| c.half_angles[k]),
        path,
        touching: path,
        pitch: g.pitch_angle(),
        assembled,
    };
    let other = [l.length - l.path[1], l.length - l.path[0]];
    let first = match &a.body {
        Body::Gear(g) => gear_view(g, 0, l.path, phase[0]),
        Body::Rack(_) => unreachable!("mesh_layout refuses a rack as the first gear"),
    };
    let second = match &b.body {
        Body::Gear(g) => gear_view(g, 1, other, phase[1]),
        Body::Rack(r) => MeshView {
            base_radius: None,
            direction: 0.0,
            working_pressure_angle: l.working_pressure_angle,
            half_angle_base: [r.half_thickness_reference(); 2],
            path: other,
            touching: other,
            pitch: r.pitch(),
            assembled: l.rack_offset + phase[1],
        },
    };
    let mut views = [first, second];
    let followed = [0, 1].map(|k| engagement(l, a, &views, k).followed());
    for (k, view) in views.iter_mut().enumerate() {
        view.touching = [view.path[0] - followed[1 - k], view.path[1] + followed[k]];
        if let Some(conical) = conical {
            view.touching[0] -= conical.margin;
            view.touching[1] += conical.margin;
        }
    }
    views
}

/// Returns the flank geometry of gear `k` of a mesh and of its mate.
pub(super) fn engagement(
    l: &MeshLayout,
    a: &GearSpec,
    views: &[MeshView; 2],
    k: usize,
) -> Engagement {
    Engagement {
        base_radius: views[k].base_radius,
        mate_base_radius: views[1 - k].base_radius,
        length: l.length,
        tip: views[k].path[1],
        mate_tip: views[1 - k].path[1],
        pressure_angle: l.working_pressure_angle,
        helix_cos: a.body.base_helix_angle().cos(),
        base_pitch: l.base_pitch,
    }
}

/// Returns the angle (or displacement) at which a flank of tooth 0 has a path coordinate.
fn phase_at(view: &MeshView, side: Side, s: f64) -> f64 {
    let (sign, half_angle) = (side.sign(), view.half_angle_of(side));
    match view.base_radius {
        Some(rb) => view.direction + sign * (s / rb - view.working_pressure_angle - half_angle),
        None => sign * (half_angle - s / view.working_pressure_angle.cos()),
    }
}

/// Places gears one mesh after another; returns the phase of each.
pub(super) fn assemble(spec: &SceneSpec, layouts: &[MeshLayout]) -> Result<Vec<f64>, BuildError> {
    let mut phase: Vec<Option<f64>> = vec![None; spec.gears.len()];
    for (mesh, l) in spec.meshes.iter().zip(layouts) {
        let [ia, ib] = mesh.gears;
        let (a, b) = (&spec.gears[ia], &spec.gears[ib]);
        let side = mesh.start.side;
        let path_coordinate = mesh.start.path_coordinate.unwrap_or(l.pitch_point);
        if !(l.path[0]..=l.path[1]).contains(&path_coordinate) {
            return Err(BuildError::mesh(
                [&a.name, &b.name],
                MeshPart::Start,
                format!(
                    "the start lies at {path_coordinate:.6e} m, outside the path of contact {:.6e} to {:.6e} m",
                    l.path[0], l.path[1]
                ),
            ));
        }
        let [va, vb] = views(l, a, b, [0.0, 0.0]);
        // The pitch in path coordinates brings a placed gear's tooth nearest to where the start is wanted.
        let nearest = |view: &MeshView, phase: f64, s: f64| {
            let placed = MeshView {
                assembled: phase,
                ..*view
            };
            let s0 = placed.path_coordinate(mesh.start.side, phase);
            s0 + ((s - s0) / l.base_pitch).round() * l.base_pitch
        };
        match (phase[ia], phase[ib]) {
            (None, None) => {
                // Of the gap either gear has half, so that their order does not matter; a place that is asked for is
                // that of the first.
                let of_first = match mesh.start.path_coordinate {
                    None => 0.5 * mesh.start.gap,
                    Some(_) => 0.0,
                };
                let s = path_coordinate - of_first;
                phase[ia] = Some(phase_at(&va, side, s));
                phase[ib] =
                    Some(phase_at(&vb, side, l.length - s - mesh.start.gap) - l.rack_offset);
            }
            (Some(p), None) => {
                let s = nearest(&va, p, path_coordinate);
                phase[ib] =
                    Some(phase_at(&vb, side, l.length - s - mesh.start.gap) - l.rack_offset);
            }
            (None, Some(p)) => {
                let s = nearest(&vb, p + l.rack_offset, l.length - path_coordinate);
                phase[ia] = Some(phase_at(&va, side, l.length - s - mesh.start.gap));
            }
            (Some(_), Some(_)) => {}
        }
    }
    Ok(phase.into_iter().map(|p| p.unwrap_or(0.0)).collect())
}

/// Largest initial overlap of flanks relative to the base pitch: a mesh may start preloaded, but not with teeth inside
/// one another.
const LARGEST_OVERLAP: f64 = 0.01;

/// Refuses initial positions with an overlap of flanks beyond a preload; `closes` is true where other meshes place
/// both gears.
pub(super) fn check_start(
    spec: &SceneSpec,
    mesh: &MeshSpec,
    l: &MeshLayout,
    loa: &LinesOfAction,
    closes: bool,
) -> Result<(), BuildError> {
    let [a, b] = mesh.gears.map(|i| &spec.gears[i]);
    for side in Side::BOTH {
        let gap = loa.assembled_gap(side);
        if gap >= -LARGEST_OVERLAP * l.base_pitch {
            continue;
        }
        if closes {
            // The smaller gap of the two flanks is the distance of the teeth.
            let overlap = Side::BOTH.map(|side| -loa.assembled_gap(side));
            let least = overlap[0].max(overlap[1]).min(l.base_pitch + gap);
            let angle = least / effective_radius(&b.body);
            return Err(BuildError::mesh(
                [&a.name, &b.name],
                MeshPart::Start,
                (
                    format!(
                        "this mesh closes a loop that does not close: flanks overlap, and `{}` would have to be rotated by {:.4} degrees, \
                         {:.3} of its pitch, relative to its position from the other meshes",
                        b.name,
                        angle.to_degrees(),
                        least / l.base_pitch
                    ),
                    "give another position or other numbers of teeth: N planets can be equally spaced if the sum of the teeth of sun \
                     and ring is a multiple of N",
                ),
            ));
        }
        let name = if side == Side::Left { "left" } else { "right" };
        return Err(BuildError::mesh(
            [&a.name, &b.name],
            MeshPart::Start,
            (
                format!(
                    "at the start the {name} flanks overlap by {:.4e} m (gap asked for: {:.4e} m, normal backlash: {:.4e} m)",
                    -gap,
                    mesh.start.gap,
                    l.pair.backlash_normal()
                ),
                "use a gap between 0 and the backlash, or, where other meshes place both gears, another position",
            ),
        ));
    }
    if !mesh.start.gap.is_finite() {
        return Err(BuildError::mesh(
            [&a.name, &b.name],
            MeshPart::Start,
            format!("the gap {} at the start is no number", mesh.start.gap),
        ));
    }
    Ok(())
}
