//! Histories of a run at full resolution and on an even grid, as CSV files.
//!
//! `results.json` keeps the thinned histories of charts. The study that made the run writes these tables to CSV files
//! once; `docs/data.md` describes them: `runNN-NAME.csv` (a row per time of the grid, strictly ascending), `-pairs.csv`
//! (a row per tooth pair in contact at such a time), `-events.csv` (a row per contact that closes or opens, with the
//! force on both sides of the instant).

use crate::csv_table::{CsvTable, number};
use crate::series::{Column, TimeSeries};
use serde::{Deserialize, Serialize};

/// Endings of a run's CSV files after the stem of its name: histories on the grid, tooth pairs, contact events.
pub(crate) const ENDINGS: [&str; 3] = [".csv", "-pairs.csv", "-events.csv"];

/// Force of a tooth pair at a time of the grid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct PairSample {
    /// Time of the sample on the grid \[s\].
    pub time_s: f64,
    /// Mesh, counted from 1 in the order of the scene.
    pub mesh: usize,
    /// Teeth of its two gears, counted from 1.
    pub teeth: [i64; 2],
    /// Magnitude of the vector sum of the pair's contact forces \[N\].
    pub force_n: f64,
    /// Teeth of the pair that move on springs of their own.
    #[serde(default, skip_serializing_if = "no_tooth_moves")]
    pub sprung: [Option<SprungTooth>; 2],
}

/// A tooth that moves against its body on a spring and a damper.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct SprungTooth {
    /// Radial part of the contact force on the tooth, positive away from the axis \[N\].
    pub radial_n: f64,
    /// Tangential part, positive counter-clockwise, of a rack along its slide \[N\].
    pub tangential_n: f64,
    /// Force of spring and damper on the tooth, positive as the tangential part \[N\].
    pub spring_n: f64,
    /// Displacement of the tooth relative to its body \[rad\], of a rack \[m\].
    pub deflection: f64,
}

fn no_tooth_moves(sprung: &[Option<SprungTooth>; 2]) -> bool {
    sprung.iter().all(Option::is_none)
}

/// A contact that closes or opens.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ContactEvent {
    /// Time of the event \[s\].
    pub time_s: f64,
    /// True if the contact closes, false if it opens.
    pub closes: bool,
    /// Mesh, counted from 1 in the order of the scene.
    pub mesh: usize,
    /// Teeth of its two gears, counted from 1.
    pub teeth: [i64; 2],
    /// Contact force of the whole mesh just before and just after the event \[N\].
    pub force_n: [f64; 2],
    /// True if the time is that of a located event and the forces are its two sides; else the forces are those at
    /// neighbouring times of the grid.
    pub located: bool,
}

/// Histories of a run at full resolution: the content of its CSV files.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Histories {
    /// The series at full resolution, if the record's own has been thinned.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub series: Option<TimeSeries>,
    /// Rows of that series at times of the grid, ascending.
    pub on_grid: Vec<usize>,
    /// Further columns, on the grid alone.
    pub further: Vec<Column>,
    /// Forces of tooth pairs in contact, at times of the grid.
    pub pairs: Vec<PairSample>,
    /// Contacts that close and open.
    pub events: Vec<ContactEvent>,
}

impl Histories {
    /// Returns the table of one of the [`ENDINGS`]; `kept` is the series in the record.
    pub(crate) fn table(&self, ending: usize, kept: Option<&TimeSeries>) -> CsvTable {
        match ending {
            0 => self.even(kept),
            1 => pairs(&self.pairs),
            _ => events(&self.events),
        }
    }

    fn even(&self, kept: Option<&TimeSeries>) -> CsvTable {
        let empty = TimeSeries::default();
        let series = self.series.as_ref().or(kept).unwrap_or(&empty);
        let rows: Vec<usize> = (self.on_grid.iter().copied())
            .take_while(|&row| row < series.len())
            .collect();
        let of_series = std::iter::once(("time_s", series.time_s.as_slice()))
            .chain(series.named_columns())
            .collect::<Vec<_>>();
        let names = of_series.iter().map(|(name, _)| (*name).to_owned());
        let row = |(k, &i): (usize, &usize)| {
            let known = of_series.iter().map(|(_, c)| c.get(i).copied());
            let further = self.further.iter().map(|c| c.values.get(k).copied());
            known.chain(further).map(number).collect()
        };
        CsvTable {
            file: String::new(),
            header: names
                .chain(self.further.iter().map(|c| c.name.clone()))
                .collect(),
            rows: rows.iter().enumerate().map(row).collect(),
        }
    }
}

/// Formats one cell of the table of tooth pairs.
type CellFormat<'c> = &'c dyn Fn(&&PairSample) -> String;

fn pairs(samples: &[PairSample]) -> CsvTable {
    let of = |k: usize, value: fn(&SprungTooth) -> f64| {
        move |s: &&PairSample| number(s.sprung[k].as_ref().map(value))
    };
    let radial = [0, 1].map(|k| of(k, |t| t.radial_n));
    let tangential = [0, 1].map(|k| of(k, |t| t.tangential_n));
    let spring = [0, 1].map(|k| of(k, |t| t.spring_n));
    let deflection = [0, 1].map(|k| of(k, |t| t.deflection));
    let mut columns: Vec<(&str, CellFormat<'_>)> = vec![
        ("time_s", &|s| number(s.time_s)),
        ("mesh", &|s| s.mesh.to_string()),
        ("tooth_1", &|s| s.teeth[0].to_string()),
        ("tooth_2", &|s| s.teeth[1].to_string()),
        ("pair_force_n", &|s| number(s.force_n)),
    ];
    // Only models whose teeth move have more.
    if samples.iter().any(|s| !no_tooth_moves(&s.sprung)) {
        columns.extend([
            ("tooth_radial_force_1_n", &radial[0] as CellFormat<'_>),
            ("tooth_radial_force_2_n", &radial[1]),
            ("tooth_tangential_force_1_n", &tangential[0]),
            ("tooth_tangential_force_2_n", &tangential[1]),
            ("tooth_spring_force_1_n", &spring[0]),
            ("tooth_spring_force_2_n", &spring[1]),
            ("tooth_deflection_1_rad", &deflection[0]),
            ("tooth_deflection_2_rad", &deflection[1]),
        ]);
    }
    CsvTable::new("", samples, &columns)
}

fn events(events: &[ContactEvent]) -> CsvTable {
    let event = |closes| if closes { "closes" } else { "opens" };
    CsvTable::new(
        "",
        events,
        &[
            ("time_s", &|e| format!("{:.16e}", e.time_s)),
            ("event", &|e| event(e.closes).to_owned()),
            ("mesh", &|e| e.mesh.to_string()),
            ("tooth_1", &|e| e.teeth[0].to_string()),
            ("tooth_2", &|e| e.teeth[1].to_string()),
            ("force_before_n", &|e| number(e.force_n[0])),
            ("force_after_n", &|e| number(e.force_n[1])),
            ("located", &|e| e.located.to_string()),
        ],
    )
}
