//! The viewer of moving gears in the page: its data and scripts. Without a script the page shows the still picture.

use crate::record::{BodyPath, FrameContacts, GearMotion, ToothDisplacements, ToothedBody};
use maud::{Markup, PreEscaped, html};
use serde::Serialize;

const GEARS: &str = include_str!("gears.js");
const SOLID: &str = include_str!("gears3d.js");

/// Moving gears of some models, which the page shows in place of a chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Viewer {
    /// File of the chart that is the still picture.
    pub chart: String,
    /// Number of models.
    pub models: usize,
    /// Data of the viewer as JSON.
    data: String,
}

/// Motion of a model with its names and colour.
pub struct MovingModel<'a> {
    /// Label of the model.
    pub label: &'a str,
    /// Name of the integrator.
    pub integrator: &'a str,
    /// Colour of the model in charts, `#RRGGBB`.
    pub ink: String,
    /// Motion of the run.
    pub motion: &'a GearMotion,
}

/// Data of a model as the script reads it.
#[derive(Serialize)]
struct ModelData<'a> {
    label: &'a str,
    integrator: &'a str,
    ink: &'a str,
    /// Place of its list of bodies.
    bodies: usize,
    view: &'a [[f64; 3]; 3],
    time_s: &'a [f64],
    meshes: &'a [[usize; 2]],
    paths: &'a [BodyPath],
    teeth: &'a [ToothDisplacements],
    contacts: &'a FrameContacts,
}

#[derive(Serialize)]
struct ViewerData<'a> {
    /// True where the viewer begins with the view in space.
    spatial: bool,
    start_s: f64,
    /// Different lists of bodies, of models of one scene a single one.
    bodies: Vec<&'a [ToothedBody]>,
    models: Vec<ModelData<'a>>,
}

impl Viewer {
    /// Makes the viewer of models; it begins at a time \[s\], in space if `spatial`.
    pub fn new(chart: &str, models: &[MovingModel<'_>], (spatial, start_s): (bool, f64)) -> Viewer {
        let mut bodies: Vec<&[ToothedBody]> = Vec::new();
        let mut all = Vec::new();
        for m in models {
            let own = m.motion.bodies.as_slice();
            let known = bodies.iter().position(|b| *b == own);
            let place = known.unwrap_or_else(|| {
                bodies.push(own);
                bodies.len() - 1
            });
            all.push(ModelData {
                label: m.label,
                integrator: m.integrator,
                ink: &m.ink,
                bodies: place,
                view: &m.motion.view,
                time_s: &m.motion.time_s,
                meshes: &m.motion.meshes,
                paths: &m.motion.paths,
                teeth: &m.motion.teeth,
                contacts: &m.motion.contacts,
            });
        }
        let data = ViewerData {
            spatial,
            start_s,
            bodies,
            models: all,
        };
        // Names come from the user: no text of the data ends the element that contains it.
        let json = serde_json::to_string(&data).unwrap_or_default();
        Viewer {
            chart: chart.to_owned(),
            models: models.len(),
            data: json.replace('<', "\\u003c"),
        }
    }

    /// Returns the element that the script turns into the viewer.
    pub(super) fn figure(&self) -> Markup {
        html! {
            div.gears { script type="application/json" { (PreEscaped(&self.data)) } }
        }
    }
}

/// Returns the scripts of the viewer.
pub(super) fn scripts() -> Markup {
    html! { script { (PreEscaped(SOLID)) (PreEscaped(GEARS)) } }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scripts_are_small_and_without_addresses() {
        let all = [GEARS, SOLID].concat();
        assert!(all.len() < 60_000, "{} bytes", all.len());
        for forbidden in [
            "http:",
            "https:",
            "fetch(",
            "XMLHttpRequest",
            "import ",
            "</script",
        ] {
            assert!(!all.contains(forbidden), "{forbidden}");
        }
    }

    #[test]
    fn names_cannot_end_the_data() {
        let motion = GearMotion::default();
        let model = MovingModel {
            label: "</script><b>",
            integrator: "rk4",
            ink: "#000000".into(),
            motion: &motion,
        };
        let viewer = Viewer::new("mesh.svg", &[model], (false, 0.0));
        assert!(!viewer.data.contains('<'));
        let back: serde_json::Value = serde_json::from_str(&viewer.data).unwrap();
        assert_eq!(back["models"][0]["label"], "</script><b>");
    }
}
