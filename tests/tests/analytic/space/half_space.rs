//! Elastic gears on half-spaces whose hubs move: in the plane, with tilts, on axes that are not parallel.

use super::elastic::reduced;
use super::*;
use gearbench_integrators::dense_solve::solve_in_place;
use gearbench_integrators::equilibrium::{EquilibriumOptions, equilibrium};
use gearbench_integrators::observers::ledger::Ledger;
use gearbench_integrators::system::{Coeffs, SecondOrderSystem, StateView};
use gearbench_integrators::{Resolution, TimePlan};
use gearbench_models::kinematics::{Locus, Point, Row, Tooth};
use gearbench_models::law::Friction;
use gearbench_models::spec::{
    ContactSpec, FlankContact, Load, ModelSpec, Mount, PointContact, Profile,
};

/// Strips over the width.
const STRIPS: usize = 3;

fn on_half_spaces() -> ContactSpec {
    ContactSpec {
        slices: Some(STRIPS),
        flanks: FlankContact::HalfSpace,
        ..contact(1.5e10)
    }
}

/// Returns full finite elements on the mesh of [`reduced`] gears.
fn full() -> ModelSpec {
    let reduced = reduced();
    let values = reduced.values().into_iter();
    model_of("fe", values.filter(|(key, _)| key != "modes"))
}

/// Fixes the tilts of all hubs.
fn upright(mut spec: SceneSpec) -> SceneSpec {
    for l in spec.gears.iter_mut().filter_map(|g| g.lateral.as_mut()) {
        l.directions[3] = Freedom::Fixed;
        l.directions[4] = Freedom::Fixed;
    }
    spec
}

fn mounted(mut spec: SceneSpec, lateral: &Option<Box<OutOfPlaneSpec>>) -> SceneSpec {
    for gear in &mut spec.gears {
        gear.lateral.clone_from(lateral);
        if let Some(l) = &mut gear.lateral {
            l.spin = SpinTerms::Off;
        }
    }
    spec
}

/// Returns pairs whose hubs move, with the models of both gears.
fn pairs(lateral: &Option<Box<OutOfPlaneSpec>>) -> Vec<(&'static str, SceneSpec, [ModelSpec; 2])> {
    let on = |spec| mounted(spec, lateral);
    let mut tilted = on(helical_pair(0.25, 0.0, true));
    tilt(&mut tilted, 0, 4e-4, -2e-4);
    tilt(&mut tilted, 1, -3e-4, 3e-4);
    let both = || [reduced(), reduced()];
    vec![
        (
            "spur in the plane",
            upright(on(helical_pair(0.0, 0.0, false))),
            both(),
        ),
        (
            "helical and modified in the plane",
            upright(on(helical_pair(0.25, 0.0, true))),
            both(),
        ),
        (
            "on a rigid gear in the plane",
            upright(on(helical_pair(0.25, 0.0, true))),
            [rigid(), reduced()],
        ),
        ("spur", on(helical_pair(0.0, 0.0, false)), both()),
        ("helical, modified and misaligned", tilted.clone(), both()),
        ("on a rigid gear", tilted, [reduced(), rigid()]),
        ("on a rack", on(rack_pair(0.2)), both()),
    ]
}

/// Returns a state with loaded flanks, displaced hubs and displaced flanks.
fn pressed(scene: &Scene, spec: &SceneSpec, roll: f64, numbers: &mut Numbers) -> State {
    let mut s = displaced(scene, spec, roll, numbers);
    for g in scene.gears().iter().filter(|g| g.id.starts_with("elastic")) {
        let modes = g.range().start + g.model.hub().first()..g.range().end;
        s.q[modes]
            .iter_mut()
            .for_each(|q| *q = 1e-7 * numbers.draw());
    }
    s
}

fn force(scene: &mut Scene, at: StateView<'_>) -> Vec<f64> {
    let mut f = vec![0.0; at.q.len()];
    scene.force(at, &mut f);
    f
}

/// Returns the largest difference between forces and the slopes of the energy, relative to the largest force, both times the
/// typical size of a coordinate.
fn off_potential(scene: &mut Scene, s: &State, coordinates: &[usize]) -> f64 {
    let f = force(scene, s.at());
    let (scale, _) = scales(scene);
    let largest = (coordinates.iter()).fold(0.0_f64, |m, &i| m.max((f[i] * scale[i]).abs()));
    let unit = scene.magnitudes().deflection;
    let off = coordinates.iter().map(|&i| {
        let h = 2e-9 * scale[i] / unit;
        let mut at = |by: f64| {
            let mut moved = s.clone();
            moved.q[i] += by;
            energy(scene, &moved)
        };
        let slope = (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
        ((slope + f[i]) * scale[i]).abs() / largest
    });
    off.fold(0.0, f64::max)
}

/// Forces on all directions of the hubs and on the modes are slopes of strain and contact energy.
#[test]
fn forces_are_slopes_of_one_potential() {
    for (name, spec, models) in pairs(&on_bearings()) {
        let mut scene = build(&spec, &models, &on_half_spaces());
        let mut numbers = Numbers::new(7);
        let (mut worst, mut lines) = (0.0_f64, Vec::new());
        for place in 0..6 {
            let s = pressed(&scene, &spec, 0.08 * f64::from(place) - 0.25, &mut numbers);
            lines.push(scene.contact_forces(s.at()).len());
            let all: Vec<usize> = (0..s.q.len()).collect();
            worst = worst.max(off_potential(&mut scene, &s, &all));
        }
        println!("{name}: force off its potential by {worst:.1e}; lines {lines:?}");
        assert!(lines.iter().all(|n| *n >= 2), "{name}: {lines:?}");
        assert!(worst < 1e-6, "{name}: {worst:.2e}");
    }
}

/// Forces of full finite elements on half-spaces are slopes of one potential, at the hubs and at the nodes around the contact.
#[test]
fn forces_of_finite_elements_are_slopes_of_one_potential() {
    for (name, spec, mut models) in pairs(&on_bearings()) {
        if !["spur in the plane", "helical, modified and misaligned"].contains(&name) {
            continue;
        }
        models[0] = full();
        let mut scene = build(&spec, &models, &on_half_spaces());
        let mut numbers = Numbers::new(11);
        let mut s = pressed(&scene, &spec, 0.0, &mut numbers);
        carry_nodes(&scene, &mut s);
        let second = scene.gears()[1].range().start;
        let with = force(&mut scene, s.at());
        let mut apart = s.clone();
        apart.q[second] += 1e-3 / effective_radius(&spec.gears[1].body);
        let without = force(&mut scene, apart.at());
        let loaded = (0..s.q.len()).filter(|i| (with[*i] - without[*i]).abs() > 1e-3);
        let loaded: Vec<usize> = loaded.collect();
        assert!(loaded.len() > 16 && loaded[..3] == [0, 1, 2], "{loaded:?}");
        let worst = off_potential(&mut scene, &s, &loaded);
        println!("{name}, finite elements: force off its potential by {worst:.1e}");
        assert!(worst < 1e-6, "{name}: {worst:.2e}");
    }
}

/// Moves the nodes of the first gear, full finite elements, with their hub.
fn carry_nodes(scene: &Scene, s: &mut State) {
    let gear = &scene.gears()[0];
    let (hub, first) = (&gear.model.hub().hub, gear.model.hub().first());
    let still = scene.initial();
    let surface = gear.model.surface().unwrap();
    let frame = hub.frame(0.0, &s.q[gear.range()]);
    let mut node = 0;
    let mut moved = 0;
    while first + 3 * moved < gear.range().len() {
        let (mut row, mut x) = (Row::default(), [Vec3::zeros()]);
        let at = gear.at(still.at());
        surface.nodes.positions(at, &[node], &mut x);
        let point = Point {
            tooth: Tooth { index: 0, mesh: 0 },
            locus: Locus::Node(node),
            x: x[0],
        };
        row.clear();
        row.target(0, 1.0);
        gear.model.row(at, &point, &Vec3::x(), &mut row);
        let arm = x[0] - hub.centre;
        let local = hub.axes.map(|axis| axis.dot(&arm));
        let carried = (0..3).fold(frame.origin, |sum, k| sum + local[k] * frame.axes[k]);
        row.for_each(|i, value| {
            if value == 1.0 {
                for axis in 0..3 {
                    s.q[i + axis] = carried[axis] - x[0][axis];
                }
                moved += 1;
            }
        });
        node += 1;
    }
}

/// Without bearings the forces of the contact on both gears, with friction too, are one wrench: they do no work along a
/// rigid motion of both.
#[test]
fn contact_adds_no_momentum() {
    for (name, spec, models) in pairs(&afloat()) {
        let in_plane = name.contains("plane");
        for slides in [false, true] {
            let friction = slides.then(|| Friction::new(0.08, 0.01).unwrap());
            let contact = ContactSpec {
                friction,
                ..on_half_spaces()
            };
            let mut scene = build(&spec, &models, &contact);
            let mut numbers = Numbers::new(3);
            let mut worst = 0.0_f64;
            for place in 0..6 {
                let roll = 0.08 * f64::from(place) - 0.25;
                let mut s = pressed(&scene, &spec, roll, &mut numbers);
                if slides {
                    s.v[0] = 100.0;
                }
                let f = force(&mut scene, s.at());
                assert!(scene.contact_forces(s.at()).len() >= 2);
                let work = match in_plane {
                    true => work_in_plane(&scene, &s, &f),
                    false => work_of_rigid_motions(&scene, &s, &f),
                };
                worst = worst.max(work);
            }
            println!("{name}, friction {slides}: momentum within {worst:.1e}");
            assert!(worst < 1e-9, "{name}: {worst:.2e}");
        }
    }
}

/// Returns the largest work of forces along rigid motions in the plane and along the axes, relative to its largest part.
fn work_in_plane(scene: &Scene, s: &State, f: &[f64]) -> f64 {
    let mut worst = 0.0_f64;
    for motion in 0..4 {
        let (mut work, mut scale) = (0.0, 0.0_f64);
        for g in scene.gears() {
            let hub = &g.model.hub().hub;
            let own = g.at(s.at());
            let origin = hub.frame(own.t, own.q).origin;
            let mut rates = [0.0; 6];
            match motion {
                0..3 => rates[motion] = 1.0,
                _ => (rates[0], rates[1], rates[5]) = (-origin.y, origin.x, 1.0),
            }
            for (k, d) in hub.free_directions().enumerate() {
                let part = f[g.range().start + k] * rates[d];
                work += part;
                scale = scale.max(part.abs());
            }
        }
        if scale > 1e-3 {
            worst = worst.max(work.abs() / scale);
        }
    }
    worst
}

/// The correction of implicit methods is the inverse of mass and tangent, and the tangent that of differences up to the turn
/// of directions.
#[test]
fn tangents_and_corrections_are_those_of_the_forces() {
    let c = Coeffs {
        m: 1.0,
        d: 5e-7,
        k: 2.5e-13,
    };
    for (name, spec, models) in pairs(&on_bearings()) {
        let mut scene = build(&spec, &models, &on_half_spaces());
        let mut numbers = Numbers::new(9);
        let s = pressed(&scene, &spec, 0.05, &mut numbers);
        let (scale, rates) = scales(&scene);
        let n = s.q.len();
        let mut worst = 0.0_f64;
        for _ in 0..4 {
            let [dq, dv] = [&scale, &rates].map(|scale| {
                let of = scale.iter().map(|x| x * numbers.draw());
                of.collect::<Vec<f64>>()
            });
            let slopes = force_slope(&mut scene, &s, [&dq, &dv], 1e-5);
            let mut tangent = vec![0.0; n];
            scene.tangent_times(s.at(), &dq, &dv, &mut tangent);
            let weighted = |x: &[f64]| {
                let all = x.iter().zip(&scale).map(|(x, s)| (x * s).abs());
                all.fold(0.0_f64, f64::max)
            };
            let difference: Vec<f64> = tangent.iter().zip(&slopes).map(|(a, b)| a - b).collect();
            worst = worst.max(weighted(&difference) / weighted(&slopes));
        }
        let rhs: Vec<f64> = scale.iter().map(|x| numbers.draw() / x).collect();
        let mut x = rhs.clone();
        scene.correct(s.at(), c, &mut x).unwrap();
        let mut a = vec![0.0; n * n];
        for j in 0..n {
            let mut unit = vec![0.0; n];
            unit[j] = 1.0;
            let (mut mass, mut df) = (vec![0.0; n], vec![0.0; n]);
            scene.apply_mass(s.at(), &unit, &mut mass);
            let (mut dq, mut dv) = (unit.clone(), unit);
            (dq[j], dv[j]) = (c.k, c.d);
            scene.tangent_times(s.at(), &dq, &dv, &mut df);
            for i in 0..n {
                a[i * n + j] = c.m * mass[i] - df[i];
            }
        }
        let mut expected = rhs;
        solve_in_place(&mut a, &mut expected).unwrap();
        let largest = |v: &[f64]| {
            let all = v.iter().zip(&scale).map(|(x, s)| (x / s).abs());
            all.fold(0.0_f64, f64::max)
        };
        let difference: Vec<f64> = x.iter().zip(&expected).map(|(a, b)| a - b).collect();
        let correction = largest(&difference) / largest(&expected);
        println!("{name}: tangent {worst:.1e}, correction {correction:.1e}");
        assert!(worst < 2e-2, "{name}: {worst:.2e}");
        assert!(correction < 1e-5, "{name}: {correction:.2e}");
    }
}

/// Load of the static pairs [N m].
const TORQUE: f64 = 100.0;

/// Returns a spur pair under load of which the first hubs are on radial bearings with a stiffness [N/m], the wheel without
/// rotation, and its equilibrium.
fn at_rest(
    (on_bearings, stiffness): (usize, Option<f64>),
    models: &[ModelSpec; 2],
    contact: &ContactSpec,
) -> (Scene, State) {
    let mut spec = helical_pair(0.0, -5e-6, false);
    for gear in &mut spec.gears {
        gear.speed = 0.0;
    }
    for gear in &mut spec.gears[..on_bearings] {
        gear.lateral = stiffness.map(|k| {
            let mut lateral = OutOfPlaneSpec {
                spin: SpinTerms::Off,
                ..OutOfPlaneSpec::default()
            };
            for d in 0..2 {
                lateral.directions[d] = Freedom::Free;
                lateral.bearing.stiffness[d][d] = k;
            }
            Box::new(lateral)
        });
    }
    spec.gears[0].loads = vec![Load::Applied(Profile::Constant(TORQUE))];
    spec.gears[1].mount = Mount::Fixed;
    let mut scene = build(&spec, models, contact);
    let mut s = scene.initial();
    equilibrium(&mut scene, &mut s, &EquilibriumOptions::default()).unwrap();
    (scene, s)
}

/// The bearing of a rigid pinion gives way by force over stiffness, and the pinion turns by the work of that; the forces of all
/// lines and the rotation tend to those of fixed axes with the compliance of the bearing. (Elastic gears omit a part of the
/// compliance of their own bearings with the truncated modes.)
#[test]
fn stiff_bearings_are_fixed_axes() {
    let models = [rigid(), reduced()];
    let of = |stiffness| {
        let (mut scene, s) = at_rest((1, stiffness), &models, &on_half_spaces());
        let forces: Vec<f64> = (scene.contact_forces(s.at()).iter())
            .map(|c| c.normal_force)
            .collect();
        let force = channel(&mut scene, &s, "force:0");
        let moved = stiffness.map(|_| s.q[1].hypot(s.q[2]));
        (s.q[0], forces, force, moved)
    };
    let (angle, forces, ..) = of(None);
    let stiff = [1e9, 1e10, 1e11];
    let off: Vec<[f64; 2]> = (stiff.iter())
        .map(|&k| {
            let (turned, on_lines, force, moved) = of(Some(k));
            assert_eq!(on_lines.len(), forces.len());
            let moved = moved.unwrap() * k / force - 1.0;
            // The energy in the bearing is half of the work of the torque.
            let gave = (turned - angle) * TORQUE / (force * force / k) - 1.0;
            println!(
                "{k:.0e} N/m: displacement of the bearing {moved:.1e}, of the mesh {gave:.1e} off"
            );
            assert!(moved.abs() < 1e-9 && gave.abs() < 1e-5);
            let parts = on_lines.iter().zip(&forces).map(|(a, b)| (a - b).abs());
            [
                (turned - angle).abs() / angle.abs(),
                parts.fold(0.0, f64::max) / force,
            ]
        })
        .collect();
    for what in 0..2 {
        let [x, y]: [Vec<f64>; 2] = [
            stiff.iter().map(|k| 1.0 / k).collect(),
            off.iter().map(|o| o[what]).collect(),
        ];
        let order = slope(&x, &y);
        println!("difference from fixed axes {off:?}, order {order:.3}");
        assert!((order - 1.0).abs() < 0.02, "{order}");
    }
}

/// Undamped pairs on bearings keep their energy.
#[test]
fn half_spaces_on_bearings_keep_their_energy() {
    let mut lateral = on_bearings();
    if let Some(l) = &mut lateral {
        l.bearing.damping = [[0.0; 6]; 6];
    }
    for (name, mut spec, models) in pairs(&lateral) {
        for g in &mut spec.gears {
            g.loads.clear();
        }
        let mut scene = build(&spec, &models, &on_half_spaces());
        let found: Vec<f64> = [4e-7, 1e-7, 2.5e-8]
            .into_iter()
            .map(|h| {
                let mut numbers = Numbers::new(4);
                let s = pressed(&scene, &spec, 0.02, &mut numbers);
                let before = total(&mut scene, &s);
                let plan = TimePlan::new(2e-5, Resolution::Step(h));
                let end = run_from(&mut scene, s, "rk4", &plan).state;
                (total(&mut scene, &end) / before - 1.0).abs()
            })
            .collect();
        println!("{name}: energy changes by {found:?}");
        assert!(found[2] < 1e-5, "{name}: {found:?}");
    }
}

/// A driven direction of a hub does the work of the lines on it.
#[test]
fn driven_directions_do_the_work_of_the_lines() {
    let mut lateral = on_bearings();
    if let Some(l) = &mut lateral {
        l.bearing.damping = [[0.0; 6]; 6];
    }
    for name in ["on a rigid gear in the plane", "on a rigid gear"] {
        let found = pairs(&lateral)
            .into_iter()
            .find(|(of, ..)| *of == name)
            .unwrap();
        let (_, mut spec, models) = found;
        let stiff = models.iter().position(|m| m.id() == "rigid").unwrap();
        if let Some(l) = &mut spec.gears[stiff].lateral {
            // Against the mate and along it; no spring of a bearing is strained.
            for (d, speed) in [(0, 0.05), (1, -0.05)] {
                l.directions[d] = Freedom::Driven(Profile::Constant(speed));
                l.bearing.stiffness[d][d] = 0.0;
            }
        }
        let mut scene = build(&spec, &models, &on_half_spaces());
        let mut numbers = Numbers::new(4);
        let s = pressed(&scene, &spec, 0.02, &mut numbers);
        let before = total(&mut scene, &s);
        let plan = TimePlan::new(2e-5, Resolution::Step(2.5e-8));
        let mut ledger = Ledger::default();
        let (end, _) = watched(&mut scene, s, "rk4", &plan, &mut ledger);
        let change = total(&mut scene, &end) - before;
        let residual = ledger.residual();
        println!(
            "{name}: energy changes by {change:.2e} J of {before:.2e}, unexplained {residual:.1e}"
        );
        assert!(change.abs() > 1e-2 * before, "{name}: {change:e}");
        assert!(residual.abs() < 1e-5 * before, "{name}: {residual:e}");
    }
}

fn total(scene: &mut Scene, s: &State) -> f64 {
    let mut out = Outputs::default();
    scene.output(s.at(), &mut out);
    out.energy.kinetic + out.energy.strain + out.energy.contact
}

/// The rotation of a loaded pair on bearings less that on fixed axes is the same on half-spaces of a coarse mesh as with the
/// contact of fine elements: what the bearings give way.
#[test]
fn half_spaces_on_bearings_are_fine_elements_on_bearings() {
    let coarse = [reduced(), reduced()];
    let fine = [0, 1].map(|_| {
        let of = [
            ("flank_elements", 24),
            ("fillet_elements", 4),
            ("across_elements", 8),
            ("rim_elements", 3),
            ("width_elements", 1),
            ("modes", 20),
        ];
        model_of("elastic", of)
    });
    let elements = ContactSpec {
        flanks: FlankContact::Points(PointContact::new(1e17)),
        ..contact(1.5e10)
    };
    let turned = |models: &[ModelSpec; 2], contact: &ContactSpec| {
        let [fixed, soft] = [None, Some(2e8)].map(|k| at_rest((2, k), models, contact).1.q[0]);
        [fixed, soft - fixed]
    };
    let [a, b] = [turned(&coarse, &on_half_spaces()), turned(&fine, &elements)];
    let off = [0, 1].map(|k| a[k] / b[k] - 1.0);
    println!(
        "rotation on fixed axes {:.4e}, by bearings {:.4e} rad, off {off:?}",
        b[0], b[1]
    );
    assert!(off[0].abs() < 0.05 && off[1].abs() < 5e-3, "{off:?}");
}
