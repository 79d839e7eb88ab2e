//! Forces of contact on half-spaces derive from one potential, of reduced gears and of full finite elements.

use super::super::*;
use super::{built, half_space};
use gearbench_integrators::Report;
use gearbench_models::Vec3;
use gearbench_models::kinematics::{Locus, Point, Row, Tooth};

/// Returns the largest relative difference between forces at some coordinates and slopes of strain and contact energy.
fn off_potential(scene: &mut Scene, s: &State, scales: &[f64], coordinates: &[usize]) -> f64 {
    let mut force = vec![0.0; s.q.len()];
    scene.force(s.at(), &mut force);
    let largest = (force.iter().zip(scales)).fold(0.0_f64, |m, (f, s)| m.max((f * s).abs()));
    let mut energy = |i: usize, by: f64| {
        let mut moved = s.clone();
        moved.q[i] += by;
        let mut out = Outputs::default();
        scene.output(moved.at(), &mut out);
        out.energy.contact + out.energy.strain
    };
    let off = coordinates.iter().map(|&i| {
        let h = 5.0 * scales[i];
        // Fourth order.
        let first = (energy(i, h) - energy(i, -h)) / (2.0 * h);
        let second = (energy(i, 2.0 * h) - energy(i, -2.0 * h)) / (4.0 * h);
        let slope = (4.0 * first - second) / 3.0;
        ((slope + force[i]) * scales[i]).abs() / largest
    });
    off.fold(0.0, f64::max)
}

/// Forces on hubs and modes are the slopes of strain and contact energy, on the path and where tip edges touch, of a
/// gear on a rigid one too.
#[test]
fn forces_are_the_slope_of_one_potential() {
    let spec = fzg(0.0, 0.0);
    let both = half_space(6.0, 2.0, 12.0);
    let one = Modelling {
        gears: vec![both.gears[0].clone(), rigid()],
        ..both.clone()
    };
    for (name, modelling) in [("both", &both), ("one", &one)] {
        let mut scene = built(&spec, modelling);
        let radius = effective_radius(&spec.gears[0].body);
        let pitch = mesh_layout(&spec.gears[0], &spec.gears[1])
            .unwrap()
            .base_pitch;
        let mut pairs = std::collections::BTreeSet::new();
        let mut worst = 0.0_f64;
        for i in 0..12 {
            let mut s = scene.initial();
            let turned = pitch * f64::from(i) / 12.0;
            let second = scene.gears()[1].range().start;
            s.q[0] += (turned + 12e-6) / radius;
            s.q[second] -= turned / (1.5 * radius);
            let (scales, _) = scales(&scene);
            let mut numbers = Numbers::new(3 + i as u64);
            let hubs = [0, second];
            for (i, x) in numbers.vector(&scales).into_iter().enumerate() {
                if !hubs.contains(&i) {
                    s.q[i] = 1e-6 * x;
                }
            }
            s.v.fill(0.0);
            pairs.insert(scene.contact_forces(s.at()).len());
            let all: Vec<usize> = (0..s.q.len()).collect();
            worst = worst.max(off_potential(&mut scene, &s, &scales, &all));
        }
        println!("{name}: force off its potential by {worst:.1e}; contacts {pairs:?}");
        assert!(pairs.len() > 1 && worst < 1e-6, "{name}: {worst:.2e}");
    }
}

/// Forces of full finite elements on an elastic gear, rotated far, are slopes of the same potential: at the nodes
/// around the contact and at the hubs.
#[test]
fn forces_of_finite_elements_are_the_slope_of_the_same_potential() {
    of_finite_elements("C3D8I");
    of_finite_elements("C3D20");
}

fn of_finite_elements(element: &str) {
    let spec = fzg(0.0, 0.0);
    let mut modelling = half_space(4.0, 1.0, 0.0);
    let full = &mut modelling.gears[0];
    let values = full.values().into_iter();
    *full = with(
        model_of("fe", values.filter(|(key, _)| key != "modes")),
        "element",
        element,
    );
    let mut scene = built(&spec, &modelling);
    let radius = effective_radius(&spec.gears[0].body);
    let pitch = mesh_layout(&spec.gears[0], &spec.gears[1])
        .unwrap()
        .base_pitch;
    let second = scene.gears()[1].range().start;
    let rest = scene.initial();
    // First coordinate and place of each node that the hub does not hold.
    let nodes: Vec<(usize, Vec3)> = {
        let gear = &scene.gears()[0];
        let own = gear.at(rest.at());
        let surface = gear.model.surface().unwrap();
        let mut found = Vec::new();
        let mut node = 0;
        while 3 * found.len() + 1 < gear.range().len() {
            let (mut row, mut x) = (Row::default(), [Vec3::zeros()]);
            surface.nodes.positions(own, &[node], &mut x);
            let point = Point {
                tooth: Tooth { index: 0, mesh: 0 },
                locus: Locus::Node(node),
                x: x[0],
            };
            row.clear();
            row.target(0, 1.0);
            gear.model.row(own, &point, &Vec3::x(), &mut row);
            row.for_each(|i, value| {
                if value == 1.0 {
                    found.push((i, x[0] - gear.model.hub().centre));
                }
            });
            node += 1;
        }
        found
    };
    let (scales, _) = scales(&scene);
    let mut worst = 0.0_f64;
    let mut pairs = std::collections::BTreeSet::new();
    for i in 0..6_u32 {
        let mut s = rest.clone();
        let turned = pitch * f64::from(i) / 6.0;
        let angle = (turned + 12e-6) / radius;
        let (sin, cos) = angle.sin_cos();
        s.q[0] = angle;
        s.q[second] -= turned / (1.5 * radius);
        let mut numbers = Numbers::new(7 + u64::from(i));
        for &(first, x) in &nodes {
            let moved = Vec3::new(cos * x.x - sin * x.y, sin * x.x + cos * x.y, x.z) - x;
            for (axis, noise) in numbers.vector(&[3e-9; 3]).into_iter().enumerate() {
                s.q[first + axis] = moved[axis] + noise;
            }
        }
        s.v.fill(0.0);
        pairs.insert(scene.contact_forces(s.at()).len());
        let (mut with, mut without) = (vec![0.0; s.q.len()], vec![0.0; s.q.len()]);
        scene.force(s.at(), &mut with);
        let mut apart = s.clone();
        apart.q[second] += 1e-3 / radius;
        scene.force(apart.at(), &mut without);
        let pressed = (0..s.q.len()).filter(|i| (with[*i] - without[*i]).abs() > 1e-3);
        let pressed: Vec<usize> = pressed.collect();
        assert!(pressed.len() > 16 && pressed.contains(&0));
        worst = worst.max(off_potential(&mut scene, &s, &scales, &pressed));
    }
    println!("finite elements: force off its potential by {worst:.1e}; contacts {pairs:?}");
    assert!(pairs.len() > 1 && worst < 1e-6, "{worst:.2e}");
}
