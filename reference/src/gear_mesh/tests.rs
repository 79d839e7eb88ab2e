use super::*;
use crate::mesh::{ElementKind, Face, quality};
use crate::test_support::layered;
use gearbench_models::Vec3;
use gearbench_models::geometry::{Gear, GearParams, Side};

pub(super) fn params(teeth: u32) -> GearParams {
    GearParams {
        teeth,
        module: 4e-3,
        ..GearParams::default()
    }
}

/// A gear with its bore at a part of the root radius.
pub(super) fn bored(mut p: GearParams, part: f64) -> Gear {
    p.bore_radius = part * Gear::new(p.clone()).unwrap().r_root();
    Gear::new(p).unwrap()
}

pub(super) fn spur(teeth: u32) -> Gear {
    bored(params(teeth), 0.5)
}

pub(super) fn small() -> GearMeshParams {
    layered(ElementKind::C3D8I, 2)
}

/// Every node belongs to an element, every inner face to exactly two.
pub(super) fn assert_conforming(mesh: &Mesh) -> usize {
    let mut used = vec![false; mesh.nodes.len()];
    let mut faces = std::collections::HashMap::new();
    for e in 0..mesh.element_count() {
        for &n in mesh.element(e) {
            used[n as usize] = true;
        }
        for face in 0..6 {
            let c = mesh.face_corners(Face {
                element: e as u32,
                face,
            });
            *faces.entry(c.key()).or_insert(0) += 1;
        }
    }
    assert!(used.iter().all(|&u| u), "a node without an element");
    assert!(faces.values().all(|&n| n <= 2), "a face of three elements");
    faces.values().filter(|&&n| n == 1).count()
}

/// Outer faces of a body extruded from `section_edges` outer edges and `quads` quadrilaterals.
fn outer_faces(section_edges: usize, quads: usize, layers: usize) -> usize {
    section_edges * layers + 2 * quads
}

#[test]
fn a_gear_is_closed_and_conforming() {
    for kind in [ElementKind::C3D8, ElementKind::C3D20] {
        let p = layered(kind, 2);
        let m = gear(&spur(20), &p).unwrap();
        let quads = m.mesh.element_count() / p.width;
        // Surface of a tooth: tip, two flanks with fillet and root arc; at the bore one edge per column.
        let t = p.tooth;
        let surface = t.across + 2 * (t.flank + t.fillet + t.root);
        let bore = m.bore.len() / if kind == ElementKind::C3D8 { 3 } else { 8 };
        let outer = assert_conforming(&m.mesh);
        assert_eq!(outer, outer_faces(20 * surface + bore, quads, p.width));
        for &n in &m.bore {
            let r = m.mesh.nodes[n as usize].xy().norm();
            assert!((r / spur(20).params().bore_radius - 1.0).abs() < 1e-13);
        }
    }
}

#[test]
fn flanks_lie_on_the_involute_helicoid() {
    for (beta, kind) in [
        (0.0, ElementKind::C3D8),
        (0.3, ElementKind::C3D20),
        (-0.5, ElementKind::C3D8I),
    ] {
        let g = bored(
            GearParams {
                helix_angle: beta,
                profile_shift: 0.2,
                ..params(17)
            },
            0.4,
        );
        let m = gear(&g, &layered(kind, 2)).unwrap();
        let twist = beta.tan() / g.r_reference();
        let mut seen = 0;
        for tooth in 0..17 {
            for side in Side::BOTH {
                for &n in &m.mesh.node_sets[&flank_set(tooth, side)] {
                    let x = m.mesh.nodes[n as usize];
                    let (r, centre) = (x.xy().norm(), f64::from(tooth) * g.pitch_angle());
                    let angle = centre + twist * x.z + side.sign() * g.half_angle_at(r);
                    let exact = Vec3::new(r * angle.cos(), r * angle.sin(), x.z);
                    assert!((x - exact).norm() < 1e-12, "{tooth} {side:?} {x}");
                    assert!(r > g.r_form() - 1e-12 && r < g.r_tip() + 1e-12);
                    seen += 1;
                }
            }
        }
        assert!(seen >= 17 * 2 * 27);
    }
}

#[test]
fn flank_grids_run_from_root_to_tip_and_from_low_to_high_z() {
    let g = spur(20);
    for kind in [ElementKind::C3D8, ElementKind::C3D20R] {
        let m = gear(&g, &layered(kind, 2)).unwrap();
        assert_eq!(m.flanks.len(), 40);
        for (i, f) in m.flanks.iter().enumerate() {
            assert_eq!((f.tooth, f.side), (i as u32 / 2, Side::BOTH[i % 2]));
            assert_eq!((f.rows, f.columns, f.nodes.len()), (9, 3, 27));
            let r = |row: usize, column: usize| f.positions[row * 3 + column].xy().norm();
            assert!((r(0, 1) - g.r_form()).abs() < 1e-12 && (r(8, 1) - g.r_tip()).abs() < 1e-12);
            for row in 0..8 {
                assert!(r(row, 0) < r(row + 1, 0));
            }
            for (k, (&n, p)) in f.nodes.iter().zip(&f.positions).enumerate() {
                assert_eq!(m.mesh.nodes[n as usize], *p);
                assert!((p.z - (k % 3) as f64 * 5e-3 + 5e-3).abs() < 1e-15);
            }
            // The faces of the set are those of the grid.
            let faces = &m.mesh.face_sets[&format!("s{}", flank_set(f.tooth, f.side))];
            assert_eq!(faces.len(), 8 * 2);
            for (k, &face) in faces.iter().enumerate() {
                let (row, column) = (k / 2, k % 2);
                let mut expected = [0, 1, 3, 4].map(|d| f.nodes[row * 3 + column + d]);
                expected.sort_unstable();
                assert_eq!(m.mesh.face_corners(face).key(), expected);
            }
        }
    }
}

#[test]
fn a_spur_tooth_is_its_own_mirror_image() {
    let m = gear(
        &spur(23),
        &GearMeshParams {
            kind: ElementKind::C3D20,
            sector: true,
            ..small()
        },
    )
    .unwrap();
    let key = |v: Vec3| [v.x, v.y, v.z].map(|c| (c * 1e10).round() as i64);
    let all: std::collections::HashMap<_, _> = m.mesh.nodes.iter().map(|&v| (key(v), v)).collect();
    for v in &m.mesh.nodes {
        let image = Vec3::new(v.x, -v.y, v.z);
        let found = all.get(&key(image)).expect("a mirror node");
        assert!((found - image).norm() < 1e-12);
    }
}

#[test]
fn cuts_of_a_sector_match_by_one_turn() {
    for (beta, kind) in [(0.0, ElementKind::C3D8), (0.35, ElementKind::C3D20)] {
        let g = bored(
            GearParams {
                helix_angle: beta,
                ..params(19)
            },
            0.6,
        );
        let whole = gear(&g, &layered(kind, 2)).unwrap();
        let m = sector(&g, &layered(kind, 2)).unwrap();
        let (low, high) = (&m.mesh.node_sets["cut_low"], &m.mesh.node_sets["cut_high"]);
        assert_eq!(low.len(), high.len());
        let turn = nalgebra::Rotation3::from_axis_angle(&Vec3::z_axis(), g.pitch_angle());
        for (&a, &b) in low.iter().zip(high) {
            let error = turn * m.mesh.nodes[a as usize] - m.mesh.nodes[b as usize];
            assert!(error.norm() < 1e-15 + 1e-14 * g.r_tip());
        }
        assert_eq!(m.mesh.element_count() * 19, whole.mesh.element_count());
        let inside = m.mesh.nodes.len() - low.len();
        assert_eq!(inside * 19, whole.mesh.nodes.len());
        let q = (quality(&m.mesh), quality(&whole.mesh));
        assert!((19.0 * q.0.volume / q.1.volume - 1.0).abs() < 1e-12);
    }
}

/// Signed errors of volume and polar moment against the integrals of the section.
fn errors(g: &Gear, p: &GearMeshParams) -> [f64; 2] {
    let q = quality(&gear(g, p).unwrap().mesh);
    let exact = g.mass_properties(1.0);
    [
        q.volume / exact.mass - 1.0,
        q.polar_moment / exact.izz - 1.0,
    ]
}

fn times(n: usize, kind: ElementKind) -> GearMeshParams {
    GearMeshParams {
        kind,
        tooth: Tooth {
            flank: 4 * n,
            fillet: 3 * n,
            root: n,
            across: 4 * n,
        },
        layers: n,
        rim: 4 * n,
        width: 1,
        ..GearMeshParams::default()
    }
}

#[test]
fn volume_and_inertia_converge() {
    let g = spur(20);
    // Chords miss the outline at second order, parabolas at fourth.
    for (kind, order, bound) in [
        (ElementKind::C3D8, 2.0, 2e-5),
        (ElementKind::C3D20, 4.0, 1e-7),
    ] {
        let (coarse, fine) = (errors(&g, &times(4, kind)), errors(&g, &times(8, kind)));
        for i in 0..2 {
            let found = (coarse[i] / fine[i]).log2();
            assert!(
                (found - order).abs() < 0.2,
                "{kind:?} {found}: {coarse:?} {fine:?}"
            );
            assert!(fine[i].abs() < bound, "{kind:?}: {fine:?}");
        }
    }
}

/// Every gear that can be cut has a mesh: teeth, shifts, tools, bores, helix, coarse and fine.
#[test]
fn all_gears_have_sound_elements() {
    let mut worst = (f64::INFINITY, String::new());
    let mut count = 0;
    for teeth in [8, 10, 12, 17, 20, 30, 60, 120, 200] {
        for shift in [-0.5, -0.2, 0.0, 0.3, 0.6, 1.0] {
            for (tool, dedendum) in [
                (0.0, 1.25),
                (0.25, 1.25),
                (0.38, 1.25),
                (0.471, 1.25),
                (0.3, 1.4),
            ] {
                for (beta, bore) in [(0.0, 0.1), (0.0, 0.9), (0.5, 0.5)] {
                    let p = GearParams {
                        profile_shift: shift,
                        tip_radius: tool,
                        dedendum,
                        helix_angle: beta,
                        ..params(teeth)
                    };
                    if Gear::new(p.clone()).is_err() {
                        continue;
                    }
                    let g = bored(p, bore);
                    let fine = Tooth {
                        flank: 12,
                        fillet: 6,
                        root: 3,
                        across: 9,
                    };
                    let coarse = Tooth {
                        flank: 3,
                        fillet: 2,
                        root: 1,
                        across: 3,
                    };
                    for (tooth, layers, rim) in
                        [(Tooth::default(), 2, 4), (fine, 3, 6), (coarse, 1, 2)]
                    {
                        for kind in [ElementKind::C3D8, ElementKind::C3D20] {
                            let name = || {
                                format!(
                                    "z {teeth} x {shift} tool {tool} h_f {dedendum} helix {beta} bore {bore} \
                                     {tooth:?} {kind:?}"
                                )
                            };
                            let p = GearMeshParams {
                                kind,
                                tooth,
                                layers,
                                rim,
                                width: 1,
                                sector: true,
                                ..GearMeshParams::default()
                            };
                            let m = gear(&g, &p).unwrap_or_else(|e| panic!("{}: {e}", name()));
                            let q = quality(&m.mesh);
                            count += 1;
                            if q.min_scaled_jacobian < worst.0 {
                                worst = (q.min_scaled_jacobian, name());
                            }
                        }
                    }
                }
            }
        }
    }
    assert!(count > 2000, "{count}");

    assert!(worst.0 > 0.4, "{worst:?} of {count}");
}
