//! Result records, metrics, charts and the report of gearbench.
//!
//! A report is a pure function of saved data: `results.json` ([`record`]) holds everything that the
//! comparison ([`metrics`]), the charts and the page need, so it can be drawn again at any time.
//! This crate knows neither models nor integrators; its tables iterate the records.

pub mod charts;
mod checks;
mod choice;
pub mod choice_check;
mod html;
pub mod metrics;

pub mod numbers;
pub mod pareto;
mod picture;
pub mod precision;
mod precision_csv;
pub mod record;
pub mod series;
pub mod stability;
mod steady;
pub mod store;
mod study;
mod study_csv;
pub mod truncation;
mod view;

pub use charts::{Chart, charts};
pub use choice::{ChoiceRecord, RungRecord, TriedRecord};
pub use metrics::{CompareOptions, Metric, compare, compare_with};
pub use record::{
    ContactPoint, ContactSnapshot, Ledger, Machine, Metrics, Outline, ReferenceSeries, Results,
    Run, SCHEMA, Status, Study, Tolerance, finite,
};
pub use series::{Column, TimeSeries, decimate};
pub use store::{ReportError, load_results, report_from, write_results};
