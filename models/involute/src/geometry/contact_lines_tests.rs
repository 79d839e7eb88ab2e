//! Helical pairs of ISO/TR 6336-30 (example 1), of the NREL 5 MW gearbox and of the FVA's REXS example: geometry,
//! stiffness of the standard and contact lines, compared with all printed digits.

use super::*;
use crate::geometry::{Gear, GearParams, Side};
use crate::stiffness::{Material, N_PER_MM_UM, iso_of};

fn near(name: &str, found: f64, expected: f64, tolerance: f64) {
    assert!(
        (found - expected).abs() <= tolerance,
        "{name}: found {found}, expected {expected} +- {tolerance:e}"
    );
}

/// Published data of a pair; lengths in mm, angles in degrees.
struct Data {
    teeth: [u32; 2],
    module: f64,
    helix: f64,
    width: f64,
    distance: f64,
    /// Tip diameters; `None` for an addendum of one module.
    tips: Option<[f64; 2]>,
    /// Profile shift coefficients of both gears.
    shifts: [f64; 2],
    dedendum: f64,
}

impl Data {
    fn gears(&self) -> [Gear; 2] {
        [0, 1].map(|k| {
            let (m, beta) = (self.module, self.helix.to_radians());
            let x = self.shifts[k];
            let reference = f64::from(self.teeth[k]) * m / beta.cos();
            Gear::new(GearParams {
                teeth: self.teeth[k],
                module: 1e-3 * m,
                helix_angle: if k == 0 { beta } else { -beta },
                profile_shift: x,
                face_width: 1e-3 * self.width,
                addendum: self.tips.map_or(1.0, |d| 0.5 * (d[k] - reference) / m - x),
                dedendum: self.dedendum,
                tip_radius: 0.3,
                ..GearParams::default()
            })
            .unwrap()
        })
    }

    fn pair(&self) -> ([Gear; 2], Pair) {
        let [one, two] = self.gears();
        let pair = Pair::new(&one, &two, 1e-3 * self.distance).unwrap();
        ([one, two], pair)
    }
}

/// Data of example 1 of ISO/TR 6336-30.
const ISO: Data = Data {
    teeth: [17, 103],
    module: 8.0,
    helix: 15.8,
    width: 100.0,
    distance: 500.0,
    tips: Some([159.66, 872.35]),
    shifts: [0.145, 0.0],
    dedendum: 1.4,
};

/// Data of the high-speed stage of the NREL 5 MW gearbox.
const NREL: Data = Data {
    teeth: [24, 95],
    module: 14.0,
    helix: 10.0,
    width: 360.0,
    distance: 861.0,
    tips: Some([380.747_341_593_610_3, 1_395.373_393_808_040_9]),
    shifts: [0.480, 0.669],
    dedendum: 1.25,
};

/// Data of the stages of the FVA's example for REXS; no tip alteration.
const FVA: [Data; 2] = [
    Data {
        teeth: [27, 51],
        module: 4.5,
        helix: 21.0,
        width: 50.0,
        distance: 190.0,
        tips: None,
        shifts: [0.231_415, 0.231_415],
        dedendum: 1.25,
    },
    // Printed with 0.15074, whose tips it has, but which the distance leaves no backlash for.
    Data {
        teeth: [23, 34],
        module: 6.5,
        helix: 10.0,
        width: 74.0,
        distance: 190.0,
        tips: Some([166.765_898_48, 239.368_901_23]),
        shifts: [0.150_739_5, 0.150_739_5],
        dedendum: 1.25,
    },
];

#[test]
fn base_quantities_of_the_norms_example() {
    let ([one, two], pair) = ISO.pair();
    let virtual_teeth = |g: &Gear| {
        f64::from(g.teeth()) / (g.base_helix_angle().cos().powi(2) * g.params().helix_angle.cos())
    };
    near("z_n1", virtual_teeth(&one), 18.905_123, 5e-7);
    near("z_n2", virtual_teeth(&two), 114.542_804, 5e-7);
    near(
        "alpha_t",
        one.transverse_pressure_angle().to_degrees(),
        20.719_712,
        5e-7,
    );
    near(
        "beta_b",
        one.base_helix_angle().to_degrees(),
        14.824_535,
        5e-7,
    );
    near(
        "alpha_wt",
        pair.working_pressure_angle().to_degrees(),
        21.066_100,
        5e-7,
    );
    near("d_b1", 2e3 * one.r_base(), 132.198_569, 5e-7);
    near("d_b2", 2e3 * two.r_base(), 800.967_802, 5e-7);
    near("p_bt", 1e3 * pair.base_pitch(), 24.430_238, 5e-7);
    near(
        "g_alpha",
        1e3 * (pair.s_end() - pair.s_start()),
        37.844_640,
        5e-7,
    );
    // 9000 N m at 360 revolutions per minute on the pinion.
    near("F_t", 9000.0 / one.r_reference(), 127_352.381, 5e-4);
    let turns = 360.0 / 60.0 * std::f64::consts::TAU;
    near("v", turns * one.r_reference(), 2.664_198, 5e-7);
    // The distance without backlash, for the sum of shifts 0.145222.
    let mut shifted = ISO;
    shifted.shifts[0] = 0.145_222;
    let [one, two] = shifted.gears();
    let closest = Pair::centre_distance_for_backlash(&one, &two, 0.0).unwrap();
    near("a", 1e3 * closest, 500.0, 2e-6);
}

#[test]
fn contact_ratios_of_helical_pairs() {
    let known = [
        (&ISO, [1.549_090, 1.083_369]),
        (&NREL, [1.462_659_404, 1.421_329_671]),
        (&FVA[0], [1.470_467, 1.267_467]),
        (&FVA[1], [1.537_645, 0.629_272]),
    ];
    for (data, [transverse, overlap]) in known {
        let (_, pair) = data.pair();
        near("eps_alpha", pair.contact_ratio(), transverse, 5e-7);
        near("eps_beta", pair.overlap_ratio(), overlap, 5e-7);
    }
    let (_, pair) = NREL.pair();
    near("eps_alpha", pair.contact_ratio(), 1.462_659_404, 5e-10);
    near("eps_beta", pair.overlap_ratio(), 1.421_329_671, 5e-10);
}

#[test]
fn stiffness_of_the_norm_for_helical_pairs() {
    let known = [
        (
            &ISO,
            [
                17.855_840_471,
                12.370_471_913,
                17.464_849_629,
                14.845_122_184,
            ],
            1e-9,
        ),
        (&NREL, [20.051_82, 15.402_81, 20.747_50, 17.635_374], 5e-6),
    ];
    for (data, values, digit) in known {
        let ([one, two], pair) = data.pair();
        let iso = iso_of(&one, ((&two).into(), &pair), [Material::STEEL_ISO; 2]).unwrap();
        let found = [iso.c_th, iso.c_prime, iso.c_gamma_alpha, iso.c_gamma_beta()];
        let names = ["c'_th", "c'", "c_gamma_alpha", "c_gamma_beta"];
        for ((found, known), name) in found.iter().zip(values).zip(names) {
            near(name, found / N_PER_MM_UM, known, digit);
        }
    }
}

#[test]
fn contact_lines_of_helical_pairs() {
    let known = [
        (&ISO, [155.872, 163.832, 160.242_867], 5e-7),
        (&NREL, [483.667, 591.833, 533.710_7], 5e-5),
        (&FVA[0], [72.812, 84.018, 78.084_1], 5e-5),
        (&FVA[1], [94.901, 139.089, 115.331_5], 5e-5),
    ];
    for (data, [least, greatest, mean], of_mean) in known {
        let (_, pair) = data.pair();
        let lines = pair.contact_lines();
        near("shortest", 1e3 * lines.least, least, 5e-4);
        near("longest", 1e3 * lines.greatest, greatest, 5e-4);
        near("mean", 1e3 * lines.mean, mean, of_mean);
        // The mean of the lengths themselves; the length is linear between four places, the midpoint rule nearly exact.
        let n = 20_000;
        let at = |i: i32| pair.s_start() + pair.base_pitch() * (f64::from(i) + 0.5) / f64::from(n);
        let lengths: Vec<f64> = (0..n).map(|i| pair.contact_line_length(at(i))).collect();
        let sum = lengths.iter().sum::<f64>() / f64::from(n);
        assert!(
            (sum / lines.mean - 1.0).abs() < 1e-8,
            "{sum} {}",
            lines.mean
        );
        let within = |l: &f64| {
            (lines.least..=lines.greatest).contains(&(l * (1.0 + 1e-12)))
                || (lines.least..=lines.greatest).contains(&(l * (1.0 - 1e-12)))
        };
        assert!(lengths.iter().all(within));
    }
}

/// The sum over slices of the width, each on the path of contact or off it, converges to the contact lines with their
/// number.
#[test]
fn slices_come_to_the_contact_lines() {
    for data in [&ISO, &NREL, &FVA[0], &FVA[1]] {
        let (_, pair) = data.pair();
        let sliced = |s: f64, n: usize| {
            let on_path = |s: f64| {
                let pitch = pair.base_pitch();
                let first = ((pair.s_start() - s) / pitch).ceil();
                ((pair.s_end() - s) / pitch).floor() - first + 1.0
            };
            let each = (0..n).map(|i| {
                let zeta = (2 * i + 1) as f64 / n as f64 - 1.0;
                let z = 0.5 * pair.face_width() * zeta;
                on_path(s + z * pair.beta_b.tan())
            });
            each.sum::<f64>() * pair.face_width() / n as f64 / pair.beta_b.cos()
        };
        let worst = |n: usize| {
            let phases =
                (0..199).map(|i| pair.s_start() + pair.base_pitch() * f64::from(i) / 199.0);
            let errors = phases.map(|s| (sliced(s, n) - pair.contact_line_length(s)).abs());
            errors.fold(0.0, f64::max)
        };
        for n in [16, 64, 256, 1024] {
            // Every end of a line on the path is off by half a slice: two for each base pitch that the width overlaps.
            let slice =
                pair.overlap_ratio().ceil() * pair.face_width() / n as f64 / pair.beta_b.cos();
            let found = worst(n);
            assert!(found <= 1.01 * slice, "{n} slices: {found:e} of {slice:e}");
            assert!(
                found >= 0.2 * slice,
                "the error is that of slices: {found:e}"
            );
        }
    }
}

#[test]
fn spur_pairs_have_whole_widths() {
    let gear = |teeth| {
        Gear::new(GearParams {
            teeth,
            module: 4e-3,
            face_width: 0.02,
            ..GearParams::default()
        })
        .unwrap()
    };
    let pair = Pair::new(&gear(20), &gear(30), 0.1001).unwrap();
    let lines = pair.contact_lines();
    assert_eq!([lines.least, lines.greatest], [0.02, 0.04]);
    assert!((lines.mean / (0.02 * pair.contact_ratio()) - 1.0).abs() < 1e-15);
    assert_eq!(pair.contact_line_length(pair.s_pitch()), 0.02);
    assert_eq!(pair.contact_line_length(pair.s_start() + 1e-6), 0.04);
    let stood = pair.tooth_angle(pair.s_pitch(), Side::Left);
    let s = pair.path_coordinate(stood, Side::Left) + 3.0 * pair.base_pitch();
    assert_eq!(pair.contact_line_length(s), 0.02);
}
