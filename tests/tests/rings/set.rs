//! Sets of three planets between a sun and a ring, with six meshes: elastic gears compared with full finite elements
//! on fixed axes, and on a carrier, where energy and angular momentum are conserved.

use super::*;
use gearbench::context::Context;
use gearbench::scene_file::{Selection, load_for};
use gearbench_integrators::equilibrium::{EquilibriumOptions, equilibrium};
use gearbench_integrators::{Resolution, TimePlan};
use gearbench_models::Vec3;
use gearbench_models::spec::{Load, Mount, Profile, mesh_layout};
use gearbench_tests::{run_from, with};
use std::collections::BTreeMap;

/// Indices of the gears in the scene.
const SUN: usize = 0;
const RING: usize = 4;

/// Angle of one planet from its nominal position [rad].
const OFF_PLACE: f64 = 5e-5;

/// Returns the set of the scene `planetary`.
fn set() -> SceneSpec {
    let scene = load_for(
        &Context::default(),
        "planetary",
        Selection::Labels(Some("rigid")),
    );
    scene.unwrap_or_else(|e| panic!("{e:?}")).spec
}

/// Returns the set with its carrier fixed: all gears rotate about their own axes, ring and sun are fixed and strained
/// against each other, and a planet is offset by some micrometres, so that stiffness alone determines the load of each
/// mesh. The first mesh starts at a fraction of the base pitch from the pitch point.
fn on_fixed_axes(part: f64) -> SceneSpec {
    let mut spec = set();
    spec.shafts.clear();
    for g in &mut spec.gears {
        g.speed = 0.0;
        g.loads.clear();
    }
    spec.gears[SUN].mount = Mount::Fixed;
    let (sin, cos) = OFF_PLACE.sin_cos();
    let [x, y, _] = spec.gears[2].position;
    spec.gears[2].position = [cos * x - sin * y, sin * x + cos * y, 0.0];
    let layout = mesh_layout(&spec.gears[SUN], &spec.gears[1]).unwrap();
    spec.meshes[0].start.path_coordinate = Some(layout.pitch_point + part * layout.base_pitch);
    for mesh in &mut spec.meshes {
        mesh.start.gap = -6e-6;
    }
    spec
}

/// A set in equilibrium.
struct SetEquilibrium {
    /// Force of each tooth pair [N], by mesh and tooth of its first gear.
    pairs: BTreeMap<(usize, i64), f64>,
    unknowns: usize,
}

impl SetEquilibrium {
    fn of(spec: &SceneSpec, model: &ModelSpec, contact: &ContactSpec) -> Self {
        let mut scene = built(spec, model, contact);
        let mut s = scene.initial();
        equilibrium(&mut scene, &mut s, &EquilibriumOptions::default()).unwrap();
        let mut sums = BTreeMap::new();
        for c in scene.contact_forces(s.at()) {
            let sum = sums.entry((c.mesh, c.teeth[0].index));
            *sum.or_insert(Vec3::zeros()) += c.force;
        }
        SetEquilibrium {
            pairs: sums.into_iter().map(|(pair, f)| (pair, f.norm())).collect(),
            unknowns: s.q.len(),
        }
    }

    fn of_mesh(&self, mesh: usize) -> f64 {
        let own = self.pairs.iter().filter(|((m, _), _)| *m == mesh);
        own.map(|(_, force)| force).sum()
    }

    fn of_meshes(&self) -> Vec<f64> {
        (0..6).map(|mesh| self.of_mesh(mesh)).collect()
    }
}

/// Computes a mesh cycle with a number of positions.
fn through_a_cycle(name: &str, contact: &ContactSpec, positions: u32) {
    let elements = [8.0, 1.0];
    let mut worst = [0.0_f64; 2];
    for i in 0..positions {
        let part = (f64::from(i) + 0.5) / f64::from(positions) - 0.5;
        let spec = on_fixed_axes(part);
        let found = SetEquilibrium::of(&spec, &elastic(elements, 40.0), contact);
        let fe = SetEquilibrium::of(&spec, &meshed("fe", elements, &[]), contact);
        let (meshes, of_fe) = (found.of_meshes(), fe.of_meshes());
        let most = of_fe.iter().fold(0.0_f64, |m, f| m.max(*f));
        for (a, b) in meshes.iter().zip(&of_fe) {
            worst[0] = worst[0].max((a / b - 1.0).abs());
        }
        for pair in found.pairs.keys().chain(fe.pairs.keys()) {
            let [a, b] = [&found, &fe].map(|of| of.pairs.get(pair).copied().unwrap_or(0.0));
            worst[1] = worst[1].max((a - b).abs() / most);
        }
        println!(
            "{name}, {part:+.2} base pitches, {} pairs: `fe` ({} unknowns) {of_fe:.1?} N, `elastic` {meshes:.1?} N",
            fe.pairs.len(),
            fe.unknowns
        );
    }
    println!(
        "{name}: forces of meshes off by {:.1e}, of tooth pairs by {:.1e} of the largest",
        worst[0], worst[1]
    );
    assert!(worst.iter().all(|w| *w < 0.02), "{worst:?}");
}

#[test]
#[ignore = "two minutes: finite elements of five gears"]
fn sets_on_fixed_axes_are_those_of_full_finite_elements() {
    let points = touching(PointContact::new(1e15), None);
    through_a_cycle("points", &points, 6);
    let half_space = touching(FlankContact::HalfSpace, Some(1));
    through_a_cycle("half-spaces", &half_space, 6);
}

/// Returns kinetic, strain and contact energy of a scene [J], and rotations and momenta of all hubs.
fn ledger(scene: &mut Scene, s: &State) -> (f64, Vec<f64>, Vec<f64>) {
    let mut out = Outputs::default();
    scene.output(s.at(), &mut out);
    let hubs = scene
        .gears()
        .iter()
        .map(|g| g.model.hub_state(g.at(s.at())));
    let (turns, momenta) = hubs.map(|hub| (hub.displacement, hub.momentum)).unzip();
    let e = out.energy;
    (e.kinetic + e.strain + e.contact, turns, momenta)
}

/// Whatever the position of the carrier, contacts are those of the same gears on fixed axes.
#[test]
fn contacts_go_round_with_the_carrier() {
    let pressed = |mut spec: SceneSpec| {
        for mesh in &mut spec.meshes {
            mesh.start.gap = -6e-6;
        }
        spec
    };
    let mut fixed = pressed(set());
    fixed.shafts.clear();
    // On a carrier the ring is held by a link; its modes are those of a hub that turns.
    fixed.gears[RING].mount = Mount::Revolute;
    for contact in [
        touching(PointContact::new(1e15), None),
        touching(FlankContact::HalfSpace, Some(1)),
    ] {
        let of = |spec: &SceneSpec, turn: f64| -> Vec<f64> {
            let mut scene = built(spec, &elastic([8.0, 1.0], 12.0), &contact);
            let mut s = scene.initial();
            let hubs: Vec<usize> = (scene.gears().iter())
                .filter(|g| !g.range().is_empty() && turn != 0.0)
                .map(|g| g.range().start)
                .collect();
            hubs.into_iter().for_each(|i| s.q[i] += turn);
            let all = scene.contact_forces(s.at());
            all.iter().map(|c| c.force.norm()).collect()
        };
        let still = of(&fixed, 0.0);
        assert!(still.iter().sum::<f64>() > 1000.0, "the meshes bear load");
        for turn in [0.0, 0.7, -4.0] {
            let round = of(&pressed(set()), turn);
            assert_eq!(round.len(), still.len());
            let off = round.iter().zip(&still).map(|(a, b)| (a - b).abs());
            let worst = off.fold(0.0, f64::max) / still.iter().fold(0.0, |m, f| f.max(m));
            println!(
                "carrier at {turn} rad: {} contacts off by {worst:.1e}",
                still.len()
            );
            assert!(worst < 1e-8, "{worst:.1e}");
        }
    }
}

/// Returns a floating set: ring and carrier rotate freely under balanced torques, so that its angular momentum is
/// conserved.
fn floating() -> SceneSpec {
    let mut spec = set();
    spec.gears[RING].mount = Mount::Revolute;
    spec.gears[RING].loads = vec![Load::Applied(Profile::Constant(210.0))];
    spec
}

#[test]
fn elastic_sets_keep_energy_and_angular_momentum() {
    let spec = floating();
    // Of the torques that balance each other the hubs take the work.
    let torque = [60.0, 0.0, 0.0, 0.0, 210.0, -270.0];
    for (name, contact) in [
        ("points", touching(PointContact::new(1e15), None)),
        ("half-spaces", touching(FlankContact::HalfSpace, Some(1))),
    ] {
        let mut scene = built(&spec, &elastic([8.0, 1.0], 12.0), &contact);
        for tolerance in [1e-6, 1e-8] {
            let start = scene.initial();
            let (energy, turns, momenta) = ledger(&mut scene, &start);
            let plan = TimePlan {
                max_steps: 4_000_000,
                ..TimePlan::new(2e-4, Resolution::Tolerance(tolerance))
            };
            let out = run_from(&mut scene, start, "dopri5", &plan).unwrap("a floating set");
            let (after, turned, gained) = ledger(&mut scene, &out.state);
            let turns: Vec<f64> = turned.iter().zip(&turns).map(|(a, b)| a - b).collect();
            let work: f64 = torque.iter().zip(&turns).map(|(t, x)| t * x).sum();
            let through = (torque[SUN] * turns[SUN]).abs();
            let off = (after - energy - work) / through;
            let sum = |p: &[f64]| p.iter().sum::<f64>();
            let largest = gained.iter().fold(0.0_f64, |m, p| m.max(p.abs()));
            let kept = (sum(&gained) - sum(&momenta)) / largest;
            println!(
                "{name}, tolerance {tolerance:.0e}: energy off by {off:.1e} of {through:.3} J that went through, angular momentum by {kept:.0e}, peak {:.0} N",
                out.peak
            );
            assert!(off.abs() < 1e-6 && kept.abs() < 1e-11, "{off:e} {kept:e}");
            assert!(out.peak > 200.0, "the meshes bear load");
        }
    }
}

/// Full finite elements on a carrier are refused.
#[test]
fn full_finite_elements_on_a_carrier_are_refused() {
    let spec = set();
    let fe = meshed("fe", [2.0, 1.0], &[]);
    let coarse = ["fillet", "across", "rim"];
    let fe = coarse
        .iter()
        .fold(fe, |m, key| with(m, &format!("{key}_elements"), 3.0));
    let points = touching(PointContact::new(1e15), None);
    let modelling = modelling(&spec, &fe, &points);
    let refused = Scene::build(&spec, &modelling, gearbench::models::models());
    let text = refused.err().expect("it is refused").to_string();
    assert!(text.contains("use the model `elastic`"), "{text}");
}
