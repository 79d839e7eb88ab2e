//! The surface of the left half of a tooth, and the rows of the skin under it.

use super::common::{Common, skin_part};
use crate::gear_mesh::grading::{focused, geometric, refined};
use crate::gear_mesh::params::Tooth;
use crate::gear_mesh::profile::Plane;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// Topological choices from the shape of the root. Sections over the width of a conical gear share them, so that their
/// elements match.
#[derive(Clone, Copy, Debug)]
pub(in crate::gear_mesh) struct Choices {
    /// The fillet is next to none: the row into the edge halves its angle.
    sharp: bool,
    /// Fillet and root arc have elements of their own.
    apart: bool,
    /// Row that ends in the corner of the core; `None` determines it.
    corner: Option<usize>,
}

impl Choices {
    /// Returns the choices of one section.
    pub(in crate::gear_mesh) fn of(common: &Common<'_>, tooth: &Tooth) -> Self {
        let root = &common.root;
        let sf = root.fillet_length() / tooth.fillet as f64;
        let sa = root.arc_length() / tooth.root as f64;
        // A sharp tool leaves no fillet on a rack, and next to none on large gears: then the row into the edge
        // halves its angle and ends in the corner of the core.
        let sharp = sf < 0.05 * sa;
        Choices {
            sharp,
            apart: sa >= 0.35 * sf && !sharp,
            corner: None,
        }
    }

    /// Returns choices that suit this section and another.
    #[must_use]
    pub(in crate::gear_mesh) fn and(self, other: Self) -> Self {
        Choices {
            sharp: self.sharp || other.sharp,
            apart: self.apart && other.apart,
            ..self
        }
    }

    /// Returns the choices with a row that ends in the corner of the core.
    #[must_use]
    pub(in crate::gear_mesh) fn with_corner(self, row: usize) -> Self {
        Choices {
            corner: Some(row),
            ..self
        }
    }
}

/// The surface of the left half: nodes, rows of the skin, ends of the rows.
pub(super) struct Surface {
    /// Where a row starts, from the tip to the middle of the space.
    pub(super) start: Vec<Plane>,
    /// Where it ends, inside.
    pub(super) end: Vec<Plane>,
    /// Dip of the row [rad].
    pub(super) dip: Vec<f64>,
    /// Length of roll that a row belongs to [m] and how far it follows a modified flank.
    pub(super) follows: Vec<(f64, f64)>,
    /// Rows on the flank, and down to the corner of the core.
    pub(super) flank: usize,
    pub(super) corner: usize,
}

impl Surface {
    pub(super) fn new(common: &Common<'_>, tooth: &Tooth, choices: Choices) -> Self {
        let f = common.refine;
        let root = &common.root;
        let part = skin_part(common.layers, common.skin_growth, tooth.across);
        let (mut start, mut dip, mut follows) = (Vec::new(), Vec::new(), Vec::new());
        // From the form circle up, then turned: the surface is followed from the tip down.
        let places = match (common.flank_focus, tooth.flank) {
            (Some(focus), n) => focused(n, focus.place, focus.reach, f),
            (None, 1) => geometric(1, 1.0, f),
            (None, n) => geometric(n, common.flank_grading.powf(1.0 / (n - 1) as f64), f),
        };
        for &t in places.iter().rev() {
            let (p, s) = common.body.flank(t);
            start.push(p);
            dip.push(0.0);
            follows.push((s, 1.0));
        }
        let flank = start.len() - 1;
        let roll_form = follows[flank].0;

        // Even steps over the fillet and over the arc, or over both where one is too short for its own.
        let (lf, la) = (root.fillet_length(), root.arc_length());
        let (nf, na) = (tooth.fillet, tooth.root);
        let (sf, sa) = (lf / nf as f64, la / na as f64);
        let sharp = choices.sharp;
        let mut ends = vec![0.0];
        if choices.apart {
            ends.extend((1..=nf).map(|i| sf * i as f64));
            ends.extend((1..=na).map(|i| lf + sa * i as f64));
        } else {
            ends.extend((1..=nf + na).map(|i| (lf + la) * i as f64 / (nf + na) as f64));
        }
        let lengths = refined(&ends, f);
        let first = if sharp { 0.0 } else { root.dip(0.0).min(1.2) };
        if sharp {
            dip[flank] = FRAC_PI_4;
        }
        for &length in &lengths[1..] {
            let natural = root.dip(length);
            start.push(root.at(length));
            let turned = ((natural - first) / (FRAC_PI_2 - first)).clamp(0.0, 1.0);
            dip.push(FRAC_PI_2 * turned);
            follows.push((roll_form, (1.0 - length / root.total()).powi(2)));
        }
        // In the middle of the tooth space the row starts at the root.
        let last = start.len() - 1;
        dip[last] = FRAC_PI_2;

        let form = start[flank][0];
        let mut end: Vec<Plane> = (0..=last)
            .map(|j| {
                let thickness = if j <= flank {
                    part * start[j][0]
                } else {
                    let p = lengths[j - flank] / root.total();
                    let smooth = p * p * (3.0 - 2.0 * p);
                    part * form + (common.root_skin - part * form) * smooth
                };
                let (sin, cos) = if j == last {
                    (1.0, 0.0)
                } else {
                    dip[j].sin_cos()
                };
                // A thin rim leaves no more room.
                let room = start[j][1] + 0.5 * common.rim_depth;
                let thickness = thickness.min(room / sin.max(1e-3));
                [start[j][0] - thickness * cos, start[j][1] - thickness * sin]
            })
            .collect();
        // Inside, edges are straight: only the surface is curved.
        for j in (1..last).step_by(2).filter(|_| f == 2) {
            end[j] = [0, 1].map(|k| 0.5 * (end[j - 1][k] + end[j + 1][k]));
            dip[j] = 0.5 * (dip[j - 1] + dip[j + 1]);
        }
        // Corner of the core: a whole element from the form circle and from the middle of the space.
        let nearest = || {
            (usize::from(!sharp)..nf + na)
                .map(|k| flank + k * f)
                .min_by(|&a, &b| {
                    let away = |j: usize| (dip[j] - FRAC_PI_4).abs();
                    away(a).total_cmp(&away(b))
                })
                .unwrap_or(flank + f)
        };
        let corner = choices.corner.unwrap_or_else(nearest);
        Surface {
            start,
            end,
            dip,
            follows,
            flank,
            corner,
        }
    }
}
