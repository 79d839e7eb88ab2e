//! The command `gearbench list`: scenes, models, integrators and references by name.

use crate::cli::command_result::CommandResult;
use crate::cli::terminal::Refusal;
use crate::context::Context;
use crate::scene_file::{self, SHIPPED, SceneFile};
use clap::{Args, ValueEnum};
use gearbench_integrators::table::FREE_FLIGHT;
use gearbench_integrators::{METHODS, Method, Stepping};
use gearbench_models::gear::table::Model;
use gearbench_reference::hash::Hash;
use gearbench_reference::reduction::cache::{Cache, LIMIT};
use gearbench_reference::{REFERENCES, StoredReference};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Examples:
  gearbench list               names and titles of everything
  gearbench list models        gear models with their parameters
  gearbench list integrators   order, stepping, parameters, source";

/// A part of the list.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Section {
    /// Shipped scenes
    Scenes,
    /// Gear models
    Models,
    /// Integrators
    Integrators,
    /// Stored references
    References,
}

/// Arguments of `list`.
#[derive(Args, Clone, Debug, Default)]
#[command(after_help = EXAMPLES)]
pub struct List {
    /// Part to list with all details [default: all parts, one line per entry]
    #[arg(value_name = "WHAT")]
    pub section: Option<Section>,
    /// Remove all reductions from the cache ($GEARBENCH_CACHE, else the user's cache folder), then list
    #[arg(long)]
    pub clear_cache: bool,
}

/// Prints the tables of scenes, models, integrators, references and caches.
pub fn run(context: &Context, args: &List) -> Result<CommandResult, Refusal> {
    let cached = CacheFiles::of(&context.resources.cache);
    let removed = match args.clear_cache {
        true => cached.remove()?,
        false => 0,
    };
    let cached = CacheFiles::of(&context.resources.cache);
    let scenes = (SHIPPED.iter())
        .map(|s| scene_file::load_unbuilt(context, s.name))
        .collect::<Result<Vec<_>, _>>()?;
    let in_full = |section: Section| args.section == Some(section);
    let listed = |section: Section| args.section.is_none() || in_full(section);
    let mut answer = CommandResult::done();
    if listed(Section::Scenes) {
        print_scenes(context, &scenes, in_full(Section::Scenes));
        answer = answer.with("scenes", scenes.iter().map(scene).collect::<Vec<_>>());
    }
    if listed(Section::Models) {
        print_models(context, in_full(Section::Models));
        answer = answer.with(
            "models",
            context.models.iter().map(model).collect::<Vec<_>>(),
        );
    }
    if listed(Section::Integrators) {
        print_integrators(context, in_full(Section::Integrators));
        answer = answer.with(
            "integrators",
            METHODS.iter().map(method).collect::<Vec<_>>(),
        );
    }
    if listed(Section::References) {
        print_references(context);
        answer = answer.with(
            "references",
            REFERENCES.iter().map(reference).collect::<Vec<_>>(),
        );
    }
    if args.section.is_none() {
        cached.print(context, removed);
        answer = answer.with("cache", cached.to_json());
        context
            .messages
            .print_line("\n`gearbench list scenes`, `models` and `integrators` print the details");
    }
    Ok(answer)
}

/// Files of the cache of reductions.
struct CacheFiles {
    folder: Option<PathBuf>,
    files: Vec<PathBuf>,
    bytes: u64,
}

impl CacheFiles {
    fn of(cache: &Cache) -> Self {
        let folder = cache.folder().map(Path::to_owned);
        let entries = folder.iter().flat_map(std::fs::read_dir).flatten();
        let (mut files, mut bytes) = (Vec::new(), 0);
        for entry in entries.flatten() {
            let name = entry.file_name().to_string_lossy().into_owned();
            let ours = name.split_once('.').is_some_and(|(hash, end)| {
                let ending = end == "npz" || (end.starts_with("npz.") && end.ends_with(".part"));
                ending && Hash::from_hex(hash).is_some()
            });
            if let Ok(data) = entry.metadata()
                && ours
                && data.is_file()
            {
                bytes += data.len();
                files.push(entry.path());
            }
        }
        CacheFiles {
            folder,
            files,
            bytes,
        }
    }

    /// Removes the files, and returns their number.
    fn remove(&self) -> Result<usize, Refusal> {
        for file in &self.files {
            match std::fs::remove_file(file) {
                Err(e) if e.kind() != std::io::ErrorKind::NotFound => {
                    return Err(Refusal::Files(format!("{}: {e}", file.display())));
                }
                _ => {}
            }
        }
        Ok(self.files.len())
    }

    fn print(&self, context: &Context, removed: usize) {
        context.messages.print_line(
            "\ncache of reductions (--clear-cache empties it; GEARBENCH_CACHE sets its folder, or `off`)",
        );
        let Some(folder) = &self.folder else {
            return context.messages.print_line("  off");
        };
        if removed > 0 {
            context
                .messages
                .print_line(&format!("  {removed} files were removed"));
        }
        context.messages.print_line(&format!(
            "  {}: {} files, {:.1} MB of at most {:.1} GB; the least recently used files are removed first",
            folder.display(),
            self.files.len(),
            1e-6 * self.bytes as f64,
            1e-9 * LIMIT as f64
        ));
    }

    fn to_json(&self) -> Value {
        json!({
            "folder": self.folder,
            "files": self.files.len(),
            "bytes": self.bytes,
            "limit_bytes": LIMIT,
        })
    }
}

fn scene(s: &SceneFile) -> Value {
    let labels: Vec<&str> = s.models.iter().map(|m| m.label.as_str()).collect();
    json!({ "name": s.name, "title": s.title, "models": labels })
}

fn model(m: &Model) -> Value {
    let parameters: Vec<Value> = (m.parameters.iter())
        .map(|p| json!({ "key": p.key, "meaning": p.meaning, "required": p.required }))
        .collect();
    json!({ "id": m.id, "title": m.title, "parameters": parameters })
}

fn method(m: &Method) -> Value {
    let i = m.info;
    let parameters: Vec<Value> = (i.parameters.iter().chain([&FREE_FLIGHT]))
        .map(|p| {
            json!({
                "name": p.name,
                "default": p.default,
                "least": p.range.0,
                "greatest": p.range.1,
                "meaning": p.meaning,
            })
        })
        .collect();
    json!({
        "id": i.id,
        "order": i.order,
        "implicit": i.implicit,
        "fixed_steps": i.stepping != Stepping::Adaptive,
        "adaptive": i.stepping != Stepping::Fixed,
        "needs_linear_part": i.linear_part,
        "citation": i.citation,
        "parameters": parameters,
    })
}

fn reference(r: &StoredReference) -> Value {
    json!({ "id": r.id, "title": r.title })
}

fn print_scenes(context: &Context, scenes: &[SceneFile], in_full: bool) {
    context
        .messages
        .print_line("scenes (gearbench compare NAME)");
    for s in scenes {
        context
            .messages
            .print_line(&format!("  {:<18} {}", s.name, s.title));
        if in_full {
            let labels: Vec<&str> = s.models.iter().map(|m| m.label.as_str()).collect();
            context
                .messages
                .print_line(&format!("  {:<18} models: {}", "", labels.join(", ")));
        }
    }
}

fn print_models(context: &Context, in_full: bool) {
    context
        .messages
        .print_line("\nmodels (model = \"ID\" in a scene)");
    for m in &*context.models {
        context
            .messages
            .print_line(&format!("  {:<18} {}", m.id, m.title));
        for p in m.parameters.iter().filter(|_| in_full) {
            let need = if p.required { "required" } else { "optional" };
            context
                .messages
                .print_line(&format!("    {:<28} {} ({need})", p.key, p.meaning));
        }
    }
}

fn print_integrators(context: &Context, in_full: bool) {
    context
        .messages
        .print_line("\nintegrators (--integrators ID or \"ID(parameter=value)@step\")");
    for m in METHODS {
        let i = m.info;
        let kind = if i.implicit { "implicit" } else { "explicit" };
        let stepping = match i.stepping {
            Stepping::Fixed => "fixed step",
            Stepping::Adaptive => "adaptive",
            Stepping::Both => "adaptive or fixed step",
        };
        let needs = if i.linear_part {
            ", rigid and elastic gears only"
        } else {
            ""
        };
        let line = format!(
            "  {:<20} order {}, {kind}, {stepping}{needs}",
            i.id, i.order
        );
        if !in_full {
            context.messages.print_line(&line);
            continue;
        }
        context
            .messages
            .print_line(&format!("{line}; {}", i.citation));
        for p in i.parameters {
            context.messages.print_line(&format!(
                "    {} = {} in [{}, {}]: {}",
                p.name, p.default, p.range.0, p.range.1, p.meaning
            ));
        }
    }
    if in_full {
        context.messages.print_line(&format!(
            "  all have the parameter {} in {{0, 1}}, default {}; {}",
            FREE_FLIGHT.name, FREE_FLIGHT.default, FREE_FLIGHT.meaning
        ));
    }
}

fn print_references(context: &Context) {
    context
        .messages
        .print_line("\nreferences (reference = \"ID\" in a scene)");
    for r in REFERENCES {
        context
            .messages
            .print_line(&format!("  {:<24} {}", r.id, r.title));
    }
    context.messages.print_line(
        "  your own table: reference = { csv = \"press.csv\" }; the run of a model: gearbench reference",
    );
}
