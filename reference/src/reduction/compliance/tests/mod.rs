//! Both routes against each other, against all modes of a body, and against loads solved for directly.
#![allow(clippy::print_stdout, reason = "observed figures")]

mod shapes;

use super::*;
use crate::assembly::assemble;
use crate::assembly::tie::Reduced;
use crate::gear_mesh::{GearMeshParams, Tooth, gear, rack, sector};
use crate::modes::{self, Options, cyclic};
use crate::reduction::choose::{self, Choice, Criterion};
use crate::reduction::{KeptModes, ModeSelection, basis, without_modes};
use crate::test_support::{self, coarse, largest, stub, tied};
use faer::Side;
use gearbench_models::geometry::Gear;
use shapes::*;

const STEEL: Material = Material::STEEL;

fn toothed(teeth: u32, helix_angle: f64) -> (Gear, GearMeshParams) {
    (stub(teeth, helix_angle), coarse(1, 1))
}

fn of_mesh(
    mesh: &GearMesh,
    surface: &Surface,
    mounting: &Mounting,
) -> Result<Residual, ReductionError> {
    of_assembly(mesh, &assemble(&mesh.mesh, &STEEL)?, surface, mounting)
}

fn small_rack() -> GearMesh {
    let bar = test_support::rack(4, 4e-3, |p| p.body_height = 8e-3);
    rack(&bar, &coarse(1, 1)).unwrap()
}

#[test]
fn forces_on_one_tooth_say_all_of_a_cyclic_gear() {
    for (teeth, helix) in [(8, 0.0), (7, 0.3)] {
        let (g, p) = toothed(teeth, helix);
        let (whole, one) = (gear(&g, &p).unwrap(), sector(&g, &p).unwrap());
        let (a, b) = (
            Surface::new(&whole).unwrap(),
            Surface::of_sector(&one).unwrap(),
        );
        for mounting in mountings() {
            let full = of_mesh(&whole, &a, &mounting).unwrap();
            let cyclic = of_sector(&one, &STEEL, &b, &mounting).unwrap();
            let (x, y) = (dense(&full), dense(&cyclic));
            assert!(matches!(cyclic.flanks, FlankCompliance::Cyclic { .. }));
            assert!(
                worst(&x, &y) < 1e-9 * largest(&x),
                "{:e}",
                worst(&x, &y) / largest(&x)
            );
            assert!(worst(&full.hub, &cyclic.hub) <= 1e-9 * largest(&full.hub));
            assert!((full.hub_hub - cyclic.hub_hub).abs() <= 1e-9 * full.hub_hub);
        }
    }
}

/// The sum over all modes of `phi phi^T / omega^2` is the static compliance, whatever the support, and nothing is left
/// when all modes are kept.
#[test]
fn all_modes_carry_everything_and_what_is_left_never_pulls() {
    let (g, p) = toothed(6, 0.0);
    let wheel = gear(&g, &p).unwrap();
    let bar = small_rack();
    let cases = [
        (&wheel, Mounting::gear(false, 0.0)),
        (&wheel, Mounting::gear(true, 0.0)),
        (&wheel, Mounting::gear(true, 1e-3)),
        (&bar, Mounting::rack(true, 0.2)),
        (&bar, Mounting::rack(false, 0.0)),
        (&wheel, floating(Mounting::gear(true, 1e-3))),
        (&wheel, floating(Mounting::gear(false, 0.0))),
        (&bar, floating(Mounting::rack(true, 0.2))),
        (&bar, floating(Mounting::rack(false, 0.0))),
    ];
    for (mesh, mounting) in cases {
        let surface = Surface::new(mesh).unwrap();
        let total = of_mesh(mesh, &surface, &mounting).unwrap();
        let all = Shapes::of(mesh, &surface, &mounting, None);
        assert!(definiteness(&total) > -1e-13, "{:e}", definiteness(&total));
        for count in [1, 7, 40, all.omega.len() / 2] {
            let rest = without_modes(&total, all.first(count).kept()).unwrap();
            assert!(
                definiteness(&rest) > -1e-10,
                "{count}: {:e}",
                definiteness(&rest)
            );
            assert!(largest(&dense(&rest)) < largest(&dense(&total)));
        }
        let rest = without_modes(&total, all.kept()).unwrap();
        let (left, scale) = (largest(&dense(&rest)), largest(&dense(&total)));
        assert!(left < 1e-9 * scale, "{left:e} of {scale:e}");
        assert!(largest(&rest.hub) <= 1e-9 * largest(&total.hub));
        assert!(rest.hub_hub.abs() <= 1e-9 * total.hub_hub);
    }
}

/// The deflection of the flanks relative to the hub under a static torque is that of a direct solution, however many
/// modes are kept.
#[test]
fn deflections_at_rest_are_those_of_the_finite_elements() {
    let (g, mut p) = toothed(9, 0.0);
    p.width = 2;
    let wheel = gear(&g, &p).unwrap();
    let bar = small_rack();
    let cases = [
        (&wheel, Mounting::gear(false, 0.0)),
        (&wheel, Mounting::gear(true, 2e-4)),
        (&bar, Mounting::rack(true, 0.0)),
    ];
    for (mesh, mounting) in cases {
        let surface = Surface::new(mesh).unwrap();
        let total = of_mesh(mesh, &surface, &mounting).unwrap();
        let n = surface.nodes();
        // Two teeth carry, at several nodes each.
        let forces: Vec<f64> = (0..n)
            .map(|k| {
                if k % 7 == 2 && k < n / 2 {
                    50.0 + k as f64
                } else {
                    0.0
                }
            })
            .collect();
        let effective_radius = arms(&surface, &[mounting.motion]);
        let torque: f64 = forces
            .iter()
            .zip(&effective_radius)
            .map(|(f, a)| f * a)
            .sum();

        // Directly: the hub held, forces along the normals into the teeth.
        let (tie, r) = matrices(
            mesh,
            &Mounting {
                free: false,
                ..mounting
            },
        );
        let mut full = vec![0.0; 3 * mesh.mesh.nodes.len()];
        for (k, f) in forces.iter().enumerate() {
            for axis in 0..3 {
                full[3 * surface.mesh_nodes[k] as usize + axis] -= f * surface.directions[k][axis];
            }
        }
        let mut load = vec![0.0; tie.coordinates()];
        tie.gather(&full, &mut load);
        Cholesky::new(r.stiffness.as_ref())
            .unwrap()
            .solve(&mut load);
        tie.expand(&load, &mut full);
        let mut exact = vec![0.0; n];
        surface.along_directions(&full, &mut exact);

        let all = Shapes::of(mesh, &surface, &mounting, Some(50));
        for count in [0, 5, 50] {
            let kept = all.first(count);
            let rest = without_modes(&total, kept.kept()).unwrap();
            let torque = if mounting.free { torque } else { 0.0 };
            let q: Vec<f64> = (0..count)
                .map(|i| {
                    let pressed: f64 = (0..n).map(|k| kept.shapes[k * count + i] * forces[k]).sum();
                    (kept.hub[i] * torque - pressed) / kept.omega[i].powi(2)
                })
                .collect();
            let turn = kept.hub.iter().zip(&q).map(|(h, q)| h * q).sum::<f64>()
                - rest
                    .hub
                    .iter()
                    .zip(&forces)
                    .map(|(r, f)| r * f)
                    .sum::<f64>()
                + rest.hub_hub * torque;
            let found: Vec<f64> = (0..n)
                .map(|k| {
                    let modal: f64 = (0..count).map(|i| kept.shapes[k * count + i] * q[i]).sum();
                    let pressed: f64 = (0..n)
                        .map(|l| rest.flanks.between(k as u32, l as u32, n) * forces[l])
                        .sum();
                    modal - pressed + rest.hub[k] * torque - effective_radius[k] * turn
                })
                .collect();
            let error = worst(&found, &exact) / largest(&exact);
            println!("{mounting:?}, {count} modes: static deflection off by {error:.1e}");
            assert!(error < 1e-9, "{mounting:?}, {count} modes: {error:e}");
        }
    }
}

/// Cyclic gears: families kept whole leave the teeth alike, and the same as without symmetry; half a pair is refused.
#[test]
fn kept_pairs_leave_the_teeth_alike_and_half_a_pair_is_refused() {
    let (g, p) = toothed(8, 0.0);
    let (whole, one) = (gear(&g, &p).unwrap(), sector(&g, &p).unwrap());
    let (a, b) = (
        Surface::new(&whole).unwrap(),
        Surface::of_sector(&one).unwrap(),
    );
    let mounting = Mounting::gear(true, 1e-4);
    let found = cyclic::lowest(
        &one.as_sector(),
        &STEEL,
        &cyclic::Hub::turning(mounting.added_inertia),
        30,
        &Options::default(),
    )
    .unwrap();
    // Without the rigid turn; whole pairs.
    let count = found.modes.len() - 1;
    let (n, m) = (b.nodes(), b.nodes() / 8);
    let mut s = Shapes {
        omega: found.modes[1..].iter().map(|m| m.omega2.sqrt()).collect(),
        shapes: vec![0.0; n * count],
        hub: vec![0.0; count],
    };
    let mut u = vec![0.0; 3 * one.mesh.nodes.len()];
    for i in 0..count {
        for tooth in 0..8 {
            found.expand(i + 1, tooth, &mut u);
            for k in tooth as usize * m..(tooth as usize + 1) * m {
                let node = b.mesh_nodes[k] as usize;
                let x = Vec3::from_column_slice(&u[3 * node..][..3]);
                s.shapes[k * count + i] = b.directions[k].dot(&x);
            }
        }
        found.expand(i + 1, 0, &mut u);
        let bore = one.bore[0] as usize;
        let x = one.mesh.nodes[bore];
        s.hub[i] = (x.x * u[3 * bore + 1] - x.y * u[3 * bore]) / (x.x * x.x + x.y * x.y);
    }
    let full = of_mesh(&whole, &a, &mounting).unwrap();
    let alike = of_sector(&one, &STEEL, &b, &mounting).unwrap();
    let scale = largest(&dense(&full));
    let (x, y) = (
        without_modes(&full, s.kept()).unwrap(),
        without_modes(&alike, s.kept()).unwrap(),
    );
    assert!(worst(&dense(&x), &dense(&y)) < 1e-9 * scale);
    assert!(worst(&x.hub, &y.hub) < 1e-9 * largest(&alike.hub));
    assert!(definiteness(&y) > -1e-10, "{:e}", definiteness(&y));

    let half = (1..count)
        .find(|&i| found.modes[i].part == cyclic::Part::Cosine)
        .unwrap();
    let refused = without_modes(&alike, s.first(half).kept()).unwrap_err();
    assert!(refused.to_string().contains("pair"), "{refused}");
    assert!(without_modes(&full, s.first(half).kept()).is_ok());
}

#[test]
fn declines_what_does_not_belong_together() {
    let (g, p) = toothed(6, 0.0);
    let (whole, one) = (gear(&g, &p).unwrap(), sector(&g, &p).unwrap());
    let (a, b) = (
        Surface::new(&whole).unwrap(),
        Surface::of_sector(&one).unwrap(),
    );
    let held = Mounting::gear(false, 0.0);
    let text = |r: Result<Residual, ReductionError>| r.unwrap_err().to_string();
    assert!(text(of_sector(&one, &STEEL, &b, &Mounting::rack(true, 0.0))).contains("rack"));
    let mut other = a.clone();
    other.mesh_nodes[0] = u32::MAX;
    assert!(text(of_mesh(&whole, &other, &held)).contains("another mesh"));
    assert!(text(of_sector(&whole, &STEEL, &b, &held)).contains("cut_low"));
    let mut loose = whole.clone();
    loose.bore.clear();
    assert!(text(of_mesh(&loose, &a, &held)).contains("not positive definite"));
    let total = of_mesh(&whole, &a, &held).unwrap();
    let kept = KeptModes {
        omega: &[0.0],
        shapes: &vec![0.0; a.nodes()],
        hub: &[0.0],
        made_for: &[],
    };
    assert!(text(without_modes(&total, kept)).contains("rigid"));
    assert!(
        text(without_modes(
            &total,
            KeptModes {
                shapes: &[],
                ..kept
            }
        ))
        .contains("expected")
    );
}

/// Halving the elements increases the compliance of a row of nodes as for a half-space loaded over half the length;
/// between two rows the increase is smaller.
#[test]
fn a_line_load_flattens_the_flank_by_the_logarithm_of_the_elements() {
    let g = test_support::gear(16, 4.5e-3, |p| {
        p.profile_shift = 0.1817;
        p.face_width = 14e-3;
        p.bore_radius = 15e-3;
    });
    let compliance = |flank: usize| {
        let p = GearMeshParams {
            tooth: Tooth {
                flank,
                across: 10.max(flank / 2),
                ..Tooth::default()
            },
            layers: 3,
            width: 1,
            ..GearMeshParams::default()
        };
        let mesh = sector(&g, &p).unwrap();
        let surface = Surface::of_sector(&mesh).unwrap();
        let held = Mounting::gear(false, 0.0);
        let r = of_sector(&mesh, &STEEL, &surface, &held).unwrap();
        let grid = &surface.flanks.grids()[0];
        let off = |row: &usize| {
            let x = grid.positions[2 * row];
            (x.x.hypot(x.y) - g.r_reference()).abs()
        };
        let row = (1..grid.rows - 1)
            .min_by(|a, b| off(a).total_cmp(&off(b)))
            .unwrap();
        // Displacement by unit load per length, spread evenly over the width.
        let under = |rows: &[(usize, f64)]| -> f64 {
            let parts = rows
                .iter()
                .flat_map(|(r, a)| [(2 * r, 0.5 * a), (2 * r + 1, 0.5 * a)]);
            let parts: Vec<(usize, f64)> = parts.collect();
            let pairs = parts.iter().flat_map(|x| parts.iter().map(move |y| (x, y)));
            g.face_width()
                * pairs
                    .map(|((i, a), (j, b))| {
                        a * b * r.flanks.between(*i as u32, *j as u32, surface.nodes())
                    })
                    .sum::<f64>()
        };
        (under(&[(row, 1.0)]), under(&[(row, 0.5), (row + 1, 0.5)]))
    };
    let (coarse, fine) = (compliance(12), compliance(24));
    let (e, nu) = (STEEL.young, STEEL.poisson);
    let more = 2.0 * (1.0 - nu * nu) * 2.0_f64.ln() / (std::f64::consts::PI * e);
    let found = (fine.0 - coarse.0) / more;
    assert!((0.7..1.3).contains(&found), "{found}");
    for (on, between) in [coarse, fine] {
        let less = 1.0 - between / on;
        assert!((0.05..0.12).contains(&less), "{less}");
    }
}

/// The displacement of a floating hub under unit loads, beyond rigid motion, is that of its modes.
#[test]
fn modes_carry_the_loads_of_bearings() {
    let mesh = gear(&stub(6, 0.0), &coarse(1, 1)).unwrap();
    let surface = Surface::new(&mesh).unwrap();
    let mounting = floating(Mounting::gear(true, 1e-5));
    let assembly = assemble(&mesh.mesh, &STEEL).unwrap();
    let total = held_of_assembly(&mesh, &assembly, &surface, &mounting).unwrap();
    let total = total.hub_compliance(&mounting);
    let (tie, r) = matrices(&mesh, &mounting);
    let all = modes::lowest(&r, tie.coordinates(), &Options::default()).unwrap();
    let first = 3 * tie.free.len();
    let of_modes = |p: usize, q: usize| -> f64 {
        let of =
            |i: usize| all.vectors[(first + p, i)] * all.vectors[(first + q, i)] / all.omega2[i];
        (6..all.omega2.len()).map(of).sum()
    };
    for (p, q) in (0..6).flat_map(|p| (0..6).map(move |q| (p, q))) {
        let scale = (total[(p, p)] * total[(q, q)]).sqrt();
        assert!(
            (of_modes(p, q) - total[(p, q)]).abs() < 1e-8 * scale,
            "{p} {q}"
        );
    }
}

/// The part of the static compliance of a floating hub that a hundred modes leave out is small relative to a bearing,
/// also along the axis and in tilts, where a narrow gear is more compliant. The gear is that of the shipped impact.
#[test]
fn few_modes_leave_little_of_the_compliance_of_a_hub() {
    let g = test_support::gear(20, 4e-3, |p| {
        p.face_width = 10e-3;
        p.bore_radius = 15e-3;
    });
    let mesh = sector(&g, &test_support::counted(8, 4, 2)).unwrap();
    let surface = Surface::of_sector(&mesh).unwrap();
    let none = Mounting::gear(true, 0.0).lateral([true; 6]).unwrap();
    for (what, mounting) in [("light", none), ("0.1 kg", none.with_added(0.1, 1e-5))] {
        let total = held_of_sector(&mesh, &STEEL, &surface, &mounting).unwrap();
        let total = total.hub_compliance(&mounting);
        let wanted = ModeSelection::Count(400);
        let basis = basis::of_sector(&mesh, &STEEL, &mounting, wanted, false).unwrap();
        let hub = &basis.lateral.as_ref().unwrap().hub;
        let kept = choose::choose(
            &basis,
            &Choice {
                by: Criterion::FlankCompliance,
                count: 100,
                candidates: 400,
                highest: f64::INFINITY,
                time: f64::INFINITY,
                even_over_width: false,
            },
        );
        for (d, k, most) in [
            (0, 1e8, (5e-4, 1.8e-3)),
            (2, 1e8, (7e-4, 2.5e-3)),
            (3, 1e5, (3e-3, 0.021)),
        ] {
            let at = mounting.directions().position(|own| own == d).unwrap();
            let total = total[(at, at)];
            let of = |modes: &[usize]| -> f64 {
                modes
                    .iter()
                    .map(|&i| (hub[i][d] / basis.omega[i]).powi(2))
                    .sum()
            };
            let lowest: Vec<usize> = (0..100).collect();
            let [chosen, lowest] = [&kept, &lowest].map(|modes| total - of(modes));
            assert!(total > 0.0 && chosen > -1e-9 * total && lowest > -1e-9 * total);
            let [chosen, lowest] = [chosen, lowest].map(|left| k * left);
            let (by_choice, by_frequency) = most;
            assert!(
                chosen < by_choice && lowest < by_frequency,
                "{what}, direction {d}: of a bearing's compliance the hub has {:.3e}, 100 chosen modes leave {chosen:.3e}, the \
                 lowest {lowest:.3e}",
                k * total
            );
        }
    }
}
