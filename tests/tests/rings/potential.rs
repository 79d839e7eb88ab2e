//! Forces of elastic pairs compared with differences of the energy.

use super::*;
use gearbench_tests::{Numbers, scales};

/// Checks forces on hubs and modes at a state with deformed gears.
fn check(name: &str, spec: &SceneSpec, contact: &ContactSpec, width: f64, bound: f64) {
    let mut scene = built(spec, &elastic([8.0, width], 20.0), contact);
    let (size, _) = scales(&scene);
    let unit = scene.magnitudes().deflection;
    let mut numbers = Numbers::new(5);
    for (i, side) in [Side::Left, Side::Right, Side::Left]
        .into_iter()
        .enumerate()
    {
        let roll = -0.15 + 0.13 * i as f64;
        // Over the backlash to the other flank.
        let press = match side {
            Side::Left => 12e-6,
            Side::Right => 12e-6 + 8e-5,
        };
        let mut s = rolled(&scene, spec, roll, (side, press));
        for g in scene.gears() {
            for k in g.range().skip(1) {
                s.q[k] = size[k] / unit * 1e-6 * numbers.draw() / 20.0_f64.sqrt();
            }
        }
        let mut f = vec![0.0; s.q.len()];
        scene.force(s.at(), &mut f);
        let mut worst = 0.0_f64;
        // Work along a deflection of a tooth is what forces are held to.
        let work: Vec<f64> = (f.iter().zip(&size))
            .map(|(f, x)| (f * x / unit).abs())
            .collect();
        let largest = work.iter().fold(0.0_f64, |m, w| m.max(*w));
        assert!(largest > 100.0, "{name}: nothing presses: {largest}");
        for k in 0..f.len() {
            let h = 2e-9 * size[k] / unit;
            let mut energy = |by: f64| {
                let mut moved = s.clone();
                moved.q[k] += by;
                potential_energy(&mut scene, &moved)
            };
            let slope = (8.0 * (energy(h) - energy(-h)) - (energy(2.0 * h) - energy(-2.0 * h)))
                / (12.0 * h);
            worst = worst.max((f[k] + slope).abs() * size[k] / unit / largest);
        }
        println!(
            "{name}, {side:?} flank: forces off slopes of the energy by {worst:.1e} of {largest:.0} N"
        );
        assert!(worst < bound, "{name}: {worst:.2e}");
    }
}

#[test]
fn forces_are_slopes_of_the_energy() {
    let points = touching(PointContact::new(1e15), None);
    let half_space = touching(FlankContact::HalfSpace, Some(1));
    let spec = pair_in(2.0, params(0.0), Side::Left, 0.0);
    let helical = pair_in(2.0, params(0.2), Side::Left, 0.0);
    for (name, contact, bound) in [
        ("points", &points, 1e-6),
        ("half-spaces", &half_space, 1e-6),
    ] {
        check(name, &spec, contact, 1.0, bound);
        let other = exchanged(spec.clone());
        check(
            &format!("{name}, the ring first"),
            &other,
            contact,
            1.0,
            bound,
        );
    }
    check("helical points", &helical, &points, 4.0, 1e-6);
}
