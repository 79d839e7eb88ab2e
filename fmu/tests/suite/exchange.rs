//! Model exchange: a host with its own integration method and event location, compared with the run of the scene.

use crate::host::Fmu;
use crate::{packed, shipped};

/// `x + h b`, entry by entry.
fn along(x: &[f64], h: f64, b: &[f64]) -> Vec<f64> {
    x.iter().zip(b).map(|(x, b)| x + h * b).collect()
}

/// One classical Runge-Kutta step; leaves the instance at its end.
fn runge_kutta(fmu: &Fmu, t: f64, x: &[f64], h: f64) -> Vec<f64> {
    let rate = |c: f64, x: &[f64]| {
        fmu.move_to(t + c * h, x);
        fmu.rates()
    };
    let a = rate(0.0, x);
    let b = rate(0.5, &along(x, 0.5 * h, &a));
    let c = rate(0.5, &along(x, 0.5 * h, &b));
    let d = rate(1.0, &along(x, h, &c));
    let mut to = x.to_vec();
    for (k, weight) in [(a, 1.0), (b, 2.0), (c, 2.0), (d, 1.0)] {
        to = along(&to, h * weight / 6.0, &k);
    }
    fmu.move_to(t + h, &to);
    to
}

/// Runs to the end and returns the number of events.
fn run(fmu: &Fmu, h: f64, t_end: f64) -> usize {
    fmu.initialise(0.0);
    let mut next = fmu.event();
    let (mut t, mut x, mut events) = (0.0, fmu.states(), 0);
    while t < t_end {
        let stop = next.unwrap_or(f64::INFINITY).min(t_end);
        let size = h.min(stop - t);
        let fell = |before: &[f64], after: &[f64]| {
            let mut pairs = before.iter().zip(after);
            pairs.any(|(b, a)| (*b > 0.0) != (*a > 0.0))
        };
        fmu.move_to(t, &x);
        let before = fmu.indicators();
        let mut to = runge_kutta(fmu, t, &x, size);
        let mut reached = size;
        let event = fell(&before, &fmu.indicators());
        if event {
            // The host ends a hair behind the change of sign.
            let (mut lo, mut hi) = (0.0, size);
            while hi - lo > 1e-13 * size {
                let mid = 0.5 * (lo + hi);
                runge_kutta(fmu, t, &x, mid);
                *(if fell(&before, &fmu.indicators()) {
                    &mut hi
                } else {
                    &mut lo
                }) = mid;
            }
            to = runge_kutta(fmu, t, &x, hi);
            reached = hi;
        }
        (t, x) = (
            if reached == stop - t {
                stop
            } else {
                t + reached
            },
            to,
        );
        if fmu.completed() || event || Some(t) == next {
            events += usize::from(event);
            next = fmu.event();
            x = fmu.states();
        }
    }
    events
}

#[test]
fn a_host_with_its_own_method_gets_the_run_of_the_scene() {
    for (scene, model, [h, t_end], expected) in [
        ("hammer", "rigid", [1e-6, 6e-3], 2..100),
        ("spur_impact", "movable-teeth", [1e-7, 1.5e-4], 2..100),
        ("driveline", "rigid", [4e-7, 1e-3], 1..100),
        // Forces at flank points are clipped: nothing is located, and a method of fixed steps goes over their kinks.
        ("spur_impact", "elastic", [1e-7, 1.5e-4], 0..100),
    ] {
        let file = shipped(scene, model);
        // Its own steps are finer by far.
        let package = packed(&file, model, "dopri5@1e-12", &[]);
        let (stepping, exchanging) = (Fmu::stepping(&package), Fmu::exchanging(&package));
        let events = run(&exchanging, h, t_end);
        stepping.initialise(0.0);
        stepping.step(0.0, t_end);
        let mut worst = 0.0_f64;
        for gear in ["pinion", "wheel"] {
            for what in ["angle", "speed"] {
                let name = format!("{gear}.{what}");
                let (a, b) = (exchanging.get(&name), stepping.get(&name));
                worst = worst.max((a - b).abs() / b.abs().max(1e-3));
            }
        }
        println!("{scene} {model}: {events} events, {worst:.1e}");
        assert!(
            expected.contains(&events),
            "{scene} {model}: {events} events"
        );
        let bound = if model == "elastic" { 1e-5 } else { 5e-7 };
        assert!(worst < bound, "{scene} {model}: {worst:e}");
    }
}

#[test]
fn states_are_variables_with_derivatives() {
    let file = shipped("hammer", "rigid");
    let fmu = Fmu::exchanging(&packed(&file, "rigid", "rk4@1us", &[]));
    fmu.set("pinion.v[1]", 21.0);
    fmu.initialise(0.0);
    fmu.event();
    let n = fmu.sizes()[0];
    assert_eq!(n, 4);
    assert!(fmu.nominals().iter().all(|x| *x > 0.0));
    let mut x = fmu.states();
    assert_eq!(x[2], 21.0);
    x[0] += 1e-3;
    fmu.move_to(1e-5, &x);
    assert_eq!(
        (fmu.get("pinion.q[1]"), fmu.get("pinion.v[1]")),
        (x[0], x[2])
    );
    let rates = fmu.rates();
    assert_eq!(rates[..2], x[2..]);
    assert_eq!(fmu.get("der(wheel.v[1])"), rates[3]);
    assert_eq!(fmu.get("time"), 1e-5);
    // A torque on the hub accelerates it alone.
    fmu.set("wheel.torque", 2.0);
    let pushed = fmu.rates();
    assert_eq!(pushed[2], rates[2]);
    assert!(pushed[3] > rates[3]);
    assert_eq!(fmu.get("event_function[1]"), fmu.indicators()[0]);
}
