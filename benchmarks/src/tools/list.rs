//! `gearbench list`: what there is to name on the command line and in scenes.

use crate::cli::terminal::{Refusal, say};
use crate::models::models;
use crate::scene_file::{self, SHIPPED};
use gearbench_integrators::table::FREE_FLIGHT;
use gearbench_integrators::{METHODS, Stepping};
use gearbench_reference::REFERENCES;
use std::process::ExitCode;

/// Prints the tables.
pub fn run() -> Result<ExitCode, Refusal> {
    say("scenes (gearbench compare NAME)");
    for s in SHIPPED {
        let scene = scene_file::load_unbuilt(s.name)?;
        let labels: Vec<&str> = scene.models.iter().map(|m| m.label.as_str()).collect();
        say(&format!("  {:<18} {}", s.name, scene.title));
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
    Ok(ExitCode::SUCCESS)
}
