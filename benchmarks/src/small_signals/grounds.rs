//! Forces on the ground as linear functions of the motion: of bearings by stiffness and damping, of held hubs by the
//! tooth forces.

use super::cycle::Running;
use super::response::GroundForce;
use gearbench_integrators::system::SecondOrderSystem;
use gearbench_models::scene::Scene;

/// The forces of the mounts of all rotating gears that are not on a carrier.
pub fn grounds(scene: &mut Scene, running: &Running) -> Vec<GroundForce> {
    let s = &running.start.state;
    let (n, meshes) = (scene.layout().n, scene.meshes().len());
    let (mut pressed, mut of_meshes) = (vec![0.0; meshes], vec![[0.0; 3]; meshes]);
    for contact in scene.contact_forces(s.at()) {
        pressed[contact.mesh] += contact.normal_force;
        let force: [f64; 3] = contact.force.into();
        (of_meshes[contact.mesh].iter_mut().zip(force)).for_each(|(to, f)| *to += f);
    }
    let mut found = Vec::new();
    for (i, gear) in scene.gears().iter().enumerate() {
        let teeth = scene.meshes().iter().any(|m| m.gears.contains(&i));
        let hub = gear.model.hub();
        if !teeth || hub.slide.is_some() || scene.is_carried(i) {
            continue;
        }
        let none = || [vec![0.0; n], vec![0.0; n]];
        let mut ground = GroundForce {
            gear: i,
            stiffness: none(),
            damping: none(),
            of_meshes: [vec![0.0; meshes], vec![0.0; meshes]],
        };
        let (own, range) = (gear.at(s.at()), gear.range());
        let places: Vec<usize> = hub.free_directions().collect();
        for d in 0..2 {
            let Some(place) = places.iter().position(|p| *p == d) else {
                for (m, mesh) in scene.meshes().iter().enumerate() {
                    for (k, sign) in [(0, 1.0), (1, -1.0)] {
                        if mesh.gears[k] == i {
                            let along: f64 = of_meshes[m]
                                .iter()
                                .zip(hub.axes[d].iter())
                                .map(|(f, a)| f * a)
                                .sum();
                            ground.of_meshes[d][m] += sign * along / pressed[m];
                        }
                    }
                }
                continue;
            };
            for j in 0..hub.first() {
                let mut unit = vec![0.0; hub.first()];
                unit[j] = 1.0;
                let zero = vec![0.0; hub.first()];
                let by_place = hub.bearing_change(own, [&unit, &zero]);
                let by_rate = hub.bearing_change(own, [&zero, &unit]);
                ground.stiffness[d][range.start + j] = by_place[place];
                ground.damping[d][range.start + j] = by_rate[place];
            }
        }
        found.push(ground);
    }
    found
}
