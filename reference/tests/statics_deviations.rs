//! Static transmission error of gears whose teeth deviate, over many base pitches: the envelope of the flanks.

mod common;

use common::{modelling, scene};
use gearbench_models::geometry::{Deviations, Gear, GearParams, Side};
use gearbench_models::spec::{ModelSpec, PointContact, Value};
use gearbench_models::stiffness::{Material, PairOrMesh, PairStiffness};
use gearbench_reference::MODELS;
use gearbench_reference::statics::LoadedPair;

const WIDTH: f64 = 0.01;

fn gear(teeth: u32, bore_radius: f64, deviations: Deviations) -> Gear {
    Gear::new(GearParams {
        teeth,
        module: 4e-3,
        face_width: WIDTH,
        bore_radius,
        deviations,
        ..GearParams::default()
    })
    .unwrap()
}

fn pair(model: &str, gears: [Gear; 2]) -> LoadedPair {
    let counts = [
        ("flank_elements", 6.0),
        ("fillet_elements", 2.0),
        ("across_elements", 6.0),
        ("rim_elements", 2.0),
        ("width_elements", 1.0),
    ];
    let modes = (model == "elastic").then_some(("modes", 0.0));
    let parameters = counts
        .into_iter()
        .chain(modes)
        .map(|(key, n)| (key.to_string(), Value::Number(n)))
        .collect();
    let spec = scene(gears, Material::STEEL, 0.1001);
    let stiffness = PairStiffness::Constant {
        per_width: 1.4e10,
        of: PairOrMesh::Pair,
    };
    let model = ModelSpec {
        id: model.into(),
        parameters,
    };
    let modelling = modelling(model, stiffness, Some(PointContact::new(1e15)));
    LoadedPair::new(&spec, &modelling, MODELS).unwrap()
}

/// Pitch, profile and run-out of a drawn pinion at 1 N/mm: its approach less that of the plain one is, at every
/// position over many base pitches, the least of what the pairs in contact have removed, within the deflection.
#[test]
fn long_period_error_is_the_envelope_of_the_flanks() {
    let wheel = || gear(30, 25e-3, Deviations::None);
    let pinion = gear(20, 15e-3, Deviations::Class { class: 8, seed: 5 });
    for model in ["elastic", "fe"] {
        let mut with = pair(model, [pinion.clone(), wheel()]);
        let mut without = pair(model, [gear(20, 15e-3, Deviations::None), wheel()]);
        let layout = with.layout().clone();
        let (load, pitch) = (1e3 * WIDTH, layout.base_pitch);
        let mut range = [f64::MAX, f64::MIN];
        for k in [0, 1, 2, 5, 8, 13, 19] {
            // One pair at the pitch point; two pairs about it.
            for part in [0.0, 0.5] {
                let s = layout.pitch_point + part * pitch;
                let turned = s + f64::from(k) * pitch;
                let found = with.under_force(turned, load).unwrap();
                let error = found.approach - without.under_force(s, load).unwrap().approach;
                // The pair ahead belongs to the tooth ahead.
                let removed =
                    |tooth: i64, s: f64| pinion.tooth_deviation_at_roll(tooth, Side::Left, s)[0];
                let first = removed(-i64::from(k), s);
                let expected = match part > 0.0 {
                    true => first.min(removed(-i64::from(k) - 1, s - pitch)),
                    false => first,
                };
                range = [range[0].min(error), range[1].max(error)];
                let off = error - expected;
                assert!(off.abs() < 0.3e-6, "{model} {k} {part}: {error} {expected}");
            }
        }
        assert!(range[1] - range[0] > 10e-6, "{range:?}");
    }
}
