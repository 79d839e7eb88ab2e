//! Removal of vibration in flight: conserved and booked quantities, and the bound of the resulting change.

use crate::flight::hammer;
use crate::free_flight::{toy, with_points};
use gearbench_integrators::observers::Tee;
use gearbench_integrators::observers::ledger::Ledger;
use gearbench_integrators::{
    AcceptedStep, Control, Outputs, Resolution, SecondOrderSystem, Sink, State, TimePlan, Work,
    method,
};
use gearbench_models::scene::Scene;
use gearbench_models::spec::{ContactSpec, Load, ModelSpec, Profile};
use gearbench_tests::*;

const FACE: f64 = 0.01;

/// Returns the speed of approach along the line of action, from the momentum means.
fn approach(scene: &Scene, out: &Outputs) -> f64 {
    let speed = |name: &str| out.channels[gearbench_tests::named(scene, name)];
    let base = 20f64.to_radians().cos();
    base * (0.04 * speed("speed:pinion") + 0.06 * speed("speed:wheel"))
}

/// Returns the reduced mass of case A on the line of action.
fn mass() -> f64 {
    let spec = case_a(0.0);
    let base = 20f64.to_radians().cos();
    let yielding: f64 = (spec.gears.iter().zip([0.04 * base, 0.06 * base]))
        .map(|(g, r)| r * r / g.inertia.unwrap())
        .sum();
    yielding.recip()
}

/// An impact: its largest force and the speed of approach after it.
#[derive(Clone, Copy, Debug, Default)]
struct Blow {
    peak: f64,
    after: f64,
}

/// Sink that records the impacts between flights.
struct Blows<'a> {
    scene: &'a Scene,
    force: usize,
    out: Outputs,
    now: Blow,
    all: Vec<Blow>,
}

impl Sink for Blows<'_> {
    fn accepted(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        sys.output(step.to.at(), &mut self.out);
        self.now.peak = self.now.peak.max(self.out.channels[self.force]);
        if self.now.peak > 0.0 && step.flight && step.to.t - step.from.t > 1e-4 {
            self.now.after = approach(self.scene, &self.out);
            self.all.push(self.now);
            self.now = Blow::default();
        }
        Control::Continue
    }
}

fn hammered(models: &[ModelSpec; 2], contact: &ContactSpec, id: &str) -> (Vec<Blow>, Ledger) {
    let spec = hammer(100e-6);
    let (mut scene, names) = (build(&spec, models, contact), build(&spec, models, contact));
    let mut blows = Blows {
        scene: &names,
        force: gearbench_tests::named(&names, "force:0"),
        out: Outputs::default(),
        now: Blow::default(),
        all: Vec::new(),
    };
    let (mut s, mut work, mut ledger) = (scene.initial(), Work::default(), Ledger::default());
    let plan = TimePlan::new(0.009, Resolution::Step(1e-7));
    let mut m = method(id).unwrap();
    let mut sinks = Tee(vec![&mut ledger, &mut blows]);
    m.run(&mut scene, &mut s, &plan, &mut sinks, &mut work)
        .unwrap();
    ledger.close(&mut scene, &s);
    (blows.all, ledger)
}

fn cut_off(model: &ModelSpec, share: f64) -> [ModelSpec; 2] {
    let model = with(model.clone(), "vibration_cut_off", share);
    [model.clone(), model]
}

/// Impact after impact the force and the speed of rebound stay within the bounds that `scene::flight` states.
#[test]
fn the_vibration_cut_off_changes_impacts_by_less_than_its_bound() {
    // Damped so that after a flight about the share is left. Stiffness of the contacts alone: of two pairs of teeth,
    // and of the penalty on a whole flank.
    let teeth = |share, damping| (share, movable(5.3e8, 4.8e-3, damping));
    let modes = |share, damping| (share, toy(damping));
    for (name, models, contact, id, stiffness) in [
        (
            "movable teeth",
            [teeth(1e-4, 15.0), teeth(1e-6, 35.0), teeth(1e-8, 55.0)],
            contact(5e10),
            "velocity-verlet(free_flight=1)",
            2.0 * 5e10 * FACE,
        ),
        (
            "elastic",
            [modes(1e-4, 0.02), modes(1e-6, 0.04), modes(1e-8, 0.06)],
            with_points(),
            "trigonometric",
            1e15 * 9e-3 * FACE,
        ),
    ] {
        for (share, model) in models {
            let awake = [model.clone(), model.clone()];
            let (exact, _) = hammered(&awake, &contact, id);
            assert!(exact.len() > 3, "{name}: {} impacts", exact.len());
            let (found, ledger) = hammered(&cut_off(&model, share), &contact, id);
            assert_eq!(found.len(), exact.len());
            let before = |j: usize| {
                if j == 0 {
                    0.075
                } else {
                    exact[j - 1].after.abs()
                }
            };
            // The energy taken is booked, and is no more than twice the share per impact.
            let most: f64 = (0..exact.len())
                .map(|j| 2.0 * share * 0.5 * mass() * before(j).powi(2))
                .sum();
            assert!(
                ledger.jumps < 0.0 && -ledger.jumps < most,
                "{name}, {share:.0e}: {:.1e} J of {most:.1e}",
                ledger.jumps
            );
            assert!(ledger.residual_relative().abs() < 1e-5);
            let (mut bound, mut used) = (0.0, [0.0_f64; 2]);
            for (j, (a, b)) in found.iter().zip(&exact).enumerate() {
                // Both gears may have slept before each impact but the first.
                if j > 0 {
                    bound += 2.0 * share.sqrt() * before(j);
                }
                let speed = (a.after - b.after).abs();
                let force = (a.peak - b.peak).abs();
                let bounds = [bound, bound * (stiffness * mass()).sqrt()];
                println!(
                    "{name}, share {share:.0e}, impact {j}: speed {speed:.1e} of {:.1e} m/s, force {force:.1e} of {:.1e} N, peak {:.0} N",
                    bounds[0], bounds[1], b.peak
                );
                if j > 0 {
                    used = [
                        used[0].max(speed / bounds[0]),
                        used[1].max(force / bounds[1]),
                    ];
                }
            }
            println!(
                "{name}, share {share:.0e}: {:.1e} and {:.1e} of the bounds, {:.1e} of the energy",
                used[0],
                used[1],
                -ledger.jumps / most
            );
            assert!(
                used.iter().all(|x| *x < 1.0),
                "{name} {share:.0e}: {used:?}"
            );
        }
    }
}

/// The momentum is conserved, the energy of the oscillators is removed, and gears without vibration are not changed.
#[test]
fn the_vibration_cut_off_keeps_momentum() {
    for load in [0.0, 3.0] {
        for (model, contact) in [
            (movable(5.3e8, 4.8e-3, 60.0), contact(5e10)),
            (all_teeth(movable(5.3e8, 4.8e-3, 0.0)), contact(5e10)),
            (toy(0.1), with_points()),
        ] {
            let mut spec = hammer(100e-6);
            spec.gears[0].loads = vec![Load::Applied(Profile::Constant(load))];
            let scene = build(&spec, &[model.clone(), model], &contact);
            let mut s = scene.initial();
            let g = &scene.gears()[0];
            let mut numbers = Numbers::new(3);
            for i in g.range().skip(1) {
                s.q[i] += 1e-7 * numbers.draw();
                s.v[i] += 1e-2 * numbers.draw();
            }
            let momentum = |s: &State| g.model.hub_state(g.at(s.at())).momentum;
            let flight = g
                .model
                .linear()
                .unwrap()
                .free_flight(g.at(s.at()), load)
                .unwrap();
            let (before, energy) = (momentum(&s), g.model.energy(g.at(s.at())).total());
            let own = g.range();
            let mut discrete = s.discrete.clone();
            let cells = &mut discrete[1..][..g.model.hub().discrete];
            let (q, v) = (&mut s.q[own.clone()], &mut s.v[own]);
            assert!(
                g.model
                    .linear()
                    .unwrap()
                    .cut_off_vibrations(0.0, load, q, v, cells)
            );
            assert!(
                !g.model
                    .linear()
                    .unwrap()
                    .cut_off_vibrations(0.0, load, q, v, cells)
            );
            let after = momentum(&s);
            assert!((after / before - 1.0).abs() < 1e-14);
            let taken = energy - g.model.energy(g.at(s.at())).total();
            let resting = g
                .model
                .linear()
                .unwrap()
                .free_flight(g.at(s.at()), load)
                .unwrap();
            assert!(resting.energy < 1e-12 * flight.energy);
            // About another rest the energy is not a difference of energies.
            if load == 0.0 {
                let d = (taken / flight.energy - 1.0).abs();
                assert!(d < 1e-6, "{d:.1e}");
            }
        }
    }
}

#[test]
fn shares_that_are_none_are_refused() {
    let mut teeth = movable(5.3e8, 4.8e-3, 60.0);
    let e = teeth.set("vibration_cut_off", f64::NAN).unwrap_err();
    assert!(e.to_string().contains("is no finite number"), "{e}");
    for share in [-0.1, 1.0] {
        let teeth = with(teeth.clone(), "vibration_cut_off", share);
        let e = try_build(&hammer(100e-6), &[teeth, rigid()], &contact(5e10));
        let e = e.err().unwrap().to_string();
        assert!(
            e.contains("vibration_cut_off") && e.contains("less than 1"),
            "{e}"
        );
    }
}
