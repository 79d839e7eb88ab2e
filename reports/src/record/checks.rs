//! Rules that a record must satisfy to be saved, and the form in which it is saved.

use crate::record::{ContactSnapshot, FlankLoad, Results, Run, SCHEMA, Steady, Study, TorquePaths};
use crate::series::TimeSeries;

/// Checks every entry of a list; the error begins with the key and the place (from 0) of the entry.
pub(crate) fn each<T>(
    key: &str,
    all: &[T],
    check: impl Fn(&T) -> Result<(), String>,
) -> Result<(), String> {
    let mut places = all.iter().enumerate();
    places.try_for_each(|(i, one)| check(one).map_err(|e| format!("{key}[{i}].{e}")))
}

/// Checks that a list has as many entries as the list that it belongs to.
pub(crate) fn same_length(
    key: &str,
    found: usize,
    of: &str,
    expected: usize,
) -> Result<(), String> {
    if found == expected {
        return Ok(());
    }
    Err(format!(
        "{key} has {found} entries, expected {expected} as `{of}`"
    ))
}

impl Results {
    /// Checks the rules that the types do not enforce.
    ///
    /// # Errors
    /// A sentence that names the run or reference and the rule.
    pub fn validate(&self) -> Result<(), String> {
        let schema = self.header.schema;
        if schema != SCHEMA {
            return Err(format!("schema is {schema}, must be {SCHEMA}"));
        }
        self.part.validate()?;
        each(
            "measured",
            &self.measured,
            crate::measured::MeasuredCurve::validate,
        )?;
        each("mesh_modes", &self.mesh_modes, |m| {
            (m.motion.as_ref()).map_or(Ok(()), |motion| motion.validate())
        })?;
        for reference in &self.references {
            for series in reference.all_series() {
                (series.validate()).map_err(|e| format!("reference {}: {e}", reference.id))?;
            }
        }
        for (i, run) in self.runs.iter().enumerate() {
            let name = || format!("run {} ({}, {})", i + 1, run.model_label(), run.integrator);
            if run.model.is_empty() || run.integrator.is_empty() {
                return Err(format!("run {} lacks model or integrator", i + 1));
            }
            let of_run = |e: String| format!("{}: {e}", name());
            if let Some(series) = &run.series {
                (series.validate()).map_err(|e| of_run(format!("series: {e}")))?;
                // A reference may have other histories alone.
                if !series.is_empty() && series.most_loaded_mesh().is_none() {
                    return Err(of_run("series: no column has a contact force".into()));
                }
            }
            if let Some(steady) = &run.steady {
                steady
                    .validate()
                    .map_err(|e| of_run(format!("steady.{e}")))?;
            }
            if let Some(picture) = &run.contacts {
                picture
                    .validate()
                    .map_err(|e| of_run(format!("contacts.{e}")))?;
            }
            if let Some(motion) = &run.motion {
                motion
                    .validate()
                    .map_err(|e| of_run(format!("motion.{e}")))?;
            }
            for (k, m) in run.metrics.iter().enumerate() {
                if run.metrics[..k].iter().any(|o| o.against == m.against) {
                    return Err(format!("{}: two metrics against {}", name(), m.against));
                }
            }
        }
        self.validate_scenes()
    }

    /// Checks the records of further scenes: of the same study, with names of their own, without further scenes.
    fn validate_scenes(&self) -> Result<(), String> {
        let takes_several = [Study::Compare, Study::Sweep].contains(&self.study());
        if !self.further.is_empty() && !takes_several {
            return Err(format!(
                "further: the study `{}` has one scene",
                self.study_name()
            ));
        }
        let mut names = vec![self.header.scene.as_str()];
        for (i, results) in self.further.iter().enumerate() {
            let of_scene = |e: String| format!("further[{i}]: {e}");
            if results.study() != self.study() || !results.further.is_empty() {
                let what = "expected a record of the same study with one scene";
                return Err(of_scene(what.into()));
            }
            if names.contains(&results.header.scene.as_str()) {
                let name = &results.header.scene;
                return Err(of_scene(format!("two scenes have the name `{name}`")));
            }
            names.push(&results.header.scene);
            results.validate().map_err(of_scene)?;
        }
        Ok(())
    }

    /// Returns the record as it is saved: histories end before their first number that is not finite and have ten
    /// significant digits; points that are not finite are removed from the pictures.
    #[must_use]
    pub fn sanitised(&self) -> Self {
        // Whole histories have files of their own; they are never copied all at once.
        let mut clean = Self {
            runs: (self.runs.iter())
                .map(|r| Run {
                    histories: None,
                    ..r.clone()
                })
                .collect(),
            header: self.header.clone(),
            settings: self.settings.clone(),
            tolerance: self.tolerance.clone(),
            references: self.references.clone(),
            measured: self.measured.clone(),
            mesh_modes: self.mesh_modes.clone(),
            part: self.part.clone(),
            further: self.further.iter().map(Results::sanitised).collect(),
        };
        clean.tolerance = clean.tolerance.filter(|t| t.limit.is_finite());
        for reference in &mut clean.references {
            reference.series = ten_digits(&reference.series);
            reference.further = reference.further.iter().map(ten_digits).collect();
        }
        clean.part.keep_finite();
        for run in &mut clean.runs {
            run.paths = run.paths.take().filter(TorquePaths::is_finite);
            run.steady = run.steady.take().filter(Steady::is_finite);
            run.wall_spread_s = (run.wall_spread_s).filter(|s| s.iter().all(|x| x.is_finite()));
            run.series = run.series.as_ref().map(ten_digits);
            run.contacts = run.contacts.take().and_then(finite_picture);
        }
        clean
    }
}

fn ten_digits(series: &TimeSeries) -> TimeSeries {
    let mut s = series.finite_prefix();
    for x in s.all_values_mut().flatten() {
        *x = format!("{x:.9e}").parse().unwrap_or(*x);
    }
    s
}

fn finite_picture(mut picture: ContactSnapshot) -> Option<ContactSnapshot> {
    let finite = |p: &[f64; 2]| p[0].is_finite() && p[1].is_finite();
    for outline in &mut picture.outlines {
        outline.points.retain(finite);
    }
    picture
        .contacts
        .retain(|c| finite(&c.point) && finite(&c.force));
    picture.flanks.retain(FlankLoad::is_sound);
    (picture.deformed).retain(|d| d.points.iter().chain(&d.displacements).all(finite));
    picture.line_of_action = picture
        .line_of_action
        .filter(|l| finite(&l[0]) && finite(&l[1]));
    picture.time_s.is_finite().then_some(picture)
}
