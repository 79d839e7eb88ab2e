//! Loaded tooth contact against CalculiX: the stored static end values, same mesh, element and penalty.
//! Observed figures are printed: `cargo test --release -p gearbench-reference --test statics_calculix -- --nocapture`.
//!
//! CalculiX integrates the penalty pressure over the overlap of slave and master faces. Gauss points do not see that
//! overlap's outline: where only the edge of a tooth's tip digs into the other flank (the pair that starts early
//! under 34 um at the last position, a strip of 20 um on a face of 350 um) a coarse rule misses it.

#![allow(clippy::print_stdout)] // measured numbers belong to the log of a test run

mod common;

use common::{modelling, scene};
use gearbench_models::gear::parameters::ModelParameters;
use gearbench_models::geometry::{Gear, GearParams};
use gearbench_models::spec::{Passes, PointContact, PointRule, SurfaceKind};
use gearbench_models::stiffness::{Material, PairOrMesh, PairStiffness};
use gearbench_reference::MODELS;
use gearbench_reference::full_order::FullOrderParameters;
use gearbench_reference::statics::LoadedPair;

/// Force per width at 17 and 34 um, and that of the pairs behind, at and ahead at 34 um [N/mm].
const STORED: &str = include_str!("../calculix/static/stiffness_C3D8.csv");
/// Face width [m].
const WIDTH: f64 = 0.01;
/// Forces here in N, there in N/mm.
const PER_WIDTH: f64 = 1e-3 / WIDTH;

/// Position [m], forces at 17 and 34 um, forces of the pairs at 34 um.
struct Stored {
    s: f64,
    force: [f64; 2],
    pairs: [f64; 3],
}

fn stored() -> Vec<Stored> {
    STORED
        .lines()
        .skip(1)
        .map(|line| {
            let x: Vec<f64> = line.split(',').map(|x| x.parse().unwrap()).collect();
            Stored {
                s: x[1],
                force: [x[3], x[4]],
                pairs: [x[7], x[8], x[9]],
            }
        })
        .collect()
}

fn case_a(rule: PointRule, passes: Passes) -> LoadedPair {
    let gears = [(20, 0.015), (30, 0.025)].map(|(teeth, bore_radius)| {
        let params = GearParams {
            teeth,
            module: 4e-3,
            face_width: WIDTH,
            tip_radius: 0.3,
            bore_radius,
            ..Default::default()
        };
        Gear::new(params).unwrap()
    });
    let spec = scene(gears, Material::STEEL, 0.1001);
    let fe = FullOrderParameters::by_key([("mesh", "calculix/case-a-fine")]).unwrap();
    let points = PointContact {
        rule,
        passes,
        surface: SurfaceKind::Faceted,
        ..PointContact::new(1e15)
    };
    let stiffness = PairStiffness::Constant {
        per_width: 1.4e10,
        of: PairOrMesh::Pair,
    };
    let modelling = modelling(fe, stiffness, points.into());
    LoadedPair::new(&spec, &modelling, MODELS).unwrap()
}

/// Largest relative error over positions and levels; the last position at 34 um apart.
fn compare(rule: PointRule, passes: Passes) -> (f64, f64, f64) {
    let mut pair = case_a(rule, passes);
    let (mut worst, mut edge, mut share) = (0.0_f64, 0.0_f64, 0.0_f64);
    let rows = stored();
    assert_eq!(rows.len(), 8);
    for row in &rows {
        for (level, approach) in [17e-6, 34e-6].into_iter().enumerate() {
            let found = pair.at_approach(row.s, approach).unwrap();
            let error = found.force * PER_WIDTH / row.force[level] - 1.0;
            if level == 1 && row.pairs[0] > 0.0 {
                edge = edge.max(error.abs());
            } else {
                worst = worst.max(error.abs());
            }
            println!(
                "{rule:?} {passes:?} s = {:.4} mm, {:.0} um: {:7.2} N/mm, CalculiX {:7.2}, {:+.2} %",
                1e3 * row.s,
                1e6 * approach,
                found.force * PER_WIDTH,
                row.force[level],
                100.0 * error
            );
            if level == 1 {
                for (offset, stored) in (-1..=1).zip(row.pairs) {
                    let of_pair = found.pair(offset) * PER_WIDTH;
                    share = share.max((of_pair - stored).abs() / row.force[1]);
                }
            }
        }
    }
    let [equilibria, iterations] = pair.work();
    println!(
        "{rule:?} {passes:?}: worst {:.2} %, with the tip's edge alone in contact {:.2} %, shares {:.2} %; {equilibria} equilibria, {iterations} Newton iterations",
        100.0 * worst,
        100.0 * edge,
        100.0 * share
    );
    (worst, edge, share)
}

#[test]
fn contact_forces_are_those_of_calculix_at_every_position_and_load() {
    // A rule fine enough for the strip at the tip: 0.18 % everywhere.
    let rule = PointRule::Quadrature {
        along: 10,
        across: 2,
    };
    let (worst, edge, share) = compare(rule, Passes::Second);
    assert!(
        worst < 3e-3 && edge < 5e-3 && share < 5e-3,
        "{worst} {edge} {share}"
    );
}

#[test]
fn the_usual_rule_stays_within_half_a_per_cent_and_fewer_points_and_nodes_do_not() {
    let (worst, edge, _) = compare(PointRule::default(), Passes::First);
    assert!(worst < 5e-3 && edge < 5e-3, "{worst} {edge}");
    // With a few points along a face the strip at the tip is hit or missed as a whole.
    let few = PointRule::Quadrature {
        along: 3,
        across: 2,
    };
    let (worst, edge, _) = compare(few, Passes::First);
    assert!(
        worst < 1e-2 && (1e-2..8e-2).contains(&edge),
        "{worst} {edge}"
    );
    let (nodes, ..) = compare(PointRule::Nodes, Passes::First);
    assert!(nodes > worst, "{nodes} {worst}");
    assert!(nodes < 0.1, "{nodes}");
}
