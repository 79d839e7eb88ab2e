//! Elastic gears in contact on half-spaces: statics that do not depend on the mesh, running under load.

use super::*;
use gearbench::context::Context;
use gearbench::scene_file::{Origin, SceneFile};
use gearbench_models::spec::{FlankContact, Mount, PointContact};

mod potential;

/// Returns elastic gears with a number of elements along a flank and over the width, with modes, on half-spaces.
pub(super) fn half_space(elements: f64, layers: f64, modes: f64) -> Modelling {
    let parameters = [
        ("modes", modes),
        ("flank_elements", elements),
        ("width_elements", layers),
    ];
    let elastic = model_of("elastic", parameters);
    let contact = ContactSpec {
        slices: Some(layers as usize),
        flanks: FlankContact::HalfSpace,
        ..contact(1.4e10)
    };
    Modelling {
        gears: vec![elastic.clone(), elastic],
        contacts: vec![contact],
    }
}

pub(super) fn built(spec: &SceneSpec, modelling: &Modelling) -> Scene {
    Scene::build(spec, modelling, gearbench::models::models()).unwrap()
}

/// Returns the gears of the tables: their transmission error is that of one pair and of two in alternation.
fn tabled() -> [(&'static str, SceneSpec); 2] {
    [("FZG C", fzg_c(0.0)), ("S30", s30(0.0))]
}

fn cycle(spec: &SceneSpec, modelling: &Modelling, per_width: f64, positions: usize) -> MeshCycle {
    let models = gearbench::models::models();
    let mut pair = LoadedPair::new(spec, modelling, models).unwrap();
    let load = StaticLoad::Force(pair.layout().face_width * per_width);
    MeshCycle::solve(&mut pair, load, positions, |_| {}).unwrap()
}

/// Static transmission error from coarse meshes and fine ones.
#[test]
fn static_transmission_error_does_not_depend_on_the_mesh() {
    for ((name, spec), most) in tabled().into_iter().zip([2e-3, 3e-3]) {
        let of = |elements, load| cycle(&spec, &half_space(elements, 1.0, 0.0), load, 120);
        for load in [50e3, 200e3, 800e3] {
            let fine = of(24.0, load);
            for elements in [8.0, 12.0] {
                let coarse = of(elements, load);
                let mean = coarse.mean_error() / fine.mean_error() - 1.0;
                let peak = coarse.peak_to_peak() / fine.peak_to_peak() - 1.0;
                println!(
                    "{name}, {:.0} N/mm, {elements} elements: mean {:.4} um ({mean:.1e}), peak to peak {:.4} um ({peak:.1e})",
                    load / 1e3,
                    1e6 * coarse.mean_error(),
                    1e6 * coarse.peak_to_peak()
                );
                assert!(
                    mean.abs() < most && peak.abs() < 5e-3,
                    "{name}: {mean:.2e} {peak:.2e}"
                );
            }
        }
    }
}

/// A single pair stiffens with its load: the line contact of Hertz adds `-A q ln b`, with `b` proportional to the root
/// of the load.
#[test]
fn a_pair_stiffens_with_its_load_as_hertz_has_it() {
    let spec = fzg_c(0.0);
    let [light, heavy] = [50e3, 800e3].map(|q| {
        let at = cycle(&spec, &half_space(8.0, 1.0, 0.0), q, 2).positions[1].clone();
        assert_eq!(at.pairs.iter().filter(|p| p.force > 0.0).count(), 1);
        at.approach / q
    });
    let material = &spec.gears[0].material;
    let hertz = 4.0 * (1.0 - material.poisson.powi(2)) / (std::f64::consts::PI * material.young)
        * 4.0_f64.ln();
    println!(
        "secant compliance falls by {:.3e} m^2/N, Hertz {hertz:.3e}",
        light - heavy
    );
    assert!(((light - heavy) / hertz - 1.0).abs() < 0.05);
}

/// Returns the peak-to-peak residual of a polynomial of degree four in the transmission error where one pair carries
/// the load [m]; `None` where that is so at too few positions for a fit.
fn ripple(cycle: &MeshCycle) -> Option<f64> {
    let single = cycle.positions.iter().filter(|p| p.pairs.len() == 1);
    let (s, mut left): (Vec<f64>, Vec<f64>) = single.map(|p| (p.s, p.approach)).unzip();
    if s.len() < 15 {
        return None;
    }
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    for degree in 0..5 {
        let place = |s: &f64| ((s - cycle.pitch_point) / cycle.base_pitch).powi(degree);
        let mut next: Vec<f64> = s.iter().map(place).collect();
        for b in &basis {
            let part = dot(b, &next);
            next.iter_mut().zip(b).for_each(|(x, b)| *x -= part * b);
        }
        let norm = dot(&next, &next).sqrt();
        next.iter_mut().for_each(|x| *x /= norm);
        let part = dot(&next, &left);
        left.iter_mut().zip(&next).for_each(|(x, b)| *x -= part * b);
        basis.push(next);
    }
    Some(range(left.into_iter()))
}

/// Returns the largest less the smallest value.
fn range(values: impl Iterator<Item = f64>) -> f64 {
    let [low, high] = values.fold([f64::MAX, f64::MIN], |[low, high], x| {
        [low.min(x), high.max(x)]
    });
    high - low
}

/// The tables of the book's page on elastic gears: half-spaces and elements in contact, over meshes and loads. The effect of
/// passing elements has two measures: the ripple where one pair carries the load, and over the whole cycle the variation of
/// the difference from the finest mesh.
#[test]
#[ignore = "a minute: meshes of up to 48 elements along a flank"]
fn transmission_error_over_meshes() {
    for (name, spec) in tabled() {
        for load in [50e3, 200e3, 800e3] {
            for on_half_spaces in [true, false] {
                let cycles = [8.0, 12.0, 24.0, 48.0].map(|elements| {
                    let mut modelling = half_space(elements, 1.0, 0.0);
                    if !on_half_spaces {
                        modelling.contacts[0].flanks =
                            FlankContact::Points(PointContact::new(1e17));
                    }
                    (elements, cycle(&spec, &modelling, load, 100))
                });
                let fine = &cycles[3].1;
                let what = ["elements in contact", "half-spaces"][usize::from(on_half_spaces)];
                for (elements, c) in &cycles {
                    let mean = c.mean_error();
                    let positions = c.positions.iter().zip(&fine.positions);
                    let varies = range(positions.map(|(p, fine)| p.approach - fine.approach));
                    let ripple = ripple(c);
                    println!(
                        "{name}, {:.0} N/mm, {what}, {elements} elements: mean {:.4} um (from 48 by {:.2e}), peak to peak {:.4} um (from 48 by {:.2e}), \
                         ripple {} um, difference from 48 varies by {:.4} um",
                        load / 1e3,
                        1e6 * mean,
                        (mean / fine.mean_error() - 1.0).abs(),
                        1e6 * c.peak_to_peak(),
                        (c.peak_to_peak() / fine.peak_to_peak() - 1.0).abs(),
                        ripple.map_or("-".into(), |r| format!("{:.4}", 1e6 * r)),
                        1e6 * varies
                    );
                    if on_half_spaces {
                        let peak = c.peak_to_peak() / fine.peak_to_peak() - 1.0;
                        assert!((mean / fine.mean_error() - 1.0).abs() < 0.01);
                        assert!(peak.abs() < 0.02, "{peak}");
                        assert!(ripple.unwrap_or(0.0) < 3e-3 * mean && varies < 0.015 * mean);
                    }
                }
            }
        }
    }
}

/// Half-width and pressure where one pair carries the load: Hertz's for the radii of the involutes at the path coordinate
/// in the middle of both flanks.
#[test]
fn lines_have_the_pressure_of_hertz() {
    let spec = fzg_c(0.0);
    let layout = mesh_layout(&spec.gears[0], &spec.gears[1]).unwrap();
    let material = &spec.gears[0].material;
    let modulus = material.young / (2.0 * (1.0 - material.poisson.powi(2)));
    for load in [50e3, 800e3] {
        let at = &cycle(&spec, &half_space(8.0, 1.0, 0.0), load, 2).positions[1];
        let found = at.pressure.unwrap();
        // Both flanks run ahead by half of the approach.
        let rho = [at.s, layout.length - at.s].map(|s| s + 0.5 * at.approach);
        let radius = rho[0] * rho[1] / (rho[0] + rho[1]);
        let half_width = (4.0 * radius * load / (std::f64::consts::PI * modulus)).sqrt();
        let peak = (load * modulus / (std::f64::consts::PI * radius)).sqrt();
        println!(
            "{:.0} N/mm: half-width {:.4} mm, off Hertz by {:.1e}, pressure {:.1} MPa, off by {:.1e}",
            load / 1e3,
            1e3 * found.half_width,
            (found.half_width / half_width - 1.0).abs(),
            1e-6 * found.peak,
            (found.peak / peak - 1.0).abs()
        );
        assert!((found.half_width / half_width - 1.0).abs() < 1e-3);
        assert!((found.peak / peak - 1.0).abs() < 1e-3);
    }
}

/// Undamped gears under load keep their energy, with one strip and with three; with a wheel that is driven, whose drive is
/// given the power of the lines where tip edges touch off the line of action too.
#[test]
fn half_spaces_keep_the_energy_under_load() {
    for (layers, driven) in [(1.0, false), (3.0, false), (1.0, true)] {
        let mut spec = fzg(400.0, 94.1);
        if driven {
            let wheel = &mut spec.gears[1];
            wheel.mount = Mount::Driven(Profile::Constant(-400.0 / 1.5));
            wheel.loads.clear();
        }
        let modelling = half_space(8.0, layers, 60.0);
        let mut scene = built(&spec, &modelling);
        let found = [1e-6, 0.5e-6, 0.25e-6].map(|h| {
            let step = Resolution::Step(h);
            let (_, ledger, watch) = observe(&spec, &mut scene, "trigonometric", step, 0.01, 0.0);
            ledger.residual().abs() / watch.power
        });
        println!("{layers} strips, driven {driven}: {found:?}");
        assert!(found[0] < 1e-3 && found[2] < 1e-4, "{found:?}");
    }
}

/// On a rack, whose teeth count from a negative index on, each pair that the exact flanks close carries its part: on
/// half-spaces as with the elements.
#[test]
fn every_pair_on_a_rack_carries() {
    const GEARS: &str = r#"
schema = 1
name = "rack"
duration_s = 1e-4

[gears.pinion]
teeth = 20
module_m = 2e-3
face_width_m = 1e-2
bore_radius_m = 8e-3

[gears.rack]
kind = "rack"
teeth = 5
module_m = 2e-3
face_width_m = 1e-2
mount = "fixed"

[[meshes]]
gears = ["pinion", "rack"]
backlash_m = 6e-5
start = { flank = "left", gap_m = 0.0, path_coordinate_m = 8.954e-3 }
"#;
    let pairs = |contact: &str| -> Vec<[i64; 2]> {
        let text = format!(
            "{GEARS}\n[[models]]\nmodel = \"elastic\"\nparameters = {{ modes = 0, flank_elements = 6, \
             width_elements = 1, rim_elements = 2 }}\ncontact = {{ {contact} }}\n"
        );
        let file = SceneFile::unbuilt(
            &Context::default(),
            "rack.toml",
            &text,
            Origin::Shipped,
            false,
        )
        .unwrap();
        let mut scene = built(&file.spec, &file.models[0].modelling);
        let mut state = scene.initial();
        state.q[0] += 3e-4;
        let forces = scene.contact_forces(state.at());
        let mut pairs: Vec<[i64; 2]> = (forces.iter())
            .filter(|f| f.normal_force > 0.0)
            .map(|f| f.teeth.map(|t| t.index))
            .collect();
        pairs.sort_unstable();
        pairs.dedup();
        pairs
    };
    let on_lines = pairs("local = \"half-space\"");
    assert_eq!(on_lines.len(), 2, "{on_lines:?}");
    assert_eq!(on_lines, pairs("penalty_pa_per_m = 2e15"));
}
