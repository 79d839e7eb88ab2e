//! Chart of the transmission error over whole mesh cycles, and of its amplitudes at the orders of the mesh.

use super::histories::{Histories, History};
use crate::drawing::Chart;
use crate::drawing::axis::Axis;
use crate::drawing::canvas::DrawError;
use crate::drawing::panel::{Curve, Panel, chart};
use crate::metrics::orders::CycleHistory;
use crate::metrics::trapezoid_weights;
use crate::numbers::Prefix;
use crate::series::{SPEED_RATIO_ERROR, TRANSMISSION_ERROR, TimeSeries};
use crate::view::View;

/// Largest number of cycles in the chart; it shows the last ones.
const SHOWN: f64 = 3.0;
/// Number of orders in the chart.
const ORDERS: usize = 10;

/// Draws the chart over the last whole cycles that all histories have, less the mean of each; `None` where no run lasts
/// a whole cycle, or where the gears hammer.
pub(super) fn error(views: &[View<'_>]) -> Result<Option<Chart>, DrawError> {
    let Some(h) = Histories::of(views) else {
        return Ok(None);
    };
    // Mesh cycles of references without their own are those of a run of their scene.
    let clocks: Vec<Option<Clock<'_>>> = (0..views.len()).map(|scene| clock(&h, scene)).collect();
    let of_scene = |c: &History<'_>| clocks.get(c.scene)?.as_ref();
    let over = |c: &History<'_>| {
        let clock = of_scene(c)?;
        match c.style {
            Some(_) => CycleHistory::of_run(c.series, clock.mesh),
            None => {
                (c.all_series()).find_map(|s| CycleHistory::of_reference(s, clock.run, clock.mesh))
            }
        }
    };
    let found: Vec<(&History<'_>, CycleHistory)> = h
        .curves
        .iter()
        .filter_map(|c| Some((c, over(c)?)))
        .collect();
    let Some(whole) = CycleHistory::whole(found.iter().map(|(_, o)| o)) else {
        return Ok(None);
    };
    if found.iter().all(|(c, _)| c.style.is_none()) {
        return Ok(None);
    }
    let [first, last] = whole;
    let from = first.max(last - SHOWN);
    let curves: Vec<(&History<'_>, Vec<(f64, f64)>)> = (found.iter())
        .map(|(c, o)| {
            let (cycle, error) = o.between([from, last]);
            let weights = trapezoid_weights(&cycle);
            let area: f64 = error.iter().zip(weights).map(|(e, w)| w * e).sum();
            let mean = area / (last - from);
            let points = cycle.iter().zip(&error);
            (*c, points.map(|(c, e)| (c - from, e - mean)).collect())
        })
        .collect();
    let values = curves
        .iter()
        .flat_map(|(_, p)| p.iter().map(|(_, e)| e.abs()));
    let prefix = Prefix::of(values.fold(0.0, f64::max), 1.0);
    let x = Axis::linear(0.0, last - from);
    let lines = curves.into_iter().map(|(c, points)| {
        let scaled = points.into_iter().map(|(c, e)| (c, e * prefix.factor));
        let (t, y): (Vec<f64>, Vec<f64>) = scaled.unzip();
        Curve::history(c.stroke, &x, &t, &y).along(c.style)
    });
    let unit = |what: &str| format!("{what} [{}m]", prefix.symbol);
    let speeds = speed_ratio(&h, &clocks, &x, [from, last]);
    let over_cycles = Panel {
        x_name: speeds.is_none().then(|| "mesh cycle".into()),
        ..Panel::new(200.0, &x, &unit("error less its mean"))
            .curves(lines)
            .close()
    };
    let orders = Axis::linear(0.0, (ORDERS + 1) as f64);
    let spectra = found.iter().map(|(c, o)| {
        let amplitudes = o.amplitudes(whole, ORDERS);
        let points = (amplitudes.iter().enumerate())
            .map(|(n, a)| ((n + 1) as f64, a * prefix.factor))
            .collect();
        Curve::line(c.stroke, points).along(c.style)
    });
    let over_orders = Panel {
        x_name: Some("order of the mesh frequency".into()),
        ..Panel::new(150.0, &orders, &unit("amplitude"))
            .curves(spectra)
            .close()
    };
    let ratio = match speeds.is_some() {
        true => {
            ", the error of the speed ratio (speed of the first hub over that of the second, over the ratio of the numbers of teeth, less 1) over the same cycles,"
        }
        false => ",",
    };
    let caption = format!(
        "The last whole mesh cycles that all histories have{}, each less its mean{ratio} and the amplitudes at multiples of the \
         mesh frequency over the last {}. What repeats with the turns of the gears alone lies between the orders.",
        of_meshes(&clocks),
        match (last - first).round() {
            1.0 => "cycle".to_owned(),
            n => format!("{n} cycles"),
        }
    );
    let title = "Transmission error over the mesh cycle";
    let panels: Vec<Panel> = std::iter::once(over_cycles)
        .chain(speeds)
        .chain([over_orders])
        .collect();
    chart(
        "transmission_error.svg",
        title,
        caption,
        &h.legend(),
        &panels,
    )
    .map(Some)
}

/// Mesh that a scene shows: the one with the largest transmission error of a run, whose mesh cycles references share.
struct Clock<'s> {
    run: &'s TimeSeries,
    /// Names of the gears, `_` between them.
    mesh: &'s str,
    /// True if the scene has further meshes.
    is_one_of_several: bool,
}

/// Returns the mesh of a scene from its first run with a mesh that passes a whole cycle.
fn clock<'s>(h: &Histories<'s>, scene: usize) -> Option<Clock<'s>> {
    let mut runs = (h.curves.iter()).filter(|c| c.style.is_some() && c.scene == scene);
    runs.find_map(|c| {
        let span = |(mesh, _): (&'s str, _)| {
            let own = CycleHistory::of_run(c.series, mesh)?;
            let (least, most) = (own.values.iter())
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
                    (a.min(*x), b.max(*x))
                });
            Some((mesh, most - least))
        };
        let all: Vec<_> = (c.series.all_of(TRANSMISSION_ERROR))
            .filter_map(span)
            .collect();
        let largest = (all.iter().copied()).reduce(|a, b| if b.1 > a.1 { b } else { a });
        largest.map(|(mesh, _)| Clock {
            run: c.series,
            mesh,
            is_one_of_several: all.len() > 1,
        })
    })
}

/// Returns the meshes that are shown, for scenes with several.
fn of_meshes(clocks: &[Option<Clock<'_>>]) -> String {
    let several = clocks.iter().flatten().filter(|c| c.is_one_of_several);
    let names: Vec<&str> = several.map(|c| c.mesh).collect();
    match names.is_empty() {
        true => String::new(),
        false => format!(
            ", of the mesh with the largest transmission error ({})",
            names.join(", ")
        ),
    }
}

/// Returns the panel of the error of the speed ratio between two mesh cycles; `None` where no run has it.
fn speed_ratio(
    h: &Histories<'_>,
    clocks: &[Option<Clock<'_>>],
    x: &Axis,
    [from, last]: [f64; 2],
) -> Option<Panel> {
    let runs = h.curves.iter().filter(|c| c.style.is_some());
    let of = |c: &History<'_>| {
        let mesh = clocks.get(c.scene)?.as_ref()?.mesh;
        let own = CycleHistory::of_quantity(c.series, SPEED_RATIO_ERROR, mesh)?;
        let (cycle, values) = own.between([from, last]);
        let cycle: Vec<f64> = cycle.iter().map(|c| c - from).collect();
        Some(Curve::history(c.stroke, x, &cycle, &values).along(c.style))
    };
    let curves: Vec<Curve> = runs.filter_map(of).collect();
    (!curves.is_empty()).then(|| Panel {
        x_name: Some("mesh cycle".into()),
        ..Panel::new(130.0, x, "speed ratio error [-]")
            .curves(curves)
            .close()
    })
}
