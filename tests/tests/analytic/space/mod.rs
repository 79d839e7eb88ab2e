//! Gears whose hubs move in six directions, on bearings and on axes that are not parallel: the flanks in space against the
//! lines of action, contact rows, momentum, the same scene turned, mirrored and exchanged.

mod bodies;
mod conical;
mod elastic;
mod flanks;
mod half_space;
mod invariance;
mod misaligned;
mod without_candidates;

use gearbench_integrators::State;
use gearbench_integrators::system::{Outputs, Report};
use gearbench_models::Vec3;
use gearbench_models::geometry::{
    GearParams, Modifications, Rack, RackParams, ReliefShape, Side, TipRelief,
};
use gearbench_models::kinematics::Hub;
use gearbench_models::scene::Scene;
use gearbench_models::spec::{
    Bearing, Body, Freedom, OutOfPlaneSpec, SceneSpec, SpinTerms, effective_radius, turned_to,
};
use gearbench_tests::*;

/// Returns freedom in all directions on stiff bearings.
pub fn on_bearings() -> Option<Box<OutOfPlaneSpec>> {
    let mut bearing = Bearing::default();
    for d in 0..5 {
        bearing.stiffness[d][d] = if d < 3 { 2e8 } else { 5e4 };
        bearing.damping[d][d] = if d < 3 { 200.0 } else { 0.05 };
    }
    Some(Box::new(OutOfPlaneSpec {
        directions: [const { Freedom::Free }; 6],
        bearing,
        ..OutOfPlaneSpec::default()
    }))
}

pub fn helical(teeth: u32, helix: f64) -> GearParams {
    GearParams {
        helix_angle: helix,
        face_width: 0.02,
        ..spur(teeth)
    }
}

/// Returns a pair with a gap, slightly above the distance of zero profile shift.
pub fn helical_pair(helix: f64, gap: f64, modified: bool) -> SceneSpec {
    let modifications = if modified {
        Modifications {
            tip_relief: Some(TipRelief {
                amount: 2e-5,
                start_radius: 42e-3,
                shape: ReliefShape::Parabolic,
            }),
            profile_crowning: 5e-6,
            lead_crowning: 8e-6,
            ..Modifications::default()
        }
    } else {
        Modifications::default()
    };
    let pinion = GearParams {
        modifications,
        ..helical(20, helix)
    };
    let distance = 0.1 / helix.cos() + 1e-4;
    pair_of(
        gear("pinion", pinion, 0.0, 20.0),
        gear("wheel", helical(30, -helix), distance, 0.0),
        start(Side::Left, gap),
    )
}

pub fn rack_pair(helix: f64) -> SceneSpec {
    let mut spec = pair_of(
        gear("pinion", helical(20, helix), 0.0, 20.0),
        rack("rack", 9, 0.04 / helix.cos() + 5e-5, 0.0),
        start(Side::Left, 2e-6),
    );
    let params = RackParams {
        teeth: 9,
        module: 4e-3,
        tip_radius: 0.3,
        helix_angle: -helix,
        face_width: 0.02,
        ..RackParams::default()
    };
    spec.gears[1].body = Body::Rack(Rack::new(params).unwrap());
    spec
}

/// Returns a state with the hubs rolled together by an angle of the first, the second rotated further.
pub fn rolled(scene: &Scene, spec: &SceneSpec, roll: f64, press: f64) -> State {
    let mut s = scene.initial();
    let radii = [0, 1].map(|k| effective_radius(&spec.gears[k].body));
    let sign = if matches!(spec.gears[1].body, Body::Rack(_)) {
        1.0
    } else {
        -1.0
    };
    for (k, by) in [roll, (sign * roll * radii[0] - sign * press) / radii[1]]
        .into_iter()
        .enumerate()
    {
        let g = &scene.gears()[k];
        let tooth = g.model.hub().first();
        s.q[g.range().start] += by;
        s.q[g.range()][tooth..].iter_mut().for_each(|q| *q += by);
    }
    s
}

/// Returns freedom in all directions, without springs or dampers.
pub fn afloat() -> Option<Box<OutOfPlaneSpec>> {
    let mut lateral = on_bearings();
    if let Some(l) = &mut lateral {
        l.bearing = Bearing::default();
        l.spin = SpinTerms::Off;
    }
    lateral
}

/// Tilts an axis about x and y [rad].
pub fn tilt(spec: &mut SceneSpec, gear: usize, x: f64, y: f64) {
    let turn = nalgebra::Rotation3::new(Vec3::new(x, y, 0.0));
    let axes = &mut spec.gears[gear].axes;
    *axes = turned_to(axes, &(turn * axes[2]));
}

/// Returns a state with loaded flanks and displaced, tilted hubs.
pub fn displaced(scene: &Scene, spec: &SceneSpec, roll: f64, numbers: &mut Numbers) -> State {
    let Body::Gear(first) = &spec.gears[0].body else {
        unreachable!("a rack comes second")
    };
    // Flanks of conical gears stand off each other over the width.
    let press = if first.is_conical() { 6e-5 } else { 1.5e-5 };
    let mut s = rolled(scene, spec, roll, press);
    for g in scene.gears() {
        let hub = g.model.hub();
        let own = hub.moving();
        let first = g.range().start;
        for (k, d) in hub.free_directions().enumerate().filter(|(_, d)| *d != own) {
            s.q[first + k] += numbers.draw() * if d < 3 { 3e-6 } else { 2e-4 };
        }
        let teeth = first + hub.first()..g.range().end;
        s.q[teeth]
            .iter_mut()
            .for_each(|q| *q += 1e-4 * numbers.draw());
    }
    s.v.fill(0.0);
    s
}

/// Returns scenes of helical and spur gears with floating hubs, aligned and tilted.
pub fn floating() -> Vec<(&'static str, SceneSpec)> {
    let mut all = vec![
        ("spur", helical_pair(0.0, 0.0, false)),
        ("helical", helical_pair(0.3, 0.0, false)),
        ("modified", helical_pair(-0.2, 0.0, true)),
        ("tilted", helical_pair(0.2, 0.0, true)),
        ("rack", rack_pair(0.2)),
        ("conical", conical::seed_pair(0.0, 0.0)),
        ("conical, crowned", conical::seed_pair(2e-5, 1e-5)),
    ];
    tilt(&mut all[3].1, 0, 2e-3, -1e-3);
    tilt(&mut all[3].1, 1, -1e-3, 3e-3);
    for (_, spec) in &mut all {
        spec.gears.iter_mut().for_each(|g| g.lateral = afloat());
    }
    all
}

pub fn energy(scene: &mut Scene, s: &State) -> f64 {
    let mut out = Outputs::default();
    scene.output(s.at(), &mut out);
    out.energy.contact + out.energy.strain
}

/// Returns the rates of the six directions of a hub with a velocity and an angular velocity.
fn rates_of(hub: &Hub, q: &[f64], v: &Vec3, w: &Vec3) -> [f64; 6] {
    let motion = hub.motion(0.0, q, &[]);
    let [e0, e1, e2] = hub.axes;
    let (sa, ca) = motion.x[3].sin_cos();
    let (sb, cb) = motion.x[4].sin_cos();
    let axes = nalgebra::Matrix3::from_columns(&[
        Vec3::x(),
        Vec3::new(0.0, ca, sa),
        Vec3::new(sb, -sa * cb, ca * cb),
    ]);
    let local = |x: &Vec3| Vec3::new(e0.dot(x), e1.dot(x), e2.dot(x));
    let angles = axes.try_inverse().unwrap() * local(w);
    let u = local(v);
    [u.x, u.y, u.z, angles.x, angles.y, angles.z]
}

/// Returns the largest work of forces on a scene under rigid translations and rotations of all bodies, relative to the
/// largest part of it.
pub fn work_of_rigid_motions(scene: &Scene, s: &State, f: &[f64]) -> f64 {
    let mut worst = 0.0_f64;
    for direction in 0..6 {
        let axis = [Vec3::x(), Vec3::y(), Vec3::z()][direction % 3];
        let (mut work, mut scale) = (0.0, 0.0_f64);
        for g in scene.gears() {
            let hub = &g.model.hub().hub;
            let own = g.at(s.at());
            let frame = hub.frame(own.t, own.q);
            // Rows of unit motions tell the hub's rates.
            let (spin, velocity) = if direction < 3 {
                (Vec3::zeros(), axis)
            } else {
                (axis, axis.cross(&frame.origin))
            };
            let rates = rates_of(hub, own.q, &velocity, &spin);
            for (k, d) in hub.free_directions().enumerate() {
                let part = f[g.range().start + k] * rates[d];
                work += part;
                scale = scale.max(part.abs());
            }
        }
        if scale > 1e-3 {
            worst = worst.max(work.abs() / scale);
        }
    }
    worst
}
