//! Plan of a scan: scene, design, configurations, outputs.

use super::axis::{Axis, AxisValues, text};
use super::design::Design;
use super::output::Output;
use crate::experiment::conditions::Conditions;
use crate::experiment::configuration::Configuration;
use crate::scene_file::changes::set_at;
use crate::scene_file::{SceneError, SceneFile};
use gearbench_integrators::{Resolution, Scheme};
use gearbench_reports::record::{Part, Results};
use gearbench_reports::scan::{
    SampleDesign, ScanAxis, ScanConfiguration, ScanIdentity, ScanRecord, Shard,
};
use std::time::Duration;
use toml_edit::DocumentMut;

/// Plan of a scan.
pub struct Plan<'a> {
    /// Conditions of the scene as its file states it; cells may change them.
    pub conditions: Conditions,
    /// The scene whose keys are varied.
    pub scene: &'a SceneFile,
    /// Its text as a document.
    pub document: DocumentMut,
    /// Values of the axes in each cell.
    pub design: Design,
    /// Label and method of each run in a cell; with a yardstick, that of the yardstick comes first.
    pub runs: Vec<(String, Scheme)>,
    /// True if the first run is the yardstick of the others.
    pub has_yardstick: bool,
    /// Quantities that are recorded.
    pub outputs: Vec<Output>,
    /// Program, scene and options that the cells are computed from.
    pub identity: ScanIdentity,
    /// The part of the cells that is computed; `None` for all.
    pub shard: Option<Shard>,
    /// Bound on the processor time of one run.
    pub timeout: Duration,
}

impl Plan<'_> {
    /// The cells that are computed, from 0.
    pub fn cells(&self) -> std::ops::Range<u64> {
        self.shard
            .map_or(0..self.design.cells(), |s| s.first - 1..s.last)
    }

    /// The scene of a cell.
    ///
    /// # Errors
    /// [`SceneError`] where a value is wrong, with its line in the changed text.
    pub fn scene_of(&self, cell: u64) -> Result<SceneFile, SceneError> {
        let mut document = self.document.clone();
        for (key, value) in self.design.values(cell) {
            set_at(&mut document, key, &value).map_err(|e| {
                SceneError::plain(e, "`gearbench help scene` lists the keys of a scene")
            })?;
        }
        self.scene.with_text(&document.to_string())
    }

    /// The keys of the outputs.
    pub fn output_keys(&self) -> Vec<String> {
        self.outputs.iter().map(Output::key).collect()
    }

    /// The models and integrators of each cell.
    pub fn configurations(&self) -> Vec<ScanConfiguration> {
        let of = |(label, method): &(String, Scheme)| ScanConfiguration {
            label: label.clone(),
            integrator: method.to_string(),
        };
        self.runs.iter().map(of).collect()
    }

    /// The record of the scan without results.
    pub fn record(&self) -> Results {
        self.conditions.record(Part::Scan(Box::new(ScanRecord {
            identity: self.identity.clone(),
            axes: self.design.axes().iter().map(axis_record).collect(),
            samples: self.design.is_sampled().then(|| self.design.record()),
            cells: self.design.cells(),
            shard: self.shard,
            outputs: self.output_keys(),
            configurations: self.configurations(),
            ..ScanRecord::default()
        })))
    }
}

impl Design {
    /// The samples as the record describes them.
    pub fn record(&self) -> SampleDesign {
        SampleDesign {
            sampling: self.sampling(),
            samples: self.samples() as u64,
            seed: self.seed(),
            variants: self.variants() as u64,
        }
    }
}

fn axis_record(axis: &Axis) -> ScanAxis {
    ScanAxis {
        keys: axis.keys.iter().map(ToString::to_string).collect(),
        values: match &axis.values {
            AxisValues::Listed(all) => all.iter().map(|entry| text(&entry[0])).collect(),
            _ => Vec::new(),
        },
        distribution: match &axis.values {
            AxisValues::Listed(_) => None,
            random => Some(random.to_string()),
        },
    }
}

/// The default integrator of a model: of those that the scene names for it, the first that controls its own error, else
/// the first; scenes of a scan differ, and a fixed step that suits one may be too long for another.
pub fn default_method(scene: &SceneFile, entry: &Configuration) -> Option<Scheme> {
    let known = entry.methods.as_ref().unwrap_or(&scene.study.integrators);
    let controlled = |s: &&Scheme| matches!(s.resolution, Resolution::Tolerance(_));
    known.iter().find(controlled).or(known.first()).copied()
}

/// Part `number` of `of` parts of some cells: contiguous, their sizes equal but for one cell.
pub fn part_of(cells: u64, [number, of]: [u64; 2]) -> Shard {
    let begin = |part: u64| (u128::from(cells) * u128::from(part) / u128::from(of)) as u64;
    Shard {
        number,
        of,
        first: begin(number - 1) + 1,
        last: begin(number),
    }
}

#[cfg(test)]
mod tests {
    use super::part_of;

    #[test]
    fn parts_hold_all_cells_once() {
        for (cells, of) in [(10, 3), (3, 10), (1_000_000_007, 50), (0, 2)] {
            let parts: Vec<_> = (1..=of).map(|i| part_of(cells, [i, of])).collect();
            assert_eq!((parts[0].first, parts[parts.len() - 1].last), (1, cells));
            for p in parts.windows(2) {
                assert_eq!(p[0].last + 1, p[1].first);
            }
        }
    }
}
