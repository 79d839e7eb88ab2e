//! Reactions of mounts: static equilibrium, power of a drive, momentum in motion.

use gearbench_integrators::{
    EquilibriumOptions, Outputs, Report, Resolution, SecondOrderSystem, State, TimePlan,
    equilibrium,
};
use gearbench_models::Vec3;
use gearbench_models::kinematics::Tooth;
use gearbench_models::scene::Scene;
use gearbench_models::spec::{Load, Mount, Profile, effective_radius};
use gearbench_tests::*;

const NAMES: [&str; 2] = ["pinion", "wheel"];

/// Returns force in the transverse plane and torque of a gear's mount.
fn reaction(scene: &mut Scene, s: &State, name: &str) -> [f64; 3] {
    ["bearing_x", "bearing_y", "mount_torque"].map(|c| channel(scene, s, &format!("{c}:{name}")))
}

#[test]
fn bearings_balance_a_torque_at_rest() {
    let torque = 60.0;
    let mut spec = case_a(-5e-6);
    spec.gears[0].speed = 0.0;
    spec.gears[0].loads = vec![Load::Applied(Profile::Constant(torque))];
    spec.gears[1].mount = Mount::Fixed;
    let force = torque / effective_radius(&spec.gears[0].body);
    for model in models() {
        let both = [usual(&model), usual(&model)];
        let mut scene = build(&spec, &both, &contact(5e10));
        let mut s = scene.initial();
        equilibrium(&mut scene, &mut s, &EquilibriumOptions::default()).unwrap();
        let [a, b] = NAMES.map(|n| reaction(&mut scene, &s, n));
        for (x, y) in [(a[0], b[0]), (a[1], b[1])] {
            assert!((x + y).abs() < 1e-9 * force, "{}: {x} {y}", model.id);
        }
        let size = a[0].hypot(a[1]);
        assert!(
            (size - force).abs() < 1e-9 * force,
            "{}: {size} {force}",
            model.id
        );
        assert_eq!(a[2], 0.0);
        // The left flank of the pinion pushes the wheel clockwise: its mount holds against that.
        let want = force * effective_radius(&spec.gears[1].body);
        assert!(
            (b[2] - want).abs() < 1e-9 * want,
            "{}: {} {want}",
            model.id,
            b[2]
        );
    }
}

#[test]
fn the_torque_of_a_drive_is_its_power_over_its_speed() {
    for driven in [0, 1] {
        for model in models() {
            let speed = [80.0, 60.0][driven];
            let mut spec = case_a(2e-6);
            spec.gears[driven].mount = Mount::Driven(Profile::Constant(speed));
            spec.gears[driven].speed = 0.0;
            spec.gears[1 - driven].speed = 0.0;
            spec.meshes[0].start = start(gearbench_models::geometry::Side::Left, 2e-6);
            if driven == 1 {
                spec.meshes[0].start = start(gearbench_models::geometry::Side::Right, 2e-6);
            }
            let both = [usual(&model), usual(&model)];
            let mut scene = build(&spec, &both, &contact(5e10));
            let mut touched = 0;
            for end in [2e-5, 4e-5, 6e-5] {
                let plan = TimePlan::new(end, Resolution::Step(5e-8));
                let initial = scene.initial();
                let s = run_from(&mut scene, initial, "rk4", &plan).state;
                let mut out = Outputs::default();
                scene.output(s.at(), &mut out);
                let torque = reaction(&mut scene, &s, NAMES[driven])[2];
                let power = out.power.external;
                touched += usize::from(power > 1.0);
                assert!(
                    (torque * speed - power).abs() < 1e-9 * power.abs().max(1.0),
                    "{}: {} {power}",
                    model.id,
                    torque * speed
                );
            }
            assert!(touched >= 2, "{}", model.id);
        }
    }
}

/// The mount force of a gear with movable teeth, masses on a circle, is that required by their centre of mass, less
/// the contact force. The reference is a second difference of the positions of all teeth.
#[test]
fn movable_teeth_load_their_bearing_with_their_inertia() {
    let (m, count, reference) = (4.8e-3, [20_i64, 30], [0.035, 0.052]);
    let teeth = reference.map(|r| {
        let teeth = all_teeth(movable(5.3e8, m, 40.0));
        with(teeth, "spring_radius_m", r)
    });
    let mut seen = 0.0_f64;
    let spec = super::movable_teeth::loaded(1.0, 300.0, 40.0);
    let mut scene = build(&spec, &teeth, &contact(5e10));
    // Within a contact, and after many teeth have come and gone.
    for end in [3e-5, 2.35e-3] {
        let plan = TimePlan::new(end, Resolution::Tolerance(1e-10));
        let initial = scene.initial();
        let s = run_from(&mut scene, initial, "dopri5", &plan).state;
        let mut a = vec![0.0; s.q.len()];
        scene.force(s.at(), &mut a);
        scene.solve_mass(s.at(), &mut a);
        let h = 2e-8;
        let moved = |sign: f64| {
            let mut x = s.clone();
            x.t += sign * h;
            for i in 0..a.len() {
                x.q[i] += sign * h * s.v[i] + 0.5 * h * h * a[i];
            }
            x
        };
        let states = [moved(-1.0), s.clone(), moved(1.0)];
        let fx = channel(&mut scene, &s, "force_x:0");
        let fy = channel(&mut scene, &s, "force_y:0");
        for (k, sign) in [(0, -1.0), (1, 1.0)] {
            let phase = scene.phases()[k];
            let centre = states.each_ref().map(|x| {
                let g = &scene.gears()[k];
                let mut sum = Vec3::zeros();
                for index in 0..count[k] {
                    let own = g
                        .model
                        .tooth_displacement(g.at(x.at()), Tooth { index, mesh: 0 });
                    let turn = index as f64 / count[k] as f64;
                    let (sin, cos) = (phase + own + std::f64::consts::TAU * turn).sin_cos();
                    sum += m * reference[k] * Vec3::new(cos, sin, 0.0);
                }
                sum
            });
            let rate = (centre[2] - 2.0 * centre[1] + centre[0]) / (h * h);
            let exact = [rate.x - sign * fx, rate.y - sign * fy];
            let r = reaction(&mut scene, &s, NAMES[k]);
            let scale = fx.hypot(fy) + rate.norm();
            seen = seen.max(rate.norm() / scale);
            for (r, e) in r.iter().zip(exact) {
                assert!((r - e).abs() < 2e-3 * scale, "{k} {end}: {r} {e}");
            }
        }
    }
    assert!(seen > 0.05, "the teeth's inertia hardly counts: {seen}");
}
