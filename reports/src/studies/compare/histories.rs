//! Charts of contact force and angular velocities over time: one run per model, with the reference.
//!
//! A quantity with a history per mesh (or gear) has one of two layouts: a panel for each model with all meshes, or,
//! where a panel would have too many curves, a panel for each mesh with all models.

use super::window::{TimeAxis, busy_window, contact_window, peak_of, time_axis};
use crate::drawing::Chart;
use crate::drawing::axis::Axis;
use crate::drawing::canvas::{DrawError, Ink, Stroke};
use crate::drawing::legend::Entry;
use crate::drawing::panel::{Curve, Panel, chart, extremes};
use crate::drawing::style::{model_stroke, reference_stroke};
use crate::numbers::{Prefix, per_cent, quantity};
use crate::record::{ReferenceSeries, Run};
use crate::series::{TimeSeries, mesh_column, resample};
use crate::view::View;

/// A run that is drawn in a chart of histories.
struct DrawnRun<'a> {
    run: &'a Run,
    history: usize,
}

/// Largest number of meshes or gears whose curves share a panel; more cannot be distinguished.
const MOST_OVERLAID: usize = 4;

/// A mesh or a gear, and the column of a quantity of it.
pub(super) struct MemberColumn {
    /// Name of the mesh or gear; empty if the scene has one only.
    pub name: String,
    pub column: String,
    /// Index of its look, after those of all models.
    pub style: usize,
}

/// A history with its look.
pub(super) struct History<'a> {
    pub label: String,
    /// True if it is a reference that is a run of the record.
    pub is_copy: bool,
    pub series: &'a TimeSeries,
    /// Further histories of a reference, at other times.
    pub further: &'a [TimeSeries],
    pub stroke: Stroke,
    /// Place of its model; none of a reference.
    pub style: Option<usize>,
}

/// Curves, time axes and names that all charts of histories share.
pub(super) struct Histories<'a> {
    reference: Option<&'a ReferenceSeries>,
    runs: Vec<DrawnRun<'a>>,
    /// The reference first, then one run per model.
    pub curves: Vec<History<'a>>,
    pub time: TimeAxis,
    /// Short time interval for a close-up, if the whole history is too dense to read.
    pub zoom: Option<TimeAxis>,
    /// Names of the gears of each mesh, of scenes with several.
    meshes: Vec<[String; 2]>,
    /// Number of models, whose looks have the first indices.
    models: usize,
}

impl<'a> History<'a> {
    /// Returns all series of the history, for a reference including those at other times.
    pub fn all_series(&self) -> impl Iterator<Item = &'a TimeSeries> {
        std::iter::once(self.series).chain(self.further)
    }

    fn has_force(&self) -> bool {
        !self.series.contact_force_n.is_empty()
    }

    /// Returns times and values of a column, from the first of its series that has it.
    fn column(&self, name: &str) -> Option<(&'a [f64], &'a [f64])> {
        let mut all = self.all_series();
        all.find_map(|s| {
            Some((s.time_s.as_slice(), s.column(name)?)).filter(|(t, _)| !t.is_empty())
        })
    }
}

impl<'a> Histories<'a> {
    pub fn of(view: &View<'a>) -> Option<Self> {
        let reference = view.reference();
        let is_copy = |id: &str| view.results.runs.iter().any(|run| is_run(id, run));
        let mut curves: Vec<History<'a>> = (reference.iter())
            .map(|r| History {
                label: view.reference_name(&r.id),
                is_copy: is_copy(&r.id),
                series: &r.series,
                further: &r.further,
                stroke: reference_stroke(),
                style: None,
            })
            .collect();
        // Further references are thin lines, in addition to the one that runs are compared with.
        let others = (view.results.references.iter())
            .filter(|r| !r.series.is_empty() && reference.is_some_and(|m| m.id != r.id));
        let plain = curves.len();
        curves.extend(others.map(|r| History {
            label: view.reference_name(&r.id),
            is_copy: is_copy(&r.id),
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
            runs.push(DrawnRun {
                run,
                history: curves.len(),
            });
            curves.push(History {
                label,
                is_copy: false,
                series,
                further: &[],
                stroke: model_stroke(group.style),
                style: Some(group.style),
            });
        }
        let with_meshes = view.results.runs.iter().map(|r| &r.mesh_forces);
        let forces = with_meshes.max_by_key(|m| m.len());
        let meshes: Vec<[String; 2]> = (forces.into_iter().flatten())
            .map(|m| m.gears.clone())
            .collect();
        let all: Vec<&TimeSeries> = curves.iter().map(|c| c.series).collect();
        // A reference may have no force.
        let busiest = curves.iter().find(|c| c.has_force());
        let zoom = busy_window(busiest.map_or(*all.first()?, |c| c.series)).map(time_axis);
        let mut found = Self {
            reference,
            runs,
            curves,
            time: time_axis((0.0, 1.0)),
            zoom,
            meshes,
            models: view.groups.len(),
        };
        found.time = time_axis(contact_window(&found.forces()));
        Some(found)
    }

    /// Returns times and contact forces of all histories: of the first mesh, and of further meshes where panels show
    /// them.
    fn forces(&self) -> Vec<(&'a [f64], &'a [f64])> {
        let meshes = self.meshes_with("contact_force", "_n");
        let shown = match overlay(meshes.len()) {
            true => meshes.len(),
            false => 1,
        };
        let columns = || meshes.iter().take(shown);
        let of = |c: &History<'a>| {
            let series = c.series;
            let force =
                |m: &MemberColumn| Some((series.time_s.as_slice(), series.column(&m.column)?));
            columns().filter_map(force).collect::<Vec<_>>()
        };
        self.curves.iter().flat_map(of).collect()
    }

    /// Returns the meshes of the scene with the columns of a quantity, whose names consist of a beginning and an
    /// ending.
    pub fn meshes_with(&self, begin: &str, end: &str) -> Vec<MemberColumn> {
        let first = MemberColumn {
            name: String::new(),
            column: format!("{begin}{end}"),
            style: self.models,
        };
        if self.meshes.is_empty() {
            return vec![first];
        }
        let member = |(m, [a, b]): (usize, &[String; 2])| MemberColumn {
            name: format!("{a} - {b}"),
            column: mesh_column(begin, end, (m > 0).then_some([a.as_str(), b.as_str()])),
            style: self.models + m,
        };
        self.meshes.iter().enumerate().map(member).collect()
    }

    /// Returns the gears with columns of a quantity; the name of such a column begins with that of the quantity and
    /// ends with a unit.
    pub fn gears_with(&self, begin: &str, unit: &str) -> Vec<MemberColumn> {
        let first = self.models + self.meshes.len();
        let mut found: Vec<MemberColumn> = Vec::new();
        let all = self.curves.iter().flat_map(History::all_series);
        for (name, _) in all.flat_map(TimeSeries::named_columns) {
            let gear = name
                .strip_prefix(begin)
                .and_then(|n| n.strip_prefix('_')?.strip_suffix(unit)?.strip_suffix('_'));
            if let Some(gear) = gear.filter(|_| found.iter().all(|m| m.column != name)) {
                found.push(MemberColumn {
                    name: gear.to_owned(),
                    column: name.to_owned(),
                    style: first + found.len(),
                });
            }
        }
        found
    }

    /// Returns the number of models that have any of these columns.
    pub fn models_with(&self, members: &[MemberColumn]) -> usize {
        let has = |c: &&History<'_>| members.iter().any(|m| c.column(&m.column).is_some());
        self.curves
            .iter()
            .filter(|c| c.style.is_some())
            .filter(has)
            .count()
    }

    /// Returns least and greatest value of some columns, zero included.
    pub fn extremes(&self, members: &[MemberColumn]) -> (f64, f64) {
        let all = || {
            self.curves
                .iter()
                .flat_map(|c| members.iter().map(move |m| (c, m)))
        };
        let values = all()
            .filter_map(|(c, m)| c.column(&m.column))
            .flat_map(|(_, y)| y);
        extremes(values.copied().chain([0.0]))
    }

    /// Returns a panel for each history with the curves of all members in it.
    pub fn by_model(
        &self,
        members: &[MemberColumn],
        factor: f64,
        time: &TimeAxis,
        panel: &dyn Fn(&str) -> Panel,
    ) -> Vec<Panel> {
        let of = |c: &History<'a>| {
            let line = |m: &MemberColumn| {
                let look = (model_stroke(m.style), Some(m.style));
                Some(self.curve(look, c.column(&m.column)?, factor, time))
            };
            let curves: Vec<Curve> = members.iter().filter_map(line).collect();
            (!curves.is_empty()).then(|| panel(&c.label).curves(curves))
        };
        let own = self.curves.iter().filter(|c| !c.is_copy);
        own.filter_map(of).collect()
    }

    /// Returns a panel for each member with the curves of all histories in it.
    pub fn by_member(
        &self,
        members: &[MemberColumn],
        factor: f64,
        time: &TimeAxis,
        panel: &dyn Fn(&str) -> Panel,
    ) -> Vec<Panel> {
        let of = |m: &MemberColumn| {
            let curves = self.lines(|s| s.column(&m.column), factor, time);
            (!curves.is_empty()).then(|| panel(&m.name).curves(curves))
        };
        members.iter().filter_map(of).collect()
    }

    pub fn legend(&self) -> Vec<Entry> {
        let entry = |c: &History<'_>| Entry::history(&c.label, c.stroke, c.style);
        self.curves.iter().map(entry).collect()
    }

    fn peak(&self) -> f64 {
        peak_of(&self.forces())
    }

    /// Returns the curves of a column for all histories.
    pub fn lines(
        &self,
        column: impl Fn(&TimeSeries) -> Option<&[f64]>,
        factor: f64,
        time: &TimeAxis,
    ) -> Vec<Curve> {
        let line = |c: &History<'_>| {
            // A column that a reference does not have is no line at zero.
            let mut all = c.all_series().filter_map(|s| Some((s, column(s)?)));
            let (series, values) = all.find(|(_, values)| !values.is_empty())?;
            let look = (c.stroke, c.style);
            Some(self.curve(look, (&series.time_s, values), factor, time))
        };
        self.curves.iter().filter_map(line).collect()
    }

    /// Returns a curve with its look. Dense overviews have thin solid lines, in which dashes would not be visible.
    fn curve(
        &self,
        (stroke, style): (Stroke, Option<usize>),
        (t, values): (&[f64], &[f64]),
        factor: f64,
        time: &TimeAxis,
    ) -> Curve {
        let overview = self.zoom.is_some() && *time == self.time;
        let stroke = match overview {
            true => Stroke::new(stroke.ink, 0.9),
            false => stroke,
        };
        let (x, y) = (scaled(t, time.factor), scaled(values, factor));
        Curve::history(stroke, &time.axis, &x, &y).along(style.filter(|_| !overview))
    }
}

/// True if one panel shows all of so many meshes or gears.
pub(super) fn overlay(members: usize) -> bool {
    (2..=MOST_OVERLAID).contains(&members)
}

/// Returns the entries of a legend for members.
pub(super) fn legend_of(members: &[MemberColumn]) -> impl Iterator<Item = Entry> + '_ {
    let entry = |m: &MemberColumn| Entry::history(&m.name, model_stroke(m.style), Some(m.style));
    members.iter().map(entry)
}

/// True if a reference is a run of the record: its id is then the run's label, `model` or `model-variant`.
fn is_run(id: &str, run: &Run) -> bool {
    match &run.variant {
        None => run.model == id,
        Some(v) => id == v || id == format!("{}-{v}", run.model),
    }
}

fn scaled(values: &[f64], factor: f64) -> Vec<f64> {
    values.iter().map(|x| x * factor).collect()
}

/// Draws the contact force over time, and the deviations of the models from the reference.
pub fn force(view: &View<'_>) -> Result<Option<Chart>, DrawError> {
    let Some(h) = Histories::of(view) else {
        return Ok(None);
    };
    let unit = Prefix::of(h.peak(), 20.0);
    let y_name = format!("contact force [{}N]", unit.symbol);
    let meshes = h.meshes_with("contact_force", "_n");
    let overlaid = overlay(meshes.len());
    let top = Axis::from_zero(h.peak() * unit.factor);
    let together = |time: &TimeAxis, height: f64| Panel {
        x_name: Some(time.name.clone()),
        ..Panel::new(height, &time.axis, &y_name)
            .curves(h.lines(|s| Some(&s.contact_force_n), unit.factor, time))
            .close()
    };
    let by_model = |time: &TimeAxis, height: f64| {
        let panel = |of: &str| Panel {
            y: Some(top.clone()),
            ..Panel::new(height, &time.axis, &format!("force [{}N]", unit.symbol)).remark(of)
        };
        let mut panels = h.by_model(&meshes, unit.factor, time, &panel);
        if let Some(last) = panels.last_mut() {
            last.x_name = Some(time.name.clone());
        }
        panels
    };
    let mut caption =
        "Normal contact force of one run per model, the one with the least error.".to_owned();
    match (overlaid, meshes.first()) {
        (true, _) => caption.push_str(" Each panel has the meshes of one model."),
        (false, Some(first)) if meshes.len() > 1 => {
            caption.push_str(&format!(" It is that of the first mesh, {}.", first.name));
        }
        _ => {}
    }
    let mut panels = Vec::new();
    match (&h.zoom, overlaid) {
        (None, false) => panels.push(together(&h.time, 240.0)),
        (None, true) => panels.extend(by_model(&h.time, 150.0)),
        (Some(zoom), true) => {
            panels.extend(by_model(&h.time, 88.0));
            panels.extend(by_model(zoom, 150.0));
            caption.push_str(
                " Each model as a whole (drawn so that every peak stays), then around the highest peak.",
            );
        }
        (Some(zoom), false) => {
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
            panels.push(together(zoom, 200.0));
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
        let of = match meshes.len() {
            1 => "",
            _ => " of the first mesh",
        };
        caption.push_str(&format!(
            " Below: model minus reference{of}, each run shifted in time to its best fit; what stays \
             are the shape of the contact law and the ripples that only elastic bodies show.",
        ));
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
    let mut legend = Vec::new();
    if overlaid {
        legend.extend(legend_of(&meshes));
    }
    // Models have a line of their own only where panels show several.
    if !overlaid || h.reference.is_some_and(|r| with_force(&r)) {
        legend.extend(h.legend());
    }
    let title = "Contact force over time";
    chart("force.svg", title, caption, &legend, &panels).map(Some)
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

/// Ending of the names of further columns with the speed of a gear.
const SPEED: &str = "_rad_s";

/// Draws the speeds of all gears over time.
pub fn speeds(view: &View<'_>) -> Result<Option<Chart>, DrawError> {
    let Some(h) = Histories::of(view) else {
        return Ok(None);
    };
    let mut names: Vec<&str> = Vec::new();
    let all = h.curves.iter().flat_map(History::all_series);
    for (name, _) in all.flat_map(TimeSeries::named_columns) {
        if name.ends_with(SPEED) && !names.contains(&name) {
            names.push(name);
        }
    }
    // Gears that are held have no panel: their speed is rounding.
    let largest = |name: &str| {
        let all = h.curves.iter().flat_map(History::all_series);
        let values = all.filter_map(|s| s.column(name)).flatten();
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
        let symbol = name.strip_suffix(SPEED).unwrap_or(name);
        let symbol = symbol
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
                    .curves(h.lines(|s| s.column(name), 1.0, time))
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
