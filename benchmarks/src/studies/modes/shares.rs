//! Where the energies of a mode lie, how its members move, and what it is called for that.

use gearbench_integrators::system::{At, State};
use gearbench_models::gear::GearModel;
use gearbench_models::scene::{Linearised, Scene, StrainIn};
use gearbench_models::spec::SceneSpec;
use gearbench_reports::modes::MemberShape;
use std::collections::BTreeMap;

/// Energies of a motion.
#[derive(Clone, Debug, Default)]
pub struct Energies {
    /// Kinetic, by member, for a rate of the motion [J].
    pub kinetic: Vec<f64>,
    /// The part of it in own coordinates, by member [J].
    pub own: Vec<f64>,
    /// Strain [J].
    pub strain: BTreeMap<StrainIn, f64>,
}

/// Energies of a displacement `x` at unit rate.
pub fn energies(scene: &mut Scene, s: &State, linear: &Linearised, x: &[f64]) -> Energies {
    let n = x.len();
    let column = nalgebra::DMatrix::from_column_slice(n, 1, x);
    let momentum = &linear.mass * column;
    let over =
        |range: std::ops::Range<usize>| -> f64 { range.map(|i| 0.5 * x[i] * momentum[i]).sum() };
    let gears = scene.gears();
    let of_own = |g: &gearbench_models::scene::SceneGear| {
        let range = g.range();
        over((range.start + g.model.hub().first()).min(range.end)..range.end)
    };
    Energies {
        kinetic: gears.iter().map(|g| over(g.range())).collect(),
        own: gears.iter().map(of_own).collect(),
        strain: scene.strain_in(s, &linear.stiffness, x),
    }
}

impl Energies {
    /// Those of several motions together.
    pub fn add(&mut self, other: Energies) {
        for (to, from) in [
            (&mut self.kinetic, other.kinetic),
            (&mut self.own, other.own),
        ] {
            to.resize(from.len(), 0.0);
            to.iter_mut().zip(from).for_each(|(to, from)| *to += from);
        }
        for (place, energy) in other.strain {
            *self.strain.entry(place).or_insert(0.0) += energy;
        }
    }
}

/// Parts of a sum.
pub fn shares(energies: &[f64]) -> Vec<f64> {
    let all: f64 = energies.iter().sum();
    let share = |e: &f64| if all > 0.0 { e / all } else { 0.0 };
    energies.iter().map(share).collect()
}

/// How the members of a scene move by a displacement of its coordinates.
pub fn shape(scene: &Scene, s: &State, x: &[f64]) -> Vec<MemberShape> {
    let of = |g: &gearbench_models::scene::SceneGear| {
        let own = g.at(s.at());
        let along = &x[g.range()];
        let hub = g.model.hub();
        let mut six = [0.0; 6];
        for (x, d) in along.iter().zip(hub.free_directions()) {
            six[d] = *x;
        }
        MemberShape {
            turn_rad: if hub.is_free() {
                turn(g.model.as_ref(), own, along)
            } else {
                0.0
            },
            x_m: if hub.slide.is_some() { 0.0 } else { six[0] },
            y_m: six[1],
            z_m: six[2],
            tilt_x_rad: six[3],
            tilt_y_rad: six[4],
            own: 0.0,
        }
    };
    scene.gears().iter().map(of).collect()
}

/// Turn of a hub with what own coordinates turn it by.
fn turn(model: &dyn GearModel, _own: At<'_>, along: &[f64]) -> f64 {
    along[0] + model.hub().over_shapes(along)
}

/// A name of what holds strain energy.
pub fn name_of(place: StrainIn, scene: &Scene, spec: &SceneSpec) -> String {
    let member = |i: usize| scene.gears()[i].name.clone();
    let shaft = |i: usize| {
        spec.shafts
            .get(i)
            .map_or_else(String::new, |s| s.name.clone())
    };
    match place {
        StrainIn::Mesh(i) => {
            let [a, b] = scene.meshes()[i].gears.map(member);
            format!("mesh {a} - {b}")
        }
        StrainIn::Body(i) if scene.gears()[i].model.teeth().is_some() => {
            format!("teeth of {}", member(i))
        }
        StrainIn::Body(i) => format!("body of {}", member(i)),
        StrainIn::Bearing(i) => format!("bearing of {}", member(i)),
        StrainIn::Twist(i) => format!("torsion of {}", shaft(i)),
        StrainIn::Stretch(i) => format!("stretching of {}", shaft(i)),
        StrainIn::Bend(i) => format!("bending of {}", shaft(i)),
    }
}

/// Part of the energy that names a mode alone, and that a second place has to have to be named beside.
const ALONE: f64 = 0.75;
const BESIDE: f64 = 0.1;

/// What a mode is called: by what holds most of its energy, and the next where that is not nearly all.
pub fn name(springs: &[String], strain: &[f64]) -> String {
    let mut order: Vec<usize> = (0..strain.len()).collect();
    order.sort_by(|a, b| strain[*b].total_cmp(&strain[*a]));
    match order[..] {
        [first, second, ..] if strain[first] < ALONE && strain[second] > BESIDE => {
            format!("{}, {}", springs[first], springs[second])
        }
        [first, ..] => springs[first].clone(),
        [] => String::new(),
    }
}
