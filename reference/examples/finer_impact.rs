//! Writes the impact of case A again, on meshes of its own that resolve the contact: tooth 1 of both gears fine, with
//! elements that are short about the pitch point and thin under the flank, and a penalty that gives next to nothing.
//!
//!     cargo run --release -p gearbench-reference --example finer_impact -- OUT.inp [FLANK]
//!
//! FLANK elements stand along each fine flank, 64 if it is left out. `reference/calculix/own_deck.sh OUT.inp` runs CalculiX
//! on the result.

use gearbench_models::geometry::{Gear, GearParams};
use gearbench_reference::deck;
use gearbench_reference::gear_deck::{self, ImpactGear};
use gearbench_reference::gear_mesh::{self, FineTeeth, Focus, GearMeshParams, Tooth};
use gearbench_reference::mesh::ElementKind;
use gearbench_reference::reference;
use gearbench_reference::stored::ImpactParameters;
use std::io::{BufWriter, Write};

/// Layers of the skin, and elements across the tooth.
const LAYERS: usize = 8;
const ACROSS: usize = 20;
/// Elements are of equal length about so far from the pitch point [m]: half as far again as the contact reaches at its
/// greatest force.
const REACH: f64 = 0.27e-3;
/// [Pa/m]: a hundredth of the approach.
const PENALTY: f64 = 1e16;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (out, flank) = match arguments.as_slice() {
        [out] => (out, 64),
        [out, flank] => (out, flank.parse()?),
        _ => return Err("usage: finer_impact OUT.inp [FLANK]".into()),
    };
    let stored = reference("calculix/case-a-fine")?;
    let read = deck::read_bytes("calculix/case-a-fine", stored.deck)?;
    let gears = gear_deck::gears(&read)?;
    let mut impact = gear_deck::Impact::of(&read, &gears)?;
    let p = &stored.parameters;
    let length =
        p.gears.iter().map(|g| g.base_radius).sum::<f64>() * p.working_pressure_angle.tan();
    let roll = [p.path_coordinate, length - p.path_coordinate];
    let meshes = [meshed(p, 0, roll[0], flank)?, meshed(p, 1, roll[1], flank)?];
    let [one, two] = &impact.gears;
    impact.gears = [
        ImpactGear {
            mesh: &meshes[0],
            ..*one
        },
        ImpactGear {
            mesh: &meshes[1],
            ..*two
        },
    ];
    impact.pairs = vec![[0, 0]];
    impact.penalty = PENALTY;
    // 18 us after the gears have parted.
    impact.end = 1.2e-4;
    let mut file = BufWriter::new(std::fs::File::create(out)?);
    gear_deck::write_impact(&mut file, &impact)?;
    file.flush()?;
    Ok(())
}

/// A gear of the reference that touches at the length of roll `roll` [m] on tooth 1.
fn meshed(
    p: &ImpactParameters,
    i: usize,
    roll: f64,
    flank: usize,
) -> Result<gear_mesh::GearMesh, Box<dyn std::error::Error>> {
    let gear = Gear::new(GearParams {
        teeth: p.gears[i].teeth,
        module: p.module,
        pressure_angle: p.pressure_angle,
        profile_shift: p.gears[i].profile_shift,
        face_width: p.face_width,
        addendum: p.addendum,
        dedendum: p.dedendum,
        tip_radius: p.tip_radius,
        bore_radius: p.gears[i].bore_radius,
        ..Default::default()
    })?;
    let (form, tip) = (gear.roll_length_form(), gear.roll_length_tip());
    let arc = (tip * tip - form * form) / (2.0 * gear.r_base());
    let params = GearMeshParams {
        kind: ElementKind::C3D8,
        tooth: Tooth {
            flank,
            fillet: 8,
            root: 2,
            across: ACROSS,
        },
        layers: LAYERS,
        rim: 6,
        width: 1,
        flank_focus: Some(Focus {
            place: (roll * roll - form * form) / (tip * tip - form * form),
            reach: REACH / arc,
        }),
        fine_teeth: Some(FineTeeth {
            teeth: vec![0],
            others: Tooth {
                // With fewer the gears were lighter by their chords.
                flank: 5,
                fillet: 2,
                across: 2 * LAYERS + 1,
                ..Tooth::coarse()
            },
        }),
        ..Default::default()
    };
    Ok(gear_mesh::gear(&gear, &params)?)
}
