//! Contact forces of all meshes as piecewise polynomials between events, from which the metrics of a run are computed ([`gearbench_reports::force`] has the reasons).
//!
//! The force in a step is sampled at the nodes of its polynomial pieces. Where events are located, steps far shorter
//! than a piece share one, so that the size of the record is proportional to the time in contact over the
//! characteristic time of the scene, and not to the number of steps; bodies with waves have no such time, and get a
//! piece per step. A piece ends where the state or its branch changes between steps, that is at located events. Steps
//! without a force are not recorded.
//!
//! | force within a step | piece |
//! |---|---|
//! | smooth: events are located | degree five over half a characteristic time |
//! | continuous: flank points close one by one, without a damper | a parabola over the step |
//! | may jump without an event: a damper, events not located | lines over a fifth of the characteristic time |

use gearbench_integrators::{AcceptedStep, SecondOrderSystem, State};
use gearbench_reports::force::{ForceHistory, MOST_NODES, integral};

/// Gauss-Lobatto nodes on [0, 1].
const LOBATTO: [f64; MOST_NODES] = [
    0.0,
    0.117_472_338_035_267_65,
    0.357_384_241_759_677_4,
    0.642_615_758_240_322_5,
    0.882_527_661_964_732_3,
    1.0,
];
/// Nodes of a parabola on [0, 1].
const PARABOLA: [f64; 3] = [0.0, 0.5, 1.0];
/// Nodes of a line on [0, 1].
const LINE: [f64; 2] = [0.0, 1.0];
/// Largest number of samples within one step.
const MOST_LOOKS: f64 = 25.0;
/// Least distance of nodes within a piece: closer nodes amplify rounding errors of the polynomial.
const CLOSEST: f64 = 0.02;

/// Sampling rule of the force.
#[derive(Clone, Copy, Debug)]
struct SamplingRule {
    nodes: &'static [f64],
    /// Longest piece of one step, in characteristic times.
    longest: f64,
    /// Length from which on a piece is full, in characteristic times.
    full: f64,
}

const SMOOTH: SamplingRule = SamplingRule {
    nodes: &LOBATTO,
    longest: 0.5,
    full: 0.15,
};
const CONTINUOUS: SamplingRule = SamplingRule {
    nodes: &PARABOLA,
    longest: f64::INFINITY,
    full: 0.0,
};
const UNSEEN: SamplingRule = SamplingRule {
    nodes: &LINE,
    longest: 0.2,
    full: 0.0,
};

/// True if a state comes from a run with located events.
pub fn is_located(s: &State, sys: &dyn SecondOrderSystem) -> bool {
    sys.layout().event_functions > 0 && s.discrete.first().is_some_and(|d| *d != 0.0)
}

/// A sample of the contact force of a mesh: time [s], magnitude [N], part in the transverse plane [N].
pub type Sample = [f64; 3];

/// Records the contact forces of all meshes during a run, at times that they share.
#[derive(Clone, Debug, Default)]
pub struct ForceRecorder {
    /// The contact forces recorded so far.
    pub meshes: Vec<RecordedForce>,
    /// Times of the samples since the last pieces ended [s].
    group: Vec<f64>,
    /// State at the end of the last step.
    end: State,
    /// Samples within one part of the present step, and those left of the whole step.
    interval: usize,
    left: usize,
    rule: Option<SamplingRule>,
    /// True if jumps without an event are searched within steps.
    finely: bool,
}

/// The contact force of a mesh, as it has been recorded so far.
#[derive(Clone, Debug, Default)]
pub struct RecordedForce {
    /// The contact force.
    pub history: ForceHistory,
    /// Impulse of the transverse part of the force [N s].
    pub impulse: f64,
    /// Samples since the last piece ended, as many as the recorder has times.
    group: Vec<Sample>,
    nodes: Vec<(f64, f64)>,
}

impl ForceRecorder {
    /// A recorder of a number of meshes; with `finely` it also searches within steps for jumps of the forces that no event
    /// marks.
    pub fn new(meshes: usize, finely: bool) -> Self {
        Self {
            meshes: vec![RecordedForce::default(); meshes],
            finely,
            ..Self::default()
        }
    }

    /// Forgets the samples since the last pieces ended.
    fn clear(&mut self) {
        self.group.clear();
        self.meshes.iter_mut().for_each(|m| m.group.clear());
    }

    /// Returns the times of a step at which the force is sampled, ascending, with its end; also its start if that is
    /// not the end of the step before. `silent` is true if there is no force at a time; of a step without force only
    /// the end is sampled.
    pub fn sample_times(
        &mut self,
        sys: &mut dyn SecondOrderSystem,
        step: &AcceptedStep<'_>,
        silent: &mut dyn FnMut(&mut dyn SecondOrderSystem, f64) -> bool,
        times: &mut Vec<f64>,
    ) {
        let (t0, t1) = (step.from.t, step.to.t);
        times.clear();
        if step.flight {
            self.close();
            self.clear();
            return;
        }
        let rule =
            *self
                .rule
                .get_or_insert_with(|| match (is_located(step.from, sys), sys.has_jumps()) {
                    (true, _) => SMOOTH,
                    (false, true) if self.finely => UNSEEN,
                    (false, _) => CONTINUOUS,
                });
        let goes_on = !self.group.is_empty() && self.end == *step.from;
        self.end.copy_from(step.to);
        if !goes_on {
            self.close();
            self.clear();
            times.push(t0);
        }
        let time = sys.characteristic_time(step.to.at());
        let h = t1 - t0;
        let begun = self.group.first().map_or(0.0, |first| t0 - first);
        if begun > 0.0 && begun + h > 1.2 * rule.full * time {
            self.close();
        }
        self.interval = 1;
        let short = h <= 0.2 * rule.full * time;
        let silent_last = |m: &RecordedForce| m.group.last().is_some_and(|s| s[1] == 0.0);
        let was_silent = goes_on && self.meshes.iter().all(silent_last);
        // A piece that is cut short must not be left with two nodes.
        let begun_well = goes_on && self.group.len() >= rule.nodes.len();
        if (begun_well && short) || (was_silent && silent(sys, t1) && silent(sys, t0 + 0.5 * h)) {
            times.push(t1);
            self.left = 1;
            return;
        }
        self.interval = rule.nodes.len() - 1;
        let most = (MOST_LOOKS / self.interval as f64).floor();
        let parts = (h / (rule.longest * time)).ceil().clamp(1.0, most);
        self.left = parts as usize * self.interval;
        for part in 0..parts as usize {
            let inner = rule.nodes[1..].iter();
            let place = inner.map(|x| (part as f64 + x) / parts);
            // Rounded, the last place may lie beyond the end, which no sample ever reaches.
            times.extend(place.map(|x| (t0 + x * h).min(t1)));
        }
        if let Some(last) = times.last_mut() {
            *last = t1;
        }
    }

    /// Records the forces at the next of these times: magnitude and transverse part of each mesh [N].
    pub fn take(
        &mut self,
        sys: &dyn SecondOrderSystem,
        t: f64,
        forces: impl Iterator<Item = [f64; 2]>,
    ) {
        if self.group.last().is_some_and(|last| *last >= t) {
            return;
        }
        self.group.push(t);
        for (mesh, [force, transverse]) in self.meshes.iter_mut().zip(forces) {
            mesh.group.push([t, force, transverse]);
        }
        let Some(rule) = self.rule else { return };
        if self.group.len() > 1 {
            self.left = self.left.saturating_sub(1);
        }
        let length = t - self.group[0];
        let time = sys.characteristic_time(self.end.at());
        // Polynomials end where parts of steps do, or their nodes would lie badly.
        if self.left.is_multiple_of(self.interval) && length >= rule.full * time {
            self.close();
        }
    }

    /// Ends the pieces at the last sample, which is the first of the next pieces.
    pub fn close(&mut self) {
        let (Some(rule), &[.., _, last]) = (self.rule, &self.group[..]) else {
            return;
        };
        for mesh in &mut self.meshes {
            mesh.close(rule);
        }
        self.group.clear();
        self.group.push(last);
    }
}

impl RecordedForce {
    fn close(&mut self, rule: SamplingRule) {
        let &[.., last] = &self.group[..] else {
            return;
        };
        let group = std::mem::take(&mut self.group);
        let silent = |s: &Sample| s[1] == 0.0;
        if !group.iter().all(silent) {
            // A smooth force is zero only at the ends of a contact.
            let inner = &group[1..group.len() - 1];
            let ends = [group[0], last];
            let broken = inner.iter().any(silent)
                || (rule.nodes.len() < MOST_NODES && ends.iter().any(silent));
            if broken {
                for line in group.windows(2) {
                    self.push(line);
                }
            } else {
                let chosen = choose(&group, rule.nodes);
                self.push(&chosen);
            }
        }
        self.group = group;
        self.group.clear();
        self.group.push(last);
    }

    fn push(&mut self, samples: &[Sample]) {
        self.nodes.clear();
        self.nodes.extend(samples.iter().map(|s| (s[0], s[2])));
        self.impulse += integral(&self.nodes);
        self.nodes.clear();
        self.nodes.extend(samples.iter().map(|s| (s[0], s[1])));
        self.history.push(&self.nodes);
    }
}

/// Selects the samples nearest to nodes between the first and the last sample, at least [`CLOSEST`] apart.
fn choose(group: &[Sample], nodes: &[f64]) -> Vec<Sample> {
    let (first, last) = (group[0], group[group.len() - 1]);
    let length = last[0] - first[0];
    let apart = |a: &Sample, b: &Sample| b[0] - a[0] >= CLOSEST * length;
    let mut chosen = vec![first];
    for x in &nodes[1..nodes.len() - 1] {
        let t = first[0] + x * length;
        let above = group
            .partition_point(|s| s[0] < t)
            .clamp(1, group.len() - 1);
        let near = if t - group[above - 1][0] < group[above][0] - t {
            group[above - 1]
        } else {
            group[above]
        };
        if apart(&chosen[chosen.len() - 1], &near) && apart(&near, &last) {
            chosen.push(near);
        }
    }
    chosen.push(last);
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_are_chosen_from_many_samples_and_from_few() {
        let samples =
            |times: &[f64]| -> Vec<Sample> { times.iter().map(|t| [*t, 1.0, 1.0]).collect() };
        let even: Vec<f64> = (0..=1000).map(|i| 1e-3 * f64::from(i)).collect();
        let chosen = choose(&samples(&even), &LOBATTO);
        assert_eq!(chosen.len(), MOST_NODES);
        for (s, x) in chosen.iter().zip(LOBATTO) {
            assert!((s[0] - x).abs() <= 5e-4, "{} {x}", s[0]);
        }
        // A sliver at the end is no node of its own.
        let few = choose(&samples(&[0.0, 0.5, 0.999, 1.0]), &LOBATTO);
        assert_eq!(few, samples(&[0.0, 0.5, 1.0]));
        assert_eq!(choose(&samples(&[0.0, 1.0]), &LOBATTO).len(), 2);
    }
}
