use super::*;
use crate::law::{Damping, Law};

/// The forces of two masses with one port each and three points satisfy their laws at the gap and rate that they
/// cause, for dashpots from zero to one that suppresses all motion within the impulse.
#[test]
fn forces_hold_at_the_end_of_the_kick() {
    for c in [0.0, 1e2, 1e4, 1e6, 1e9] {
        let law = Law::new(1.0, Damping::KelvinVoigt { c }).unwrap();
        let gaps = [(-2e-6, -0.1), (-1e-6, 0.2), (1e-6, -0.3), (-1e-9, -0.3)];
        let mut springs: Vec<Spring> = (gaps.iter())
            .map(|&of| Spring::new(([0; 8], [0.0; 8]), of, 1e8, law.clone()))
            .collect();
        let (r, y) = (2e-9, 5e-6);
        let mut solve = DissipativeSolve {
            ports: Ports {
                n: 2,
                blocks: vec![Block { start: 0, len: 1 }, Block { start: 1, len: 1 }],
                compliance: vec![r, 0.0],
                mobility: vec![y, 2.0 * y],
                ..Ports::default()
            },
            points: (0..4)
                .map(|i| {
                    let mut p = PortPoint::default();
                    p.normal.ports[1] = 1;
                    (p.normal.weights[0], p.normal.weights[1]) = (1.0, 0.5 + 0.1 * i as f64);
                    p
                })
                .collect(),
            ..DissipativeSolve::default()
        };
        solve.solve(&mut springs).unwrap();
        let sum = |k: usize| -> f64 {
            let of = solve.points.iter().zip(&springs);
            of.map(|(p, s)| p.normal.weights[k] * s.force.n).sum()
        };
        let f = [sum(0), sum(1)];
        let u = solve.displacements().1[0];
        assert!((u + r * f[0]).abs() <= 1e-12 * u.abs());
        for (p, (s, (gap0, rate))) in solve.points.iter().zip(springs.iter().zip(gaps)) {
            let gap = gap0 + p.normal.weights[0] * r * f[0];
            let rate = rate + p.normal.weights[0] * y * f[0] + p.normal.weights[1] * 2.0 * y * f[1];
            let want = law.at_point(gap, rate, s.stiffness).n;
            assert!(
                (s.force.n - want).abs() <= 1e-9 * (f[0] + 1.0),
                "c = {c}: {want}"
            );
        }
    }
}

/// The solve for many points on a stiff law whose damper grows with the force converges even for slow motions, where
/// the damper contributes less than the rounding of the elastic forces.
#[test]
fn gears_that_hardly_vibrate_have_forces() {
    let load = crate::law::MeshLoad {
        force: 1e3,
        stiffness: 1e8,
        mass: 0.1,
    };
    let law = Law::new(1.0, Damping::RatioAtLoad { ratio: 0.05 }).unwrap();
    let law = law.under_load(load).unwrap();
    const NODES: usize = 12;
    for exponent in 0..20 {
        let rate = -0.1 * 0.1_f64.powi(exponent);
        let points: Vec<PortPoint> = (0..30)
            .map(|i| {
                let mut p = PortPoint::default();
                for k in 0..4 {
                    p.normal.ports[k] = ((i + k) % NODES) as u32;
                    p.normal.weights[k] = [0.31, 0.27, 0.23, 0.19][k];
                }
                p
            })
            .collect();
        let mut springs: Vec<Spring> = (0..30)
            .map(|i| {
                let gap0 = -1e-6 * (1.0 + 0.37 * (i as f64).sin());
                let force = law.undamped().smooth(gap0, 0.0, 0.0, 1e8);
                Spring {
                    force,
                    elastic: (gap0, force.n),
                    elastic_stiffness: -force.dn_dg,
                    ..Spring::new(([0; 8], [0.0; 8]), (gap0, rate), 1e8, law.clone())
                }
            })
            .collect();
        let mut compliance = vec![0.0; NODES * NODES];
        for i in 0..NODES {
            for j in 0..NODES {
                let apart = (i as f64 - j as f64).abs();
                compliance[i * NODES + j] = 3e-8 * (-0.3 * apart).exp();
            }
        }
        let mut solve = DissipativeSolve {
            ports: Ports {
                n: NODES,
                blocks: vec![Block {
                    start: 0,
                    len: NODES,
                }],
                compliance,
                ..Ports::default()
            },
            points,
            ..DissipativeSolve::default()
        };
        // From the elastic solution, as a run has it.
        for s in &mut springs {
            s.rate = 0.0;
        }
        solve.solve(&mut springs).unwrap();
        for s in &mut springs {
            s.rate = rate;
        }
        let solved = solve.solve(&mut springs);
        assert!(solved.is_ok(), "at {rate:.0e} m/s");
    }
}
