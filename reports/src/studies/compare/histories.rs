//! Charts of contact force and angular velocities over time: one run per model, with the reference.
//!
//! A quantity with a history per mesh (or gear) has one of two layouts: a panel for each model with all meshes, or,
//! where a panel would have too many curves, a panel for each mesh with all models.

use super::FORCE_WIDTH;
use super::window::{TimeAxis, busy_window, contact_window, peak_of, time_axis};
use crate::drawing::Chart;
use crate::drawing::axis::Axis;
use crate::drawing::canvas::{DrawError, Ink, Stroke};
use crate::drawing::legend::Entry;
use crate::drawing::panel::{Curve, Panel, chart, chart_of_width, extremes};
use crate::drawing::style::{model_stroke, reference_stroke};
use crate::metrics::Metric;
use crate::numbers::{Prefix, per_cent, quantity};
use crate::record::{ReferenceSeries, Run};
use crate::series::{CONTACT_FORCE, Quantity, SPEED, TimeSeries, resample};
use crate::view::View;

/// A run that is drawn in a chart of histories.
struct DrawnRun<'a> {
    run: &'a Run,
    /// Label of its model.
    label: String,
    /// Index of its curve.
    history: usize,
    /// Index of its scene.
    scene: usize,
}

/// Largest number of meshes or gears whose curves share a panel; more cannot be distinguished.
const MOST_OVERLAID: usize = 4;

/// A mesh or a gear, and the column of a quantity of it.
pub(super) struct MemberColumn {
    /// Name of the mesh or gear; empty if the scene has one only.
    pub name: String,
    /// Names of the column; the only meshes of several scenes are one member, whatever the names of their gears.
    pub columns: Vec<String>,
    /// Index of its look, after those of all models.
    pub style: usize,
}

impl MemberColumn {
    /// Returns the values of the member in a series.
    pub fn of<'s>(&self, series: &'s TimeSeries) -> Option<&'s [f64]> {
        self.columns.iter().find_map(|name| series.column(name))
    }
}

/// A history with its look.
pub(super) struct History<'a> {
    pub label: String,
    /// True if it is a reference that is a run of the record.
    pub is_copy: bool,
    pub series: &'a TimeSeries,
    /// Histories of a reference at other times.
    pub further: &'a [TimeSeries],
    pub stroke: Stroke,
    /// Place of its model; none of a reference.
    pub style: Option<usize>,
    /// Index of its scene.
    pub scene: usize,
}

/// Curves, time axes and names that all charts of histories share.
pub(super) struct Histories<'a> {
    /// The reference of each scene, if it has one.
    references: Vec<Option<&'a ReferenceSeries>>,
    runs: Vec<DrawnRun<'a>>,
    /// Of each scene the reference first, then one run per model.
    pub curves: Vec<History<'a>>,
    pub time: TimeAxis,
    /// Short time interval for a close-up, if the whole history is too dense to read.
    pub zoom: Option<TimeAxis>,
    /// Meshes of the scene.
    meshes: Vec<Mesh>,
    /// Number of models, whose looks have the first indices.
    models: usize,
}

/// A mesh of the scene.
struct Mesh {
    /// Name in texts; empty if the scene has one only.
    name: String,
    /// Names of its gears as columns have them; of the only meshes of several scenes those of each.
    gears: Vec<String>,
}

impl<'a> History<'a> {
    /// Returns all series of the history, for a reference including those at other times.
    pub fn all_series(&self) -> impl Iterator<Item = &'a TimeSeries> {
        std::iter::once(self.series).chain(self.further)
    }

    fn has_force(&self) -> bool {
        !self.series.contact_force().is_empty()
    }

    /// Returns times and values of a member, from the first of its series that has its column.
    fn column(&self, member: &MemberColumn) -> Option<(&'a [f64], &'a [f64])> {
        let mut all = self.all_series();
        all.find_map(|s| Some((s.time_s.as_slice(), member.of(s)?)).filter(|(t, _)| !t.is_empty()))
    }
}

impl<'a> Histories<'a> {
    /// Returns the histories of one or several scenes; `None` without any.
    pub fn of(views: &[View<'a>]) -> Option<Self> {
        let mut found = Self {
            references: views.iter().map(View::reference).collect(),
            runs: Vec::new(),
            curves: Vec::new(),
            time: time_axis((0.0, 1.0)),
            zoom: None,
            meshes: Vec::new(),
            models: views.iter().map(|v| v.groups.len()).sum(),
        };
        let mut scenes = Vec::with_capacity(views.len());
        for view in views {
            let first = found.curves.len();
            found.add(view);
            scenes.push(subjects(&found.curves[first..], CONTACT_FORCE));
        }
        let runs = views.iter().flat_map(|v| &v.results.runs);
        found.meshes = meshes_of(scenes, runs);
        let all: Vec<&TimeSeries> = found.curves.iter().map(|c| c.series).collect();
        // A reference may have no force.
        let busiest = found.curves.iter().find(|c| c.has_force());
        found.zoom = busy_window(busiest.map_or(*all.first()?, |c| c.series)).map(time_axis);
        found.time = time_axis(contact_window(&found.forces()));
        Some(found)
    }

    /// Adds the curves of a scene: its references, then one run per model.
    fn add(&mut self, view: &View<'a>) {
        let reference = view.reference();
        let is_copy = |id: &str| view.results.runs.iter().any(|run| is_run(id, run));
        let of_reference = |r: &'a ReferenceSeries, stroke: Stroke| History {
            label: reference_label(view, r),
            is_copy: is_copy(&r.id),
            series: &r.series,
            further: &r.further,
            stroke,
            style: None,
            scene: view.place,
        };
        (self.curves).extend(reference.map(|r| of_reference(r, reference_stroke(view.place))));
        // Further references are thin lines, in addition to the one that runs are compared with.
        let others = (view.results.references.iter())
            .filter(|r| !r.series.is_empty() && reference.is_some_and(|m| m.id != r.id));
        let plain = self.curves.len();
        let thin = Stroke::dashed(Ink::GREY, 1.3, &[1.5, 2.0]);
        self.curves.extend(others.map(|r| of_reference(r, thin)));
        let further = self.curves.len() - plain;
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
            self.runs.push(DrawnRun {
                run,
                label: group.label.clone(),
                history: self.curves.len(),
                scene: view.place,
            });
            self.curves.push(History {
                label,
                is_copy: false,
                series,
                further: &[],
                stroke: model_stroke(group.style),
                style: Some(group.style),
                scene: view.place,
            });
        }
    }

    /// Returns times and contact forces of all meshes in all histories.
    fn forces(&self) -> Vec<(&'a [f64], &'a [f64])> {
        let of = |s: &'a TimeSeries| {
            s.all_of(CONTACT_FORCE)
                .map(|(_, f)| (s.time_s.as_slice(), f))
        };
        self.curves.iter().flat_map(|c| of(c.series)).collect()
    }

    /// Returns the meshes of the scene with the columns of a quantity.
    pub fn meshes_with(&self, quantity: Quantity) -> Vec<MemberColumn> {
        let member = |(m, mesh): (usize, &Mesh)| MemberColumn {
            name: mesh.name.clone(),
            columns: mesh.gears.iter().map(|gears| quantity.of(gears)).collect(),
            style: self.models + m,
        };
        self.meshes.iter().enumerate().map(member).collect()
    }

    /// Returns the gears with columns of a quantity, those of runs first.
    pub fn gears_with(&self, quantity: Quantity) -> Vec<MemberColumn> {
        // A single mesh has no curve with a look of its own.
        let meshes = Some(self.meshes.len()).filter(|n| *n > 1).unwrap_or(0);
        let first = self.models + meshes;
        let mut found: Vec<MemberColumn> = Vec::new();
        for gear in subjects(&self.curves, quantity) {
            found.push(MemberColumn {
                columns: vec![quantity.of(&gear)],
                name: gear,
                style: first + found.len(),
            });
        }
        found
    }

    /// Returns the name of a column without those of the gears of the mesh, for a scene with one mesh.
    pub fn without_only_mesh(&self, name: &str) -> String {
        match self.meshes.as_slice() {
            [only] => (only.gears.iter()).fold(name.to_owned(), |name, gears| {
                name.replace(&format!("_{gears}"), "")
            }),
            _ => name.to_owned(),
        }
    }

    /// Returns the number of models that have any of these columns.
    pub fn models_with(&self, members: &[MemberColumn]) -> usize {
        let has = |c: &&History<'_>| members.iter().any(|m| c.column(m).is_some());
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
        let values = all().filter_map(|(c, m)| c.column(m)).flat_map(|(_, y)| y);
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
                Some(self.curve(look, c.column(m)?, factor, time))
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
            let curves = self.lines(|s| m.of(s), factor, time);
            (!curves.is_empty()).then(|| panel(&m.name).curves(curves))
        };
        members.iter().filter_map(of).collect()
    }

    pub fn legend(&self) -> Vec<Entry> {
        let entry = |c: &History<'_>| Entry::history(&c.label, c.stroke, c.style);
        self.curves.iter().map(entry).collect()
    }

    /// Returns the reference of a scene, if it has the column of a member.
    fn reference_with(&self, member: &MemberColumn, scene: usize) -> Option<&'a ReferenceSeries> {
        let reference = *self.references.get(scene)?;
        reference.filter(|r| member.of(&r.series).is_some())
    }

    /// Returns the mesh of the largest time-aligned error of a run, else the first whose force a reference has.
    fn mesh_of_errors<'m>(&self, meshes: &'m [MemberColumn]) -> Option<&'m MemberColumn> {
        let known = |mesh: &&MemberColumn| {
            (0..self.references.len()).any(|k| self.reference_with(mesh, k).is_some())
        };
        let errors = self.runs.iter().filter_map(|d| {
            let reference = (*self.references.get(d.scene)?)?;
            let metrics = d.run.against(&reference.id)?;
            Some((
                metrics.force_l2_aligned?,
                metrics.mesh(Metric::ForceL2Aligned)?,
            ))
        });
        let worst = errors.max_by(|a, b| a.0.total_cmp(&b.0));
        let column = worst.map(|(_, mesh)| CONTACT_FORCE.of(mesh));
        let of_error =
            |mesh: &&MemberColumn| column.as_ref().is_some_and(|c| mesh.columns.contains(c));
        let mut known = meshes.iter().filter(known);
        known.clone().find(of_error).or_else(|| known.next())
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

/// Returns the names of gears in the columns of a quantity, those of runs first.
fn subjects(curves: &[History<'_>], quantity: Quantity) -> Vec<String> {
    let (runs, references): (Vec<_>, Vec<_>) = curves.iter().partition(|c| c.style.is_some());
    let all = runs.into_iter().chain(references);
    let mut found: Vec<String> = Vec::new();
    for (gears, _) in all
        .flat_map(History::all_series)
        .flat_map(|s| s.all_of(quantity))
    {
        if found.iter().all(|known| known != gears) {
            found.push(gears.to_owned());
        }
    }
    found
}

/// Returns the meshes whose contact force some history has, from their gears in each scene. The records of their forces
/// have the names of both gears.
fn meshes_of<'r>(scenes: Vec<Vec<String>>, runs: impl Iterator<Item = &'r Run>) -> Vec<Mesh> {
    let has_one_each = scenes.iter().all(|gears| gears.len() <= 1);
    let mut gears: Vec<String> = Vec::new();
    for pair in scenes.into_iter().flatten() {
        if !gears.contains(&pair) {
            gears.push(pair);
        }
    }
    if has_one_each && !gears.is_empty() {
        let name = String::new();
        return vec![Mesh { name, gears }];
    }
    let pairs: Vec<&[String; 2]> = runs
        .flat_map(|r| &r.mesh_forces)
        .map(|m| &m.gears)
        .collect();
    let mesh = |gears: String| {
        let pair = pairs.iter().find(|pair| pair.join("_") == gears);
        Mesh {
            name: pair.map_or_else(|| gears.clone(), |pair| pair.join(" - ")),
            gears: vec![gears],
        }
    };
    gears.into_iter().map(mesh).collect()
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

/// Returns the name of a reference in legends; that of several scenes is without what it has in parentheses, since names of
/// scenes are in front.
fn reference_label(view: &View<'_>, reference: &ReferenceSeries) -> String {
    let name = view.reference_name(&reference.id);
    match view.scene {
        Some(_) => view.with_scene(name.split(" (").next().unwrap_or(&name)),
        None => name,
    }
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

/// Draws the contact force over time, and the deviations of the models from the reference of their scene.
pub fn force(views: &[View<'_>]) -> Result<Option<Chart>, DrawError> {
    let Some(h) = Histories::of(views) else {
        return Ok(None);
    };
    let unit = Prefix::of(h.peak(), 20.0);
    let y_name = format!("contact force [{}N]", unit.symbol);
    let meshes = h.meshes_with(CONTACT_FORCE);
    let Some(first) = meshes.first() else {
        return Ok(None);
    };
    let overlaid = overlay(meshes.len());
    let top = Axis::from_zero(h.peak() * unit.factor);
    let together = |time: &TimeAxis, height: f64| Panel {
        x_name: Some(time.name.clone()),
        ..Panel::new(height, &time.axis, &y_name)
            .curves(h.lines(|s| first.of(s), unit.factor, time))
            .close()
    };
    let of_meshes = |time: &TimeAxis, height: f64| {
        let panel = |of: &str| Panel {
            y: Some(top.clone()),
            ..Panel::new(height, &time.axis, &format!("force [{}N]", unit.symbol)).remark(of)
        };
        let mut panels = match overlaid {
            true => h.by_model(&meshes, unit.factor, time, &panel),
            false => h.by_member(&meshes, unit.factor, time, &panel),
        };
        if let Some(last) = panels.last_mut() {
            last.x_name = Some(time.name.clone());
        }
        panels
    };
    let mut caption =
        "Normal contact force of one run per model, the one with the least error.".to_owned();
    let several = meshes.len() > 1;
    let member = if overlaid { "model" } else { "mesh" };
    if several {
        let others = if overlaid { "meshes" } else { "models" };
        caption.push_str(&format!(" Each panel has the {others} of one {member}."));
    }
    let mut panels = Vec::new();
    match (&h.zoom, several) {
        (None, false) => panels.push(together(&h.time, 230.0)),
        (None, true) => panels.extend(of_meshes(&h.time, 150.0)),
        (Some(zoom), true) => {
            panels.extend(of_meshes(&h.time, 88.0));
            panels.extend(of_meshes(zoom, 150.0));
            caption.push_str(&format!(
                " Each {member} as a whole (drawn so that every peak stays), then around the highest peak.",
            ));
        }
        (Some(zoom), false) => {
            let lines = h.lines(|s| first.of(s), unit.factor, &h.time);
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
    let compared = h.mesh_of_errors(&meshes);
    if let Some(compared) = compared {
        let time = h.zoom.as_ref().unwrap_or(&h.time);
        panels.push(residual(&h, compared, time, unit));
        let of = match several {
            false => String::new(),
            true => format!(" of the mesh with the largest error, {}", compared.name),
        };
        caption.push_str(&format!(
            " Below: model minus reference{of}, each run shifted in time to its best fit; what stays \
             are the shape of the contact law and the ripples that only elastic bodies show.",
        ));
        let shifts: Vec<String> = (h.runs.iter())
            .filter_map(|d| {
                let reference = h.reference_with(compared, d.scene)?;
                let m = d.run.against(&reference.id)?;
                let (e, shift) = (m.force_l2_aligned?, m.time_shift_s.unwrap_or(0.0));
                Some(format!(
                    "{}, {} after a shift of {}",
                    d.label,
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
    if !overlaid || compared.is_some() {
        legend.extend(h.legend());
    }
    let title = "Contact force over time";
    chart_of_width(FORCE_WIDTH, "force.svg", title, caption, &legend, &panels).map(Some)
}

fn residual(h: &Histories<'_>, mesh: &MemberColumn, time: &TimeAxis, unit: Prefix) -> Panel {
    let force = |of: &'_ TimeSeries| mesh.of(of).unwrap_or_default().to_vec();
    let zero = Curve::line(
        Stroke::new(Ink::DARK.opacity(0.82), 1.6),
        vec![(time.axis.min, 0.0), (time.axis.max, 0.0)],
    );
    let mut buffer = Vec::new();
    let lines = h.runs.iter().filter_map(|d| {
        let reference = h.reference_with(mesh, d.scene)?;
        let (t, wanted) = (&reference.series.time_s, force(&reference.series));
        let shift = (d.run.against(&reference.id))
            .and_then(|m| m.time_shift_s)
            .unwrap_or(0.0);
        let curve = &h.curves[d.history];
        let own = curve.series;
        resample(&own.time_s, &force(own), t, shift, &mut buffer);
        let y: Vec<f64> = (buffer.iter().zip(&wanted))
            .map(|(f, r)| (f - r) * unit.factor)
            .collect();
        let x = scaled(t, time.factor);
        Some(Curve::history(curve.stroke, &time.axis, &x, &y).along(curve.style))
    });
    let name = format!("model \u{2212} ref. [{}N]", unit.symbol);
    Panel {
        x_name: Some(time.name.clone()),
        ..Panel::new(120.0, &time.axis, &name)
            .remark("difference after time alignment")
            .curves(std::iter::once(zero).chain(lines))
            .close()
    }
}

/// Speed over the greatest of all gears below which a gear is at rest.
const AT_REST: f64 = 1e-9;
/// Longest name of a gear that has room next to the symbol of its speed [characters].
const LONGEST_NAME: usize = 10;

/// Draws the speeds of all gears over time.
pub fn speeds(views: &[View<'_>]) -> Result<Option<Chart>, DrawError> {
    let Some(h) = Histories::of(views) else {
        return Ok(None);
    };
    let gears = h.gears_with(SPEED);
    // Gears that are held have no panel: their speed is rounding.
    let largest = |gear: &MemberColumn| {
        let all = h.curves.iter().flat_map(History::all_series);
        let values = all.filter_map(|s| gear.of(s)).flatten();
        values.fold(0.0_f64, |most, x| most.max(x.abs()))
    };
    let fastest = gears.iter().map(&largest).fold(0.0, f64::max);
    let moving: Vec<(usize, &MemberColumn)> = (gears.iter().enumerate())
        .filter(|(_, gear)| largest(gear) > AT_REST * fastest)
        .collect();
    let label = |i: usize, gear: &str| match gear.len() <= LONGEST_NAME {
        true => format!("\u{3c9}{} {gear} [rad/s]", i + 1),
        false => format!("\u{3c9}{} [rad/s]", i + 1),
    };
    let size = if h.zoom.is_some() { 130.0 } else { 160.0 };
    let mut panels = Vec::new();
    for time in std::iter::once(&h.time).chain(&h.zoom) {
        for (place, (i, gear)) in moving.iter().enumerate() {
            panels.push(Panel {
                x_name: (place + 1 == moving.len()).then(|| time.name.clone()),
                ..Panel::new(size, &time.axis, &label(*i, &gear.name))
                    .curves(h.lines(|s| gear.of(s), 1.0, time))
                    .close()
            });
        }
    }
    let zoomed = if h.zoom.is_some() {
        " The lower panels show the time around the highest peak of the force."
    } else {
        ""
    };
    let of: Vec<&str> = moving.iter().map(|(_, gear)| gear.name.as_str()).collect();
    let of = of.join(", ");
    let title = "Angular velocities of the gears";
    let caption = format!(
        "Angular velocities of {of}, counter-clockwise positive. Elastic bodies are shown by their momentum mean, angular \
         momentum over inertia, which is what a rigid body has; a rack by its speed over the pitch radius of its \
         mate.{zoomed}"
    );
    chart("speeds.svg", title, caption, &h.legend(), &panels).map(Some)
}
