//! Flight within the backlash: the scene as oscillators and a remainder, the duration without contact, and the saved
//! work.

use gearbench_integrators::{
    AcceptedStep, Control, NullSink, Outputs, Resolution, SecondOrderSystem, Sink, State, TimePlan,
    Work,
};
use gearbench_models::scene::Scene;
use gearbench_models::spec::{Load, Mount, Profile, SceneSpec, mesh_layout};
use gearbench_tests::*;

/// Returns case A in the middle of `backlash`, with impacts on both sides.
pub fn hammer(backlash: f64) -> SceneSpec {
    let mut a = case_a(0.0);
    a.meshes[0].start.gap = 0.0;
    let mut spec = at_backlash(a, backlash);
    spec.meshes[0].start.gap = 0.5 * backlash;
    spec.gears[0].speed = 20.0;
    spec.gears[1].speed = -12.0;
    spec
}

/// Returns the specification at the centre distance of a normal backlash.
fn at_backlash(mut spec: SceneSpec, wanted: f64) -> SceneSpec {
    let (mut lo, mut hi) = (0.1, 0.1015);
    for _ in 0..60 {
        let mid = 0.5 * (lo + hi);
        spec.gears[1].position[0] = mid;
        match mesh_layout(&spec.gears[0], &spec.gears[1]) {
            Ok(l) if l.backlash > wanted => hi = mid,
            _ => lo = mid,
        }
    }
    spec
}

fn smallest_gap(scene: &Scene, s: &State) -> f64 {
    let all = candidates(scene, s);
    all.iter().map(|(_, c)| c.gap).fold(f64::INFINITY, f64::min)
}

/// The remainder is the acceleration without the oscillators, whatever acts.
#[test]
fn oscillators_and_rest_make_the_acceleration() {
    let mut spec = case_a(-2e-6);
    spec.gears[0].loads = vec![Load::Applied(Profile::Constant(3.0)), Load::Viscous(0.1)];
    spec.gears[1].loads = vec![Load::Applied(Profile::Constant(-1.0))];
    let mut scene = build(&spec, &[rigid(), rigid()], &contact(1.5e10));
    let s = scene.initial();
    let n = scene.layout().n;
    let (mut whole, mut rest, mut omega, mut zeta) =
        (vec![0.0; n], vec![0.0; n], vec![1.0; n], vec![1.0; n]);
    scene.force(s.at(), &mut whole);
    scene.solve_mass(s.at(), &mut whole);
    let split = scene.modal().unwrap();
    split.oscillators(&mut omega, &mut zeta);
    split.remainder(s.at(), &mut rest);
    assert_eq!(rest, whole);
    assert_eq!(omega, [0.0, 0.0]);
    // A viscous load is not steady, and the flanks touch.
    assert_eq!(split.steady(s.at(), &mut rest), 0.0);
    assert_eq!(split.free_until(&s), 0.0);
}

/// At random speeds, loads and positions no contact closes just before the predicted time, and one closes just after
/// it.
#[test]
fn the_time_of_flight_is_that_of_the_first_touch() {
    let mut numbers = Numbers::new(7);
    let (mut ends, mut never) = (0, 0);
    for _ in 0..300 {
        let mut spec = hammer(100e-6);
        for g in &mut spec.gears {
            g.speed = 30.0 * numbers.draw();
            g.loads = vec![Load::Applied(Profile::Constant(20.0 * numbers.draw()))];
        }
        let held = numbers.draw();
        if held > 0.5 {
            spec.gears[1].mount = Mount::Driven(Profile::Ramp {
                from: 3.0 * numbers.draw(),
                to: 50.0 * numbers.draw(),
                start: -1.0,
                end: 10.0,
            });
        }
        let mut scene = build(&spec, &[rigid(), rigid()], &contact(1.5e10));
        let mut s = scene.initial();
        let until = scene.modal().unwrap().free_until(&s);
        assert!(until > 0.0);
        let n = s.q.len();
        let mut a = vec![0.0; n];
        scene.modal().unwrap().steady(s.at(), &mut a);
        if until > 1.0 {
            never += 1;
            continue;
        }
        ends += 1;
        let (q0, v0) = (s.q.clone(), s.v.clone());
        let mut gap_at = |t: f64| {
            for i in 0..n {
                s.q[i] = q0[i] + t * (v0[i] + 0.5 * t * a[i]);
                s.v[i] = v0[i] + t * a[i];
            }
            s.t = t;
            smallest_gap(&scene, &s)
        };
        for i in 0..=50 {
            let gap = gap_at(until * f64::from(i) / 50.0);
            assert!(gap > 0.0, "{gap:.2e} at {i}/50 of the flight");
        }
        let gap = gap_at(until);
        assert!(gap < 1e-8, "{gap:.2e} is left at the end of the flight");
    }
    assert!(ends > 250, "{ends} flights end, {never} do not");
}

/// A breakpoint of a load ends a flight.
#[test]
fn loads_that_change_end_a_flight() {
    let ramp = |start: f64| {
        let mut spec = hammer(100e-6);
        spec.gears[0].loads = vec![Load::Applied(Profile::Ramp {
            from: 0.0,
            to: 1.0,
            start,
            end: 1.0,
        })];
        build(&spec, &[rigid(), rigid()], &contact(1.5e10))
    };
    let mut later = ramp(1e-5);
    let s = later.initial();
    assert_eq!(later.modal().unwrap().free_until(&s), 1e-5);
    let mut now = ramp(-1.0);
    assert_eq!(now.modal().unwrap().free_until(&s), 0.0);
}

#[test]
fn gears_with_teeth_of_their_own_have_no_split() {
    let mut scene = build(
        &case_a(1e-6),
        &[rigid(), movable(5.3e8, 4.8e-3, 0.0)],
        &contact(5e10),
    );
    assert!(scene.modal().is_none());
    let mut s = scene.initial();
    let plan = TimePlan::new(1e-5, Resolution::Step(1e-6));
    let error = gearbench_integrators::table::TRIGONOMETRIC
        .build()
        .run(
            &mut scene,
            &mut s,
            &plan,
            &mut NullSink,
            &mut Work::default(),
        )
        .unwrap_err();
    assert!(error.to_string().contains("oscillators"), "{error}");
}

/// Sink that counts impacts by the contact force at the ends of steps.
pub struct Impacts {
    force: usize,
    out: Outputs,
    closed: bool,
    pub number: u32,
}

impl Impacts {
    pub fn of(scene: &Scene) -> Self {
        Impacts {
            force: gearbench_tests::named(scene, "force:0"),
            out: Outputs::default(),
            closed: false,
            number: 0,
        }
    }
}

impl Sink for Impacts {
    fn accepted(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        sys.output(step.to.at(), &mut self.out);
        let closed = self.out.channels[self.force] != 0.0;
        self.number += u32::from(closed && !self.closed);
        self.closed = closed;
        Control::Continue
    }
}

/// With ten times the backlash, and so ten times the flight between impacts, the work per impact is unchanged.
#[test]
fn the_cost_of_hammering_follows_contact_time() {
    for events in [true, false] {
        for resolution in [Resolution::Step(1e-6), Resolution::Tolerance(1e-5)] {
            let cost = |stretch: f64| {
                let spec = hammer(50e-6 * stretch);
                let mut scene = build(&spec, &[rigid(), rigid()], &contact(1.5e10));
                let plan = TimePlan {
                    events,
                    ..TimePlan::new(0.02 * stretch, resolution)
                };
                let (start, mut impacts) = (scene.initial(), Impacts::of(&scene));
                let (_, work) = watched(&mut scene, start, "trigonometric", &plan, &mut impacts);
                println!(
                    "events {events}, {resolution:?}, backlash {:.0} um: {} impacts, {} steps, {} rejected, {} evaluations, {} events",
                    50.0 * stretch,
                    impacts.number,
                    work.steps,
                    work.rejected,
                    work.force_evaluations,
                    work.events
                );
                assert!(impacts.number > 20);
                [work.steps + work.rejected, work.force_evaluations]
                    .map(|x| x as f64 / f64::from(impacts.number))
            };
            let (short, long) = (cost(1.0), cost(10.0));
            for (short, long) in short.into_iter().zip(long) {
                assert!(
                    long <= 1.1 * short,
                    "{long:.1} per impact, {short:.1} with a tenth of the flight"
                );
            }
        }
    }
}
