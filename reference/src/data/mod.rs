//! References as data: histories with times of their own and where they come from, whatever their origin.
//!
//! A stored run of another program, a table of the user and a run of a model of gearbench all are a [`Reference`]: SI
//! units, the gears and meshes of a scene by their place in it, every contact force the normal force of its mesh.
//!
//! | module | owns |
//! |---|---|
//! | `table` | the text of a CSV file: byte order mark, delimiter, comments, the line of names, rows |
//! | `columns` | which column is which quantity, by what the user says or by its name |
//! | `units` | units of headers, and their factors |
//! | `read` | numbers, times and what is wrong with them |
//! | `process` | offset, moving average, window, even times |
//!
//! **Force.** A transverse force F_t is the part of a normal force F in the plane of rotation: `F = F_t / cos(beta_b)`, with
//! the base helix angle beta_b (ISO 21771). It is converted where it is read, and the lines of
//! [`Reference::processing`] say so.
//!
//! **Transmission error.** In units of angle it is that of the second gear of its mesh, and `r_b2` times as much along the line
//! of action, with that gear's base radius.

mod columns;
mod curves;
mod process;
mod read;
mod table;
#[cfg(test)]
mod tests;
mod units;

pub use curves::{Curve, curves};
pub use process::Processing;
pub use read::{Request, read};
pub use table::{Delimiter, TableError, decode};
pub use units::{Dimension, factor};

/// Quantity of a history; gears, bodies behind them, meshes and spans of shafts are numbered by their position in the
/// scene, from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Quantity {
    /// Normal contact force of a mesh, the magnitude of the sum over its tooth pairs [N].
    Force(usize),
    /// Transmission error of a mesh along its line of action [m].
    TransmissionError(usize),
    /// Angular velocity of a gear [rad/s], speed of a rack [m/s].
    Speed(usize),
    /// Angle through which a hub has turned since the start [rad], way of a rack [m].
    Angle(usize),
    /// Torque of the contact forces on a gear about its axis [N m], force along the slide of a rack [N].
    Torque(usize),
    /// Torque of the mount that fixes or drives a gear [N m], for a rack its force along the motion [N].
    MountTorque(usize),
    /// Torque of a member on the next one through their shaft or stage [N m], by the span between them.
    ShaftTorque(usize),
}

impl Quantity {
    /// Returns the name of the quantity in prose.
    pub fn words(self) -> &'static str {
        match self {
            Quantity::Force(_) => "contact force",
            Quantity::TransmissionError(_) => "transmission error",
            Quantity::Speed(_) => "speed",
            Quantity::Angle(_) => "angle",
            Quantity::Torque(_) => "torque",
            Quantity::MountTorque(_) => "mount torque",
            Quantity::ShaftTorque(_) => "shaft torque",
        }
    }
}

/// Which part of a contact force a history has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ForceKind {
    /// Contact force normal to the flanks.
    #[default]
    Normal,
    /// Its part in the plane of rotation.
    Transverse,
}

/// A history with its own times.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Quantity of the history.
    pub quantity: Quantity,
    /// Times [s], strictly increasing, from 0 on.
    pub time: Vec<f64>,
    /// Values in SI units, one for each time.
    pub value: Vec<f64>,
}

/// A reference: histories with their source and processing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reference {
    /// Id in records, metrics and tolerances.
    pub id: String,
    /// Name of the reference in legends.
    pub title: String,
    /// Where the data come from: program, file, who made it and how.
    pub source: String,
    /// Note for the assessment of the reference; may be empty.
    pub note: String,
    /// Command that makes them again.
    pub command: Option<String>,
    /// Own error of the data, as a share of the quantities that models are compared in [-].
    pub own_error: Option<f64>,
    /// Processor time that they cost [s].
    pub cpu_s: Option<f64>,
    /// The histories, each quantity once.
    pub channels: Vec<Channel>,
    /// Processing of the data from their file to here, one line each: units, kind of force, offset, filter.
    pub processing: Vec<String>,
    /// Conditions that the file states itself, by the keys of a scene, such as `gears.pinion.speed_rad_s`.
    pub stated: Vec<(String, f64)>,
}

impl Reference {
    /// Returns the history of a quantity, if there is one.
    pub fn channel(&self, quantity: Quantity) -> Option<&Channel> {
        self.channels.iter().find(|c| c.quantity == quantity)
    }

    /// Times and values of the contact force of the first mesh [s, N].
    pub fn force(&self) -> Option<(&[f64], &[f64])> {
        let found = self.channel(Quantity::Force(0))?;
        Some((&found.time, &found.value))
    }

    /// The last time of all histories [s].
    pub fn end(&self) -> f64 {
        let last = self.channels.iter().filter_map(|c| c.time.last());
        last.copied().fold(0.0, f64::max)
    }
}

/// A gear, or a body on a shaft, that columns may be of.
#[derive(Clone, Debug, PartialEq)]
pub struct GearSubject {
    /// Its name in the scene.
    pub name: String,
    /// Of a rack, the reference radius of its mate [m], over which angular velocities become its speed; `None` of a gear.
    pub slides: Option<f64>,
    /// True for a gear; bodies have no contact forces, and no number by which columns may name them.
    pub toothed: bool,
}

/// A mesh that columns may be of.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshSubject {
    /// Names of its gears.
    pub gears: [String; 2],
    /// Base helix angle [rad].
    pub base_helix: f64,
    /// Base radius of the second gear [m], which converts a transmission error in rad to one along the line of action;
    /// `None` for a rack.
    pub base_radius: Option<f64>,
}

/// Gears, bodies, meshes and shafts of a scene, as far as columns are about them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Subjects {
    /// Gears in the order of the scene, then bodies on shafts.
    pub gears: Vec<GearSubject>,
    /// Names of the neighbours on shafts and of the members of stages, between which torques act.
    pub spans: Vec<[String; 2]>,
    /// Meshes in its order.
    pub meshes: Vec<MeshSubject>,
    /// Rotation of the first gear of the first mesh at constant speed, which converts a table over its angle of
    /// rotation to one over time.
    pub turning: Option<Turning>,
}

/// Steady rotation of a gear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turning {
    /// Its angular velocity [rad/s].
    pub speed: f64,
    /// Its number of teeth.
    pub teeth: u32,
}

impl Subjects {
    /// Returns the name of a quantity with its subject, such as `speed of pinion`.
    pub fn told(&self, quantity: Quantity) -> String {
        let mesh = |m: usize| match self.meshes.get(m) {
            Some(mesh) if m > 0 => format!(" of {}-{}", mesh.gears[0], mesh.gears[1]),
            _ => String::new(),
        };
        let gear = |g: usize| self.gears.get(g).map_or("", |g| g.name.as_str());
        let words = quantity.words();
        match quantity {
            Quantity::Force(m) | Quantity::TransmissionError(m) => format!("{words}{}", mesh(m)),
            Quantity::ShaftTorque(s) => match self.spans.get(s) {
                Some([a, b]) => format!("{words} of {a}-{b}"),
                None => words.to_owned(),
            },
            Quantity::Speed(g)
            | Quantity::Angle(g)
            | Quantity::Torque(g)
            | Quantity::MountTorque(g) => {
                format!("{words} of {}", gear(g))
            }
        }
    }

    /// Returns the dimension of the values of a quantity.
    pub fn dimension(&self, quantity: Quantity) -> Dimension {
        let slides = |g: usize| self.gears.get(g).is_some_and(|g| g.slides.is_some());
        match quantity {
            Quantity::Force(_) => Dimension::Force,
            Quantity::TransmissionError(_) => Dimension::Length,
            Quantity::Speed(g) if slides(g) => Dimension::Velocity,
            Quantity::Speed(_) => Dimension::Turning,
            Quantity::Angle(g) if slides(g) => Dimension::Length,
            Quantity::Angle(_) => Dimension::Angle,
            Quantity::Torque(g) | Quantity::MountTorque(g) if slides(g) => Dimension::Force,
            Quantity::Torque(_) | Quantity::MountTorque(_) | Quantity::ShaftTorque(_) => {
                Dimension::Torque
            }
        }
    }

    /// All quantities that columns may be of.
    pub(crate) fn quantities(&self) -> impl Iterator<Item = Quantity> {
        let meshes = 0..self.meshes.len();
        let gears = 0..self.gears.len();
        let of_meshes = meshes.flat_map(|m| [Quantity::Force(m), Quantity::TransmissionError(m)]);
        let of_gears = gears.flat_map(|g| {
            let all = [
                Quantity::Speed(g),
                Quantity::Angle(g),
                Quantity::Torque(g),
                Quantity::MountTorque(g),
            ];
            let toothed = self.gears[g].toothed;
            (all.into_iter()).filter(move |q| toothed || !matches!(q, Quantity::Torque(_)))
        });
        let of_spans = (0..self.spans.len()).map(Quantity::ShaftTorque);
        of_meshes.chain(of_gears).chain(of_spans)
    }
}
