//! The viewer of moving gears in the page: its data and scripts. Without a script the page shows the still picture.

use crate::drawing::canvas::Ink;
use crate::drawing::style::curve_style;
use crate::record::{BodyPath, FrameContacts, GearMotion, ToothDisplacements, ToothedBody};
use crate::studies::solid::mechanism::Mechanism;
use maud::{Markup, PreEscaped, html};
use serde::Serialize;

const GEARS: &str = include_str!("gears.js");
const SOLID: &str = include_str!("gears3d.js");
const MECHANISM: &str = include_str!("mechanism.js");

/// Largest number of models next to each other.
const MOST_MODELS: usize = 6;
/// Largest size of the data of all models, in a plane and in space [bytes].
const MOST_BYTES: [usize; 2] = [1_000_000, 3_000_000];

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
    /// Name of the integrator; empty for modes.
    pub integrator: &'a str,
    /// Number of its curve style in charts.
    pub style: usize,
    /// Motion of the run, or of modes.
    pub motion: &'a GearMotion,
    /// The modes of the motion, in the order of its frames behind the first; empty for a run.
    pub modes: Vec<MovingMode>,
}

/// A mode that the viewer offers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MovingMode {
    /// Text of the list of modes.
    pub name: String,
    /// True of a motion without frequency.
    pub is_rigid: bool,
    /// Largest displacement of a point of the gears in the data \[m\].
    pub largest_m: f64,
}

/// Data of a model as the script reads it.
#[derive(Serialize)]
struct ModelData<'a> {
    label: &'a str,
    integrator: &'a str,
    ink: String,
    /// Place of its list of bodies.
    bodies: usize,
    view: &'a [[f64; 3]; 3],
    time_s: &'a [f64],
    meshes: &'a [[usize; 2]],
    paths: &'a [BodyPath],
    mechanism: Mechanism,
    modes: &'a [MovingMode],
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

/// Size of the data of a motion in the page, without its bodies [bytes].
fn bytes(motion: &GearMotion) -> usize {
    let of_teeth = motion
        .teeth
        .iter()
        .map(|t| t.displacements_m.data.len() + 4 * t.teeth.len());
    let of_paths = (motion.paths.iter()).map(|p| {
        let further = [&p.shift_m, &p.tilt]
            .into_iter()
            .flatten()
            .map(|q| q.data.len());
        p.turn_rad.data.len() + further.sum::<usize>()
    });
    let c = &motion.contacts;
    let of_contacts = [
        &c.points_m,
        &c.forces_n,
        &c.widths_m,
        &c.half_widths_m,
        &c.values,
    ];
    of_teeth.sum::<usize>()
        + of_paths.sum::<usize>()
        + of_contacts.map(|q| q.data.len()).iter().sum::<usize>()
        + 14 * c.meshes.len()
        + 20 * motion.time_s.len()
}

impl Viewer {
    /// Makes the viewer of as many models as a page can contain, beginning at a time \[s\] (of modes at a part of the
    /// period); also returns the labels of the others. `None` without models.
    pub fn fitting(
        chart: &str,
        models: Vec<MovingModel<'_>>,
        start_s: f64,
    ) -> Option<(Viewer, Vec<String>)> {
        let mut shown: Vec<MovingModel<'_>> = Vec::new();
        let (mut left_out, mut sum, mut spatial) = (Vec::new(), 0, false);
        for model in models {
            let in_space = spatial || model.motion.is_spatial();
            let with = sum + bytes(model.motion);
            let fits = shown.len() < MOST_MODELS && with <= MOST_BYTES[usize::from(in_space)];
            if shown.is_empty() || fits {
                (spatial, sum) = (in_space, with);
                shown.push(model);
            } else {
                left_out.push(model.label.to_owned());
            }
        }
        let viewer = || Viewer::new(chart, &shown, (spatial, start_s));
        (!shown.is_empty()).then(|| (viewer(), left_out))
    }

    /// Makes the viewer of models; it begins at a time \[s\], in space if `spatial`.
    fn new(chart: &str, models: &[MovingModel<'_>], (spatial, start_s): (bool, f64)) -> Viewer {
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
                ink: {
                    let Ink(r, g, b, _) = curve_style(m.style).ink;
                    format!("#{r:02x}{g:02x}{b:02x}")
                },
                bodies: place,
                view: &m.motion.view,
                time_s: &m.motion.time_s,
                meshes: &m.motion.meshes,
                paths: &m.motion.paths,
                mechanism: Mechanism::of(m.motion),
                modes: &m.modes,
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
    html! { script { (PreEscaped(MECHANISM)) (PreEscaped(SOLID)) (PreEscaped(GEARS)) } }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scripts_are_small_and_without_addresses() {
        let all = [GEARS, SOLID, MECHANISM].concat();
        assert!(all.len() < 68_000, "{} bytes", all.len());
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
            style: 0,
            motion: &motion,
            modes: Vec::new(),
        };
        let viewer = Viewer::new("mesh.svg", &[model], (false, 0.0));
        assert!(!viewer.data.contains('<'));
        let back: serde_json::Value = serde_json::from_str(&viewer.data).unwrap();
        assert_eq!(back["models"][0]["label"], "</script><b>");
    }
}
