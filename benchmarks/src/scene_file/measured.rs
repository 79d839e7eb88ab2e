//! Loads and motions from a column of a CSV file, as an instrument recorded them.
//!
//! ```toml
//! loads = [{ csv = { file = "drive.csv", column = "torque [N m]", offset_s = 0.3, zero_over_s = [0.0, 0.27] } }]
//! mount = { driven = { csv = { file = "drive.csv", column = "encoder [deg]", resample_s = 2e-3 } } }
//! ```
//!
//! The table is read as a reference is (`gearbench_reference::data`): units of the header or of the keys, then offset,
//! zero, moving average, even times. Values are linear between samples. A motion is a speed, or the position that an
//! encoder counts, whose unit tells it: then the speed is the difference quotient of neighbouring samples at the middle
//! between them,
//!
//! ```text
//! v((t_i + t_(i+1)) / 2) = (x_(i+1) - x_i) / (t_(i+1) - t_i)
//! ```
//!
//! which turns the digits of a position into noise of a speed: a moving average or a longer step of even times smooths
//! it.

use super::error::SceneError;
use super::reading::Place;
use super::reading::keys::keys;
use super::reading::values::{Positive, is_default};
use super::references::{DecimalWord, DelimiterWord, located};
use super::tables;
use gearbench_models::spec::Profile;
use gearbench_reference::data::{self, GearSubject, Processing, Quantity, Request, Subjects};
use std::cell::RefCell;
use std::path::{Path, PathBuf};

/// Largest size of a table [bytes].
const LARGEST: u64 = 1 << 30;

keys! {
    /// A column of a CSV file over time.
    #[derive(Default)]
    struct MeasuredTable {
        /// CSV file with a line of names, its path from the folder of the scene
        file: String,
        /// name of the column of values
        column: String,
        /// unit of the values, where the name has none or another, for example "N m"
        unit: Option<String>,
        /// name of the column of time, default the one that is known by its name
        time: Option<String>,
        /// unit of time, where its name has none or another
        time_unit: Option<String>,
        /// "comma", "semicolon" or "tab" between columns, default what the line of names has
        delimiter: Option<DelimiterWord>,
        /// "point" or "comma" in numbers, default what they have
        decimal: Option<DecimalWord>,
        /// factor on all values, for example -1.0 for an instrument that counts the other way, default 1
        #[serde(default = "one", skip_serializing_if = "is_one")]
        factor: f64,
        /// factor on all times, before the offset, for a recorder whose clock runs fast or slow, default 1
        time_factor: Option<Positive>,
        /// added to all times in seconds, default 0; the scene begins at 0
        #[serde(default, skip_serializing_if = "is_default")]
        offset_s: f64,
        /// first and last time in seconds, after the offset, of a part whose mean is subtracted from all values
        zero_over_s: Option<[f64; 2]>,
        /// width of a centred moving average in seconds, default none
        moving_average_s: Option<Positive>,
        /// step of even times in seconds, default the times of the file
        resample_s: Option<Positive>,
    }
}

fn one() -> f64 {
    1.0
}

#[expect(
    clippy::trivially_copy_pass_by_ref,
    reason = "serde passes fields by reference"
)]
fn is_one(x: &f64) -> bool {
    *x == 1.0
}

/// The folder of a scene file, and the data files that its gears, shafts and loads are read from.
#[derive(Debug)]
pub(super) struct DataFiles<'a> {
    folder: Option<&'a Path>,
    read: RefCell<Vec<PathBuf>>,
}

impl<'a> DataFiles<'a> {
    pub(super) fn beside(folder: Option<&'a Path>) -> Self {
        DataFiles {
            folder,
            read: RefCell::default(),
        }
    }

    /// Returns the path of a file, and notes that the scene needs it.
    pub(super) fn path(&self, file: &str) -> PathBuf {
        let path = located(file, self.folder);
        let mut read = self.read.borrow_mut();
        if !read.contains(&path) {
            read.push(path.clone());
        }
        path
    }

    /// Returns all files, in the order of the scene.
    pub(super) fn into_paths(self) -> Vec<PathBuf> {
        self.read.into_inner()
    }
}

/// The load or motion that a column prescribes. Its unit selects the first of its quantities that it fits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Action {
    /// A torque on a gear or a body.
    Torque,
    /// A force on a rack.
    Force,
    /// A rotation, by its speed or its angle.
    Rotation,
    /// A translation, by its speed or its displacement.
    Translation,
}

impl Action {
    fn quantities(self) -> &'static [Quantity] {
        match self {
            Action::Torque | Action::Force => &[Quantity::Torque(0)],
            Action::Rotation | Action::Translation => &[Quantity::Speed(0), Quantity::Angle(0)],
        }
    }

    fn words(self) -> &'static str {
        match self {
            Action::Torque => "a torque, for example N m",
            Action::Force => "a force, for example N",
            Action::Rotation => "a speed or an angle, for example rad/s, 1/min, rad, deg",
            Action::Translation => "a speed or a displacement, for example m/s, m, mm",
        }
    }
}

impl MeasuredTable {
    /// Reads the column as a function of time.
    ///
    /// # Errors
    /// [`SceneError`] at the key, or at the line of the file.
    pub(super) fn profile(
        &self,
        action: Action,
        files: &DataFiles<'_>,
        at: &Place<'_>,
    ) -> Result<Profile, SceneError> {
        let file = at.key("file");
        let path = files.path(&self.file);
        let text = tables::text(
            &path,
            LARGEST,
            "paths are relative to the folder of the scene file",
        )
        .map_err(|e| file.error(e.why, "this file", e.help))?;
        let quantity = match &self.unit {
            None => None,
            Some(unit) => {
                let fits = |q: &&Quantity| {
                    let dimension = self.subjects(action).dimension(**q);
                    data::factor(unit, dimension).is_some()
                };
                let found = action.quantities().iter().find(fits);
                if found.is_none() {
                    return at.key("unit").refuse(
                        format!("\"{unit}\" is not the unit of {}", action.words()),
                        "this unit",
                        "give the unit of the column",
                    );
                }
                found.copied()
            }
        };
        let tried: Vec<Quantity> = match quantity {
            Some(quantity) => vec![quantity],
            None => action.quantities().to_vec(),
        };
        let mut first_error = None;
        for quantity in tried {
            match data::read(
                &text.decoded,
                &self.request(quantity),
                &self.subjects(action),
            ) {
                Ok(found) => {
                    let Some(channel) = found.channel(quantity) else {
                        continue;
                    };
                    let values = channel.value.iter().map(|x| self.factor * x).collect();
                    return Ok(match quantity {
                        Quantity::Angle(_) => speed_of(&channel.time, values),
                        _ => Profile::table(channel.time.clone(), values),
                    });
                }
                Err(error) => first_error = first_error.or(Some(error)),
            }
        }
        match first_error {
            Some(error) => {
                let what = format!("the column \"{}\" of {}", self.column, action.words());
                Err(text.error(&error, &what))
            }
            None => at.key("column").refuse(
                format!("the column \"{}\" has no values", self.column),
                "this column",
                "name a column with at least three samples",
            ),
        }
    }

    fn subjects(&self, action: Action) -> Subjects {
        let slides = matches!(action, Action::Force | Action::Translation);
        Subjects {
            gears: vec![GearSubject {
                name: self.column.clone(),
                slides: slides.then_some(1.0),
                toothed: true,
            }],
            ..Subjects::default()
        }
    }

    fn request(&self, quantity: Quantity) -> Request {
        let unit = self.unit.iter().map(|unit| (quantity, unit.clone()));
        Request {
            time: self.time.clone(),
            columns: vec![(quantity, self.column.clone())],
            time_unit: self.time_unit.clone(),
            units: unit.collect(),
            delimiter: self.delimiter.map(DelimiterWord::delimiter),
            decimal_comma: self.decimal.map(|d| d == DecimalWord::Comma),
            processing: Processing {
                time_factor: self.time_factor.map(f64::from),
                offset: self.offset_s,
                zero: self.zero_over_s,
                moving_average: self.moving_average_s.map(f64::from),
                from: f64::NEG_INFINITY,
                to: None,
                resample: self.resample_s.map(f64::from),
            },
            ..Request::default()
        }
    }
}

/// Returns the speed of a position, see the head of the module.
fn speed_of(time: &[f64], position: Vec<f64>) -> Profile {
    let middle = time.windows(2).map(|t| 0.5 * (t[0] + t[1]));
    let steps = time.windows(2).zip(position.windows(2));
    let speed = steps.map(|(t, x)| (x[1] - x[0]) / (t[1] - t[0]));
    Profile::table(middle.collect(), speed.collect())
}
