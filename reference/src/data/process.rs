//! Processing of histories: clock, zero, moving average, window, resampling, in this order.
//!
//! The moving average is that of the linearly interpolated samples over a window of time about each sample, which is
//! narrower at both ends so that it stays centred: it moves no feature in time. It applies to the reference alone; a
//! run that is compared with it keeps its own force, so that a window has to be short compared with the features of
//! the force.

use super::Channel;

/// Processing of histories before a comparison.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Processing {
    /// Factor on all times, before the offset: the rate of the recorder's clock; `None` for 1.
    pub time_factor: Option<f64>,
    /// Added to all times [s].
    pub offset: f64,
    /// First and last time [s], after the offset, of a part whose mean becomes zero.
    pub zero: Option<[f64; 2]>,
    /// Width of a centred moving average [s].
    pub moving_average: Option<f64>,
    /// First time that is kept [s].
    pub from: f64,
    /// Last time that is kept [s].
    pub to: Option<f64>,
    /// Step of even times [s].
    pub resample: Option<f64>,
}

/// Even times at most.
const MOST: f64 = 1e7;

/// Expected content, actual content and remedy of a problem.
type ProcessingProblem = (String, String, String);

impl Processing {
    /// Applies the processing and describes it in lines; every history keeps at least `least` samples.
    pub(super) fn apply(
        &self,
        channels: &mut Vec<Channel>,
        least: usize,
    ) -> Result<Vec<String>, ProcessingProblem> {
        let mut lines = Vec::new();
        if let Some(factor) = self.time_factor.filter(|x| *x != 1.0) {
            if !(factor > 0.0 && factor.is_finite()) {
                return Err((
                    "a positive factor on times".into(),
                    format!("{factor:e}"),
                    "give the seconds of the scene over the seconds of the recorder, for example 1.00002".into(),
                ));
            }
            lines.push(format!("times multiplied by {factor:?}"));
            let times = channels.iter_mut().flat_map(|c| &mut c.time);
            times.for_each(|t| *t *= factor);
        }
        if self.offset != 0.0 {
            lines.push(format!("times shifted by {:e} s", self.offset));
            let times = channels.iter_mut().flat_map(|c| &mut c.time);
            times.for_each(|t| *t += self.offset);
        }
        let end = self.to.unwrap_or(f64::INFINITY);
        let whole = channels
            .iter()
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], c| {
                [a.min(c.time[0]), b.max(c.time[c.time.len() - 1])]
            });
        if let Some(part) = self.zero {
            for c in channels.iter_mut() {
                let Some(mean) = mean_over(&c.time, &c.value, part) else {
                    return Err((
                        format!(
                            "samples from {:e} s to {:e} s, over which the mean becomes zero",
                            part[0], part[1]
                        ),
                        format!("times from {:e} s to {:e} s", whole[0], whole[1]),
                        "give two times within the record, after the offset, in ascending order"
                            .into(),
                    ));
                };
                c.value.iter_mut().for_each(|x| *x -= mean);
                lines.push(format!(
                    "mean of the {} from {:e} s to {:e} s subtracted: {mean:e}",
                    c.quantity.words(),
                    part[0],
                    part[1]
                ));
            }
        }
        if let Some(width) = self.moving_average {
            let span = whole[1] - whole[0];
            if width > span {
                return Err((
                    format!("a moving average over at most {span:e} s, the duration of the table"),
                    format!("one over {width:e} s"),
                    "give a window of a few samples in seconds".into(),
                ));
            }
            for c in channels.iter_mut() {
                c.value = moving_average(&c.time, &c.value, width);
            }
            lines.push(format!(
                "centred moving average over {width:e} s, applied to the reference but not to the runs"
            ));
        }
        let mut left_out = 0;
        // The last digit of a window or an offset is no reason to lose an end.
        let slack = 1e-9 * (whole[1] - whole[0]);
        for c in channels.iter_mut() {
            let before = c.time.len();
            let first = c.time.partition_point(|&t| t < self.from - slack);
            let last = c.time.partition_point(|&t| t <= end + slack);
            c.time = c.time[first.min(last)..last].to_vec();
            c.value = c.value[first.min(last)..last].to_vec();
            left_out += before - c.time.len();
        }
        if channels.iter().all(|c| c.time.len() < least) {
            let to = self.to.map_or("the end".into(), |t| format!("{t:e} s"));
            return Err((
                format!("at least {least} samples from {:e} s to {to}", self.from),
                format!("times from {:e} s to {:e} s", whole[0], whole[1]),
                "the scene begins at 0: shift the times by `offset_s`, and check their unit".into(),
            ));
        }
        for c in channels.iter().filter(|c| c.time.len() < least) {
            let what = c.quantity.words();
            lines.push(format!(
                "a {what} has fewer than {least} samples in this range and is left out"
            ));
        }
        channels.retain(|c| c.time.len() >= least);
        if left_out > 0 {
            let to = self.to.map_or("the end".into(), |t| format!("{t:e} s"));
            lines.push(format!(
                "{left_out} samples outside {:e} s to {to} left out",
                self.from
            ));
        }
        if let Some(step) = self.resample {
            for c in channels.iter_mut() {
                let [first, last] = [c.time[0], c.time[c.time.len() - 1]];
                let count = ((last - first) / step * (1.0 + 1e-12)).floor();
                if !(2.0..=MOST).contains(&count) {
                    return Err((
                        format!("a step that gives 3 to {MOST:e} samples"),
                        format!("{step:e} s over {:e} s", last - first),
                        "give another `resample_s`".into(),
                    ));
                }
                let times: Vec<f64> = (0..=count as usize)
                    .map(|i| first + step * i as f64)
                    .collect();
                c.value = times.iter().map(|&t| at(&c.time, &c.value, t)).collect();
                c.time = times;
            }
            lines.push(format!(
                "resampled every {step:e} s, linearly between samples"
            ));
        }
        let sound = |c: &Channel| {
            c.time.windows(2).all(|w| w[0] < w[1]) && c.value.iter().all(|x| x.is_finite())
        };
        match channels.iter().find(|c| !sound(c)) {
            None => Ok(lines),
            Some(c) => Err((
                "times that differ in their digits".into(),
                format!("equal times of a {}", c.quantity.words()),
                "give times from the start of the scene; see `offset_s`".into(),
            )),
        }
    }
}

/// Linear between samples, constant outside.
fn at(time: &[f64], value: &[f64], t: f64) -> f64 {
    let i = time.partition_point(|&x| x <= t);
    match (i, i == time.len()) {
        (0, _) => value[0],
        (i, true) => value[i - 1],
        (i, false) => {
            let u = (t - time[i - 1]) / (time[i] - time[i - 1]);
            value[i - 1] + u * (value[i] - value[i - 1])
        }
    }
}

/// Mean of the samples between two times; `None` without samples there.
fn mean_over(time: &[f64], value: &[f64], [from, to]: [f64; 2]) -> Option<f64> {
    let within = time.iter().zip(value);
    let within = within.filter(|(t, _)| (from..=to).contains(*t));
    let (sum, count) = within.fold((0.0, 0_usize), |(sum, n), (_, x)| (sum + x, n + 1));
    (count > 0).then(|| sum / count as f64)
}

/// See the head of the module.
fn moving_average(time: &[f64], value: &[f64], width: f64) -> Vec<f64> {
    let mut integral = Vec::with_capacity(time.len());
    let mut sum = 0.0;
    integral.push(0.0);
    for i in 1..time.len() {
        sum += 0.5 * (time[i] - time[i - 1]) * (value[i] + value[i - 1]);
        integral.push(sum);
    }
    let integral_to = |t: f64| {
        let i = time.partition_point(|&x| x <= t).clamp(1, time.len() - 1);
        let h = t - time[i - 1];
        integral[i - 1] + 0.5 * h * (value[i - 1] + at(time, value, t))
    };
    let [first, last] = [time[0], time[time.len() - 1]];
    (time.iter().zip(value))
        .map(|(&t, &x)| {
            let half = (0.5 * width).min(t - first).min(last - t);
            match half > 0.0 {
                true => (integral_to(t + half) - integral_to(t - half)) / (2.0 * half),
                false => x,
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::Quantity;

    fn channel(time: &[f64], value: &[f64]) -> Vec<Channel> {
        vec![Channel {
            quantity: Quantity::Force(0),
            time: time.to_vec(),
            value: value.to_vec(),
        }]
    }

    /// The mean of a line is its middle, that of a parabola lies h^2/24 of its curvature above: exact with samples at
    /// hand, on uneven times as well.
    #[test]
    fn a_centred_average_moves_nothing() {
        let time: Vec<f64> = (0..2001).map(|i| 1e-3 * f64::from(i)).collect();
        let line: Vec<f64> = time.iter().map(|t| 3.0 - 2.0 * t).collect();
        let found = moving_average(&time, &line, 0.1);
        assert!(found.iter().zip(&line).all(|(a, b)| (a - b).abs() < 1e-12));
        let parabola: Vec<f64> = time.iter().map(|t| t * t).collect();
        let found = moving_average(&time, &parabola, 0.1);
        let above = 0.1 * 0.1 / 12.0;
        for i in [200, 1000, 1800] {
            assert!((found[i] - parabola[i] - above).abs() < 1e-6, "{i}");
        }
        let uneven = [0.0, 0.1, 0.15, 0.5, 0.8, 1.0];
        let line = uneven.map(|t| 1.0 + t);
        let found = moving_average(&uneven, &line, 0.3);
        assert!(found.iter().zip(line).all(|(a, b)| (a - b).abs() < 1e-12));
    }

    #[test]
    fn the_mean_of_a_part_becomes_zero() {
        let mut all = channel(&[0.0, 1.0, 2.0, 3.0], &[4.0, 6.0, 9.0, 1.0]);
        let todo = Processing {
            offset: -1.0,
            zero: Some([-1.0, 0.0]),
            ..Processing::default()
        };
        todo.apply(&mut all, 3).unwrap();
        assert_eq!(all[0].value, [1.0, 4.0, -4.0]);
        let mut all = channel(&[0.0, 1.0, 2.0], &[4.0, 6.0, 9.0]);
        let late = Processing {
            zero: Some([5.0, 6.0]),
            ..Processing::default()
        };
        assert!(late.apply(&mut all, 3).is_err());
    }

    #[test]
    fn a_clock_has_an_offset_and_a_rate() {
        let mut all = channel(&[0.0, 1.0, 2.0, 4.0], &[5.0, 6.0, 9.0, 1.0]);
        let todo = Processing {
            time_factor: Some(1.5),
            offset: -1.0,
            from: f64::NEG_INFINITY,
            ..Processing::default()
        };
        let lines = todo.apply(&mut all, 3).unwrap();
        assert_eq!(all[0].time, [-1.0, 0.5, 2.0, 5.0]);
        assert_eq!(all[0].value, [5.0, 6.0, 9.0, 1.0]);
        assert_eq!(lines.len(), 2, "{lines:?}");
        for bad in [0.0, -1.0, f64::NAN] {
            let todo = Processing {
                time_factor: Some(bad),
                ..Processing::default()
            };
            let why = todo.apply(&mut all, 3).unwrap_err();
            assert!(why.0.contains("positive factor"), "{why:?}");
        }
    }

    #[test]
    fn offset_window_and_even_times() {
        let mut all = channel(&[0.0, 1.0, 2.0, 4.0, 5.0], &[0.0, 1.0, 2.0, 4.0, 5.0]);
        let todo = Processing {
            offset: -1.0,
            to: Some(3.0),
            resample: Some(0.5),
            ..Processing::default()
        };
        let lines = todo.apply(&mut all, 3).unwrap();
        assert_eq!(all[0].time, [0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0]);
        assert!(
            all[0]
                .value
                .iter()
                .zip(&all[0].time)
                .all(|(x, t)| x - t == 1.0)
        );
        assert_eq!(lines.len(), 3, "{lines:?}");
        let late = Processing {
            offset: 1e3,
            to: Some(1.0),
            ..Processing::default()
        };
        let mut all = channel(&[0.0, 1.0, 2.0], &[0.0; 3]);
        assert!(late.apply(&mut all, 3).unwrap_err().1.contains("1e3"));
    }
}
