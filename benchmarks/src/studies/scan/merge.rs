//! `gearbench merge FOLDER...`: joins the parts of a scan.

use super::arguments::{Merge, Scan};
use super::command::finish;
use super::results::summarise_table;
use super::table::{TableWriter, header};
use crate::cli::command_result::CommandResult;
use crate::cli::files::is_same;
use crate::cli::study_folder::StudyFolder;
use crate::cli::terminal::Refusal;
use crate::context::Context;
use gearbench_reports::record::{Part, Results};
use gearbench_reports::scan::{ScanRecord, Shard};
use gearbench_reports::{Study, load_results};
use std::path::{Path, PathBuf};

/// A part of a scan with its folder.
struct PartOfScan {
    folder: PathBuf,
    shard: Shard,
}

/// Most numbers of missing parts that a refusal lists.
const MOST_LISTED: usize = 12;

/// Joins parts and writes the folder of the whole scan.
pub fn run(context: &Context, args: &Merge) -> Result<CommandResult, Refusal> {
    let (mut results, parts) = read(&args.parts)?;
    let scan = results.scan().cloned().unwrap_or_default();
    let whole = whole_command(&results.header.command)?;
    let design = (whole.1.design()).map_err(|e| {
        refuse(
            &args.parts[0],
            &format!("its command is not that of a scan: {e}"),
            REPEAT,
        )
    })?;
    results.header.command = whole.0;
    let folder =
        StudyFolder::joining(context, &args.output, &results.header, Study::Scan.as_str())?;
    if let Some(own) = parts.iter().find(|p| is_same(&p.folder, folder.path())) {
        return Err(refuse(
            &own.folder,
            "the folder is a part of the scan",
            "name another folder with --out",
        ));
    }
    let mut writer = TableWriter::begin(folder.path(), &header(&design, &scan.outputs))?;
    let runs = scan.configurations.len() as u64;
    for part in &parts {
        let cells = [part.shard.first, part.shard.last];
        (writer.append(&part.folder, cells, runs))
            .map_err(|e| Refusal::Input(miette::miette!(help = REPEAT, "{e}")))?;
    }
    writer.commit()?;
    let Part::Scan(record) = &mut results.part else {
        return Err(refuse(
            &args.parts[0],
            "it is not the record of a scan",
            REPEAT,
        ));
    };
    record.shard = None;
    summarise_table(&mut results, &design, folder.path())?;
    finish(&folder, results)
}

const REPEAT: &str = "run this part of the scan again: gearbench scan ... --shard I/N --out FOLDER";

fn refuse(folder: &Path, what: &str, help: &str) -> Refusal {
    Refusal::Input(miette::miette!(
        help = help.to_owned(),
        "{}: {what}",
        folder.display()
    ))
}

/// Reads the records of all parts and checks that each part of one scan is there once. Returns the record of the first
/// part, and the parts in order.
fn read(folders: &[PathBuf]) -> Result<(Results, Vec<PartOfScan>), Refusal> {
    let mut first: Option<(Results, ScanRecord, PathBuf)> = None;
    let mut parts: Vec<PartOfScan> = Vec::new();
    for folder in folders {
        let results = load_results(folder)
            .map_err(|e| Refusal::Input(miette::miette!(help = REPEAT, "{e}")))?;
        let Some(scan) = results.scan().cloned() else {
            return Err(refuse(
                folder,
                "it is not the record of a scan",
                "name folders of `gearbench scan --shard`",
            ));
        };
        let Some(shard) = scan.shard else {
            return Err(refuse(
                folder,
                "it has a whole scan, no part of one",
                "name folders of `gearbench scan --shard`",
            ));
        };
        match &first {
            None => first = Some((results, scan, folder.clone())),
            Some((_, of_first, name)) => {
                if let Some(what) = difference(of_first, &scan) {
                    let what = format!(
                        "the part is of another scan than {}: {what}",
                        name.display()
                    );
                    return Err(refuse(folder, &what, "name the parts of one scan"));
                }
            }
        }
        parts.push(PartOfScan {
            folder: folder.clone(),
            shard,
        });
    }
    let Some((results, ..)) = first else {
        return Err(Refusal::Input(miette::miette!("no part is named")));
    };
    parts.sort_by_key(|p| p.shard.number);
    if let Some(twice) = parts
        .windows(2)
        .find(|p| p[0].shard.number == p[1].shard.number)
    {
        let [a, b] = [&twice[0], &twice[1]].map(|p| p.folder.display().to_string());
        let what = format!(
            "part {} of {} is there twice, in {b} too",
            twice[0].shard.number, twice[0].shard.of
        );
        return Err(refuse(Path::new(&a), &what, "name each part once"));
    }
    let of = parts.first().map_or(0, |p| p.shard.of);
    let there = |n: &u64| parts.binary_search_by_key(n, |p| p.shard.number).is_ok();
    let missing: Vec<String> = (1..=of)
        .filter(|n| !there(n))
        .take(MOST_LISTED + 1)
        .map(|n| n.to_string())
        .collect();
    if !missing.is_empty() {
        let more = if missing.len() > MOST_LISTED {
            ", ..."
        } else {
            ""
        };
        let listed = missing[..missing.len().min(MOST_LISTED)].join(", ");
        return Err(Refusal::Input(miette::miette!(
            help = "run them (gearbench scan ... --shard I/N --out FOLDER), and name their folders",
            "{} of {of} parts are missing: {listed}{more}",
            of - parts.len() as u64
        )));
    }
    Ok((results, parts))
}

/// Returns a sentence on the first difference between two parts; `None` for parts of one scan.
fn difference(a: &ScanRecord, b: &ScanRecord) -> Option<String> {
    let [x, y] = [&a.identity, &b.identity];
    let of = |s: &ScanRecord| s.shard.map_or(0, |s| s.of);
    if x.program != y.program {
        Some(format!(
            "it was computed by gearbench {}, that one by {}",
            y.program, x.program
        ))
    } else if x.scene != y.scene {
        Some("its scene, a calibration or a file of the scene differs".into())
    } else if x.arguments != y.arguments {
        let differing =
            (x.arguments.split("; ").zip(y.arguments.split("; "))).find(|(x, y)| x != y);
        let (x, y) = differing.unwrap_or((&x.arguments, &y.arguments));
        Some(format!("it was computed with `{y}`, that one with `{x}`"))
    } else if of(a) != of(b) {
        Some(format!(
            "it is one of {} parts, that one of {}",
            of(b),
            of(a)
        ))
    } else {
        (a.cells != b.cells).then(|| "its number of cells differs".into())
    }
}

/// The command of the whole scan from that of a part, with its arguments.
fn whole_command(of_part: &str) -> Result<(String, Scan), Refusal> {
    crate::cli::whole_scan(of_part).ok_or_else(|| {
        Refusal::Input(miette::miette!(
            help = REPEAT,
            "the command of a part cannot be read: {of_part}"
        ))
    })
}
