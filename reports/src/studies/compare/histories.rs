//! Contact force and angular velocities over time: one run per model, with the reference.

use super::window::{TimeAxis, busy_window, contact_window, peak_of, time_axis};
use crate::drawing::Chart;
use crate::drawing::axis::Axis;
use crate::drawing::canvas::{DrawError, Ink, Stroke};
use crate::drawing::legend::Entry;
use crate::drawing::panel::{Curve, Panel, chart};
use crate::drawing::style::{model_stroke, reference_stroke};
use crate::numbers::{Prefix, per_cent, quantity};
use crate::record::{ReferenceSeries, Run};
use crate::series::{TimeSeries, resample};
use crate::view::View;

/// A run that a history chart shows.
struct Drawn<'a> {
    run: &'a Run,
    history: usize,
}

/// A history with its look.
pub(super) struct History<'a> {
    pub label: String,
    pub series: &'a TimeSeries,
    /// Of a reference, its histories at other times.
    pub further: &'a [TimeSeries],
    pub stroke: Stroke,
    /// Place of its model; none of a reference.
    pub style: Option<usize>,
}

/// What both history charts share.
pub(super) struct Histories<'a> {
    reference: Option<&'a ReferenceSeries>,
    runs: Vec<Drawn<'a>>,
    /// The reference first, then one run per model.
    pub curves: Vec<History<'a>>,
    pub time: TimeAxis,
    /// A window to look into when the whole is too busy to read.
    pub zoom: Option<TimeAxis>,
}

impl<'a> History<'a> {
    /// Its histories, of a reference also those at other times.
    pub fn all_series(&self) -> impl Iterator<Item = &'a TimeSeries> {
        std::iter::once(self.series).chain(self.further)
    }

    fn has_force(&self) -> bool {
        !self.series.contact_force_n.is_empty()
    }
}

impl<'a> Histories<'a> {
    pub fn of(view: &View<'a>) -> Option<Self> {
        let reference = view.reference();
        let mut curves: Vec<History<'a>> = (reference.iter())
            .map(|r| History {
                label: view.reference_name(&r.id),
                series: &r.series,
                further: &r.further,
                stroke: reference_stroke(),
                style: None,
            })
            .collect();
        // Further references: thin, beside the one that runs are held against.
        let others = (view.results.references.iter())
            .filter(|r| !r.series.is_empty() && reference.is_some_and(|m| m.id != r.id));
        let plain = curves.len();
        curves.extend(others.map(|r| History {
            label: view.reference_name(&r.id),
            series: &r.series,
            further: &r.further,
            stroke: Stroke::dashed(Ink::GREY, 1.3, &[1.5, 2.0]),
            style: None,
        }));
        let further = curves.len() - plain;
        let mut runs = Vec::new();
        for group in &view.groups {
            // The reference itself may be a run of the record.
            if further > 0
                && reference.is_some_and(|r| group.runs.iter().all(|(_, run)| is_run(&r.id, run)))
            {
                continue;
            }
            let Some((_, run)) = view.drawn(group) else {
                continue;
            };
            let Some(series) = &run.series else {
                continue;
            };
            let mut label = format!("{} ({})", group.label, run.integrator);
            if run.status.is_failure() {
                label = format!("{label}: {}", run.status);
            }
            runs.push(Drawn {
                run,
                history: curves.len(),
            });
            curves.push(History {
                label,
                series,
                further: &[],
                stroke: model_stroke(group.style),
                style: Some(group.style),
            });
        }
        let all: Vec<&TimeSeries> = curves.iter().map(|c| c.series).collect();
        let time = time_axis(contact_window(&all));
        // A reference may lack a force.
        let busiest = curves.iter().find(|c| c.has_force());
        let zoom = busy_window(busiest.map_or(*all.first()?, |c| c.series)).map(time_axis);
        Some(Self {
            reference,
            runs,
            curves,
            time,
            zoom,
        })
    }

    pub fn legend(&self) -> Vec<Entry> {
        let entry = |c: &History<'_>| Entry::history(&c.label, c.stroke, c.style);
        self.curves.iter().map(entry).collect()
    }

    fn peak(&self) -> f64 {
        peak_of(&self.curves.iter().map(|c| c.series).collect::<Vec<_>>())
    }

    /// All curves of a column. Busy overviews take thin full lines: dashes would be lost in them.
    pub fn lines(
        &self,
        column: impl Fn(&TimeSeries) -> Option<&[f64]>,
        factor: f64,
        time: &TimeAxis,
    ) -> Vec<Curve> {
        let overview = self.zoom.is_some() && *time == self.time;
        let line = |c: &History<'_>| {
            // A column that a reference does not have is no line at zero.
            let mut all = c.all_series().filter_map(|s| Some((s, column(s)?)));
            let (series, values) = all.find(|(_, values)| !values.is_empty())?;
            let stroke = match overview {
                true => Stroke::new(c.stroke.ink, 0.9),
                false => c.stroke,
            };
            let x = scaled(&series.time_s, time.factor);
            let y = scaled(values, factor);
            let curve = Curve::history(stroke, &time.axis, &x, &y);
            Some(curve.along(c.style.filter(|_| !overview)))
        };
        self.curves.iter().filter_map(line).collect()
    }
}

/// Whether a reference is a run of the record: it then has the run's label, `model` or `model-variant`.
fn is_run(id: &str, run: &Run) -> bool {
    match &run.variant {
        None => run.model == id,
        Some(v) => id == v || id == format!("{}-{v}", run.model),
    }
}

fn scaled(values: &[f64], factor: f64) -> Vec<f64> {
    values.iter().map(|x| x * factor).collect()
}

/// Contact force over time, and where the models miss the reference.
pub fn force(view: &View<'_>) -> Result<Option<Chart>, DrawError> {
    let Some(h) = Histories::of(view) else {
        return Ok(None);
    };
    let unit = Prefix::of(h.peak(), 20.0);
    let y_name = format!("contact force [{}N]", unit.symbol);
    let panel = |time: &TimeAxis, height: f64| Panel {
        x_name: Some(time.name.clone()),
        ..Panel::new(height, &time.axis, &y_name)
            .curves(h.lines(|s| Some(&s.contact_force_n), unit.factor, time))
            .close()
    };
    let mut caption =
        "Normal contact force of one run per model, the one with the least error.".to_owned();
    let mut panels = Vec::new();
    match &h.zoom {
        None => panels.push(panel(&h.time, 240.0)),
        Some(zoom) => {
            let top = Axis::from_zero(h.peak() * unit.factor);
            let lines = h.lines(|s| Some(&s.contact_force_n), unit.factor, &h.time);
            let forces = h.curves.iter().filter(|c| c.has_force());
            let last = lines.len().saturating_sub(1);
            for (i, (line, curve)) in lines.into_iter().zip(forces).enumerate() {
                let name = format!("force [{}N]", unit.symbol);
                panels.push(Panel {
                    y: Some(top.clone()),
                    x_name: (i == last).then(|| h.time.name.clone()),
                    ..Panel::new(88.0, &h.time.axis, &name)
                        .remark(&curve.label)
                        .curves([line])
                });
            }
            panels.push(panel(zoom, 200.0));
            caption.push_str(
                " Each history as a whole (drawn so that every peak stays), then all of them \
                 around the highest peak.",
            );
        }
    }
    let with_force = |r: &&ReferenceSeries| !r.series.contact_force_n.is_empty();
    if let Some(reference) = h.reference.filter(with_force) {
        panels.push(residual(
            &h,
            reference,
            h.zoom.as_ref().unwrap_or(&h.time),
            unit,
        ));
        caption.push_str(
            " Below: model minus reference, each run shifted in time to its best fit; what stays \
             are the shape of the contact law and the ripples that only elastic bodies show.",
        );
        let shifts: Vec<String> = (h.runs.iter())
            .filter_map(|d| {
                let m = d.run.against(&reference.id)?;
                let (e, shift) = (m.force_l2_aligned?, m.time_shift_s.unwrap_or(0.0));
                Some(format!(
                    "{}, {} after a shift of {}",
                    d.run.model_label(),
                    per_cent(e, 3),
                    quantity(shift, "s", 2),
                ))
            })
            .collect();
        if !shifts.is_empty() {
            caption.push_str(&format!(" Errors: {}.", shifts.join("; ")));
        }
    }
    let title = "Contact force over time";
    chart("force.svg", title, caption, &h.legend(), &panels).map(Some)
}

fn residual(
    h: &Histories<'_>,
    reference: &ReferenceSeries,
    time: &TimeAxis,
    unit: Prefix,
) -> Panel {
    let t = &reference.series.time_s;
    let zero = Curve::line(
        Stroke::new(Ink::DARK.opacity(0.82), 1.6),
        vec![(time.axis.min, 0.0), (time.axis.max, 0.0)],
    );
    let mut buffer = Vec::new();
    let lines = h.runs.iter().map(|d| {
        let shift = (d.run.against(&reference.id))
            .and_then(|m| m.time_shift_s)
            .unwrap_or(0.0);
        let curve = &h.curves[d.history];
        let own = curve.series;
        resample(&own.time_s, &own.contact_force_n, t, shift, &mut buffer);
        let y: Vec<f64> = (buffer.iter().zip(&reference.series.contact_force_n))
            .map(|(f, r)| (f - r) * unit.factor)
            .collect();
        let x = scaled(t, time.factor);
        Curve::history(curve.stroke, &time.axis, &x, &y).along(curve.style)
    });
    let name = format!("model \u{2212} ref. [{}N]", unit.symbol);
    Panel {
        x_name: Some(time.name.clone()),
        ..Panel::new(150.0, &time.axis, &name)
            .remark("difference after time alignment")
            .curves(std::iter::once(zero).chain(lines))
            .close()
    }
}

/// Speed over the greatest of all gears below which a gear is at rest.
const AT_REST: f64 = 1e-9;

/// What names of further columns with the speed of a gear end in.
const SPEED: &str = "_rad_s";

/// The speed of a gear by the name of its column, without the unit.
fn speed<'s>(series: &'s TimeSeries, name: &str) -> Option<&'s [f64]> {
    let mut columns = series.named_columns();
    columns.find_map(|(n, values)| (n.strip_suffix(SPEED)? == name).then_some(values))
}

/// Speeds of all gears over time.
pub fn speeds(view: &View<'_>) -> Result<Option<Chart>, DrawError> {
    let Some(h) = Histories::of(view) else {
        return Ok(None);
    };
    let mut names: Vec<&str> = Vec::new();
    let all = h.curves.iter().flat_map(History::all_series);
    for (name, _) in all.flat_map(TimeSeries::named_columns) {
        if let Some(name) = name.strip_suffix(SPEED)
            && !names.contains(&name)
        {
            names.push(name);
        }
    }
    // Gears that are held have no panel: their speed is rounding.
    let largest = |name: &str| {
        let all = h.curves.iter().flat_map(History::all_series);
        let values = all.filter_map(|s| speed(s, name)).flatten();
        values.fold(0.0_f64, |most, x| most.max(x.abs()))
    };
    let fastest = names.iter().map(|n| largest(n)).fold(0.0, f64::max);
    let moving: Vec<(usize, &str)> = (names.iter().copied().enumerate())
        .filter(|(_, name)| largest(name) > AT_REST * fastest)
        .collect();
    // The picture of the teeth knows what the gears are called, in their order.
    let gears: Vec<&str> = (view.results.runs.iter())
        .find_map(|r| r.contacts.as_ref())
        .map_or(Vec::new(), |s| {
            s.outlines.iter().map(|o| o.gear.as_str()).collect()
        });
    let label = |i: usize, name: &str| {
        let symbol = name
            .replacen("omega", "\u{3c9}", 1)
            .replacen("speed", "\u{3c9}", 1);
        let symbol = symbol.replace('_', " ");
        match gears
            .get(i)
            .filter(|g| g.len() <= 10 && !symbol.ends_with(*g))
        {
            Some(gear) => format!("{symbol} {gear} [rad/s]"),
            None => format!("{symbol} [rad/s]"),
        }
    };
    let size = if h.zoom.is_some() { 130.0 } else { 160.0 };
    let mut panels = Vec::new();
    for time in std::iter::once(&h.time).chain(&h.zoom) {
        for (place, (i, name)) in moving.iter().enumerate() {
            panels.push(Panel {
                x_name: (place + 1 == moving.len()).then(|| time.name.clone()),
                ..Panel::new(size, &time.axis, &label(*i, name))
                    .curves(h.lines(|s| speed(s, name), 1.0, time))
                    .close()
            });
        }
    }
    let zoomed = if h.zoom.is_some() {
        " The lower panels show the time around the highest peak of the force."
    } else {
        ""
    };
    let of: Option<Vec<&str>> = moving.iter().map(|(i, _)| gears.get(*i).copied()).collect();
    let of = of.map_or_else(|| "the gears".into(), |gears| gears.join(", "));
    let title = "Angular velocities of the gears";
    let caption = format!(
        "Angular velocities of {of}, counter-clockwise positive. Elastic bodies are shown by their momentum mean, angular \
         momentum over inertia, which is what a rigid body has; a rack by its speed over the pitch radius of its \
         mate.{zoomed}"
    );
    chart("speeds.svg", title, caption, &h.legend(), &panels).map(Some)
}
