//! Reads the example decks of CalculiX, and compares frequencies with the results that are stored with them.
//!
//!     apt-get install calculix-ccx-test
//!     cargo run --release -p gearbench-reference --example ccx_examples -- \
//!         /usr/share/doc/calculix-ccx-test/examples/test reference/calculix/examples/table.csv
//!
//! Per deck: is its body a linear isotropic solid, was it read, and why not. That is judged from the text alone, by
//! [`judged`]. Frequencies are compared where the deck was read, its material is whole, and the first step that
//! computes them is about the undeformed body with nodes held at zero: `digits` is the greatest difference from
//! the frequencies printed in `NAME.dat.ref`, in units of their last digit.
#![allow(clippy::print_stdout)]

use flate2::read::MultiGzDecoder;
use gearbench_models::stiffness::Material;
use gearbench_reference::assembly::assemble;
use gearbench_reference::assembly::tie::{MassKind, Tie};
use gearbench_reference::deck::{self, Deck, Procedure, Units};
use gearbench_reference::modes::{Options, lowest};
use std::collections::BTreeSet;
use std::error::Error;
use std::io::Read;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [folder, output] = arguments.as_slice() else {
        return Err("usage: ccx_examples FOLDER TABLE.csv".into());
    };
    let mut paths: Vec<_> = std::fs::read_dir(folder)?
        .map(|entry| entry.map(|e| e.path()))
        .collect::<Result<_, _>>()?;
    paths.retain(|p| {
        let name = p.to_string_lossy();
        name.ends_with(".inp") || name.ends_with(".inp.gz")
    });
    paths.sort();
    let mut table = csv::Writer::from_path(output)?;
    table.write_record([
        "deck",
        "solid",
        "read",
        "kinds",
        "nodes",
        "elements",
        "node_sets",
        "materials",
        "modes",
        "digits",
        "why",
    ])?;
    let mut counts = [0; 6];
    for path in &paths {
        let row = row(path)?;
        let yes = |i: usize| row[i] == "yes";
        counts[0] += 1;
        counts[1] += usize::from(yes(1));
        counts[2] += usize::from(yes(1) && yes(2));
        counts[3] += usize::from(!yes(1) && !yes(2));
        counts[4] += usize::from(!row[9].is_empty());
        counts[5] += usize::from(row[9].parse::<f64>().is_ok_and(|d| d <= 1.0));
        if yes(1) && (!yes(2) || !row[10].is_empty()) || (!row[9].is_empty() && row[9] != "0") {
            println!(
                "{}: read {}, {} modes, {} digits; {}",
                row[0], row[2], row[8], row[9], row[10]
            );
        }
        table.write_record(&row)?;
    }
    table.flush()?;
    let [all, solids, read, others, compared, agreed] = counts;
    println!(
        "{all} decks; {solids} of linear isotropic solids, {read} of them read; {others} others declined; \
         frequencies of {compared} compared, {agreed} within one unit of the last printed digit"
    );
    Ok(())
}

/// The text of a file, unpacked if it is gzip; Latin-1 passes.
fn text(path: &Path) -> Result<String, Box<dyn Error>> {
    let bytes = std::fs::read(path)?;
    let mut unpacked = Vec::new();
    match bytes.starts_with(&[0x1f, 0x8b]) {
        true => MultiGzDecoder::new(bytes.as_slice()).read_to_end(&mut unpacked)?,
        false => bytes.as_slice().read_to_end(&mut unpacked)?,
    };
    Ok(String::from_utf8_lossy(&unpacked).into_owned())
}

/// The row of the table of a deck.
fn row(path: &Path) -> Result<Vec<String>, Box<dyn Error>> {
    let file = path
        .file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned();
    let name = file
        .trim_end_matches(".gz")
        .trim_end_matches(".inp")
        .to_owned();
    let judged = judged(&text(path)?);
    let read = deck::read_in(path, Some(Units::SI));
    let mut row = vec![
        name.clone(),
        if judged.is_ok() { "yes" } else { "no" }.to_owned(),
    ];
    let deck = match read {
        Ok(deck) => deck,
        Err(e) => {
            row.push("no".into());
            row.extend(std::iter::repeat_n(String::new(), 7));
            // The message without the path of the file.
            let shown = e.to_string().replace(&*path.to_string_lossy(), &file);
            row.push(shown);
            return Ok(row);
        }
    };
    let whole = deck.section_materials().iter().all(|m| {
        let material = m.and_then(|m| deck.materials.get(m));
        material.is_some_and(|m| m.elastic.is_some())
    });
    let complete = deck.element_count() > 0 && whole;
    row.push(if complete { "yes" } else { "no" }.to_owned());
    row.extend([
        deck.mesh().kind_names(),
        deck.nodes.len().to_string(),
        deck.element_count().to_string(),
        deck.node_sets.len().to_string(),
        deck.materials.len().to_string(),
    ]);
    let compared = match judged {
        Ok(()) if complete => compared(&deck, path, &name),
        Ok(()) => Err("elements without a section or an elastic material".into()),
        Err(why) => Err(why),
    };
    match compared {
        Ok((modes, digits)) => row.extend([modes.to_string(), digits.to_string(), String::new()]),
        Err(why) => row.extend([String::new(), String::new(), why]),
    }
    Ok(row)
}

/// Returns an error with the keyword unless all elements of a deck are solids with sections of linear isotropic
/// materials, joined by their nodes alone.
fn judged(text: &str) -> Result<(), String> {
    let beyond = "PLASTIC HYPERELASTIC HYPERFOAM CREEP CYCLICHARDENING DEFORMATIONPLASTICITY USERMATERIAL \
        MODELCHANGE CHANGEMATERIAL CHANGEPLASTIC CHANGESOLIDSECTION EQUATION MPC TIE CYCLICSYMMETRYMODEL \
        SHELLSECTION BEAMSECTION BEAMGENERALSECTION MEMBRANE MEMBRANESECTION FLUIDSECTION FLUIDSECTIONS SPRING DASHPOT \
        GAP MASS PRE-TENSIONSECTION";
    let (mut elastic, mut sections) = (0, 0);
    let mut constants: Option<BTreeSet<String>> = None;
    for line in text.lines().map(str::trim).filter(|l| !l.starts_with("**")) {
        let squeezed: String = line.to_ascii_uppercase().split_whitespace().collect();
        let Some(keyword) = squeezed.strip_prefix('*') else {
            if let (Some(seen), false) = (&mut constants, line.is_empty()) {
                // Constants without the temperature that they hold at.
                let two: Vec<&str> = squeezed.split(',').take(2).collect();
                seen.insert(two.join(","));
                if seen.len() > 1 {
                    return Err("*ELASTIC depends on temperature".into());
                }
            }
            continue;
        };
        constants = None;
        let mut fields = keyword.split(',');
        let key = fields.next().unwrap_or_default();
        let option = |name: &str| {
            let mut options = keyword.split(',').skip(1);
            options.find_map(|o| o.strip_prefix(name)?.strip_prefix('=').map(str::to_owned))
        };
        if beyond.split_whitespace().any(|b| b == key) {
            return Err(format!("*{key}"));
        }
        match key {
            "ELEMENT" => match option("TYPE") {
                Some(kind) if kind.starts_with("C3D") => {}
                kind => return Err(format!("*ELEMENT of type {}", kind.unwrap_or_default())),
            },
            "ELASTIC" => {
                elastic += 1;
                if option("TYPE").is_some_and(|t| !t.starts_with("ISO")) {
                    return Err("*ELASTIC that is not isotropic".into());
                }
                constants = Some(BTreeSet::new());
            }
            "SOLIDSECTION" => sections += 1,
            _ => {}
        }
    }
    match (elastic, sections) {
        (0, _) => Err("no *ELASTIC".into()),
        (_, 0) => Err("no *SOLID SECTION".into()),
        _ => Ok(()),
    }
}

/// How many frequencies of a deck were compared, and their greatest difference in units of the last digit.
fn compared(deck: &Deck, path: &Path, name: &str) -> Result<(usize, f64), String> {
    let is_frequency = |p: &Procedure| matches!(p, Procedure::Frequency { .. });
    let Some(step) = deck.steps.iter().position(|s| is_frequency(&s.procedure)) else {
        return Err(String::new());
    };
    let told = |what: &str| Err(format!("frequencies not compared: {what}"));
    if step > 0 && deck.steps[step].perturbation {
        return told("about a loaded state");
    }
    if !deck.contact_pairs.is_empty() {
        return told("contact");
    }
    if !deck.rigid_bodies.is_empty() || deck.passed_over.contains_key("*RIGID BODY") {
        return told("a rigid body");
    }
    let mut held = vec![false; 3 * deck.nodes.len()];
    let anew = (0..=step).rfind(|&i| deck.steps[i].boundaries_anew);
    let steps = deck.steps[anew.unwrap_or(0)..=step].iter();
    let first = deck.boundaries.iter().filter(|_| anew.is_none());
    for b in first.chain(steps.flat_map(|s| &s.boundaries)) {
        if b.own_axes {
            return told("conditions in axes of their own");
        }
        for &n in deck.target(&b.target) {
            for direction in b.directions[0]..=b.directions[1] {
                held[3 * n as usize + usize::from(direction) - 1] = true;
            }
        }
    }
    if !held.contains(&true) {
        return told("no node is held");
    }
    let materials: BTreeSet<_> = deck.section_materials().into_iter().collect();
    let one = match materials.into_iter().collect::<Vec<_>>().as_slice() {
        [Some(one)] => deck.material(one),
        _ => return told("several materials"),
    };
    let Some(material) = one else {
        return told("no density");
    };
    let reference =
        [".dat.ref", ".dat.ref.gz"].map(|end| path.with_file_name(format!("{name}{end}")));
    let reference = reference
        .iter()
        .find(|p| p.is_file())
        .ok_or("no stored results")?;
    let reference = printed(&text(reference).map_err(|e| e.to_string())?);
    if reference.is_empty() {
        return told("none in the stored results");
    }
    let ours = frequencies(deck, &material, &held, reference.len())?;
    let digits = reference
        .iter()
        .zip(&ours)
        .map(|((f, unit), own)| (f - own).abs() / unit);
    let worst = digits.fold(0.0, f64::max);
    // A unit is one seventh digit; differences far below it are noise.
    Ok((
        reference.len().min(ours.len()),
        (worst * 100.0).round() / 100.0,
    ))
}

/// The lowest frequencies [Hz] of the body of a deck.
fn frequencies(
    deck: &Deck,
    material: &Material,
    held: &[bool],
    count: usize,
) -> Result<Vec<f64>, String> {
    let mesh = deck.mesh();
    let mut held = held.to_vec();
    // Nodes without an element have neither stiffness nor mass.
    let mut used = vec![false; mesh.nodes.len()];
    mesh.connectivity().for_each(|n| used[n as usize] = true);
    for (n, used) in used.iter().enumerate() {
        held[3 * n..3 * n + 3].iter_mut().for_each(|h| *h |= !used);
    }
    let assembly = assemble(&mesh, material).map_err(|e| e.to_string())?;
    let tie = Tie::new(&mesh.nodes, &[], &[]);
    let reduced = tie.reduce(&assembly, &[], MassKind::Consistent).held(&held);
    let count = count.min(reduced.stiffness.ncols());
    let modes = lowest(&reduced, count, &Options::default()).map_err(|e| e.to_string())?;
    Ok(modes.frequencies())
}

/// Frequencies of the first table of eigenvalues, with the unit of their last printed digit.
fn printed(text: &str) -> Vec<(f64, f64)> {
    let table = text
        .split("E I G E N V A L U E   O U T P U T")
        .nth(1)
        .unwrap_or_default();
    let mut found = Vec::new();
    for line in table.lines() {
        let cells: Vec<&str> = line.split_whitespace().collect();
        let number = cells.first().and_then(|c| c.parse::<usize>().ok());
        match (number, cells.get(3)) {
            (Some(n), Some(cell)) if n == found.len() + 1 => {
                let Ok(value) = cell.parse::<f64>() else {
                    break;
                };
                let exponent = cell
                    .split_once('E')
                    .and_then(|(_, e)| e.parse::<i32>().ok());
                found.push((value, 10.0_f64.powi(exponent.unwrap_or(0) - 7)));
            }
            _ if found.is_empty() => {}
            _ => break,
        }
    }
    found
}
