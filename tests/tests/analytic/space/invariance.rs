//! A scene rotated in space, mirrored, or with pinion and wheel exchanged, gives the same results.

use super::*;
use gearbench_integrators::{Resolution, TimePlan};
use gearbench_models::law::Damping;
use gearbench_models::spec::ModelSpec;
use nalgebra::Rotation3;

/// Returns a helical pair on bearings with a gap, both axes tilted, in an impact.
fn striking() -> SceneSpec {
    let mut spec = helical_pair(0.25, 2e-6, true);
    tilt(&mut spec, 0, 6e-4, -3e-4);
    tilt(&mut spec, 1, -2e-4, 5e-4);
    for gear in &mut spec.gears {
        gear.lateral = on_bearings();
    }
    spec
}

/// Returns conical gears on bearings in an impact.
fn striking_cones() -> SceneSpec {
    let mut spec = conical::seed_pair(1e-5, 0.0);
    spec.meshes[0].start.gap = 2e-6;
    spec.gears[0].speed = 20.0;
    for gear in &mut spec.gears {
        gear.lateral = on_bearings();
    }
    spec
}

/// Returns the coordinates of both gears at the end of an impact, by name; those of the hub first.
fn end(spec: &SceneSpec, models: &[ModelSpec], step: f64) -> Vec<(String, Vec<f64>)> {
    let mut law = contact(1.5e10);
    law.damping = Damping::None;
    law.slices = Some(6);
    if models.iter().all(|m| m.id() == "elastic") {
        law = elastic::on_points(0.0);
    }
    let mut scene = build(spec, models, &law);
    let s = scene.initial();
    let end = run_from(
        &mut scene,
        s,
        "velocity-verlet",
        &TimePlan::new(6e-5, Resolution::Step(step)),
    );
    end.result.unwrap();
    assert!(end.peak > 100.0, "a peak of {} N is no impact", end.peak);
    let of = |g: &gearbench_models::scene::SceneGear| {
        let n = g.model.hub().first();
        let first = g.range().start;
        let (q, v) = (&end.state.q[first..][..n], &end.state.v[first..][..n]);
        (g.name.clone(), q.iter().chain(v).copied().collect())
    };
    scene.gears().iter().map(of).collect()
}

/// Returns the largest difference of two results relative to the largest of each kind of coordinate.
fn difference(a: &[(String, Vec<f64>)], b: &[(String, Vec<f64>)], signs: [f64; 6]) -> f64 {
    let mut worst = 0.0_f64;
    for (name, x) in a {
        let (_, y) = b.iter().find(|(other, _)| other == name).unwrap();
        for (half, (x, y)) in x.chunks(6).zip(y.chunks(6)).enumerate() {
            // Own turn, then x, y, z, then tilts: each kind by its largest.
            for range in [0..1, 1..4, 4..6] {
                let size = x[range.clone()].iter().fold(0.0_f64, |m, x| m.max(x.abs()));
                for k in range {
                    let off = (x[k] - signs[k] * y[k]).abs() / size;
                    assert!(off.is_finite(), "{name} {half} {k}");
                    worst = worst.max(off);
                }
            }
        }
    }
    worst
}

#[test]
fn turned_mirrored_and_exchanged_scenes_give_the_same_numbers() {
    let teeth = movable(5.3e8, 4.8e-3, 20.0);
    for (name, models) in [
        ("rigid", [rigid(), rigid()]),
        ("movable teeth", [teeth.clone(), teeth]),
        ("elastic", [elastic::reduced(), elastic::reduced()]),
    ] {
        let spec = striking();
        let step = if name == "rigid" { 2e-7 } else { 5e-8 };
        let plain = end(&spec, &models, step);
        let mut turned = spec.clone();
        let turn = Rotation3::new(Vec3::new(0.7, -1.1, 0.4));
        for gear in &mut turned.gears {
            gear.axes = gear.axes.map(|axis| turn * axis);
            gear.position = (turn * Vec3::from(gear.position) + Vec3::new(0.2, -0.1, 0.3)).into();
        }
        let by_turning = difference(&plain, &end(&turned, &models, step), [1.0; 6]);
        let mut mirrored = striking();
        for (gear, other) in mirrored
            .gears
            .iter_mut()
            .zip(helical_pair(-0.25, 2e-6, true).gears)
        {
            // Mirrored at z = 0, the third axis turned upwards again.
            gear.axes = gear.axes.map(|a| Vec3::new(a.x, a.y, -a.z));
            gear.axes[2] *= -1.0;
            gear.body = other.body;
        }
        // Displacements along x and y and the turn stay, those along z and the tilts are reversed.
        let signs = [1.0, 1.0, 1.0, -1.0, -1.0, -1.0];
        let by_mirroring = difference(&plain, &end(&mirrored, &models, step), signs);
        let mut exchanged = spec.clone();
        exchanged.gears.reverse();
        let by_exchange = difference(&plain, &end(&exchanged, &models, step), [1.0; 6]);
        println!(
            "{name}: turned {by_turning:.1e}, mirrored {by_mirroring:.1e}, exchanged {by_exchange:.1e}"
        );
        assert!(by_turning < 1e-9, "{name} turned: {by_turning:.2e}");
        assert!(by_mirroring < 1e-9, "{name} mirrored: {by_mirroring:.2e}");
        assert!(by_exchange < 1e-9, "{name} exchanged: {by_exchange:.2e}");
    }
}

#[test]
fn turned_and_exchanged_conical_gears_give_the_same_numbers() {
    let teeth = movable(4.4e9, 3.4e-2, 20.0);
    for (name, models) in [
        ("rigid", [rigid(), rigid()]),
        ("movable teeth", [teeth.clone(), teeth]),
        ("elastic", [elastic::reduced(), elastic::reduced()]),
    ] {
        let spec = striking_cones();
        let step = if name == "elastic" { 1e-7 } else { 2e-7 };
        let plain = end(&spec, &models, step);
        let mut turned = spec.clone();
        let turn = Rotation3::new(Vec3::new(0.7, -1.1, 0.4));
        for gear in &mut turned.gears {
            gear.axes = gear.axes.map(|axis| turn * axis);
            gear.position = (turn * Vec3::from(gear.position) + Vec3::new(0.2, -0.1, 0.3)).into();
        }
        let by_turning = difference(&plain, &end(&turned, &models, step), [1.0; 6]);
        let mut exchanged = spec.clone();
        exchanged.gears.reverse();
        let by_exchange = difference(&plain, &end(&exchanged, &models, step), [1.0; 6]);
        println!("{name}: turned {by_turning:.1e}, exchanged {by_exchange:.1e}");
        assert!(by_turning < 1e-9, "{name} turned: {by_turning:.2e}");
        assert!(by_exchange < 1e-9, "{name} exchanged: {by_exchange:.2e}");
    }
}
