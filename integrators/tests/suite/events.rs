//! Event location: simultaneous events, grazing events, events at the end of a step, jumps of the state, breakpoints
//! and hand-overs.

use crate::problems::*;
use crate::{split_off, unit_masses};
use gearbench_integrators::{
    AcceptedStep, Change, Control, Events, Layout, METHODS, Method, ModalSplit, SecondOrderSystem,
    Sink, State, StateView, StepError, Stepping, TimePlan,
};

fn plan_for(m: &Method, t_end: f64) -> TimePlan<'static> {
    plan_of(m, t_end, 1000.0, 1e-8)
}

/// Balls that fall on a floor and lose part of their speed there.
struct Balls {
    n: usize,
    restitution: f64,
}

impl SecondOrderSystem for Balls {
    unit_masses!(|own| [own.n, own.n, 0], modal: ModalSplit, events: Events);

    fn characteristic_time(&self, _at: StateView<'_>) -> f64 {
        0.1
    }
    fn force(&mut self, _at: StateView<'_>, f: &mut [f64]) {
        f.fill(-2.0);
    }
    fn tangent_times(&mut self, _at: StateView<'_>, _dq: &[f64], _dv: &[f64], df: &mut [f64]) {
        df.fill(0.0);
    }
}

impl Events for Balls {
    fn event_functions(&mut self, at: StateView<'_>, out: &mut [f64]) {
        out.copy_from_slice(at.q);
    }
    fn transition(&mut self, s: &mut State, event: usize) -> Change {
        s.v[event] *= -self.restitution;
        Change::Restart
    }
}

split_off!(Balls, |_own, _i| (0.0, 0.0));
split_off!(GrazingMass, |_own, _i| (1.0, 0.0));
split_off!(Table, |_own, _i| (0.0, 0.0));
split_off!(CommitCounter, |_own, i| ([1.0, 1.3][i], [0.05, 0.0][i]));

/// Balls from height one with acceleration two reach the floor after one second and rise again until three.
#[test]
fn simultaneous_events_are_switched_together() {
    for m in METHODS {
        let mut balls = Balls {
            n: 3,
            restitution: 1.0,
        };
        // Half a second of drift apart for the third ball.
        let s = state(&[1.0, 1.0, 1.0], &[0.0, 0.0, 1.0]);
        let (s, work) = solve(m, &mut balls, s, &plan_for(m, 4.0));
        assert_eq!(work.events, 6, "{}: {work:?}", m.info.id);
        assert_eq!(work.restarts, 4, "{}: {work:?}", m.info.id);
        assert_eq!(s.q[0].to_bits(), s.q[1].to_bits(), "{}", m.info.id);
        let allowed = if m.info.order == 1 { 2e-2 } else { 1e-6 };
        assert!((s.q[0] - 1.0).abs() < allowed, "{}: {:?}", m.info.id, s.q);
    }
}

/// An event at one second, where a step ends, counts exactly once.
#[test]
fn an_event_at_the_end_of_a_step_counts_once() {
    for m in fixed_step() {
        let mut balls = Balls {
            n: 1,
            restitution: 1.0,
        };
        let s = state(&[1.0], &[0.0]);
        let (s, work) = solve(m, &mut balls, s, &steps(2.0, 64.0));
        assert_eq!(work.events, 1, "{}", m.info.id);
        let allowed = if m.info.order == 1 { 0.2 } else { 1e-12 };
        assert!((s.q[0] - 1.0).abs() < allowed, "{}: {:?}", m.info.id, s);
    }
}

/// Bounces accumulate at 1 + 2 e/(1 - e) = 3 seconds.
#[test]
fn accumulating_events_end_as_chatter() {
    for m in METHODS {
        let mut balls = Balls {
            n: 1,
            restitution: 0.5,
        };
        let (_, work, result) = run(m, &mut balls, state(&[1.0], &[0.0]), &plan_for(m, 4.0));
        let Err(StepError::Chatter { t, .. }) = result else {
            panic!("{}: {result:?}", m.info.id)
        };
        // The last bounces lie closer together than time or height resolves.
        let allowed = if m.info.order == 1 { 0.1 } else { 1e-3 };
        assert!((t - 3.0).abs() < allowed, "{}: {t}", m.info.id);
        assert!(work.events > 30);
    }
}

/// A mass on a spring whose motion turns just at a stiff wall.
struct GrazingMass {
    wall: f64,
}

impl SecondOrderSystem for GrazingMass {
    unit_masses!(|_own| [1, 1, 1], modal: ModalSplit, events: Events);

    fn characteristic_time(&self, at: StateView<'_>) -> f64 {
        if at.discrete[0] == 0.0 { 1.0 } else { 0.01 }
    }
    fn force(&mut self, at: StateView<'_>, f: &mut [f64]) {
        f[0] = -at.q[0] - at.discrete[0] * 1e4 * (at.q[0] - self.wall);
    }
    fn tangent_times(&mut self, at: StateView<'_>, dq: &[f64], _dv: &[f64], df: &mut [f64]) {
        df[0] = -(1.0 + at.discrete[0] * 1e4) * dq[0];
    }
}

impl Events for GrazingMass {
    fn event_functions(&mut self, at: StateView<'_>, out: &mut [f64]) {
        let gap = self.wall - at.q[0];
        out[0] = if at.discrete[0] == 0.0 { gap } else { -gap };
    }
    fn transition(&mut self, s: &mut State, _event: usize) -> Change {
        s.discrete[0] = 1.0 - s.discrete[0];
        Change::Restart
    }
}

#[test]
fn grazing_contact_goes_through() {
    let t_end = 6.0 * std::f64::consts::PI;
    for m in METHODS {
        for depth in [0.0, 1e-16, 1e-13, 1e-9, 1e-6, -1e-9] {
            let mut s = state(&[0.0], &[1.0]);
            s.discrete = vec![0.0];
            let plan = plan_of(m, t_end, 6000.0, 1e-8);
            let mut sys = GrazingMass { wall: 1.0 - depth };
            let (s, work) = solve(m, &mut sys, s, &plan);
            // The push of a graze of this depth: the speed it takes away, sqrt(2 depth), is turned round
            // within a hundredth of a second at most.
            let allowed =
                if m.info.order == 1 { 3e-2 } else { 1e-3 } + 2.0 * f64::abs(depth).sqrt();
            assert!(
                (s.v[0] - 1.0).abs() < allowed && s.q[0].abs() < allowed,
                "{} at depth {depth:.0e}: {s:?} {work:?}",
                m.info.id
            );
        }
    }
}

/// A force table with jumps at its breakpoints: constant acceleration in between.
struct Table {
    breakpoints: Vec<f64>,
    landed: Vec<f64>,
}

impl Table {
    fn acceleration(&self, t: f64) -> f64 {
        let i = self.breakpoints.iter().filter(|&&k| k <= t).count();
        [1.0, -2.0, 5.0, 0.5][i % 4]
    }
}

impl SecondOrderSystem for Table {
    unit_masses!(|_own| [1, 0, 1], modal: ModalSplit, events: Events);

    fn characteristic_time(&self, _at: StateView<'_>) -> f64 {
        0.1
    }
    /// The branch of the table is held in discrete state, so that it is right on both sides of a breakpoint.
    fn force(&mut self, at: StateView<'_>, f: &mut [f64]) {
        f[0] = at.discrete[0];
    }
    fn tangent_times(&mut self, _at: StateView<'_>, _dq: &[f64], _dv: &[f64], df: &mut [f64]) {
        df.fill(0.0);
    }
}

impl Events for Table {
    fn next_breakpoint(&self, t: f64) -> f64 {
        self.breakpoints
            .iter()
            .copied()
            .find(|&k| k > t)
            .unwrap_or(f64::INFINITY)
    }
    fn begin(&mut self, s: &mut State, _located: bool) {
        s.discrete[0] = self.acceleration(s.t);
    }
    fn commit(&mut self, s: &mut State) -> Change {
        if self.breakpoints.contains(&s.t) {
            self.landed.push(s.t);
        }
        s.discrete[0] = self.acceleration(s.t);
        Change::None
    }
}

#[test]
fn steps_land_on_the_breakpoints_of_a_table() {
    // Two breakpoints closer than a step, one next to nothing apart, one at a step's end.
    let breakpoints = vec![0.3, 0.7, 0.700_000_1, 0.700_000_100_000_000_1, 1.25];
    let (mut x, mut v, mut t) = (0.0, 0.0, 0.0);
    let table = Table {
        breakpoints: breakpoints.clone(),
        landed: Vec::new(),
    };
    for k in breakpoints.iter().copied().chain([2.0]) {
        let (a, h) = (table.acceleration(t), k - t);
        x += v * h + 0.5 * a * h * h;
        v += a * h;
        t = k;
    }
    for m in METHODS {
        let mut table = Table {
            breakpoints: breakpoints.clone(),
            landed: Vec::new(),
        };
        let mut s = state(&[0.0], &[0.0]);
        s.discrete = vec![0.0];
        let plan = plan_of(m, 2.0, 40.0, 1e-8);
        let (s, _) = solve(m, &mut table, s, &plan);
        assert_eq!(table.landed, breakpoints, "{}", m.info.id);
        assert!((s.v[0] - v).abs() < 1e-12, "{}: {} {v}", m.info.id, s.v[0]);
        // Constant acceleration is exact from order two on.
        let allowed = match m.info.order {
            1 => 0.2,
            _ if m.info.stepping == Stepping::Adaptive => 1e-6,
            _ => 1e-12,
        };
        assert!(
            (s.q[0] - x).abs() < allowed,
            "{}: {} {x}",
            m.info.id,
            s.q[0]
        );
    }
}

/// System that counts its commits in the discrete state and requests a restart at some of them; the force requires
/// that the discrete state is the committed one.
struct CommitCounter {
    commits: f64,
    restart_every: u32,
    seen: u32,
}

impl SecondOrderSystem for CommitCounter {
    fn layout(&self) -> Layout {
        Layout {
            discrete: 1,
            ..Duffing.layout()
        }
    }
    fn scales(&self, q: &mut [f64], v: &mut [f64]) {
        Duffing.scales(q, v);
    }
    fn characteristic_time(&self, at: StateView<'_>) -> f64 {
        Duffing.characteristic_time(at)
    }
    fn modal(&mut self) -> Option<&mut dyn ModalSplit> {
        Some(self)
    }
    fn force(&mut self, at: StateView<'_>, f: &mut [f64]) {
        assert_eq!(at.discrete[0], self.commits, "stale discrete at {}", at.t);
        Duffing.force(at, f);
    }
    fn solve_mass(&mut self, at: StateView<'_>, f: &mut [f64]) {
        Duffing.solve_mass(at, f);
    }
    fn apply_mass(&mut self, at: StateView<'_>, x: &[f64], y: &mut [f64]) {
        Duffing.apply_mass(at, x, y);
    }
    fn tangent_times(&mut self, at: StateView<'_>, dq: &[f64], dv: &[f64], df: &mut [f64]) {
        assert_eq!(at.discrete[0], self.commits, "stale discrete at {}", at.t);
        Duffing.tangent_times(at, dq, dv, df);
    }
    fn events(&mut self) -> Option<&mut dyn Events> {
        Some(self)
    }
}

impl Events for CommitCounter {
    fn commit(&mut self, s: &mut State) -> Change {
        self.commits += 1.0;
        s.discrete[0] = self.commits;
        self.seen += 1;
        if self.seen.is_multiple_of(self.restart_every) {
            Change::Restart
        } else {
            Change::None
        }
    }
}

#[test]
fn commits_reach_the_force_and_restarts_keep_the_solution() {
    for m in METHODS {
        for restart_every in [7, u32::MAX] {
            let mut sys = CommitCounter {
                commits: 0.0,
                restart_every,
                seen: 0,
            };
            let mut s = Duffing::start();
            s.discrete = vec![0.0];
            let plan = plan_of(m, 5.0, 2000.0, 1e-7);
            let (s, work) = solve(m, &mut sys, s, &plan);
            assert_eq!(f64::from(sys.seen), sys.commits);
            assert_eq!(u64::from(sys.seen), work.steps, "{}", m.info.id);
            if restart_every == 7 {
                assert!(work.restarts >= work.steps / 7 - 1, "{work:?}");
            }
            let allowed = if m.info.order == 1 { 5e-3 } else { 1e-3 };
            let error = Duffing::error(&s);
            assert!(error < allowed, "{}: {error:.1e}", m.info.id);
        }
    }
}

/// Sink that checks that steps follow each other without gap or overlap, through events as well.
#[derive(Default)]
struct ContinuityCheck {
    last: Option<State>,
    restarts: u64,
}

impl Sink for ContinuityCheck {
    fn accepted(&mut self, _sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        if let Some(last) = &self.last {
            assert_eq!(last, step.from);
        }
        assert!(step.to.t > step.from.t);
        assert_eq!(step.from.discrete, step.to.discrete);
        self.last = Some(step.to.clone());
        Control::Continue
    }
    fn restarted(&mut self, _sys: &mut dyn SecondOrderSystem, before: &State, after: &State) {
        self.restarts += 1;
        assert_eq!(self.last.as_ref(), Some(before));
        self.last = Some(after.clone());
    }
}

#[test]
fn the_sink_sees_every_step_and_every_switch() {
    for m in METHODS {
        let mut hammer = Hammer::gears(0.05);
        let (start, mut sink) = (hammer.start(), ContinuityCheck::default());
        let plan = plan_of(m, 0.02, 4000.0, 1e-6);
        let (s, work) = watch(m.info.id, &mut hammer, start, &plan, &mut sink);
        assert_eq!(sink.last, Some(s), "{}", m.info.id);
        assert_eq!(sink.restarts, work.restarts, "{}", m.info.id);
    }
}

/// A sink may end a run without an error.
#[test]
fn a_sink_can_stop_a_run() {
    struct Stop;
    impl Sink for Stop {
        fn accepted(&mut self, _: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
            if step.to.t > 0.5 {
                Control::Stop
            } else {
                Control::Continue
            }
        }
    }
    for m in METHODS {
        let (start, plan) = (Duffing::start(), plan_for(m, 5.0));
        let (s, _) = watch(m.info.id, &mut Duffing, start, &plan, &mut Stop);
        assert!(s.t > 0.5 && s.t < 4.0, "{}: {}", m.info.id, s.t);
    }
}
