//! Motion of the members in a mode, its energy shares, and its name by these shares.

use gearbench_integrators::system::{State, StateView};
use gearbench_models::gear::GearModel;
use gearbench_models::scene::{Scene, StrainIn};
use gearbench_models::spec::SceneSpec;
use gearbench_reports::modes::MemberShape;

/// Returns each energy over their sum [-]; zeros if the sum is zero.
pub fn shares(energies: &[f64]) -> Vec<f64> {
    let all: f64 = energies.iter().sum();
    let share = |e: &f64| if all > 0.0 { e / all } else { 0.0 };
    energies.iter().map(share).collect()
}

/// Computes the motion of the members of a scene for a displacement of its coordinates.
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
                hub_rotation(g.model.as_ref(), own, along)
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
fn hub_rotation(model: &dyn GearModel, _own: StateView<'_>, along: &[f64]) -> f64 {
    along[0] + model.hub().over_shapes(along)
}

/// Returns the name of a component that stores strain energy.
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
        StrainIn::Stage(i) => format!(
            "stage {}",
            spec.stages.get(i).map_or("", |s| s.name.as_str())
        ),
    }
}

/// Share of the strain energy from which on one component alone names a mode, and least share of a second one in the
/// name.
const ALONE: f64 = 0.75;
const BESIDE: f64 = 0.1;

/// Returns the name of a mode: the spring with most of its strain energy, and the next one where that is not nearly
/// all.
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
