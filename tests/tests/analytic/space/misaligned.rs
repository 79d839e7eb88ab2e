//! Skewed contact of spur gears compared with the elastic foundation of ISO 6336-1, and forces of helical gears.
//!
//! With the mesh deviation `F` over the width `b`, a stiffness `c` per width and the mean load `w`, `q = F c/(2 w)`: the load
//! at the end is `1 + q` times the mean where teeth touch over the whole width, else `2 sqrt(q)`; with the approach `d` of
//! that end the force is `c b d^2/(2 F)` up to `d = F`, then `c b (d - F/2)`.

use super::*;
use gearbench_integrators::{Resolution, TimePlan};
use gearbench_models::law::Damping;

/// Returns the contact per slice of a state: share of the width of each, and its force.
fn loads(scene: &mut Scene, s: &State) -> Vec<f64> {
    let forces = scene.contact_forces(s.at());
    forces.iter().map(|f| f.normal_force).collect()
}

#[test]
fn skewed_spur_gears_bear_as_an_elastic_foundation() {
    let slices = 400;
    let (width, per_width, skew) = (0.02, 1.5e10, 2e-4);
    let mut spec = helical_pair(0.0, 0.0, false);
    // Within the plane of action: a turn of the axis towards the line of action.
    let angle = std::f64::consts::FRAC_PI_2 - (0.09396926207859084_f64 / 0.1001).acos();
    let line = Vec3::new(angle.cos(), angle.sin(), 0.0);
    // By half for either gear, so that their face widths stay in front of each other.
    for (gear, sign) in spec.gears.iter_mut().zip([0.5, -0.5]) {
        let turn = nalgebra::Rotation3::new(Vec3::z().cross(&line) * sign * skew);
        gear.axes = turned_to(&gear.axes, &(turn * Vec3::z()));
    }
    let mut law = contact(per_width);
    law.damping = Damping::None;
    law.slices = Some(slices);
    let mut scene = build(&spec, &[rigid(), rigid()], &law);
    // The gears stand so that the pair in the middle touches alone.
    let deviation = skew * width;
    let stiffness = per_width;
    let mut worst = [0.0_f64; 2];
    for approach in [0.3, 0.6, 0.95, 1.2, 2.0, 4.0] {
        let d = approach * deviation;
        let mut s = scene.initial();
        // The middle lies half the deviation behind the end that touches first.
        s.q[0] += (d - 0.5 * deviation) / effective_radius(&spec.gears[0].body);
        let found = loads(&mut scene, &s);
        let force: f64 = found.iter().sum();
        let expected = if approach < 1.0 {
            stiffness * width * d * d / (2.0 * deviation)
        } else {
            stiffness * width * (d - 0.5 * deviation)
        };
        let mean = force / width;
        let q = deviation * stiffness / (2.0 * mean);
        let factor = if q <= 1.0 { 1.0 + q } else { 2.0 * q.sqrt() };
        let largest = found.iter().copied().fold(0.0, f64::max) * slices as f64 / width;
        worst[0] = worst[0].max((force / expected - 1.0).abs());
        worst[1] = worst[1].max((largest / mean / factor - 1.0).abs());
        println!(
            "approach {approach} of the deviation: force {force:.2} N ({expected:.2}), load factor {:.4} ({factor:.4})",
            largest / mean
        );
    }
    println!(
        "skewed spur gears: force within {:.3} %, load at the end within {:.3} %",
        100.0 * worst[0],
        100.0 * worst[1]
    );
    // Flanks askew leave a gap of the order of the angle squared; and the last slice bears the load of its middle.
    assert!(worst[0] < 1e-3, "force: {:.2e}", worst[0]);
    assert!(worst[1] < 6e-3, "load factor: {:.2e}", worst[1]);
}

#[test]
fn forces_of_helical_gears_are_those_of_the_textbook() {
    // z = 40/80 on radii of 2 and 4 m, normal pressure angle 20, helix 10 degrees, 1000 N m on the small one (Chrono's test
    // of gears, utest_CH_gears.cpp).
    let helix = 10_f64.to_radians();
    let module = 2.0 * 2.0 * helix.cos() / 40.0;
    let params = |teeth, helix| GearParams {
        teeth,
        module,
        helix_angle: helix,
        face_width: 0.3,
        bore_radius: 0.5,
        ..GearParams::default()
    };
    let spec = pair_of(
        gear("pinion", params(40, helix), 0.0, 0.0),
        gear("wheel", params(80, -helix), 6.0, 0.0),
        start(Side::Left, 0.0),
    );
    let mut free = spec.clone();
    free.gears
        .iter_mut()
        .for_each(|g| g.lateral = on_bearings());
    for spec in [spec, free] {
        let mut law = contact(1.5e10);
        law.damping = Damping::None;
        law.slices = Some(4);
        let mut scene = build(&spec, &[rigid(), rigid()], &law);
        let mut s = scene.initial();
        s.q[0] += 1e-6;
        let found = scene.contact_forces(s.at());
        let force: Vec3 = found.iter().map(|f| f.force).sum();
        let torque: f64 = found.iter().map(|f| -f.on_hubs[0]).sum();
        let normal: f64 = found.iter().map(|f| f.normal_force).sum();
        let scale = 1000.0 / torque;
        let [radial, tangential, axial] = [force.x, force.y, force.z].map(|f| (f * scale).abs());
        let off = [
            (tangential, 500.0),
            (radial, 184.792530904),
            (axial, 88.163490354),
            (normal * scale, 540.297214975),
        ]
        .map(|(x, y)| (x / y - 1.0_f64).abs());
        println!("tangential {tangential:.6}, radial {radial:.6}, axial {axial:.6} N");
        let worst = off.iter().copied().fold(0.0, f64::max);
        println!("helical gears: forces within {worst:.1e} of the textbook");
        assert!(off.iter().all(|x| *x < 1e-9), "{off:?}");
    }
}

#[test]
fn an_impact_is_longer_and_weaker_the_more_askew_its_gears() {
    let mut peaks = Vec::new();
    for thousandths in 0..40 {
        let mut spec = helical_pair(0.0, 1.5e-5, false);
        let angle = std::f64::consts::FRAC_PI_2 - 20.157_f64.to_radians();
        let line = Vec3::new(angle.cos(), angle.sin(), 0.0);
        let by = (1e-3 * f64::from(thousandths)).to_radians();
        let turn = nalgebra::Rotation3::new(Vec3::z().cross(&line) * by);
        spec.gears[0].axes = turned_to(&spec.gears[0].axes, &(turn * Vec3::z()));
        let mut law = contact(1.5e10);
        law.damping = Damping::None;
        law.slices = Some(24);
        let mut scene = build(&spec, &[rigid(), rigid()], &law);
        let s = scene.initial();
        // Steps so short that the peak lies on one.
        let plan = TimePlan::new(1.5e-4, Resolution::Step(1e-7));
        let end = run_from(&mut scene, s, "velocity-verlet", &plan);
        end.result.unwrap();
        peaks.push(end.peak);
    }
    let falls = peaks
        .windows(2)
        .map(|w| w[0] - w[1])
        .fold(f64::INFINITY, f64::min);
    println!(
        "peaks from {:.1} to {:.1} N, falling by at least {falls:.2e} N per thousandth of a degree",
        peaks[0], peaks[39]
    );
    assert!(falls > 0.0, "the peak rises somewhere: {falls:.2e}");
    assert!(
        peaks[39] < 0.99 * peaks[0],
        "{} to {} N",
        peaks[0],
        peaks[39]
    );
}
