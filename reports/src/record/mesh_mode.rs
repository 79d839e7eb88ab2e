//! The record of mesh modes: natural frequency and damping ratio of each model of a scene.

use super::GearMotion;
use crate::numbers::{quantity, short};
use serde::{Deserialize, Serialize};

/// Ratio of the damping ratios of mesh modes from which on models count as differently damped.
const DIFFERS: f64 = 1.5;
/// Damping ratio below which a mesh mode counts as undamped.
const UNDAMPED: f64 = 1e-6;

/// The natural mode of a model that strains its meshes most, in the equilibrium of the loads of the scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct MeshMode {
    /// Label of the model.
    pub label: String,
    /// Natural frequency without damping, at the start [Hz].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frequency_hz: Option<f64>,
    /// Resonance: root mean square of this frequency over the mesh cycle [Hz].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub resonance_hz: Option<f64>,
    /// Least and greatest of this frequency over the mesh cycle [Hz].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub resonance_range_hz: Option<[f64; 2]>,
    /// Damping ratio at the start [-].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub damping_ratio: Option<f64>,
    /// Share of its strain energy in the meshes [-].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mesh_share: Option<f64>,
    /// The mode as a motion: the state at rest, and the amplitude; absent where a study shows no moving gears of it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motion: Option<GearMotion>,
    /// Reason why the model has no mesh mode.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub message: String,
}

impl MeshMode {
    /// Returns frequency and damping ratio in words, or the reason why there is none.
    pub fn to_text(&self) -> String {
        let Some(f) = self.frequency_hz else {
            return self.message.clone();
        };
        let damping = self.damping_ratio.map_or_else(String::new, |z| {
            let ratio = match z > 1.0 {
                true => "",
                false => "damping ratio ",
            };
            format!(", {ratio}{}", damping_to_text(z))
        });
        let cycle = match (self.resonance_hz, self.resonance_range_hz) {
            (Some(rms), Some([low, high])) => format!(
                "; resonance over the mesh cycle {} ({} to {})",
                quantity(rms, "Hz", 4),
                quantity(low, "Hz", 4),
                quantity(high, "Hz", 4)
            ),
            _ => String::new(),
        };
        format!("{}{damping}{cycle}", quantity(f, "Hz", 4))
    }
}

/// Formats a damping ratio in per cent; above 1 the mode is overdamped, and the word is enough.
pub(crate) fn damping_to_text(ratio: f64) -> String {
    match ratio {
        z if z > 1.0 => "overdamped".into(),
        z => format!("{} %", short(100.0 * z, 3)),
    }
}

/// Returns a remark on models whose mesh modes are damped differently; `None` where they are not.
pub fn damping_differs(all: &[MeshMode]) -> Option<String> {
    let known: Vec<(&str, f64)> = (all.iter())
        .filter_map(|m| Some((m.label.as_str(), m.damping_ratio?)))
        .collect();
    let (least, most) = (known.iter().map(|(_, z)| *z))
        .fold((f64::INFINITY, 0.0_f64), |(a, b), z| (a.min(z), b.max(z)));
    if known.len() < 2 || most < UNDAMPED || most <= DIFFERS * least {
        return None;
    }
    let each: Vec<String> = (known.iter())
        .map(|(label, z)| format!("{label} {}", damping_to_text(*z)))
        .collect();
    Some(format!(
        "the models differ in the damping of their mesh mode: {}; near resonances their results differ by this, whatever their contact",
        each.join(", ")
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(label: &str, ratio: f64) -> MeshMode {
        MeshMode {
            label: label.into(),
            frequency_hz: Some(5e3),
            damping_ratio: Some(ratio),
            ..MeshMode::default()
        }
    }

    #[test]
    fn models_that_differ_in_damping_are_named_with_their_values() {
        let text = damping_differs(&[of("rigid", 0.05), of("elastic", 0.0017)]).unwrap();
        assert!(
            text.contains("rigid 5 %") && text.contains("elastic 0.17 %"),
            "{text}"
        );
        assert!(damping_differs(&[of("rigid", 0.05), of("elastic", 0.0)]).is_some());
        let absurd = [of("rigid", 1.15e8), of("elastic", 0.5)];
        let text = damping_differs(&absurd).unwrap();
        assert!(text.contains("rigid overdamped, elastic 50 %"), "{text}");
        let texts = absurd.map(|m| m.to_text());
        assert!(texts[0].ends_with("Hz, overdamped"), "{}", texts[0]);
        assert!(texts[1].ends_with("Hz, damping ratio 50 %"), "{}", texts[1]);
        let unknown = MeshMode::default();
        for alike in [
            vec![of("a", 0.05), of("b", 0.04)],
            vec![of("a", 0.0), of("b", 0.0)],
            vec![of("a", 0.05), unknown],
        ] {
            assert_eq!(damping_differs(&alike), None);
        }
    }
}
