//! Writes the impact of two helical gears, aligned or with the axis of the wheel inclined.
//!
//!     cargo run --release -p gearbench-reference --example helical_impact -- OUT.inp [TILT_MRAD]
//!
//! The gears mesh as in the spur cases: gear 1 at the origin turns into gear 2 at (a, 0, 0), left flanks, tooth 1 of both at
//! the pitch point in the middle of the width. TILT_MRAD (0 if it is left out) turns gear 2 about its centre by the vector
//!
//! ```text
//! theta = TILT (-cos(alpha_wt), sin(alpha_wt), 0)
//! ```
//!
//! which lies in the transverse plane, square to the line of action (sin(alpha_wt), cos(alpha_wt), 0): flanks open by
//! TILT z, and close all over by TILT times the length of roll of gear 2 and tan(beta_b), for they shift along the axis.
//! `reference/calculix/own_deck.sh OUT.inp` runs CalculiX on the result.

use gearbench_models::Vec3;
use gearbench_models::geometry::{Gear, GearParams, Side};
use gearbench_models::stiffness::Material;
use gearbench_reference::gear_deck::{self, BodyShape, Hub, Impact, ImpactGear};
use gearbench_reference::gear_mesh::{self, FineTeeth, GearMeshParams, Tooth};
use gearbench_reference::mesh::ElementKind;
use std::f64::consts::PI;
use std::io::{BufWriter, Write};

/// Normal module [m], helix angle of gear 1 [deg], face width [m].
const MODULE: f64 = 4e-3;
const HELIX_DEG: f64 = 15.0;
const WIDTH: f64 = 12e-3;
/// Distance of the axes [m]: 0.1 mm more than without backlash.
const CENTRE_DISTANCE: f64 = 0.10363;
/// Of gear 1 at the start [rad/s].
const SPEED: f64 = 20.0;
/// Gap of the exact involutes along the line of action, without the tilt [m].
const GAP: f64 = 6e-6;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (out, tilt) = match arguments.as_slice() {
        [out] => (out, 0.0),
        [out, tilt] => (out, 1e-3 * tilt.parse::<f64>()?),
        _ => return Err("usage: helical_impact OUT.inp [TILT_MRAD]".into()),
    };
    let gears = [
        gear(20, 0.015, HELIX_DEG.to_radians())?,
        gear(30, 0.025, -HELIX_DEG.to_radians())?,
    ];
    let meshes = [
        meshed(&gears[0], vec![19, 0, 1])?,
        meshed(&gears[1], vec![29, 0, 1])?,
    ];
    let base = gears.each_ref().map(Gear::r_base);
    let working = ((base[0] + base[1]) / CENTRE_DISTANCE).acos();
    let length = (base[0] + base[1]) * working.tan();
    let pitch_point = base[0] * working.tan();
    // Tooth 1 where its left flank has the length of roll of the pitch point, less the gap on gear 2.
    let phase = |i: usize, roll: f64| {
        let g = &gears[i];
        roll / base[i] - working - g.half_angle_base()
    };
    let phases = [
        phase(0, pitch_point),
        phase(1, length - pitch_point - GAP) + PI,
    ];
    let square = Vec3::new(-working.cos(), working.sin(), 0.0);
    let axis = match tilt {
        0.0 => Vec3::z(),
        tilt => tilt.cos() * Vec3::z() + tilt.sin() * square.cross(&Vec3::z()),
    };
    let placed = |i: usize, centre: Vec3, axis: Vec3, speed: f64| ImpactGear {
        mesh: &meshes[i],
        material: Material::STEEL,
        shape: BodyShape::Gear,
        axis,
        centre,
        phase: phases[i],
        hub: Hub::Free { speed },
    };
    let impact = Impact {
        title: format!(
            "helical pair impact, wheel turned by {tilt:e} ({:.12}, {:.12}, 0) rad, SI units",
            square.x, square.y
        ),
        gears: [
            placed(0, Vec3::zeros(), Vec3::z(), SPEED),
            placed(1, CENTRE_DISTANCE * Vec3::x(), axis, 0.0),
        ],
        side: Side::Left,
        pairs: vec![[19, 1], [0, 0], [1, 29]],
        penalty: 1e15,
        step: 5e-7,
        end: 1.5e-4,
        alpha: -0.05,
    };
    let mut file = BufWriter::new(std::fs::File::create(out)?);
    gear_deck::write_impact(&mut file, &impact)?;
    file.flush()?;
    Ok(())
}

fn gear(
    teeth: u32,
    bore_radius: f64,
    helix_angle: f64,
) -> Result<Gear, Box<dyn std::error::Error>> {
    Ok(Gear::new(GearParams {
        teeth,
        module: MODULE,
        face_width: WIDTH,
        helix_angle,
        tip_radius: 0.3,
        bore_radius,
        ..Default::default()
    })?)
}

/// Three teeth fine, the others just mass and the stiffness of their roots.
fn meshed(gear: &Gear, fine: Vec<u32>) -> Result<gear_mesh::GearMesh, Box<dyn std::error::Error>> {
    let params = GearMeshParams {
        kind: ElementKind::C3D8,
        tooth: Tooth {
            flank: 10,
            fillet: 2,
            root: 1,
            across: 4,
        },
        layers: 1,
        rim: 3,
        width: 6,
        fine_teeth: Some(FineTeeth {
            teeth: fine,
            others: Tooth::coarse(),
        }),
        ..Default::default()
    };
    Ok(gear_mesh::gear(gear, &params)?)
}
