//! Charts of stability maps: an overview at the scene's own parameters, and one figure of small multiples per model.

mod label_style;
mod overview;
mod panel;

use crate::drawing::Chart;
use crate::drawing::axis::NAME_SIZE;
use crate::drawing::canvas::{Anchor, DrawError, Type, draw, text_width};
use crate::drawing::geometry::Rect;
use crate::drawing::panel::{RIGHT, WIDTH};
use crate::numbers::{counted, per_cent, quantity};
use crate::record::Status;
use crate::studies::stability::{Columns, LineKind, Map};
use crate::view::capital;
use label_style::{Entry, KINDS, legend, legend_height};
pub use overview::overview;
use panel::{Panel, labels};

/// Panels side by side.
const ACROSS: usize = 3;
/// Space for the values of the parameter.
const LEFT: f64 = 74.0;
/// Space between the panels of a figure.
const BETWEEN: f64 = 16.0;
/// Space above a panel for its heading, below for its ticks, and below the last for the name of the abscissa.
const ABOVE: f64 = 26.0;
const BELOW: f64 = 22.0;
const NAME: f64 = 22.0;
/// Height of a line with the name of the ordinate, where that is longer than the panels are high.
const NAME_ABOVE: f64 = 20.0;

/// Largest number of maps that are drawn; the last caption states the number of those that are left out.
const DRAWN: usize = 24;

/// Returns the maps of one model over one set of axes.
fn figures(maps: &[Map]) -> Vec<Vec<&Map>> {
    let mut found: Vec<Vec<&Map>> = Vec::new();
    for map in maps {
        let same =
            |f: &&mut Vec<&Map>| f[0].set == map.set && f[0].model_label() == map.model_label();
        match found.iter_mut().find(same) {
            Some(figure) => figure.push(map),
            None => found.push(vec![map]),
        }
    }
    found
}

/// Draws the charts of a study of stability.
pub fn stability(maps: &[Map]) -> Result<Vec<Chart>, DrawError> {
    let mut charts = Vec::new();
    if let Some(svg) = overview(maps, "Where methods fail")? {
        charts.push(Chart {
            file: "stability.svg".into(),
            title: "Where methods fail".into(),
            caption: "How runs ended at the scene's own parameters, by step (or tolerance, for methods that choose \
                      their steps). The diamond is the largest step up to which every run held, closed in on to \
                      2 %; the vertical line is the stability limit of linear theory at the closed contact."
                .into(),
            svg,
        });
    }
    let all = figures(maps);
    for (i, figure) in all.iter().take(DRAWN).enumerate() {
        charts.push(Chart {
            file: format!("stability_map{:02}.svg", i + 1),
            title: heading(figure),
            caption: caption(figure),
            svg: paint(figure)?,
        });
    }
    if all.len() > DRAWN
        && let Some(last) = charts.last_mut()
    {
        last.caption.push_str(&format!(
            " {} further figures are left out; stability.csv has their cells.",
            all.len() - DRAWN
        ));
    }
    Ok(charts)
}

/// Returns the heading of a figure: model, integrator (their number where there are several) and parameters.
fn heading(maps: &[&Map]) -> String {
    let first = maps[0];
    let names: Vec<&str> = first.axes.iter().map(|a| a.name.as_str()).collect();
    let under = match maps {
        [one] => one.integrator.clone(),
        all => counted(all.len(), "integrator", "integrators"),
    };
    let columns = match first.columns {
        Columns::Step => "step",
        Columns::Tolerance => "tolerance",
    };
    format!(
        "{} under {under}: how runs ended over {columns} and {}",
        capital(&first.model_label()),
        names.join(" and ")
    )
}

/// Returns the clause on the distance between two converged solutions.
fn distance(checked: f64) -> String {
    format!(
        "a second solution at another tolerance differs from it by at most {} in the metric of the tolerance",
        per_cent(checked, 2)
    )
}

fn caption(maps: &[&Map]) -> String {
    let first = maps[0];
    let names: Vec<String> = first.axes.iter().map(|a| labels(a).1).collect();
    let over = match names.as_slice() {
        [a, b] => format!("{a}, panels by {b}"),
        _ => names.join(", "),
    };
    let checked: Vec<f64> = (first.references.iter())
        .filter_map(|r| r.checked)
        .collect();
    let worst = checked.iter().copied().fold(0.0, f64::max);
    let references = match (checked.len(), first.references.len()) {
        (0, _) => {
            "No converged solution was to be had: cells are classified by the energy ledger alone."
                .into()
        }
        (n, all) if n == all => format!(
            "Every row has a converged solution of its own; {}.",
            distance(worst)
        ),
        (n, all) => format!(
            "{n} of {all} rows have a converged solution; {}. The others are classified by the energy ledger alone.",
            distance(worst)
        ),
    };
    format!(
        "{}: {over}; {} simulated. The framed row is the scene's own value. {references}",
        first.model_label(),
        quantity(first.duration_s, "s", 3)
    )
}

/// Returns the panels of a figure, in rows.
fn panels<'a>(maps: &[&'a Map]) -> Vec<Vec<Panel<'a>>> {
    let name = |map: &Map| {
        if map.implicit {
            format!("{} (implicit)", map.integrator)
        } else {
            map.integrator.clone()
        }
    };
    let panel = |map, second, title| Panel {
        map,
        second,
        title,
        y_labels: false,
        x_name: false,
    };
    let mut rows: Vec<Vec<Panel<'a>>> = Vec::new();
    let seconds = maps.iter().any(|m| m.axes.len() > 1);
    if seconds {
        for &map in maps {
            let Some(axis) = map.axes.get(1) else {
                continue;
            };
            let texts = labels(axis).0;
            let all: Vec<Panel<'a>> = (texts.iter().enumerate())
                .map(|(j, text)| panel(map, j, format!("{}: {}", short_name(map), text)))
                .collect();
            let mut all = all.into_iter().peekable();
            while all.peek().is_some() {
                rows.push(all.by_ref().take(ACROSS).collect());
            }
        }
    } else {
        for chunk in maps.chunks(ACROSS) {
            rows.push(chunk.iter().map(|m| panel(*m, 0, name(m))).collect());
        }
    }
    let last = rows.len().saturating_sub(1);
    for (i, row) in rows.iter_mut().enumerate() {
        for (k, p) in row.iter_mut().enumerate() {
            p.y_labels = k == 0;
            p.x_name = i == last;
        }
    }
    rows
}

/// Returns the integrator without its parameters.
fn short_name(map: &Map) -> &str {
    map.integrator.split('(').next().unwrap_or("")
}

fn paint(maps: &[&Map]) -> Result<String, DrawError> {
    let rows = panels(maps);
    let occurs = |s: &Status| maps.iter().any(|m| m.cells.iter().any(|c| c.status == *s));
    let mut entries: Vec<Entry> = (Status::ALL.into_iter().filter(occurs))
        .map(Entry::Label)
        .collect();
    let drawn = |kind: LineKind| {
        let visible = |m: &Map, h: f64| m.at.first() <= Some(&h) && Some(&h) <= m.at.last();
        (maps.iter()).any(|m| {
            let of_kind = m.lines.iter().filter(|l| l.kind == kind);
            of_kind
                .flat_map(|l| l.step_s.iter().flatten())
                .any(|h| visible(m, *h))
        })
    };
    entries.extend((KINDS.iter().filter(|k| drawn(k.0))).map(|k| Entry::Theory(k.0)));
    if maps.iter().any(|m| {
        m.limit()
            .is_some_and(|l| l.unstable_s.is_some() && l.stable_s.is_some())
    }) {
        entries.push(Entry::Found);
    }
    let values = (maps.iter())
        .filter_map(|m| Some(m.axes.first()?.values.len()))
        .max()
        .unwrap_or(1);
    let tall = (18.0 * values as f64).clamp(96.0, 300.0);
    let plots = rows.len() as f64 * (ABOVE + tall + BELOW);
    let y_name = maps[0].axes.first().map(|axis| labels(axis).1);
    let is_long = |name: &String| text_width(name, NAME_SIZE) > plots;
    let above = y_name.iter().any(is_long);
    let legend_end = 30.0 + legend_height(&entries);
    let head = legend_end + if above { NAME_ABOVE } else { 0.0 };
    let height = head + plots + NAME;
    let wide = (WIDTH - RIGHT - LEFT - BETWEEN * (ACROSS - 1) as f64) / ACROSS as f64;
    let title = maps[0].model_label();
    draw(WIDTH, height, &title, |c| {
        let heading = Type::new(1.15 * NAME_SIZE, Anchor::Start).bold();
        c.text(&title, (16.0, 14.0), heading);
        legend(c, &entries, 26.0);
        for (i, row) in rows.iter().enumerate() {
            let top = head + i as f64 * (ABOVE + tall + BELOW) + ABOVE;
            for (k, p) in row.iter().enumerate() {
                let left = LEFT + k as f64 * (wide + BETWEEN);
                p.paint(c, &Rect::new(left, top, left + wide, top + tall));
            }
        }
        match &y_name {
            Some(name) if above => {
                let kind = Type::new(NAME_SIZE, Anchor::Start);
                let text = format!("ordinate: {name}");
                c.text(&text, (16.0, legend_end + 0.5 * NAME_ABOVE), kind);
            }
            Some(name) => {
                let middle = 0.5 * (head + height - NAME);
                let kind = Type::new(NAME_SIZE, Anchor::Middle).upwards();
                c.text(name, (14.0, middle), kind);
            }
            None => {}
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::quantity;
    use crate::record::{Part, Results, StudyHeader};
    use crate::studies::stability::{
        Cell, Columns, MapAxis, MapLine, SelfReference, StabilityRecord,
    };

    /// Makes a map with every label in its own row.
    fn map(set: usize, integrator: &str, seconds: usize) -> Map {
        let steps = 0..Status::ALL.len() as i32;
        let at: Vec<f64> = steps.map(|i| 1e-8 * 2_f64.powi(i)).collect();
        let axis = |id: &str, n: usize| MapAxis {
            id: id.into(),
            name: format!("{id} <over> the scene's"),
            unit: if n == 3 { "N/m".into() } else { String::new() },
            values: (0..n).map(|i| 10_f64.powi(i as i32 + 8)).collect(),
            own: n - 1,
        };
        let mut axes = vec![axis("tooth-stiffness", 3)];
        if seconds > 0 {
            axes.push(axis("speed", seconds));
        }
        let rows: usize = axes.iter().map(|a| a.values.len()).product();
        let cells = (0..rows).flat_map(|_| {
            at.iter().zip(Status::ALL).map(|(h, status)| Cell {
                at: *h,
                status,
                ..Cell::default()
            })
        });
        let steps = (0..rows).map(|r| (r != 1).then_some(3e-7 / (r + 1) as f64));
        Map {
            set,
            model: "movable-teeth".into(),
            variant: Some("<b>".into()),
            integrator: integrator.into(),
            duration_s: 1e-3,
            columns: if integrator == "bdf" {
                Columns::Tolerance
            } else {
                Columns::Step
            },
            cells: cells.collect(),
            lines: KINDS
                .iter()
                .map(|k| MapLine {
                    label: k.1.into(),
                    kind: k.0,
                    step_s: steps.clone().collect(),
                })
                .collect(),
            references: vec![SelfReference::default(); rows],
            at,
            axes,
            ..Map::default()
        }
    }

    fn results(maps: Vec<Map>) -> Results {
        Results {
            header: StudyHeader {
                scene: "made up".into(),
                ..StudyHeader::default()
            },
            part: Part::Stability(StabilityRecord { maps }),
            ..Results::default()
        }
    }

    #[test]
    fn every_label_has_its_letter_and_nothing_is_not_a_number() {
        let maps = vec![map(0, "rk4", 0), map(0, "bdf", 0), map(1, "rk4", 4)];
        let record = results(maps.clone());
        record.validate().unwrap();
        let charts = stability(&maps).unwrap();
        assert_eq!(charts.len(), 3, "an overview and one figure per set");
        for chart in &charts {
            assert!(!chart.svg.contains("NaN") && !chart.svg.contains("<b>"));
            for status in Status::ALL {
                let letter = label_style::label_style(status).letter;
                let written = format!(">{letter}</text>");
                assert!(
                    letter.is_empty() || chart.svg.contains(&written),
                    "{letter}"
                );
                assert!(chart.svg.contains(status.as_str()), "{status}");
            }
        }
        assert!(charts[1].svg.contains("theory: stability limit"));
        // Each cell of each row has the values of its row and column, its label and the reason for it.
        let cells: usize = maps.iter().map(|m| m.cells.len()).sum();
        let figures = charts[1..]
            .iter()
            .map(|c| c.svg.matches("class=\"cell\">\n<title>").count());
        assert_eq!(figures.sum::<usize>(), cells);
        let cell = &maps[0].cells[1];
        let text = format!("step {}: {}", quantity(cell.at, "s", 3), cell.status);
        let text = text.replace('\u{a0}', " ");
        assert!(
            charts[1].svg.replace('\u{a0}', " ").contains(&text),
            "{text}"
        );
        let report = crate::studies::report(&record).unwrap();
        let page = crate::markup::page(&record, &report).replace(crate::markup::SCRIPT, "");
        assert!(page.contains("Largest stable steps") && !page.contains("<b></b>"));
        assert!(!page.contains("NaN") && page.contains("&lt;b&gt;"));
    }

    /// The name of the ordinate is upright next to panels that are at least as high as it is long, else in a line above
    /// them.
    #[test]
    fn a_long_name_of_the_ordinate_stands_above() {
        let short = map(0, "rk4", 0);
        let above = |map: &Map| {
            let charts = stability(std::slice::from_ref(map)).unwrap();
            charts[1].svg.contains("ordinate: tooth-stiffness")
        };
        assert!(above(&short));
        let mut tall = short;
        let rows = 20_i32;
        tall.axes[0].values = (1..=rows).map(f64::from).collect();
        tall.cells = (0..rows)
            .flat_map(|_| tall.cells[..Status::ALL.len()].to_vec())
            .collect();
        assert!(!above(&tall));
    }

    #[test]
    fn more_figures_than_there_is_room_for_are_told_of() {
        let maps: Vec<Map> = (0..40).map(|set| map(set, "rk4", 0)).collect();
        let charts = stability(&maps).unwrap();
        assert_eq!(charts.len(), DRAWN + 1);
        let last = charts.last().map(|c| c.caption.as_str()).unwrap_or("");
        assert!(last.contains("16 further figures"), "{last}");
    }
}
