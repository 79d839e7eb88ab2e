//! CSV tables of a scan: statistics and sensitivity indices. The rows of all cells are in `cells.csv`.

use super::{SampleStatistics, ScanRecord, SensitivityIndex};
use crate::csv_table::{CsvTable, number};

/// Returns the tables of statistics and indices.
pub fn tables(record: &ScanRecord) -> Vec<CsvTable> {
    let label = |c: usize| record.configurations[c].label.clone();
    let integrator = |c: usize| record.configurations[c].integrator.clone();
    let output = |o: usize| record.outputs[o].clone();
    let statistics = CsvTable::new(
        "scan_statistics.csv",
        &record.statistics,
        &[
            ("model", &|s: &&SampleStatistics| label(s.configuration)),
            ("integrator", &|s| integrator(s.configuration)),
            ("quantity", &|s| output(s.output)),
            ("at", &|s| record.at_text(&s.at)),
            ("count", &|s| s.count.to_string()),
            ("missing", &|s| s.missing.to_string()),
            ("mean", &|s| number(s.mean)),
            ("standard_deviation", &|s| number(s.deviation)),
            ("least", &|s| number(s.quantiles[0])),
            ("quantile_5", &|s| number(s.quantiles[1])),
            ("quantile_25", &|s| number(s.quantiles[2])),
            ("median", &|s| number(s.quantiles[3])),
            ("quantile_75", &|s| number(s.quantiles[4])),
            ("quantile_95", &|s| number(s.quantiles[5])),
            ("greatest", &|s| number(s.quantiles[6])),
        ],
    );
    let indices = CsvTable::new(
        "scan_indices.csv",
        &record.indices,
        &[
            ("model", &|s: &&SensitivityIndex| label(s.configuration)),
            ("integrator", &|s| integrator(s.configuration)),
            ("quantity", &|s| output(s.output)),
            ("at", &|s| record.at_text(&s.at)),
            ("axis", &|s| record.axes[s.axis].keys.join(" | ")),
            ("first_order", &|s| number(s.first[0])),
            ("first_order_low_95", &|s| number(s.first[1])),
            ("first_order_high_95", &|s| number(s.first[2])),
            ("total", &|s| number(s.total[0])),
            ("total_low_95", &|s| number(s.total[1])),
            ("total_high_95", &|s| number(s.total[2])),
        ],
    );
    [statistics, indices]
        .into_iter()
        .filter(|t| !t.rows.is_empty())
        .collect()
}
