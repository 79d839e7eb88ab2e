//! Random scenes for the validation of model choices.
//!
//! A set has a seed; scene `n` of it follows from the seed and `n` alone. Gears come from a short list, everything else
//! from distributions: approach speed `v`, added inertia, load, damping, backlash, start, mount, metric, tolerance.
//! With the tooth pair's stiffness `k` (norm) and the reduced mass `m` on the line of action
//!
//! ```text
//! 1/m = r_b1^2/J_1 + r_b2^2/J_2     T = pi sqrt(m/k)     F = v sqrt(k m)
//! ```
//!
//! are length and peak force of an impact, by which loads and durations are scaled. There are three kinds of scenes:
//! one impact, several impacts within the backlash, and running under load for some mesh cycles.
//!
//! A scene is valid if rigid gears of the norm's stiffness move in it according to its kind, and no tooth is loaded
//! beyond the strength of steel. The run of rigid gears takes microseconds and gives begin and end of the contacts,
//! from which the duration follows. An invalid scene is sampled again from the next stream of random numbers, and this
//! is counted.

mod distributions;
pub mod random;
mod rigid;
mod sets;
#[cfg(test)]
mod tests;
mod text;
mod toothing;

use gearbench::context::Context;
pub use sets::{SampleError, Set, set};

pub use distributions::Kind;
use distributions::{LONGEST, Parameters, parameters};
use gearbench::scene_file::{Origin, SceneFile};
use gearbench_models::spec::mesh_layout;
use gearbench_reports::Metric;
use random::Random;
use sets::MOST_SAMPLES;

/// Largest load `F / (b m_n)` [Pa]; the bending stress at the tooth root is about four times as large.
const BEARABLE: f64 = 150e6;
/// Time of flight after an impact that belongs to the scene, and required time of flight, relative to the duration of
/// the impact: softer gears separate later.
const AFTER: [f64; 2] = [0.35, 0.6];
/// Time of flight before the first of several impacts, relative to the duration of an impact, where that impact is run
/// alone.
const FLIGHT: f64 = 0.25;
/// Share of the time of flight after the last of several impacts that belongs to the scene.
const AFTER_LAST: f64 = 0.3;
/// Share of the path of contact at either end in which no impact starts, as tip corners are in contact there.
const PATH_MARGIN: f64 = 0.1;

/// A random scene with the question to its model choice.
#[derive(Clone, Debug)]
pub struct Sample {
    /// Number of the scene in its set, from 1.
    pub number: usize,
    pub kind: Kind,
    /// Metric of the question.
    pub metric: Metric,
    /// Largest error that counts as adequate.
    pub tolerance: f64,
    /// Estimated duration of an impact [s].
    pub contact_time: f64,
    /// True if modes have modal damping, which full finite elements cannot have.
    pub damps_modes: bool,
    pub text: String,
    /// The scene of `text`; its models are read, but not built.
    pub scene: SceneFile,
    /// Number of rejected samples before this one.
    pub rejected: u32,
}

/// Samples the scene of a set with a number, from 1.
///
/// # Errors
/// [`SampleError`]: no such scene, or a sampling that breaks its own rules.
pub fn sample(set: &Set, number: usize) -> Result<Sample, SampleError> {
    if !(1..=set.scenes).contains(&number) {
        return Err(SampleError::Number {
            set: set.name.clone(),
            last: set.scenes,
            number,
        });
    }
    let mut last = String::new();
    for rejected in 0..MOST_SAMPLES {
        let mut random = Random::of(set.seed, number, rejected);
        let parameters = parameters(&mut random, set, number)?;
        match sound(&parameters)? {
            Ok((text, scene)) => {
                return Ok(Sample {
                    number,
                    kind: parameters.kind,
                    metric: parameters.metric,
                    tolerance: parameters.tolerance,
                    contact_time: parameters.contact_time,
                    damps_modes: parameters.modal_ratio > 0.0,
                    text,
                    scene,
                    rejected,
                });
            }
            Err(why) => last = why.to_owned(),
        }
    }
    Err(SampleError::Unsound {
        set: set.name.clone(),
        number,
        last,
    })
}

/// Reduces a scene with several impacts to the first one: returns a start gap with a short flight, and the duration up
/// to the end of the impact and some flight [m, s].
///
/// # Errors
/// [`SampleError`]: the scene cannot be built.
pub fn one_impact(sample: &Sample) -> Result<(f64, f64), SampleError> {
    let mut scene = sample.scene.clone();
    let first = |scene: &SceneFile| -> Result<[f64; 2], SampleError> {
        let (_, contacts) = rigid::contacts(scene, sample.contact_time)?;
        Ok(contacts.first().copied().unwrap_or([0.0, scene.duration]))
    };
    let [touch, _] = first(&scene)?;
    let gap = scene.spec.meshes[0].start.gap * (FLIGHT * sample.contact_time / touch).min(1.0);
    scene.spec.meshes[0].start.gap = gap;
    let [from, to] = first(&scene)?;
    Ok((gap, to + AFTER[0] * (to - from)))
}

/// Numbers of the scenes of a set for the validation against full finite elements: the first ones with one impact and
/// without modal damping.
pub fn full_order(set: &Set) -> Result<Vec<usize>, SampleError> {
    let mut found = Vec::new();
    for number in 1..=set.scenes {
        if found.len() == set.full_order {
            break;
        }
        let sample = sample(set, number)?;
        if sample.kind == Kind::Impact && !sample.damps_modes {
            found.push(number);
        }
    }
    Ok(found)
}

/// Builds the scene of some parameters, or returns the reason for their rejection.
fn sound(p: &Parameters) -> Result<Result<(String, SceneFile), &'static str>, SampleError> {
    let file = format!("{}-{}.toml", p.set, p.number);
    let parse =
        |text: &str| SceneFile::unbuilt(&Context::default(), &file, text, Origin::Shipped, false);
    let unplaced = parse(&text::scene(p, None, p.window)?)?;
    let [a, b] = [0, 1].map(|i| &unplaced.spec.gears[i]);
    let [start, end] = mesh_layout(a, b)?.path;
    let margin = PATH_MARGIN * (end - start);
    let path = start + margin + p.place * (end - start - 2.0 * margin);

    let scene = parse(&text::scene(p, Some(path), p.window)?)?;
    let (peak, contacts) = rigid::contacts(&scene, p.contact_time)?;
    if peak.is_nan() || peak > BEARABLE * p.toothing.width * p.toothing.module {
        return Ok(Err("the teeth are overloaded"));
    }
    let duration = match p.kind {
        Kind::Impact => match contacts[..] {
            [[from, to], ref rest @ ..] if to < p.window => {
                let length = to - from;
                let next = rest.first().map_or(p.window, |c| c[0]);
                if next < to + AFTER[1] * length {
                    return Ok(Err("the flanks touch again at once"));
                }
                to + AFTER[0] * length
            }
            _ => return Ok(Err("the flanks do not touch and part")),
        },
        Kind::Hammer => {
            let n = p.count as usize;
            if contacts.len() <= n {
                return Ok(Err("there are too few impacts"));
            }
            let [ends, next] = [contacts[n - 1][1], contacts[n][0]];
            ends + AFTER_LAST * (next - ends)
        }
        Kind::Load => {
            if contacts.is_empty() {
                return Ok(Err("the flanks do not touch"));
            }
            p.window
        }
    };
    if duration > LONGEST {
        return Ok(Err("it takes too long"));
    }
    let text = text::scene(p, Some(path), duration)?;
    let scene = parse(&text)?;
    Ok(Ok((text, scene)))
}
