//! Whole pairs compared with published numbers and stored finite-element results.

use super::tooth::ToothProfile;
use super::*;
use crate::geometry::{GearParams, Rack, RackParams};

fn params(teeth: u32, module: f64, tip_radius: f64, bore_radius: f64) -> GearParams {
    GearParams {
        teeth,
        module,
        tip_radius,
        bore_radius,
        ..GearParams::default()
    }
}

/// Builds case A of the stored finite-element data: z 20/30, m 4 mm, b 10 mm, centre distance 100.1 mm.
fn case_a() -> (Gear, Gear, Pair) {
    let one = Gear::new(params(20, 4e-3, 0.3, 15e-3)).unwrap();
    let two = Gear::new(params(30, 4e-3, 0.3, 25e-3)).unwrap();
    let pair = Pair::new(&one, &two, 0.1001).unwrap();
    (one, two, pair)
}

const FIT: Foundation = Foundation::SainsotVelex(RootLength::TwoRfThetaF);

fn compliance(tooth: ToothModel, foundation: Foundation, hertz: Hertz) -> PairStiffness {
    PairStiffness::Compliance {
        tooth,
        foundation,
        hertz,
    }
}

/// CalculiX, one tooth pair of case A at and around the pitch point, secant between 17 and 34 um:
/// 13.7 to 14.4 N/(mm um) with C3D8 on one layer of elements, and about 12 expected from the
/// quadratic element on the same mesh. A plausibility band of 11.5 to 16 N/(mm um) for models that
/// know neither mesh nor penalty; nothing is fitted to it. The values beside the models pin them
/// against unintended change.
#[test]
fn single_pair_stiffness_lies_where_finite_elements_put_it() {
    let (one, two, pair) = case_a();
    // The load per width of the finite-element secant is 210 to 450 N/mm.
    let load = Hertz::WeberBanaschek {
        reference_load: Some(3300.0),
    };
    let models = [
        (compliance(ToothModel::Energy, FIT, Hertz::Linear), 13.93),
        (compliance(ToothModel::WeberBanaschek, FIT, load), 12.43),
        (
            compliance(ToothModel::Cornell, Foundation::Cornell, load),
            13.78,
        ),
        (
            compliance(ToothModel::WeberBanaschek, Foundation::WeberBanaschek, load),
            15.47,
        ),
        (
            PairStiffness::Iso6336 {
                variation: IsoVariation::IsoMean,
            },
            12.50,
        ),
    ];
    for (spec, pinned) in models {
        let curve = build(&spec, &one, &two, &pair, [Material::STEEL; 2], 10e-3).unwrap();
        for u in [-0.1245, 0.0005] {
            let k = curve.eval(pair.s_pitch() + u * pair.base_pitch()).0 / 10e-3 / N_PER_MM_UM;
            assert!((11.5..16.0).contains(&k), "{}: {k}", spec.describe());
        }
        let k = curve.eval(pair.s_pitch()).0 / 10e-3 / N_PER_MM_UM;
        assert!((k - pinned).abs() < 0.02, "{}: {k}", spec.describe());
    }
}

/// The curve reproduces the series of compliances between its samples.
#[test]
fn curve_interpolates_the_compliances() {
    let (one, two, pair) = case_a();
    let steel = [Material::STEEL; 2];
    let mate = (Mate::Gear(&two), &pair);
    for (tooth, foundation, hertz) in [
        (ToothModel::Energy, FIT, Hertz::Linear),
        (
            ToothModel::Cornell,
            Foundation::Cornell,
            Hertz::Log {
                reference_load: Some(1e3),
            },
        ),
    ] {
        let spec = compliance(tooth, foundation, hertz);
        let curve = build(&spec, &one, &two, &pair, steel, 10e-3).unwrap();
        let rows = compliance_table(&one, mate, (tooth, foundation, hertz), steel, 10e-3, 336)
            .unwrap()
            .rows;
        for row in &rows {
            let k = curve.eval(row.s).0;
            assert!((k * row.pair() - 1.0).abs() < 2e-6, "{}: {k}", row.s);
        }
        // The slope is that of the compliances, too.
        let (a, b) = (&rows[100], &rows[101]);
        let slope = (b.stiffness() - a.stiffness()) / (b.s - a.s);
        let middle = curve.eval(0.5 * (a.s + b.s)).1;
        assert!((slope / middle - 1.0).abs() < 1e-3, "{slope} {middle}");
    }
}

/// FZG type C, S30, 50/50 and 62/62 through the real geometry: the stated values of c' and
/// c_gamma_alpha to their printed digits.
#[test]
fn iso_values_of_whole_pairs() {
    let steel = [Material::STEEL_ISO; 2];
    let shifted = |teeth, x| {
        Gear::new(GearParams {
            profile_shift: x,
            ..params(teeth, 4.5e-3, 0.38, 10e-3)
        })
        .unwrap()
    };
    let plain = |teeth| Gear::new(params(teeth, 2e-3, 0.38, 10e-3)).unwrap();
    // FZG: the contact ratio, hence c_gamma_alpha, belongs to shortened tips; 91.5 mm leaves -0.06 um of
    // backlash.
    let cases = [
        (
            shifted(16, 0.1817),
            shifted(24, 0.1715),
            91.501e-3,
            12.3,
            None,
        ),
        (plain(30), plain(30), 60e-3, 12.8, Some(19.1)),
        (plain(50), plain(50), 100e-3, 14.05, Some(22.0)),
        (plain(62), plain(62), 124e-3, 14.5, Some(23.0)),
    ];
    for (one, two, distance, c_prime, c_mean) in cases {
        let pair = Pair::new(&one, &two, distance).unwrap();
        let mate = (Mate::Gear(&two), &pair);
        let iso = iso_of(&one, mate, steel).unwrap();
        assert!(
            (iso.c_prime / N_PER_MM_UM - c_prime).abs() < 0.055,
            "{iso:?}"
        );
        if let Some(c_mean) = c_mean {
            assert!(
                (iso.c_gamma_alpha / N_PER_MM_UM - c_mean).abs() < 0.055,
                "{iso:?}"
            );
        }
        // The mean over a base pitch of all pairs in contact is the norm's value.
        let spec = PairStiffness::Iso6336 {
            variation: IsoVariation::IsoMean,
        };
        let curve = build(&spec, &one, &two, &pair, steel, 20e-3).unwrap();
        let n = 20_000;
        let mean = (0..n)
            .map(|i| {
                let s = pair.s_start() + pair.base_pitch() * (f64::from(i) + 0.5) / f64::from(n);
                mesh_stiffness(&curve, &pair, s)
            })
            .sum::<f64>()
            / f64::from(n);
        assert!(
            (mean / (iso.c_gamma_alpha * 20e-3) - 1.0).abs() < 1e-4,
            "{mean}"
        );
    }
}

/// ROSS 62/62 (m 2 mm, b 20 mm, E 206 GPa, bore radius 17.5 mm) at the start of its mesh period:
/// 3.96623e8 N/m, a regression value of that package. Its inputs to the Sainsot-Velex formula differ
/// from the paper's: the lever is the height of the contact point instead of the crossing of line of
/// action and centreline, and theta_f takes the depth of the tool centre from `ha - rho` instead of
/// `hf - rho`. With those two fed to the same functions its value must come out; with ours the
/// result is only recorded.
#[test]
fn ross_pair_in_its_conventions_and_in_ours() {
    let steel = Material::STEEL_ISO;
    let (module, width, alpha) = (2e-3, 20e-3, 0.349066_f64);
    let rho = 0.25 / (1.0 - alpha.sin());
    let gear = Gear::new(GearParams {
        pressure_angle: alpha,
        ..params(62, module, rho - 1e-12, 17.5e-3)
    })
    .unwrap();
    let pair = Pair::new(&gear, &gear, 124e-3).unwrap();
    assert!((pair.contact_ratio() - 1.78978).abs() < 1e-5);

    let profile = ToothProfile::of_gear(&gear);
    let theta_f = (PI / 2.0 + 2.0 * alpha.tan() * (1.0 - rho) + 2.0 * rho / alpha.cos()) / 62.0;
    let factors = foundation::sainsot_velex_factors(theta_f, gear.r_root() / 17.5e-3);
    let of_tooth = |alpha: f64| {
        let load = profile.load_on_gear(&gear, gear.r_base() / alpha.cos());
        let lever =
            (load.height + profile.origin() - gear.r_root()) / (2.0 * gear.r_root() * theta_f);
        foundation::ring_compliance(factors, lever, load.beta, &steel, width)
            + profile.compliance(ToothModel::Energy, &steel, width, &load, 0.0)
    };
    let hertz = 1.0 / (width * hertz_limit(&steel));
    let start = (gear.r_base() / gear.r_form()).acos();
    let tip = (gear.r_base() / gear.r_tip()).acos();
    let pitch = (tip - start) / pair.contact_ratio();
    let k: f64 = [0.0, pitch]
        .map(|d| 1.0 / (of_tooth(start + d) + of_tooth(tip - d) + hertz))
        .iter()
        .sum();
    assert!((k / 3.96623e8 - 1.0).abs() < 2e-6, "{k}");

    let spec = compliance(ToothModel::Energy, FIT, Hertz::Linear);
    let curve = build(&spec, &gear, &gear, &pair, [steel; 2], width).unwrap();
    let sum: f64 = (Path::from(&pair).pairs_in_contact(pair.s_start()))
        .map(|s| curve.eval(s).0)
        .sum();
    assert!((sum / 4.1556e8 - 1.0).abs() < 1e-4, "{sum}");
    // Both pairs bend the same bodies, which that package leaves out.
    let ours = mesh_stiffness(&curve, &pair, pair.s_start());
    assert!((ours / 3.0248e8 - 1.0).abs() < 1e-3, "{ours}");
}

fn rack_pair() -> (Gear, Rack, Pair) {
    let gear = Gear::new(params(20, 2e-3, 0.3, 8e-3)).unwrap();
    let rack = Rack::new(RackParams {
        teeth: 5,
        module: 2e-3,
        tip_radius: 0.3,
        ..RackParams::default()
    })
    .unwrap();
    let pair = Pair::new(&gear, &rack, 20.05e-3).unwrap();
    (gear, rack, pair)
}

/// A rack is a gear of very many teeth, and its ring foundation is left out aloud.
#[test]
fn rack_is_the_limit_of_large_gears() {
    let (gear, rack, rack_pair) = rack_pair();
    let large = Gear::new(params(9000, 2e-3, 0.3, 1.0)).unwrap();
    let distance = 20.05e-3 + large.r_reference();
    let pair = Pair::new(&gear, &large, distance).unwrap();
    let steel = [Material::STEEL; 2];
    let hertz = Hertz::WeberBanaschek {
        reference_load: Some(3e3),
    };
    let model = (
        ToothModel::WeberBanaschek,
        Foundation::WeberBanaschek,
        hertz,
    );
    let on = |mate| compliance_table(&gear, mate, model, steel, 10e-3, 9).unwrap();
    let (a, b) = (
        on((Mate::Rack(&rack), &rack_pair)),
        on((Mate::Gear(&large), &pair)),
    );
    for (a, b) in a.rows.iter().zip(&b.rows) {
        assert!((a.s - b.s).abs() < 2e-5 * 20.0, "{} {}", a.s, b.s);
        assert!((a.pair() / b.pair() - 1.0).abs() < 0.01, "{a:?} {b:?}");
    }
    let ring = compliance(ToothModel::Energy, FIT, Hertz::Linear);
    let built = build_with_warnings(&ring, &gear, &rack, &rack_pair, steel, 10e-3).unwrap();
    assert!(
        built
            .warnings
            .contains(&StiffnessWarning::RackFoundationOmitted)
    );
    let log = compliance(
        ToothModel::Energy,
        Foundation::Rigid,
        Hertz::Log {
            reference_load: Some(1e3),
        },
    );
    let refused = build(&log, &gear, &rack, &rack_pair, steel, 10e-3);
    assert_eq!(refused, Err(StiffnessError::HertzFlat));
    let iso = PairStiffness::Iso6336 {
        variation: IsoVariation::CaiHayashi,
    };
    let curve = build(&iso, &gear, &rack, &rack_pair, steel, 10e-3).unwrap();
    let ends = curve.eval(rack_pair.s_start()).0 / curve.maximum().1;
    assert!((ends - 0.55).abs() < 1e-12);
}

#[test]
fn constants_and_tables() {
    let (one, two, pair) = case_a();
    let steel = [Material::STEEL; 2];
    let built = |spec: &PairStiffness| build_with_warnings(spec, &one, &two, &pair, steel, 10e-3);
    // The rigid gear of the movable-teeth paper: c = 5.72 N/(mm um), of the mesh.
    let mut constant = PairStiffness::Constant {
        per_width: 5.72e9,
        of: PairOrMesh::Mesh,
    };
    assert!(constant.describe().contains("5.7200 N/(mm um) of the mesh"));
    let curve = built(&constant).unwrap().curve;
    assert_eq!(curve.eval(pair.s_pitch()), (5.72e7, 0.0));
    let two_pairs = pair.s_pitch() - 0.5 * pair.base_pitch();
    assert_eq!(mesh_stiffness(&curve, &pair, two_pairs), 5.72e7);
    assert_eq!(load_shares(&curve, &pair, two_pairs)[0].1, 0.5);
    if let PairStiffness::Constant { of, .. } = &mut constant {
        *of = PairOrMesh::Pair;
    }
    let curve = built(&constant).unwrap().curve;
    assert_eq!(mesh_stiffness(&curve, &pair, two_pairs), 2.0 * 5.72e7);

    let table = |last: f64, ends, of| PairStiffness::Table {
        s: vec![pair.s_start(), pair.s_pitch(), last],
        k: vec![1e8, 1.4e8, 1e8],
        of,
        ends,
        interpolation: Interpolation::Linear,
    };
    let pairs = PairOrMesh::Pair;
    assert!(
        built(&table(pair.s_end(), Ends::Clamped, pairs))
            .unwrap()
            .warnings
            .is_empty()
    );
    let short = built(&table(0.02, Ends::Clamped, pairs)).unwrap();
    assert!(short.warnings[0].to_string().contains("held constant"));
    let period = pair.s_start() + pair.base_pitch();
    let mesh = table(period, Ends::Periodic, PairOrMesh::Mesh);
    assert!(built(&mesh).unwrap().warnings.is_empty());
    let other = built(&table(period + 1e-3, Ends::Periodic, PairOrMesh::Mesh)).unwrap();
    assert!(matches!(
        other.warnings[..],
        [StiffnessWarning::TablePeriod { .. }]
    ));
}

#[test]
fn impossible_values_are_refused() {
    let (one, two, pair) = case_a();
    let energy = compliance(ToothModel::Energy, FIT, Hertz::Linear);
    let refuse = |spec: &PairStiffness, m: Material, width: f64| {
        build(spec, &one, &two, &pair, [Material::STEEL, m], width)
            .unwrap_err()
            .to_string()
    };
    let steel = Material::STEEL;
    assert!(refuse(&energy, steel, 0.0).contains("face width"));
    let soft = Material {
        young: f64::NAN,
        ..steel
    };
    assert!(refuse(&energy, soft, 1e-2).contains("Young's modulus"));
    let strange = Material {
        poisson: 0.5,
        ..steel
    };
    assert!(refuse(&energy, strange, 1e-2).contains("Poisson"));
    let none = PairStiffness::Constant {
        per_width: -1.0,
        of: PairOrMesh::Pair,
    };
    assert!(refuse(&none, steel, 1e-2).contains("stiffness per width"));
    // A small bore is beyond the fit: it is held at its end, with a warning; a solid gear has a seat.
    let built = |bore| {
        let one = Gear::new(params(20, 4e-3, 0.3, bore)).unwrap();
        build_with_warnings(&energy, &one, &two, &pair, [steel; 2], 1e-2).unwrap()
    };
    let held = |w: &StiffnessWarning| matches!(w, StiffnessWarning::FoundationRatioHeld { .. });
    assert!(!built(0.0).warnings.iter().any(held));
    let built = built(4e-3);
    assert!(matches!(
        built.warnings[0],
        StiffnessWarning::FoundationRatioHeld { gear: 1, .. }
    ));
}
