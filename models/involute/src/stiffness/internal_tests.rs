//! Teeth of internal gears: racks in the limit of many teeth, and the same pair in either order.

use super::*;
use crate::geometry::{GearParams, Internal, Rack, RackParams};
use crate::stiffness::tooth::ToothProfile;

fn ring(teeth: u32) -> Gear {
    Gear::new(GearParams {
        teeth,
        module: 4e-3,
        tip_radius: 0.3,
        addendum: 0.8,
        profile_shift: if teeth > 1000 { 0.0 } else { -0.2 },
        internal: Some(Internal::default()),
        ..GearParams::default()
    })
    .unwrap()
}

#[test]
fn a_tooth_of_a_large_ring_is_that_of_a_rack() {
    let rack = Rack::new(RackParams {
        teeth: 5,
        module: 4e-3,
        tip_radius: 0.3,
        addendum: 0.8,
        ..RackParams::default()
    })
    .unwrap();
    let large = ring(10_000);
    let (p, q) = (ToothProfile::of_rack(&rack), ToothProfile::of_gear(&large));
    for model in [ToothModel::WeberBanaschek, ToothModel::Energy] {
        for h in [-2e-3, 0.0, 3e-3] {
            let of = |profile: &ToothProfile, load| {
                profile.compliance(model, &Material::STEEL, 1e-2, &load, 0.0)
            };
            let a = of(&p, p.load_on_rack(&rack, h));
            let b = of(&q, q.load_on_gear(&large, large.r_reference() - h));
            assert!((a / b - 1.0).abs() < 5e-3, "{h}: {a} {b}");
        }
    }
}

/// A line tangent to the base circle crosses the centreline at `r_b / cos(beta)`.
#[test]
fn the_load_follows_the_line_of_action() {
    let gear = ring(61);
    let profile = ToothProfile::of_gear(&gear);
    for i in 0..=10 {
        let r = gear.r_tip() + (gear.r_form() - gear.r_tip()) * f64::from(i) / 10.0;
        let load = profile.load_on_gear(&gear, r);
        let crossing = -gear.r_base() / load.beta.cos() - profile.origin();
        assert!((crossing - load.crossing()).abs() < 1e-12);
        // Inwards from the root, thinner and thinner.
        assert!(load.height > 0.0 && load.half_thickness < profile.half_thickness(0.0));
    }
}

#[test]
fn the_order_of_both_gears_does_not_matter() {
    let ring = ring(61);
    let planet = Gear::new(GearParams {
        teeth: 22,
        module: 4e-3,
        profile_shift: 0.2,
        thinning: 4e-5,
        ..GearParams::default()
    })
    .unwrap();
    let pairs = [
        Pair::new(&planet, &ring, 0.078).unwrap(),
        Pair::new(&ring, &planet, 0.078).unwrap(),
    ];
    let compliance = PairStiffness::Compliance {
        tooth: ToothModel::WeberBanaschek,
        foundation: Foundation::Ring,
        hertz: Hertz::WeberBanaschek {
            reference_load: None,
        },
    };
    let iso = PairStiffness::Iso6336 {
        variation: IsoVariation::IsoMean,
    };
    let materials = [Material::STEEL; 2];
    for spec in [compliance, iso] {
        let one = build(&spec, &planet, &ring, &pairs[0], materials, 1e-2).unwrap();
        let two = build(&spec, &ring, &planet, &pairs[1], materials, 1e-2).unwrap();
        for x in [0.0, 0.1, 0.5, 0.8, 1.0] {
            let s = pairs[0].s_start() + x * (pairs[0].s_end() - pairs[0].s_start());
            let (a, b) = (one.eval(s).0, two.eval(pairs[0].line_length() - s).0);
            assert!((a / b - 1.0).abs() < 1e-9, "{a} {b}");
            let per_width = a / 1e-2 / N_PER_MM_UM;
            assert!((8.0..30.0).contains(&per_width), "{per_width}");
            let (a, b) = (
                one.coupling(1, s).0,
                two.coupling(1, pairs[0].line_length() - s).0,
            );
            assert!((a - b).abs() < 1e-9 * (1.0 / one.eval(s).0), "{a} {b}");
        }
    }
}
