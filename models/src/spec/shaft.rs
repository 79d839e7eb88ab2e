//! Shafts with several gears, and bodies without teeth on them.

use super::load::Load;
use super::mount::{Guide, Mount, OutOfPlaneSpec};
use crate::error::{BuildError, Reason};
use crate::stiffness::Material;

/// A shaft: the members that it carries from one end to the other, and the sections between them.
///
/// Without sections it is rigid: all that it carries moves as one body. With sections it is an elastic beam; it is twisted
/// only, unless something on it may move sideways, and then it bends and stretches as well.
#[derive(Clone, Debug, Default)]
pub struct ShaftSpec {
    /// Name, unique among the shafts of a scene.
    pub name: String,
    /// Members on the shaft, in the order of their positions.
    pub stations: Vec<Station>,
    /// Sections from the start of the shaft on; empty for a rigid shaft.
    pub sections: Vec<Section>,
    /// Damping of the sections.
    pub damping: ShaftDamping,
}

/// Position of a member on a shaft.
#[derive(Clone, Debug)]
pub struct Station {
    /// Distance from the start of the shaft [m].
    pub place: f64,
    /// Member at the station.
    pub carries: StationMember,
}

/// Member at a station of a shaft.
#[derive(Clone, Debug)]
pub enum StationMember {
    /// A gear of the scene, by index.
    Gear(usize),
    /// A body without teeth.
    Body(Box<BodySpec>),
}

/// A body without teeth on a shaft: the rotor of a motor, a flywheel, a load, the position of a bearing.
#[derive(Clone, Debug)]
pub struct BodySpec {
    /// Name, unique among gears and bodies of the scene.
    pub name: String,
    /// Inertia about the axis [kg m^2], in addition to that of the shaft; may be zero.
    pub inertia: f64,
    /// Mount of the body.
    pub mount: Mount,
    /// Support about its axis where the mount leaves that free.
    pub guide: Option<Guide>,
    /// Bearing, and mass and inertia tensor where the shaft bends; `None` uses those of the shaft.
    pub lateral: Option<Box<OutOfPlaneSpec>>,
    /// Initial speed [rad/s].
    pub speed: f64,
    /// Torques about the axis.
    pub loads: Vec<Load>,
    /// Gears of the scene whose axes rotate with the body, by index: a planet carrier. A planet with a bearing is on
    /// an elastic pin, others are on rigid ones.
    pub planets: Vec<usize>,
}

/// A piece of an elastic shaft with one cross-section.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// Length of the section [m].
    pub length: f64,
    /// Kind of the section.
    pub kind: SectionKind,
    /// Number of beam elements, at least one; a station within a section divides it as well.
    pub divisions: usize,
    /// Damping over stiffness of this section [s]; `None` uses the damping of the shaft.
    pub damping: Option<f64>,
}

/// Kind of a section of a shaft.
#[derive(Clone, Debug, PartialEq)]
pub enum SectionKind {
    /// A round bar or a tube.
    Round {
        /// Outer and inner diameter [m].
        diameters: [f64; 2],
        /// Material of the bar.
        material: Material,
    },
    /// A coupling: a torsional spring without mass that resists in no other direction.
    Coupling {
        /// Torque per unit twist of the whole section [N m/rad].
        stiffness: f64,
    },
}

/// Damping of an elastic shaft, in proportion to its stiffness.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ShaftDamping {
    /// The shaft has no damping.
    #[default]
    None,
    /// Time constant of the damping, `c = time k` [s].
    Time(f64),
    /// Damping ratio at the lowest natural frequency of torsion, of bending and of stretching, each of the shaft with
    /// its members, without meshes and bearings [-].
    Ratio(f64),
}

impl BodySpec {
    /// Creates a body that rotates freely.
    pub fn new(name: &str, inertia: f64) -> Self {
        BodySpec {
            name: name.into(),
            inertia,
            mount: Mount::Revolute,
            guide: None,
            lateral: None,
            speed: 0.0,
            loads: Vec::new(),
            planets: Vec::new(),
        }
    }
}

impl ShaftSpec {
    /// Returns the length of its sections [m].
    pub fn length(&self) -> f64 {
        self.sections.iter().map(|s| s.length).sum()
    }

    /// Returns its bodies without teeth.
    pub fn bodies(&self) -> impl Iterator<Item = &BodySpec> {
        self.stations.iter().filter_map(|s| match &s.carries {
            StationMember::Body(body) => Some(body.as_ref()),
            StationMember::Gear(_) => None,
        })
    }

    /// Creates an error about the shaft.
    pub(crate) fn refuse(&self, why: impl Into<Reason>) -> BuildError {
        BuildError::shaft(&self.name, why)
    }

    /// Checks the shaft itself.
    pub(crate) fn check(&self) -> Result<(), BuildError> {
        let length = self.length();
        for (i, section) in self.sections.iter().enumerate() {
            if let Some(why) = section.problem() {
                return Err(self.refuse((format!("section {}: {}", i + 1, why.0), why.1)));
            }
        }
        if !length.is_finite() {
            return Err(self.refuse((
                "its sections are longer than any number",
                "give lengths in metres",
            )));
        }
        let damping = match self.damping {
            ShaftDamping::None => 0.0,
            ShaftDamping::Time(x) | ShaftDamping::Ratio(x) => x,
        };
        if !(damping >= 0.0 && damping.is_finite()) {
            return Err(self.refuse((
                format!("the damping {damping} is not zero or positive"),
                "give a time in seconds or a ratio such as 0.01",
            )));
        }
        if self.sections.is_empty() && damping > 0.0 {
            return Err(self.refuse((
                "damping has no effect on a rigid shaft",
                "give its sections, or remove the damping",
            )));
        }
        let rigid = self.sections.is_empty();
        // A carrier may be the only body of a shaft.
        let carries = self.bodies().any(|b| !b.planets.is_empty());
        if self.stations.len() < 2 && rigid && !carries {
            return Err(self.refuse((
                format!(
                    "a rigid shaft joins at least two members, but carries {}",
                    self.stations.len()
                ),
                "name two gears or bodies, or remove the shaft",
            )));
        }
        let mut last = f64::NEG_INFINITY;
        for station in &self.stations {
            let z = station.place;
            if !(z.is_finite() && z > last) {
                return Err(self.refuse((
                    format!("the place {z} m does not come after the one before it, {last} m"),
                    "give different places in ascending order",
                )));
            }
            if !rigid && !(-1e-9 * length..=length * (1.0 + 1e-9)).contains(&z) {
                return Err(self.refuse((
                    format!(
                        "the place {z} m is not on the shaft, whose sections end at {length} m"
                    ),
                    "give a place between 0 and the sum of the lengths",
                )));
            }
            last = z;
        }
        for body in self.bodies() {
            self.check_body(body)?;
        }
        Ok(())
    }

    fn check_body(&self, body: &BodySpec) -> Result<(), BuildError> {
        let name = &body.name;
        let refuse = |why: String| Err(self.refuse(format!("body `{name}`: {why}")));
        if !(body.inertia >= 0.0 && body.inertia.is_finite()) {
            return refuse(format!("inertia {} is not zero or positive", body.inertia));
        }
        if matches!(body.mount, Mount::Prismatic) {
            return refuse("a body on a shaft rotates and cannot translate".into());
        }
        if let Mount::Driven(p) = &body.mount
            && let Some(problem) = p.problem()
        {
            return refuse(format!("driven motion: {problem}"));
        }
        for load in &body.loads {
            let problem = match load {
                Load::Applied(p) => p.problem(),
                Load::Viscous(c) if !(c.is_finite() && *c >= 0.0) => {
                    Some(format!("viscous coefficient {c} is not zero or positive"))
                }
                Load::Viscous(_) => None,
            };
            if let Some(problem) = problem {
                return refuse(format!("load: {problem}"));
            }
        }
        Ok(())
    }
}

impl Section {
    /// Returns the problem of an invalid section, with a remedy.
    fn problem(&self) -> Option<(String, &'static str)> {
        let good = |x: f64| x > 0.0 && x.is_finite();
        if !good(self.length) {
            return Some((
                format!("the length {} m is not positive", self.length),
                "give a length in metres",
            ));
        }
        if self.divisions == 0 {
            return Some(("no element".into(), "give at least one division"));
        }
        if let Some(time) = self.damping.filter(|t| !(*t >= 0.0 && t.is_finite())) {
            return Some((
                format!("the damping {time} s is not zero or positive"),
                "give a time in seconds, damping over stiffness",
            ));
        }
        match &self.kind {
            SectionKind::Coupling { stiffness } => (!good(*stiffness)).then(|| {
                (
                    format!("the torsional stiffness {stiffness} N m/rad is not positive"),
                    "give a positive one; a rigid shaft has no sections",
                )
            }),
            SectionKind::Round {
                diameters: [outer, inner],
                material,
            } => {
                if !(good(*outer) && *inner >= 0.0 && inner < outer) {
                    return Some((
                        format!(
                            "outer diameter {outer} m, inner {inner} m: the wall thickness is not positive"
                        ),
                        "give an outer diameter that is larger than the inner one",
                    ));
                }
                let sound = good(material.young)
                    && material.poisson > -1.0
                    && material.poisson <= 0.5
                    && material.density >= 0.0
                    && material.density.is_finite();
                (!sound).then(|| {
                    (
                        "Young's modulus, Poisson's ratio or density are outside the range of materials"
                            .into(),
                        "steel has 2.1e11 Pa, 0.3, 7850 kg/m3",
                    )
                })
            }
        }
    }
}

/// Returns the initial speed of a body [rad/s].
pub fn initial_speed(mount: &Mount, speed: f64) -> f64 {
    match mount {
        Mount::Driven(p) => p.value(0.0),
        Mount::Fixed => 0.0,
        Mount::Revolute | Mount::Prismatic => speed,
    }
}
