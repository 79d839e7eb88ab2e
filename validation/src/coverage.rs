//! Coverage of the 95 % confidence intervals of `gearbench identify` on synthetic data.
//!
//! A model with the constants of its calibration generates a reference impact. Data sets are derived from it: the
//! history is shifted by an unknown offset of the clock, and noise is added with the spectrum of the residuals of the
//! fit to the real reference. That noise is a moving average of independent normal numbers whose coefficients are the
//! residuals themselves, `u_t = n^(-1/2) sum_j r_j e_(t-j)`: its autocovariance is that of the residuals. Each set is
//! fitted as by a user, offset included, and each interval is checked for the true value.

use crate::sampling::random::Random;
use crate::validate::ValidationError;
use gearbench::context::Context;
use gearbench::experiment::runner::Runner;
use gearbench::scene_file::calibration::{Constants, GAP};
use gearbench::scene_file::{self, Selection};
use gearbench::studies::identify::{
    CLOCK, Clock, DataSet, FitOptions, FitPlan, identify, modelled,
};
use gearbench_reference::reference;
use gearbench_reports::identify::Outcome;
use std::fmt::Write as _;

/// Largest offset of a clock in either direction [s].
const OFFSET: f64 = 2e-6;

/// The scene, model and number of data sets of a coverage check.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Name of a scene with a stored reference.
    pub scene: String,
    /// Label of a model with a calibration.
    pub model: String,
    /// Number of synthetic data sets.
    pub sets: usize,
    /// Seed of the noise and the offsets.
    pub seed: u64,
}

/// A parameter of one data set: true value, fitted value and interval.
#[derive(Clone, Debug)]
pub struct Row {
    /// Number of the set, from 1.
    pub set: usize,
    /// Key of the parameter.
    pub parameter: String,
    /// Value of the parameter that generated the data.
    pub truth: f64,
    /// Fitted value; `None` if the fit reports that the data do not determine it.
    pub found: Option<f64>,
    /// Lower and upper end of the confidence interval.
    pub interval: [f64; 2],
}

impl Row {
    /// True if the interval contains the true value; an interval that the fit does not give is unbounded.
    pub fn holds(&self) -> bool {
        (self.interval[0]..=self.interval[1]).contains(&self.truth)
    }
}

/// Coverage by parameter: key, share of intervals that contain the true value, and number of sets without a fitted
/// value.
pub fn coverage(rows: &[Row]) -> Vec<(String, f64, usize)> {
    let mut keys: Vec<&str> = Vec::new();
    for row in rows {
        if !keys.contains(&row.parameter.as_str()) {
            keys.push(&row.parameter);
        }
    }
    let of = |key: &str| {
        let own: Vec<&Row> = rows.iter().filter(|r| r.parameter == key).collect();
        let held = own.iter().filter(|r| r.holds()).count();
        let open = own.iter().filter(|r| r.found.is_none()).count();
        (key.to_owned(), held as f64 / own.len().max(1) as f64, open)
    };
    keys.into_iter().map(of).collect()
}

/// Generates the data sets and fits each of them.
///
/// # Errors
/// [`ValidationError`] where the scene has no such model or reference, or a fit fails.
pub fn check(plan: &Plan, mut done: impl FnMut(usize)) -> Result<Vec<Row>, ValidationError> {
    let other = |e: &dyn std::fmt::Display| ValidationError::Other(e.to_string());
    let labels = Some(plan.model.as_str());
    let scene = scene_file::load_for(&Context::default(), &plan.scene, Selection::Labels(labels))
        .map_err(|e| other(&e.to_text()))?;
    let choice = scene.model(&plan.model);
    let id = scene.reference().and_then(|r| r.stored());
    let truth = choice.and_then(|c| c.calibration.as_ref()?.constants.clone());
    let (Some(choice), Some(truth), Some(id)) = (choice, truth, id) else {
        return Err(ValidationError::Other(format!(
            "`{}` of {} has no calibration, or the scene no stored reference",
            plan.model, plan.scene
        )));
    };
    let stored = reference(id).map_err(|e| other(&e))?;
    let n = stored
        .history
        .time
        .partition_point(|&t| t <= scene.duration);
    let time = &stored.history.time[..n];
    let measured = &stored.history.contact_force[..n];
    let set = DataSet::history(id, &scene.spec_for(choice), time, measured);
    let fit = FitPlan {
        data: vec![set.clone()],
        ..FitPlan::new(scene.clone(), &plan.model, &choice.modelling)
    };
    let model = modelled(&fit, &set, &truth, Clock::default()).map_err(|e| other(&e))?;
    let residuals: Vec<f64> = model.iter().zip(measured).map(|(a, b)| b - a).collect();
    // The gap is the touch time, and so is the offset of the clock: one of them is known.
    let gap = truth.gap.unwrap_or_default();
    let springs = truth.by_key().into_iter().map(|(key, _)| key);
    let mut keys: Vec<String> = springs.filter(|key| key != GAP).collect();
    keys.push(CLOCK.into());

    let mut rows = Vec::new();
    for number in 1..=plan.sets {
        let mut random = Random::of(plan.seed, number, 0);
        let clock = random.between(-OFFSET, OFFSET);
        let shifted = modelled(
            &fit,
            &set,
            &truth,
            Clock {
                offset: clock,
                ..Clock::default()
            },
        )
        .map_err(|e| other(&e))?;
        let force: Vec<f64> = (shifted.iter().zip(moving_average(&residuals, &mut random)))
            .map(|(a, b)| a + b)
            .collect();
        let made = FitPlan {
            data: vec![DataSet {
                ..DataSet::history(&set.name, &set.spec, time, &force)
            }],
            wishes: FitOptions {
                fit: Some(keys.clone()),
                held: vec![(GAP.into(), gap)],
                // The valley is known: what is checked are intervals, not the search for it.
                starts: truth.by_key(),
                ..FitOptions::default()
            },
            ..fit.clone()
        };
        let found = identify(&made, &Runner::default(), |_, _| {}).map_err(|e| other(&e))?;
        let true_values = Constants {
            gap: None,
            ..truth.clone()
        };
        let true_values = true_values
            .by_key()
            .into_iter()
            .chain([(CLOCK.into(), clock)]);
        for (key, truth) in true_values {
            let parameter = found.record.parameters.iter().find(|p| p.key == key);
            let Some(p) = parameter.filter(|p| p.outcome != Outcome::Held) else {
                continue;
            };
            rows.push(Row {
                set: number,
                parameter: key,
                truth,
                found: p.value,
                interval: [
                    p.low.unwrap_or(f64::NEG_INFINITY),
                    p.high.unwrap_or(f64::INFINITY),
                ],
            });
        }
        done(number);
    }
    Ok(rows)
}

/// Noise with the autocovariance of the residuals.
fn moving_average(residuals: &[f64], random: &mut Random) -> Vec<f64> {
    let n = residuals.len();
    let white: Vec<f64> = (0..2 * n).map(|_| random.normal()).collect();
    (0..n)
        .map(|t| {
            let terms = residuals.iter().enumerate();
            let sum: f64 = terms.map(|(j, r)| r * white[n + t - j]).sum();
            sum / (n as f64).sqrt()
        })
        .collect()
}

/// All rows as CSV.
pub fn csv(plan: &Plan, rows: &[Row]) -> String {
    let mut out = format!(
        "# gearbench-validation coverage {} --model {} --sets {} --seed {}\n",
        plan.scene, plan.model, plan.sets, plan.seed
    );
    out.push_str("set,parameter,truth,found,low_95,high_95,holds\n");
    let number = |x: f64| {
        if x.is_finite() {
            format!("{x:.6e}")
        } else {
            String::new()
        }
    };
    for row in rows {
        // Writing to a string cannot fail.
        let _ = writeln!(
            out,
            "{},{},{},{},{},{},{}",
            row.set,
            row.parameter,
            number(row.truth),
            row.found.map_or_else(String::new, number),
            number(row.interval[0]),
            number(row.interval[1]),
            row.holds()
        );
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reduced version of the stored check with rigid gears and few data sets. Of 24 intervals 95 % contain the true
    /// value on average, and fewer than 20 do in one of 200 such checks. One clock offset of these sets cannot be
    /// determined, and does not count as contained.
    #[test]
    fn intervals_hold_the_truth() {
        let plan = Plan {
            scene: "spur_impact".into(),
            model: "rigid".into(),
            sets: 24,
            seed: 1,
        };
        let rows = check(&plan, |_| {}).unwrap();
        for (key, part, open) in coverage(&rows) {
            assert!(
                part >= 20.0 / 24.0 && open <= 1,
                "{key}: {part}, {open} open"
            );
        }
        assert!(csv(&plan, &rows).lines().count() == 2 + rows.len());
    }

    /// The autocovariance of the noise is that of the residuals.
    #[test]
    fn the_noise_has_the_spectrum_of_the_residuals() {
        let residuals: Vec<f64> = (0..50).map(|i| (0.3 * f64::from(i)).sin()).collect();
        let n = residuals.len();
        let lagged = |x: &[f64], lag: usize| -> f64 {
            x.iter().zip(&x[lag..]).map(|(a, b)| a * b).sum::<f64>()
        };
        let (mut found, draws) = ([0.0; 2], 4000);
        for seed in 0..draws {
            let u = moving_average(&residuals, &mut Random::new(seed));
            for (lag, sum) in [0, 5].into_iter().zip(&mut found) {
                *sum += lagged(&u, lag) / (n - lag) as f64 / draws as f64;
            }
        }
        for (lag, found) in [0, 5].into_iter().zip(found) {
            let expected = lagged(&residuals, lag) / n as f64;
            assert!(
                (found - expected).abs() < 0.02,
                "{lag}: {found} and {expected}"
            );
        }
    }
}
