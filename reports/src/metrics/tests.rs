//! Metrics of histories in closed form.

use super::*;
use crate::record::Run;
use crate::series::Column;
use std::f64::consts::PI;

/// Makes a series of the contact force and the speeds of a pair.
fn pair() -> TimeSeries {
    TimeSeries::named(["contact_force_a_b_n", "speed_a_rad_s", "speed_b_rad_s"])
}

/// Makes a half-sine of height `peak` and length `length` that starts at `start`.
fn half_sine(start: f64, length: f64, peak: f64, h: f64) -> TimeSeries {
    let mut s = pair();
    for i in 0..=((4.0 * length / h) as usize) {
        let t = i as f64 * h;
        let u = (t - start) / length;
        let f = if (0.0..=1.0).contains(&u) {
            peak * (PI * u).sin()
        } else {
            0.0
        };
        s.push(t, &[f, 20.0, -f64::from(i as u32)]);
    }
    s
}

/// Computes the metrics of a run that counts as having reached its end.
fn metrics_of(s: &TimeSeries, reference: &TimeSeries, against: &str) -> Metrics {
    let ledger = Ledger::default();
    let run = FinishedRun::reached(s, &ledger, [0.0, 0.0]).unwrap();
    compare(run, reference, against)
}

fn close(a: Option<f64>, b: f64, tolerance: f64) {
    let a = a.expect("a value");
    assert!((a - b).abs() <= tolerance, "{a} against {b}");
}

#[test]
fn half_sine_has_its_closed_form() {
    let s = half_sine(1e-4, 1e-4, 3000.0, 1e-7);
    let m = metrics_of(&s, &s, "self");
    close(m.peak_force_n, 3000.0, 1e-3);
    close(m.impulse_ns, 2.0 / PI * 3000.0 * 1e-4, 1e-6);
    close(m.duration_s, 1e-4, 2e-10);
    close(m.force_l2, 0.0, 1e-15);
    close(m.force_l2_aligned, 0.0, 1e-15);
    close(m.peak_force_rel, 0.0, 0.0);
    close(m.speed_end("a"), 20.0, 0.0);
    close(m.speed_end("b"), -4000.0, 0.0);
}

/// Two forces of zero have zero error against each other, and a force of zero is no reference for any other.
#[test]
fn a_force_of_zero_agrees_with_zero() {
    let none = half_sine(1e-4, 1e-4, 0.0, 1e-7);
    let m = metrics_of(&none, &none, "self");
    for error in [
        m.force_l1,
        m.force_l2,
        m.force_l2_aligned,
        m.peak_force_rel,
        m.impulse_rel,
    ] {
        close(error, 0.0, 0.0);
    }
    let some = half_sine(1e-4, 1e-4, 3000.0, 1e-7);
    let m = metrics_of(&some, &none, "self");
    assert_eq!(
        (m.force_l1, m.force_l2, m.peak_force_rel),
        (None, None, None)
    );
    // A reference without a force says nothing of it.
    let mut speeds = none.clone();
    speeds.columns.remove(0);
    let m = metrics_of(&none, &speeds, "measured");
    assert_eq!((m.force_l1, m.force_l2), (None, None));
}

#[test]
fn rebound_and_transmission_error() {
    let with = |s: &mut TimeSeries, scale: f64, end: f64| {
        let n = s.len();
        let speed = (0..n).map(|i| 20.0 - 25.0 * i as f64 / (n - 1) as f64);
        s.columns[1].values = speed.collect();
        s.columns[1].values[n - 1] = end;
        s.columns[2].values = vec![0.0; n];
        let error = s.contact_force().iter().map(|f| scale * 1e-9 * f).collect();
        s.columns
            .push(Column::new("transmission_error_a_b_m", error));
    };
    let mut r = half_sine(1e-4, 1e-4, 1000.0, 1e-7);
    let mut s = r.clone();
    with(&mut r, 1.0, -5.0);
    with(&mut s, 1.1, -4.5);
    let m = metrics_of(&s, &r, "fe");
    close(m.rebound_rel, 0.5 / 25.0, 1e-12);
    close(m.transmission_error_l2, 0.1, 1e-12);
    // A run that stops early has no rebound; a reference without the column has no transmission error.
    s.all_values_mut().for_each(|c| c.truncate(300));
    r.columns.pop();
    let m = metrics_of(&s, &r, "fe");
    assert_eq!((m.rebound_rel, m.transmission_error_l2), (None, None));
}

#[test]
fn scaled_force_has_the_scale_as_error() {
    let r = half_sine(1e-4, 1e-4, 1000.0, 1e-7);
    let s = half_sine(1e-4, 1e-4, 1100.0, 1e-7);
    let m = metrics_of(&s, &r, "fe");
    close(m.force_l2, 0.1, 1e-12);
    close(m.force_l2_aligned, 0.1, 1e-6);
    close(m.peak_force_rel, 0.1, 1e-12);
    close(m.impulse_rel, 0.1, 1e-12);
    close(m.time_shift_s, 0.0, 1e-8);
}

/// The squared error of two half-sines of length T at a distance d is 2 (1 - c(d)) with the overlap c(d) = (1 - d/T)
/// cos(pi d/T) + sin(pi d/T)/pi.
#[test]
fn shifted_force_is_found_and_raw_error_exact() {
    let length = 1e-4;
    let r = half_sine(1e-4, length, 1000.0, 1e-7);
    for shift in [-6.35e-5, -3e-6, 1.234e-5, 9e-5] {
        let s = half_sine(1e-4 + shift, length, 1000.0, 1.3e-7);
        let m = metrics_of(&s, &r, "fe");
        let x: f64 = shift.abs() / length;
        let overlap = (1.0 - x) * (PI * x).cos() + (PI * x).sin() / PI;
        close(m.force_l2, (2.0 * (1.0 - overlap)).sqrt(), 1e-4);
        close(m.force_l2_aligned, 0.0, 2e-4);
        close(m.time_shift_s, -shift, 1e-9);
    }
}

#[test]
fn far_apart_impacts_are_still_aligned() {
    let r = half_sine(1e-5, 1e-4, 1000.0, 1e-7);
    let s = half_sine(2.9e-4, 1e-4, 1000.0, 1e-7);
    let m = metrics_of(&s, &r, "fe");
    close(m.force_l2, 2.0_f64.sqrt(), 1e-6);
    close(m.force_l2_aligned, 0.0, 1e-6);
}

#[test]
fn a_run_that_ends_before_its_reference_is_charged() {
    let r = half_sine(1e-4, 1e-4, 1000.0, 1e-7);
    let mut s = r.clone();
    s.all_values_mut().for_each(|c| c.truncate(1501));
    let m = metrics_of(&s, &r, "fe");
    close(m.force_l2, 0.5_f64.sqrt(), 1e-3);
}

#[test]
fn broken_data_give_no_numbers_and_no_panic() {
    let r = half_sine(1e-4, 1e-4, 1000.0, 1e-7);
    let mut blown = r.clone();
    for f in &mut blown.columns[0].values[1200..] {
        *f = f64::NAN;
    }
    let (empty, ledger) = (TimeSeries::default(), Ledger::default());
    for s in [&blown, &empty] {
        for target in [&r, &empty, &blown] {
            let Ok(run) = FinishedRun::reached(s, &ledger, [0.0, 0.0]) else {
                assert!(s.is_empty());
                continue;
            };
            let m = compare(run, target, "fe");
            let json = serde_json::to_string(&m).unwrap();
            assert!(!json.contains("null"), "{json}");
        }
    }
    let ledger = Ledger {
        residual_rel: Some(f64::INFINITY),
        ..Ledger::default()
    };
    let run = FinishedRun::reached(&r, &ledger, [0.0, 0.0]).unwrap();
    assert_eq!(compare(run, &r, "fe").energy_drift_rel, None);
}

#[test]
fn what_follows_the_reference_is_not_compared_with_it() {
    let reference = half_sine(1e-5, 1e-4, 3000.0, 2e-7);
    let mut run = half_sine(1e-5, 1e-4, 3000.0, 2e-7);
    let end = reference.time_s[reference.len() - 1];
    for i in 1..50 {
        run.push(end + f64::from(i) * 1e-6, &[9000.0, 5.0, 5.0]);
    }
    let m = metrics_of(&run, &reference, "calculix");
    assert!(m.peak_force_rel.is_some_and(|x| x.abs() < 1e-12), "{m:?}");
    assert!(m.impulse_rel.is_some_and(|x| x.abs() < 1e-9), "{m:?}");
    let last = reference.of(SPEED, "a").and_then(<[f64]>::last);
    assert_eq!(m.speed_end("a"), last.copied());
}

/// A run that blew up, timed out or was stopped has no metrics, however good its beginning.
#[test]
fn a_run_that_did_not_reach_its_end_is_refused() {
    let s = half_sine(1e-4, 1e-4, 1000.0, 1e-7);
    let (ledger, end) = (Ledger::default(), *s.time_s.last().unwrap());
    assert!(FinishedRun::reached(&s, &ledger, [end, end]).is_ok());
    let early = FinishedRun::reached(&s, &ledger, [end, 1.01 * end]).unwrap_err();
    assert_eq!((early.reached_s, early.end_s), (end, 1.01 * end));
    assert!(early.to_string().contains("stopped at 4.0"), "{early}");
    assert!(FinishedRun::reached(&TimeSeries::default(), &ledger, [0.0, 0.0]).is_err());
    let mut run = Run {
        simulated_s: end,
        end_s: Some(1.01 * end),
        series: Some(s),
        ..Run::default()
    };
    assert_eq!(run.finished().unwrap_err(), early);
    // The history may end with the last contact: the run says itself which time it reached.
    run.simulated_s = 1.01 * end;
    assert!(run.finished().is_ok());
}

/// Makes a force of height one in pieces, with a jump up at `start` and a jump down at `start + 1`.
fn jumping(start: f64) -> TimeSeries {
    let mut s = pair();
    for i in 0..=4 {
        s.push(f64::from(i), &[0.0; 3]);
    }
    let mut force = crate::force::ForceHistory::default();
    for k in 0..32 {
        let [a, b] = [k, k + 1].map(|k| start + f64::from(k) / 32.0);
        force.push(&[(a, 1.0), (0.5 * (a + b), 1.0), (b, 1.0)]);
    }
    s.forces = vec![force];
    s
}

/// An event that is late by d misplaces 2 d of the impulse: the L1 error is that, the L2 error its square root.
#[test]
fn a_late_jump_costs_its_delay() {
    let reference = jumping(0.6);
    for d in [1e-2, 1e-6, 1e-10] {
        let m = metrics_of(&jumping(0.6 + d), &reference, "self");
        close(m.force_l1, 2.0 * d, 1e-5 * d + 1e-15);
        close(m.force_l2, (2.0 * d).sqrt(), 1e-5 * d.sqrt());
        close(m.impulse_rel, 0.0, 1e-12);
        close(m.peak_force_rel, 0.0, 1e-12);
        close(m.duration_s, 1.0, 1e-12);
    }
    let late = metrics_of(&jumping(0.8), &reference, "self");
    close(late.time_shift_s, -0.2, 1e-8);
    close(late.force_l2_aligned, 0.0, 1e-3);
    let same = metrics_of(&reference, &reference, "self");
    assert_eq!(
        (same.force_l1, same.force_l2_aligned),
        (Some(0.0), Some(0.0))
    );
}

/// A reference without pieces is known at its samples alone, so the run is evaluated at their times.
#[test]
fn samples_from_elsewhere_are_met_at_their_own_times() {
    let mut run = jumping(0.5);
    run.forces.clear();
    let mut sampled = pair();
    for i in 0..=400 {
        let t = 0.01 * f64::from(i);
        let f = if (0.5..1.5).contains(&t) { 1.0 } else { 0.0 };
        sampled.push(t, &[f, 0.0, 0.0]);
    }
    let mut pieces = crate::force::ForceHistory::default();
    pieces.push(&[(0.5, 1.0), (1.4999999, 1.0)]);
    run.forces = vec![pieces];
    let m = metrics_of(&run, &sampled, "calculix");
    close(m.force_l1, 0.0, 1e-12);
    close(m.force_l2, 0.0, 1e-12);
}

/// Quantities are those of the mesh where they are largest, by whatever place it has, and the mesh is named; a mesh that
/// hardly bears a force has no duration. Scenes with one mesh name none.
#[test]
fn the_largest_quantity_counts() {
    let meshes = ["a_b", "b_c", "c_d"];
    let of = |name: &str, unit: &str| meshes.map(|mesh| format!("{name}_{mesh}{unit}"));
    let mut s =
        TimeSeries::named([of("contact_force", "_n"), of("transmission_error", "_m")].concat());
    for i in 0..=1000 {
        let t = 1e-3 * f64::from(i);
        // A high short force, a long one with a larger impulse, and next to none all the time.
        let short = if t < 0.1 {
            100.0 * (10.0 * PI * t).sin()
        } else {
            0.0
        };
        let long = if t < 0.5 {
            50.0 * (2.0 * PI * t).sin()
        } else {
            0.0
        };
        let error = 1e-6 * (2.0 * PI * t).cos();
        s.push(t, &[1e-3, long, short, error, 2.0 * error, 3.0 * error]);
    }
    let m = metrics_of(&s, &s, "self");
    close(m.peak_force_n, 100.0, 1e-2);
    close(m.impulse_ns, 50.0 / PI, 1e-2);
    close(m.rms_force_n, 25.0, 1e-2);
    close(m.duration_s, 0.5, 1e-3);
    close(m.transmission_error_pp_m, 6e-6, 1e-12);
    for (metric, mesh) in [
        (Metric::PeakForce, "c_d"),
        (Metric::Impulse, "b_c"),
        (Metric::RmsForce, "b_c"),
        (Metric::Duration, "b_c"),
        (Metric::TransmissionErrorSpan, "c_d"),
    ] {
        assert_eq!(m.mesh(metric), Some(mesh), "{metric}");
    }
    let one = half_sine(1e-4, 1e-4, 3000.0, 1e-7);
    assert!(metrics_of(&one, &one, "self").meshes.is_empty());
}

/// Errors of the force are those of the mesh that is worst; a mesh that hardly bears a force does not count.
#[test]
fn the_worst_mesh_counts() {
    let names = [
        "contact_force_a_b_n",
        "contact_force_b_c_n",
        "contact_force_c_d_n",
    ];
    let scaled = |factors: [f64; 3]| {
        let mut s = TimeSeries::named(names);
        for i in 0..=200 {
            let t = 0.01 * f64::from(i);
            let force = (std::f64::consts::PI * t).sin().abs();
            s.push(t, &factors.map(|factor| factor * force));
        }
        s
    };
    let reference = scaled([100.0, 10.0, 1e-3]);
    let m = metrics_of(&scaled([101.0, 9.5, 1.0]), &reference, "fe");
    close(m.force_l2, 0.05, 1e-9);
    close(m.force_l1, 0.05, 1e-9);
    close(m.peak_force_rel, -0.05, 1e-9);
    close(m.impulse_rel, -0.05, 1e-9);
    close(m.rms_force_rel, -0.05, 1e-9);
    close(m.peak_force_n, 101.0, 1e-9);
    assert_eq!(m.mesh(Metric::ForceL2), Some("b_c"));
    // A reference that knows one of the meshes decides by that.
    let mut first = reference.clone();
    first.columns.truncate(1);
    close(
        metrics_of(&scaled([101.0, 9.5, 1.0]), &first, "fe").force_l2,
        0.01,
        1e-9,
    );
}

/// Errors of the transmission error are those of the worst mesh too, wherever it stands; a mesh whose transmission error
/// is a thousandth of the largest does not count.
#[test]
fn the_worst_transmission_error_counts() {
    let meshes = ["a_b", "b_c", "c_d"];
    let scaled = |factors: [f64; 3]| {
        let of = |name: &str| meshes.map(|mesh| format!("{name}_{mesh}"));
        let names = [
            of("contact_force").map(|n| format!("{n}_n")),
            of("transmission_error").map(|n| format!("{n}_m")),
            of("mesh_cycle"),
        ];
        let mut s = TimeSeries::named(names.concat());
        for i in 0..=4000 {
            let cycle = 1e-3 * f64::from(i);
            let error = 1e-6 * (std::f64::consts::TAU * cycle).cos();
            let mut row = vec![100.0; 3];
            row.extend(factors.map(|factor| factor * error));
            row.extend([cycle; 3]);
            s.push(cycle, &row);
        }
        s
    };
    let m = metrics_of(&scaled([1.01, 0.38, 1e-3]), &scaled([1.0, 0.4, 1e-5]), "fe");
    close(m.transmission_error_pp_rel, -0.05, 1e-6);
    close(m.transmission_error_orders_rel, 0.05, 1e-6);
    close(m.transmission_error_l2_aligned, 0.05, 1e-6);
    close(m.transmission_error_pp_m, 2.02e-6, 1e-9);
    assert_eq!(m.mesh(Metric::TransmissionErrorSpanRel), Some("b_c"));
}
