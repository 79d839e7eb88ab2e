//! Deviations of single teeth: pitch, run-out, profile slope and profile form, given or drawn from a
//! class of ISO 1328-1.
//!
//! Amounts on the flanks of tooth `k`, in the transverse plane along the base tangent, material removed
//! counted positive (as for modifications); `s` is the length of roll, `sigma` +1 on left flanks and -1
//! on right ones, `s_f` and `s_a` belong to the form circle and the tip, `s_r` to the reference circle:
//!
//! ```text
//! e_k(s) = -sigma F_k cos(alpha_t)                     pitch: F_k on the reference circle, counter-clockwise
//!          - f_Ha (s - s_r)/(s_a - s_f)                profile slope: more material towards the tip
//!          - f_fa/2 sin(2 pi (s - s_f)/(s_a - s_f))    profile form: one wave of range f_fa
//!          - sigma F_r/2 sin(phi - gamma)              run-out: teeth about a point F_r/2 off the axis, towards phi
//! gamma  = k 2 pi/z + sigma (chi - s/r_b)              direction of the tangent point on the base circle
//! ```
//!
//! Tolerances of ISO 1328-1:2013 for the class A (1 to 11), in um with `d` and `m_n` in mm:
//!
//! ```text
//! single pitch      f_pT  = (0.001 d + 0.4 m_n + 5)                sqrt(2)^(A - 5)
//! cumulative pitch  F_pT  = (0.002 d + 0.55 sqrt(d) + 0.7 m_n + 12) sqrt(2)^(A - 5)
//! profile slope     f_HaT = (0.001 d + 0.4 m_n + 4)                sqrt(2)^(A - 5)
//! profile form      f_faT = (0.55 m_n + 5)                         sqrt(2)^(A - 5)
//! run-out           F_rT  = 0.9 F_pT
//! ```
//!
//! not rounded. A drawn gear is of its class and no better: single pitches are even random numbers, the
//! run-out an eccentricity in a random direction, and both together are scaled until the first of `f_pT`,
//! `F_pT` and `F_rT` is used up; slopes and forms are even random numbers within theirs. Random numbers:
//! SplitMix64 (Steele, Lea, Flood, OOPSLA 2014).

use std::f64::consts::{SQRT_2, TAU};

use super::Side;
use super::error::GeometryError;

/// Deviations of the teeth of a gear.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Deviations {
    /// All teeth are equal.
    #[default]
    None,
    /// Deviations drawn at random from a class of ISO 1328-1.
    Class {
        /// Tolerance class, 1 to 11.
        class: u32,
        /// Seed of the random numbers; the same seed gives the same gear.
        seed: u64,
    },
    /// Measured or otherwise given deviations.
    Given(Box<GivenDeviations>),
}

/// Deviations with given values for each tooth.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GivenDeviations {
    /// Deviations of left and right flanks.
    pub sides: [FlankDeviations; 2],
    /// Run-out F_r (m): twice the distance of the toothing's axis from the gear's.
    pub runout: f64,
    /// Direction of the eccentricity of the toothing, in the gear frame (rad).
    pub runout_direction: f64,
}

/// Deviations of the flanks of one side; a list is empty, or has one value per tooth from tooth 0 on,
/// counter-clockwise.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FlankDeviations {
    /// Cumulative pitch deviation (m): counter-clockwise offset of each flank from its nominal position, on the
    /// reference circle.
    pub cumulative_pitch: Vec<f64>,
    /// Profile slope deviation f_Halpha (m).
    pub profile_slope: Vec<f64>,
    /// Profile form deviation f_falpha (m).
    pub profile_form: Vec<f64>,
}

/// Tolerances of ISO 1328-1:2013 (m).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IsoTolerances {
    /// Single pitch tolerance `f_pT` (m).
    pub single_pitch: f64,
    /// Cumulative pitch tolerance `F_pT` (m).
    pub cumulative_pitch: f64,
    /// Profile slope tolerance `f_HalphaT` (m).
    pub profile_slope: f64,
    /// Profile form tolerance `f_falphaT` (m).
    pub profile_form: f64,
    /// Run-out tolerance `F_rT` (m).
    pub runout: f64,
}

impl IsoTolerances {
    /// Returns the tolerances of a class for a reference diameter and a normal module (m), without rounding.
    pub fn new(class: u32, diameter: f64, module: f64) -> IsoTolerances {
        let (d, m) = (1e3 * diameter, 1e3 * module);
        let unit = 1e-6 * SQRT_2.powi(class as i32 - 5);
        let cumulative_pitch = unit * (0.002 * d + 0.55 * d.sqrt() + 0.7 * m + 12.0);
        IsoTolerances {
            single_pitch: unit * (0.001 * d + 0.4 * m + 5.0),
            cumulative_pitch,
            profile_slope: unit * (0.001 * d + 0.4 * m + 4.0),
            profile_form: unit * (0.55 * m + 5.0),
            runout: 0.9 * cumulative_pitch,
        }
    }
}

/// Toothing data that the deviations of a gear depend on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Toothing {
    pub teeth: u32,
    pub module: f64,
    pub r: f64,
    pub r_base: f64,
    /// Angle of the left involute of tooth 0 on the base circle (rad).
    pub chi: f64,
    /// Lengths of roll at the form circle, the reference circle and the tip (m).
    pub roll: [f64; 3],
}

/// Deviations of every tooth, prepared for evaluation.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ToothDeviations {
    of: Toothing,
    /// Pitch along the base tangent, slope and form per tooth, left and right.
    sides: [Vec<[f64; 3]>; 2],
    /// Eccentricity (m) and its direction (rad).
    eccentric: [f64; 2],
}

impl ToothDeviations {
    /// Prepares the deviations; `None` when all teeth are equal.
    pub(super) fn new(
        deviations: &Deviations,
        of: Toothing,
    ) -> Result<Option<ToothDeviations>, GeometryError> {
        let drawn;
        let given = match deviations {
            Deviations::None => return Ok(None),
            Deviations::Given(given) => given,
            Deviations::Class { class, seed } => {
                check_class(*class, &of)?;
                drawn = draw(
                    IsoTolerances::new(*class, 2.0 * of.r, of.module),
                    *seed,
                    &of,
                );
                &drawn
            }
        };
        let teeth = of.teeth as usize;
        let list = |what, values: &[f64]| match values.len() {
            0 => Ok(vec![0.0; teeth]),
            n if n == teeth && values.iter().all(|x| x.is_finite()) => Ok(values.to_vec()),
            n if n == teeth => Err(refuse(
                what,
                "a value that is not finite",
                "lengths in metre",
            )),
            n => Err(GeometryError::Deviations {
                what,
                found: format!("{n} values"),
                expected: format!("one for each of the {teeth} teeth"),
            }),
        };
        if !(given.runout.is_finite() && given.runout >= 0.0 && given.runout_direction.is_finite())
        {
            let found = format!("{} m at {} rad", given.runout, given.runout_direction);
            return Err(refuse(
                "run-out",
                &found,
                "zero or more, and a finite direction",
            ));
        }
        let side = |flanks: &FlankDeviations| {
            let pitch = list("cumulative pitch deviations", &flanks.cumulative_pitch)?;
            let slope = list("profile slope deviations", &flanks.profile_slope)?;
            let form = list("profile form deviations", &flanks.profile_form)?;
            let on_base = of.r_base / of.r;
            let all = pitch.iter().zip(slope).zip(form);
            let all = all.map(|((p, s), f)| [on_base * p, s, f]);
            Ok::<Vec<[f64; 3]>, GeometryError>(all.collect())
        };
        let [left, right] = &given.sides;
        Ok(Some(ToothDeviations {
            of,
            sides: [side(left)?, side(right)?],
            eccentric: [0.5 * given.runout, given.runout_direction],
        }))
    }

    /// Returns the material removed along the base tangent at the length of roll `s` (m), and its first and second
    /// derivative.
    #[inline]
    pub(super) fn at(&self, tooth: i64, side: Side, s: f64) -> [f64; 3] {
        let index = tooth.rem_euclid(i64::from(self.of.teeth)) as usize;
        let [pitch, slope, form] = self.sides[usize::from(side == Side::Right)][index];
        let sign = side.sign();
        let [low, reference, high] = self.of.roll;
        let length = high - low;
        let wave = TAU / length;
        let (sin, cos) = (wave * (s - low)).sin_cos();
        let [eccentricity, direction] = self.eccentric;
        let turn = index as f64 * TAU / f64::from(self.of.teeth);
        let gamma = turn + sign * (self.of.chi - s / self.of.r_base);
        let (sin_off, cos_off) = (direction - gamma).sin_cos();
        let off = sign * eccentricity * sin_off;
        [
            -sign * pitch - slope * (s - reference) / length - 0.5 * form * sin - off,
            -slope / length - 0.5 * form * wave * cos - eccentricity * cos_off / self.of.r_base,
            0.5 * form * wave * wave * sin + off / (self.of.r_base * self.of.r_base),
        ]
    }

    /// Returns an upper bound of the amount of material removed or left on any flank (m).
    pub(super) fn greatest(&self) -> f64 {
        let flanks = self.sides.iter().flatten();
        let of = |[p, s, f]: &[f64; 3]| p.abs() + s.abs() + 0.5 * f.abs();
        self.eccentric[0] + flanks.map(of).fold(0.0, f64::max)
    }
}

fn refuse(what: &'static str, found: &str, expected: &str) -> GeometryError {
    GeometryError::Deviations {
        what,
        found: found.to_owned(),
        expected: expected.to_owned(),
    }
}

/// Checks the range of validity of the standard.
fn check_class(class: u32, of: &Toothing) -> Result<(), GeometryError> {
    let outside = |fits: bool, found: String, expected: &str| match fits {
        true => Ok(()),
        false => Err(refuse("tolerance class of ISO 1328-1", &found, expected)),
    };
    let (d, m) = (2e3 * of.r, 1e3 * of.module);
    outside((1..=11).contains(&class), class.to_string(), "1 to 11")?;
    outside(
        (5..=1000).contains(&of.teeth),
        format!("{} teeth", of.teeth),
        "5 to 1000 teeth",
    )?;
    outside(
        (5.0..=15_000.0).contains(&d),
        format!("a reference diameter of {d} mm"),
        "5 to 15000 mm",
    )?;
    outside(
        (0.5..=70.0).contains(&m),
        format!("a module of {m} mm"),
        "0.5 to 70 mm",
    )
}

/// Random number generator SplitMix64.
struct Random(u64);

impl Random {
    /// Returns a uniform random number from `low` to `high`.
    fn even(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        low + (high - low) * (z >> 11) as f64 * (-53.0_f64).exp2()
    }
}

fn draw(tolerance: IsoTolerances, seed: u64, of: &Toothing) -> GivenDeviations {
    let mut random = Random(seed);
    let n = of.teeth as usize;
    let mut side = || {
        let single: Vec<f64> = (0..n).map(|_| random.even(-1.0, 1.0)).collect();
        let mean = single.iter().sum::<f64>() / n as f64;
        // The pitches of a whole turn close.
        let mut place = 0.0;
        let mut cumulative: Vec<f64> = single
            .iter()
            .map(|f| {
                place += (f - mean) * tolerance.single_pitch;
                place
            })
            .collect();
        let middle = cumulative.iter().sum::<f64>() / n as f64;
        cumulative.iter_mut().for_each(|x| *x -= middle);
        FlankDeviations {
            cumulative_pitch: cumulative,
            profile_slope: (0..n)
                .map(|_| tolerance.profile_slope * random.even(-1.0, 1.0))
                .collect(),
            profile_form: (0..n)
                .map(|_| tolerance.profile_form * random.even(0.0, 1.0))
                .collect(),
        }
    };
    let mut given = GivenDeviations {
        sides: [side(), side()],
        runout: 0.0,
        runout_direction: 0.0,
    };
    given.runout = tolerance.runout * random.even(0.25, 1.0);
    given.runout_direction = random.even(0.0, TAU);
    // Measured pitch deviations include the eccentricity.
    let used = Side::BOTH.map(|side| {
        let seen = seen_pitches(&given, side, of);
        let (low, high) = seen
            .iter()
            .fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(*x), h.max(*x)));
        let single = (0..n).map(|k| (seen[k] - seen[(k + n - 1) % n]).abs());
        (single.fold(0.0, f64::max) / tolerance.single_pitch)
            .max((high - low) / tolerance.cumulative_pitch)
    });
    let used = used[0].max(used[1]).max(given.runout / tolerance.runout);
    given.runout /= used;
    for side in &mut given.sides {
        side.cumulative_pitch.iter_mut().for_each(|x| *x /= used);
    }
    given
}

/// Returns the cumulative pitch deviations (m) as measured on the reference circle about the axis of the gear.
fn seen_pitches(given: &GivenDeviations, side: Side, of: &Toothing) -> Vec<f64> {
    let sign = side.sign();
    let pitches = &given.sides[usize::from(side == Side::Right)].cumulative_pitch;
    let off = |k: usize| {
        let turn = k as f64 * TAU / f64::from(of.teeth);
        let gamma = turn + sign * (of.chi - of.roll[1] / of.r_base);
        0.5 * given.runout * (given.runout_direction - gamma).sin() * of.r / of.r_base
    };
    pitches
        .iter()
        .enumerate()
        .map(|(k, x)| x + off(k))
        .collect()
}

#[cfg(test)]
#[path = "deviation_tests.rs"]
mod tests;
