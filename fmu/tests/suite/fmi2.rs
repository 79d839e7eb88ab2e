//! FMI 2 is a second facade over the instance of FMI 3: equal numbers, and what FMI 2 alone has.

use crate::host::{Fmu, said};
use crate::host2::{Fmu2, all, said as said2, version};
use crate::rollback::Random;
use crate::{packed, packed_as, shipped};
use gearbench::fmu::description::FmiVersion;
use std::collections::BTreeSet;

/// Communication step [s]: a power of two, so that times are exact.
const STEP: f64 = 1.0 / 131_072.0;

fn bits(x: &[f64]) -> Vec<u64> {
    x.iter().map(|x| x.to_bits()).collect()
}

/// Packs one model for both versions of FMI.
fn both(scene: &str, model: &str, method: &str, moved: &[&str]) -> (Fmu, Fmu2) {
    let file = shipped(scene, model);
    let two = packed_as(FmiVersion::Two, &file, model, method, moved);
    (
        Fmu::stepping(&packed(&file, model, method, moved)),
        Fmu2::stepping(&two),
    )
}

#[test]
fn all_functions_of_fmi_2_are_there() {
    let all = all();
    let names: BTreeSet<_> = all.iter().map(|(name, _)| name).collect();
    assert_eq!((all.len(), names.len()), (44, 44));
    assert!(all.iter().all(|(_, address)| *address != 0));
    assert_eq!(version(), ["2.0", "default"]);
}

#[test]
fn both_versions_give_equal_numbers() {
    for (scene, model, method) in [
        ("hammer", "rigid", "rk4@2us"),
        ("loaded_mesh", "rigid", "dopri5@1e-7"),
        ("driveline", "movable-teeth", "velocity-verlet@400ns"),
    ] {
        let (three, two) = both(scene, model, method, &[]);
        three.initialise(0.25);
        two.initialise(0.25, None);
        assert_eq!(three.outputs, two.outputs);
        let input = match scene {
            "driveline" => "motor.torque",
            _ => "pinion.torque",
        };
        for i in 0..200 {
            let (t, load) = (0.25 + f64::from(i) * STEP, f64::from(i % 7));
            three.set(input, load);
            two.set(input, load);
            three.step(t, STEP);
            two.step(t, STEP);
            assert_eq!(bits(&three.look()), bits(&two.look()), "{scene}, {i}");
        }
        let output = &three.outputs[0];
        for order in [1, 2] {
            assert_eq!(three.slope(output, order), two.slope(output, order));
        }
    }
}

#[test]
fn a_thousand_random_sequences_leave_no_trace() {
    // Copies as objects and as bytes, restored in this instance or in another one.
    let file = shipped("hammer", "rigid");
    let package = packed_as(FmiVersion::Two, &file, "rigid", "velocity-verlet@1us", &[]);
    let straight = Fmu2::stepping(&package);
    let others = [Fmu2::stepping(&package), Fmu2::stepping(&package)];
    straight.initialise(0.0, None);
    others.iter().for_each(|fmu| fmu.initialise(0.0, None));
    let mut random = Random(0x2545_f491_4f6c_dd1d);
    let (mut here, mut moved) = (0, 0);
    for i in 0..1000 {
        let t = f64::from(i) * STEP;
        let fmu = &others[here];
        let (kept, mut now) = (fmu.keep(), t);
        let bytes = fmu.store(&kept);
        let before = fmu.look();
        for _ in 0..=random.below(3) {
            if random.below(2) == 0 {
                fmu.set("wheel.torque", 50.0 * (random.unit() - 0.5));
            }
            if random.below(3) == 0 {
                fmu.extrapolate("pinion.torque", 1, 1e5 * (random.unit() - 0.5));
            }
            let size = STEP * (0.1 + 2.0 * random.unit());
            fmu.step(now, size);
            now += size;
        }
        moved += usize::from(fmu.look() != before);
        match random.below(3) {
            0 => fmu.go_back(&kept),
            1 => assert_eq!(fmu.try_go_back_to(&bytes), 0, "{}", said2()),
            _ => {
                drop(kept);
                here = 1 - here;
                assert_eq!(others[here].try_go_back_to(&bytes), 0, "{}", said2());
            }
        }
        let torque = 4.0 * (0.02 * f64::from(i)).sin();
        let looks = [&straight, &others[here]].map(|fmu| {
            fmu.set("pinion.torque", torque);
            fmu.step(t, STEP);
            bits(&fmu.look())
        });
        assert_eq!(looks[0], looks[1], "step {i}");
    }
    assert!(moved > 900, "{moved} sequences changed the outputs");
}

#[test]
fn stored_states_continue_under_all_methods_and_models() {
    for (scene, model, method, steps) in [
        ("hammer", "rigid", "semi-implicit-euler@1us", 60),
        ("hammer", "rigid", "rk4@1us", 60),
        ("hammer", "rigid", "dopri5@1e-7", 60),
        ("hammer", "rigid", "bdf@1e-6", 20),
        ("hammer", "rigid", "generalised-alpha(rho_inf=0.8)@1us", 60),
        ("hammer", "rigid", "trigonometric@1us", 60),
        ("hammer", "movable-teeth", "velocity-verlet@1us", 60),
        ("spur_impact", "elastic", "trigonometric@1us", 8),
        ("spur_impact", "elastic-half-space", "trigonometric@1us", 8),
    ] {
        let package = packed(&shipped(scene, model), model, method, &[]);
        let straight = Fmu::stepping(&package);
        straight.initialise(0.0);
        for i in 0..steps {
            let kept = straight.keep();
            let bytes = straight.store(&kept);
            // A new instance, which was never initialised.
            let other = Fmu::stepping(&package);
            if i % (steps / 4) == 0 {
                let copy = other
                    .try_unstore(&bytes)
                    .unwrap_or_else(|_| panic!("{}", said()));
                other.go_back(&copy);
                let looks = [&straight, &other].map(|fmu| {
                    let mut looks = Vec::new();
                    for k in 0..3 {
                        fmu.step(f64::from(i + k) * STEP, STEP);
                        looks.push(bits(&fmu.look()));
                    }
                    looks
                });
                assert_eq!(looks[0], looks[1], "{scene} {model} {method}, step {i}");
                straight.go_back(&kept);
            }
            straight.step(f64::from(i) * STEP, STEP);
        }
    }
}

#[test]
fn bytes_that_are_no_state_are_refused() {
    let file = shipped("hammer", "rigid");
    let fmu = Fmu::stepping(&packed(&file, "rigid", "trigonometric@1us", &[]));
    fmu.initialise(0.0);
    fmu.step(0.0, STEP);
    let good = fmu.store(&fmu.keep());
    let mut random = Random(7);
    for n in (0..good.len()).step_by(8) {
        assert!(fmu.try_unstore(&good[..n]).is_err());
    }
    assert!(
        fmu.try_unstore(&[good.as_slice(), &[0; 8]].concat())
            .is_err()
    );
    assert!(said().contains("8 bytes too many"));
    for _ in 0..500 {
        // Any bytes end in a state or in an error; the instance continues.
        let mut bad = good.clone();
        let at = random.below(bad.len() as u64) as usize;
        bad[at] ^= 1 << random.below(8);
        let _ = fmu.try_unstore(&bad);
    }
    let other = Fmu::stepping(&packed(&file, "rigid", "rk4@1us", &[]));
    assert!(other.try_unstore(&good).is_err());
    assert!(said().contains("another FMU, method or kind"));
    fmu.step(STEP, STEP);
}

#[test]
fn derivatives_of_inputs_act_in_one_step() {
    // A linear load by its derivative, and by its value at the end in FMI 3.
    let (three, two) = both("loaded_mesh", "rigid", "velocity-verlet@200ns", &[]);
    three.interpolate();
    three.initialise(0.0);
    two.initialise(0.0, None);
    let load = |i: u32| f64::from(i * i % 32);
    for i in 0..50 {
        let t = f64::from(i) * STEP;
        three.set("pinion.torque", load(i));
        three.set("pinion.torque_end", load(i + 1));
        two.set("pinion.torque", load(i));
        two.extrapolate("pinion.torque", 1, (load(i + 1) - load(i)) / STEP);
        three.step(t, STEP);
        two.step(t, STEP);
        assert_eq!(bits(&three.look()), bits(&two.look()), "step {i}");
    }
    // Without a new derivative the load is constant, at its last value.
    two.step(50.0 * STEP, STEP);
    three.set("pinion.torque", load(49));
    three.set("pinion.torque_end", load(49));
    three.step(50.0 * STEP, STEP);
    assert_eq!(bits(&three.look()), bits(&two.look()));
    // A quadratic: its impulse is that of its mean.
    let (three, two) = both("hammer", "rigid", "rk4@1us", &[]);
    three.initialise(0.0);
    two.initialise(0.0, None);
    let (a, b, h) = (3e5, 4e10, STEP);
    two.extrapolate("wheel.torque", 1, a);
    two.extrapolate("wheel.torque", 2, b);
    two.step(0.0, h);
    three.set("wheel.torque", h * (0.5 * a + b * h / 6.0));
    three.step(0.0, h);
    let [quadratic, mean] = [two.get("wheel.speed"), three.get("wheel.speed")];
    assert!(
        (quadratic - mean).abs() < 1e-12 * mean.abs(),
        "{quadratic} {mean}"
    );
    // A motion: displacement and speed at the end of the step.
    let (three, two) = both("loaded_mesh", "rigid", "rk4@200ns", &["pinion"]);
    three.interpolate();
    three.initialise(0.0);
    two.initialise(0.0, None);
    let motion = |t: f64| [1e-3 * (900.0 * t).sin(), 0.9 * (900.0 * t).cos()];
    for i in 0..50 {
        let t = f64::from(i) * STEP;
        let [now, end] = [motion(t), motion(t + STEP)];
        for (k, name) in ["pinion.angle", "pinion.speed"].iter().enumerate() {
            three.set(name, now[k]);
            three.set(&format!("{name}_end"), end[k]);
            two.set(name, now[k]);
            two.extrapolate(name, 1, (end[k] - now[k]) / STEP);
        }
        three.step(t, STEP);
        two.step(t, STEP);
        for (a, b) in three.look().iter().zip(two.look()) {
            assert!(
                (a - b).abs() <= 1e-9 * a.abs().max(1.0),
                "step {i}: {a} {b}"
            );
        }
    }
}

#[test]
fn bad_calls_of_fmi_2_end_in_errors() {
    let file = shipped("hammer", "rigid");
    let package = packed_as(FmiVersion::Two, &file, "rigid", "rk4@2us", &[]);
    assert!(Fmu2::try_new(&package, false, Some("another")).is_none());
    assert!(said2().contains("do not match the model description"));
    let fmu = Fmu2::stepping(&package);
    assert_eq!(fmu.try_step(0.0, STEP), 3);
    // The message is a format: a percent sign of the name is that of the name, not of the format.
    assert!(said2().starts_with("3: 50 % test: fmi2DoStep: the instance is not initialised"));
    assert_eq!(fmu.try_extrapolate("pinion.torque", 3, 1.0), 3);
    assert!(said2().contains("orders are 1 and 2"));
    assert_eq!(fmu.try_extrapolate("pinion.torque_end", 1, 1.0), 3);
    assert!(said2().contains("has no derivatives"));
    fmu.initialise(0.0, Some(1.0));
    fmu.step(0.0, STEP);
    assert_eq!(fmu.try_get_integer(0), 3);
    assert!(said2().contains("no variables of type Integer"));
    let (status, time, ends) = fmu.questions();
    assert_eq!((status, time, ends), ([2, 0, 0, 3], STEP, 0));
    assert_eq!(fmu.try_step(STEP, 2.0), 3);
    assert!(said2().contains("the stop time is 1 s"));
    fmu.terminate();
    fmu.reset();
    fmu.interpolate();
    fmu.initialise(0.0, None);
    assert_eq!(fmu.try_extrapolate("pinion.torque", 1, 1.0), 3);
    assert!(said2().contains("run to the values that end in _end"));
}

#[test]
fn model_exchange_of_fmi_2_has_the_states_of_fmi_3() {
    let file = shipped("driveline", "rigid");
    let two = packed_as(FmiVersion::Two, &file, "rigid", "rk4@1us", &[]);
    let description = String::from_utf8_lossy(&two.entries[0].bytes).into_owned();
    let three = Fmu::exchanging(&packed(&file, "rigid", "rk4@1us", &[]));
    let two = Fmu2::exchanging(&two);
    three.initialise(0.0);
    two.initialise(0.0, None);
    let [states, indicators] = three.sizes();
    assert_eq!([three.states(), three.rates()], two.rates(states));
    let has = |part: &str| assert!(description.contains(part), "{part} in\n{description}");
    has("fmiVersion=\"2.0\"");
    has(&format!("numberOfEventIndicators=\"{indicators}\""));
    has("canSerializeFMUstate=\"true\"");
    has("canInterpolateInputs=\"true\"");
    assert!(!description.contains("event_function"));
    // Indices of variables begin with one.
    let first = two.reference("der(motor.q[1])");
    has(&format!(
        "derivative=\"{}\"",
        two.reference("motor.q[1]") + 1
    ));
    has(&format!("<Unknown index=\"{}\"/>", first + 1));
}
