//! Static transmission error of gears whose teeth deviate, over many base pitches: the envelope of the flanks.

mod common;

use common::{modelling, scene};
use gearbench_models::gear::table::MODELS as RIGID;
use gearbench_models::geometry::{
    Deviations, FlankDeviations, Gear, GearParams, GivenDeviations, Side,
};
use gearbench_models::spec::{FlankContact, PointContact, PointRule};
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
    let rigid = model == "rigid";
    let counts = [
        ("flank_elements", 14),
        ("fillet_elements", 2),
        ("across_elements", 6),
        ("rim_elements", 2),
        ("width_elements", 1),
    ];
    let modes = (model == "elastic").then_some(("modes", 0));
    let parameters = counts.into_iter().chain(modes).filter(|_| !rigid);
    let spec = scene(gears, Material::STEEL, 0.1001);
    let stiffness = PairStiffness::Constant {
        per_width: if rigid { 1.4e16 } else { 1.4e10 },
        of: PairOrMesh::Pair,
    };
    let mut rows = RIGID.iter().chain(MODELS);
    let row = rows.find(|row| row.id == model).unwrap();
    let model = row.spec(parameters).unwrap();
    // Between points the flanks meet by their sagitta: 0.2 um with so many.
    let points = PointContact {
        rule: PointRule::Quadrature {
            along: 10,
            across: 1,
        },
        ..PointContact::new(1e15)
    };
    let modelling = modelling(
        model,
        stiffness,
        match rigid {
            true => FlankContact::Toothing,
            false => points.into(),
        },
    );
    let models = if rigid { RIGID } else { MODELS };
    LoadedPair::new(&spec, &modelling, models).unwrap()
}

/// The approach of a pinion with pitch deviations, profile slope and run-out at 1 N/mm, less that of the plain one, is
/// at every position over many base pitches the smallest removed material of the pairs in contact, within the
/// deflection.
#[test]
fn long_period_error_is_the_envelope_of_the_flanks() {
    let wheel = || gear(30, 25e-3, Deviations::None);
    let list = |size: f64, turn: u32| {
        (0..20).map(move |k| size * f64::from((turn * k * k) % 13) / 6.0 - size)
    };
    let flank = FlankDeviations {
        cumulative_pitch: list(8e-6, 3).collect(),
        profile_slope: list(3e-6, 5).collect(),
        profile_form: Vec::new(),
    };
    let pinion = gear(
        20,
        15e-3,
        Deviations::Given(Box::new(GivenDeviations {
            sides: [flank, FlankDeviations::default()],
            runout: 20e-6,
            runout_direction: 1.0,
        })),
    );
    for model in ["rigid", "elastic", "fe"] {
        let mut with = pair(model, [pinion.clone(), wheel()]);
        let mut without = pair(model, [gear(20, 15e-3, Deviations::None), wheel()]);
        let layout = with.layout().clone();
        let (load, pitch) = (1e3 * WIDTH, layout.base_pitch);
        let mut range = [f64::MAX, f64::MIN];
        let positions: &[u32] = if model == "fe" {
            &[0, 13]
        } else {
            &[0, 1, 5, 8, 19]
        };
        for &k in positions {
            // One pair at the pitch point; two pairs about it.
            for part in [0.0, 0.5] {
                let s = layout.pitch_point + part * pitch;
                let turned = s + f64::from(k) * pitch;
                let found = with.under_force(turned, load).unwrap();
                let error = found.approach - without.under_force(s, load).unwrap().approach;
                // The pair ahead belongs to the tooth ahead.
                let removed = |tooth: i64, s: f64| {
                    pinion.tooth_deviation_at_roll(tooth, Side::Left, s + found.approach)[0]
                };
                let first = removed(-i64::from(k), s);
                let expected = match part > 0.0 {
                    true => first.min(removed(-i64::from(k) - 1, s - pitch)),
                    false => first,
                };
                range = [range[0].min(error), range[1].max(error)];
                let off = error - expected;
                let most = if model == "rigid" { 1e-10 } else { 0.3e-6 };
                assert!(off.abs() < most, "{model} {k} {part}: {error} {expected}");
            }
        }
        assert!(range[1] - range[0] > 10e-6, "{range:?}");
    }
}
