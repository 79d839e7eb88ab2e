//! A run in pieces equals the whole run, and copies of a method run independently.

use crate::hammer::Hammer;
use crate::problems::*;
use gearbench_integrators::system::Events;
use gearbench_integrators::{Archive, Change, Integrator, NullSink, State, TimePlan, Work};

/// Runs pieces of equal length from a given piece on; returns the state after each.
fn pieces(
    method: &mut dyn Integrator,
    hammer: &mut Hammer,
    s: &mut State,
    [first, count]: [u32; 2],
    plan: &TimePlan<'_>,
) -> Vec<State> {
    let length = plan.t_end;
    let mut seen = Vec::new();
    for i in first..first + count {
        let plan = TimePlan {
            t_end: f64::from(i + 1) * length,
            ..*plan
        };
        let mut work = Work::default();
        method
            .resume(hammer, s, Change::None, &plan, &mut NullSink, &mut work)
            .unwrap();
        seen.push(s.clone());
    }
    seen
}

#[test]
fn a_run_in_pieces_is_the_run_as_a_whole() {
    for method in fixed_step() {
        for zeta in [0.0, 0.05] {
            let hammer = Hammer::gears(zeta);
            // Some impacts; pieces of eight steps.
            let (n, t_end) = (250, 2e-3);
            let plan = steps(t_end, 8.0 * f64::from(n));
            let (whole, _) = solve(method, &mut hammer.clone(), hammer.start(), &plan);
            let piece = TimePlan {
                t_end: t_end / f64::from(n),
                ..plan
            };
            let (mut s, mut own) = (hammer.start(), method.build());
            let mut sys = hammer.clone();
            pieces(&mut *own, &mut sys, &mut s, [0, n], &piece);
            for (a, b) in s.v.iter().zip(&whole.v).chain(s.q.iter().zip(&whole.q)) {
                let off = (a - b).abs() / b.abs();
                assert!(off < 1e-11, "{}, damping {zeta}: {off:e}", method.info.id);
            }
        }
    }
}

#[test]
fn copies_of_a_method_go_on_alike() {
    let hammer = Hammer::gears(0.05);
    for method in fixed_step().chain(adaptive()) {
        let plan = plan_of(method, 3e-5, 12.0, 1e-6);
        let (mut own, mut s, mut sys) = (method.build(), hammer.start(), hammer.clone());
        pieces(&mut *own, &mut sys, &mut s, [0, 40], &plan);
        let (mut copy, kept) = (own.duplicate(), s.clone());
        let on = pieces(&mut *own, &mut sys, &mut s, [40, 30], &plan);
        s = kept;
        let again = pieces(&mut *copy, &mut sys, &mut s, [40, 30], &plan);
        assert!(on == again, "{}", method.info.id);
        assert!(on.iter().any(|x| x.v[0] != on[0].v[0]), "no impact");
    }
}

#[test]
fn a_method_restored_from_bytes_goes_on_alike() {
    let hammer = Hammer::gears(0.05);
    for method in fixed_step().chain(adaptive()) {
        let plan = plan_of(method, 3e-5, 12.0, 1e-6);
        let (mut own, mut s, mut sys) = (method.build(), hammer.start(), hammer.clone());
        pieces(&mut *own, &mut sys, &mut s, [0, 40], &plan);
        let mut to = Archive::writing();
        own.archive(&mut sys, plan.resolution, &mut to).unwrap();
        let bytes = to.into_bytes();
        // A new method on a new system, as in another process.
        let (mut copy, mut other) = (method.build(), hammer.clone());
        other.begin(&mut hammer.start(), plan.events);
        let mut from = Archive::reading(&bytes);
        copy.archive(&mut other, plan.resolution, &mut from)
            .unwrap();
        from.finish().unwrap();
        let mut kept = s.clone();
        let on = pieces(&mut *own, &mut sys, &mut s, [40, 30], &plan);
        let again = pieces(&mut *copy, &mut other, &mut kept, [40, 30], &plan);
        assert!(on == again, "{}", method.info.id);
        // No part of the bytes can be missing.
        for n in 0..bytes.len() {
            let mut short = Archive::reading(&bytes[..n]);
            let mut broken = method.build();
            let restored = broken.archive(&mut other, plan.resolution, &mut short);
            assert!(restored.is_err(), "{}, {n} bytes", method.info.id);
        }
    }
}
