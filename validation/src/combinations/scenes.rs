//! The scenes of the table of combinations: one toothing, mount, position of axes, model and contact each, small and under
//! load.

use gearbench::scene_file::format::*;
use gearbench_models::geometry::Side;
use std::fmt;

/// Declares a property of combinations: an enum with the names of its values in tables.
macro_rules! property {
    ($(#[$doc:meta])* $name:ident { $($(#[$of:meta])* $value:ident = $text:literal,)+ }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum $name {
            $($(#[$of])* $value,)+
        }

        impl $name {
            /// All values, in the order of the table.
            pub const ALL: &[$name] = &[$($name::$value,)+];
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(match self { $($name::$value => $text,)+ })
            }
        }
    };
}

property! {
    /// The gears in mesh.
    Toothing {
        /// Two spur gears.
        Spur = "spur",
        /// Two helical gears.
        Helical = "helical",
        /// A spur gear in a ring gear.
        Internal = "internal",
        /// A spur gear on a rack.
        Rack = "rack",
        /// Two conical gears on parallel axes.
        Conical = "conical",
    }
}

property! {
    /// The mount of the first gear; planets on a carrier are a scene of their own.
    Mount {
        /// Both gears turn about fixed axes.
        Revolute = "revolute",
        /// The speed of the second gear is prescribed.
        Driven = "driven",
        /// A guide with friction acts on the first gear.
        Guided = "guided",
        /// The hub of the first gear moves across and along its axis.
        Bearing = "bearing",
        /// The hub of the first gear also tilts.
        TiltingBearing = "bearing that tilts",
        /// The first gear sits on an elastic shaft with a body.
        Shaft = "elastic shaft",
        /// Planets on a carrier between a sun and a ring, of the teeth of the toothing.
        Carrier = "carrier",
    }
}

property! {
    /// Directions of the axes.
    Axes {
        /// The axes are parallel.
        Parallel = "parallel",
        /// The first axis is tilted by 0.02 degrees in the plane of action.
        Misaligned = "misaligned",
    }
}

property! {
    /// Models of the gears.
    Model {
        /// All gears are rigid.
        Rigid = "rigid",
        /// All gears have movable teeth.
        MovableTeeth = "movable-teeth",
        /// All gears are elastic.
        Elastic = "elastic",
        /// All gears are full finite elements.
        FullOrder = "fe",
        /// The first gear is elastic, the others are rigid.
        ElasticOnRigid = "elastic on rigid",
        /// The first gear is elastic, the others have movable teeth.
        ElasticOnMovable = "elastic on movable-teeth",
    }
}

property! {
    /// Contact of the flanks.
    Contact {
        /// Tooth pairs with the stiffness of ISO 6336.
        Pairs = "tooth pairs",
        /// Points with a penalty.
        Penalty = "penalty",
        /// Hard contact.
        Hard = "hard",
        /// Half-spaces.
        HalfSpace = "half-space",
    }
}

/// One scene of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Combination {
    pub toothing: Toothing,
    pub mount: Mount,
    pub axes: Axes,
    pub model: Model,
    pub contact: Contact,
}

/// Returns all combinations, in the order of the table.
pub fn all() -> Vec<Combination> {
    let mut all = Vec::new();
    for &toothing in Toothing::ALL {
        for &mount in Mount::ALL {
            for &axes in Axes::ALL {
                for &model in Model::ALL {
                    all.extend(Contact::ALL.iter().map(|&contact| Combination {
                        toothing,
                        mount,
                        axes,
                        model,
                        contact,
                    }));
                }
            }
        }
    }
    all
}

/// Module and face width of all gears [m].
const MODULE: f64 = 3e-3;
const WIDTH: f64 = 8e-3;
/// Helix angle of helical gears in degrees.
const HELIX: f64 = 15.0;
/// Teeth of the first and the second gear, of a ring gear and of the gears of a set.
const TEETH: [u32; 2] = [20, 28];
const RING: u32 = 76;
/// Speed of the first gear [rad/s] and its torque [N m].
const SPEED: f64 = 100.0;
const TORQUE: f64 = 15.0;
const PLANETS: [&str; 3] = ["p1", "p2", "p3"];

impl Combination {
    /// True if each of some words is one of its properties.
    pub fn has(&self, words: &[String]) -> bool {
        let own = [
            self.toothing.to_string(),
            self.mount.to_string(),
            self.axes.to_string(),
            self.model.to_string(),
            self.contact.to_string(),
        ];
        words.iter().all(|word| own.contains(word))
    }

    /// Returns the scene.
    pub fn scene(&self) -> SceneTable {
        let mut scene = match self.mount {
            Mount::Carrier => self.set(),
            _ => self.pair(),
        };
        scene.name = SceneName("combination".into());
        scene.models = vec![self.models(&scene)];
        scene
    }

    fn gear(&self, teeth: u32, sign: f64, further: GearTable) -> GearTable {
        let of =
            |toothing, value: f64| (self.toothing == toothing).then_some(Degrees(sign * value));
        GearTable {
            teeth,
            module_m: MODULE,
            face_width_m: WIDTH,
            bore_radius_m: 0.2 * f64::from(teeth) * MODULE,
            helix_angle_deg: of(Toothing::Helical, HELIX),
            profile_shift_angle_deg: of(Toothing::Conical, 4.0),
            ..further
        }
    }

    fn pair(&self) -> SceneTable {
        let internal = self.toothing == Toothing::Internal;
        let second_teeth = if internal { RING } else { TEETH[1] };
        // A ring turns with its pinion.
        let turns = if internal { 1.0 } else { -1.0 };
        let ratio = f64::from(TEETH[0]) / f64::from(second_teeth);
        let mut first = self.gear(TEETH[0], 1.0, turning(SPEED, TORQUE));
        let mut second = self.gear(
            second_teeth,
            -1.0,
            turning(turns * SPEED * ratio, -turns * TORQUE / ratio),
        );
        if internal {
            second.internal = true;
            second.addendum_factor = Some(0.85);
            second.bore_radius_m = 0.0;
        }
        if self.toothing == Toothing::Conical {
            let distance = 0.5 * f64::from(TEETH[0] + TEETH[1]) * MODULE;
            for (gear, x) in [(&mut first, 0.0), (&mut second, distance)] {
                gear.thinning_m = 30e-6;
                gear.axis = Some([0.0, 0.0, 1.0]);
                gear.position_m = Some(Position([x, 0.0, 0.0]));
            }
        }
        if self.axes == Axes::Misaligned {
            first.misalignment_deg = Some(misaligned());
        }
        let bearing = |tilts: f64| BearingTable {
            stiffness: Some([2e8, 2e8, 1e8, tilts, tilts, 0.0]),
            damping: Some([2e3, 2e3, 1e3, 1e-5 * tilts, 1e-5 * tilts, 0.0]),
            ..BearingTable::default()
        };
        let mut shafts = None;
        match self.mount {
            Mount::Revolute | Mount::Carrier => {}
            Mount::Driven => {
                second.mount = GearMount::Driven(Turning::speed_rad_s(turns * SPEED * ratio));
                second.loads = None;
                second.speed_rad_s = None;
            }
            Mount::Guided => {
                let guide = TurningGuide {
                    stiffness_nm_per_rad: None,
                    damping_nms_per_rad: Some(NotNegative(1e-3)),
                    friction_nm: Some(NotNegative(0.1)),
                    stick_rad: Some(Positive(1e-5)),
                    v_ref_rad_s: None,
                };
                if let Ok(guide) = CheckedGuide::new(guide) {
                    first.mount = GearMount::Guided(guide);
                }
            }
            Mount::Bearing => {
                first.bearing = Some(bearing(0.0));
                first.directions = Some(DirectionTable {
                    x: None,
                    y: None,
                    z: None,
                    tilt_x: Some(Tilt::Held),
                    tilt_y: Some(Tilt::Held),
                    tilt_z: None,
                });
            }
            Mount::TiltingBearing => first.bearing = Some(bearing(1e5)),
            Mount::Shaft => {
                first.loads = None;
                let body = StationTable {
                    body: Some("motor".into()),
                    inertia_kgm2: Some(NotNegative(2e-3)),
                    loads: Some(vec![GearLoad::torque_nm(TORQUE)]),
                    ..StationTable::default()
                };
                let gear = StationTable {
                    gear: Some("first".into()),
                    at_m: 0.1,
                    ..StationTable::default()
                };
                shafts = Some(vec![ShaftTable {
                    name: "input".into(),
                    carries: vec![body, gear],
                    sections: Some(vec![SectionTable {
                        length_m: Positive(0.1),
                        diameter_m: Some(Positive(0.025)),
                        ..SectionTable::default()
                    }]),
                    damping_ratio: Some(NotNegative(0.02)),
                    speed_rad_s: Some(SPEED),
                    ..ShaftTable::default()
                }]);
            }
        }
        let mut gears: OrderedTable<ToothedTable> = [("first", first)].into_iter().collect();
        gears.0.push(match self.toothing {
            Toothing::Rack => ("second".into(), self.rack().into()),
            _ => ("second".into(), second.into()),
        });
        let mesh = MeshTable {
            gears: ["first".into(), "second".into()],
            backlash_m: (self.toothing != Toothing::Conical).then_some(50e-6),
            start: Some(loaded(Side::Left)),
            ..MeshTable::default()
        };
        SceneTable {
            duration_s: Positive(DURATION),
            gears,
            meshes: vec![mesh],
            shafts,
            ..SceneTable::default()
        }
    }

    fn rack(&self) -> RackTable {
        let radius = 0.5 * f64::from(TEETH[0]) * MODULE;
        // A prescribed motion has its own speed, and needs no load.
        let driven = self.mount == Mount::Driven;
        RackTable {
            teeth: 11,
            module_m: MODULE,
            face_width_m: WIDTH,
            speed_m_s: (!driven).then_some(SPEED * radius),
            mount: match driven {
                true => RackMount::Driven(Sliding::speed_m_s(SPEED * radius)),
                false => RackMount::default(),
            },
            loads: (!driven).then(|| vec![RackLoad::force_n(-TORQUE / radius)]),
            ..RackTable::default()
        }
    }

    /// A sun, three planets on a carrier and a ring that is held; spur or helical. Other toothings have no such set: an
    /// internal one is that of spur gears, the others are refused when they are read.
    fn set(&self) -> SceneTable {
        let across = match self.toothing {
            Toothing::Helical => HELIX.to_radians().cos(),
            _ => 1.0,
        };
        let distance = 0.5 * f64::from(TEETH[0] + TEETH[1]) * MODULE / across;
        let carrier = f64::from(TEETH[0]) / f64::from(TEETH[0] + RING);
        let centre = Some(Position([0.0; 3]));
        let thinned = |own: GearTable| GearTable {
            thinning_m: 30e-6,
            ..own
        };
        let mut sun = self.gear(TEETH[0], 1.0, thinned(turning(SPEED, TORQUE)));
        sun.position_m = centre;
        if self.axes == Axes::Misaligned {
            sun.misalignment_deg = Some(misaligned());
        }
        let ring = GearTable {
            internal: true,
            addendum_factor: Some(0.85),
            position_m: centre,
            mount: GearMount::Fixed,
            ..self.gear(RING, -1.0, GearTable::default())
        };
        let ring = GearTable {
            bore_radius_m: 0.0,
            ..ring
        };
        let planet = || self.gear(TEETH[1], -1.0, thinned(GearTable::default()));
        let gears = [("sun", sun)]
            .into_iter()
            .chain(PLANETS.map(|name| (name, planet())))
            .chain([("ring", ring)]);
        let mesh = |gears: [&str; 2], start: Option<StartTable>| MeshTable {
            gears: gears.map(GearName::from),
            start,
            ..MeshTable::default()
        };
        let inner = PLANETS.into_iter().zip([0.0, 120.0, 240.0]);
        let inner = inner.map(|(name, direction)| MeshTable {
            centre_distance_m: Some(Positive(distance)),
            direction_deg: Some(Degrees(direction)),
            ..mesh(["sun", name], None)
        });
        // Planets press on the ring with their right flanks; the other meshes close loops.
        let starts = [Some(loaded(Side::Right)), None, None];
        let outer = PLANETS.into_iter().zip(starts);
        let outer = outer.map(|(name, start)| mesh([name, "ring"], start));
        let arm = StationTable {
            body: Some("carrier".into()),
            inertia_kgm2: Some(NotNegative(2e-3)),
            planets: Some(PLANETS.map(GearName::from).to_vec()),
            speed_rad_s: Some(SPEED * carrier),
            loads: Some(vec![GearLoad::torque_nm(-TORQUE / carrier)]),
            ..StationTable::default()
        };
        SceneTable {
            duration_s: Positive(DURATION),
            gears: gears.collect(),
            meshes: inner.chain(outer).collect(),
            shafts: Some(vec![ShaftTable {
                name: "arm".into(),
                carries: vec![arm],
                ..ShaftTable::default()
            }]),
            ..SceneTable::default()
        }
    }

    fn models(&self, scene: &SceneTable) -> ModelTable {
        let elastic: OrderedTable<ParameterValue> = [
            ("modes", 12.0),
            ("flank_elements", 4.0),
            ("fillet_elements", 2.0),
            ("across_elements", 4.0),
            ("rim_elements", 2.0),
            ("width_elements", 2.0),
            ("damping_ratio", 0.02),
        ]
        .into_iter()
        .collect();
        let full: OrderedTable<ParameterValue> = OrderedTable(
            (elastic
                .0
                .iter()
                .filter(|(key, _)| !["modes", "damping_ratio"].contains(&key.as_str())))
            .cloned()
            .collect(),
        );
        let teeth: OrderedTable<ParameterValue> = [
            ("tooth_stiffness_n_per_m", 4e8),
            ("tooth_mass_kg", 2e-3),
            ("tooth_damping_ns_per_m", 50.0),
        ]
        .into_iter()
        .collect();
        let others = |own: GearModelEntry| {
            let names = scene.gears.0.iter().skip(1).map(|(name, _)| name.clone());
            OrderedTable(names.map(|name| (name, own.clone())).collect())
        };
        let (model, parameters, gears) = match self.model {
            Model::Rigid => ("rigid", OrderedTable::default(), OrderedTable::default()),
            Model::MovableTeeth => ("movable-teeth", teeth, OrderedTable::default()),
            Model::Elastic => ("elastic", elastic, OrderedTable::default()),
            Model::FullOrder => ("fe", full, OrderedTable::default()),
            Model::ElasticOnRigid => (
                "elastic",
                elastic,
                others(GearModelEntry::Id("rigid".into())),
            ),
            Model::ElasticOnMovable => (
                "elastic",
                elastic,
                others(GearModelEntry::Own(GearModelTable {
                    model: "movable-teeth".into(),
                    parameters: teeth,
                })),
            ),
        };
        let contact = match self.contact {
            Contact::Pairs => ContactTable {
                stiffness: Some(StiffnessTable::Iso6336(IsoTable::default())),
                ..ContactTable::default()
            },
            Contact::Penalty => ContactTable {
                penalty_pa_per_m: Some(1e15),
                ..ContactTable::default()
            },
            Contact::Hard => ContactTable {
                law: Some(LawWord::Hard),
                ..ContactTable::default()
            },
            Contact::HalfSpace => ContactTable {
                local: Some(LocalContact::HalfSpace),
                ..ContactTable::default()
            },
        };
        ModelTable {
            model: model.into(),
            gears,
            parameters,
            contact: OneOrMany::One(contact),
            ..ModelTable::default()
        }
    }
}

/// Simulated time of each scene [s].
const DURATION: f64 = 2e-5;

fn turning(speed: f64, torque: f64) -> GearTable {
    GearTable {
        speed_rad_s: Some(speed),
        loads: Some(vec![GearLoad::torque_nm(torque)]),
        ..GearTable::default()
    }
}

/// The tilt of misaligned axes.
fn misaligned() -> MisalignmentTable {
    MisalignmentTable {
        plane_of_action: Some(Degrees(0.02)),
        across: None,
        about: None,
        angle: None,
    }
}

fn loaded(flank: Side) -> StartTable {
    StartTable {
        flank: Some(flank),
        loaded: true,
        ..StartTable::default()
    }
}
