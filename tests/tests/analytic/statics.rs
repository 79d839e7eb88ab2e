//! Static equilibrium of scenes: a torque carried by a tooth contact, compared with springs in series.

use gearbench_integrators::{EquilibriumError, EquilibriumOptions, State, equilibrium};
use gearbench_models::scene::Scene;
use gearbench_models::spec::{Load, ModelSpec, Mount, Profile, SceneSpec, effective_radius};
use gearbench_tests::*;

/// Contact stiffness per width [N/m per m], and over the width of 20 mm.
const PER_WIDTH: f64 = 5e10;

/// Returns case A with a torque [N m] on the pinion and the wheel fixed, overlapping by 5 um at the pitch point.
fn load_references(torque: f64, wheel: Mount) -> SceneSpec {
    let mut spec = case_a(-5e-6);
    spec.gears[0].speed = 0.0;
    spec.gears[0].loads = vec![Load::Applied(Profile::Constant(torque))];
    spec.gears[1].mount = wheel;
    spec
}

/// Returns the torque of the pinion over its base radius [N], and the contact stiffness over the width [N/m].
fn force_and_stiffness(spec: &SceneSpec, torque: f64) -> (f64, f64) {
    let gearbench_models::spec::Body::Gear(g) = &spec.gears[0].body else {
        panic!("a gear")
    };
    (
        torque / effective_radius(&spec.gears[0].body),
        PER_WIDTH * g.face_width(),
    )
}

fn at_rest(spec: &SceneSpec, models: &[ModelSpec]) -> (Scene, State) {
    let mut scene = build(spec, models, &contact(PER_WIDTH));
    let mut s = scene.initial();
    equilibrium(&mut scene, &mut s, &EquilibriumOptions::default()).unwrap();
    (scene, s)
}

#[test]
fn a_torque_is_held_by_the_contact_of_every_model() {
    let torque = 60.0;
    let spec = load_references(torque, Mount::Fixed);
    let (force, k) = force_and_stiffness(&spec, torque);
    for model in models() {
        let (mut scene, s) = at_rest(&spec, &[usual(&model), usual(&model)]);
        let found = channel(&mut scene, &s, "force:0");
        assert!(
            (found - force).abs() < 1e-9 * force,
            "{}: {found} {force}",
            model.id
        );
        let other = channel(&mut scene, &s, "contact_torque:wheel");
        let want = force * effective_radius(&spec.gears[1].body);
        assert!((other.abs() - want).abs() < 1e-9 * want, "{}", model.id);
        // The line of action advances by the law in series with what the model adds.
        let advance = s.q[0] * effective_radius(&spec.gears[0].body) + 5e-6;
        let more = advance - force / k;
        match model.id {
            "rigid" => assert!(more.abs() < 1e-15, "{more}"),
            // Two teeth of 5.3e8 N/m.
            "movable-teeth" => assert!((more * 5.3e8 / force - 2.0).abs() < 0.3, "{more}"),
            // The webs, half of the inertia on each.
            "elastic-web" => {
                let omega = std::f64::consts::TAU * 2e4;
                let give = spec.gears.iter().map(|g| {
                    let rim = 0.5 * g.inertia.unwrap();
                    effective_radius(&g.body).powi(2) / (rim * omega * omega)
                });
                let want = force * give.sum::<f64>();
                assert!((more - want).abs() < 1e-9 * want, "{more} {want}");
            }
            _ => {}
        }
    }
}

#[test]
fn gears_that_nothing_holds_are_named() {
    for model in models() {
        let both = [usual(&model), usual(&model)];
        let at_rest = |spec: &SceneSpec| {
            let mut scene = build(spec, &both, &contact(PER_WIDTH));
            let mut s = scene.initial();
            let result = equilibrium(&mut scene, &mut s, &EquilibriumOptions::default());
            (result, channel(&mut scene, &s, "contact_torque:pinion"))
        };
        let (result, _) = at_rest(&load_references(60.0, Mount::Revolute));
        assert!(
            matches!(result, Err(EquilibriumError::SingularTangent { .. })),
            "{}: {result:?}",
            model.id
        );
        // Turned the other way against a held wheel the pinion may find the other flank, never rest on nothing.
        let (result, torque) = at_rest(&load_references(-1.0, Mount::Fixed));
        match result {
            Ok(_) => assert!((torque - 1.0).abs() < 1e-6, "{}: {torque}", model.id),
            Err(e) => assert!(
                matches!(e, EquilibriumError::SingularTangent { .. }),
                "{}: {e}",
                model.id
            ),
        }
    }
}

#[test]
fn driven_gears_stand_where_their_motion_has_brought_them() {
    // Both hubs prescribed: the approach along the line of action is rb1 times the pinion's advance.
    let approach = 17e-6;
    let mut spec = load_references(0.0, Mount::Fixed);
    spec.meshes[0].start.gap = 0.0;
    spec.gears[0].loads.clear();
    let rb = effective_radius(&spec.gears[0].body);
    spec.gears[0].mount = Mount::Driven(Profile::Ramp {
        from: 2.0 * approach / rb,
        to: 0.0,
        start: 0.0,
        end: 1.0,
    });
    let (_, k) = force_and_stiffness(&spec, 1.0);
    for model in models() {
        let both = [usual(&model), usual(&model)];
        let mut scene = build(&spec, &both, &contact(PER_WIDTH));
        let mut s = scene.initial();
        s.t = 2.0;
        equilibrium(&mut scene, &mut s, &EquilibriumOptions::default()).unwrap();
        let force = channel(&mut scene, &s, "force:0");
        if model.id == "rigid" {
            assert!((force - k * approach).abs() < 1e-9 * force);
        } else {
            assert!(force > 0.1 * k * approach && force < 0.9 * k * approach);
        }
    }
}
