//! Files of a study: `results.json`, CSV per history, charts and the page.
//!
//! The study writes the histories once, at full resolution ([`crate::histories`]). All other files are drawn from the
//! text of `results.json`, also when it was just made, so that [`report_from`] gives the same bytes at any later time
//! and does not touch the histories. A file is written completely or not at all: all files go to a staging folder first
//! and are then renamed.

use crate::csv_table::{CsvTable, number};
use crate::drawing::canvas::DrawError;
use crate::histories::ENDINGS;
use crate::markup::page;
use crate::record::{ReferenceSeries, Results, SCHEMA, former, slug};
use crate::series::TimeSeries;
use crate::studies::{Study, report};
use crate::view::View;
use serde::Serialize;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Name of the record in a study's folder.
pub const RECORD: &str = "results.json";
/// Name of the page in a study's folder.
pub const PAGE: &str = "index.html";

/// A report could not be written or read.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// A file or folder refused.
    #[error("{}: {source}", path.display())]
    Io {
        /// Path of the file or folder.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// A record does not conform to the format that this version reads.
    #[error("{}: {reason}", path.display())]
    Record {
        /// Path of the record.
        path: PathBuf,
        /// Reason, with line and column where there is one.
        reason: String,
    },
    /// A chart failed to be drawn.
    #[error(transparent)]
    Draw(#[from] DrawError),
}

/// Writes all files of a study into a folder, made if missing, and returns the path of the page.
///
/// Files of an earlier study in the same folder are replaced, and removed when they have no
/// successor; other files are left alone.
///
/// # Errors
/// [`ReportError`] when a file cannot be written or the record breaks its own rules.
pub fn write_results(dir: &Path, results: &Results) -> Result<PathBuf, ReportError> {
    let path = dir.join(RECORD);
    results.validate().map_err(|reason| ReportError::Record {
        path: path.clone(),
        reason,
    })?;
    let mut clean = results.sanitised();
    let mut all_histories = Vec::new();
    let prefixes = scene_prefixes(results);
    for ((one, runs), prefix) in results.scenes().zip(clean.runs_mut()).zip(&prefixes) {
        let histories = histories(one, prefix);
        for (i, run) in runs.iter_mut().enumerate() {
            let own = histories.iter().filter(|h| h.run == Some(i));
            run.files = own.map(|h| h.file.0.clone()).collect();
        }
        all_histories.extend(histories);
    }
    let text = to_json(&clean).map_err(|e| ReportError::Record {
        path: path.clone(),
        reason: e.to_string(),
    })?;
    let saved = parse(&text, &path)?;
    let mut files = vec![(RECORD.to_owned(), Content::Text(text))];
    files.extend(all_histories.into_iter().map(|h| h.file));
    files.extend(render(&saved)?);
    // What the record before made is drawn once more for its names; one that cannot be read made nothing known.
    let before: Vec<String> = load_results(&path).map_or_else(
        |_| Vec::new(),
        |old| {
            let drawn = render(&old).unwrap_or_default();
            let drawn = drawn.into_iter().map(|(name, _)| name);
            drawn.chain(history_names(&old)).collect()
        },
    );
    put(dir, &files)?;
    for name in before {
        if !files.iter().any(|(new, _)| *new == name) {
            // A file that is gone already is what is wanted.
            let _ = fs::remove_file(dir.join(name));
        }
    }
    Ok(dir.join(PAGE))
}

/// Draws charts, tables and page of a folder again from its `results.json` alone. The files of histories stay as the
/// study wrote them, since the record keeps only the thinned histories of charts.
///
/// # Errors
/// [`ReportError`] when the record cannot be read or a file cannot be written.
pub fn report_from(dir: &Path) -> Result<PathBuf, ReportError> {
    let results = load_results(dir)?;
    put(dir, &render(&results)?)?;
    Ok(dir.join(PAGE))
}

/// Reads the record of a folder, or the record at a path that ends in `.json`.
///
/// # Errors
/// [`ReportError`] with line and column when it is not a record of a schema this version reads.
pub fn load_results(path: &Path) -> Result<Results, ReportError> {
    let file = if path.extension().is_some_and(|e| e == "json") {
        path.to_owned()
    } else {
        path.join(RECORD)
    };
    let text = fs::read_to_string(&file).map_err(|source| ReportError::Io {
        path: file.clone(),
        source,
    })?;
    parse(&text, &file)
}

fn parse(text: &str, path: &Path) -> Result<Results, ReportError> {
    #[derive(serde::Deserialize)]
    #[serde(expecting = "a record with `schema`")]
    struct Version {
        schema: u32,
        #[serde(default)]
        study: Option<String>,
    }
    let refuse = |reason: String| ReportError::Record {
        path: path.to_owned(),
        reason,
    };
    // The schema first: a record of another one may not parse at all.
    let broken = |e: serde_json::Error| {
        refuse(format!(
            "no record of gearbench, or one that was cut off: {e}"
        ))
    };
    let version: Version = serde_json::from_str(text).map_err(broken)?;
    if !(former::SCHEMA..=SCHEMA).contains(&version.schema) {
        return Err(refuse(format!(
            "the record has schema {}, this version reads schemas {} to {SCHEMA}",
            version.schema,
            former::SCHEMA
        )));
    }
    if let Some(study) = version
        .study
        .filter(|name| !former::STUDIES.contains(&name.as_str()))
    {
        study.parse::<Study>().map_err(refuse)?;
    }
    let upgraded = former::upgrade(text).map_err(|e| refuse(e.to_string()))?;
    let mut results: Results = match upgraded {
        Some(results) => results,
        None => serde_json::from_str(text).map_err(|e| refuse(e.to_string()))?,
    };
    results.header.schema = SCHEMA;
    results
        .further
        .iter_mut()
        .for_each(|r| r.header.schema = SCHEMA);
    results.validate().map_err(refuse)?;
    Ok(results)
}

/// Content of a file. Histories are written one by one and are never all in memory.
enum Content<'a> {
    Text(String),
    Table(Box<dyn Fn() -> CsvTable + 'a>),
}

type File<'a> = (String, Content<'a>);

fn render(results: &Results) -> Result<Vec<File<'static>>, ReportError> {
    let report = report(results)?;
    let tables = report.csv.iter().map(|t| (t.file.clone(), t.text()));
    let charts = report.all_charts().map(|c| (c.file.clone(), c.svg.clone()));
    let texts = report.texts.iter().cloned();
    Ok(tables
        .chain(charts)
        .chain(texts)
        .chain([(PAGE.to_owned(), page(results, &report))])
        .map(|(name, text)| (name, Content::Text(text)))
        .collect())
}

/// A file of histories, with the place of the run that it belongs to; none of a reference.
struct HistoryFile<'a> {
    run: Option<usize>,
    file: File<'a>,
}

/// Returns the runs whose histories have files. For a comparison this is the most accurate run of each model: files of
/// all runs would be hundreds that differ by integration errors alone.
fn runs_with_files(results: &Results) -> Vec<usize> {
    if results.study() != Study::Compare {
        return (0..results.runs.len()).collect();
    }
    let view = View::new(results);
    let kept = view.groups.iter().filter_map(|g| view.stored_run(g));
    kept.map(|(i, _)| *i).collect()
}

/// Returns the histories of references, and those of runs: at full resolution where the study has them, else as in the
/// record.
fn histories<'a>(results: &'a Results, prefix: &str) -> Vec<HistoryFile<'a>> {
    let mut files: Vec<HistoryFile<'a>> = Vec::new();
    let mut add = |run: Option<usize>, name: String, table: Box<dyn Fn() -> CsvTable + 'a>| {
        let file = (format!("{prefix}{name}"), Content::Table(table));
        files.push(HistoryFile { run, file });
    };
    for (i, r) in results.references.iter().enumerate() {
        for (k, series) in r.all_series().into_iter().enumerate() {
            add(
                None,
                reference_name(i, r, k),
                Box::new(|| series_table(&series.finite_prefix())),
            );
        }
    }
    let kept = runs_with_files(results);
    let runs = results.runs.iter().enumerate();
    for (i, r) in runs.filter(|(i, _)| kept.contains(i)) {
        let stem = r.file_stem(i);
        match (&r.histories, &r.series) {
            (Some(whole), kept) => {
                for (k, ending) in ENDINGS.into_iter().enumerate() {
                    let table = move || whole.table(k, kept.as_ref());
                    add(Some(i), format!("{stem}{ending}"), Box::new(table));
                }
            }
            (None, Some(series)) => {
                add(
                    Some(i),
                    format!("{stem}.csv"),
                    Box::new(|| series_table(&series.finite_prefix())),
                );
            }
            (None, None) => {}
        }
    }
    files
}

/// Returns the beginnings of the names of files of histories of each scene: nothing for one scene, the name of the scene
/// for several. Names that differ in punctuation alone are numbered.
fn scene_prefixes(results: &Results) -> Vec<String> {
    if results.further.is_empty() {
        return vec![String::new()];
    }
    let mut prefixes: Vec<String> = Vec::new();
    for scene in results.scenes().map(|r| &r.header.scene) {
        let name = slug(scene);
        let further = (2..).map(|k| format!("{name}{k}-"));
        let mut free = std::iter::once(format!("{name}-")).chain(further);
        prefixes.extend(free.find(|p| !prefixes.contains(p)));
    }
    prefixes
}

/// Returns the names of all files of histories that a record can have.
fn history_names(results: &Results) -> Vec<String> {
    let scenes = results.scenes().zip(scene_prefixes(results));
    scenes
        .flat_map(|(one, prefix)| names_of_scene(one).map(move |name| format!("{prefix}{name}")))
        .collect()
}

fn names_of_scene(results: &Results) -> impl Iterator<Item = String> {
    let references = results.references.iter().enumerate();
    let runs = results
        .runs
        .iter()
        .enumerate()
        .filter(|(_, r)| r.series.is_some());
    references
        .flat_map(|(i, r)| (0..=r.further.len()).map(move |k| reference_name(i, r, k)))
        .chain(runs.flat_map(|(i, r)| ENDINGS.map(|ending| format!("{}{ending}", r.file_stem(i)))))
}

/// Returns the name of the file of a reference, and of its histories at other times.
fn reference_name(i: usize, reference: &ReferenceSeries, k: usize) -> String {
    let more = match k {
        0 => String::new(),
        k => format!("-{}", k + 1),
    };
    format!("reference{:02}-{}{more}.csv", i + 1, slug(&reference.id))
}

fn series_table(series: &TimeSeries) -> CsvTable {
    let columns: Vec<&[f64]> = std::iter::once(&series.time_s)
        .chain(series.columns.iter().map(|c| &c.values))
        .map(Vec::as_slice)
        .collect();
    let names = series.columns.iter().map(|c| c.name.as_str());
    let row = |i: usize| columns.iter().map(|c| number(c.get(i).copied())).collect();
    CsvTable {
        file: String::new(),
        header: std::iter::once("time_s")
            .chain(names)
            .map(Into::into)
            .collect(),
        rows: (0..series.len()).map(row).collect(),
    }
}

/// Writes files to a staging folder and renames them into place, the page last.
fn put(dir: &Path, files: &[File<'_>]) -> Result<(), ReportError> {
    let io = |path: &Path| {
        let path = path.to_owned();
        move |source| ReportError::Io { path, source }
    };
    fs::create_dir_all(dir).map_err(io(dir))?;
    let staging = dir.join(format!(".staging-{}", std::process::id()));
    fs::create_dir_all(&staging).map_err(io(&staging))?;
    let work = || {
        for (name, content) in files {
            let path = staging.join(name);
            match content {
                Content::Text(text) => fs::write(&path, text),
                Content::Table(table) => fs::write(&path, table().text()),
            }
            .map_err(io(&path))?;
        }
        for (name, _) in files {
            let path = dir.join(name);
            fs::rename(staging.join(name), &path).map_err(io(&path))?;
        }
        Ok(())
    };
    let result = work();
    // Left-overs of a failure are no result; that they cannot be removed is not the reader's news.
    let _ = fs::remove_dir_all(&staging);
    result
}

/// Formats a record as JSON, with objects on several lines and arrays of numbers on one.
fn to_json(results: &Results) -> serde_json::Result<String> {
    let mut bytes = Vec::new();
    let mut serializer = serde_json::Serializer::with_formatter(&mut bytes, Layout { depth: 0 });
    results.serialize(&mut serializer)?;
    bytes.push(b'\n');
    Ok(String::from_utf8(bytes).unwrap_or_default())
}

struct Layout {
    depth: usize,
}

impl Layout {
    fn line<W: ?Sized + io::Write>(&self, out: &mut W) -> io::Result<()> {
        out.write_all(b"\n")?;
        for _ in 0..self.depth {
            out.write_all(b" ")?;
        }
        Ok(())
    }
}

impl serde_json::ser::Formatter for Layout {
    fn begin_object<W: ?Sized + io::Write>(&mut self, out: &mut W) -> io::Result<()> {
        self.depth += 1;
        out.write_all(b"{")
    }
    fn end_object<W: ?Sized + io::Write>(&mut self, out: &mut W) -> io::Result<()> {
        self.depth -= 1;
        self.line(out)?;
        out.write_all(b"}")
    }
    fn begin_object_key<W: ?Sized + io::Write>(
        &mut self,
        out: &mut W,
        first: bool,
    ) -> io::Result<()> {
        if !first {
            out.write_all(b",")?;
        }
        self.line(out)
    }
    fn begin_object_value<W: ?Sized + io::Write>(&mut self, out: &mut W) -> io::Result<()> {
        out.write_all(b": ")
    }
}
