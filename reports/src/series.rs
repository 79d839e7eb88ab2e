//! Time series of a run or of a reference, in SI units.
//!
//! Owns [`TimeSeries`] with its invariants (all columns as long as the time axis or absent, time not
//! decreasing), linear interpolation, and thinning that keeps the extrema.

use crate::force::ForceHistory;
use serde::{Deserialize, Serialize};

/// Column of the position of the tooth of the first mesh in its backlash [-]; for further meshes the names of their
/// gears follow.
pub const BACKLASH_POSITION: &str = "backlash_position";
/// Column of the error of the speed ratio of the first mesh [-]; for further meshes the names of their gears follow.
pub const SPEED_RATIO_ERROR: &str = "speed_ratio_error";
/// Returns the name of the column of a quantity of a mesh, which begins and ends with given words: the names of its gears
/// stand between them, except for the first mesh of a scene.
pub fn mesh_column(begin: &str, end: &str, further: Option<[&str; 2]>) -> String {
    match further {
        None => format!("{begin}{end}"),
        Some([a, b]) => format!("{begin}_{a}_{b}{end}"),
    }
}

/// Prefix of the columns with the deflection of a movable tooth; the name of the gear follows it.
pub const TOOTH_DEFLECTION: &str = "tooth_deflection";
/// Prefix of the columns with the radial part of the contact force on a movable tooth; the name of the gear follows it.
pub const TOOTH_RADIAL_FORCE: &str = "tooth_radial_force";
/// Prefix of the columns with the tangential part of the contact force on a movable tooth; the name of the gear follows
/// it.
pub const TOOTH_TANGENTIAL_FORCE: &str = "tooth_tangential_force";
/// Prefix of the columns with the force of the spring and damper of a movable tooth; the name of the gear follows it.
pub const TOOTH_SPRING_FORCE: &str = "tooth_spring_force";

/// Sampled histories over a common time axis.
///
/// Every column is as long as `time_s`, or empty where a reference does not have it; the time does not decrease (two samples at one time mark a
/// jump). `omega*_rad_s` are momentum means, angular momentum over inertia, so that rigid and
/// elastic bodies compare.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct TimeSeries {
    /// Times of the samples \[s\], not decreasing; two equal times are the two sides of a jump.
    pub time_s: Vec<f64>,
    /// Contact force, the magnitude in space of the vector sum over the tooth pairs: on helical gears the force normal to
    /// the flanks, not its transverse part \[N\].
    pub contact_force_n: Vec<f64>,
    /// Angular velocity of gear 1 [rad/s].
    pub omega1_rad_s: Vec<f64>,
    /// Angular velocity of gear 2 [rad/s]; for a rack the speed over the pitch radius of the mate.
    pub omega2_rad_s: Vec<f64>,
    /// Further columns; the name carries the unit.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub columns: Vec<Column>,
    /// The contact force between the events of the run, for metrics: known while a study runs and in its journal, not
    /// kept in records. References from elsewhere have none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force: Option<ForceHistory>,
}

/// One further named column of a [`TimeSeries`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Column {
    /// Name with unit, for example `transmission_error_m`.
    pub name: String,
    /// Values, one per time sample.
    pub values: Vec<f64>,
}

impl TimeSeries {
    /// Makes a series of the four standard columns.
    ///
    /// # Errors
    /// A sentence that names the broken invariant.
    pub fn new(
        time_s: Vec<f64>,
        contact_force_n: Vec<f64>,
        omega1_rad_s: Vec<f64>,
        omega2_rad_s: Vec<f64>,
    ) -> Result<Self, String> {
        let series = Self {
            time_s,
            contact_force_n,
            omega1_rad_s,
            omega2_rad_s,
            ..Self::default()
        };
        series.validate()?;
        Ok(series)
    }

    /// Appends one sample of the four standard columns [s, N, rad/s, rad/s].
    pub fn push(&mut self, t: f64, force: f64, omega1: f64, omega2: f64) {
        self.time_s.push(t);
        self.contact_force_n.push(force);
        self.omega1_rad_s.push(omega1);
        self.omega2_rad_s.push(omega2);
    }

    /// Returns the values of a standard or further column by its name; `None` where a reference does not have it.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        let mut all = self.named_columns();
        all.find_map(|(n, values)| (n == name).then_some(values))
    }

    /// Returns the samples of the contact force of a mesh, given by the names of its gears and whether it is the first of
    /// the scene.
    pub fn mesh_force(&self, [a, b]: &[String; 2], first: bool) -> Option<&[f64]> {
        let further = (!first).then_some([a.as_str(), b.as_str()]);
        self.column(&mesh_column("contact_force", "_n", further))
    }

    /// Returns the number of samples.
    pub fn len(&self) -> usize {
        self.time_s.len()
    }

    /// True if the series has no samples.
    pub fn is_empty(&self) -> bool {
        self.time_s.is_empty()
    }

    /// Checks the invariants of the type.
    ///
    /// # Errors
    /// A sentence that names the column or the time where an invariant is broken.
    pub fn validate(&self) -> Result<(), String> {
        let n = self.len();
        for (name, column) in self.named_columns() {
            if column.len() != n {
                return Err(format!(
                    "column {name} has {} samples, the time axis has {n}",
                    column.len()
                ));
            }
        }
        match self.time_s.windows(2).find(|w| w[1] < w[0]) {
            Some(w) => Err(format!("time falls from {} s to {} s", w[0], w[1])),
            None => self.force.iter().try_for_each(ForceHistory::validate),
        }
    }

    /// Returns all columns except time with their names, standard ones first; columns that a reference does not have
    /// are left out.
    pub fn named_columns(&self) -> impl Iterator<Item = (&str, &[f64])> {
        [
            ("contact_force_n", self.contact_force_n.as_slice()),
            ("omega1_rad_s", self.omega1_rad_s.as_slice()),
            ("omega2_rad_s", self.omega2_rad_s.as_slice()),
        ]
        .into_iter()
        .chain(
            self.columns
                .iter()
                .map(|c| (c.name.as_str(), c.values.as_slice())),
        )
        .filter(|(_, column)| self.is_empty() || !column.is_empty())
    }

    /// Returns the samples before the first that is not finite in any column, which are the usable part of a run that
    /// blew up.
    #[must_use]
    pub fn finite_prefix(&self) -> Self {
        self.select(&(0..self.finite_len()).collect::<Vec<_>>())
    }

    /// Returns the number of samples before the first that is not finite in any column.
    pub(crate) fn finite_len(&self) -> usize {
        self.named_columns()
            .map(|(_, c)| c)
            .chain([self.time_s.as_slice()])
            .map(|c| c.iter().position(|x| !x.is_finite()).unwrap_or(c.len()))
            .min()
            .unwrap_or(0)
    }

    /// Returns a series of at most about `6 * buckets` samples that keeps the extrema of each standard column in every
    /// bucket of time.
    #[must_use]
    pub fn decimated(&self, buckets: usize) -> Self {
        if buckets == 0 || self.len() <= 6 * buckets || self.validate().is_err() {
            return Self {
                force: None,
                ..self.clone()
            };
        }
        let mut keep = vec![0, self.len() - 1];
        for column in [
            &self.contact_force_n,
            &self.omega1_rad_s,
            &self.omega2_rad_s,
        ] {
            keep.extend(extrema_per_bucket(&self.time_s, column, buckets));
        }
        keep.sort_unstable();
        keep.dedup();
        self.select(&keep)
    }

    /// Returns a decimated series as [`TimeSeries::decimated`] does, but with every sample whose time lies in `window`
    /// \[s\]: charts show a part of a long history in close-up.
    #[must_use]
    pub fn decimated_around(&self, buckets: usize, window: [f64; 2]) -> Self {
        let thin = self.decimated(buckets);
        if thin.len() == self.len() {
            return thin;
        }
        let inside = |t: f64| t >= window[0] && t <= window[1];
        let rows = |of: &Self, wanted: &dyn Fn(f64) -> bool| -> Self {
            let rows: Vec<usize> = (0..of.len()).filter(|&i| wanted(of.time_s[i])).collect();
            of.select(&rows)
        };
        let mut all = rows(&thin, &|t| t < window[0]);
        all.append(rows(self, &inside));
        all.append(rows(&thin, &|t| t > window[1]));
        all
    }

    /// Appends the samples of a series with the same columns.
    fn append(&mut self, other: Self) {
        self.time_s.extend(other.time_s);
        self.contact_force_n.extend(other.contact_force_n);
        self.omega1_rad_s.extend(other.omega1_rad_s);
        self.omega2_rad_s.extend(other.omega2_rad_s);
        for (c, o) in self.columns.iter_mut().zip(other.columns) {
            c.values.extend(o.values);
        }
    }

    fn select(&self, rows: &[usize]) -> Self {
        let pick = |c: &[f64]| -> Vec<f64> {
            let rows = if c.is_empty() { &[] } else { rows };
            rows.iter().map(|&i| c[i]).collect()
        };
        Self {
            time_s: pick(&self.time_s),
            contact_force_n: pick(&self.contact_force_n),
            omega1_rad_s: pick(&self.omega1_rad_s),
            omega2_rad_s: pick(&self.omega2_rad_s),
            columns: self
                .columns
                .iter()
                .map(|c| Column {
                    name: c.name.clone(),
                    values: pick(&c.values),
                })
                .collect(),
            force: None,
        }
    }
}

/// Returns the indices of a min-max decimation of a polyline over `buckets` equal parts of its time span.
///
/// Returns ascending indices: the first and last sample, and of each bucket the samples with the
/// least and the greatest value. Nothing is dropped where this would not shorten the line.
pub fn decimate(t: &[f64], y: &[f64], buckets: usize) -> Vec<usize> {
    let n = t.len().min(y.len());
    if n <= 2 * buckets + 2 || buckets == 0 {
        return (0..n).collect();
    }
    let mut keep = extrema_per_bucket(&t[..n], &y[..n], buckets);
    keep.extend([0, n - 1]);
    keep.sort_unstable();
    keep.dedup();
    keep
}

fn extrema_per_bucket(t: &[f64], y: &[f64], buckets: usize) -> Vec<usize> {
    let n = t.len().min(y.len());
    let Some((&first, &last)) = t[..n].first().zip(t[..n].last()) else {
        return Vec::new();
    };
    let width = (last - first) / buckets as f64;
    let bucket_of = |i: usize| {
        if width > 0.0 {
            (((t[i] - first) / width) as usize).min(buckets - 1)
        } else {
            0
        }
    };
    let mut keep = Vec::with_capacity(2 * buckets);
    let mut start = 0;
    while start < n {
        let bucket = bucket_of(start);
        let (mut low, mut high, mut i) = (start, start, start);
        while i < n && bucket_of(i) == bucket {
            if y[i] < y[low] {
                low = i;
            }
            if y[i] > y[high] {
                high = i;
            }
            i += 1;
        }
        keep.extend([low, high]);
        start = i;
    }
    keep
}

/// Interpolates `y(t)` linearly at the ascending times `at`, each moved by `-shift`; zero outside the samples, since a
/// force that was not computed counts as none.
pub(crate) fn resample(t: &[f64], y: &[f64], at: &[f64], shift: f64, out: &mut Vec<f64>) {
    out.clear();
    let n = t.len().min(y.len());
    let mut i = 0;
    for &time in at {
        let x = time - shift;
        if n == 0 || x < t[0] || x > t[n - 1] {
            out.push(0.0);
            continue;
        }
        while i + 1 < n && t[i + 1] < x {
            i += 1;
        }
        let j = (i + 1).min(n - 1);
        let h = t[j] - t[i];
        let u = if h > 0.0 { (x - t[i]) / h } else { 0.0 };
        out.push(y[i] + u * (y[j] - y[i]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimation_keeps_every_spike() {
        let n = 100_000;
        let t: Vec<f64> = (0..n).map(|i| i as f64 * 1e-6).collect();
        let mut y = vec![0.0; n];
        let spikes = [17, 4_242, 4_243, 50_001, 99_998];
        for (k, &i) in spikes.iter().enumerate() {
            y[i] = (k as f64 + 1.0) * if k % 2 == 0 { 1.0 } else { -1.0 };
        }
        let keep = decimate(&t, &y, 800);
        assert!(keep.len() <= 1602, "{}", keep.len());
        assert!(keep.windows(2).all(|w| w[0] < w[1]));
        for i in spikes {
            assert!(keep.contains(&i), "spike at sample {i} was lost");
        }
        assert_eq!((keep[0], keep[keep.len() - 1]), (0, n - 1));
    }

    #[test]
    fn thinning_keeps_the_extrema_of_all_columns() {
        let mut s = TimeSeries::default();
        for i in 0..20_000 {
            let x = f64::from(i);
            s.push(
                x * 1e-5,
                (x * 0.37).sin(),
                (x * 0.11).cos(),
                (x * 0.05).sin(),
            );
        }
        let thin = s.decimated(200);
        assert!(thin.len() <= 1202);
        thin.validate().unwrap();
        for ((_, a), (_, b)) in s.named_columns().zip(thin.named_columns()) {
            let max = |c: &[f64]| c.iter().copied().fold(f64::MIN, f64::max);
            let min = |c: &[f64]| c.iter().copied().fold(f64::MAX, f64::min);
            assert_eq!((max(a), min(a)), (max(b), min(b)));
        }
    }

    #[test]
    fn broken_series_are_named() {
        let e = TimeSeries::new(vec![0.0, 1.0], vec![0.0], vec![0.0; 2], vec![0.0; 2]);
        assert!(e.unwrap_err().contains("contact_force_n"));
        let e = TimeSeries::new(vec![0.0, -1.0], vec![0.0; 2], vec![0.0; 2], vec![0.0; 2]);
        assert!(e.unwrap_err().contains("falls"));
    }

    #[test]
    fn a_blow_up_ends_at_its_last_finite_sample() {
        let mut s = TimeSeries::default();
        s.push(0.0, 1.0, 1.0, 1.0);
        s.push(1.0, 2.0, f64::NAN, 1.0);
        s.push(2.0, 2.0, 1.0, 1.0);
        assert_eq!(s.finite_prefix().len(), 1);
    }

    #[test]
    fn interpolation_is_linear_and_zero_outside() {
        let mut out = Vec::new();
        let at = [-0.5, 0.0, 0.25, 1.0, 1.5];
        resample(&[0.0, 1.0], &[2.0, 4.0], &at, 0.0, &mut out);
        assert_eq!(out, [0.0, 2.0, 2.5, 4.0, 0.0]);
        resample(&[0.0, 1.0], &[2.0, 4.0], &[0.75], 0.5, &mut out);
        assert_eq!(out, [2.5]);
    }

    #[test]
    fn a_window_keeps_every_sample() {
        let mut long = TimeSeries::default();
        for i in 0..5000 {
            let t = f64::from(i) * 1e-4;
            long.push(t, (300.0 * t).sin(), t, -t);
        }
        let thin = long.decimated_around(20, [0.1, 0.12]);
        let count = |s: &TimeSeries| {
            s.time_s
                .iter()
                .filter(|t| (0.1..=0.12).contains(*t))
                .count()
        };
        assert_eq!(count(&thin), count(&long));
        assert!(thin.len() < 500, "{}", thin.len());
        assert!(thin.validate().is_ok());
    }
}
