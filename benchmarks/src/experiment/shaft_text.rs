//! A shaft in words, for what a reader must know of a scene.

use gearbench_models::spec::{Carried, SceneSpec, Section, SectionKind, ShaftDamping, ShaftSpec};
use gearbench_reports::numbers::short;

/// What it carries, and what it is made of.
pub fn shaft_text(scene: &SceneSpec, shaft: &ShaftSpec) -> String {
    let station = |s: &gearbench_models::spec::Station| {
        let at = short(s.place * 1e3, 4);
        match &s.carries {
            Carried::Gear(i) => format!("{} at {at} mm", scene.gears[*i].name),
            Carried::Body(b) => {
                let inertia = short(b.inertia, 4);
                format!("{} at {at} mm ({inertia} kg m2)", b.name)
            }
        }
    };
    let stations: Vec<String> = shaft.stations.iter().map(station).collect();
    let sections: Vec<String> = shaft.sections.iter().map(section_text).collect();
    let made = match sections.is_empty() {
        true => "rigid".to_owned(),
        false => sections.join(", "),
    };
    let damping = match shaft.damping {
        ShaftDamping::None => String::new(),
        ShaftDamping::Time(time) => {
            format!("; damping {} us of the stiffness", short(time * 1e6, 3))
        }
        ShaftDamping::Ratio(ratio) => format!("; damping ratio {}", short(ratio, 3)),
    };
    format!("{}; {made}{damping}", stations.join(", "))
}

fn section_text(s: &Section) -> String {
    let length = short(s.length * 1e3, 4);
    match &s.kind {
        SectionKind::Coupling { stiffness } => {
            format!("coupling of {length} mm, {} N m/rad", short(*stiffness, 4))
        }
        SectionKind::Round {
            diameters: [outer, inner],
            ..
        } => {
            let bore = match *inner > 0.0 {
                true => format!(" (bore {} mm)", short(inner * 1e3, 4)),
                false => String::new(),
            };
            let elements = match s.divisions {
                1 => String::new(),
                n => format!(" in {n} elements"),
            };
            format!(
                "diameter {} mm{bore} over {length} mm{elements}",
                short(outer * 1e3, 4)
            )
        }
    }
}
