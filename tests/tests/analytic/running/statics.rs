//! Static equilibria of a mesh compared with the potential of its contacts.

use super::*;
use gearbench_integrators::Report;

/// The force of a position is the derivative of the contacts' energy by the approach, tip edges that touch off the line
/// of action included.
#[test]
fn static_forces_are_the_slope_of_the_potential() {
    let spec = fzg(0.0, 94.1);
    for contact in [varying(Damping::None), contact(1.4e10)] {
        let mut pair = statics(&spec, &rigid(), &contact);
        let (pitch_point, pitch) = (pair.layout().pitch_point, pair.layout().base_pitch);
        let mut held = spec.clone();
        for g in &mut held.gears {
            g.mount = gearbench_models::spec::Mount::Driven(Profile::Constant(0.0));
            g.loads.clear();
        }
        let mut scene = build(&held, &[rigid(), rigid()], &contact);
        let radii = [0, 1].map(|i| effective_radius(&spec.gears[i].body));
        // Both gears by half, so that the middle of the path stays.
        let mut energy = |s: f64, approach: f64| {
            let mut state = scene.initial();
            state.t = 2.0;
            let along = s - pitch_point;
            scene.hold(0, (along + approach) / radii[0]);
            scene.hold(1, -along / radii[1]);
            let mut out = Outputs::default();
            scene.output(state.at(), &mut out);
            out.energy.contact
        };
        let mut edges = 0;
        for i in 0..60 {
            let s = pitch_point + pitch * (f64::from(i) / 60.0 - 0.5);
            let at = pair.under_force(s, 2600.0).unwrap();
            let h = 2e-4 * at.approach;
            let slope = (energy(s - 0.5 * h, at.approach + h)
                - energy(s + 0.5 * h, at.approach - h))
                / (2.0 * h);
            assert!(
                (slope / at.force - 1.0).abs() < 1e-6,
                "at {s}: {slope} {}",
                at.force
            );
            let on_edge = |p: &gearbench_reference::statics::PairForce| {
                let [first, last] = pair.layout().path;
                let middle = s + 0.5 * at.approach + p.offset as f64 * pitch;
                p.force > 0.0 && !(first..last).contains(&middle)
            };
            edges += usize::from(at.pairs.iter().any(on_edge));
        }
        assert!(edges > 3, "{edges}");
    }
}
