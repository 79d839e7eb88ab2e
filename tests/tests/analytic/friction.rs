//! Sliding friction: direction, size, flip at the pitch point, energy.

use gearbench_integrators::{Events, Resolution, SecondOrderSystem};
use gearbench_models::law::{Damping, Friction};
use gearbench_models::spec::{ContactSpec, Load, Mount, Profile, mesh_layout};
use gearbench_tests::*;

const MU: f64 = 0.08;
const V_REF: f64 = 0.01;

fn rubbing(per_width: f64) -> ContactSpec {
    ContactSpec {
        friction: Some(Friction::new(MU, V_REF).unwrap()),
        ..contact(per_width)
    }
}

#[test]
fn friction_opposes_sliding_and_flips_at_the_pitch_point() {
    // Speeds roll at the pitch point; beside it gear 2 slides over gear 1 by (omega_1 + omega_2) (s - s_C).
    for turning in [1.0, -1.0] {
        let spec = case_a(0.0);
        let l = mesh_layout(&spec.gears[0], &spec.gears[1]).unwrap();
        let mut scene = build(&spec, &[rigid(), rigid()], &rubbing(1.5e10));
        let (mut before, mut after) = (0, 0);
        for i in 0..200 {
            let roll = 0.002 * f64::from(i) - 0.2;
            let mut s = scene.initial();
            s.q = vec![roll + 1e-4, -roll / 1.5];
            s.v = vec![turning * 20.0, -turning * 20.0 / 1.5];
            scene.begin(&mut s, false);
            for c in scene.contact_forces(s.at()) {
                let n = c.force - c.force.dot(&normal(&scene, &s, &c)) * normal(&scene, &s, &c);
                let (_, candidate) = candidates(&scene, &s)
                    .into_iter()
                    .find(|(_, x)| x.points[0].x == c.x)
                    .unwrap();
                // Velocity of gear 2 over gear 1 at the contact.
                let at = |k: usize, w: f64| {
                    let r = c.x - scene.gears()[k].model.hub().centre;
                    w * gearbench_models::Vec3::new(-r.y, r.x, 0.0)
                };
                let relative = at(1, s.v[1]) - at(0, s.v[0]);
                let slide = relative - relative.dot(&candidate.normal) * candidate.normal;
                let want = (20.0 + 20.0 / 1.5) * (candidate.s - l.pitch_point).abs();
                assert!(
                    (slide.norm() - want).abs() < 1e-9,
                    "slides at {} m/s, {want} m/s",
                    slide.norm()
                );
                let force = MU * c.normal_force * (slide.norm() / V_REF).tanh();
                assert!(
                    (n.norm() - force).abs() < 1e-9 * c.normal_force,
                    "{} N, {force} N",
                    n.norm()
                );
                assert!(n.dot(&slide) <= 0.0, "friction drives the sliding");
                // The force on gear 2 points to one side before the pitch point, to the other after it.
                let t = gearbench_models::Vec3::new(-candidate.normal.y, candidate.normal.x, 0.0);
                let side = n.dot(&t) * turning;
                if candidate.s < l.pitch_point - 1e-5 {
                    assert!(
                        side < 0.0 || n.norm() < 1e-9,
                        "{side} before the pitch point"
                    );
                    before += 1;
                } else if candidate.s > l.pitch_point + 1e-5 {
                    assert!(
                        side > 0.0 || n.norm() < 1e-9,
                        "{side} after the pitch point"
                    );
                    after += 1;
                }
            }
        }
        assert!(before > 50 && after > 50);
    }
}

fn normal(
    scene: &gearbench_models::scene::Scene,
    s: &gearbench_integrators::State,
    c: &gearbench_models::scene::ContactForce,
) -> gearbench_models::Vec3 {
    candidates(scene, s)
        .into_iter()
        .find(|(_, x)| x.points[0].x == c.x)
        .map(|(_, x)| x.normal)
        .unwrap()
}

#[test]
fn friction_never_drives_and_its_loss_is_in_the_ledger() {
    for models in [
        [rigid(), rigid()],
        [movable(1e8, 4.8e-3, 50.0), movable(1e8, 4.8e-3, 50.0)],
        [web(0.02), rigid()],
    ] {
        for driven in [false, true] {
            let mut spec = case_a(0.0);
            spec.gears[0].speed = 60.0;
            spec.gears[1].speed = -40.0;
            spec.gears[1].loads = vec![Load::Applied(Profile::Constant(40.0))];
            if driven {
                spec.gears[0].mount = Mount::Driven(Profile::Constant(60.0));
            } else {
                spec.gears[0].loads = vec![Load::Applied(Profile::Constant(40.0 / 1.5))];
            }
            let damping = Damping::KelvinVoigtRatio { ratio: 0.05 };
            let run_with = |friction: Option<Friction>| {
                let contact = ContactSpec {
                    friction,
                    damping,
                    ..contact(1.5e10)
                };
                let mut scene = build(&spec, &models, &contact);
                run(&mut scene, "dopri5", Resolution::Tolerance(1e-8), 0.012).unwrap("friction")
            };
            let (with, without) = (
                run_with(Some(Friction::new(MU, V_REF).unwrap())),
                run_with(None),
            );
            let what = format!("{}, driven {driven}", models[0].id());
            let residual = with.ledger.residual_relative();
            assert!(
                residual.abs() < 1e-5,
                "{what}: {residual:.2e} of the energy is not explained"
            );
            // Friction takes about mu N times the sliding path; damping alone far less.
            let more = with.ledger.dissipated - without.ledger.dissipated;
            assert!(more > 0.05, "{what}: friction takes {more} J");
        }
    }
}

#[test]
fn friction_at_rest_carries_no_force_and_has_its_slope() {
    // The regularised law is zero at rest and rises with mu N / v_ref.
    let mut scene = build(&case_a(0.0), &[rigid(), rigid()], &rubbing(1.5e10));
    let mut s = scene.initial();
    s.q[0] += 0.03;
    s.q[1] -= 0.03 / 1.5 - 1e-4;
    s.v.fill(0.0);
    scene.begin(&mut s, false);
    let still = scene.contact_forces(s.at());
    assert!(!still.is_empty());
    for c in &still {
        assert!((c.force.norm() - c.normal_force).abs() < 1e-12 * c.normal_force);
    }
    let w = 1e-6;
    s.v = vec![1.5 * w, -w];
    let n: f64 = still.iter().map(|c| c.normal_force).sum();
    let mut f = vec![0.0; 2];
    scene.force(s.at(), &mut f);
    let l = mesh_layout(&case_a(0.0).gears[0], &case_a(0.0).gears[1]).unwrap();
    for c in scene.contact_forces(s.at()) {
        let sliding = 2.5
            * w
            * (candidates(&scene, &s)
                .iter()
                .find(|(_, x)| x.points[0].x == c.x)
                .unwrap()
                .1
                .s
                - l.pitch_point);
        let tangential = (c.force.norm_squared() - c.normal_force.powi(2))
            .max(0.0)
            .sqrt();
        let want = MU * c.normal_force * sliding.abs() / V_REF;
        assert!(
            (tangential - want).abs() < 1e-3 * want + 1e-5 * n,
            "{tangential} {want}"
        );
    }
}
