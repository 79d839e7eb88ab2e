//! `gearbench list`: what there is to name on the command line and in scenes.

use crate::cli::answer::Answer;
use crate::cli::terminal::{Refusal, say};
use crate::models::models;
use crate::scene_file::{self, SHIPPED, SceneFile};
use gearbench_integrators::table::FREE_FLIGHT;
use gearbench_integrators::{METHODS, Method, Stepping};
use gearbench_models::gear::table::Model;
use gearbench_reference::{REFERENCES, StoredReference};
use serde_json::{Value, json};

/// Prints the tables.
pub fn run() -> Result<Answer, Refusal> {
    let scenes = (SHIPPED.iter())
        .map(|s| scene_file::load_unbuilt(s.name))
        .collect::<Result<Vec<_>, _>>()?;
    print(&scenes);
    Ok(Answer::done()
        .with("scenes", scenes.iter().map(scene).collect::<Vec<_>>())
        .with("models", models().iter().map(model).collect::<Vec<_>>())
        .with(
            "integrators",
            METHODS.iter().map(method).collect::<Vec<_>>(),
        )
        .with(
            "references",
            REFERENCES.iter().map(reference).collect::<Vec<_>>(),
        ))
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

fn print(scenes: &[SceneFile]) {
    say("scenes (gearbench compare NAME)");
    for s in scenes {
        let labels: Vec<&str> = s.models.iter().map(|m| m.label.as_str()).collect();
        say(&format!("  {:<18} {}", s.name, s.title));
        say(&format!("  {:<18} models: {}", "", labels.join(", ")));
    }
    say("\nmodels (model = \"ID\" in a scene)");
    for m in models() {
        say(&format!("  {:<18} {}", m.id, m.title));
        for p in m.parameters {
            let need = if p.required { "required" } else { "optional" };
            say(&format!("    {:<28} {} ({need})", p.key, p.meaning));
        }
    }
    say("\nintegrators (--integrators ID or \"ID(parameter=value)@step\")");
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
        say(&format!(
            "  {:<20} order {}, {kind}, {stepping}{needs}; {}",
            i.id, i.order, i.citation
        ));
        for p in i.parameters {
            say(&format!(
                "    {} = {} in [{}, {}]: {}",
                p.name, p.default, p.range.0, p.range.1, p.meaning
            ));
        }
    }
    say(&format!(
        "  all take {} in {{0, 1}}, default {}; {}",
        FREE_FLIGHT.name, FREE_FLIGHT.default, FREE_FLIGHT.meaning
    ));
    say("\nreferences (reference = \"ID\" in a scene)");
    for r in REFERENCES {
        say(&format!("  {:<24} {}", r.id, r.title));
    }
    say(
        "  a table of your own: reference = { csv = \"press.csv\" }; a run of a model: gearbench reference",
    );
}
