use super::*;
use crate::gear_mesh::{GearMeshParams, gear, rack, sector};
use crate::test_support::{self, counted};
use gearbench_models::geometry::{Gear, Side};

fn spur(helix_angle: f64) -> Gear {
    test_support::gear(20, 4e-3, |p| {
        p.helix_angle = helix_angle;
        p.bore_radius = 0.02;
    })
}

/// Outward normal of the involute (helicoid) through a point: tangent to the base cylinder, tilted by the base
/// helix angle.
fn involute_normal(g: &Gear, side: Side, x: &Vec3) -> Vec3 {
    let (rb, r) = (g.r_base(), x.x.hypot(x.y));
    let roll = (r * r - rb * rb).max(0.0).sqrt();
    let angle = x.y.atan2(x.x) - side.sign() * roll.atan2(rb);
    let (s, c) = angle.sin_cos();
    let tilt = g.base_helix_angle();
    // Points of equal radius turn by z tan(beta_b) / r_b: the normal leans against that.
    side.sign() * Vec3::new(-s * tilt.cos(), c * tilt.cos(), -tilt.sin())
}

/// Largest error of a normal where the radius of curvature is at least `from` [m].
fn worst(helix: f64, flank: usize, width: usize, from: f64) -> f64 {
    let g = spur(helix);
    let s = Surface::new(&gear(&g, &counted(flank, 4, width)).unwrap()).unwrap();
    let mut worst = 0.0_f64;
    for grid in s.flanks.grids() {
        for (&k, x) in grid.nodes.iter().zip(&grid.positions) {
            let roll = (x.x.powi(2) + x.y.powi(2) - g.r_base().powi(2))
                .max(0.0)
                .sqrt();
            if roll >= from {
                let exact = involute_normal(&g, grid.side, x);
                worst = worst.max((s.directions[k as usize] - exact).norm());
            }
        }
    }
    worst
}

/// Where gears touch; at the base circle the involute's curvature is infinite and a spline less exact.
#[test]
fn normals_are_those_of_the_involute() {
    for (helix, width) in [(0.0, 1), (0.0, 3), (0.3, 4)] {
        let [coarse, medium, fine] = [8, 16, 32].map(|n| worst(helix, n, width, 6e-3));
        assert!(
            coarse < 4e-3 && medium < 2.1e-3 && fine < 4e-4,
            "{helix}: {coarse} {medium} {fine}"
        );
    }
}

#[test]
fn a_rack_has_the_normals_of_its_planes_and_its_teeth_in_order() {
    let r = test_support::rack(6, 4e-3, |p| p.body_height = 12e-3);
    let s = Surface::new(&rack(&r, &GearMeshParams::default()).unwrap()).unwrap();
    let teeth: Vec<u32> = s.flanks.grids().iter().map(|g| g.tooth).collect();
    assert_eq!(teeth, [0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5]);
    let alpha = r.transverse_pressure_angle();
    let mut expected = 0..;
    for g in s.flanks.grids() {
        let exact = Vec3::new(-alpha.sin(), -g.side.sign() * alpha.cos(), 0.0);
        for &k in &g.nodes {
            assert_eq!(Some(k), expected.next());
            assert!((s.directions[k as usize] - exact).norm() < 1e-12);
        }
    }
}

#[test]
fn areas_add_up_and_nodes_are_where_the_mesh_has_them() {
    let g = spur(0.0);
    let mesh = gear(&g, &counted(8, 4, 3)).unwrap();
    let s = Surface::new(&mesh).unwrap();
    let (low, high) = (g.roll_length_form(), g.roll_length_tip());
    // Arc length of an involute over its roll length: (s_2^2 - s_1^2) / (2 r_b).
    let exact = 40.0 * g.face_width() * (high * high - low * low) / (2.0 * g.r_base());
    let area: f64 = s.areas.iter().sum();
    assert!((area / exact - 1.0).abs() < 1e-4, "{area:e} {exact:e}");
    for (x, &node) in s.positions().iter().zip(&s.mesh_nodes) {
        assert_eq!(*x, mesh.mesh.nodes[node as usize]);
    }
    let u: Vec<f64> = mesh
        .mesh
        .nodes
        .iter()
        .flat_map(|x| [-x.y, x.x, 0.0])
        .collect();
    let mut out = vec![0.0; s.nodes()];
    s.along_directions(&u, &mut out);
    for (k, x) in s.positions().iter().enumerate() {
        let lever = x.x * s.directions[k].y - x.y * s.directions[k].x;
        assert!((out[k] - lever).abs() < 1e-15);
    }
}

#[test]
fn copies_of_a_sector_are_the_whole_gear() {
    let g = spur(0.2);
    let p = counted(5, 4, 2);
    let whole = Surface::new(&gear(&g, &p).unwrap()).unwrap();
    let copies = Surface::of_sector(&sector(&g, &p).unwrap()).unwrap();
    assert_eq!(whole.nodes(), copies.nodes());
    for (a, b) in whole.flanks.grids().iter().zip(copies.flanks.grids()) {
        assert_eq!((a.tooth, a.side, &a.nodes), (b.tooth, b.side, &b.nodes));
        assert_eq!((a.rows, a.columns), (b.rows, b.columns));
    }
    for k in 0..whole.nodes() {
        assert!((whole.positions()[k] - copies.positions()[k]).norm() < 1e-15);
        assert!((whole.directions[k] - copies.directions[k]).norm() < 1e-11);
        assert!((whole.areas[k] / copies.areas[k] - 1.0).abs() < 1e-9);
    }
}

#[test]
fn declines_flanks_that_are_none() {
    let mesh = gear(&spur(0.0), &counted(3, 4, 1)).unwrap();
    let declined = |change: &dyn Fn(&mut GearMesh)| {
        let mut m = mesh.clone();
        change(&mut m);
        Surface::new(&m).unwrap_err().to_string()
    };
    assert!(declined(&|m| m.flanks.clear()).contains("names none"));
    assert!(declined(&|m| m.flanks[3] = m.flanks[0].clone()).contains("given twice"));
    assert!(declined(&|m| m.flanks[3].rows = 1).contains("at least 2 x 2"));
    assert!(declined(&|m| m.flanks[3].nodes[1] = m.bore[0]).contains("bore"));
    assert!(declined(&|m| m.flanks[3].nodes[1] = 1_000_000).contains("1000000"));
    assert!(
        declined(&|m| {
            let x = m.flanks[3].positions[0];
            m.flanks[3].positions.fill(x);
        })
        .contains("no normal")
    );
}
