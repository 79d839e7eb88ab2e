//! Flanks in space compared with the lines of action, and their forces with energy and momentum.

use super::*;
use gearbench_integrators::system::SecondOrderSystem;
use gearbench_models::contact::Candidate;
use gearbench_models::law::Damping;

#[test]
fn flanks_in_space_are_those_of_the_lines_of_action_on_parallel_axes() {
    let slices = |spec: &SceneSpec| {
        let mut c = contact(1.5e10);
        c.slices = Some(7);
        let helix = spec.gears[0].body.base_helix_angle();
        (c, helix)
    };
    for (name, spec) in [
        ("spur", helical_pair(0.0, 2e-6, false)),
        ("helical", helical_pair(0.3, 2e-6, false)),
        ("left hand", helical_pair(-0.3, 2e-6, false)),
        ("crowned, relieved", helical_pair(0.2, 2e-6, true)),
        ("rack", rack_pair(0.0)),
        ("helical rack", rack_pair(0.25)),
    ] {
        let mut free = spec.clone();
        free.gears[0].lateral = on_bearings();
        let (law, helix) = slices(&spec);
        let models = [rigid(), rigid()];
        let plain = build(&spec, &models, &law);
        let space = build(&free, &models, &law);
        let (mut compared, mut worst) = (0, 0.0_f64);
        for place in 0..60 {
            let roll = 0.013 * f64::from(place) - 0.4;
            for press in [4e-6, 1.2e-5, -7.8e-5] {
                let (a, b) = (
                    rolled(&plain, &spec, roll, press),
                    rolled(&space, &free, roll, press),
                );
                let (one, two) = (candidates(&plain, &a), candidates(&space, &b));
                for (_, c) in one.iter().filter(|(_, c)| c.gap < 2e-5) {
                    let Some((_, d)) = two.iter().find(|(_, d)| d.slot == c.slot) else {
                        panic!("{name}: a pair with the gap {:.2e} is missing", c.gap)
                    };
                    worst = worst.max((c.gap - d.gap).abs());
                    // On a rack the place is that of the gear's own flank.
                    if !name.contains("rack") {
                        worst = worst.max(0.3 * (c.s - d.s).abs());
                    }
                    compared += 1;
                }
            }
        }
        println!("{name}: {compared} pairs, helix {helix:.3}: gaps within {worst:.1e} m");
        assert!(compared > 300, "{name}: {compared}");
        // On lines of action the separation of modified flanks is a table, and a tip edge sees what is removed from its mate
        // where the line meets it.
        let modified = name == "crowned, relieved";
        assert!(
            worst < if modified { 3e-6 } else { 1e-10 },
            "{name}: {worst:.2e}"
        );
    }
}

#[test]
fn forces_of_flanks_in_space_are_those_of_a_potential() {
    let teeth = movable(5.3e8, 4.8e-3, 0.0);
    for (name, spec) in floating() {
        for models in [[rigid(), rigid()], [teeth.clone(), rigid()]] {
            // A stiffness that varies along the path, and pairs that bend one body.
            let mut law = contact(1.5e10);
            law.stiffness = weber_banaschek();
            law.damping = Damping::None;
            law.slices = Some(5);
            let mut scene = build(&spec, &models, &law);
            let mut numbers = Numbers::new(11);
            let (mut worst, mut pressed) = (0.0_f64, 0.0_f64);
            for place in 0..12 {
                let s = displaced(&scene, &spec, 0.04 * f64::from(place) - 0.25, &mut numbers);
                let mut f = vec![0.0; s.q.len()];
                scene.force(s.at(), &mut f);
                let (unit, _) = scales(&scene);
                for _ in 0..4 {
                    let along: Vec<f64> = unit.iter().map(|x| x * numbers.draw()).collect();
                    let at = |h: f64| {
                        let mut moved = s.clone();
                        moved
                            .q
                            .iter_mut()
                            .zip(&along)
                            .for_each(|(q, x)| *q += h * x);
                        moved
                    };
                    let work: f64 = f.iter().zip(&along).map(|(f, x)| f * x).sum();
                    let scale: f64 = f.iter().zip(&along).map(|(f, x)| (f * x).abs()).sum();
                    let h = 2e-3;
                    let slope =
                        (energy(&mut scene, &at(h)) - energy(&mut scene, &at(-h))) / (2.0 * h);
                    // Where a contact begins in between, central differences know neither side.
                    let closed = |h: f64| {
                        let found = candidates(&scene, &at(h));
                        found.iter().filter(|(_, c)| c.gap < 0.0).count()
                    };
                    if scale > 0.0 && closed(h) == closed(-h) {
                        worst = worst.max((work + slope).abs() / scale);
                        pressed = pressed.max(scale);
                    }
                }
            }
            println!("{name}: forces within {worst:.1e} of the energy's slopes");
            assert!(pressed > 0.0, "{name}: nothing touched");
            assert!(worst < 2e-7, "{name}: {worst:.2e}");
        }
    }
}

#[test]
fn contact_in_space_adds_no_momentum() {
    for (name, spec) in floating() {
        let mut law = contact(1.5e10);
        law.stiffness = weber_banaschek();
        law.slices = Some(5);
        let mut scene = build(&spec, &[rigid(), rigid()], &law);
        let mut numbers = Numbers::new(3);
        let mut worst = 0.0_f64;
        for place in 0..12 {
            let mut s = displaced(&scene, &spec, 0.04 * f64::from(place) - 0.25, &mut numbers);
            s.v.iter_mut().for_each(|v| *v = 0.01 * numbers.draw());
            let mut f = vec![0.0; s.q.len()];
            scene.force(s.at(), &mut f);
            worst = worst.max(work_of_rigid_motions(&scene, &s, &f));
        }
        println!("{name}: momentum within {worst:.1e}");
        assert!(worst < 1e-10, "{name}: {worst:.2e}");
    }
}

/// Neither does contact at points, those included that leave over a tip: how they fade out follows the master's hub too.
#[test]
fn contact_at_points_adds_no_momentum() {
    let own = crate::flank_points::flanked("rigid-flanks-test", 9, 3);
    let mut all = 0;
    for (name, spec) in floating().into_iter().take(4) {
        let mut scene = build(
            &spec,
            &[own.clone(), own.clone()],
            &super::elastic::on_points(0.0),
        );
        let mut numbers = Numbers::new(3);
        let (mut worst, mut leaving) = (0.0_f64, 0);
        for place in 0..96 {
            let s = displaced(&scene, &spec, 0.005 * f64::from(place) - 0.25, &mut numbers);
            let mut f = vec![0.0; s.q.len()];
            scene.force(s.at(), &mut f);
            worst = worst.max(work_of_rigid_motions(&scene, &s, &f));
            let found = candidates(&scene, &s);
            let faded = |c: &Candidate| c.gap < 0.0 && c.taper < 1.0;
            leaving += found.iter().filter(|(_, c)| faded(c)).count();
        }
        println!("{name}: momentum within {worst:.1e}, {leaving} points leave over tips");
        assert!(worst < 1e-9, "{name}: {worst:.2e}");
        all += leaving;
    }
    assert!(all > 0, "no point leaves");
}
