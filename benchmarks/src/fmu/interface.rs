//! FMI variables of a scene with names, units and roles. The value reference of a variable is its index in the list.

use super::coupled::{InputQuantity, Port};
use gearbench_integrators::SecondOrderSystem;
use gearbench_models::scene::{Channel, OfGear, OfMesh, Scene};
use gearbench_models::spec::SceneSpec;
use gearbench_reference::hash::Hash;

/// Largest number of coordinates for which the states are variables; larger scenes serve co-simulation only.
const MOST_COORDINATES: usize = 500;

/// Quantity that an input variable sets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Torque [N m] or force [N].
    Load,
    /// Angle [rad] or displacement [m].
    Place,
    /// Rate of the angle or displacement.
    Speed,
}

/// Role of a variable in the FMU.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The independent variable, time [s].
    Time,
    /// The parameter that enables the inputs for the end of a communication step.
    Interpolate,
    /// An input of a port, for the start of a communication step or for its end.
    Input {
        /// Index of the port.
        port: usize,
        /// The quantity that the input sets.
        quantity: Quantity,
        /// True if the input is the value at the end of the communication step.
        end: bool,
    },
    /// An output: a channel of the scene, by index.
    Output(usize),
    /// A continuous state, by index: coordinates, then velocities.
    State(usize),
    /// Time derivative of the state with this index.
    Derivative(usize),
    /// An event function of the scene, by index; an event indicator in FMI.
    EventFunction(usize),
}

/// A variable of the model description.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// Name, unique within the FMU.
    pub name: String,
    /// Role of the variable.
    pub role: Role,
    /// Name of the unit; empty if dimensionless.
    pub unit: &'static str,
    /// Description in one line.
    pub description: String,
    /// Initial value, for variables that can be set.
    pub start: Option<f64>,
}

/// All variables of an FMU and the sizes of its states.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Interface {
    /// The variables, in the order of their value references.
    pub variables: Vec<Variable>,
    /// Number of continuous states: twice the coordinates.
    pub states: usize,
    /// Number of event functions.
    pub event_functions: usize,
    /// True if states and event functions are variables, as model exchange requires.
    pub exchanges: bool,
}

impl Interface {
    /// Builds the variables of a scene whose host acts at `ports`.
    pub fn of(spec: &SceneSpec, scene: &Scene, ports: &[Port]) -> Self {
        let layout = scene.layout();
        let mut all = Interface {
            states: 2 * layout.n,
            event_functions: layout.event_functions,
            exchanges: layout.n <= MOST_COORDINATES,
            ..Interface::default()
        };
        all.add(Role::Time, "time", "s", "time", None);
        all.add(
            Role::Interpolate,
            "interpolate",
            "",
            "inputs run from their values to those that end in _end over a communication step; else they hold their values",
            Some(0.0),
        );
        for (i, port) in ports.iter().enumerate() {
            all.add_input(i, port);
        }
        all.add_outputs(spec, scene, ports);
        if all.exchanges {
            all.add_states(scene);
        }
        all
    }

    fn add(
        &mut self,
        role: Role,
        name: impl Into<String>,
        unit: &'static str,
        description: impl Into<String>,
        start: Option<f64>,
    ) {
        self.variables.push(Variable {
            name: name.into(),
            role,
            unit,
            description: description.into(),
            start,
        });
    }

    fn add_input(&mut self, i: usize, port: &Port) {
        let member = &port.name;
        let [load, place, speed] = match port.slides {
            false => [("torque", "N.m"), ("angle", "rad"), ("speed", "rad/s")],
            true => [("force", "N"), ("displacement", "m"), ("speed", "m/s")],
        };
        let about = match port.slides {
            false => "about its axis",
            true => "along its slide",
        };
        let quantities = match port.acts {
            InputQuantity::Load(_) => vec![(Quantity::Load, load, 0.0, "that the host applies")],
            InputQuantity::Motion => vec![
                (Quantity::Place, place, 0.0, "from the assembled position"),
                (Quantity::Speed, speed, port.speed, "of its hub"),
            ],
        };
        for (quantity, (what, unit), start, which) in quantities {
            for end in [false, true] {
                let (suffix, when) = match end {
                    false => ("", ""),
                    true => ("_end", ", at the end of a communication step"),
                };
                let port = i;
                self.add(
                    Role::Input {
                        port,
                        quantity,
                        end,
                    },
                    format!("{member}.{what}{suffix}"),
                    unit,
                    format!("{what} of {member} {about} {which}{when}"),
                    Some(start),
                );
            }
        }
    }

    fn add_outputs(&mut self, spec: &SceneSpec, scene: &Scene, ports: &[Port]) {
        for (i, gear) in scene.gears().iter().enumerate() {
            // Nodes of an elastic shaft have no name of their own.
            if gear.name.is_empty() || spec.member_name(i) != gear.name {
                continue;
            }
            let hub = gear.model.hub();
            let moved = ports
                .iter()
                .any(|p| p.member == i && p.acts == InputQuantity::Motion);
            for what in OfGear::ALL {
                let is_motion = matches!(what, OfGear::HubSpeed | OfGear::Displacement);
                let aside = OfGear::aside().contains(&what);
                if what == OfGear::Speed || (is_motion && moved) || (aside && hub.lateral.is_none())
                {
                    continue;
                }
                if let Some(channel) = scene.channel(Channel::Gear(i, what)) {
                    let slides = hub.slide.is_some();
                    let (name, description) = of_gear(what, slides);
                    self.add(
                        Role::Output(channel),
                        format!("{}.{name}", gear.name),
                        unit(what.unit(slides)),
                        format!("{}: {description}", gear.name),
                        None,
                    );
                }
            }
        }
        for (m, mesh) in spec.meshes.iter().enumerate() {
            let [a, b] = spec.names_of(mesh.gears);
            for (what, name, description) in [
                (OfMesh::Force, "force", "contact force, magnitude"),
                (OfMesh::X, "force_x", "contact force on the second gear, x"),
                (OfMesh::Y, "force_y", "contact force on the second gear, y"),
                (OfMesh::Z, "force_z", "contact force on the second gear, z"),
            ] {
                if let Some(channel) = scene.channel(Channel::Mesh(m, what)) {
                    self.add(
                        Role::Output(channel),
                        format!("{a}_{b}.{name}"),
                        "N",
                        format!("{a} on {b}: {description}"),
                        None,
                    );
                }
            }
        }
        let mut span = 0;
        while let Some(channel) = scene.channel(Channel::ShaftTorque(span)) {
            let column = Channel::ShaftTorque(span).column(spec);
            self.add(
                Role::Output(channel),
                column.trim_end_matches("_nm"),
                "N.m",
                "torque that a station of a shaft exerts on the next one",
                None,
            );
            span += 1;
        }
    }

    fn add_states(&mut self, scene: &Scene) {
        let start = scene.initial();
        let n = start.q.len();
        let mut names = vec![String::new(); n];
        for (k, gear) in scene.gears().iter().enumerate() {
            let name = match gear.name.as_str() {
                "" => format!("member_{}", k + 1),
                name => name.to_owned(),
            };
            for (i, place) in gear.range().enumerate() {
                names[place] = format!("{name}.q[{}]", i + 1);
            }
        }
        let velocity = |name: &String| name.replacen(".q[", ".v[", 1);
        for (i, name) in names.iter().enumerate() {
            let role = Role::State(i);
            self.add(role, name, "", "coordinate", Some(start.q[i]));
        }
        for (i, name) in names.iter().map(velocity).enumerate() {
            let role = Role::State(n + i);
            self.add(role, name, "", "its rate", Some(start.v[i]));
        }
        for (i, name) in names.iter().enumerate() {
            self.add(Role::Derivative(i), format!("der({name})"), "", "", None);
        }
        for (i, name) in names.iter().map(velocity).enumerate() {
            let role = Role::Derivative(n + i);
            self.add(role, format!("der({name})"), "", "", None);
        }
        for i in 0..self.event_functions {
            let name = format!("event_function[{}]", i + 1);
            let what = "positive until its part of the branch ends";
            self.add(Role::EventFunction(i), name, "", what, None);
        }
    }

    /// The value reference of the variable with a name.
    pub fn reference(&self, name: &str) -> Option<u32> {
        let place = self.variables.iter().position(|v| v.name == name)?;
        u32::try_from(place).ok()
    }

    /// Hash of the list of variables; two builds of the program agree in it only if they number the variables alike.
    pub fn key(&self) -> String {
        let mut hash = Hash::START;
        for v in &self.variables {
            hash.text(&v.name);
            hash.text(&format!("{:?}", v.role));
        }
        hash.to_string()
    }
}

fn of_gear(what: OfGear, slides: bool) -> (&'static str, &'static str) {
    let way = |turn: (&'static str, &'static str), slide| if slides { slide } else { turn };
    match what {
        OfGear::Speed => ("mean_speed", "momentum over inertia"),
        OfGear::HubSpeed => ("speed", "speed of the hub"),
        OfGear::Displacement => way(
            ("angle", "turn of the hub from the assembled position"),
            (
                "displacement",
                "slide of the hub from the assembled position",
            ),
        ),
        OfGear::ContactTorque => way(
            (
                "contact_torque",
                "torque of contact forces about the axis of the hub",
            ),
            ("contact_force", "contact forces along the slide of the hub"),
        ),
        OfGear::BearingX => ("mount_force_x", "what the mount exerts along x"),
        OfGear::BearingY => ("mount_force_y", "what the mount exerts along y"),
        OfGear::BearingZ => ("mount_force_z", "what the mount exerts along z"),
        OfGear::MountTorque => way(
            (
                "mount_torque",
                "what the mount of a held or moved hub exerts about its axis",
            ),
            (
                "mount_force",
                "what the mount of a held or moved hub exerts along its slide",
            ),
        ),
        OfGear::ShiftX => ("shift_x", "shift along the first axis of the hub"),
        OfGear::ShiftY => ("shift_y", "shift along the second axis of the hub"),
        OfGear::ShiftZ => ("shift_z", "shift along the axis of the gear"),
        OfGear::TiltX => ("tilt_x", "tilt about the first axis of the hub"),
        OfGear::TiltY => ("tilt_y", "tilt about the second axis of the hub"),
    }
}

/// The unit in a model description for the unit suffix of a column.
fn unit(column: &str) -> &'static str {
    match column {
        "rad_s" => "rad/s",
        "m_s" => "m/s",
        "rad" => "rad",
        "m" => "m",
        "nm" => "N.m",
        _ => "N",
    }
}
