//! Damping proportional to stiffness, of elastic gears and full finite elements, residual compliance and contact included:
//! derivatives, losses, and the same damping in a body of modes and in one of nodes.

use gearbench_integrators::observers::ledger::Ledger;
use gearbench_integrators::{Coeffs, Outputs, Report, Resolution, SecondOrderSystem, TimePlan};
use gearbench_models::scene::Scene;
use gearbench_models::spec::{ContactSpec, FlankContact, ModelSpec, PointContact};
use gearbench_reference::MODELS;
use gearbench_tests::*;

/// Retardation time [s].
const BETA: f64 = 1.2e-6;

fn model(id: &str, beta: f64) -> ModelSpec {
    let mesh = ["flank", "fillet", "across", "rim", "width"].map(|part| {
        let elements = if part == "width" { 1 } else { 4 };
        (format!("{part}_elements"), elements)
    });
    let model = with(model_of(id, mesh), "rayleigh", vec![0.0, beta]);
    match id {
        "elastic" => with(with(model, "modes", 30), "spin_terms", "none"),
        _ => model,
    }
}

fn scene(id: &str, flanks: FlankContact, gap: f64, beta: f64) -> Scene {
    let contact = ContactSpec {
        flanks,
        ..contact(1.4e10)
    };
    let modelling = gearbench_models::spec::Modelling {
        gears: vec![model(id, beta); 2],
        contacts: vec![contact],
    };
    let table = [models(), MODELS.to_vec()].concat();
    Scene::build(&case_a(gap), &modelling, &table).unwrap_or_else(|e| panic!("{e}"))
}

/// Bodies and contacts that have this damping.
fn all() -> [(&'static str, FlankContact); 4] {
    let points = || FlankContact::Points(PointContact::new(1e15));
    [
        ("elastic", points()),
        ("elastic", FlankContact::HalfSpace),
        ("fe", points()),
        ("fe", FlankContact::HalfSpace),
    ]
}

/// Returns a state with overlapping flanks, displaced coordinates and speeds at which gaps change by a part of their
/// overlap within the retardation time.
fn pressed(scene: &mut Scene, numbers: &mut Numbers) -> gearbench_integrators::State {
    let mut s = scene.initial();
    let (sq, sv) = scales(scene);
    for g in scene.gears() {
        for i in g.range().skip(1) {
            s.q[i] += 0.02 * sq[i] * numbers.draw();
            s.v[i] += 0.02 * sv[i] * numbers.draw();
        }
    }
    s
}

/// Tangents agree with central differences of the force, and corrections invert the Newton matrix with damping.
#[test]
fn derivatives_are_those_of_the_force() {
    for (id, flanks) in all() {
        let mut scene = scene(id, flanks, -8e-6, BETA);
        let mut numbers = Numbers::new(7);
        let s = pressed(&mut scene, &mut numbers);
        let (sq, sv) = scales(&scene);
        let n = s.q.len();
        let small = 1e-9 / scene.magnitudes().deflection;
        let none = vec![0.0; n];
        for (what, dq, dv) in [
            ("displacements", numbers.vector(&sq), none.clone()),
            ("velocities", none.clone(), numbers.vector(&sv)),
        ] {
            let mut df = vec![0.0; n];
            scene.tangent_times(s.at(), &dq, &dv, &mut df);
            let slopes = force_slope(&mut scene, &s, [&dq, &dv], small);
            let work = |i: usize, x: f64| (x * sq[i]).abs();
            let size = (0..n).fold(1e-12_f64, |m, i| m.max(work(i, df[i])));
            let off = (0..n).map(|i| work(i, slopes[i] - df[i]) / size);
            let worst = off.fold(0.0, f64::max);
            println!("{id}, {flanks:?}: tangent of {what} off by {worst:.1e}");
            assert!(worst < 3e-3, "{id}, {flanks:?}, {what}: {worst:.1e}");
        }
        let c = Coeffs {
            m: 1.0,
            d: 2.5e-7,
            k: 6e-14,
        };
        let rhs: Vec<f64> = numbers.vector(&vec![1.0; n]);
        let rhs: Vec<f64> = rhs.iter().zip(&sq).map(|(r, s)| r / s).collect();
        let mut x = rhs.clone();
        scene.correct(s.at(), c, &mut x).unwrap();
        let (mut mass, mut df) = (vec![0.0; n], vec![0.0; n]);
        scene.apply_mass(s.at(), &x, &mut mass);
        let weighted = |by: f64| -> Vec<f64> { x.iter().map(|x| by * x).collect() };
        scene.tangent_times(s.at(), &weighted(c.k), &weighted(c.d), &mut df);
        let off = (0..n).map(|i| ((c.m * mass[i] - df[i] - rhs[i]) * sq[i]).abs());
        let worst = off.fold(0.0, f64::max);
        println!("{id}, {flanks:?}: correction off by {worst:.1e}");
        let limit = if id == "fe" { 5e-2 } else { 1e-8 };
        assert!(worst < limit, "{id}, {flanks:?}: correction {worst:.1e}");
    }
}

/// Whatever the velocities, the damping takes power.
#[test]
fn it_never_supplies_energy() {
    for (id, flanks) in all() {
        let mut scene = scene(id, flanks, -8e-6, BETA);
        let mut numbers = Numbers::new(3);
        let mut out = Outputs::default();
        let mut least = f64::INFINITY;
        for _ in 0..40 {
            let mut s = pressed(&mut scene, &mut numbers);
            s.v.iter_mut().for_each(|v| *v *= 10.0);
            scene.output(s.at(), &mut out);
            least = least.min(out.power.dissipated);
        }
        println!("{id}, {flanks:?}: at least {least:.2e} W are lost");
        assert!(least > 0.0, "{id}, {flanks:?}: {least:e} W");
    }
}

/// An impact of elastic gears and of full finite elements loses the same energy, all of it explained, and less of it is
/// left the more the bodies are damped.
#[test]
fn elastic_gears_lose_what_finite_elements_lose() {
    for flanks in [
        FlankContact::HalfSpace,
        FlankContact::Points(PointContact::new(1e15)),
    ] {
        let lost = |id: &str, beta: f64| {
            let mut scene = scene(id, flanks, 2e-6, beta);
            let start = scene.initial();
            let mut ledger = Ledger::default();
            let plan = TimePlan::new(1.6e-4, Resolution::Step(5e-7));
            watched(&mut scene, start, "newmark", &plan, &mut ledger);
            let from = ledger.start.unwrap().total();
            let unexplained = ledger.residual() / from;
            assert!(
                unexplained.abs() < 2e-3,
                "{id}: {unexplained:e} unexplained"
            );
            ledger.dissipated / from
        };
        let [once, twice] = [BETA, 2.0 * BETA].map(|beta| lost("elastic", beta));
        let nodes = lost("fe", BETA);
        println!(
            "{flanks:?}: {once:.4} and {twice:.4} of the energy lost, {nodes:.4} by finite elements"
        );
        assert!(0.01 < once && once < twice);
        assert!((nodes / once - 1.0).abs() < 0.05, "{once} {nodes}");
    }
}
