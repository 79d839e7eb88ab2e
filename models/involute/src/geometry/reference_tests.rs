//! Published gears and the stored finite-element decks, each with its source.

use super::*;

const DENSITY: f64 = 7850.0;

fn near(name: &str, found: f64, expected: f64, tolerance: f64) {
    assert!(
        (found - expected).abs() <= tolerance,
        "{name}: found {found}, expected {expected} +- {tolerance:e}"
    );
}

fn standard(teeth: u32, module: f64) -> GearParams {
    GearParams {
        teeth,
        module,
        ..GearParams::default()
    }
}

/// Gear of the CalculiX decks: tip radius factor 0.3.
fn deck_gear(teeth: u32, module: f64, width: f64, bore: f64) -> Gear {
    Gear::new(GearParams {
        tip_radius: 0.3,
        face_width: width,
        bore_radius: bore,
        ..standard(teeth, module)
    })
    .unwrap()
}

/// CalculiX reference, case A fine: its `params` file to all digits given there.
#[test]
fn calculix_case_a() {
    let (one, two) = (
        deck_gear(20, 4e-3, 10e-3, 15e-3),
        deck_gear(30, 4e-3, 10e-3, 25e-3),
    );
    near("r_base 1", one.r_base(), 0.037_587_704_831_436_336, 1e-16);
    near("r_form 1", one.r_form(), 0.037_612_676_199_799_82, 1e-15);
    near("r_form 2", two.r_form(), 0.056_976_279_661_200_73, 1e-15);
    near("r_root 1", one.r_root(), 0.035, 1e-16);
    near("r_tip 2", two.r_tip(), 0.064, 1e-16);
    let pair = Pair::new(&one, &two, 0.1001).unwrap();
    let aw = pair.working_pressure_angle();
    near("alpha_w", aw.to_degrees(), 20.156_673_260_849_868, 1e-11);
    near(
        "eps_alpha",
        pair.contact_ratio(),
        1.580_508_640_271_647_5,
        1e-12,
    );
    near("p_bt", pair.base_pitch(), 0.011_808_525_736_374_198, 1e-16);
    near("s_A", pair.s_start(), 0.004_209_311_364_206_554, 1e-15);
    near("s_E", pair.s_end(), 0.022_872_788_319_416_092, 1e-15);
    near("s_C", pair.s_pitch(), 0.013_797_320_229_117_59, 1e-15);
    near(
        "j_wt",
        pair.backlash_circ(),
        7.314_090_205_652_081e-5,
        1e-15,
    );
    let s = pair.s_pitch();
    near(
        "theta 1",
        pair.tooth_angle(s, Side::Left),
        -0.078_174_477_168_633_35,
        1e-14,
    );
    near(
        "theta 2",
        pair.mate_position(s, 2e-6, Side::Left),
        3.089_562_642_608_659,
        1e-14,
    );
}

/// CalculiX reference, case C.
#[test]
fn calculix_case_c() {
    let gear = deck_gear(30, 10e-3, 40e-3, 50e-3);
    near("r_form", gear.r_form(), 0.142_440_699_153_001_8, 1e-15);
    let pair = Pair::new(&gear, &gear, 0.3002).unwrap();
    near(
        "eps_alpha",
        pair.contact_ratio(),
        1.633_755_349_174_262,
        1e-12,
    );
    near("s_A", pair.s_start(), 0.027_479_367_802_310_36, 1e-15);
    near("s_E", pair.s_end(), 0.075_709_973_021_468_58, 1e-15);
    near(
        "j_wt",
        pair.backlash_circ(),
        1.460_508_710_641_600_4e-4,
        1e-14,
    );
    let s = pair.s_pitch();
    near(
        "theta 1",
        pair.tooth_angle(s, Side::Left),
        -0.052_116_621_612_021_5,
        1e-14,
    );
    near(
        "theta 2",
        pair.mate_position(s, 1e-5, Side::Left),
        3.089_405_086_792_939_7,
        1e-14,
    );
}

/// Boundary nodes of tooth 1 in the case A deck (written to 11 digits): form circle, middle of the
/// fillet and tip, as radius and angle from the tooth centreline.
#[test]
fn calculix_flank_and_fillet_nodes() {
    let gear = deck_gear(20, 4e-3, 10e-3, 15e-3);
    let centre = -0.078_174_477_168_633_35f64;
    for ([x, y], name) in [
        ([4.395_225_682_1e-2f64, -2.049_175_536_6e-3f64], "tip"),
        ([4.366_331_626_5e-2, -1.857_547_651_7e-3], "flank"),
        ([4.155_789_479_5e-2, -6.532_546_347_5e-4], "flank"),
    ] {
        let angle = y.atan2(x) - centre;
        near(name, angle, gear.half_angle_at(x.hypot(y)), 2e-9);
    }
    near(
        "form",
        gear.half_angle_at(0.037_612_676_2),
        0.093_428_06,
        6e-9,
    );
    near(
        "fillet",
        gear.half_angle_at(0.035_899_950),
        0.104_783_24,
        2e-8,
    );
}

/// Mass and inertia of the meshed gears. The meshes have straight edges: chords across the concave
/// fillet add material, most on the impact deck, whose remote teeth have three edges per flank.
#[test]
fn calculix_mass_properties() {
    let (pinion, wheel) = ([4e-3, 10e-3, 15e-3], [4e-3, 10e-3, 25e-3]);
    let cases = [
        // Uniform meshes of the modal decks (8 edges per flank).
        (20, pinion, 0.332_857, 3.096_810e-4, 1.2e-3),
        (30, wheel, 0.725_171, 1.542_303_5e-3, 1.2e-3),
        // Impact decks.
        (20, pinion, 0.333_447_88, 3.102_056e-4, 3e-3),
        (30, wheel, 0.725_650_64, 1.543_270_6e-3, 3e-3),
        (30, [10e-3, 40e-3, 50e-3], 19.527_898, 0.245_575_73, 3e-3),
        (20, [2e-3, 10e-3, 8e-3], 0.081_452_41, 1.927_314e-5, 3e-3),
    ];
    for (teeth, [module, width, bore], mass, izz, tolerance) in cases {
        let gear = deck_gear(teeth, module, width, bore);
        let exact = gear.mass_properties(DENSITY);
        let (more_mass, more_izz) = (mass / exact.mass - 1.0, izz / exact.izz - 1.0);
        assert!(more_mass > 0.0 && more_mass < tolerance, "mass {more_mass}");
        assert!(more_izz > 0.0 && more_izz < tolerance, "inertia {more_izz}");
    }
}

/// CalculiX reference, rack and pinion: positions, and nodes of rack tooth 0 as distance beyond the
/// reference line and half thickness (those on the fillet were interpolated on a fine polyline).
#[test]
fn calculix_rack_and_pinion() {
    let pinion = deck_gear(20, 2e-3, 10e-3, 8e-3);
    let rack = Rack::new(RackParams {
        teeth: 5,
        module: 2e-3,
        tip_radius: 0.3,
        body_height: 6e-3,
        ..RackParams::default()
    })
    .unwrap();
    near("r_form", pinion.r_form(), 0.018_806_338_099_899_91, 1e-15);
    let pair = Pair::new(&pinion, &rack, 0.02005).unwrap();
    let theta = pair.tooth_angle(8.5e-3, Side::Left);
    near("theta", theta, 0.009_765_502_696_315_542, 1e-14);
    let y = pair.mate_position(8.5e-3, 1e-6, Side::Left);
    near("y", y, 0.003_319_768_373_575_268_2, 1e-15);
    near("gap", pair.gap(theta, y, Side::Left), 1e-6, 1e-15);
    near("form depth", rack.form_depth(), 2.105_212e-3, 5e-10);
    for (depth, half) in [
        (-2.0e-3, 0.842_856e-3),
        (-0.357_915e-3, 1.440_526e-3),
        (2.105_212e-3, 2.337_031e-3),
        (2.312_636e-3, 2.465_268e-3),
        (2.392_545e-3, 2.558_211e-3),
        (2.478_028e-3, 2.739_970e-3),
    ] {
        near("rack flank", rack.half_thickness_at(-depth), half, 1e-8);
    }
    let more = 0.020_702_076_360_044_643 / rack.mass(DENSITY) - 1.0;
    assert!(more > 0.0 && more < 2e-3, "rack mass {more}");
}

/// FZG type C (GEARpie gear library and report C14): z 16/24, m 4.5, x 0.1817/0.1715.
#[test]
fn fzg_type_c() {
    let gear = |teeth, shift, addendum| {
        Gear::new(GearParams {
            profile_shift: shift,
            addendum,
            face_width: 14e-3,
            bore_radius: 15e-3,
            ..standard(teeth, 4.5e-3)
        })
        .unwrap()
    };
    let (one, two) = (gear(16, 0.1817, 1.0), gear(24, 0.1715, 1.0));
    near("r_b 1", one.r_base(), 33.829e-3, 5e-7);
    near("r_b 2", two.r_base(), 50.743e-3, 5e-7);
    near("r_a 1", one.r_tip(), 41.318e-3, 5e-7);
    near("r_a 2", two.r_tip(), 59.272e-3, 5e-7);
    near("r_f 1", one.r_root(), 31.193e-3, 5e-7);
    near("r_f 2", two.r_root(), 49.147e-3, 5e-7);
    let a = Pair::centre_distance_for_backlash(&one, &two, 0.0).unwrap();
    near("a", a, 91.5e-3, 1e-6);
    let pair = Pair::new(&one, &two, a).unwrap();
    near("p_bt", pair.base_pitch(), 13.285e-3, 5e-7);
    near("eps_alpha", pair.contact_ratio(), 1.46, 5e-3);
    near("T1T2", pair.line_length(), 34.93e-3, 5e-6);
    near("r_w 1", pair.pitch_radii()[0], 36.6e-3, 1e-6);

    // The report's later version shortens the tips to keep the clearance:
    // k = x_1 + x_2 - (a - a_0) / m, tip radii 41.228 / 59.182 mm.
    let k = 0.1817 + 0.1715 - (91.5 - 90.0) / 4.5;
    let (one, two) = (gear(16, 0.1817, 1.0 - k), gear(24, 0.1715, 1.0 - k));
    near("r_a 1", one.r_tip(), 41.228e-3, 6e-7);
    near("r_a 2", two.r_tip(), 59.182e-3, 6e-7);
    let pair = Pair::new(&one, &two, a).unwrap();
    near("eps_alpha", pair.contact_ratio(), 1.44, 5e-3);
    near("AC", pair.s_pitch() - pair.s_start(), 9.50e-3, 1e-5);
    near("AE", pair.s_end() - pair.s_start(), 19.10e-3, 1e-5);
}

/// S30 of GEARpie: 30/30, m 2, a 60.
#[test]
fn gearpie_s30() {
    let gear = Gear::new(GearParams {
        tip_radius: 0.25,
        face_width: 15e-3,
        ..standard(30, 2e-3)
    })
    .unwrap();
    near("r_b", gear.r_base(), 28.191e-3, 5e-7);
    near("r_f", gear.r_root(), 27.5e-3, 1e-15);
    let pair = Pair::new(&gear, &gear, 60e-3).unwrap();
    near("j_wt", pair.backlash_circ(), 0.0, 1e-12);
    near("eps_alpha", pair.contact_ratio(), 1.65, 5e-3);
    near("T1T2", pair.line_length(), 20.52e-3, 5e-6);
    near("AC", pair.s_pitch() - pair.s_start(), 4.88e-3, 5e-6);
    near("AE", pair.s_end() - pair.s_start(), 9.76e-3, 5e-6);
}

/// H501 and H701 of GEARpie: helical, 15 degrees, tips shortened to keep the clearance.
#[test]
fn gearpie_helical_pairs() {
    struct Case {
        z: [u32; 2],
        m: f64,
        x: [f64; 2],
        b: f64,
        p_bt: f64,
        r: [f64; 2],
        r_root: [f64; 2],
        r_tip: [f64; 2],
        eps: [f64; 3],
        path: [f64; 3],
    }
    let cases = [
        Case {
            z: [20, 30],
            m: 3.5,
            x: [0.1809, 0.0891],
            b: 23.0,
            p_bt: 10.652,
            r: [36.235, 54.352],
            r_root: [32.493, 50.289],
            r_tip: [40.336, 58.132],
            eps: [1.46, 0.54, 2.00],
            path: [34.45, 7.48, 15.55],
        },
        Case {
            z: [28, 42],
            m: 2.5,
            x: [0.2290, 0.1489],
            b: 17.0,
            p_bt: 7.609,
            r: [36.235, 54.352],
            r_root: [33.682, 51.599],
            r_tip: [39.276, 57.193],
            eps: [1.52, 0.56, 2.08],
            path: [34.45, 5.49, 11.53],
        },
    ];
    for c in cases {
        let mm = 1e-3;
        let build = |k: f64| {
            [0, 1].map(|i| {
                Gear::new(GearParams {
                    profile_shift: c.x[i],
                    helix_angle: [15f64, -15.0][i].to_radians(),
                    face_width: c.b * mm,
                    addendum: 1.0 - k,
                    ..standard(c.z[i], c.m * mm)
                })
                .unwrap()
            })
        };
        let [one, two] = build(0.0);
        let a = Pair::centre_distance_for_backlash(&one, &two, 0.0).unwrap();
        near("a", a, 91.5 * mm, 2e-6);
        let k = c.x[0] + c.x[1] - (a - one.r_reference() - two.r_reference()) / (c.m * mm);
        let gears = build(k);
        for i in 0..2 {
            near("r", gears[i].r_reference(), c.r[i] * mm, 6e-7);
            near("r_f", gears[i].r_root(), c.r_root[i] * mm, 6e-7);
            near("r_a", gears[i].r_tip(), c.r_tip[i] * mm, 2e-6);
        }
        let pair = Pair::new(&gears[0], &gears[1], a).unwrap();
        near("p_bt", pair.base_pitch(), c.p_bt * mm, 6e-7);
        near("eps_alpha", pair.contact_ratio(), c.eps[0], 6e-3);
        near("eps_beta", pair.overlap_ratio(), c.eps[1], 6e-3);
        near("eps_gamma", pair.total_contact_ratio(), c.eps[2], 6e-3);
        near("T1T2", pair.line_length(), c.path[0] * mm, 1e-5);
        near("AC", pair.s_pitch() - pair.s_start(), c.path[1] * mm, 1e-5);
        near("AE", pair.s_end() - pair.s_start(), c.path[2] * mm, 1e-5);
    }
}

/// Contact ratios of standard pairs: ROSS 62/62 (m 2, b 20, bore 35 mm: 1.78978) and 20/20 (m 10);
/// 50/50 at 1.76, for which ISO 6336-1 gives c_gamma/c' = 0.75 eps + 0.25.
#[test]
fn standard_pairs() {
    let ross = Gear::new(GearParams {
        face_width: 20e-3,
        bore_radius: 35e-3,
        ..standard(62, 2e-3)
    })
    .unwrap();
    let pair = Pair::new(&ross, &ross, 124e-3).unwrap();
    near("ROSS 62/62", pair.contact_ratio(), 1.789_78, 5e-6);
    let fifty = Gear::new(standard(50, 3e-3)).unwrap();
    let pair = Pair::new(&fifty, &fifty, 150e-3).unwrap();
    near("50/50", pair.contact_ratio(), 1.76, 6e-3);

    // ROSS backlash example: 50 um by a wider centre distance.
    let twenty = Gear::new(GearParams {
        face_width: 30e-3,
        ..standard(20, 10e-3)
    })
    .unwrap();
    let a = Pair::centre_distance_for_backlash(&twenty, &twenty, 50e-6).unwrap();
    let pair = Pair::new(&twenty, &twenty, a).unwrap();
    near("backlash", pair.backlash_circ(), 50e-6, 1e-14);

    // PHM-BGU example 17/38, m 3: seventeen standard teeth lie just beyond the undercut limit of
    // the 0.38 tool (17.1 teeth); a tool tip of 0.39 cuts them.
    let phm = |teeth| {
        Gear::new(GearParams {
            tip_radius: 0.39,
            face_width: 15e-3,
            ..standard(teeth, 3e-3)
        })
        .unwrap()
    };
    let pair = Pair::new(&phm(17), &phm(38), 82.5e-3).unwrap();
    near("PHM-BGU 17/38", pair.contact_ratio(), 1.60, 2e-2);
}
