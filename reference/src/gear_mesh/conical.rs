//! Sections of a conical gear over its width: one topology, each section that of the cylindrical gear with the profile shift
//! and the tip radius there, its flanks brought to the helicoids of the gear.
//!
//! A tilted rack cuts left and right flanks on base circles of their own, so that the flanks of the cylindrical gear at the
//! height `z` are nearly those of the conical one. With the half angles `psi'` of its flank and `psi` of the helicoid at one
//! radius a point of the section is turned by `w (psi - psi')`, `w` being 1 on the flank and falling to zero at the
//! centreline, along the fillet, and to the end of the skin, as points follow a modified flank. Fillets are those of the
//! cylindrical gear, followed so. (K. Mitome, *Conical involute gear*, Bulletin of JSME 26, 1983.)

use super::build::Layer;
use super::error::MeshError;
use super::params::{GearMeshParams, Tooth};
use super::profile::Body;
use super::section::{Choices, Common, Section, section};
use gearbench_models::geometry::{Gear, Side};

/// Part of the form radius by which a base circle may lie above it.
const FORM_SLACK: f64 = 1e-6;

/// Refuses sections with undercut on one side: its base circle lies above the form circle.
fn check_undercut(g: &Gear, section: &Gear, height: f64) -> Result<(), MeshError> {
    for side in Side::BOTH {
        let (base, form) = (g.flank(side).base_radius, section.r_form());
        if base > form * (1.0 + FORM_SLACK) {
            return Err(MeshError::Undercut {
                side,
                height,
                base,
                form,
            });
        }
    }
    Ok(())
}

/// The transverse section at a height [m].
pub(super) fn at_height(g: &Gear, height: f64) -> Result<Gear, MeshError> {
    g.transverse_section(height)
        .map_err(|why| MeshError::Section { height, why })
}

/// Returns the section in the middle, which defines the topology, and those in all planes.
pub(super) fn over_width(
    g: &Gear,
    planes: &[f64],
    (params, tooth, layers): (&GearMeshParams, &Tooth, usize),
) -> Result<(Section, Vec<Layer>), MeshError> {
    let all = planes.iter().map(|z| at_height(g, *z));
    let gears = all.collect::<Result<Vec<Gear>, MeshError>>()?;
    for (section, z) in gears.iter().zip(planes) {
        check_undercut(g, section, *z)?;
    }
    let commons: Vec<Common<'_>> = gears
        .iter()
        .map(|g| Common::new(Body::Gear(g), params, layers))
        .collect();
    let middle = &commons[commons.len() / 2];
    let of_each = commons.iter().map(|c| Choices::of(c, tooth));
    let together = of_each.fold(Choices::of(middle, tooth), Choices::and);
    let topology = section(middle, tooth, together);
    let choices = together.with_corner(topology.corner);
    let mut of_planes = Vec::with_capacity(planes.len());
    for ((common, own), &z) in commons.iter().zip(&gears).zip(planes) {
        let Section {
            points, followers, ..
        } = section(common, tooth, choices);
        let mut rolled: Vec<[f64; 2]> = points.iter().map(|&p| common.body.rolled(p)).collect();
        for f in &followers {
            let exact = g.half_angle_of_section(f.flank(), own.r_base().hypot(f.roll), z);
            let off = exact - own.half_angle_at_roll(f.roll);
            rolled[f.point as usize][1] += f.side * f.weight * off;
        }
        of_planes.push(Layer { rolled, followers });
    }
    Ok((topology, of_planes))
}

/// Amount of a modification along the transverse normal [m], and the half angle of the tangent point of that on the base
/// circle [rad], of the flank of tooth 0 at a radius and height [m].
pub(super) fn removed(g: &Gear, side: Side, radius: f64, z: f64) -> (f64, f64) {
    let flank = g.flank(side);
    let base = flank.base_radius;
    let roll = ((radius - base) * (radius + base)).max(0.0).sqrt();
    let tangent_at = g.half_angle_of_section(side, radius, z) - (roll / base).atan();
    let amount = g.flank_deviation_at(side, radius, z) / flank.cos_helix;
    (amount, tangent_at)
}
