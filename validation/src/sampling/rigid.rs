//! Runs of sampled scenes with rigid gears: times and forces of the contacts.

use super::SampleError;
use gearbench::models::models;
use gearbench::scene_file::SceneFile;
use gearbench_integrators::system::{Outputs, SecondOrderSystem, State};
use gearbench_integrators::table::DOPRI5;
use gearbench_integrators::{AcceptedStep, Control, MethodSpec, Resolution, Sink, TimePlan, Work};
use gearbench_models::gear::table::properties_of;
use gearbench_models::scene::{Channel, OfMesh, Scene};

/// Method, tolerance and bound of steps. The bound is never reached; it is one of steps, not of time, so that a scene
/// is the same on every machine.
const METHOD: (MethodSpec, f64, u64) = (DOPRI5, 1e-8, 100_000);
/// Points within a step at which the force is evaluated.
const PLACES: [f64; 4] = [0.25, 0.5, 0.75, 1.0];
/// Contacts with a shorter separation, relative to the duration of an impact, count as one: such separations are
/// rounding errors of events.
const APART: f64 = 1e-3;

/// Contact intervals of a run; methods that locate events have no step across the begin or the end of a contact.
struct Contacts {
    channel: usize,
    apart: f64,
    peak: f64,
    spells: Vec<[f64; 2]>,
    sample: State,
    out: Outputs,
}

impl Sink for Contacts {
    fn accepted(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        let (from, to) = (step.from.t, step.to.t);
        let mut touches = false;
        for place in PLACES {
            self.sample.copy_from(step.from);
            let State { q, v, .. } = &mut self.sample;
            step.dense.eval(place, q, v);
            self.sample.t = from + place * (to - from);
            sys.output(self.sample.at(), &mut self.out);
            let force = self.out.channels[self.channel].abs();
            self.peak = self.peak.max(force);
            touches |= place < 1.0 && force > 0.0;
        }
        match self.spells.last_mut() {
            Some(last) if touches && from - last[1] < self.apart => last[1] = to,
            _ if touches => self.spells.push([from, to]),
            _ => {}
        }
        Control::Continue
    }
}

/// Peak force [N] of rigid gears, and begin and end of their contacts [s]; an impact takes about `contact_time`. The
/// peak is NaN if the run does not reach the end.
pub fn contacts(scene: &SceneFile, contact_time: f64) -> Result<(f64, Vec<[f64; 2]>), SampleError> {
    let (method, tolerance, max_steps) = METHOD;
    let Some(choice) = scene
        .models
        .iter()
        .find(|m| properties_of(models(), &m.model).rigid)
    else {
        return Ok((f64::NAN, Vec::new()));
    };
    let mut integrator = method.build();
    let mut system = Scene::build(&scene.spec, &choice.modelling, models())?;
    let mut state = system.initial();
    let Some(channel) = system.channel(Channel::Mesh(0, OfMesh::Force)) else {
        return Ok((f64::NAN, Vec::new()));
    };
    let mut seen = Contacts {
        channel,
        apart: APART * contact_time,
        peak: 0.0,
        spells: Vec::new(),
        sample: State::default(),
        out: Outputs::default(),
    };
    let plan = TimePlan {
        max_steps,
        ..TimePlan::new(scene.duration, Resolution::Tolerance(tolerance))
    };
    let mut work = Work::default();
    let ended = integrator.run(&mut system, &mut state, &plan, &mut seen, &mut work);
    if ended.is_err() {
        seen.peak = f64::NAN;
    }
    Ok((seen.peak, seen.spells))
}
