//! The command `gearbench reduce SCENE|DECK`: computes, reports and stores the modal basis of elastic gears.

pub mod arguments;
mod mounting;
mod recognised_body;
mod report;

use crate::cli::command_result::CommandResult;
use crate::cli::files::ReplaceableFiles;
use crate::cli::folder_lock::FolderLock;
use crate::cli::progress::Display;
use crate::cli::terminal::{Refusal, absolute};
use crate::context::Context;
use crate::scene_file;
use crate::tools::mesh::{DECK_ENDINGS, chosen, inputs_of, is_deck, named};
use arguments::Reduce as Arguments;
use gearbench_models::Vec3;
use gearbench_models::gear::parameters::ModelParameters;
use gearbench_models::gear::table::GearContext;
use gearbench_models::kinematics::{Hub, Placement};
use gearbench_models::scene::hub_of;
use gearbench_models::spec::{Body, GearSpec, ModelSpec};
use gearbench_models::stiffness::Material;
use gearbench_reference::deck::{self, Deck};
use gearbench_reference::gear_deck::{self, BodyShape, DeckGear};
use gearbench_reference::gear_mesh::GearMesh;
use gearbench_reference::matrices::{self, ForeignBody, MatrixError, MeshFrame};
use gearbench_reference::recognise::{RecognisedBody, SpecifiedBody};
use gearbench_reference::reduction::choose::{self, Choice, Criterion};
use gearbench_reference::reduction::store::{self, Meta, Motion};
use gearbench_reference::reduction::{
    Basis, ElasticParameters, ModeSelection, Mounting, ReductionError, Request, Toothing, of_gear,
};
use mounting::mounted;
use serde_json::json;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

/// Default number of modes.
const MODES: usize = 400;

/// A gear to be reduced.
struct Job {
    /// Name of the gear in its file, where there are several.
    name: String,
    /// Origin of the mesh, in words.
    source: String,
    mesh: GearMesh,
    /// True if the mesh is one sector of the gear.
    sector: bool,
    material: Material,
    mounting: Mounting,
    /// Matrices and mode shapes of another program.
    foreign: Option<ForeignBody>,
    /// Recognised geometry, where no sets name the flanks.
    found: Option<RecognisedBody>,
    /// Notes on the input, for the summary.
    notes: Vec<String>,
}

/// A reduced gear: basis, properties and computing time.
struct ReducedGear {
    basis: Arc<Basis>,
    meta: Meta,
    /// True if the basis was taken from the cache.
    hit: bool,
    /// Time of the reduction [s].
    seconds: f64,
}

/// Reduces the gears, prints the summaries and writes the requested files.
pub fn run(context: &Context, args: &Arguments) -> Result<CommandResult, Refusal> {
    let mut jobs = Vec::new();
    let display = Display::of(context, 0);
    for input in &args.inputs {
        display.message(&format!("reading {input}"));
        match is_deck(input) {
            true => jobs.extend(from_deck(args, input)?),
            false => jobs.extend(from_scene(context, args, input)?),
        }
    }
    let files = files(context, args, &jobs)?;
    let folder = args.out.as_deref().filter(|out| out.is_dir());
    let _lock = folder
        .map(|f| FolderLock::take(&context.messages, f))
        .transpose()?;
    let mut gears = Vec::new();
    for (i, (job, file)) in jobs.iter().zip(&files).enumerate() {
        display.report_progress(i, jobs.len(), &format!("reducing `{}`", job.name));
        let done = reduce(context, args, job)?;
        display.suspend(|| report::print_report(&context.messages, job, &done));
        let mut gear = report::to_json(job, &done);
        if let Some(path) = file {
            let size = store::write(path, &done.basis, &done.meta)
                .map_err(|e| Refusal::Files(e.to_string()))?;
            display.suspend(|| {
                context
                    .messages
                    .print_line(&report::line("written", &report::file(path, size)))
            });
            gear["written"] = json!(absolute(path.clone()));
        }
        gears.push(gear);
    }
    drop(display);
    if args.out.is_none() {
        context
            .messages
            .print_line("no file was written; `--out F.npz` writes the reduction");
    }
    Ok(CommandResult::done().with("gears", gears))
}

fn refuse(message: &str, help: &str) -> Refusal {
    Refusal::Input(miette::miette!(help = help.to_owned(), "{message}"))
}

fn from_deck(args: &Arguments, input: &str) -> Result<Vec<Job>, Refusal> {
    if args.model.is_some() {
        return Err(refuse(
            "--model cannot be used with a deck, which contains a mesh",
            "remove the option, or give a scene",
        ));
    }
    let bad = |e: deck::DeckError| Refusal::Input(miette::miette!("{e}"));
    let deck = deck::read_in(input, args.units).map_err(bad)?;
    let mut notes = deck.told();
    notes.extend(gear_deck::check_gtm(&deck).iter().map(ToString::to_string));
    let known = SpecifiedBody {
        axis: args.axis.map(Vec3::from),
        point: args.axis_point.map(Vec3::from),
        ..SpecifiedBody::default()
    };
    let alone = gear_deck::gears_known(&deck, None, &known);
    if alone.is_err() || alone.is_ok_and(|all| all.iter().any(Result::is_err)) {
        notes
            .push("material constants that the deck does not define are those of steel".to_owned());
    }
    let mut gears = gear_deck::gears_known(&deck, Some(Material::STEEL), &known).map_err(bad)?;
    let one = gears.len() == 1;
    // Given axis properties apply to the named gear only; other gears of the deck need not match them.
    let is_named = |g: &DeckGear| args.gear.as_ref().is_some_and(|name| *name == g.name);
    if known != SpecifiedBody::default() && gears.iter().flatten().any(is_named) {
        gears.retain(|g| g.as_ref().is_ok_and(is_named));
    }
    let gears = gears.into_iter().collect::<Result<_, _>>().map_err(bad)?;
    let gears = chosen(gears, args.gear.as_deref(), input, |g| g.name.clone())?;
    let stem = stem(input);
    if gears.len() > 1 && (args.matrices.is_some() || args.shapes.is_some()) {
        let names: Vec<&str> = gears.iter().map(|g| g.name.as_str()).collect();
        return Err(refuse(
            &format!(
                "matrices and shapes belong to one gear, but {input} has {}",
                names.join(", ")
            ),
            "choose one with --gear NAME",
        ));
    }
    let jobs = gears.into_iter().map(|g| {
        let material = material(args, g.material)?;
        let foreign = foreign_body(args, &deck, &g, &material)?;
        notes.extend(foreign.iter().flat_map(|f| f.notes.clone()));
        let free = args.mount.is_none_or(|m| m.0);
        let added = args.added_inertia.unwrap_or(0.0);
        Ok(Job {
            name: match one {
                true => stem.clone(),
                false => format!("{stem}-{}", g.name),
            },
            source: match one {
                true => format!("deck {input}"),
                false => format!("deck {input}, gear {}", g.name),
            },
            mounting: mounted(
                args,
                match g.shape {
                    BodyShape::Gear => Mounting::gear(free, added),
                    BodyShape::Rack { .. } => Mounting::rack(free, added),
                },
            )?,
            material,
            foreign,
            found: g.found,
            mesh: g.mesh,
            sector: false,
            notes: without_repeats(std::mem::take(&mut notes).into_iter().chain(g.missing)),
        })
    });
    jobs.collect()
}

/// Reads matrices and mode shapes that the command line names.
fn foreign_body(
    args: &Arguments,
    deck: &Deck,
    gear: &DeckGear,
    material: &Material,
) -> Result<Option<ForeignBody>, Refusal> {
    if args.matrices.is_none() && args.shapes.is_none() {
        return Ok(None);
    }
    let bad = |e: MatrixError| Refusal::Input(miette::miette!("{e}"));
    let mut disk = matrices::from_disk;
    let read = |names: &Vec<String>| matrices::read(names, &mut disk);
    let system = args.matrices.as_ref().map(read).transpose().map_err(bad)?;
    let read = |name: &String| matrices::read_shapes(name, &mut disk);
    let shapes = args.shapes.as_ref().map(read).transpose().map_err(bad)?;
    let frame = MeshFrame::of(deck, gear).map_err(bad)?;
    let body = ForeignBody::new(
        system.as_ref(),
        shapes.as_ref(),
        &frame,
        &gear.mesh,
        material,
    );
    body.map(Some).map_err(bad)
}

/// Removes repeated notes and keeps their order.
fn without_repeats(notes: impl Iterator<Item = String>) -> Vec<String> {
    let mut once: Vec<String> = Vec::new();
    for note in notes {
        if !once.contains(&note) {
            once.push(note);
        }
    }
    once
}

/// Name of a deck without folder and extension.
fn stem(input: &str) -> String {
    let name = Path::new(input).file_name().unwrap_or_default();
    let name = name.to_string_lossy();
    let lower = name.to_ascii_lowercase();
    let end = DECK_ENDINGS.iter().find(|e| lower.ends_with(*e));
    name[..name.len() - end.map_or(0, |e| e.len())].to_owned()
}

/// The material with the changes of the command line.
fn material(args: &Arguments, of: Material) -> Result<Material, Refusal> {
    let material = Material {
        young: args.young.unwrap_or(of.young),
        poisson: args.poisson.unwrap_or(of.poisson),
        density: args.density.unwrap_or(of.density),
    };
    let sound = material.check();
    sound.map_err(|e| refuse(&e.to_string(), "set --young, --poisson and --density"))?;
    Ok(material)
}

fn from_scene(context: &Context, args: &Arguments, input: &str) -> Result<Vec<Job>, Refusal> {
    if args.matrices.is_some() || args.shapes.is_some() {
        return Err(refuse(
            "--matrices and --shapes belong to a deck, not to a scene",
            "give the deck that the other program solved (`gearbench mesh SCENE --modal PROGRAM --out F.inp`)",
        ));
    }
    for (option, given, key) in [
        ("--units", args.units.is_some(), "units"),
        ("--axis", args.axis.is_some(), "axis"),
        ("--axis-point", args.axis_point.is_some(), "axis_point_m"),
    ] {
        if given {
            return Err(refuse(
                &format!("{option} applies to decks, not to scenes"),
                &format!(
                    "remove the option; for a mesh that the scene names, give `{key}` next to `mesh` in the scene"
                ),
            ));
        }
    }
    let scene = scene_file::load_unbuilt(context, input)?;
    // The configuration whose gears are elastic: it says where meshes come from.
    let mut elastic = scene.models.iter().filter(|m| {
        m.modelling
            .gears
            .iter()
            .any(|g| g.id() == ElasticParameters::MODEL)
    });
    let model = match &args.model {
        None => elastic.next(),
        Some(label) => Some(elastic.find(|m| m.label == *label).ok_or_else(|| {
            refuse(
                &format!("the scene `{}` has no elastic model `{label}`", scene.name),
                "remove --model to use the first elastic model, or meshes with default sizes if there is none",
            )
        })?),
    };
    let none = ElasticParameters::default().spec();
    let gears: Vec<(usize, GearSpec)> = scene.spec.gears.into_iter().enumerate().collect();
    let gears = chosen(gears, args.gear.as_deref(), input, |g| g.1.name.clone())?;
    let jobs = gears.into_iter().filter_map(|(i, g)| {
        let own = model.map(|m| &m.modelling.gears[i]);
        // In a mixed configuration only the elastic gears have a mesh.
        let own = match own {
            Some(spec) if spec.id() != ElasticParameters::MODEL => return None,
            Some(spec) => spec,
            None => &none,
        };
        Some(of_scene(args, &scene.name, &g, own))
    });
    let jobs: Vec<Job> = jobs.collect::<Result<_, _>>()?;
    match jobs.is_empty() {
        true => Err(refuse(
            "the gear is not elastic in the scene's elastic model",
            "remove --gear, or choose another model with --model",
        )),
        false => Ok(jobs),
    }
}

/// Meshes the gears of a scene according to the parameters of their model.
fn of_scene(
    args: &Arguments,
    scene: &str,
    g: &GearSpec,
    model: &ModelSpec,
) -> Result<Job, Refusal> {
    let rack = matches!(g.body, Body::Rack(_));
    let mut hub = Hub::new(g.mount.clone(), g.position.into(), rack.then(Vec3::y), 1.0);
    let of_scene = |e| Refusal::Input(miette::miette!("scene `{scene}`, gear `{}`: {e}", g.name));
    hub.lateral = hub_of(g).map_err(of_scene)?.lateral;
    let material = material(args, g.material)?;
    let context = GearContext {
        name: &g.name,
        body: &g.body,
        material,
        hub: &hub,
        added_inertia: args.added_inertia.unwrap_or(g.added_inertia),
        placement: Placement::new(&hub, 0.0),
        effective_radius: 1.0,
        meshes: &[],
        slides: false,
        lines: None,
        speed: 0.0,
        time_of_first_teeth: f64::INFINITY,
        model,
    };
    let given = &context
        .parameters::<ElasticParameters>()
        .map_err(of_scene)?
        .mesh;
    let of = of_gear(ElasticParameters::MODEL, &context, given).map_err(of_scene)?;
    let mesh = match &given.mesh {
        Some(text) => format!("mesh {text}"),
        None => "generated mesh".to_owned(),
    };
    Ok(Job {
        name: g.name.clone(),
        source: format!("scene {scene}, gear {}, {mesh}", g.name),
        mesh: of.mesh,
        sector: of.sector,
        material,
        mounting: mounted(args, of.mounting)?,
        foreign: None,
        found: of.found,
        notes: of.notes,
    })
}

/// The output path of each gear.
fn files(
    context: &Context,
    args: &Arguments,
    jobs: &[Job],
) -> Result<Vec<Option<PathBuf>>, Refusal> {
    let Some(out) = &args.out else {
        return Ok(vec![None; jobs.len()]);
    };
    let fail = |path: &Path, what: &str| Refusal::Files(format!("{}: {what}", path.display()));
    let ends_open = out.as_os_str().to_string_lossy().ends_with(['/', '\\']);
    let folder = out.is_dir() || ends_open;
    let ends_so = |e: &std::ffi::OsStr| e.eq_ignore_ascii_case("npz");
    if !folder && !out.extension().is_some_and(ends_so) {
        return Err(fail(
            out,
            "is neither a folder nor the name of a file that ends in .npz",
        ));
    }
    let mut files: Vec<PathBuf> = Vec::with_capacity(jobs.len());
    for job in jobs {
        let path = match (folder, jobs.len()) {
            (true, _) => out.join(format!("{}.npz", job.name)),
            (false, 1) => out.clone(),
            (false, _) => named(out, Some(&job.name)),
        };
        if files.contains(&path) {
            return Err(fail(&path, "is given twice; reduce the gears one by one"));
        }
        files.push(path);
    }
    let mut inputs = Vec::new();
    for input in &args.inputs {
        inputs.extend(inputs_of(context, input)?);
    }
    let overwriting = ReplaceableFiles {
        inputs: &inputs,
        // The arrays of the format that no other has.
        mark: Some("participation.npy"),
        force: args.force,
    };
    files.iter().try_for_each(|path| overwriting.check(path))?;
    if folder {
        std::fs::create_dir_all(out).map_err(|e| fail(out, &e.to_string()))?;
    }
    Ok(files.into_iter().map(Some).collect())
}

fn reduce(context: &Context, args: &Arguments, job: &Job) -> Result<ReducedGear, Refusal> {
    let most = args.modes.map(|n| n as usize);
    let by = match args.choose.as_str() {
        "flank-compliance" => Criterion::FlankCompliance,
        _ => Criterion::Frequency,
    };
    let wanted = match (most, args.max_frequency) {
        (_, Some(f)) => ModeSelection::UpTo(f),
        (None, None) => ModeSelection::Count(MODES),
        // Among twice as many there is something to choose from.
        (Some(n), None) if by == Criterion::FlankCompliance => {
            ModeSelection::Count(MODES.max(2 * n))
        }
        (Some(n), None) => ModeSelection::Count(n.max(1)),
    };
    let request = Request {
        along_profile: args.along_profile,
        mesh: &job.mesh,
        sector: job.sector,
        material: job.material,
        mounting: job.mounting,
        wanted,
        foreign: job.foreign.as_ref(),
    };
    let start = Instant::now();
    let found = context
        .resources
        .cache
        .basis(&request, &job.source, || request.compute());
    let found = found.map_err(|e| match e {
        ReductionError::Modes(_) => Refusal::Failed(format!("{}: {e}", job.source)),
        e => Refusal::Input(miette::miette!("{}: {e}", job.source)),
    })?;
    let mut meta = Meta::new(&request, &job.source);
    let mut basis = found.basis;
    if let Some(count) = most.filter(|n| *n < basis.omega.len()) {
        let kept = choose::choose(
            &basis,
            &Choice {
                by,
                count,
                candidates: basis.omega.len(),
                highest: args.max_frequency.map_or(f64::INFINITY, |f| TAU * f),
                time: f64::INFINITY,
                even_over_width: basis.lateral.is_none()
                    && Toothing::of(&basis, meta.motion, meta.teeth).straight,
            },
        );
        meta.asked = format!(
            "{count} at most, chosen by {} among {}",
            args.choose, meta.asked
        );
        meta.key.text(&meta.asked);
        basis = Arc::new(basis.with_modes(&kept));
    }
    Ok(ReducedGear {
        basis,
        meta,
        hit: found.hit,
        seconds: start.elapsed().as_secs_f64(),
    })
}

/// Describes the boundary condition of the hub.
fn hub(motion: Motion, free: bool) -> &'static str {
    match (motion, free) {
        (Motion::Turn, true) => "free to rotate",
        (Motion::Slide, true) => "free to translate",
        (_, false) => "held",
    }
}
