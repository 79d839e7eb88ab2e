//! Frames of a run for ParaView: displaced bodies of all gears with contact forces.
//!
//! A frame is one grid (`NAME/frame_0000.vtu`), the run a collection of frames with their times (`NAME.pvd`). Nodes are
//! in their displaced positions; `displacement` is the deviation from the rigid motion of the gear, so that a warp by
//! `s` of it shows `1 + s` times the displacement. Each contact acts on its nearest node: `contact_force` is the sum of
//! these forces, `contact_pressure` the largest contact pressure there, 0 elsewhere.

use super::run::RunError;
use gearbench_integrators::State;
use gearbench_models::Vec3;
use gearbench_models::scene::{ContactExtent, ContactForce, GearPicture, Scene};
use gearbench_models::spec::SceneSpec;
use gearbench_reference::limits;
use gearbench_reference::mesh::vtu::{self, Field, Values, VtuError};
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

/// Number, time window and path of the frames of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Pictures {
    /// Common folder of all runs.
    pub folder: PathBuf,
    /// Name of the run in file names.
    pub name: String,
    /// Number of frames in the window.
    pub frames: usize,
    /// First and last time [s].
    pub window: [f64; 2],
}

/// Frames of a run while it is computed.
#[derive(Clone, Debug, Default)]
pub struct Frames {
    /// Times of frames, ascending [s].
    pub times: Vec<f64>,
    /// States at the times reached so far.
    pub states: Vec<State>,
}

impl Pictures {
    /// Sets the times of the frames, if the memory suffices for their states.
    ///
    /// # Errors
    /// [`RunError::Refused`] where all states would take too much memory.
    pub fn begin(&self, scene: &Scene) -> Result<Frames, RunError> {
        let state = scene.initial();
        let numbers = 2 * state.q.len() + state.discrete.len();
        let what = format!("the states of {} frames", self.frames);
        let bytes = 8.0 * self.frames as f64 * numbers as f64;
        limits::check(what, bytes, "use fewer frames")?;
        let [from, to] = self.window;
        let last = self.frames.saturating_sub(1).max(1) as f64;
        Ok(Frames {
            times: (0..self.frames)
                // The last one is the end itself, whatever rounding does.
                .map(|i| (from + (to - from) * (i as f64 / last)).min(to))
                .collect(),
            states: Vec::with_capacity(self.frames),
        })
    }

    /// Writes the frames of a run, one at a time.
    ///
    /// # Errors
    /// A file cannot be written, or a frame cannot be computed.
    pub fn write(
        &self,
        spec: &SceneSpec,
        scene: &mut Scene,
        (bodies, states): (&[GearPicture], &[State]),
    ) -> Result<(), RunError> {
        let folder = self.folder.join(&self.name);
        let fail = |path: &Path| {
            let path = path.display().to_string();
            move |e: VtuError| RunError::Picture(format!("{path}: {e}"))
        };
        std::fs::create_dir_all(&folder).map_err(|e| fail(&folder)(e.into()))?;
        let mut collection = Vec::with_capacity(states.len());
        for (i, state) in states.iter().enumerate() {
            let file = format!("frame_{i:04}.vtu");
            let path = folder.join(&file);
            let frame = Frame::of(spec, scene, bodies, state)?;
            let written = File::create(&path).map_err(VtuError::from).and_then(|f| {
                let mut out = BufWriter::new(f);
                frame.write(&mut out, bodies, state.t)?;
                Ok(out.flush()?)
            });
            written.map_err(fail(&path))?;
            collection.push((state.t, format!("{}/{file}", self.name)));
        }
        let path = self.folder.join(format!("{}.pvd", self.name));
        let written = File::create(&path).and_then(|f| {
            let mut out = BufWriter::new(f);
            vtu::write_collection(&mut out, &collection)?;
            out.flush()
        });
        written.map_err(|e| fail(&path)(e.into()))
    }
}

/// Values at the nodes of all bodies, one gear after the other.
#[derive(Default)]
struct Frame {
    places: Vec<Vec3>,
    displacement: Vec<Vec3>,
    force: Vec<Vec3>,
    pressure: Vec<f64>,
    /// Number of the gear, from 1, in the order of the scene.
    gear: Vec<i32>,
    /// End of the nodes of each gear.
    ends: Vec<usize>,
}

impl Frame {
    fn of(
        spec: &SceneSpec,
        scene: &mut Scene,
        bodies: &[GearPicture],
        state: &State,
    ) -> Result<Self, RunError> {
        let mut frame = Frame::default();
        for (gear, body) in bodies.iter().enumerate() {
            let found = scene.displaced(state.at(), gear, body)?;
            let places = found.rigid.iter().zip(&found.displacement);
            frame.places.extend(places.map(|(x, u)| x + u));
            frame.displacement.extend(found.displacement);
            frame.gear.resize(frame.places.len(), gear as i32 + 1);
            frame.ends.push(frame.places.len());
        }
        frame.force.resize(frame.places.len(), Vec3::zeros());
        frame.pressure.resize(frame.places.len(), 0.0);
        for contact in scene.contact_forces(state.at()) {
            for (k, sign) in [-1.0, 1.0].into_iter().enumerate() {
                frame.add_force(spec.meshes[contact.mesh].gears[k], sign, &contact);
            }
        }
        Ok(frame)
    }

    fn nodes(&self, gear: usize) -> std::ops::Range<usize> {
        let begin = gear.checked_sub(1).map_or(0, |before| self.ends[before]);
        begin..self.ends[gear]
    }

    /// Adds the force of a contact to the nearest node of a gear.
    fn add_force(&mut self, gear: usize, sign: f64, contact: &ContactForce) {
        let off = |n: &usize| (self.places[*n] - contact.x).norm_squared();
        let nearest = self.nodes(gear).min_by(|a, b| off(a).total_cmp(&off(b)));
        let Some(node) = nearest else { return };
        self.force[node] += sign * contact.force;
        let pressure = match (contact.pressure, contact.extent) {
            (Some(line), _) => line.peak,
            // With equal weights of the nodes an area of 1 means that no area is known.
            (None, ContactExtent::Area(area)) if area < 1.0 => contact.normal_force / area,
            _ => 0.0,
        };
        self.pressure[node] = self.pressure[node].max(pressure);
    }

    fn write(
        &self,
        out: &mut dyn Write,
        bodies: &[GearPicture],
        time: f64,
    ) -> Result<(), VtuError> {
        let bodies: Vec<_> = (bodies.iter().enumerate())
            .map(|(gear, body)| (&self.places[self.nodes(gear)], &*body.cells))
            .collect();
        let fields = [
            ("displacement", Values::Vectors(&self.displacement)),
            ("contact_force", Values::Vectors(&self.force)),
            ("contact_pressure", Values::Scalars(&self.pressure)),
            ("gear", Values::Integers(&self.gear)),
        ];
        let fields = fields.map(|(name, values)| Field { name, values });
        vtu::write_frame(out, time, &bodies, &fields)
    }
}

/// Converts text to a file name of letters, digits and dashes.
pub fn file_name(text: &str) -> String {
    let of = |c: char| if c.is_ascii_alphanumeric() { c } else { '-' };
    let parts: String = text.chars().map(of).collect();
    let parts: Vec<&str> = parts.split('-').filter(|p| !p.is_empty()).collect();
    parts.join("-")
}

#[cfg(test)]
mod tests;
