//! Contact on half-spaces of coarse elastic gears, compared with finite elements that resolve the contact themselves:
//! full order, with elements that are short along the flank around the contact and thin under it, without correction.
//!
//! The elements touch at one point along each face, with a penalty that gives next to nothing. Their half-width is twice
//! the standard deviation of the pressure over the arc of the flank, as it is of Hertz's semi-ellipse; their peak pressure
//! is that of a parabola through `p^2` about its middle.
//!
//! `cargo test --release -p gearbench-tests --test analytic graded -- --nocapture --include-ignored` (eight minutes).

use super::half_space::half_space;
use super::*;
use elements::{ElementFineness, toothing};
use gearbench_models::contact::pairs::LinePressure;
use gearbench_models::geometry::{
    Deviations, FlankDeviations, Gear, GivenDeviations, Side, inv, inv_inverse,
};
use gearbench_models::scene::ContactForce;
use gearbench_models::spec::{Body, GearSpec};
use gearbench_reference::statics::LoadedContact;

mod elements;

/// Changes the parameters of a gear.
fn change(gear: &mut GearSpec, change: impl FnOnce(&mut GearParams)) {
    let mut params = toothing(&gear.body).params().clone();
    change(&mut params);
    gear.body = Body::Gear(Gear::new(params).unwrap());
}

fn on_half_spaces(spec: &SceneSpec, layers: usize) -> LoadedPair {
    let modelling = half_space(8.0, layers as f64, 0.0);
    LoadedPair::new(spec, &modelling, gearbench::models::models()).unwrap()
}

/// Returns the forces of rows of points [N] by their arcs [m] on the involute of the base radius `rb`.
fn rows(contacts: &[ContactForce], rb: f64) -> Vec<(f64, f64)> {
    let mut rows: Vec<(f64, f64)> = Vec::new();
    for c in contacts {
        // Points of a row stand at the same arc.
        let arc = (c.x.xy().norm_squared() - rb * rb) / (2.0 * rb);
        match rows.iter_mut().find(|r| (r.0 - arc).abs() < 1e-6) {
            Some(row) => row.1 += c.normal_force,
            None => rows.push((arc, c.normal_force)),
        }
    }
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    rows
}

/// Returns the pressure of points on a part of the width [m].
fn pressed(contacts: &[ContactForce], gear: &Gear, width: f64) -> LinePressure {
    let rows = rows(contacts, gear.r_base());
    assert!(rows.len() > 8, "{} rows of points press", rows.len());
    let moment = |f: &dyn Fn(f64) -> f64| rows.iter().map(|r| f(r.0) * r.1).sum::<f64>();
    let total = moment(&|_| 1.0);
    let mean = moment(&|x| x) / total;
    let half_width = 2.0 * (moment(&|x| (x - mean).powi(2)) / total).sqrt();
    // p^2 = p_0^2 - c x^2 by least squares within three quarters of the half-width.
    let (mut n, mut x2, mut x4, mut y, mut x2y) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for w in rows.windows(3) {
        let x = ((w[1].0 - mean) / half_width).powi(2);
        let p = w[1].1 / (0.5 * (w[2].0 - w[0].0) * width);
        if x < 0.5625 {
            n += 1.0;
            x2 += x;
            x4 += x * x;
            y += p * p;
            x2y += x * p * p;
        }
    }
    LinePressure {
        half_width,
        peak: ((y * x4 - x2y * x2) / (n * x4 - x2 * x2)).sqrt(),
    }
}

/// Prints the same equilibrium on half-spaces and with graded elements; returns the relative difference of the first
/// from the second in approach, half-width and peak pressure.
fn beside(
    what: &str,
    [found, graded]: [&LoadedContact; 2],
    [lines, elements]: [LinePressure; 2],
) -> [f64; 3] {
    let off = [
        found.approach / graded.approach - 1.0,
        lines.half_width / elements.half_width - 1.0,
        lines.peak / elements.peak - 1.0,
    ];
    println!(
        "{what}: approach {:.3} um, graded {:.3} ({:+.2} %); half-width {:.4} mm, {:.4} ({:+.2} %); peak {:.1} MPa, {:.1} ({:+.2} %)",
        1e6 * found.approach,
        1e6 * graded.approach,
        100.0 * off[0],
        1e3 * lines.half_width,
        1e3 * elements.half_width,
        100.0 * off[1],
        1e-6 * lines.peak,
        1e-6 * elements.peak,
        100.0 * off[2]
    );
    off
}

/// One layer of elements over the width, 8 along the flank, is compared with 96 elements, 14 to 26 over the width of
/// the contact.
#[test]
fn a_tooth_pair_over_its_load() {
    let spec = fzg_c(0.0);
    let mut coarse = on_half_spaces(&spec, 1);
    let (s, width) = (coarse.layout().pitch_point, coarse.layout().face_width);
    for load in [50e3, 200e3, 800e3] {
        let found = coarse.under_force(s, width * load).unwrap();
        let lines = found.pressure.unwrap();
        let fine = ElementFineness {
            s,
            reach: 1.5 * lines.half_width,
            flank: 96,
            layers: 10,
            width: [1, 1],
            penalty: 1e17,
        };
        let mut fine = fine.pair(&spec);
        let graded = fine.under_force(s, width * load).unwrap();
        let elements = pressed(&fine.contacts(), toothing(&spec.gears[0].body), width);
        let what = format!("{:.0} N/mm", load / 1e3);
        let off = beside(&what, [&found, &graded], [lines, elements]);
        assert!(off.iter().all(|x| x.abs() < 0.02), "{off:?}");
    }
}

/// A pair of spur gears without backlash, of few teeth and with profile shift; centre distance from the involute
/// function of the operating pressure angle (ISO 21771).
fn shifted(teeth: [u32; 2], shifts: [f64; 2], module: f64) -> SceneSpec {
    let alpha = 20_f64.to_radians();
    let sum = f64::from(teeth[0] + teeth[1]);
    let operating = inv_inverse(inv(alpha) + 2.0 * alpha.tan() * (shifts[0] + shifts[1]) / sum);
    let distance = 0.5 * sum * module * alpha.cos() / operating.cos();
    let [a, b] = [0, 1].map(|i| GearParams {
        teeth: teeth[i],
        module,
        face_width: 3.0 * module,
        profile_shift: shifts[i],
        thinning: 0.01 * module,
        bore_radius: 0.22 * f64::from(teeth[i]) * module,
        ..Default::default()
    });
    let [a, b] = [gear("a", a, 0.0, 0.0), gear("b", b, distance, 0.0)];
    pair_of(a, b, start(Side::Left, 0.0))
}

/// Rolling statics of pairs of few teeth: transmission error and load shares at eight positions of a cycle, 12 elements
/// along the flank on half-spaces, otherwise the default mesh, beside 256 of equal length whose contact is that of the
/// elements.
#[test]
#[ignore = "four minutes: two gears of 120,000 unknowns each"]
fn rolling_statics_of_few_teeth_and_profile_shift() {
    const POSITIONS: u32 = 8;
    for (teeth, shifts, module) in [([13, 21], [0.4, 0.1], 3e-3), ([17, 45], [0.3, -0.1], 5e-3)] {
        let spec = shifted(teeth, shifts, module);
        let modelling = half_space(12.0, 1.0, 0.0);
        let mut coarse = LoadedPair::new(&spec, &modelling, gearbench::models::models()).unwrap();
        let layout = coarse.layout();
        let (from, pitch) = (layout.pitch_point, layout.base_pitch);
        let width = layout.face_width;
        let fine = ElementFineness {
            s: from,
            reach: f64::INFINITY,
            flank: 256,
            layers: 8,
            width: [1, 1],
            penalty: 1e17,
        };
        let mut fine = fine.pair(&spec);
        for load in [100e3, 300e3] {
            // Of the transmission error and of the share of the pair at the position.
            let mut largest = [0.0_f64; 2];
            for k in 0..POSITIONS {
                let s = from + (f64::from(k) / f64::from(POSITIONS) - 0.5) * pitch;
                let resolved = fine.under_force(s, width * load).unwrap();
                let found = coarse.under_force(s, width * load).unwrap();
                let share = |of: &LoadedContact| of.pair(0) / of.force;
                let off = found.approach / resolved.approach - 1.0;
                let of_share = share(&found) - share(&resolved);
                println!(
                    "    position {k}: approach {:.3} um, resolved {:.3} ({:+.2} %); share {:.3}, {:.3}",
                    1e6 * found.approach,
                    1e6 * resolved.approach,
                    100.0 * off,
                    share(&found),
                    share(&resolved)
                );
                largest = [largest[0].max(off.abs()), largest[1].max(of_share.abs())];
            }
            println!(
                "{teeth:?}, {:.0} N/mm: transmission error within {:.2} %, share within {:.4}",
                load / 1e3,
                100.0 * largest[0],
                largest[1]
            );
            assert!(largest.iter().all(|x| *x < 0.01), "{largest:?}");
        }
    }
}

/// Formats the forces over strips of the width, from one end to the other, in per cent of their sum.
fn over_width(contacts: &[ContactForce], strips: usize, width: f64) -> String {
    let mut parts = vec![0.0; strips];
    let total: f64 = contacts.iter().map(|c| c.normal_force).sum();
    for c in contacts {
        let strip = (c.x.z / width + 0.5) * strips as f64;
        parts[strip as usize] += 100.0 * c.normal_force / total;
    }
    let parts: Vec<String> = parts.iter().map(|x| format!("{x:.2}")).collect();
    parts.join(" ")
}

/// Eight strips are compared with eight layers of elements over the width, with and without crowning.
#[test]
#[ignore = "four minutes: two gears of 100,000 unknowns each, three times"]
fn strips_of_crowned_and_of_straight_teeth() {
    const STRIPS: usize = 8;
    for (crowning, load) in [(0.0, 200e3), (10e-6, 50e3), (10e-6, 200e3)] {
        let mut spec = fzg_c(0.0);
        change(&mut spec.gears[0], |p| {
            p.modifications.lead_crowning = crowning;
        });
        let mut coarse = on_half_spaces(&spec, STRIPS);
        let (s, width) = (coarse.layout().pitch_point, coarse.layout().face_width);
        let found = coarse.under_force(s, width * load).unwrap();
        let of_lines = over_width(&coarse.contacts(), STRIPS, width);
        let lines = found.pressure.unwrap();
        let fine = ElementFineness {
            s,
            reach: 1.5 * lines.half_width,
            flank: 72,
            layers: 6,
            width: [STRIPS; 2],
            penalty: 1e17,
        };
        let mut fine = fine.pair(&spec);
        println!("    {} unknowns", fine.unknowns());
        let graded = fine.under_force(s, width * load).unwrap();
        let contacts = fine.contacts();
        let of_points = over_width(&contacts, STRIPS, width);
        // Of either element in the middle of the width the points next to it, which stand for half of it.
        let strip = width / STRIPS as f64;
        let middle: Vec<ContactForce> = contacts
            .into_iter()
            .filter(|c| c.x.z.abs() < 0.5 * strip)
            .collect();
        let elements = pressed(&middle, toothing(&spec.gears[0].body), strip);
        let what = format!("crowning {:.0} um, {:.0} N/mm", 1e6 * crowning, load / 1e3);
        let off = beside(&what, [&found, &graded], [lines, elements]);
        println!("    strips, per cent of the force: {}", of_lines);
        println!("    graded:                        {}", of_points);
        assert!(
            off[0].abs() < 0.01 && off.iter().all(|x| x.abs() < 0.06),
            "{off:?}"
        );
    }
}

/// One strip on faces so narrow that their free ends are all there is, and on a face that is wider than its mate's: its
/// load lies on all of its width, where the elements bend it in the middle.
#[test]
#[ignore = "three minutes: two gears of 100,000 unknowns each, four times"]
fn free_ends_of_the_width() {
    for (wide, layers) in [
        ([1e-3; 2], [6, 6]),
        ([3e-3; 2], [8, 8]),
        ([14e-3, 18e-3], [7, 9]),
        ([14e-3, 22e-3], [7, 11]),
    ] {
        let mut spec = fzg_c(0.0);
        for (gear, width) in spec.gears.iter_mut().zip(wide) {
            change(gear, |p| p.face_width = width);
        }
        let mut coarse = on_half_spaces(&spec, 1);
        let (s, width) = (coarse.layout().pitch_point, coarse.layout().face_width);
        let load = 200e3;
        let found = coarse.under_force(s, width * load).unwrap();
        let lines = found.pressure.unwrap();
        let fine = ElementFineness {
            s,
            reach: 1.5 * lines.half_width,
            flank: 72,
            layers: 6,
            width: layers,
            // With more the points at the ends of the width come and go.
            penalty: 2e16,
        };
        let mut fine = fine.pair(&spec);
        println!("    {} unknowns", fine.unknowns());
        let graded = fine.under_force(s, width * load).unwrap();
        let contacts = fine.contacts();
        let of_points = over_width(&contacts, layers[0], width);
        let elements = pressed(&contacts, toothing(&spec.gears[0].body), width);
        let what = format!("{:.0} and {:.0} mm wide", 1e3 * wide[0], 1e3 * wide[1]);
        let [off, ..] = beside(&what, [&found, &graded], [lines, elements]);
        println!("    graded, over the width, per cent of the force: {of_points}");
        let wider = wide[1] > 1.5 * wide[0];
        assert!(off.abs() < if wider { 0.03 } else { 0.02 }, "{what}: {off}");
    }
}

/// A single pair up to its tip edge, because the other teeth of its first gear are set back: from far away up to the
/// edge and over it.
#[test]
#[ignore = "a minute"]
fn a_pair_at_its_tip_edge() {
    let mut spec = fzg_c(0.0);
    change(&mut spec.gears[0], |p| {
        let back = |tooth: u32| if tooth == 0 { 0.0 } else { -60e-6 };
        let left = FlankDeviations {
            cumulative_pitch: (0..p.teeth).map(back).collect(),
            ..FlankDeviations::default()
        };
        p.deviations = Deviations::Given(Box::new(GivenDeviations {
            sides: [left, FlankDeviations::default()],
            ..GivenDeviations::default()
        }));
    });
    let gear = toothing(&spec.gears[0].body);
    let (rb, tip) = (gear.r_base(), gear.roll_length_tip());
    let mut coarse = on_half_spaces(&spec, 1);
    let width = coarse.layout().face_width;
    let load = 200e3;
    for part in [8.0, 4.0, 2.0, 1.0, 0.5, 0.0, -0.5, -1.0, -2.0] {
        // The contact runs ahead by half of the approach.
        let half_width = 0.13e-3;
        let s = (tip * tip - 2.0 * rb * part * half_width).sqrt() - 8e-6;
        let found = coarse.under_force(s, width * load).unwrap();
        let fine = ElementFineness {
            s,
            reach: 1.5 * half_width,
            flank: 96,
            layers: 10,
            width: [1, 1],
            penalty: 1e17,
        };
        let mut fine = fine.pair(&spec);
        let graded = fine.under_force(s, width * load).unwrap();
        // Of rows of points, but for the last that press.
        let rows = rows(&fine.contacts(), rb);
        let pressure = rows
            .windows(3)
            .map(|w| w[1].1 / (0.5 * (w[2].0 - w[0].0) * width));
        println!(
            "{part} half-widths from the edge: approach {:.3} um, graded {:.3} ({:+.2} %); peak {:.0} MPa, {:.0}; {} and {} pairs",
            1e6 * found.approach,
            1e6 * graded.approach,
            100.0 * (found.approach / graded.approach - 1.0),
            1e-6 * found.pressure.unwrap().peak,
            1e-6 * pressure.fold(0.0, f64::max),
            found.pairs.len(),
            graded.pairs.len(),
        );
        let off = found.approach / graded.approach - 1.0;
        assert!(
            off.abs() < if part < 0.0 { 0.07 } else { 0.02 },
            "{part}: {off}"
        );
    }
}
