//! The list `[[stages]]`: gears, belts or chains of a drive train whose teeth are not resolved.
//!
//! ```toml
//! [[stages]]
//! name = "bevel"
//! between = ["motor_pinion", "wheel_hub"]   # gears, or bodies on shafts
//! ratio = 3.0                               # speed of the first over that of the second
//! stiffness_nm_per_rad = 43300.0            # at the second; left out, the stage is rigid
//! damping_nms_per_rad = 1.84
//! ```

use super::error::SceneError;
use super::reading::Place;
use super::reading::keys::keys;
use super::reading::suggest::there_are;
use super::reading::values::{NotNegative, Positive};
use gearbench_models::spec::{SceneSpec, StageSpec};

keys! {
    /// A stage without teeth between two members.
    #[derive(Default)]
    struct StageTable {
        /// name of the stage, for example "bevel"
        name: String,
        /// names of two gears or bodies on shafts, for example ["motor_hub", "wheel_hub"]
        between: [String; 2],
        /// speed of the first over that of the second; negative if they turn in opposite directions
        ratio: f64,
        /// torsional stiffness at the second member in N m/rad; left out, the stage is rigid
        stiffness_nm_per_rad: Option<Positive>,
        /// damper at the second member in N m s/rad, default 0
        damping_nms_per_rad: Option<NotNegative>,
    }
}

/// Reads the stages between the members of a scene.
pub(super) fn stages(
    list: Vec<StageTable>,
    spec: &SceneSpec,
    all: &Place<'_>,
) -> Result<Vec<StageSpec>, SceneError> {
    (list.into_iter().enumerate())
        .map(|(i, keys)| stage(keys, spec, &all.member(i)))
        .collect()
}

fn stage(keys: StageTable, spec: &SceneSpec, at: &Place<'_>) -> Result<StageSpec, SceneError> {
    let all = spec.gears.len() + spec.bodies().count();
    let names: Vec<String> = (0..all).map(|i| spec.member_name(i).to_owned()).collect();
    let mut members = [0; 2];
    for (k, (member, name)) in members.iter_mut().zip(&keys.between).enumerate() {
        let Some(index) = names.iter().position(|own| own == name) else {
            return at.key("between").member(k).refuse(
                format!("there is no gear or body `{name}`"),
                "not known",
                there_are(name, &names),
            );
        };
        *member = index;
    }
    let stiffness = keys.stiffness_nm_per_rad.map_or(f64::INFINITY, f64::from);
    let damper = keys.damping_nms_per_rad.map_or(0.0, f64::from);
    if damper > 0.0 && stiffness.is_infinite() {
        return at.key("damping_nms_per_rad").refuse(
            "a rigid stage has no damper",
            "this key",
            "give `stiffness_nm_per_rad` as well, or remove it",
        );
    }
    Ok(StageSpec {
        name: keys.name,
        members,
        ratio: keys.ratio,
        stiffness,
        damping: damper / stiffness,
    })
}
