//! Text of a sampled scene as a scene file, which can be viewed and run like any other.
//!
//! The finite elements define a scene: mesh, penalty and damping of the models `elastic`, `densest` and `fe` are the
//! same. Rigid gears and movable teeth are added as a user would specify them without further knowledge, with the
//! stiffness of the norm.

use super::distributions::{Kind, Load, Parameters, Second};
use super::random::short;
use super::toothing::DENSITY;
use std::fmt::Write as _;

/// Teeth of fitted impacts: contact stiffness and tooth stiffness per face width [N/m per m], tooth mass over
/// `density width module^2` (calibration `impact` of the scene `spur_impact`).
const CONTACT_PER_WIDTH: f64 = 2.68e10;
const TOOTH_PER_WIDTH: f64 = 7.8e10;
const TOOTH_MASS: f64 = 4.2;
/// Numbers of elements of all gears: along a flank, over the width, from root to bore.
const ELEMENTS: &str = "flank_elements = 8, width_elements = 1, rim_elements = 3";
/// Setting that leaves gyroscopic terms out: gears rotate at a few per cent of their lowest frequency at most, and
/// modal integration needs uncoupled modes.
const SPIN: &str = "spin_terms = \"none\"";
/// Number of modes and step [s] of the densest elastic model.
const DENSEST: (usize, f64) = (300, 2.5e-7);
/// Number of steps of full finite elements over the duration of an impact.
const FULL_STEPS: f64 = 500.0;

/// Writes the scene with a duration [s]; `path` is the path coordinate of the first tooth pair [m].
pub fn scene(p: &Parameters, path: Option<f64>, duration: f64) -> String {
    let mut out = String::new();
    // Writing to a string cannot fail.
    let _ = write(&mut out, p, path, duration);
    out
}

fn write(
    out: &mut String,
    p: &Parameters,
    path: Option<f64>,
    duration: f64,
) -> Result<(), std::fmt::Error> {
    let t = &p.toothing;
    writeln!(
        out,
        "# A random scene: {} of the set \"{}\" (`gearbench-validation sample {}:{}`).\n\
         schema = 1\nname = \"{}-{}\"",
        p.number, p.set, p.set, p.number, p.set, p.number
    )?;
    let mate = if t.rack {
        format!("on a rack of {} teeth", t.teeth[1])
    } else {
        format!("and {}", t.teeth[1])
    };
    writeln!(
        out,
        "title = \"{}: {} teeth {mate}, m = {} mm\"",
        match p.kind {
            Kind::Impact => "One impact",
            Kind::Hammer => "Hammering in the backlash",
            Kind::Load => "Running under load",
        },
        t.teeth[0],
        short(1e3 * t.module),
    )?;
    writeln!(out, "duration_s = {:e}", short(duration))?;
    writeln!(
        out,
        "tolerance = {{ metric = \"{}\", limit = {}, against = \"model\" }}",
        p.metric, p.tolerance
    )?;
    gear(out, p, 0)?;
    gear(out, p, 1)?;
    let path = path.map_or(String::new(), |s| {
        format!(", path_coordinate_m = {:e}", short(s))
    });
    writeln!(
        out,
        "\n[[meshes]]\ngears = [\"first\", \"second\"]\nbacklash_m = {:e}\n\
         start = {{ flank = \"left\", gap_m = {:e}{path} }}",
        p.backlash, p.gap
    )?;
    models(out, p)?;
    writeln!(
        out,
        "\n[study]\nmodels = [\"rigid\", \"movable-teeth\", \"elastic\", \"densest\"]\n\
         reference_model = \"densest\"\nintegrators = [{{ method = \"dopri5\", rtol = 1e-7 }}]\n\
         quantities = [\"{}\"]",
        p.metric
    )
}

fn gear(out: &mut String, p: &Parameters, i: usize) -> std::fmt::Result {
    let t = &p.toothing;
    let rack = t.rack && i == 1;
    writeln!(out, "\n[gears.{}]", ["first", "second"][i])?;
    if rack {
        writeln!(out, "kind = \"rack\"")?;
    }
    writeln!(
        out,
        "teeth = {}\nmodule_m = {:e}\nface_width_m = {:e}",
        t.teeth[i], t.module, t.width
    )?;
    if !rack {
        if t.shift[i] != 0.0 {
            writeln!(out, "profile_shift = {}", t.shift[i])?;
        }
        writeln!(out, "bore_radius_m = {:e}", t.bore[i])?;
    }
    let (inertia, speed, load) = if rack {
        ("added_mass_kg", "speed_m_s", "force_n")
    } else {
        ("added_inertia_kgm2", "speed_rad_s", "torque_nm")
    };
    if p.added[i] > 0.0 {
        writeln!(out, "{inertia} = {:e}", p.added[i])?;
    }
    match (i, p.second) {
        (1, Second::Fixed) => return writeln!(out, "mount = \"fixed\""),
        (1, Second::Driven) => {
            return writeln!(
                out,
                "mount = {{ driven = {{ {speed} = {:e} }} }}",
                p.speed[1]
            );
        }
        _ => {}
    }
    if p.speed[i] != 0.0 {
        writeln!(out, "{speed} = {:e}", p.speed[i])?;
    }
    match p.load[i] {
        Load::None => Ok(()),
        Load::Constant(x) => writeln!(out, "loads = [{{ {load} = {x:e} }}]"),
        Load::Ramp(x, end) => writeln!(
            out,
            "loads = [{{ ramp = {{ from_nm = 0.0, to_nm = {x:e}, start_s = 0.0, end_s = {end:e} }} }}]"
        ),
        Load::Viscous(c) => writeln!(out, "loads = [{{ viscous_nms_per_rad = {c:e} }}]"),
    }
}

fn models(out: &mut String, p: &Parameters) -> std::fmt::Result {
    let t = &p.toothing;
    let damping = if p.rigid_ratio > 0.0 {
        format!(
            ", damping = {{ law = \"kelvin-voigt-ratio\", ratio = {:e} }}",
            p.rigid_ratio
        )
    } else {
        String::new()
    };
    writeln!(
        out,
        "\n[[models]]\nmodel = \"rigid\"\ncontact = {{ stiffness = \"iso6336\"{damping} }}"
    )?;
    let tooth = TOOTH_PER_WIDTH * t.width;
    let mass = TOOTH_MASS * DENSITY * t.width * t.module * t.module;
    let damper = 2.0 * p.modal_ratio * (tooth * mass).sqrt();
    writeln!(
        out,
        "\n[[models]]\nmodel = \"movable-teeth\"\n\
         contact = {{ stiffness = {{ kind = \"constant\", stiffness_n_per_m2 = {CONTACT_PER_WIDTH:e} }}{damping} }}\n\
         parameters = {{ tooth_stiffness_n_per_m = {:e}, tooth_mass_kg = {:e}, tooth_damping_ns_per_m = {:e} }}",
        short(tooth),
        short(mass),
        short(damper)
    )?;
    let contact = if p.dashpot > 0.0 {
        format!(
            "contact = {{ penalty_pa_per_m = {:e}, damping_ns_per_m3 = {:e} }}",
            p.penalty, p.dashpot
        )
    } else {
        format!("contact = {{ penalty_pa_per_m = {:e} }}", p.penalty)
    };
    let modal = if p.modal_ratio > 0.0 {
        format!(", damping_ratio = {:e}", p.modal_ratio)
    } else {
        String::new()
    };
    writeln!(
        out,
        "\n[[models]]\nmodel = \"elastic\"\nparameters = {{ {ELEMENTS}, modes = 100, {SPIN}{modal} }}\n{contact}\n\
         integrators = [{{ method = \"trigonometric\", step_s = 1e-6 }}]"
    )?;
    let (modes, step) = DENSEST;
    writeln!(
        out,
        "\n[[models]]\nlabel = \"densest\"\nmodel = \"elastic\"\n\
         parameters = {{ {ELEMENTS}, modes = {modes}, step_s = {step:e}, {SPIN}{modal} }}\n{contact}\n\
         integrators = [{{ method = \"trigonometric\", step_s = {step:e} }}]"
    )?;
    // Full finite elements have no modal damping, and cost seconds for an impact.
    if p.kind == Kind::Impact {
        writeln!(
            out,
            "\n[[models]]\nmodel = \"fe\"\nparameters = {{ {ELEMENTS} }}\n{contact}\n\
             integrators = [{{ method = \"newmark\", step_s = {:e} }}]",
            short(p.contact_time / FULL_STEPS)
        )?;
    }
    Ok(())
}
