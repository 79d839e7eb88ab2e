//! Time series of a run or of a reference, in SI units.
//!
//! Owns the names of columns ([`Quantity`]), [`TimeSeries`] with its invariants (all columns as long as the time axis, time
//! not decreasing), linear interpolation, and thinning that keeps the extrema.

use crate::force::ForceHistory;
use serde::{Deserialize, Serialize};

/// A quantity of gears or of meshes. The name of a column with it consists of its name, the name of the gear or of both
/// gears of the mesh, and its unit: `speed_pinion_rad_s`, `contact_force_pinion_wheel_n`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Quantity {
    name: &'static str,
    /// Unit at the end of the name; empty for ratios.
    unit: &'static str,
}

/// Contact force of a mesh \[N\], the magnitude in space of the vector sum over the tooth pairs: on helical gears the
/// force normal to the flanks, not its transverse part.
pub const CONTACT_FORCE: Quantity = Quantity::new("contact_force", "n");
/// Transmission error of a mesh \[m\], `r_b1 theta_1 + r_b2 theta_2` in the transverse plane, zero at first touch of the
/// flanks of rigid gears.
pub const TRANSMISSION_ERROR: Quantity = Quantity::new("transmission_error", "m");
/// Cycles of a mesh since the start [-].
pub const MESH_CYCLE: Quantity = Quantity::new("mesh_cycle", "");
/// Position of the tooth of a mesh in its backlash [-].
pub const BACKLASH_POSITION: Quantity = Quantity::new("backlash_position", "");
/// Error of the speed ratio of a mesh [-].
pub const SPEED_RATIO_ERROR: Quantity = Quantity::new("speed_ratio_error", "");
/// Transverse part of the contact force of a mesh \[N\].
const TRANSVERSE_FORCE: Quantity = Quantity::new("transverse_force", "n");
/// Greatest pressure of a mesh \[Pa\].
pub const PRESSURE: Quantity = Quantity::new("contact_pressure", "pa");
/// Half-width of the contact with that pressure \[m\].
pub const HALF_WIDTH: Quantity = Quantity::new("contact_half_width", "m");
/// Angular velocity of a gear [rad/s], momentum mean (angular momentum over inertia), so that rigid and elastic bodies
/// compare; for a rack the speed over the pitch radius of its mate.
pub const SPEED: Quantity = Quantity::new("speed", "rad_s");
/// Deflection of a movable tooth of a gear \[rad\], of a rack \[m\].
pub const TOOTH_DEFLECTION: Quantity = Quantity::new("tooth_deflection", "rad");
/// Radial part of the contact force on a movable tooth of a gear \[N\].
pub const TOOTH_RADIAL_FORCE: Quantity = Quantity::new("tooth_radial_force", "n");
/// Tangential part of the contact force on a movable tooth of a gear \[N\].
pub const TOOTH_TANGENTIAL_FORCE: Quantity = Quantity::new("tooth_tangential_force", "n");
/// Force of the spring and damper of a movable tooth of a gear \[N\].
pub const TOOTH_SPRING_FORCE: Quantity = Quantity::new("tooth_spring_force", "n");

/// All quantities of meshes.
pub(crate) const OF_MESHES: [Quantity; 11] = [
    CONTACT_FORCE,
    TRANSVERSE_FORCE,
    TRANSMISSION_ERROR,
    MESH_CYCLE,
    BACKLASH_POSITION,
    SPEED_RATIO_ERROR,
    PRESSURE,
    HALF_WIDTH,
    Quantity::new("force_x", "n"),
    Quantity::new("force_y", "n"),
    Quantity::new("force_z", "n"),
];
/// Names of the columns with the speeds of the first two gears where gears have no names.
pub(crate) const NUMBERED_SPEEDS: [&str; 2] = ["omega1_rad_s", "omega2_rad_s"];

/// Quantities whose extrema a thinned series keeps.
const DRAWN: [Quantity; 2] = [CONTACT_FORCE, SPEED];

impl Quantity {
    const fn new(name: &'static str, unit: &'static str) -> Self {
        Self { name, unit }
    }

    /// Returns the quantity in another unit: \[m\] or \[N\] of a rack.
    #[must_use]
    pub const fn in_unit(self, unit: &'static str) -> Self {
        Self { unit, ..self }
    }

    /// Returns the name of the column of a gear by its name, or of a mesh by the names of both gears with `_` between them.
    pub fn of(self, subject: &str) -> String {
        match self.unit {
            "" => format!("{}_{subject}", self.name),
            unit => format!("{}_{subject}_{unit}", self.name),
        }
    }

    /// Returns the name of the column of a mesh by the names of its gears.
    pub fn of_mesh<S: AsRef<str>>(self, [a, b]: &[S; 2]) -> String {
        self.of(&format!("{}_{}", a.as_ref(), b.as_ref()))
    }

    /// Returns the name of a column without the names of gears: that of the first mesh where gears have no names.
    pub(crate) fn without_gears(self) -> String {
        match self.unit {
            "" => self.name.to_owned(),
            unit => format!("{}_{unit}", self.name),
        }
    }

    /// Returns the name of the gear, or of both gears with `_` between them, in the name of a column of this quantity.
    pub fn subject(self, column: &str) -> Option<&str> {
        let named = column.strip_prefix(self.name)?.strip_prefix('_')?;
        match self.unit {
            "" => Some(named),
            unit => named.strip_suffix(unit)?.strip_suffix('_'),
        }
    }
}

/// Returns the place of a column among those of a table. A name without gears is that of the first mesh, or of one of
/// the first two gears.
pub(crate) fn place_of(columns: &[String], name: &str) -> Option<usize> {
    let of = |quantity: Quantity, n: usize| {
        let all = columns.iter().enumerate();
        let mut of_quantity = all.filter(|(_, c)| quantity.subject(c).is_some());
        of_quantity.nth(n).map(|(i, _)| i)
    };
    let of_mesh = || {
        let mut all = OF_MESHES.into_iter();
        of(all.find(|q| q.without_gears() == name)?, 0)
    };
    let of_gear = || of(SPEED, NUMBERED_SPEEDS.iter().position(|n| *n == name)?);
    let exact = columns.iter().position(|c| c == name);
    exact.or_else(of_mesh).or_else(of_gear)
}

/// Sampled histories over a common time axis.
///
/// Every column is as long as `time_s`; the time does not decrease (two samples at one time mark a jump). Contact
/// forces and speeds are in the order of the meshes and gears of the scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct TimeSeries {
    /// Times of the samples \[s\], not decreasing; two equal times are the two sides of a jump.
    pub time_s: Vec<f64>,
    /// Histories; a reference has those that are known of it.
    pub columns: Vec<Column>,
    /// The contact force of each mesh between the events of the run, in the order of the meshes, for metrics: known while a
    /// study runs and in its journal, not kept in records. References from elsewhere have none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub forces: Vec<ForceHistory>,
}

/// One named column of a [`TimeSeries`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Column {
    /// Name of the quantity, of its gear or of both gears of its mesh, and of its unit, for example
    /// `contact_force_pinion_wheel_n`.
    pub name: String,
    /// Values, one per time sample.
    pub values: Vec<f64>,
}

impl Column {
    /// Makes a column of a name and values.
    pub fn new(name: impl Into<String>, values: Vec<f64>) -> Self {
        Self {
            name: name.into(),
            values,
        }
    }
}

impl TimeSeries {
    /// Makes a series of named columns.
    ///
    /// # Errors
    /// A sentence that names the broken invariant.
    pub fn new(time_s: Vec<f64>, columns: Vec<Column>) -> Result<Self, String> {
        let series = Self {
            time_s,
            columns,
            forces: Vec::new(),
        };
        series.validate()?;
        Ok(series)
    }

    /// Makes a series without samples that has the columns of some names.
    pub fn named<S: Into<String>>(names: impl IntoIterator<Item = S>) -> Self {
        let column = |name: S| Column::new(name, Vec::new());
        Self {
            columns: names.into_iter().map(column).collect(),
            ..Self::default()
        }
    }

    /// Appends one sample \[s\] with a value for each column.
    pub fn push(&mut self, t: f64, values: &[f64]) {
        self.time_s.push(t);
        for (column, x) in self.columns.iter_mut().zip(values) {
            column.values.push(*x);
        }
    }

    /// Returns the values of a column by its name; `None` where a reference does not have it.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        let found = self.columns.iter().find(|c| c.name == name)?;
        Some(&found.values)
    }

    /// Returns the history of a quantity of a gear by its name, or of a mesh by the names of both gears with `_` between
    /// them.
    pub fn of(&self, quantity: Quantity, subject: &str) -> Option<&[f64]> {
        self.column(&quantity.of(subject))
    }

    /// Returns the history of a quantity of a mesh by the names of its gears.
    pub fn of_mesh<S: AsRef<str>>(&self, quantity: Quantity, gears: &[S; 2]) -> Option<&[f64]> {
        self.column(&quantity.of_mesh(gears))
    }

    /// Returns all columns of a quantity with the names of their gears.
    pub fn all_of(&self, quantity: Quantity) -> impl Iterator<Item = (&str, &[f64])> {
        let columns = self.columns.iter();
        columns.filter_map(move |c| Some((quantity.subject(&c.name)?, c.values.as_slice())))
    }

    /// Returns the contact force of the mesh with the greatest one, with the names of its gears, `_` between them; `None`
    /// of a reference without contact forces.
    pub fn most_loaded_mesh(&self) -> Option<(&str, &[f64])> {
        let peak = |force: &[f64]| force.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        (self.all_of(CONTACT_FORCE)).reduce(|a, b| if peak(b.1) > peak(a.1) { b } else { a })
    }

    /// Returns the contact force of the mesh with the greatest one; empty of a reference without contact forces.
    pub fn contact_force(&self) -> &[f64] {
        self.most_loaded_mesh().map_or(&[], |(_, force)| force)
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
        for Column { name, values } in &self.columns {
            if values.len() != n {
                return Err(format!(
                    "column {name} has {} samples, the time axis has {n}",
                    values.len()
                ));
            }
        }
        match self.time_s.windows(2).find(|w| w[1] < w[0]) {
            Some(w) => Err(format!("time falls from {} s to {} s", w[0], w[1])),
            None => self.forces.iter().try_for_each(ForceHistory::validate),
        }
    }

    /// Returns the time axis and the values of all columns.
    fn all_values(&self) -> impl Iterator<Item = &[f64]> {
        let columns = self.columns.iter().map(|c| c.values.as_slice());
        std::iter::once(self.time_s.as_slice()).chain(columns)
    }

    /// Returns the time axis and the values of all columns, to be changed.
    pub(crate) fn all_values_mut(&mut self) -> impl Iterator<Item = &mut Vec<f64>> {
        let columns = self.columns.iter_mut().map(|c| &mut c.values);
        std::iter::once(&mut self.time_s).chain(columns)
    }

    /// Returns the samples before the first that is not finite in any column, which are the usable part of a run that
    /// blew up.
    #[must_use]
    pub fn finite_prefix(&self) -> Self {
        self.select(&(0..self.finite_len()).collect::<Vec<_>>())
    }

    /// Returns the number of samples before the first that is not finite in any column.
    pub(crate) fn finite_len(&self) -> usize {
        self.all_values()
            .map(|c| c.iter().position(|x| !x.is_finite()).unwrap_or(c.len()))
            .min()
            .unwrap_or(0)
    }

    /// True if the column has the contact force of a mesh or the speed of a gear, whose extrema a thinned series keeps.
    pub fn is_drawn(column: &Column) -> bool {
        DRAWN.iter().any(|q| q.subject(&column.name).is_some())
    }

    /// Returns a series of at most about `6 * buckets` samples that keeps the extrema of the contact forces and speeds in
    /// every bucket of time; the buckets are wider the more of these there are.
    #[must_use]
    pub fn decimated(&self, buckets: usize) -> Self {
        if buckets == 0 || self.len() <= 6 * buckets || self.validate().is_err() {
            return Self {
                forces: Vec::new(),
                ..self.clone()
            };
        }
        let drawn: Vec<&Column> = self.columns.iter().filter(|c| Self::is_drawn(c)).collect();
        let buckets = (3 * buckets / drawn.len().max(1)).max(1);
        let mut keep = vec![0, self.len() - 1];
        for column in drawn {
            keep.extend(extrema_per_bucket(&self.time_s, &column.values, buckets));
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
    fn append(&mut self, mut other: Self) {
        for (all, more) in self.all_values_mut().zip(other.all_values_mut()) {
            all.append(more);
        }
    }

    fn select(&self, rows: &[usize]) -> Self {
        let pick = |c: &[f64]| -> Vec<f64> { rows.iter().map(|&i| c[i]).collect() };
        let column = |c: &Column| Column::new(c.name.clone(), pick(&c.values));
        Self {
            time_s: pick(&self.time_s),
            columns: self.columns.iter().map(column).collect(),
            forces: Vec::new(),
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

    /// Makes a series of the contact force and the speeds of a pair.
    fn pair() -> TimeSeries {
        TimeSeries::named(["contact_force_a_b_n", "speed_a_rad_s", "speed_b_rad_s"])
    }

    /// A name leads back to its gears, and no quantity is mistaken for another whose name begins with its own.
    #[test]
    fn names_of_columns() {
        let gears = ["sun", "planet_1"];
        for (quantity, name) in [
            (CONTACT_FORCE, "contact_force_sun_planet_1_n"),
            (MESH_CYCLE, "mesh_cycle_sun_planet_1"),
        ] {
            assert_eq!(quantity.of_mesh(&gears), name);
            assert_eq!(quantity.subject(name), Some("sun_planet_1"));
        }
        assert_eq!(SPEED.of("sun"), "speed_sun_rad_s");
        for other in [
            "speed_rack_m_s",
            "speed_ratio_error_a_b",
            "hub_speed_sun_rad_s",
        ] {
            assert_eq!(SPEED.subject(other), None, "{other}");
        }
        for (i, quantity) in OF_MESHES.iter().enumerate() {
            let name = quantity.of_mesh(&gears);
            let found = OF_MESHES.iter().position(|q| q.subject(&name).is_some());
            assert_eq!(found, Some(i), "{name}");
        }
        let rack = TOOTH_DEFLECTION.in_unit("m");
        assert_eq!(rack.of("rack"), "tooth_deflection_rack_m");
    }

    /// A table of users may have names without gears; a name that a table has is taken first.
    #[test]
    fn names_without_gears_are_of_the_first() {
        let columns = "time_s,speed_a_rad_s,speed_b_rad_s,mesh_cycle_a_b,mesh_cycle_b_c,force_x_n";
        let columns: Vec<String> = columns.split(',').map(str::to_owned).collect();
        let place = |name: &str| place_of(&columns, name);
        assert_eq!(
            [place("mesh_cycle"), place("mesh_cycle_b_c")],
            [Some(3), Some(4)]
        );
        assert_eq!(
            [place("omega2_rad_s"), place("force_x_n")],
            [Some(2), Some(5)]
        );
        assert_eq!([place("contact_force_n"), place("mesh_cycle_b")], [None; 2]);
    }

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
        let mut s = pair();
        for i in 0..20_000 {
            let x = f64::from(i);
            let values = [(x * 0.37).sin(), (x * 0.11).cos(), (x * 0.05).sin()];
            s.push(x * 1e-5, &values);
        }
        let thin = s.decimated(200);
        assert!(thin.len() <= 1202);
        thin.validate().unwrap();
        for (a, b) in s.all_values().zip(thin.all_values()) {
            let max = |c: &[f64]| c.iter().copied().fold(f64::MIN, f64::max);
            let min = |c: &[f64]| c.iter().copied().fold(f64::MAX, f64::min);
            assert_eq!((max(a), min(a)), (max(b), min(b)));
        }
    }

    #[test]
    fn broken_series_are_named() {
        let force = |values: Vec<f64>| vec![Column::new("contact_force_a_b_n", values)];
        let e = TimeSeries::new(vec![0.0, 1.0], force(vec![0.0]));
        assert!(e.unwrap_err().contains("contact_force_a_b_n"));
        let e = TimeSeries::new(vec![0.0, -1.0], force(vec![0.0; 2]));
        assert!(e.unwrap_err().contains("falls"));
    }

    #[test]
    fn a_blow_up_ends_at_its_last_finite_sample() {
        let mut s = pair();
        s.push(0.0, &[1.0; 3]);
        s.push(1.0, &[2.0, f64::NAN, 1.0]);
        s.push(2.0, &[2.0, 1.0, 1.0]);
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
        let mut long = pair();
        for i in 0..5000 {
            let t = f64::from(i) * 1e-4;
            long.push(t, &[(300.0 * t).sin(), t, -t]);
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
