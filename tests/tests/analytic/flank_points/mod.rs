//! Contact of flank points: gaps and normals on exact involutes compared with the lines of action, forces, rows,
//! moments, edges.

mod coarse;
mod forces;
mod gaps;
mod rows;

use gearbench_integrators::system::Coeffs;
use gearbench_integrators::{Outputs, SecondOrderSystem, State};
use gearbench_models::contact::{Candidate, CandidateSelection, GearState};
use gearbench_models::geometry::{Gear, GearParams, Rack, RackParams, Side, inv};
use gearbench_models::law::Damping;
use gearbench_models::scene::Scene;
use gearbench_models::spec::{
    Body, ContactSpec, ModelSpec, Mount, Passes, PointContact, PointRule, Profile, SceneSpec,
    SurfaceKind, effective_radius, mesh_layout,
};
use gearbench_tests::*;
use std::f64::consts::TAU;

pub(crate) fn flanked(id: &str, rows: usize, columns: usize) -> ModelSpec {
    model_of(id, [("rows", rows), ("columns", columns)])
}

fn with_points(points: PointContact) -> ContactSpec {
    ContactSpec {
        flanks: points.into(),
        ..contact(1.5e10)
    }
}

/// Rotates both hubs as if rolling, by an angle of the first.
fn roll(spec: &SceneSpec, scene: &Scene, angle: f64) -> State {
    let mut s = scene.initial();
    let displacement = angle * effective_radius(&spec.gears[0].body);
    for (k, g) in scene.gears().iter().enumerate() {
        let rack = g.model.hub().slide.is_some();
        let sign = if rack || k == 0 { 1.0 } else { -1.0 };
        s.q[g.range().start] += sign * displacement / effective_radius(&spec.gears[k].body);
    }
    s
}

fn quadrature(along: usize, across: usize) -> PointRule {
    PointRule::Quadrature { along, across }
}

/// Builds case A with rigid flanks, overlapping by `-gap`.
fn rigid_pair(
    spec: &SceneSpec,
    [rows, columns]: [usize; 2],
    points: PointContact,
) -> (Scene, Vec<(usize, Candidate)>, State) {
    let model = flanked("rigid-flanks-test", rows, columns);
    let scene = build(spec, &[model.clone(), model], &with_points(points));
    let s = scene.initial();
    let found = candidates(&scene, &s);
    (scene, found, s)
}

/// Returns the sum of penalty x area x overlap [N] over the candidates that overlap.
fn force_of(found: &[(usize, Candidate)]) -> f64 {
    let closed = found.iter().filter(|(_, c)| c.gap < 0.0);
    closed.map(|(_, c)| -c.stiffness * c.gap).sum()
}
