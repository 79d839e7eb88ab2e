use super::*;
use crate::gear_mesh;
use crate::reduction::{ModeSelection, Mounting, basis};
use crate::test_support::{self, coarse};
use gearbench_models::gear::elastic::reduced::FlankCompliance;
use gearbench_models::stiffness::Material;

/// All modes of a small rack.
fn rack() -> Basis {
    let rack = test_support::rack(3, 2e-3, |p| p.face_width = 4e-3);
    let mesh = gear_mesh::rack(&rack, &coarse(2, 1)).unwrap();
    let wanted = ModeSelection::Count(usize::MAX / 2);
    basis::of_mesh(
        &mesh,
        &Material::STEEL,
        &Mounting::rack(true, 0.01),
        wanted,
        false,
        None,
    )
    .unwrap()
}

fn gear() -> Basis {
    let gear = test_support::gear(18, 2e-3, |p| {
        p.face_width = 5e-3;
        p.bore_radius = 6e-3;
    });
    let sector = gear_mesh::sector(&gear, &coarse(2, 2)).unwrap();
    let mounting = Mounting::gear(true, 1e-6);
    basis::of_sector(
        &sector,
        &Material::STEEL,
        &mounting,
        ModeSelection::Count(120),
        false,
    )
    .unwrap()
}

fn choice(count: usize, by: Criterion) -> Choice {
    Choice {
        by,
        count,
        candidates: usize::MAX,
        highest: f64::INFINITY,
        time: f64::INFINITY,
        even_over_width: false,
    }
}

/// All modes together have the static compliance of the mesh.
#[test]
fn compliances_of_all_modes_add_up_to_the_static_one() {
    let b = rack();
    let FlankCompliance::Full(c) = &b.compliance.flanks else {
        panic!("a rack is not cyclic")
    };
    let n = b.normals.len();
    for even in [false, true] {
        let (mut sum, mut total) = (0.0, 0.0);
        for (g, grid) in b.flanks.grids().iter().enumerate() {
            let areas = reference_areas(&b.flanks, g, PointRule::Nodes);
            let together = if even { grid.columns } else { 1 };
            for (nodes, areas) in grid.nodes.chunks(together).zip(areas.chunks(together)) {
                let area: f64 = areas.iter().sum();
                for (i, a) in nodes.iter().zip(areas) {
                    for (j, b) in nodes.iter().zip(areas) {
                        sum += a * b / area * c[*i as usize * n + *j as usize];
                    }
                }
                total += area;
            }
        }
        let of_modes: f64 = flank_compliances(&b, even).iter().sum();
        let exact = sum / total;
        assert!((of_modes / exact - 1.0).abs() < 1e-7, "{of_modes} {exact}");
    }
}

#[test]
fn choices_grow_and_keep_families_whole() {
    let b = gear();
    for by in [Criterion::Frequency, Criterion::FlankCompliance] {
        let mut share = 0.0;
        for count in [0, 7, 20, 41, 80, 1000] {
            let kept = choose(&b, &choice(count, by));
            assert!(kept.len() <= count && kept.len() + 2 > count.min(b.omega.len()));
            assert!(kept.is_sorted_by(|a, b| a < b));
            for &i in &kept {
                let mut family = (0..b.family.len()).filter(|j| b.family[*j] == b.family[i]);
                assert!(family.all(|j| kept.contains(&j)), "half of a family");
            }
            let compliances = flank_compliances(&b, false);
            let of_kept: f64 = kept.iter().map(|&i| compliances[i]).sum();
            assert!(of_kept >= share);
            share = of_kept;
            if by == Criterion::FlankCompliance && kept.len() == count {
                // No other families of as many modes yield more.
                let lowest = choose(&b, &choice(count, Criterion::Frequency));
                assert!(of_kept >= lowest.iter().map(|&i| compliances[i]).sum::<f64>());
            }
        }
    }
    let half = 0.5 * (b.omega[50] + b.omega[51]);
    let low = choose(
        &b,
        &Choice {
            highest: half,
            candidates: 45,
            ..choice(1000, Criterion::FlankCompliance)
        },
    );
    assert!(low.iter().all(|&i| b.omega[i] < half && i < 45));
}

/// On a spur gear shapes are even or odd over the width; odd ones have no compliance under an even load.
#[test]
fn shapes_odd_over_the_width_do_not_count_where_contact_is_even() {
    let b = gear();
    let (all, even) = (flank_compliances(&b, false), flank_compliances(&b, true));
    let odd = all
        .iter()
        .zip(&even)
        .filter(|(a, e)| **e < 1e-9 * **a)
        .count();
    assert!(odd > 20 && odd < b.omega.len() - 20, "{odd}");
    let kept = choose(
        &b,
        &Choice {
            time: f64::INFINITY,
            even_over_width: true,
            ..choice(30, Criterion::FlankCompliance)
        },
    );
    assert!(kept.iter().all(|&i| even[i] > 1e-3 * all[i]));
}

#[test]
fn reduced_gears_are_sound_and_damping_is_what_was_asked() {
    let b = gear();
    let kept = choose(&b, &choice(30, Criterion::FlankCompliance));
    let damping = ModalDamping {
        ratio: 0.01,
        alpha: 100.0,
        beta: 1e-8,
    };
    let with = reduced(&b, &kept, &damping, true).unwrap();
    let without = reduced(&b, &kept, &damping, false).unwrap();
    assert_eq!(with.problem(), None);
    assert_eq!(without.problem(), None);
    assert!(with.residual.is_some() && without.residual.is_none());
    let none = reduced(&b, &[], &damping, true).unwrap();
    assert_eq!(none.problem(), None);
    let w = with.omega[3];
    assert_eq!(with.damping[3], 0.01 + 0.5 * (100.0 / w + 1e-8 * w));
    let strong = ModalDamping {
        beta: 1e-5,
        ..ModalDamping::default()
    };
    // Fast modes may be damped beyond their critical damping.
    let overdamped = reduced(&b, &kept, &strong, true).unwrap();
    assert_eq!(overdamped.problem(), None);
    assert!(overdamped.damping.iter().any(|z| *z > 1.0));
}

/// Twice the strain energy of flank nodes `k` and `l` of a reduced gear at an angular frequency: modes and residual compliance.
fn response(r: &Reduced, k: u32, l: u32, at: f64) -> f64 {
    let rows = r.rows();
    let residual = &r.residual.as_ref().unwrap().flanks;
    let modes = r.shapes_at(k).iter().zip(r.shapes_at(l)).zip(&r.omega);
    let moving: f64 = modes.map(|((a, b), w)| a * b / (w * w - at * at)).sum();
    residual.between(k, l, rows) + moving
}

/// Modes fitted to some teeth are oscillators within the span of all; static deflections are unchanged on every tooth.
#[test]
fn modes_made_for_teeth_leave_statics_as_they_are() {
    let b = gear();
    let damping = ModalDamping::default();
    let by = choice(40, Criterion::TeethInMesh);
    let teeth = [17, 0, 1];
    let made = made_for(&b, &teeth, &by).unwrap();
    assert_eq!(made.basis.omega.len(), 40);
    // Frequencies of a subspace lie among those of the whole.
    assert!(
        made.basis
            .omega
            .iter()
            .zip(&b.omega)
            .all(|(r, w)| r > &(w * (1.0 - 1e-9)))
    );
    assert!(made.basis.omega.is_sorted() && made.basis.omega[39] < b.omega[119] * (1.0 + 1e-9));
    let few = made.reduced(&damping, true).unwrap();
    assert_eq!(few.problem(), None);
    let all: Vec<usize> = (0..b.omega.len()).collect();
    let all = reduced(&b, &all, &damping, true).unwrap();
    let nodes_of = |tooth: u32| -> Vec<u32> {
        let grids = b.flanks.grids().iter().filter(|g| g.tooth == tooth);
        grids.flat_map(|g| g.nodes.clone()).collect()
    };
    let near: Vec<u32> = teeth.iter().flat_map(|t| nodes_of(*t)).collect();
    let far = nodes_of(8);
    let off = |r: &Reduced, nodes: &[u32], at: f64| {
        let (mut error, mut sum) = (0.0, 0.0);
        for &k in nodes {
            for &l in nodes {
                let expected = response(&all, k, l, at);
                error += (response(r, k, l, at) - expected).powi(2);
                sum += expected * expected;
            }
        }
        f64::sqrt(error / sum)
    };
    let both: Vec<u32> = near.iter().chain(&far).copied().collect();
    assert!(off(&few, &both, 0.0) < 1e-12);
    // Without the residual compliance, and with none.
    assert!(made.reduced(&damping, false).unwrap().residual.is_none());
    let none = made_for(&b, &teeth, &choice(0, Criterion::TeethInMesh)).unwrap();
    assert_eq!(none.reduced(&damping, true).unwrap().problem(), None);
}
