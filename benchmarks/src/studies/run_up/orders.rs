//! Orders of a scene: frequencies of meshes and shafts over the rotation frequency of the reference gear, from the
//! rotations of the hubs.

use super::channels::ChannelLayout;
use super::recorder::Recorder;
use gearbench_models::spec::{Body, SceneSpec};
use gearbench_reports::run_up::TrackedOrder;

/// Relative distance of orders that are one.
const ALIKE: f64 = 1e-4;
/// Multiples of the turns of a shaft that are followed.
const OF_SHAFTS: usize = 2;

/// An order and what has it.
struct Family {
    order: f64,
    names: Vec<String>,
}

fn add(families: &mut Vec<Family>, order: f64, name: String) {
    let alike = |f: &&mut Family| (f.order - order).abs() <= ALIKE * order;
    match families.iter_mut().find(alike) {
        Some(family) => family.names.push(name),
        None => families.push(Family {
            order,
            names: vec![name],
        }),
    }
}

/// Returns the orders to follow, those of meshes first; `shortest` is the least order that a window resolves.
pub fn tracked(
    (spec, recorded): (&SceneSpec, &ChannelLayout<'_>),
    recorder: &Recorder,
    between: [usize; 2],
    (gear, multiples): (usize, usize),
    shortest: f64,
) -> Vec<TrackedOrder> {
    let reference = {
        let angle = recorded.angle(recorder, gear);
        (angle[between[1]] - angle[between[0]]).abs()
    };
    let (mut meshes, mut shafts) = (Vec::new(), Vec::new());
    for (m, mesh) in spec.meshes.iter().enumerate() {
        let g = mesh.gears[0];
        let Body::Gear(body) = &spec.gears[g].body else {
            continue;
        };
        // Angles relative to the carrier, also that of the sun.
        let angle = |i: usize| {
            let a = recorded.angle(recorder, i);
            a[between[1]] - a[between[0]]
        };
        let turned = angle(g) - recorded.carrier_of_mesh(m).map_or(0.0, angle);
        let [a, b] = spec.names_of(mesh.gears);
        let order = f64::from(body.teeth()) * turned.abs() / reference;
        if order > 0.0 {
            add(&mut meshes, order, format!("{a} - {b}"));
        }
    }
    let racks = |i: usize| matches!(spec.gears.get(i).map(|g| &g.body), Some(Body::Rack(_)));
    for i in (0..spec.gears.len() + spec.bodies().count()).filter(|i| !racks(*i)) {
        let order = recorded.rotation(recorder, i, between).abs() / reference;
        if order > ALIKE {
            add(&mut shafts, order, spec.member_name(i).to_owned());
        }
    }
    let alone = meshes.len() == 1;
    let mut all = Vec::new();
    for family in &meshes {
        all.extend((1..=multiples).map(|k| TrackedOrder {
            name: match (alone, family.names.len()) {
                (true, _) => format!("{k}x mesh"),
                (_, 1) => format!("{k}x mesh {}", family.names[0]),
                (_, n) => format!("{k}x mesh {} and {} more", family.names[0], n - 1),
            },
            order: k as f64 * family.order,
            of_mesh: true,
        }));
    }
    for family in &shafts {
        all.extend((1..=OF_SHAFTS).map(|k| TrackedOrder {
            name: format!("{k}x {}", family.names.join(", ")),
            order: k as f64 * family.order,
            of_mesh: false,
        }));
    }
    all.retain(|o| o.of_mesh || o.order >= shortest);
    // A shaft's double may be another's own.
    let mut kept: Vec<TrackedOrder> = Vec::new();
    for order in all {
        let there = |k: &TrackedOrder| (k.order - order.order).abs() <= ALIKE * order.order;
        if !kept.iter().any(there) {
            kept.push(order);
        }
    }
    kept
}
