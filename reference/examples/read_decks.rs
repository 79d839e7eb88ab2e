//! Reads every deck below a folder and says what became of each.
//!
//!     cargo run --release -p gearbench-reference --example read_decks -- FOLDER
//!
//! For the examples of CalculiX itself (Debian package calculix-ccx-test) FOLDER is
//! /usr/share/doc/calculix-ccx-test/examples or where `dpkg -L calculix-ccx-test` says. Gears and findings of
//! the GTM check are counted for decks that are read. `.inp` files that others include are read on their own too.
#![allow(clippy::print_stdout)]

use gearbench_reference::deck::{self, DeckErrorKind};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

fn collect(folder: &Path, decks: &mut Vec<PathBuf>) -> std::io::Result<()> {
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        let name = path.to_string_lossy();
        if path.is_dir() {
            collect(&path, decks)?;
        } else if name.ends_with(".inp") || name.ends_with(".inp.gz") {
            decks.push(path);
        }
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args().nth(1).ok_or("usage: read_decks FOLDER")?;
    let mut decks = Vec::new();
    collect(Path::new(&folder), &mut decks)?;
    decks.sort();
    let mut read = 0;
    let mut gears_found = 0;
    let mut declined: BTreeMap<DeckErrorKind, usize> = BTreeMap::new();
    let mut causes: BTreeMap<String, usize> = BTreeMap::new();
    for path in &decks {
        match deck::read(path) {
            Ok(d) => {
                read += 1;
                let findings = deck::check_gtm(&d).len();
                let gears = match deck::gears(&d) {
                    Ok(gears) => {
                        gears_found += 1;
                        format!("{} gears", gears.len())
                    }
                    Err(e) => format!("no gears: {}, found {}", e.expected, e.found),
                };
                println!(
                    "{}: read: {} nodes, {} elements, {} steps; {gears}; {findings} findings",
                    path.display(),
                    d.nodes.len(),
                    d.element_count(),
                    d.steps.len()
                );
            }
            Err(e) => {
                println!("{e}");
                *declined.entry(e.kind).or_default() += 1;
                let keyword = e
                    .context
                    .split(',')
                    .next()
                    .unwrap_or("")
                    .to_ascii_uppercase();
                let cause = match e.kind {
                    DeckErrorKind::Unsupported => format!("{keyword} (expected {})", e.expected),
                    kind => format!("{keyword} ({kind:?}: expected {})", e.expected),
                };
                *causes.entry(cause).or_default() += 1;
            }
        }
    }
    println!(
        "\n{} decks, {read} read, {gears_found} with gears",
        decks.len()
    );
    for (kind, count) in declined {
        println!("declined, {kind:?}: {count}");
    }
    let mut causes: Vec<(String, usize)> = causes.into_iter().collect();
    causes.sort_by_key(|c| std::cmp::Reverse(c.1));
    for (cause, count) in causes {
        println!("{count:5}  {cause}");
    }
    Ok(())
}
