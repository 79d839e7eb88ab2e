//! Toothed bodies as surfaces, for figures: the outlines of sections across the axis, joined over the face width.
//!
//! A section at the height `z` is the transverse outline turned by the helix, `z tan(beta)/r` (a rack: moved by
//! `-z tan(beta)`). Flanks of conical gears are their involute helicoids, the fillets those of the cylindrical gear with the
//! profile shift of the section. Modifications and deviations, some micrometres, are left out.

use super::{Gear, Rack, Side};
use crate::Vec3;

/// Kinds of cells, numbered as in VTK's file formats, with the node orders of these.
pub mod cell {
    /// Cell of a flat polygon.
    pub const POLYGON: u8 = 7;
    /// Cell of four nodes in a ring.
    pub const QUADRILATERAL: u8 = 9;
}

/// Cells of a mesh over nodes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Cells {
    /// Kind of each cell, see [`cell`].
    pub kinds: Vec<u8>,
    /// End of the nodes of each cell in [`Cells::nodes`].
    pub ends: Vec<u32>,
    /// Nodes of the cells, one after the other.
    pub nodes: Vec<u32>,
}

impl Cells {
    /// Adds a cell.
    pub fn push(&mut self, kind: u8, nodes: impl IntoIterator<Item = u32>) {
        self.nodes.extend(nodes);
        self.ends.push(self.nodes.len() as u32);
        self.kinds.push(kind);
    }
}

/// Surface of a toothed body in its own frame.
#[derive(Clone, Debug, Default)]
pub struct SweptSurface {
    /// Positions of the nodes [m].
    pub nodes: Vec<Vec3>,
    /// Tooth of each node, and its share in a motion of that tooth alone: 1 on the flanks, falling to 0 on the root.
    pub teeth: Vec<(i64, f64)>,
    /// Faces of the surface.
    pub cells: Cells,
}

/// Number of points along an arc of the bore per pitch.
const ON_BORE: usize = 4;
/// Largest rotation of the helix between two sections [rad].
const TURN: f64 = 0.02;

/// Returns the share of a point between the root and the end of the flank in the motion of a tooth.
fn share(from_root: f64, flank: f64) -> f64 {
    (from_root / flank.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0)
}

/// Returns the number of layers that resolve a helix.
fn layers(turn: f64) -> usize {
    ((turn.abs() / TURN).ceil() as usize).clamp(1, 32)
}

/// One pitch of a toothed body in sections across its axis, from which all teeth follow by rotation (rack: by shift).
#[derive(Clone, Debug)]
pub struct PitchSections {
    /// Heights of the sections along the axis, ascending [m].
    pub heights: Vec<f64>,
    /// Outline of tooth 0 in each section, from the middle of one tooth space to that of the next, with as many points
    /// in all sections [m].
    pub outlines: Vec<Vec<[f64; 2]>>,
}

impl PitchSections {
    /// Returns the sections of a gear with a number of points per flank. A spur gear has two, at the ends of its face.
    #[must_use]
    pub fn gear(gear: &Gear, points: usize) -> PitchSections {
        let sections = GearSections::of(gear, points);
        let heights: Vec<f64> = (0..sections.number).map(|s| sections.height(s)).collect();
        let in_plane = |p: Vec3| [p.x, p.y];
        let outlines = heights.iter().map(|&z| {
            let (outline, of) = sections.section(z);
            let places = outline.iter().map(|p| sections.place(&of, *p, 0.0, z));
            places.map(in_plane).collect()
        });
        PitchSections {
            outlines: outlines.collect(),
            heights,
        }
    }

    /// Returns the sections of a rack, as [`Self::gear`].
    #[must_use]
    pub fn rack(rack: &Rack, points: usize) -> PitchSections {
        let (slope, heights) = rack_heights(rack);
        let outline = rack.tooth_outline(points);
        let shifted = |z: &f64| outline.iter().map(|[x, y]| [*x, y + slope * z]).collect();
        PitchSections {
            outlines: heights.iter().map(shifted).collect(),
            heights,
        }
    }
}

/// Returns the shift of a rack's section by height [-], and the heights that resolve its helix [m].
fn rack_heights(rack: &Rack) -> (f64, Vec<f64>) {
    let width = rack.face_width();
    let slope = -rack.params().helix_angle.tan();
    let last = layers(slope * width / rack.pitch());
    let height = |section: usize| width * (section as f64 / last as f64 - 0.5);
    (slope, (0..=last).map(height).collect())
}

/// Sections of a gear across its axis.
struct GearSections<'a> {
    gear: &'a Gear,
    points: usize,
    middle: Vec<[f64; 2]>,
    number: usize,
    /// Rotation by height of the helix [rad/m].
    per_height: f64,
}

impl<'a> GearSections<'a> {
    fn of(gear: &'a Gear, points: usize) -> Self {
        let per_height = gear.params().helix_angle.tan() / gear.r_reference();
        GearSections {
            gear,
            points,
            middle: gear.tooth_outline(points),
            number: layers(per_height * gear.face_width()) + 1,
            per_height,
        }
    }

    fn height(&self, section: usize) -> f64 {
        self.gear.face_width() * (section as f64 / (self.number - 1) as f64 - 0.5)
    }

    /// Returns the transverse outline at a height, and the cylindrical gear of that section.
    fn section(&self, z: f64) -> (Vec<[f64; 2]>, Gear) {
        // Sections of a cone have the same points, but where a tool leaves no arc between the fillets.
        let of_section = self.gear.at_height(z);
        let own = of_section.map(|g| (g.tooth_outline(self.points), g));
        own.filter(|(outline, _)| outline.len() == self.middle.len())
            .unwrap_or_else(|| (self.middle.clone(), self.gear.clone()))
    }

    /// Returns the place of a point of a section's outline on a tooth that is rotated by `turn`.
    fn place(&self, of: &Gear, [x, y]: [f64; 2], turn: f64, z: f64) -> Vec3 {
        let gear = self.gear;
        let r = x.hypot(y);
        let side = if y >= 0.0 { Side::Left } else { Side::Right };
        if gear.is_conical() && r >= of.r_form() && r < of.r_tip() {
            let flank = gear.flank(side);
            let roll = (r * r - flank.base_radius.powi(2)).max(0.0).sqrt();
            flank.point(&flank.base(turn, roll, z), roll, z)
        } else {
            turned(x, y, z, turn + self.per_height * z)
        }
    }
}

impl SweptSurface {
    /// Builds a gear with a number of points per flank and an open bore.
    pub fn gear(gear: &Gear, points: usize) -> SweptSurface {
        let of_gear = GearSections::of(gear, points);
        let (sections, per_height) = (of_gear.number, of_gear.per_height);
        let height = |section: usize| of_gear.height(section);
        let teeth = gear.teeth() as usize;
        let per_tooth = of_gear.middle.len() - 1;
        let mut swept = SweptSurface::default();
        for section in 0..sections {
            let z = height(section);
            let (outline, of) = of_gear.section(z);
            for tooth in 0..teeth {
                let turn = tooth as f64 * gear.pitch_angle();
                for &point in &outline[..per_tooth] {
                    let r = f64::hypot(point[0], point[1]);
                    let own = share(r - of.r_root(), of.r_form() - of.r_root());
                    swept.nodes.push(of_gear.place(&of, point, turn, z));
                    swept.teeth.push((tooth as i64, own));
                }
            }
        }
        swept.sides(sections, teeth * per_tooth);
        let bore = gear.params().bore_radius;
        let ring = teeth * per_tooth;
        let ends = [0, (sections - 1) * ring];
        if bore <= 0.0 {
            let all = |first: usize| (first..first + ring).map(|n| n as u32);
            swept.cells.push(cell::POLYGON, all(ends[0]).rev());
            swept.cells.push(cell::POLYGON, all(ends[1]));
            return swept;
        }
        let inner = swept.nodes.len();
        let on_bore = teeth * ON_BORE;
        for section in 0..sections {
            let z = height(section);
            for k in 0..on_bore {
                let angle = gear.pitch_angle() * (k as f64 / ON_BORE as f64 - 0.5);
                let place = turned(bore, 0.0, z, angle + per_height * z);
                swept.nodes.push(place);
                swept.teeth.push(((k / ON_BORE) as i64, 0.0));
            }
        }
        let at = |section: usize, k: usize| (inner + section * on_bore + k % on_bore) as u32;
        for section in 1..sections {
            let before = section - 1;
            for k in 0..on_bore {
                let around = [
                    at(before, k),
                    at(section, k),
                    at(section, k + 1),
                    at(before, k + 1),
                ];
                swept.cells.push(cell::QUADRILATERAL, around);
            }
        }
        // The face of an end, a polygon for each pitch.
        for (end, first) in ends.into_iter().enumerate() {
            for tooth in 0..teeth {
                let outer =
                    (0..=per_tooth).map(|i| (first + (tooth * per_tooth + i) % ring) as u32);
                let section = end * (sections - 1);
                let back = (0..=ON_BORE)
                    .rev()
                    .map(|k| at(section, tooth * ON_BORE + k));
                let face: Vec<u32> = outer.chain(back).collect();
                if end == 0 {
                    swept.cells.push(cell::POLYGON, face.into_iter().rev());
                } else {
                    swept.cells.push(cell::POLYGON, face);
                }
            }
        }
        swept
    }

    /// Builds a rack with a number of points per flank.
    pub fn rack(rack: &Rack, points: usize) -> SweptSurface {
        let (slope, heights) = rack_heights(rack);
        let sections = heights.len();
        let outline = rack.outline(points);
        let mut swept = SweptSurface::default();
        for z in heights {
            for [x, y] in &outline {
                swept.nodes.push(Vec3::new(*x, y + slope * z, z));
                let own = share(rack.root_depth() - x, rack.root_depth() - rack.form_depth());
                swept.teeth.push(((y / rack.pitch()).round() as i64, own));
            }
        }
        let ring = outline.len();
        swept.sides(sections, ring);
        let all = |first: usize| (first..first + ring).map(|n| n as u32);
        swept.cells.push(cell::POLYGON, all(0).rev());
        swept.cells.push(cell::POLYGON, all((sections - 1) * ring));
        swept
    }

    /// Adds the faces between sections with rings of a number of nodes.
    fn sides(&mut self, sections: usize, ring: usize) {
        let at = |section: usize, k: usize| (section * ring + k % ring) as u32;
        for section in 0..sections - 1 {
            for k in 0..ring {
                let face = [
                    at(section, k),
                    at(section, k + 1),
                    at(section + 1, k + 1),
                    at(section + 1, k),
                ];
                self.cells.push(cell::QUADRILATERAL, face);
            }
        }
    }
}

fn turned(x: f64, y: f64, z: f64, angle: f64) -> Vec3 {
    let (sin, cos) = angle.sin_cos();
    Vec3::new(cos * x - sin * y, sin * x + cos * y, z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{GearParams, RackParams};
    use std::collections::HashMap;

    /// Checks that the surface is closed (every edge occurs once in each direction) and returns its volume by the
    /// divergence theorem, with faces as fans about their means.
    fn volume(swept: &SweptSurface) -> f64 {
        let mut edges: HashMap<(u32, u32), i32> = HashMap::new();
        let (mut sum, mut begin) = (0.0, 0);
        for &end in &swept.cells.ends {
            let face = &swept.cells.nodes[begin..end as usize];
            begin = end as usize;
            let at = |n: u32| swept.nodes[n as usize];
            let mean: Vec3 = face.iter().map(|n| at(*n)).sum::<Vec3>() / face.len() as f64;
            for (i, &a) in face.iter().enumerate() {
                let b = face[(i + 1) % face.len()];
                *edges.entry((a, b)).or_default() += 1;
                *edges.entry((b, a)).or_default() -= 1;
                sum += at(a).cross(&at(b)).dot(&mean) / 6.0;
            }
        }
        assert!(edges.values().all(|n| *n == 0), "the surface is open");
        sum
    }

    #[test]
    fn surfaces_are_closed_and_hold_the_volume_of_the_body() {
        let base = GearParams {
            teeth: 20,
            module: 4e-3,
            face_width: 0.03,
            bore_radius: 0.02,
            ..GearParams::default()
        };
        let conical = GearParams {
            profile_shift_angle: 0.05,
            tip_cone_angle: 0.05,
            profile_shift: 0.3,
            helix_angle: 0.1,
            ..base.clone()
        };
        let helical = GearParams {
            helix_angle: 0.4,
            ..base.clone()
        };
        let solid = GearParams {
            bore_radius: 0.0,
            ..helical.clone()
        };
        // Points per flank of 60 leave 1e-5 (outlines), chords of the bore, 4 per pitch, 3e-4; the tip of a cone differs by
        // the square of its angle.
        for (params, bound) in [
            (base, 6e-4),
            (helical, 6e-4),
            (solid, 2e-4),
            (conical, 2e-3),
        ] {
            let gear = Gear::new(params).unwrap();
            let found = volume(&SweptSurface::gear(&gear, 60));
            let expected = gear.mass_properties(1.0).mass;
            assert!(
                (found / expected - 1.0).abs() < bound,
                "{found:e} {expected:e}"
            );
        }
        let rack = Rack::new(RackParams {
            teeth: 5,
            module: 4e-3,
            helix_angle: 0.3,
            face_width: 0.03,
            ..RackParams::default()
        })
        .unwrap();
        let found = volume(&SweptSurface::rack(&rack, 200));
        assert!((found / rack.mass(1.0) - 1.0).abs() < 1e-4, "{found:e}");
    }
}
