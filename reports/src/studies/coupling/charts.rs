//! Charts of errors of force and energy over the communication step, with the status of the runs.

use super::{Coupling, CouplingCell, manners, models};
use crate::drawing::Chart;
use crate::drawing::axis::Axis;
use crate::drawing::canvas::{DrawError, Ink, Stroke};
use crate::drawing::legend::Entry;
use crate::drawing::panel::{Curve, Panel, chart, extremes};
use crate::drawing::style::curve_style;
use crate::numbers::per_cent;
use crate::studies::stability::{Cell, Columns, LineKind, Map, MapAxis, MapLine, overview};

/// Lower edge of the charts; smaller errors are drawn there.
const LEAST: f64 = 1e-9;
/// Upper edge of the charts; larger errors are drawn there.
const MOST: f64 = 10.0;

/// Name of the abscissa of the map.
const STEP: &str = "communication step [\u{b5}s]";

/// A quantity of a run.
type Quantity = fn(&CouplingCell) -> Option<f64>;

/// Draws the charts of a study of coupling.
pub fn charts(couplings: &[Coupling], limit: Option<f64>) -> Result<Vec<Chart>, DrawError> {
    let mut all = Vec::new();
    let force: Quantity = |c| c.force_l2;
    let energy: Quantity = |c| c.energy_error_rel.map(f64::abs);
    let text = |what: &str, more: &str| {
        format!(
            "{what} over the communication step, model by model, for each extrapolation of the forces on hubs. {more} Crosses \
             are runs that failed; dotted lines in the colour of a model are where theory has the coupling make up more energy than is allowed: the \
             hubs as one oscillator on the static stiffness of the teeth."
        )
    };
    let caption = text(
        "Relative L2 error of the force history against the run as one system",
        "The dashed level is the tolerance.",
    );
    all.extend(errors(
        couplings,
        ("coupling_error.svg", "Error of the coupling", &caption),
        ("force, L2", force, limit),
    )?);
    let caption = text(
        "Work that the host takes from extrapolated forces less what the gears give along the motion that they see, over the \
         whole run, by magnitude, over the energy that vibrates and passes through contacts,",
        "",
    );
    all.extend(errors(
        couplings,
        (
            "coupling_energy.svg",
            "Energy error of the coupling",
            &caption,
        ),
        ("energy error", energy, None),
    )?);
    let maps: Vec<Map> = couplings.iter().map(map).collect();
    all.extend(overview(&maps, "Where the coupling fails", Some(STEP))?.map(|svg| Chart {
        file: "coupling_map.svg".into(),
        title: "Where the coupling fails".into(),
        caption: "How runs ended, by communication step, for each model and extrapolation. The diamond is the largest step up to \
                  which every run held, the vertical line the limit of theory."
            .into(),
        svg,
    }));
    Ok(all)
}

/// Draws a panel per method of coupling with a curve per model.
fn errors(
    couplings: &[Coupling],
    (file, title, caption): (&str, &str, &str),
    (name, get, limit): (&str, Quantity, Option<f64>),
) -> Result<Option<Chart>, DrawError> {
    let models = models(couplings);
    let cells = || couplings.iter().flat_map(Coupling::all);
    let (low, high) = extremes(cells().map(|c| c.step_s));
    if low >= high || low.is_nan() || cells().filter_map(get).count() < 2 {
        return Ok(None);
    }
    let x = Axis::logarithmic(low, high);
    let clamped = |y: f64| y.clamp(LEAST, MOST);
    let (least, most) = extremes(
        cells()
            .filter(|c| !c.status.is_failure())
            .filter_map(get)
            .map(clamped),
    );
    let y = Axis::logarithmic(least, most.max(10.0 * least));
    let curve = |c: &Coupling| {
        let style = models.iter().position(|m| *m == c.model_label());
        let (failed, held): (Vec<_>, Vec<_>) =
            (c.all().into_iter()).partition(|cell| cell.status.is_failure());
        let point = |cell: &&CouplingCell| Some((cell.step_s, clamped(get(cell)?)));
        let points = held.iter().filter_map(point).collect();
        Curve::joined(curve_style(style.unwrap_or(0)), 1.6, 4.2, points)
            .failed(failed.iter().map(|cell| cell.step_s).collect())
    };
    let manners = manners(couplings);
    let panels: Vec<Panel> = (manners.iter().enumerate())
        .map(|(i, manner)| {
            let of = || couplings.iter().filter(|c| c.manner() == *manner);
            let theory = of().filter_map(|c| {
                let style = models.iter().position(|m| *m == c.model_label());
                let stroke = Stroke::dashed(curve_style(style.unwrap_or(0)).ink, 1.3, &[2.0, 3.0]);
                let h = c.theory_s?;
                Some(Curve::line(stroke, vec![(h, y.min), (h, y.max)]))
            });
            Panel {
                x_name: (i + 1 == manners.len()).then(|| "communication step [s]".to_owned()),
                y: Some(y.clone()),
                limits: limit.map(|l| (l, per_cent(l, 2))).into_iter().collect(),
                ..Panel::new(190.0, &x, name)
                    .remark(format!("{manner} extrapolation"))
                    .curves(theory.chain(of().map(curve)))
            }
        })
        .collect();
    let mut legend: Vec<Entry> = (models.iter().enumerate())
        .map(|(i, m)| Entry::marked(m, curve_style(i), true))
        .collect();
    if couplings.iter().any(|c| c.theory_s.is_some()) {
        let stroke = Stroke::dashed(Ink::GREY, 1.3, &[2.0, 3.0]);
        legend.push(Entry::line("limit of theory", stroke));
    }
    chart(file, title, caption, &legend, &panels).map(Some)
}

/// Makes a map of one row from a coupling.
fn map(c: &Coupling) -> Map {
    let cell = |x: &CouplingCell| Cell {
        at: x.step_s,
        status: x.status,
        error: x.force_l2,
        ..Cell::default()
    };
    Map {
        model: c.model.clone(),
        variant: c.variant.clone(),
        integrator: c.manner(),
        columns: Columns::Step,
        at: c.cells.iter().map(|x| x.step_s).collect(),
        axes: vec![MapAxis {
            values: vec![1.0],
            ..MapAxis::default()
        }],
        cells: c.cells.iter().map(cell).collect(),
        refined: c.refined.iter().map(cell).collect(),
        lines: vec![MapLine {
            label: "one oscillator".into(),
            kind: LineKind::Stability,
            step_s: vec![c.theory_s],
        }],
        ..Map::default()
    }
}
