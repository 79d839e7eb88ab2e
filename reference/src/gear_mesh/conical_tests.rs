//! Conical gears: flanks on their helicoids, volume, moments, elements, sectors, and cones that become cylinders.

#![allow(clippy::print_stdout)]

use super::tests::{assert_conforming, bored, params};
use super::*;
use crate::mesh::{ElementKind, quality};
use crate::test_support::layered;
use gearbench_models::Vec3;
use gearbench_models::geometry::{
    Gear, GearParams, Modifications, PlaneAngle, ReliefShape, Side, TipRelief, Topography,
};
use std::sync::Arc;

/// A pinion of the pair of the SIMPACK User Meeting of 2014.
fn seed(modifications: Modifications) -> Gear {
    Gear::new(GearParams {
        teeth: 35,
        module: 6.5e-3,
        helix_angle: (-6.0_f64).to_radians(),
        profile_shift: 0.28,
        profile_shift_angle: 5_f64.to_radians(),
        tip_cone_angle: 4.729_f64.to_radians(),
        face_width: 0.091,
        thinning: 1e-4,
        bore_radius: 0.04,
        modifications,
        ..GearParams::default()
    })
    .unwrap()
}

/// Builds a small gear with a cone and a helix.
fn cone(
    teeth: u32,
    helix: f64,
    angle: f64,
) -> Result<Gear, gearbench_models::geometry::GeometryError> {
    Gear::new(GearParams {
        helix_angle: helix,
        profile_shift: 0.3,
        profile_shift_angle: angle,
        tip_cone_angle: 0.9 * angle,
        ..params(teeth)
    })
}

/// Calls `f` with the tooth, the side and all nodes of each flank.
fn each_flank(m: &GearMesh, mut f: impl FnMut(u32, Side, &Vec3)) {
    for tooth in 0..m.teeth {
        for side in Side::BOTH {
            for &n in &m.mesh.node_sets[&flank_set(tooth, side)] {
                f(tooth, side, &m.mesh.nodes[n as usize]);
            }
        }
    }
}

#[test]
fn flank_nodes_lie_on_the_helicoids_of_each_side_up_to_the_tip_cone() {
    for (g, kind) in [
        (seed(Modifications::default()), ElementKind::C3D8I),
        (seed(Modifications::default()), ElementKind::C3D20),
        (cone(30, 0.25, 0.12).unwrap(), ElementKind::C3D8),
        (cone(40, 0.0, -0.15).unwrap(), ElementKind::C3D8),
    ] {
        let m = gear(&g, &layered(kind, 3)).unwrap();
        assert_conforming(&m.mesh);
        let (mut worst, mut highest, mut seen) = (0.0_f64, f64::NEG_INFINITY, 0);
        each_flank(&m, |tooth, side, x| {
            let psi = f64::from(tooth) * g.pitch_angle();
            worst = worst.max(
                g.flank(side)
                    .near(psi, x, &PlaneAngle::new(0.0))
                    .distance
                    .abs(),
            );
            highest = highest.max(x.xy().norm() - g.r_tip_at(x.z));
            seen += 1;
        });
        println!("off the helicoids {worst:.1e} m, over the tip cone {highest:.1e} m");
        assert!(worst < 1e-12, "{worst:.2e}");
        assert!(highest.abs() < 1e-13, "{highest:.2e}");
        assert!(seen > 2 * 24 * 30);
        for f in &m.flanks {
            for column in 0..f.columns {
                let x = f.positions[(f.rows - 1) * f.columns + column];
                assert!((x.xy().norm() - g.r_tip_at(x.z)).abs() < 1e-13);
            }
        }
    }
}

#[test]
fn modified_flanks_are_removed_along_the_normal_up_to_the_tip_cone() {
    let topography = Topography::new(&[vec![0.0, 2e-6], vec![1e-6, 4e-6]], None, None);
    let measured = topography.ok().map(Arc::new);
    let g = seed(Modifications {
        tip_relief: Some(TipRelief {
            amount: 4e-5,
            start_radius: 0.1187,
            shape: ReliefShape::Linear,
        }),
        lead_crowning: 1e-5,
        profile_crowning: 6e-6,
        helix_slope: [8e-6, -5e-6],
        topography: [measured, None],
        ..Modifications::default()
    });
    let m = gear(&g, &layered(ElementKind::C3D8I, 4)).unwrap();
    let (mut worst, mut most) = (0.0_f64, 0.0_f64);
    each_flank(&m, |tooth, side, x| {
        let flank = g.flank(side);
        let near = flank.near(f64::from(tooth) * g.pitch_angle(), x, &PlaneAngle::new(0.0));
        // Back along the normal the length of roll is longer by what was removed there.
        let roll = near.roll - near.distance / flank.cos_helix;
        let asked = g.flank_deviation_at(side, flank.base_radius.hypot(roll), x.z);
        worst = worst.max((near.distance + asked).abs());
        most = most.max(asked);
    });
    println!("removed within {worst:.1e} m of what is asked for, {most:.1e} m at most");
    assert!(worst < 1e-12, "{worst:.2e}");
    assert!(most > 5e-5);
}

/// Gauss-Legendre on [-1, 1].
const GAUSS: [(f64, f64); 3] = [
    (-0.774_596_669_241_483_4, 5.0 / 9.0),
    (0.0, 8.0 / 9.0),
    (0.774_596_669_241_483_4, 5.0 / 9.0),
];

/// Returns volume and polar moment by sections: those of the cylindrical gear at each height, the difference of the
/// helicoids from its flanks, and that of the fillets.
fn integrals(g: &Gear) -> [f64; 2] {
    let integrate = |from: f64, to: f64, panels: usize, f: &dyn Fn(f64) -> [f64; 2]| {
        let h = (to - from) / panels as f64;
        let mut sum = [0.0; 2];
        for k in 0..panels {
            for (x, w) in GAUSS {
                let value = f(from + h * (k as f64 + 0.5 + 0.5 * x));
                for i in 0..2 {
                    sum[i] += 0.5 * h * w * value[i];
                }
            }
        }
        sum
    };
    let bore = g.seat_radius();
    let end = 0.5 * g.face_width();
    integrate(-end, end, 6, &|z| {
        let section = g.transverse_section(z).unwrap();
        let (area, polar) = section.section_properties();
        let flanks = integrate(section.r_form(), section.r_tip(), 8, &|r| {
            let exact = Side::BOTH.map(|side| g.half_angle_of_section(side, r, z));
            let more = exact[0] + exact[1] - 2.0 * section.half_angle_at(r);
            [more * r, more * r.powi(3)]
        });
        let fillets = followed_fillets(g, &section, z);
        let (teeth, pi) = (f64::from(g.teeth()), std::f64::consts::PI);
        let of = |k: usize| teeth * (flanks[k] + fillets[k]);
        [
            area - pi * bore.powi(2) + of(0),
            polar - 0.5 * pi * bore.powi(4) + of(1),
        ]
    })
}

/// Returns the difference of both fillets of a tooth from those of the cylindrical gear: the whole offset at the form
/// circle, decreasing with the square of the length to the middle of the space.
fn followed_fillets(g: &Gear, section: &Gear, z: f64) -> [f64; 2] {
    let at_form = Side::BOTH.map(|side| g.half_angle_of_section(side, section.r_form(), z));
    let off = at_form[0] + at_form[1] - 2.0 * section.half_angle_at(section.r_form());
    let points: Vec<(f64, f64)> = (0..=2000)
        .map(|i| section.fillet_at(1.0 - f64::from(i) / 2000.0))
        .collect();
    let root = section.r_root();
    let lengths: Vec<f64> = (points.windows(2))
        .map(|p| root * (p[1].1 - p[0].1).hypot((p[1].0 / p[0].0).ln()))
        .collect();
    let arc = root * (0.5 * section.pitch_angle() - points[2000].1);
    let total = lengths.iter().sum::<f64>() + arc;
    let (mut passed, mut sum) = (0.0, [0.0; 2]);
    for (p, length) in points.windows(2).zip(&lengths) {
        let part = 1.0 - (passed + 0.5 * length) / total;
        let r = 0.5 * (p[0].0 + p[1].0);
        let area = off * part * part * r * (p[0].0 - p[1].0);
        sum = [sum[0] + area, sum[1] + area * r * r];
        passed += length;
    }
    sum
}

#[test]
fn volume_and_polar_moment_are_those_of_the_sections() {
    for g in [
        seed(Modifications::default()),
        cone(30, 0.25, 0.12).unwrap(),
        cone(30, 0.0, 0.1).unwrap(),
    ] {
        let [volume, moment] = integrals(&g);
        for (kind, bound) in [(ElementKind::C3D8, 1e-3), (ElementKind::C3D20, 2e-5)] {
            let q = quality(&gear(&g, &layered(kind, 4)).unwrap().mesh);
            let off = [q.volume / volume - 1.0, q.polar_moment / moment - 1.0];
            println!(
                "{kind:?}: volume off by {:.1e}, polar moment by {:.1e}",
                off[0], off[1]
            );
            assert!(off.iter().all(|x| x.abs() < bound), "{off:?}");
        }
        // The middle section alone is further off.
        let of_middle = g.mass_properties(1.0).mass / volume - 1.0;
        assert!(of_middle.abs() > 5e-6, "{of_middle:.1e}");
    }
}

#[test]
fn elements_of_cones_are_sound() {
    let (mut least, mut made) = (1.0_f64, 0);
    for teeth in [18, 25, 40, 80] {
        for helix in [0.0, 0.15, -0.4] {
            for angle in [0.02, 0.1, -0.1, 0.25] {
                let Ok(g) = cone(teeth, helix, angle) else {
                    continue;
                };
                let g = bored(g.params().clone(), 0.45);
                for kind in [ElementKind::C3D8, ElementKind::C3D20] {
                    let m = match gear(&g, &layered(kind, 4)) {
                        Ok(m) => m,
                        Err(MeshError::Undercut { .. }) => continue,
                        Err(e) => panic!("{teeth} {helix} {angle} {kind:?}: {e}"),
                    };
                    let q = quality(&m.mesh);
                    if q.min_scaled_jacobian < 0.4 {
                        println!(
                            "{teeth} {helix} {angle} {kind:?}: {:.3}",
                            q.min_scaled_jacobian
                        );
                    }
                    least = least.min(q.min_scaled_jacobian / helix.cos());
                    made += 1;
                }
            }
        }
    }
    println!("{made} meshes, least scaled Jacobian {least:.2} of the cosine of the helix");
    assert!(made > 40, "{made}");
    assert!(least > 0.3, "{least:.2}");
}

#[test]
fn a_sector_of_a_cone_repeats() {
    let g = seed(Modifications::default());
    let p = layered(ElementKind::C3D20, 3);
    let (m, whole) = (sector(&g, &p).unwrap(), gear(&g, &p).unwrap());
    let (low, high) = (&m.mesh.node_sets["cut_low"], &m.mesh.node_sets["cut_high"]);
    assert_eq!(low.len(), high.len());
    let (sin, cos) = g.pitch_angle().sin_cos();
    for (&a, &b) in low.iter().zip(high) {
        let [a, b] = [a, b].map(|n| m.mesh.nodes[n as usize]);
        let turned = Vec3::new(cos * a.x - sin * a.y, sin * a.x + cos * a.y, a.z);
        assert!((turned - b).norm() < 1e-15);
    }
    let volume = |m: &GearMesh| quality(&m.mesh).volume;
    assert!((35.0 * volume(&m) / volume(&whole) - 1.0).abs() < 1e-12);
}

#[test]
fn a_cone_without_angle_is_the_cylinder() {
    let round = Gear::new(GearParams {
        helix_angle: 0.2,
        profile_shift: 0.3,
        ..params(22)
    })
    .unwrap();
    let p = layered(ElementKind::C3D8I, 3);
    let cylinder = gear(&round, &p).unwrap();
    let off = |angle: f64| {
        let m = gear(&cone(22, 0.2, angle).unwrap(), &p).unwrap();
        assert_eq!(m.mesh.blocks, cylinder.mesh.blocks);
        assert_eq!(m.mesh.node_sets, cylinder.mesh.node_sets);
        let pairs = m.mesh.nodes.iter().zip(&cylinder.mesh.nodes);
        pairs.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
    };
    let [coarse, fine] = [1e-6, 1e-9].map(off);
    println!("nodes off those of the cylinder by {coarse:.1e} and {fine:.1e} m");
    assert!(coarse < 1e-7 && fine < 1e-10, "{coarse:.1e} {fine:.1e}");
}

#[test]
fn a_web_has_to_fit_under_the_smaller_end() {
    let g = seed(Modifications::default());
    let (low, high) = (g.r_root(), g.transverse_section(-0.0455).unwrap().r_root());
    let web = |outer_radius: f64| GearMeshParams {
        web: Some(Web {
            inner_radius: 0.06,
            outer_radius,
            thickness: 0.03,
            layers: 2,
            hub_layers: 2,
        }),
        ..layered(ElementKind::C3D8, 5)
    };
    assert!(high < low);
    let refused = gear(&g, &web(0.5 * (low + high))).unwrap_err();
    assert!(matches!(refused, MeshError::Web { .. }), "{refused}");
    let m = gear(&g, &web(0.085)).unwrap();
    assert_conforming(&m.mesh);
    assert!(quality(&m.mesh).min_scaled_jacobian > 0.3);
}
