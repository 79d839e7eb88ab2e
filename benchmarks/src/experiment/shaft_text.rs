//! Descriptions of shafts and guides for the settings of a report.

use gearbench_models::law::FrictionForm;
use gearbench_models::spec::{
    Guide, SceneSpec, Section, SectionKind, ShaftDamping, ShaftSpec, StageSpec, StationMember,
};
use gearbench_reports::numbers::short;

/// Describes a shaft: its stations, sections and material.
pub fn shaft_text(scene: &SceneSpec, shaft: &ShaftSpec) -> String {
    let station = |s: &gearbench_models::spec::Station| {
        let at = short(s.place * 1e3, 4);
        match &s.carries {
            StationMember::Gear(i) => format!("{} at {at} mm", scene.gears[*i].name),
            StationMember::Body(b) => {
                let inertia = short(b.inertia, 4);
                let guide = b
                    .guide
                    .as_ref()
                    .map_or_else(String::new, |g| guide_text(g, false));
                format!("{} at {at} mm ({inertia} kg m2{guide})", b.name)
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
        ShaftDamping::Time(time) => format!("; {}", damping_text(time)),
        ShaftDamping::Ratio(ratio) => format!("; damping ratio {}", short(ratio, 3)),
    };
    format!("{}; {made}{damping}", stations.join(", "))
}

/// Describes a stage without teeth: its members, ratio and stiffness.
pub fn stage_text(scene: &SceneSpec, stage: &StageSpec) -> String {
    let [first, second] = stage.members.map(|i| scene.member_name(i));
    let made = match stage.stiffness.is_finite() {
        true => format!("{} N m/rad", short(stage.stiffness, 4)),
        false => "rigid".to_owned(),
    };
    let damping = match stage.damping > 0.0 {
        true => format!("; {}", damping_text(stage.damping)),
        false => String::new(),
    };
    format!(
        "{first} to {second}, ratio {}; {made}{damping}",
        short(stage.ratio, 5)
    )
}

/// Describes damping over stiffness [s].
fn damping_text(time: f64) -> String {
    format!("damping {} us of the stiffness", short(time * 1e6, 3))
}

fn section_text(s: &Section) -> String {
    let length = short(s.length * 1e3, 4);
    let damping = s
        .damping
        .map_or_else(String::new, |time| format!(", {}", damping_text(time)));
    match &s.kind {
        SectionKind::Coupling { stiffness } => {
            let stiffness = short(*stiffness, 4);
            format!("coupling of {length} mm, {stiffness} N m/rad{damping}")
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
                "diameter {} mm{bore} over {length} mm{elements}{damping}",
                short(outer * 1e3, 4)
            )
        }
    }
}

/// Describes the guide of a hub to the ground along its own motion; `slides` for a rack, which translates.
pub fn guide_text(guide: &Guide, slides: bool) -> String {
    let [force, stiffness, damping, way, speed] = match slides {
        true => ["N", "N/m", "N s/m", "m", "m/s"],
        false => ["N m", "N m/rad", "N m s/rad", "rad", "rad/s"],
    };
    let mut parts = Vec::new();
    for (what, x, unit) in [
        ("spring", guide.stiffness, stiffness),
        ("damper", guide.damping, damping),
    ] {
        if x > 0.0 {
            parts.push(format!("{what} {} {unit}", short(x, 4)));
        }
    }
    if let Some(friction) = &guide.friction {
        let form = match friction.form() {
            FrictionForm::StickSlip(l) => format!("sticks over {} {way}", short(l, 3)),
            FrictionForm::Regularised(v) => format!("smoothed over {} {speed}", short(v, 3)),
        };
        let size = short(friction.force(), 4);
        parts.push(format!("friction {size} {force} ({form})"));
    }
    format!(" on {}", parts.join(", "))
}
