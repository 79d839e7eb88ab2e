//! The studies that write a record, one module each: the specific part of the record, and its page, charts and CSV
//! tables.
//!
//! A new study needs a module and its lines in [`Study`], [`Part`] and [`report`] below.

pub mod check;
pub mod choose;
pub mod compare;
pub mod identify;
mod mesh_modes;
pub mod modes;
mod moving_modes;
pub mod response;
pub mod run_up;
pub mod runs;
pub mod scan;
pub(crate) mod solid;
pub mod stability;
pub mod stiffness;
pub mod sweep;
pub mod tabular;

use crate::columns::FileDescription;
use crate::csv_table::CsvTable;
use crate::drawing::Chart;
use crate::drawing::canvas::DrawError;
use crate::markup::gears::Viewer;
use crate::measured;
use crate::record::Results;
use crate::record::checks::each;
use crate::view::View;
use crate::words::words;
use maud::Markup;
use serde::{Deserialize, Serialize};

words! {
    /// The study that made a record.
    pub enum Study {
        /// Comparison of all models and integrators of a scene with its references.
        #[default]
        Compare = "compare",
        /// Maps of where integrators fail over step and parameters.
        Stability = "stability",
        /// The cheapest adequate model, integrator and step.
        Choose = "choose",
        /// Results, work and runtime against a stored baseline.
        Check = "check",
        /// Running under load at speed after speed.
        Sweep = "sweep",
        /// Constants of models fitted to references.
        Identify = "identify",
        /// Natural frequencies about the loaded state.
        Modes = "modes",
        /// Frequency response to the passing of teeth.
        Response = "response",
        /// Spectra and orders over the speed of a run-up.
        RunUp = "run-up",
        /// Static mesh stiffness, load sharing and transmission error over a mesh cycle.
        Stiffness = "stiffness",
        /// Many scenes: keys varied at once, statistics and sensitivity.
        Scan = "scan",
        /// A study whose results are one table, under a name of its own.
        Tabular = "tabular",
    }
}

/// The part of a record that is specific to its study, next to header, references and runs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(tag = "study", rename_all = "kebab-case")]
pub enum Part {
    /// Part of a record of [`Study::Compare`].
    Compare(compare::CompareRecord),
    /// Part of a record of [`Study::Stability`].
    Stability(stability::StabilityRecord),
    /// Part of a record of [`Study::Choose`].
    Choose(Box<choose::ChooseRecord>),
    /// Part of a record of [`Study::Check`].
    Check(check::CheckRecord),
    /// Part of a record of [`Study::Sweep`].
    Sweep(sweep::SweepRecord),
    /// Part of a record of [`Study::Identify`].
    Identify(identify::IdentifyRecord),
    /// Part of a record of [`Study::Modes`].
    Modes(modes::ModesRecord),
    /// Part of a record of [`Study::Response`].
    Response(response::ResponseRecord),
    /// Part of a record of [`Study::RunUp`].
    RunUp(run_up::RunUpRecord),
    /// Part of a record of [`Study::Stiffness`].
    Stiffness(stiffness::StiffnessRecord),
    /// Part of a record of [`Study::Scan`].
    Scan(Box<scan::ScanRecord>),
    /// Part of a record of [`Study::Tabular`].
    Tabular(tabular::TabularRecord),
}

impl Default for Part {
    fn default() -> Self {
        Part::Compare(compare::CompareRecord::default())
    }
}

impl Part {
    /// Returns the study that the part belongs to.
    pub fn study(&self) -> Study {
        match self {
            Part::Compare(_) => Study::Compare,
            Part::Stability(_) => Study::Stability,
            Part::Choose(_) => Study::Choose,
            Part::Check(_) => Study::Check,
            Part::Sweep(_) => Study::Sweep,
            Part::Identify(_) => Study::Identify,
            Part::Modes(_) => Study::Modes,
            Part::Response(_) => Study::Response,
            Part::RunUp(_) => Study::RunUp,
            Part::Stiffness(_) => Study::Stiffness,
            Part::Scan(_) => Study::Scan,
            Part::Tabular(_) => Study::Tabular,
        }
    }

    /// Checks the rules that the types do not enforce.
    pub(crate) fn validate(&self) -> Result<(), String> {
        match self {
            Part::Choose(part) => part.choice.validate(),
            Part::Stability(part) => each("maps", &part.maps, stability::Map::validate),
            Part::RunUp(part) => each("run_ups", &part.run_ups, run_up::ModelRunUp::validate),
            Part::Modes(part) => each("vibrations", &part.vibrations, modes::ModelModes::validate),
            Part::Response(part) => each(
                "responses",
                &part.responses,
                response::ModelResponse::validate,
            ),
            Part::Sweep(part) => each("statics", &part.statics, sweep::StaticCycle::validate),
            Part::Stiffness(part) => each(
                "stiffness",
                &part.stiffness,
                stiffness::ModelStiffness::validate,
            ),
            Part::Scan(part) => part.validate(),
            Part::Tabular(part) => part.validate(),
            Part::Identify(part) => {
                each("fits", &part.fits, identify::FitRecord::validate)?;
                each("histories", &part.histories, |h| h.series.validate())
            }
            Part::Compare(_) | Part::Check(_) => Ok(()),
        }
    }

    /// Removes all numbers that are not finite.
    pub(crate) fn keep_finite(&mut self) {
        match self {
            Part::Sweep(part) => part.statics.retain(sweep::StaticCycle::is_finite),
            Part::Scan(part) => part.keep_finite(),
            Part::Tabular(part) => part.keep_finite(),
            Part::Identify(part) => {
                (part.fits.iter_mut()).for_each(identify::FitRecord::keep_finite);
            }
            _ => {}
        }
    }
}

/// Returns the descriptions of the tables of all studies.
#[rustfmt::skip]
pub(crate) fn files() -> Vec<FileDescription> {
    let [n, gear, id] = ["N", "GEAR", "ID"].map(|word| [word.to_owned()]);
    vec![
        runs::columns(&gear, &n, &id).described(),
        mesh_modes::columns().described(),
        compare::meshes::columns("").described(),
        compare::paths::meshes().described(),
        compare::paths::members().described(),
        compare::paths::shafts().described(),
        compare::paths::load_sharing().described(),
        stability::csv::cells().described(),
        stability::csv::limits().described(),
        stability::csv::times_of_runs().described(),
        choose::csv::candidates().described(),
        choose::csv::levels().described(),
        check::files::columns().described(),
        identify::csv::parameters().described(),
        identify::csv::fitted().described(),
        identify::csv::residuals().described(),
        identify::csv::profiles().described(),
        identify::csv::histories(&[]).described(),
        modes::csv::frequencies().described(),
        modes::csv::energies().described(),
        modes::csv::shapes().described(),
        response::csv::meshes(&n).described(),
        response::csv::mounts(&n).described(),
        response::csv::limits(&n).described(),
        sweep::csv::speeds(&n, &gear).described(),
        sweep::csv::cycles().described(),
        sweep::csv::orders().described(),
        sweep::csv::statics().described(),
        run_up::csv::orders(&run_up::csv::PLACEHOLDERS).described(),
        run_up::csv::spectra(&run_up::csv::PLACEHOLDERS).described(),
        run_up::csv::order_spectra(&run_up::csv::PLACEHOLDERS).described(),
        scan::csv::cells(),
        scan::csv::times_of_cells(),
        scan::csv::statistics().described(),
        scan::csv::indices().described(),
        stiffness::csv::models().described(),
        stiffness::csv::cycle(&n, 0, true).described(),
    ]
}

/// Returns the report of a record. It has a branch for every study.
///
/// # Errors
/// [`DrawError`] when the drawing backend refuses.
pub fn report(results: &Results) -> Result<StudyReport, DrawError> {
    let mut report = of_part(results)?;
    let views = View::of_scenes(results);
    report.tables = maud::html! {
        (report.tables)
        @for view in &views { (of_scene(view, &mesh_modes::tables(&view.results.mesh_modes))) }
    };
    let modes = |v: &View<'_>| mesh_modes::csv(&v.results.mesh_modes).into_iter().collect();
    report.csv.extend(CsvTable::of_scenes(
        views.iter().map(|v| (v.scene, modes(v))),
    ));
    if report.viewer.is_none()
        && let Some((still, viewer)) = moving_modes::of_mesh_modes(&results.mesh_modes)?
    {
        report.charts.push(still);
        report.viewer = Some(viewer);
    }
    let (measured, charts) = measured::report(&results.measured, &report.csv)?;
    report.tables = maud::html! { (report.tables) (measured) };
    report.charts.extend(charts);
    // A study without a choice of its own has its first chart on the first screen.
    if report.first.is_empty() && !report.charts.is_empty() {
        report.first.push(report.charts.remove(0));
    }
    report.distinguish_files();
    Ok(report)
}

/// Returns the finding of a record of one scene, or of the first of several, as sentences without markup, for a terminal.
///
/// # Errors
/// [`DrawError`] when the drawing backend refuses.
pub fn finding(results: &Results) -> Result<Vec<String>, DrawError> {
    let report = of_views(&[View::new(results)])?;
    Ok(report.finding.iter().map(crate::markup::text).collect())
}

/// Returns the errors of a record's results against its measured curves, a line each.
///
/// # Errors
/// [`DrawError`] when the drawing backend refuses.
pub fn measured_lines(results: &Results) -> Result<Vec<String>, DrawError> {
    if results.measured.is_empty() {
        return Ok(Vec::new());
    }
    Ok(measured::lines(&results.measured, &of_part(results)?.csv))
}

/// Returns the report of the part that is specific to the study, without mesh modes, measured curves and `runs.csv`.
fn of_part(results: &Results) -> Result<StudyReport, DrawError> {
    of_views(&View::of_scenes(results))
}

/// Returns the same report of the scenes of a record.
fn of_views(views: &[View<'_>]) -> Result<StudyReport, DrawError> {
    let view = &views[0];
    let results = view.results;
    let mut report = match &results.part {
        Part::Compare(_) => compare::report(views),
        Part::Stability(part) => stability::report(part),
        Part::Choose(part) => choose::report(&part.choice),
        Part::Check(part) => check::report(part),
        Part::Sweep(_) => sweep::report(views),
        Part::Identify(part) => identify::report(part),
        Part::Modes(part) => modes::report(&part.vibrations),
        Part::Response(part) => response::report(&part.responses),
        Part::RunUp(part) => run_up::report(view, &part.run_ups),
        Part::Stiffness(part) => stiffness::report(&part.stiffness),
        Part::Scan(part) => scan::report(part),
        Part::Tabular(part) => tabular::report(view, part),
    }?;
    let csv = std::mem::take(&mut report.csv);
    let tables = views.iter().map(|view| {
        let mut own = match &view.results.part {
            Part::Compare(_) => compare::csv(view),
            Part::Sweep(part) => sweep::csv::tables(view.results, &part.statics),
            // Studies of one scene.
            _ => csv.clone(),
        };
        own.extend(runs::of_study(view.results, &own));
        (view.scene, own)
    });
    report.csv = CsvTable::of_scenes(tables);
    Ok(report)
}

/// Returns the sentences of one or several scenes. Of several, the first has the answers of all; `of` returns the
/// sentences of a scene with the index of the answer.
fn findings(
    views: &[View<'_>],
    of: impl Fn(&View<'_>) -> (Vec<Markup>, usize),
) -> (Vec<Markup>, usize) {
    if let [only] = views {
        return of(only);
    }
    let (mut answers, mut others) = (Vec::new(), Vec::new());
    for view in views {
        // Below the name of their scene, models need no name of it.
        let (mut sentences, answer) = of(&View::new(view.results));
        let name = view.scene.unwrap_or_default();
        if answer < sentences.len() {
            answers.push((name, sentences.remove(answer)));
        }
        others.push((name, crate::markup::sentences(&sentences)));
    }
    let by_scene = |all: &[(&str, Markup)]| {
        maud::html! {
            @for (i, (name, said)) in all.iter().filter(|s| !s.1.0.is_empty()).enumerate() {
                @if i > 0 { " " br; }
                b { (name) } ": " (said)
            }
        }
    };
    (vec![by_scene(&answers), by_scene(&others)], 0)
}

/// Renders the sections of a scene, under its name if the page has several.
pub(crate) fn of_scene(view: &View<'_>, sections: &Markup) -> Markup {
    match view.scene.filter(|_| !sections.0.is_empty()) {
        Some(scene) => maud::html! { div.scene { p.scene { "Scene " b { (scene) } } (sections) } },
        None => sections.clone(),
    }
}

/// The report of a study: everything that page, charts and CSV files are written from.
#[derive(Clone, Debug, Default)]
pub struct StudyReport {
    /// The finding in plain words: at most four sentences.
    pub finding: Vec<Markup>,
    /// Index of the sentence with the answer, which the page shows above the others.
    pub answer: usize,
    /// Charts of the first screen, next to each other below the finding: those that the study names, else its first.
    pub first: Vec<Chart>,
    /// Sections above the other charts.
    pub tables: Markup,
    /// The other charts, in the order of the page.
    pub charts: Vec<Chart>,
    /// Moving gears, which the page shows in place of one of the charts where it runs scripts.
    pub viewer: Option<Viewer>,
    /// Sections below the charts.
    pub details: Markup,
    /// Tables in files of their own.
    pub csv: Vec<CsvTable>,
    /// Texts in files of their own, for other programs: name and content.
    pub texts: Vec<(String, String)>,
}

impl StudyReport {
    /// Returns all charts in the order of the page.
    pub fn all_charts(&self) -> impl Iterator<Item = &Chart> {
        self.first.iter().chain(&self.charts)
    }

    /// Makes all file names unique. Names of gears and labels of models that differ in punctuation alone give the same
    /// file name, and so do entries of an edited record.
    fn distinguish_files(&mut self) {
        let charts = self.first.iter_mut().chain(&mut self.charts);
        let charts = charts.map(|c| &mut c.file);
        let tables = self.csv.iter_mut().map(|t| &mut t.file);
        let texts = self.texts.iter_mut().map(|(name, _)| name);
        let mut known = std::collections::BTreeSet::new();
        for name in charts.chain(tables).chain(texts) {
            let (stem, ending) = name.rsplit_once('.').unwrap_or((name, ""));
            let further = (2..).map(|k| format!("{stem}_{k}.{ending}"));
            let free = std::iter::once(name.clone()).chain(further);
            let mut free = free.skip_while(|n| known.contains(n));
            if let Some(free) = free.next() {
                known.insert(free.clone());
                *name = free;
            }
        }
    }
}

impl std::str::FromStr for Study {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if let Some(study) = Self::ALL.into_iter().find(|s| s.as_str() == text) {
            return Ok(study);
        }
        let all = Self::ALL.map(Self::as_str).join(", ");
        Err(format!(
            "there is no study `{text}`; this version knows {all}"
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_lead_back() {
        for s in Study::ALL {
            assert_eq!(s.as_str().parse(), Ok(s));
        }
        assert!("mode".parse::<Study>().unwrap_err().contains("compare"));
    }
}
