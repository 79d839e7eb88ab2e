//! Finding and tables of a scan: failures, statistics over the samples, sensitivity indices.

use super::csv;
use super::{SampleStatistics, ScanRecord, SensitivityIndex, output_text};
use crate::markup::table::Table;
use crate::markup::{glance, note, section};
use crate::numbers::{count, counted, quantity, short, significant};
use maud::{Markup, html};

/// Largest number of outputs that the finding describes.
const MOST_DESCRIBED: usize = 2;
/// Largest number of configurations whose ranges the finding names.
const MOST_CONFIGURATIONS: usize = 4;
/// Share of the variance that an axis must cause to be named in the finding.
const NAMED_SHARE: f64 = 0.05;

/// Returns the sentences on the number of runs, failures, ranges and sensitivities.
pub fn finding(record: &ScanRecord) -> Vec<Markup> {
    let (runs, failed) = (record.runs(), record.failed());
    let cells = record.shard.map_or(record.cells, |s| s.last + 1 - s.first);
    let configurations = counted(
        record.configurations.len(),
        "configuration",
        "configurations",
    );
    let mut sentences = vec![html! {
        (count(cells)) @if cells == 1 { " scene" } @else { " scenes" } " ran with " (configurations) ": "
        b { (count(runs)) @if runs == 1 { " run" } @else { " runs" } }
        @if failed == 0 { ", none of which failed." } @else { ", of which " b { (count(failed)) " failed" } "." }
    }];
    if let Some(shard) = record.shard {
        sentences.push(html! {
            "This is part " (shard.number) " of " (shard.of) " of a scan of " (count(record.cells))
            " scenes; `gearbench merge` joins the parts and computes their statistics."
        });
    }
    if !record.unaffected.is_empty() {
        let labels: Vec<&str> = (record.unaffected.iter())
            .map(|c| record.configurations[*c].label.as_str())
            .collect();
        sentences.push(html! {
            "The results of " b { (labels.join(", ")) } " are the same in all scenes: no varied key has an effect, for example \
             since the mesh of a file or a calibration determines what the keys would change."
        });
    }
    sentences.extend(responses(record));
    let single = record.axes.iter().all(|a| a.values.len() < 2);
    for s in record
        .statistics
        .iter()
        .filter(|s| single && s.output < MOST_DESCRIBED)
    {
        let (name, unit) = output_text(&record.outputs[s.output]);
        let text = |x: f64| value_text(x, unit);
        sentences.push(html! {
            "In 90\u{a0}% of the samples the " (name) " of " (record.configurations[s.configuration].label) " is "
            b { (text(s.quantiles[1])) " to " (text(s.quantiles[5])) } ", its median " (text(s.quantiles[3])) "."
        });
        let mut own: Vec<&SensitivityIndex> = (record.indices.iter())
            .filter(|i| (i.configuration, i.output) == (s.configuration, s.output) && i.at == s.at)
            .collect();
        own.sort_by(|a, b| b.total[0].total_cmp(&a.total[0]));
        let strong = own.iter().filter(|i| i.total[0] >= NAMED_SHARE).take(3);
        let strong: Vec<String> = strong
            .map(|i| {
                let share = short(100.0 * i.total[0].clamp(0.0, 1.0), 2);
                format!("{share}\u{a0}% involves {}", record.axes[i.axis].keys[0])
            })
            .collect();
        if !strong.is_empty() {
            sentences.push(html! { "Of its variance " (strong.join(", ")) "." });
        }
    }
    sentences
}

/// Returns a sentence for each of the first outputs of a scan of listed values: its range with each configuration, and the
/// scenes where it is least and greatest. Scans with samples have quantiles, and scans of more cells than are shown none.
fn responses(record: &ScanRecord) -> Vec<Markup> {
    let all_shown = record.shown.len() as u64 == record.cells * record.configurations.len() as u64;
    if record.samples.is_some() || record.shard.is_some() || !all_shown || record.cells < 2 {
        return Vec::new();
    }
    // A chart of one axis names it.
    let place = |at: &[usize]| match record.axes.as_slice() {
        [axis] => axis.values.get(at[0]).cloned().unwrap_or_default(),
        _ => record.at_text(at),
    };
    let range = |configuration: usize, output: usize| {
        let own = (record.shown.iter()).filter(|r| r.configuration == configuration);
        let found: Vec<(f64, String)> = own
            .filter_map(|r| Some((r.outputs[output]?, place(&r.at))))
            .collect();
        let least = found.iter().min_by(|a, b| a.0.total_cmp(&b.0))?.clone();
        let greatest = found.iter().max_by(|a, b| a.0.total_cmp(&b.0))?.clone();
        Some((configuration, least, greatest))
    };
    let described = (0..record.outputs.len()).filter_map(|output| {
        let (name, unit) = output_text(&record.outputs[output]);
        let ranges: Vec<_> = (0..record.configurations.len().min(MOST_CONFIGURATIONS))
            .filter(|c| !record.unaffected.contains(c))
            .filter_map(|c| range(c, output))
            .collect();
        let (_, least, greatest) = ranges.first()?;
        let common = |place: fn(&Range) -> &str, of: &str| ranges.iter().all(|r| place(r) == of);
        let at_least = common(|r| &r.1.1, &least.1).then(|| least.1.clone());
        let at_greatest = common(|r| &r.2.1, &greatest.1).then(|| greatest.1.clone());
        let texts: Vec<String> = (ranges.iter())
            .map(|(c, least, greatest)| {
                let (low, high) = (value_text(least.0, unit), value_text(greatest.0, unit));
                let at = |known: &Option<String>, at: &str| match known {
                    Some(_) => String::new(),
                    None => format!(" ({at})"),
                };
                let label = &record.configurations[*c].label;
                let (low_at, high_at) = (at(&at_least, &least.1), at(&at_greatest, &greatest.1));
                format!("{low}{low_at} to {high}{high_at} with {label}")
            })
            .collect();
        let places: Vec<String> = [("least", at_least), ("greatest", at_greatest)]
            .into_iter()
            .filter_map(|(which, at)| Some(format!("{which} at {}", at?)))
            .collect();
        Some(html! {
            (crate::view::capital(&name)) ": " (texts.join(", "))
            @if !places.is_empty() { "; " (places.join(", ")) } "."
        })
    });
    described.take(MOST_DESCRIBED).collect()
}

/// The least and the greatest value of a configuration, each with the scene that has it.
type Range = (usize, (f64, String), (f64, String));

fn value_text(x: f64, unit: &str) -> String {
    match unit {
        "" => significant(x, 3),
        unit => quantity(x, unit, 3),
    }
}

/// Returns the tables of failures, statistics and indices.
pub fn tables(record: &ScanRecord) -> Markup {
    html! { (statistics(record)) (indices(record)) (failures(record)) (axes(record)) }
}

fn statistics(record: &ScanRecord) -> Markup {
    if record.statistics.is_empty() {
        return Markup::default();
    }
    let of_output = |o: usize| -> Vec<&SampleStatistics> {
        record.statistics.iter().filter(|s| s.output == o).collect()
    };
    let remark =
        "Quantiles are values of samples: the given share of the samples does not exceed them.";
    let parts = (0..record.outputs.len()).map(|o| {
        let rows = of_output(o);
        let (name, unit) = output_text(&record.outputs[o]);
        let quantile = |k: usize| move |s: &&SampleStatistics| s.quantiles[k];
        let table = Table::of(&rows)
            .text("Model", |s| record.configurations[s.configuration].text())
            .text("At", |s| record.at_text(&s.at))
            .key()
            .written("Samples", "", |s| count(s.count))
            .numbers("Mean", unit, 4, |s| s.mean)
            .numbers("Standard deviation", unit, 3, |s| s.deviation)
            .numbers("5 %", unit, 4, quantile(1))
            .result()
            .numbers("Median", unit, 4, quantile(3))
            .result()
            .numbers("95 %", unit, 4, quantile(5))
            .result()
            .numbers("Least", unit, 4, quantile(0))
            .numbers("Greatest", unit, 4, quantile(6))
            .written("Without value", "", |s| {
                (s.missing > 0).then(|| count(s.missing))
            });
        html! { h3 { (crate::view::capital(&name)) } (table) }
    });
    let parts: Vec<Markup> = parts.collect();
    glance(
        "Statistics over the samples",
        html! { @for part in &parts { (part) } (note(remark)) },
    )
}

fn indices(record: &ScanRecord) -> Markup {
    if record.indices.is_empty() {
        return Markup::default();
    }
    let interval = |x: [f64; 3]| format!("{} to {}", short(x[1], 2), short(x[2], 2));
    let columns = csv::indices();
    let of = |s| Some((record, s));
    let table = Table::of(&record.indices)
        .columns_by_key(&columns, &["axis"], of)
        .text("Quantity", |s| output_text(&record.outputs[s.output]).0)
        .key()
        .columns_by_key(&columns, &["model", "at", "first_order"], of)
        .written("95 % interval", "", |s| interval(s.first))
        .columns_by_key(&columns, &["total"], of)
        .written("95 % interval of total", "", |s| interval(s.total));
    let remark = "Sobol indices: share of the variance that an axis causes alone (first order), and alone and together \
                  with others (total). Intervals follow from the differences between groups of samples, each scrambled with another seed.";
    section("Sensitivity", html! { (table) (note(remark)) })
}

fn failures(record: &ScanRecord) -> Markup {
    if record.failures.is_empty() {
        return Markup::default();
    }
    let table = Table::of(&record.failures)
        .text("Model", |f| record.configurations[f.configuration].text())
        .text("Status", |f| f.status.to_string())
        .key()
        .written("Runs", "", |f| count(f.count))
        .result()
        .written("First in cell", "", |f| count(f.first_cell))
        .text("Reason there", |f| f.message.clone());
    section("Failed runs", table)
}

fn axes(record: &ScanRecord) -> Markup {
    let table = Table::of(&record.axes)
        .text("Keys", |a| a.keys.join(" | "))
        .text("Values", |a| match &a.distribution {
            Some(distribution) => distribution.clone(),
            None if a.values.len() > 8 => {
                let (first, last) = (&a.values[0], &a.values[a.values.len() - 1]);
                format!("{} values from {first} to {last}", a.values.len())
            }
            None => a.values.join(", "),
        });
    let remark = record.samples.as_ref().map(|s| {
        format!(
            "{} samples ({}, seed {}){}",
            count(s.samples),
            s.sampling,
            s.seed,
            if s.variants > 1 {
                format!(" in {} variants each", s.variants)
            } else {
                String::new()
            }
        )
    });
    section(
        "Axes",
        html! { (table) @if let Some(remark) = remark { (note(remark)) } },
    )
}
