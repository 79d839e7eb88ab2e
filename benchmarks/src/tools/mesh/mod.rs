//! The command `gearbench mesh SCENE|DECK`: meshes of gears, their quality, decks and files for ParaView.

pub mod arguments;

use crate::cli::command_result::CommandResult;
use crate::cli::files::{ReplaceableFiles, StagedFile};
use crate::cli::terminal::{Refusal, absolute};
use crate::context::Context;
use crate::scene_file;
use arguments::Mesh as Arguments;
use gearbench_models::spec::Body;
use gearbench_models::stiffness::Material;
use gearbench_reference::deck;
use gearbench_reference::gear_deck::{self, GearDeck, ModalProgram, ModalRun};
use gearbench_reference::gear_mesh::{
    self, FineTeeth, GearMesh, GearMeshParams, MeshError, Tooth, membership,
};
use gearbench_reference::mesh::vtu::{self, Field, Values};
use gearbench_reference::mesh::{self, ElementKind};
use serde_json::{Value, json};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Text that marks the files of this command: the command line in a deck, a comment in a file for ParaView.
const MARK: &str = "gearbench mesh";

/// Default number of modes of a modal analysis.
const MODES: u32 = 100;

/// A gear with its mesh, before it is written.
struct GearWithMesh {
    name: String,
    material: Material,
    mesh: GearMesh,
    /// Time to generate or read the mesh [s].
    seconds: f64,
}

impl GearWithMesh {
    /// The row of the table of meshes as JSON.
    fn to_json(&self) -> Value {
        let (m, q) = (&self.mesh.mesh, mesh::quality(&self.mesh.mesh));
        json!({
            "gear": self.name,
            "teeth": self.mesh.teeth,
            "element": m.kind_names(),
            "nodes": m.nodes.len(),
            "elements": m.element_count(),
            "unknowns": 3 * m.nodes.len(),
            "least_scaled_jacobian": q.min_scaled_jacobian,
            "mean_scaled_jacobian": q.mean_scaled_jacobian,
            "greatest_aspect": q.max_aspect_ratio,
            "seconds": self.seconds,
        })
    }
}

/// Meshes the gears, prints the mesh quality and writes the requested files.
pub fn run(context: &Context, args: &Arguments, command: &str) -> Result<CommandResult, Refusal> {
    let deck = match args.modal {
        Some(ModalProgram::Ansys) => "cdb",
        _ => "inp",
    };
    if args.modal.is_some() && args.sector {
        return Err(Refusal::Input(miette::miette!(
            help = "remove --sector",
            "--modal needs the mesh of a whole gear: the reduction of its matrices ties the whole bore to the hub"
        )));
    }
    for (option, path, ending) in [("--out", &args.out, deck), ("--vtu", &args.vtu, "vtu")] {
        ends_in(option, path.as_deref(), ending)?;
    }
    let gears = if is_deck(&args.input) {
        from_deck(context, args)?
    } else {
        from_scene(context, args)?
    };
    table(context, &gears);
    let mut files = Files::default();
    let overwriting = ReplaceableFiles {
        inputs: &inputs_of(context, &args.input)?,
        mark: Some(MARK),
        force: args.force,
    };
    for g in &gears {
        let several = (gears.len() > 1).then_some(g.name.as_str());
        if let Some(out) = &args.out {
            let path = named(out, several);
            let options = GearDeck {
                title: format!("{} of {}\n{command}", g.name, args.input),
                modal: args.modal.map(|program| ModalRun {
                    program,
                    modes: args.modes.unwrap_or(MODES),
                    stem: job_name(&path),
                }),
            };
            files.add(&path, &overwriting, |f| write_deck(f, g, &options))?;
        }
        if let Some(out) = &args.vtu {
            files.add(&named(out, several), &overwriting, |f| {
                write_vtu(f, &g.mesh)
            })?;
        }
    }
    if files.0.is_empty() {
        context.messages.print_line(
            "no file was written; `--out F.inp` writes a deck, `--vtu F.vtu` a file for ParaView",
        );
    }
    let written: Vec<PathBuf> = files.commit()?.into_iter().map(absolute).collect();
    for path in &written {
        context
            .messages
            .print_line(&format!("written: {}", path.display()));
    }
    let gears: Vec<Value> = gears.iter().map(GearWithMesh::to_json).collect();
    Ok(CommandResult::done()
        .with("gears", gears)
        .with("written", written))
}

/// Checks the extension of a file, by which other programs recognise its format.
fn ends_in(option: &str, path: Option<&Path>, ending: &str) -> Result<(), Refusal> {
    let fits = |p: &Path| {
        p.extension()
            .is_some_and(|e| e.eq_ignore_ascii_case(ending))
    };
    match path.filter(|p| !fits(p)) {
        None => Ok(()),
        Some(path) => Err(Refusal::Input(miette::miette!(
            help = format!("write {option} {}", path.with_extension(ending).display()),
            "{option} {}: the name of the file has to end in .{ending}",
            path.display()
        ))),
    }
}

/// Files read for an input: a deck, or a scene with all files that it names.
pub(super) fn inputs_of(context: &Context, input: &str) -> Result<Vec<PathBuf>, Refusal> {
    Ok(match is_deck(input) {
        true => vec![input.into()],
        false => scene_file::load_unbuilt(context, input)?.inputs(),
    })
}

/// Endings of the names of meshes.
pub(super) const DECK_ENDINGS: [&str; 6] =
    [".inp.gz", ".inp", ".msh.gz", ".msh", ".cdb.gz", ".cdb"];

pub(super) fn is_deck(input: &str) -> bool {
    let name = input.to_ascii_lowercase();
    DECK_ENDINGS.iter().any(|end| name.ends_with(end))
}

/// The path with the name of the gear: `F.inp` becomes `F-NAME.inp` where there are several gears.
pub(super) fn named(path: &Path, gear: Option<&str>) -> PathBuf {
    let Some(gear) = gear else {
        return path.to_owned();
    };
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let mut name = format!("{stem}-{gear}");
    if let Some(e) = path.extension() {
        name = format!("{name}.{}", e.to_string_lossy());
    }
    path.with_file_name(name)
}

/// Returns the members of a list with the requested name, or all without one.
pub(super) fn chosen<T>(
    all: Vec<T>,
    wanted: Option<&str>,
    input: &str,
    name: impl Fn(&T) -> String,
) -> Result<Vec<T>, Refusal> {
    let Some(wanted) = wanted else {
        return Ok(all);
    };
    let names: Vec<String> = all.iter().map(&name).collect();
    let found: Vec<T> = all.into_iter().filter(|g| name(g) == wanted).collect();
    if found.is_empty() {
        return Err(Refusal::Input(miette::miette!(
            help = format!("its gears are {}", names.join(", ")),
            "there is no gear `{wanted}` in {input}"
        )));
    }
    Ok(found)
}

fn from_deck(context: &Context, args: &Arguments) -> Result<Vec<GearWithMesh>, Refusal> {
    let counts = [
        ("--flank", args.flank.is_some()),
        ("--fillet", args.fillet.is_some()),
        ("--root", args.root.is_some()),
        ("--across", args.across.is_some()),
        ("--layers", args.layers.is_some()),
        ("--rim", args.rim.is_some()),
        ("--width", args.width.is_some()),
        ("--element", args.element.is_some()),
        ("--sector", args.sector),
        ("--fine-teeth", !args.fine_teeth.is_empty()),
    ];
    if let Some((option, _)) = counts.iter().find(|(_, given)| *given) {
        return Err(Refusal::Input(miette::miette!(
            help = "remove the option, or mesh a scene with that gear",
            "{option} cannot be used with a deck, which contains a mesh"
        )));
    }
    let start = Instant::now();
    let refuse = |e: deck::DeckError| Refusal::Input(miette::miette!("{e}"));
    let deck = deck::read_in(&args.input, args.units).map_err(refuse)?;
    deck.told()
        .iter()
        .for_each(|line| context.messages.print_line(line));
    let gears = gear_deck::gears(&deck).map_err(refuse)?;
    let seconds = start.elapsed().as_secs_f64() / gears.len().max(1) as f64;
    let gears = chosen(gears, args.gear.as_deref(), &args.input, |g| g.name.clone())?;
    Ok(gears
        .into_iter()
        .map(|g| GearWithMesh {
            name: g.name,
            material: g.material,
            mesh: g.mesh,
            seconds,
        })
        .collect())
}

fn from_scene(context: &Context, args: &Arguments) -> Result<Vec<GearWithMesh>, Refusal> {
    if args.units.is_some() {
        return Err(Refusal::Input(miette::miette!(
            help = "leave it out",
            "--units applies to decks: scenes are in SI units"
        )));
    }
    let scene = scene_file::load_unbuilt(context, &args.input)?;
    let params = params(args)?;
    let gears = chosen(scene.spec.gears, args.gear.as_deref(), &args.input, |g| {
        g.name.clone()
    })?;
    gears
        .into_iter()
        .map(|g| {
            let start = Instant::now();
            let made = match &g.body {
                Body::Gear(gear) => gear_mesh::gear(gear, &params),
                Body::Rack(_) if args.sector => {
                    return Err(Refusal::Input(miette::miette!(
                        help = "remove --sector, or choose a gear with --gear NAME",
                        "`{}` is a rack: it has no sector",
                        g.name
                    )));
                }
                Body::Rack(rack) => gear_mesh::rack(rack, &params),
            };
            let mesh = made.map_err(|e| refuse(&g.name, &e))?;
            Ok(GearWithMesh {
                name: g.name,
                material: g.material,
                mesh,
                seconds: start.elapsed().as_secs_f64(),
            })
        })
        .collect()
}

fn params(args: &Arguments) -> Result<GearMeshParams, Refusal> {
    let mut p = GearMeshParams::default();
    if let Some(name) = &args.element {
        let kind = ElementKind::from_name(name);
        let kind = kind.filter(|k| ElementKind::HEXAHEDRA.contains(k));
        p.kind = kind.ok_or_else(|| {
            let known: Vec<&str> = ElementKind::HEXAHEDRA.iter().map(|k| k.name()).collect();
            Refusal::Input(miette::miette!(
                help = format!("there are {}", known.join(", ")),
                "there is no element `{name}`"
            ))
        })?;
    }
    for (given, to) in [
        (args.flank, &mut p.tooth.flank),
        (args.fillet, &mut p.tooth.fillet),
        (args.root, &mut p.tooth.root),
        (args.across, &mut p.tooth.across),
        (args.layers, &mut p.layers),
        (args.rim, &mut p.rim),
        (args.width, &mut p.width),
    ] {
        if let Some(n) = given {
            *to = n;
        }
    }
    p.sector = args.sector;
    if !args.fine_teeth.is_empty() {
        p.fine_teeth = Some(FineTeeth {
            // On the command line as in the names of sets, from 1.
            teeth: args.fine_teeth.iter().map(|t| t - 1).collect(),
            others: Tooth::coarse(),
        });
    }
    Ok(p)
}

/// The refusal of a mesh, with the option or the line of the scene to correct.
fn refuse(name: &str, e: &MeshError) -> Refusal {
    let help = match e {
        MeshError::NoSuchTooth { .. } => {
            "the numbers of --fine-teeth start at 1, as in the sets flank_1l, flank_1r".to_owned()
        }
        _ => "--flank, --fillet, --root, --across, --layers, --rim and --width set the numbers of elements"
            .to_owned(),
    };
    Refusal::Input(miette::miette!(
        help = help,
        "the gear `{name}` cannot be meshed: {e}"
    ))
}

fn table(context: &Context, gears: &[GearWithMesh]) {
    let width = gears.iter().map(|g| g.name.len()).max().unwrap_or(0).max(4);
    context.messages.print_line(&format!(
        "{:<width$}  {:>5}  {:>7}  {:>8}  {:>8}  {:>8}  {:>15}  {:>8}  {:>9}",
        "gear",
        "teeth",
        "element",
        "nodes",
        "elements",
        "unknowns",
        "scaled Jacobian",
        "greatest",
        "time"
    ));
    context.messages.print_line(&format!(
        "{:<width$}  {:>5}  {:>7}  {:>8}  {:>8}  {:>8}  {:>7} {:>7}  {:>8}  {:>9}",
        "", "", "", "", "", "", "least", "mean", "aspect", "ms"
    ));
    for g in gears {
        let (m, q) = (&g.mesh.mesh, mesh::quality(&g.mesh.mesh));
        context.messages.print_line(&format!(
            "{:<width$}  {:>5}  {:>7}  {:>8}  {:>8}  {:>8}  {:>7.3} {:>7.3}  {:>8.1}  {:>9.1}",
            g.name,
            g.mesh.teeth,
            m.kind_names(),
            m.nodes.len(),
            m.element_count(),
            3 * m.nodes.len(),
            q.min_scaled_jacobian,
            q.mean_scaled_jacobian,
            q.max_aspect_ratio,
            1e3 * g.seconds
        ));
        if q.min_scaled_jacobian <= 0.0 {
            let i = q.worst_element;
            context.messages.print_line(&format!(
                "  element {} (counted from 1) has a negative Jacobian and cannot be used by any program",
                i + 1
            ));
        }
    }
}

/// The name of a deck without folder and ending, of letters that commands of other programs accept.
fn job_name(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    stem.chars().map(plain).collect()
}

fn write_deck(out: &mut dyn Write, g: &GearWithMesh, options: &GearDeck) -> Result<(), String> {
    gear_deck::write(out, &g.mesh, &g.material, options).map_err(|e| e.to_string())?;
    for name in ["cut_low", "cut_high"] {
        let Some(nodes) = g.mesh.mesh.node_sets.get(name) else {
            continue;
        };
        writeln!(out, "*NSET, NSET={name}, UNSORTED").map_err(|e| e.to_string())?;
        for line in nodes.chunks(12) {
            let labels: Vec<String> = line.iter().map(|n| (n + 1).to_string()).collect();
            writeln!(out, "{}", labels.join(", ")).map_err(|e| e.to_string())?;
        }
    }
    Ok(())
}

fn write_vtu(out: &mut dyn Write, g: &GearMesh) -> Result<(), String> {
    let (jacobian, aspect): (Vec<f64>, Vec<f64>) = mesh::element_qualities(&g.mesh)
        .map(|q| (q.scaled_jacobian, q.aspect_ratio))
        .unzip();
    let sets = membership(&g.mesh);
    let at_nodes: Vec<Field<'_>> = sets
        .iter()
        .map(|(name, v)| Field {
            name,
            values: Values::Integers(v),
        })
        .collect();
    let at_elements =
        [("scaled_jacobian", &jacobian), ("aspect_ratio", &aspect)].map(|(name, v)| Field {
            name,
            values: Values::Scalars(v),
        });
    vtu::write(out, &g.mesh, &at_nodes, &at_elements).map_err(|e| e.to_string())?;
    writeln!(out, "<!-- {MARK} -->").map_err(|e| e.to_string())
}

/// Files that are renamed to their final names when all of them are complete.
#[derive(Default)]
struct Files(Vec<StagedFile>);

impl Files {
    fn add(
        &mut self,
        path: &Path,
        overwriting: &ReplaceableFiles<'_>,
        write: impl Fn(&mut dyn Write) -> Result<(), String>,
    ) -> Result<(), Refusal> {
        let fail = |e: &dyn std::fmt::Display| Refusal::Files(format!("{}: {e}", path.display()));
        overwriting.check(path)?;
        if self.0.iter().any(|other| other.path() == path) {
            return Err(fail(
                &"is given twice; --out and --vtu need different names",
            ));
        }
        let mut out = BufWriter::new(StagedFile::begin(path).map_err(|e| fail(&e))?);
        write(&mut out).map_err(|e| fail(&e))?;
        self.0.push(out.into_inner().map_err(|e| fail(&e))?);
        Ok(())
    }

    /// Renames all files to their final names.
    fn commit(self) -> Result<Vec<PathBuf>, Refusal> {
        let keep = |file: StagedFile| {
            let path = file.path().to_owned();
            let kept = file.commit();
            kept.map_err(|e| Refusal::Files(format!("{}: {e}", path.display())))?;
            Ok(path)
        };
        self.0.into_iter().map(keep).collect()
    }
}
