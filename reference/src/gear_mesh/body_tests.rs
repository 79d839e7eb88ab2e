//! Racks, webs, fine teeth, modified flanks, refusals.

use super::tests::{assert_conforming, bored, params, small, spur};
use super::*;
use crate::mesh::{ElementKind, quality};
use crate::test_support::{self, layered};
use gearbench_models::geometry::{
    EndRelief, Gear, GearParams, Modifications, Rack, RackParams, ReliefShape, TipRelief,
    Topography,
};
use std::f64::consts::PI;
use std::sync::Arc;

fn a_rack(helix: f64) -> Rack {
    test_support::rack(6, 4e-3, |p| {
        p.helix_angle = helix;
        p.body_height = 12e-3;
    })
}

#[test]
fn flanks_of_a_rack_are_planes_and_its_mass_is_right() {
    for helix in [0.0, 0.35] {
        let r = a_rack(helix);
        let p = layered(ElementKind::C3D20, 2);
        let m = rack(&r, &p).unwrap();
        assert_eq!((m.teeth, m.flanks.len()), (6, 12));
        assert_conforming(&m.mesh);
        let back = r.root_depth() + r.params().body_height;
        assert!(
            m.bore
                .iter()
                .all(|&n| (m.mesh.nodes[n as usize].x - back).abs() < 1e-15)
        );
        // From the highest tooth down: 3, 2, 1, 0, -1, -2; the last two count from the end.
        let teeth: Vec<u32> = m.flanks.iter().step_by(2).map(|f| f.tooth).collect();
        assert_eq!(teeth, [3, 2, 1, 0, 5, 4]);
        for (i, f) in m.flanks.iter().enumerate() {
            let centre = 3.0 - (i as f64 / 2.0).floor();
            for x in &f.positions {
                // The left flanks of gears meet the lower side of a rack's teeth.
                let y = centre * r.pitch()
                    - f.side.sign() * r.half_thickness_at(-x.x)
                    - x.z * helix.tan();
                assert!((x.y - y).abs() < 1e-12, "{f:?}");
            }
        }
        // Parabolas through the fillets' arcs.
        let q = quality(&m.mesh);
        assert!(
            (q.volume / r.mass(1.0) - 1.0).abs() < 1e-6,
            "{q:?} {}",
            r.mass(1.0)
        );
        assert!(q.min_scaled_jacobian > 0.45 * helix.cos(), "{q:?}");
    }
}

#[test]
fn all_racks_have_sound_elements() {
    for tip_radius in [0.0, 0.2, 0.38, 0.4] {
        for pressure_angle in [14.5_f64, 20.0, 25.0] {
            for body_height in [1e-3, 2.5e-3, 4e-3, 40e-3] {
                let r = RackParams {
                    teeth: 2,
                    module: 4e-3,
                    tip_radius,
                    pressure_angle: pressure_angle.to_radians(),
                    body_height,
                    ..RackParams::default()
                };
                let Ok(r) = Rack::new(r) else { continue };
                for kind in [ElementKind::C3D8, ElementKind::C3D20] {
                    let p = layered(kind, 1);
                    let made = rack(&r, &p);
                    // A body of a quarter of the module may be refused; it is never built unsound.
                    if body_height < 2e-3 && matches!(made, Err(MeshError::Inverted { .. })) {
                        continue;
                    }
                    let q = quality(&made.unwrap().mesh);
                    let bound = match (body_height < 2e-3, tip_radius == 0.0) {
                        (true, _) => 0.0,
                        (_, true) => 0.25,
                        _ => 0.35,
                    };
                    assert!(
                        q.min_scaled_jacobian > bound,
                        "{tip_radius} {pressure_angle} {body_height} {q:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn a_web_takes_its_volume_away() {
    let g = spur(30);
    let web = Web {
        inner_radius: 35e-3,
        outer_radius: 46e-3,
        thickness: 4e-3,
        layers: 3,
        hub_layers: 2,
    };
    for kind in [ElementKind::C3D8, ElementKind::C3D20] {
        let p = GearMeshParams {
            web: Some(web),
            ..layered(kind, 5)
        };
        let m = gear(&g, &p).unwrap();
        let solid = gear(&g, &GearMeshParams { web: None, ..p }).unwrap();
        assert_conforming(&m.mesh);
        let ring = PI * (web.outer_radius.powi(2) - web.inner_radius.powi(2)) * 6e-3;
        let exact = g.mass_properties(1.0).mass - ring;
        let (q, whole) = (quality(&m.mesh), quality(&solid.mesh));
        let bound = if kind == ElementKind::C3D8 {
            3e-4
        } else {
            1e-5
        };
        assert!(
            (q.volume / exact - 1.0).abs() < bound,
            "{}",
            q.volume / exact
        );
        assert!(q.volume < 0.9 * whole.volume && q.min_scaled_jacobian > 0.6);
        // No node in the air.
        for x in &m.mesh.nodes {
            let r = x.xy().norm();
            let beside = x.z.abs() > 2.1e-3;
            assert!(!(beside && r > 35.1e-3 && r < 45.9e-3), "{x}");
        }
    }
}

#[test]
fn fine_teeth_join_coarse_ones() {
    let g = spur(20);
    let p = GearMeshParams {
        tooth: Tooth {
            flank: 20,
            ..Tooth::default()
        },
        width: 1,
        fine_teeth: Some(FineTeeth {
            teeth: vec![0, 1, 19],
            others: Tooth::coarse(),
        }),
        ..GearMeshParams::default()
    };
    for kind in [ElementKind::C3D8, ElementKind::C3D20] {
        let p = GearMeshParams { kind, ..p.clone() };
        let m = gear(&g, &p).unwrap();
        assert_conforming(&m.mesh);
        for f in &m.flanks {
            let fine = [0, 1, 19].contains(&f.tooth);
            assert_eq!(f.rows, if fine { 21 } else { 4 });
        }
        let whole = gear(
            &g,
            &GearMeshParams {
                fine_teeth: None,
                ..p.clone()
            },
        )
        .unwrap();
        assert!(2 * m.mesh.element_count() < whole.mesh.element_count());
        assert!(quality(&m.mesh).min_scaled_jacobian > 0.45);
    }
}

/// A relieved and crowned flank is, plane by plane, the plain involute turned by removed / (r_b cos beta_b).
#[test]
fn modifications_are_laid_normal_to_the_flank() {
    let plain = bored(
        GearParams {
            helix_angle: 0.3,
            ..params(24)
        },
        0.5,
    );
    let with = |modifications| {
        Gear::new(GearParams {
            modifications,
            ..plain.params().clone()
        })
        .unwrap()
    };
    let rows = [vec![1e-6, 4e-6, 0.0], vec![0.0, -2e-6, 3e-6]];
    let measured = Topography::new(&rows, None, None).unwrap();
    let modified = with(Modifications {
        tip_relief: Some(TipRelief {
            amount: 60e-6,
            start_radius: plain.r_reference(),
            shape: ReliefShape::Linear,
        }),
        profile_crowning: 10e-6,
        lead_crowning: 20e-6,
        end_relief: [
            None,
            Some(EndRelief {
                amount: 5e-6,
                length: 4e-3,
                shape: ReliefShape::Parabolic,
            }),
        ],
        helix_slope: [6e-6, -3e-6],
        twist: [-8e-6, 4e-6],
        topography: [None, Some(Arc::new(measured))],
    });
    let p = layered(ElementKind::C3D20, 2);
    let (a, b) = (gear(&plain, &p).unwrap(), gear(&modified, &p).unwrap());
    let twist = 0.3_f64.tan() / plain.r_reference();
    let mut greatest = 0.0_f64;
    for (f, g) in a.flanks.iter().zip(&b.flanks) {
        for (x, y) in f.positions.iter().zip(&g.positions) {
            assert_eq!(x.z, y.z);
            let removed = modified.flank_deviation(f.side, x.xy().norm(), x.z / 5e-3);
            let centre = f64::from(f.tooth) * plain.pitch_angle() + twist * y.z;
            let angle = (y.y.atan2(y.x) - centre + PI).rem_euclid(2.0 * PI) - PI;
            let found =
                plain.half_angle_at_roll(plain.roll_length(y.xy().norm())) - f.side.sign() * angle;
            let normal = found * plain.r_base() * plain.base_helix_angle().cos();
            assert!((normal - removed).abs() < 1e-12, "{normal} {removed}");
            greatest = greatest.max(removed);
        }
    }
    assert!(greatest > 85e-6);
    let q = quality(&b.mesh);
    assert!(q.min_scaled_jacobian > 0.45 && q.volume < quality(&a.mesh).volume);
    // Root and bore stay where they were.
    let moved = |n: u32| (a.mesh.nodes[n as usize] - b.mesh.nodes[n as usize]).norm();
    assert!(a.bore.iter().all(|&n| moved(n) == 0.0));
}

#[test]
fn bad_input_is_refused_with_a_way_out() {
    let g = spur(20);
    let said = |g: &Gear, p: GearMeshParams| gear(g, &p).map(|_| ()).unwrap_err().to_string();
    let with = |change: &dyn Fn(&mut GearMeshParams)| {
        let mut p = small();
        change(&mut p);
        said(&g, p)
    };
    let web = |inner_radius, outer_radius| Web {
        inner_radius,
        outer_radius,
        thickness: 4e-3,
        layers: 1,
        hub_layers: 1,
    };
    let cases = [
        (
            with(&|p| p.kind = ElementKind::C3D10),
            "built of hexahedra, not of C3D10: take C3D8, C3D8I, C3D20, C3D20R",
        ),
        (
            with(&|p| p.tooth.across = 2),
            "elements across the tooth is 2; expected 3 to 1000",
        ),
        (
            with(&|p| p.tooth.fillet = 1),
            "elements along the fillet is 1; expected 2 to 1000",
        ),
        (with(&|p| p.width = 0), "layers over the width is 0"),
        (with(&|p| p.layers = 0), "layers of the skin is 0"),
        (with(&|p| p.rim = 2000), "layers of the rim is 2000"),
        (
            with(&|p| p.skin_growth = f64::NAN),
            "growth in the skin is NaN; expected a ratio",
        ),
        (
            with(&|p| p.rim_growth = Some(0.0)),
            "growth in the rim is 0",
        ),
        (
            with(&|p| p.flank_grading = 1e3),
            "grading of the flank is 1000",
        ),
        (
            with(&|p| {
                p.flank_focus = Some(Focus {
                    place: 0.5,
                    reach: 0.0,
                });
            }),
            "reach of the focus is 0; expected a part",
        ),
        (
            with(&|p| {
                p.sector = true;
                p.fine_teeth = Some(FineTeeth {
                    teeth: vec![0],
                    others: p.tooth,
                });
            }),
            "a sector is one tooth",
        ),
        (
            with(&|p| {
                p.fine_teeth = Some(FineTeeth {
                    teeth: vec![20],
                    others: p.tooth,
                })
            }),
            "fine tooth 20 does not exist: the teeth are 0 to 19",
        ),
        (
            with(&|p| {
                p.fine_teeth = Some(FineTeeth {
                    teeth: vec![1],
                    others: Tooth {
                        flank: 0,
                        ..p.tooth
                    },
                })
            }),
            "elements along the flank is 0",
        ),
        (
            with(&|p| p.web = Some(web(25e-3, 30e-3))),
            "web is 2; expected 3",
        ),
        (
            with(&|p| (p.web, p.width) = (Some(web(10e-3, 30e-3)), 3)),
            "does not fit",
        ),
        (
            with(&|p| {
                p.tooth = Tooth {
                    flank: 900,
                    fillet: 900,
                    root: 900,
                    across: 900,
                };
                (p.width, p.rim) = (900, 900);
            }),
            "use fewer elements, or raise the limit with --memory",
        ),
    ];
    for (found, expected) in cases {
        assert!(
            found.contains(expected),
            "expected `{expected}` in: {found}"
        );
    }
    let r = GearMeshParams {
        rim: 0,
        ..GearMeshParams::default()
    };
    assert!(rack(&a_rack(0.0), &r).is_err());
}

/// Rims down to a thousandth of the root radius.
#[test]
fn thin_rims_have_sound_elements() {
    for part in [0.95, 0.98, 0.99, 0.999] {
        for kind in [ElementKind::C3D8, ElementKind::C3D20] {
            let p = layered(kind, 2);
            let q = quality(&gear(&bored(params(20), part), &p).unwrap().mesh);
            assert!(
                q.min_scaled_jacobian > 0.2,
                "{part} {kind:?} {}",
                q.min_scaled_jacobian
            );
        }
    }
}
