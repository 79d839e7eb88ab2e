//! Contact of elastic gears on nodes: one potential behind all forces, tangents, the solve, partners.

mod clearance;
mod dashpots;
mod flight;
mod friction;
mod hard;
mod order;
mod partners;
mod potential;
mod search;
mod tangents;

use gearbench_integrators::system::{HalfStepImpulse, ModalSplit, StateView};
use gearbench_integrators::{Outputs, Report, SecondOrderSystem, State};
use gearbench_models::scene::Scene;
use gearbench_models::spec::{
    ContactSpec, Load, ModelSpec, Passes, PointContact, PointRule, Profile, SceneSpec, SurfaceKind,
    effective_radius, mesh_layout,
};
use gearbench_tests::*;

fn toy(rows: usize, columns: usize, modes: usize, residual: f64) -> ModelSpec {
    let counts = [("rows", rows), ("columns", columns), ("modes", modes)];
    with(
        model_of("elastic-toy", counts),
        "residual_m_per_n",
        residual,
    )
}

fn with_points(points: PointContact) -> ContactSpec {
    ContactSpec {
        flanks: points.into(),
        ..contact(1.5e10)
    }
}

/// Rolls both hubs by an angle of the first.
fn roll(spec: &SceneSpec, scene: &Scene, s: &mut State, angle: f64) {
    let displacement = angle * effective_radius(&spec.gears[0].body);
    for (k, g) in scene.gears().iter().enumerate() {
        let rack = g.model.hub().slide.is_some();
        let sign = if rack || k == 0 { 1.0 } else { -1.0 };
        s.q[g.range().start] += sign * displacement / effective_radius(&spec.gears[k].body);
    }
}

/// Sets modal coordinates that move flanks by about `size` [m], and modal speeds.
fn deform(scene: &Scene, s: &mut State, size: f64, seed: u64) {
    let (scale, _) = scales(scene);
    let magnitude = scene.magnitudes().deflection;
    let mut numbers = Numbers::new(seed);
    for g in scene.gears().iter().filter(|g| g.id == "elastic-toy") {
        let n = g.range().len() - g.model.hub().coordinates();
        for i in g.range().skip(g.model.hub().coordinates()) {
            s.q[i] = scale[i] * size / magnitude * numbers.draw() / (n as f64).sqrt();
            s.v[i] = 1e4 * s.q[i] * numbers.draw();
        }
    }
}

/// Returns gears under load that rotate at a speed of the first.
fn loaded(gap: f64, speed: f64) -> SceneSpec {
    let mut spec = case_a(gap);
    (spec.gears[0].speed, spec.gears[1].speed) = (speed, -speed / 1.5);
    spec.gears[0].loads = vec![Load::Applied(Profile::Constant(40.0))];
    spec.gears[1].loads = vec![Load::Applied(Profile::Constant(60.0))];
    spec
}

/// Returns the difference of the accelerations for an impulse of half a microsecond from those at the velocities at
/// its end, relative to the largest.
fn off_at_the_end_of_a_kick(scene: &mut Scene, s: &State, filter: &[f64]) -> f64 {
    let n = s.q.len();
    let kick = HalfStepImpulse {
        time: 5e-7,
        before: &s.v,
        steady: &[],
        filter,
    };
    let mut a = vec![0.0; n];
    scene.remainder_after(s.at(), &kick, &mut a);
    let mut v = Vec::new();
    kick.end(&a, &mut v);
    let mut at_end = vec![0.0; n];
    scene.remainder(StateView { v: &v, ..s.at() }, &mut at_end);
    let largest = a.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let worst = (a.iter().zip(&at_end)).fold(0.0_f64, |m, (x, y)| m.max((x - y).abs()));
    worst / largest
}

fn force(scene: &mut Scene, s: &State) -> Vec<f64> {
    let mut f = vec![0.0; s.q.len()];
    scene.force(s.at(), &mut f);
    f
}

/// Returns the energy from which forces without dampers derive, less the work of constant loads.
fn potential(scene: &mut Scene, s: &State) -> f64 {
    let mut out = Outputs::default();
    scene.output(s.at(), &mut out);
    let mut work = 0.0;
    for g in scene.gears() {
        let Some(Load::Applied(Profile::Constant(torque))) = g.loads.first() else {
            continue;
        };
        // The hub turns with frame and modes: the load's generalised forces say how.
        let mut f = vec![0.0; g.range().len()];
        g.model.hub().add_load(*torque, &mut f);
        work += f
            .iter()
            .zip(&s.q[g.range()])
            .map(|(f, q)| f * q)
            .sum::<f64>();
    }
    out.energy.strain + out.energy.contact - work
}

fn quadrature(along: usize, across: usize) -> PointRule {
    PointRule::Quadrature { along, across }
}

fn nodes_on_springs(rows: usize) -> ModelSpec {
    model_of("nodal-test", [("rows", rows), ("columns", 2)])
}
