//! Guides of mounts: a spring, a damper and dry friction between a hub and the ground, along its own motion. Gears that move
//! within their backlash, each by itself.

use gearbench_integrators::observers::ledger::Ledger;
use gearbench_integrators::{Coeffs, Events, Resolution, SecondOrderSystem, State, TimePlan};
use gearbench_models::law::{DryFriction, FrictionForm};
use gearbench_models::scene::Scene;
use gearbench_models::spec::{
    BodySpec, Guide, Load, Mount, Profile, SceneSpec, ShaftSpec, Station, StationMember,
};
use gearbench_tests::*;

const SPRING: Guide = Guide {
    stiffness: 3e5,
    damping: 0.0,
    friction: None,
};

fn friction(force: f64, form: FrictionForm) -> Option<DryFriction> {
    Some(DryFriction::new(force, form).unwrap())
}

/// Returns a fixed pinion and a rack of 2 kg within a backlash of 2 mm, on a guide.
fn guided_rack(guide: Guide, speed: f64, force: f64) -> SceneSpec {
    let mut spec = pair_of(
        gear("pinion", spur(20), 0.0, 0.0),
        rack("rack", 7, 0.043, speed),
        start(gearbench_models::geometry::Side::Left, 1e-3),
    );
    spec.gears[0].mount = Mount::Fixed;
    spec.gears[1].inertia = Some(2.0);
    spec.gears[1].guide = Some(guide);
    spec.gears[1].loads = vec![Load::Applied(Profile::Constant(force))];
    spec
}

fn run_to(scene: &mut Scene, method: &str, resolution: Resolution, t: f64) -> (State, Ledger) {
    let plan = TimePlan::new(t, resolution);
    let (begin, mut ledger) = (scene.initial(), Ledger::default());
    let (end, _) = watched(scene, begin, method, &plan, &mut ledger);
    (end, ledger)
}

/// A rack on a guide moves as a mass on a spring and a damper under a constant force, with every method.
#[test]
fn a_rack_on_a_spring_and_a_damper_is_an_oscillator() {
    let guide = Guide {
        damping: 80.0,
        ..SPRING
    };
    let (m, force, t) = (2.0, 30.0, 0.02);
    let (decay, square): (f64, f64) = (0.5 * guide.damping / m, guide.stiffness / m);
    let w = (square - decay * decay).sqrt();
    let rest = force / guide.stiffness;
    let exact = rest * (1.0 - (-decay * t).exp() * ((w * t).cos() + decay / w * (w * t).sin()));
    let mut scene = build(
        &guided_rack(guide, 0.0, force),
        &[rigid(), rigid()],
        &contact(1e10),
    );
    for method in methods_of(&mut scene) {
        let resolution = resolution(method.info, 2e-6, 1e-9);
        let (end, ledger) = run_to(&mut scene, method.info.id, resolution, t);
        let error = (end.q[0] - exact).abs() / rest;
        println!(
            "{}: {error:.1e}, energy {:.1e}",
            method.info.id,
            ledger.residual_relative()
        );
        let first = method.info.order == 1;
        assert!(
            error < if first { 1e-2 } else { 2e-5 },
            "{}: {error:e}",
            method.info.id
        );
    }
    // What the guide exerts is told as that of the mount.
    let (end, _) = run_to(&mut scene, "dopri5", Resolution::Tolerance(1e-9), t);
    let told = channel(&mut scene, &end, "mount_torque:rack");
    let exerted = -guide.stiffness * end.q[0] - guide.damping * end.v[0];
    assert!((told - exerted).abs() < 1e-9 * force, "{told} {exerted}");
}

/// A force below the sliding force is carried: the rack moves by `-l ln(1 - F/F_c)` and stops; smoothed friction
/// creeps.
#[test]
fn what_sticks_stays_where_it_is() {
    let (force, sliding, length) = (90.0, 100.0, 2e-6);
    let held = -length * (1.0_f64 - force / sliding).ln();
    for (form, sticks) in [
        (FrictionForm::StickSlip(length), true),
        (FrictionForm::Regularised(1e-3), false),
    ] {
        let guide = Guide {
            stiffness: 0.0,
            // Overdamped: what sticks and turns has slid a little.
            damping: 2e4,
            friction: friction(sliding, form),
        };
        let mut scene = build(
            &guided_rack(guide, 0.0, force),
            &[rigid(), rigid()],
            &contact(1e10),
        );
        let [early, late] = [0.05, 0.25].map(|t| {
            run_to(&mut scene, "dopri5", Resolution::Tolerance(1e-9), t)
                .0
                .q[0]
        });
        println!("{form:?}: {early:.9e} m, {late:.9e} m, held at {held:.9e} m");
        if sticks {
            assert!((late - held).abs() < 1e-6 * held && (late - early).abs() < 2e-6 * held);
        } else {
            assert!(late - early > 10.0 * length);
        }
    }
}

/// Two gears in step that friction alone slows down evenly: 10 rad/s less 500 rad/s2, at rest after 0.02 s at 0.1 rad, as in the
/// example `LossyGearDemo3` of the Modelica Standard Library. What sticks over a way `l` swings back by a part of `l`.
fn slowing(length: f64) -> Scene {
    let mut spec = pair_of(
        gear("pinion", spur(20), 0.0, 10.0),
        gear("wheel", spur(30), 0.101, -10.0 / 1.5),
        start(gearbench_models::geometry::Side::Left, 3e-4),
    );
    for (g, (inertia, slows)) in spec
        .gears
        .iter_mut()
        .zip([(0.02, 500.0), (0.08, 500.0 / 1.5)])
    {
        g.inertia = Some(inertia);
        g.guide = Some(Guide {
            friction: friction(inertia * slows, FrictionForm::StickSlip(length)),
            ..Guide::default()
        });
    }
    build(&spec, &[rigid(), rigid()], &contact(1e10))
}

#[test]
fn friction_slows_down_evenly_and_holds() {
    for length in [1e-5, 1e-6, 1e-7] {
        let mut scene = slowing(length);
        let tight = Resolution::Tolerance(1e-9);
        let (half, _) = run_to(&mut scene, "dopri5", tight, 0.01);
        let (end, ledger) = run_to(&mut scene, "dopri5", tight, 0.03);
        let (moving, still) = ((half.v[0] - 5.0).abs(), (end.q[0] - 0.1).abs());
        println!(
            "over {length:.0e} rad: speed at half of the way off by {moving:.1e} rad/s, angle at rest by {still:.1e} rad, energy {:.1e}",
            ledger.residual_relative()
        );
        // The way over which friction sets in is not slowed down on: v dv = a dx.
        assert!(moving < 1.1 * 500.0 * length / 5.0, "{moving:e}");
        assert!(still < 0.1 * length, "{still:e}");
        assert!(ledger.residual_relative().abs() < 1e-6);
    }
}

/// Friction dissipates the sliding force times the distance; the ledger closes with a spring and with reversals of the
/// motion.
#[test]
fn the_ledger_has_the_work_of_friction() {
    let guide = Guide {
        stiffness: 3e5,
        damping: 0.0,
        friction: friction(20.0, FrictionForm::StickSlip(1e-6)),
    };
    let spec = guided_rack(guide, 0.2, 0.0);
    let mut scene = build(&spec, &[rigid(), rigid()], &contact(1e10));
    let energy = 0.5 * 2.0 * 0.2 * 0.2;
    let mut last = f64::INFINITY;
    for rtol in [1e-6, 1e-8] {
        let (end, ledger) = run_to(&mut scene, "dopri5", Resolution::Tolerance(rtol), 0.2);
        println!(
            "rtol {rtol:.0e}: at rest at {:.3e} m, residual {:.1e} of the energy",
            end.q[0],
            ledger.residual() / energy
        );
        last = ledger.residual().abs() / energy;
        // It comes to rest where friction holds the spring.
        assert!(
            end.q[0].abs() <= 20.0 / 3e5 && end.v[0].abs() < 2e-3,
            "{end:?}"
        );
    }
    assert!(last < 1e-6, "{last:e}");
    let [a, b] = [0, 1].map(|_| run_to(&mut scene, "dopri5", Resolution::Tolerance(1e-6), 0.2).0);
    assert_eq!(a, b);
}

/// For a guided gear, its mate and a guided body on an elastic shaft, tangents agree with finite differences, and
/// corrections with tangents.
#[test]
fn tangents_and_corrections_know_guides() {
    let guide = |stiffness, form| Guide {
        stiffness,
        damping: 0.3,
        friction: friction(2.0, form),
    };
    let mut spec = case_a(-2e-6);
    spec.gears[1].guide = Some(guide(50.0, FrictionForm::StickSlip(1e-5)));
    let mut body = BodySpec::new("motor", 1e-3);
    body.guide = Some(guide(20.0, FrictionForm::Regularised(0.1)));
    spec.shafts.push(ShaftSpec {
        name: "input".into(),
        stations: vec![
            Station {
                place: 0.0,
                carries: StationMember::Body(Box::new(body)),
            },
            Station {
                place: 0.1,
                carries: StationMember::Gear(0),
            },
        ],
        sections: vec![gearbench_models::spec::Section {
            length: 0.1,
            kind: gearbench_models::spec::SectionKind::Coupling { stiffness: 900.0 },
            divisions: 1,
            damping: None,
        }],
        ..ShaftSpec::default()
    });
    for model in [rigid(), movable(1e8, 4.8e-3, 20.0)] {
        let mut scene = build(&spec, &[model.clone(), model.clone()], &contact(1.5e10));
        let mut s = scene.initial();
        scene.begin(&mut s, true);
        let n = s.q.len();
        // Off the place where friction has begun.
        let (scale, speed) = scales(&scene);
        let mut numbers = Numbers::new(7);
        for i in 0..n {
            s.q[i] += scale[i] * (0.3 + 0.1 * numbers.draw());
            s.v[i] += speed[i] * 0.2 * numbers.draw();
        }
        let direction: Vec<f64> = (0..n).map(|i| scale[i] * numbers.draw()).collect();
        let c = Coeffs {
            m: 1.0,
            d: 2e-6,
            k: 3e-12,
        };
        let h = 1e-4;
        let mut forces = |sign: f64| {
            let mut moved = s.clone();
            for i in 0..n {
                moved.q[i] += sign * h * direction[i];
                moved.v[i] += sign * h * 1e3 * direction[i];
            }
            let mut f = vec![0.0; n];
            scene.force(moved.at(), &mut f);
            f
        };
        let (up, down) = (forces(1.0), forces(-1.0));
        let faster: Vec<f64> = direction.iter().map(|x| 1e3 * x).collect();
        let mut change = vec![0.0; n];
        scene.tangent_times(s.at(), &direction, &faster, &mut change);
        let size = change.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        for i in 0..n {
            let between = (up[i] - down[i]) / (2.0 * h);
            assert!(
                (between - change[i]).abs() < 1e-6 * size,
                "{i}: {between} {}",
                change[i]
            );
        }
        let (dq, dv): (Vec<f64>, Vec<f64>) = direction.iter().map(|x| (c.k * x, c.d * x)).unzip();
        let (mut df, mut mass) = (vec![0.0; n], vec![0.0; n]);
        scene.tangent_times(s.at(), &dq, &dv, &mut df);
        scene.apply_mass(s.at(), &direction, &mut mass);
        let mut x: Vec<f64> = mass.iter().zip(&df).map(|(m, f)| m - f).collect();
        scene.correct(s.at(), c, &mut x).unwrap();
        let worst = x.iter().zip(&direction).zip(&scale);
        let worst = worst.fold(0.0_f64, |m, ((x, y), s)| m.max((x - y).abs() / s));
        println!("{}: correction off by {worst:.1e}", model.id());
        assert!(worst < 1e-9, "{worst:e}");
    }
}

/// Invalid guides are refused.
#[test]
fn guides_that_cannot_be() {
    let refused = |spec: &SceneSpec, word: &str| {
        let models = [rigid(), rigid()];
        let error = try_build(spec, &models, &contact(1e10))
            .map(|_| ())
            .unwrap_err();
        let text = error.to_string();
        assert!(text.contains(word) && text.contains("rack"), "{text}");
    };
    let negative = Guide {
        stiffness: -1.0,
        ..SPRING
    };
    refused(&guided_rack(negative, 0.0, 0.0), "stiffness -1");
    let endless = Guide {
        damping: f64::INFINITY,
        ..SPRING
    };
    refused(&guided_rack(endless, 0.0, 0.0), "damping inf");
    assert!(DryFriction::new(-1.0, FrictionForm::StickSlip(1e-6)).is_err());
    assert!(DryFriction::new(1.0, FrictionForm::StickSlip(0.0)).is_err());
}
