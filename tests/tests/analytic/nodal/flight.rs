//! Flight and impacts of elastic gears under the trigonometric method.

use super::*;
use gearbench_integrators::Report;
use gearbench_integrators::modal::propagator::coefficients;
use gearbench_integrators::{AcceptedStep, Control, Resolution, Sink, TimePlan, Work, method};

/// Returns gears of case A with impacts within the backlash and vibrating teeth.
fn vibrating(size: f64, seed: u64, torque: f64) -> (Scene, State) {
    let mut spec = case_a(0.0);
    let backlash = mesh_layout(&spec.gears[0], &spec.gears[1])
        .unwrap()
        .backlash;
    let mut numbers = Numbers::new(seed);
    spec.meshes[0].start.gap = (0.5 + 0.3 * numbers.draw()) * backlash;
    for g in &mut spec.gears {
        g.speed = 10.0 * numbers.draw();
        g.loads = vec![Load::Applied(Profile::Constant(torque * numbers.draw()))];
    }
    let gear = toy(9, 2, 6, 2e-9);
    let scene = build(
        &spec,
        &[gear.clone(), gear],
        &with_points(PointContact::new(1e15)),
    );
    let mut s = scene.initial();
    deform(&scene, &mut s, size, seed + 1);
    (scene, s)
}

/// Only the steady loads act until the predicted time, whatever vibrates.
#[test]
fn nothing_touches_before_the_time_told() {
    let (mut flights, mut looked) = (0, 0.0);
    for seed in 0..60 {
        let (mut scene, s) = vibrating(2e-6, seed, 5.0);
        let n = s.q.len();
        let (mut omega, mut zeta) = (vec![0.0; n], vec![0.0; n]);
        let (mut steady, mut rest) = (vec![0.0; n], vec![0.0; n]);
        let split = scene.modal().expect("elastic gears are oscillators");
        split.oscillators(&mut omega, &mut zeta);
        let until = split.free_until(&s).min(0.05);
        split.steady(s.at(), &mut steady);
        if until == 0.0 {
            continue;
        }
        flights += 1;
        looked += until;
        let mut here = s.clone();
        for k in 0..=400 {
            let t = until * f64::from(k) / 400.0;
            here.t = t;
            for i in 0..n {
                let c = coefficients(omega[i], zeta[i], t);
                here.q[i] = c.qq * s.q[i] + c.qv * s.v[i] + c.qg * steady[i];
                here.v[i] = c.vq * s.q[i] + c.vv * s.v[i] + c.qv * steady[i];
            }
            scene.modal().unwrap().remainder(here.at(), &mut rest);
            assert_eq!(
                rest, steady,
                "seed {seed}: touches {k}/400 into a flight of {until:.2e} s"
            );
        }
    }
    println!("{flights} flights, {looked:.2e} s");
    assert!(flights > 40);
}

/// Sink that counts impacts by the contact force at the ends of steps.
struct Impacts {
    channel: usize,
    out: Outputs,
    closed: bool,
    number: u32,
}

impl Sink for Impacts {
    fn accepted(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        sys.output(step.to.at(), &mut self.out);
        let closed = self.out.channels[self.channel] != 0.0;
        // Vibrating flanks touch several times within one impact.
        self.number += u32::from(closed && !self.closed && !step.flight);
        self.closed = closed;
        Control::Continue
    }
}

/// Impacts conserve the energy, and flights need few steps.
#[test]
fn impacts_keep_the_energy_and_flight_is_free() {
    let worst = [1e-7, 2.5e-8].map(|h| {
        let (mut worst, mut steps, mut touches) = (0.0_f64, 0, 0);
        for seed in 0..6 {
            let (mut scene, mut s) = vibrating(0.0, seed, 0.0);
            let mut impacts = Impacts {
                channel: gearbench_tests::named(&scene, "force:0"),
                out: Outputs::default(),
                closed: false,
                number: 0,
            };
            scene.output(s.at(), &mut impacts.out);
            let start = impacts.out.energy.total();
            let mut work = Work::default();
            let mut m = method("trigonometric").unwrap();
            let plan = TimePlan::new(1e-3, Resolution::Step(h));
            m.run(&mut scene, &mut s, &plan, &mut impacts, &mut work).unwrap();
            scene.output(s.at(), &mut impacts.out);
            let change = impacts.out.energy.total() / start - 1.0;
            println!(
                "h {h:.1e}, seed {seed}: {} touches, {} steps of {:.0}, {} evaluations, energy {change:.1e}",
                impacts.number, work.steps, 1e-3 / h, work.force_evaluations
            );
            worst = worst.max(change.abs());
            steps += work.steps;
            touches += impacts.number;
        }
        assert!(touches > 3 && (steps as f64) < 0.3 * 6.0 * 1e-3 / h);
        worst
    });
    assert!(worst[0] < 1e-2 && worst[1] < 0.5 * worst[0], "{worst:?}");
}
