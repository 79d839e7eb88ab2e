//! Result records, metrics, charts and the report of gearbench.
//!
//! A report is a pure function of saved data: `results.json` ([`record`]) has all the data of the comparison
//! ([`metrics`]), the charts and the page, so that these can be drawn again at any time. This crate does not depend on
//! models or integrators; its tables iterate over the records.

pub mod columns;
mod csv_table;
pub mod dictionary;
mod drawing;
pub mod escape;
pub mod force;
pub mod gallery;
mod glossary;
pub mod histories;
mod markup;
pub mod measured;
pub mod metrics;
pub mod numbers;
pub mod pareto;
pub mod record;
pub mod series;
pub mod store;
pub mod studies;
mod view;
mod words;

pub use csv_table::CsvTable;
pub use drawing::{Chart, DrawError};
pub use force::ForceHistory;
pub use histories::{ContactEvent, Histories, PairSample, SprungTooth};
pub use markup::column::Format;
pub use metrics::{FinishedRun, Metric, UnfinishedRun, compare};
pub use record::{
    BodyPath, ContactPoint, ContactSnapshot, DeformedSection, FlankGrid, FlankLoad, FlankPatch,
    FlankValue, FrameContacts, GearMotion, Ledger, Machine, Metrics, OUTLINE, Outline, Part,
    Quantised, ReferenceSeries, Results, Run, SCHEMA, Status, Study, StudyHeader, Tolerance,
    ToothDisplacements, ToothedBody, finite,
};
pub use series::{Column, TimeSeries, decimate};
pub use store::{RECORD, ReportError, load_results, report_from, write_results};
pub use studies::choose::{
    Adequacy, CandidateRecord, ChoiceRecord, ChooseRecord, ForceStatistics, LevelRecord,
    ReferenceDistance, Verdict,
};
pub use studies::{
    StudyReport, check, compare as comparison, finding, identify, measured_lines, modes, response,
    run_up, runs, scan, stability, stiffness, sweep, tabular,
};
pub use view::{NOTHING, capital, metric_against, yardstick_of};
