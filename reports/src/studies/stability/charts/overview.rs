//! Overview of stability at the scene's own parameters: one strip of cells per model and integrator.

use super::label_style::{self, Entry, legend, legend_height, limit_mark};
use super::panel::{Abscissa, column_scale};
use crate::drawing::axis::{Axis, Frame, NAME_SIZE};
use crate::drawing::canvas::{Anchor, Canvas, DrawError, Type, draw};
use crate::drawing::geometry::Rect;
use crate::drawing::panel::{RIGHT, WIDTH, extremes};
use crate::record::Status;
use crate::studies::stability::{Columns, LineKind, Map, unique_pairs};

/// Height of a strip and of a heading.
const STRIP: f64 = 18.0;
const HEADING: f64 = 24.0;
/// Space for names at the left.
const LEFT: f64 = 262.0;

/// Returns the maps of the overview: each pair of model and integrator once.
pub fn pairs(maps: &[Map], columns: Columns) -> Vec<&Map> {
    let mut found = unique_pairs(maps.iter().filter(|m| m.columns == columns));
    // Models stay together, in the order of their first map.
    let order: Vec<String> = found.iter().map(|m| m.model_label()).collect();
    found.sort_by_key(|m| order.iter().position(|l| *l == m.model_label()));
    found
}

/// Returns the axis of several maps in its own unit.
fn common(maps: &[&Map]) -> Option<Axis> {
    let (scale, _) = column_scale(maps[0].columns);
    let ends = maps
        .iter()
        .filter_map(|m| Some(Abscissa::of(&m.at)?.ends()));
    let (low, high) = extremes(ends.flatten());
    (low < high).then(|| Axis::decades(low * scale, high * scale))
}

fn block_height(maps: &[&Map]) -> f64 {
    let models = headings(maps).len() as f64;
    HEADING * models + STRIP * maps.len() as f64 + 52.0
}

/// Returns the indices at which a new model begins.
fn headings(maps: &[&Map]) -> Vec<usize> {
    (0..maps.len())
        .filter(|&i| i == 0 || maps[i - 1].model_label() != maps[i].model_label())
        .collect()
}

/// Draws the chart with a title; `None` without maps.
pub fn overview(maps: &[Map], title: &str) -> Result<Option<String>, DrawError> {
    let blocks: Vec<Vec<&Map>> = [Columns::Step, Columns::Tolerance]
        .map(|columns| pairs(maps, columns))
        .into_iter()
        .filter(|b| !b.is_empty())
        .collect();
    if blocks.is_empty() {
        return Ok(None);
    }
    let shown = || blocks.iter().flatten();
    let occurs = |s: &Status| shown().any(|m| m.row(m.own_row()).iter().any(|c| c.status == *s));
    let mut entries: Vec<Entry> = (Status::ALL.into_iter().filter(occurs))
        .map(Entry::Label)
        .collect();
    if shown().any(|m| m.theory(m.own_row()).is_some()) {
        entries.push(Entry::Theory(LineKind::Stability));
    }
    if shown().any(|m| {
        m.limit()
            .is_some_and(|l| l.unstable_s.is_some() && l.stable_s.is_some())
    }) {
        entries.push(Entry::Found);
    }
    let head = 8.0 + legend_height(&entries);
    let height = head + blocks.iter().map(|b| block_height(b)).sum::<f64>();
    let svg = draw(WIDTH, height, title, |c| {
        legend(c, &entries, 4.0);
        let mut y = head;
        for block in &blocks {
            paint(c, block, y);
            y += block_height(block);
        }
    })?;
    Ok(Some(svg))
}

fn paint(c: &mut Canvas, maps: &[&Map], top: f64) {
    let Some(x) = common(maps) else {
        return;
    };
    let bottom = top + block_height(maps) - 46.0;
    let frame = Frame {
        area: Rect::new(LEFT, top + 4.0, WIDTH - RIGHT, bottom),
        x,
        y: Axis::linear(0.0, 1.0),
    };
    let (scale, name) = column_scale(maps[0].columns);
    frame.paint_x(c, name, 9);
    let place = |x: f64| frame.at(x * scale, 0.0).0;
    let begins = headings(maps);
    let mut y = top;
    for (i, map) in maps.iter().enumerate() {
        if begins.contains(&i) {
            let at = (16.0, y + 0.62 * HEADING);
            c.text(
                &map.model_label(),
                at,
                Type::new(NAME_SIZE, Anchor::Start).bold(),
            );
            y += HEADING;
        }
        strip(c, map, &place, &frame.area, y);
        y += STRIP;
    }
}

fn strip(c: &mut Canvas, map: &Map, place: &dyn Fn(f64) -> f64, whole: &Rect, y: f64) {
    let middle = y + 0.5 * STRIP;
    let name = if map.implicit {
        format!("{} (implicit)", map.integrator)
    } else {
        map.integrator.clone()
    };
    let kind = Type::new(12.0, Anchor::End);
    c.text(&name, (LEFT - 8.0, middle), kind);
    let Some(x) = Abscissa::of(&map.at) else {
        return;
    };
    let [low, high] = x.ends().map(place);
    let area = Rect::new(low, y + 1.0, high, y + STRIP - 1.0);
    super::panel::paint_row(c, map, map.own_row(), &x, &area, &area);
    if let Some((h, _)) = map.theory(map.own_row()) {
        let at = place(h);
        let line = [(at, area.y1), (at, area.y0)];
        label_style::theory_line(c, &line, whole, LineKind::Stability);
    }
    if let Some(h) = map.limit().and_then(|l| l.unstable_s.and(l.stable_s)) {
        limit_mark(c, (place(h), middle));
    }
}
