//! The transverse section of one tooth pitch as quadrilaterals, in the unrolled plane of `profile`.
//!
//! ```text
//!          tip
//!        +--+--+          S: skin under flank, fillet and root    C: core of the tooth
//!        |S|C|S|          R: rim down to the bore
//!        |S|C|S|          At o five elements meet, inside the body: all elements
//!       /S/ C \S\         at the surface stand square on it.
//!  ----+ o-----o +----
//!   SSSS/   R   \SSSS
//!  ----+---------+----
//!      |    R    |
//! ```
//!
//! A row of the skin starts at a node of the surface and runs inwards: along the circle at the flank, turning
//! over the fillet until it stands on the root. The row nearest to 45 degrees ends in the corner of the core.
//! The left half is computed, the right half is its mirror image to the last bit.

mod common;
mod surface;

pub(super) use common::Common;
pub(super) use surface::Choices;

use super::error::Part;
use super::grading::geometric;
use super::params::Tooth;
use super::profile::Plane;
use gearbench_models::geometry::Side;
use surface::Surface;

/// A quadrilateral: corners counter-clockwise, then mid-side nodes (if the elements have them).
#[derive(Clone, Copy, Debug)]
pub(super) struct Quad {
    pub nodes: [u32; 8],
    pub part: Part,
}

/// A flank in the section.
#[derive(Clone, Debug, Default)]
pub(super) struct FlankLine {
    /// Points from root to tip, mid-side nodes included.
    pub points: Vec<u32>,
    /// Quadrilaterals under the flank from root to tip and the face of their elements that lies on it.
    pub faces: Vec<(u32, u8)>,
}

/// How a point follows a modified flank.
#[derive(Clone, Copy, Debug)]
pub(super) struct Follower {
    pub point: u32,
    /// +1 left, -1 right.
    pub side: f64,
    /// Length of roll of the flank point it follows [m].
    pub roll: f64,
    /// Part of the shift, 1 on the flank.
    pub weight: f64,
}

impl Follower {
    /// The flank it follows.
    pub fn flank(&self) -> Side {
        if self.side > 0.0 {
            Side::Left
        } else {
            Side::Right
        }
    }
}

/// One tooth pitch of the section.
#[derive(Default)]
pub(super) struct Section {
    pub points: Vec<Plane>,
    /// True for each point that is a mid-side node.
    pub mid: Vec<bool>,
    pub quads: Vec<Quad>,
    /// So many points lie on each cut, from the root to the bore: the first and the last of all points.
    pub cut: usize,
    pub bore: Vec<u32>,
    /// Left and right flank.
    pub flanks: [FlankLine; 2],
    pub followers: Vec<Follower>,
    /// Row that ends in the corner of the core.
    pub corner: usize,
}

/// Nodes of a block, row by row; missing ones (centres of quadratic faces) are `u32::MAX`.
struct Block {
    columns: usize,
    ids: Vec<u32>,
}

impl Block {
    fn new(rows: usize, columns: usize) -> Self {
        Block {
            columns: columns + 1,
            ids: vec![u32::MAX; (rows + 1) * (columns + 1)],
        }
    }

    fn at(&self, row: usize, column: usize) -> u32 {
        self.ids[row * self.columns + column]
    }

    fn set(&mut self, row: usize, column: usize, id: u32) {
        self.ids[row * self.columns + column] = id;
    }

    /// The quadrilateral whose first corner is (row, column); `flip` turns its sense.
    fn quad(&self, row: usize, column: usize, refine: usize, flip: bool, part: Part) -> Quad {
        let (h, s) = (refine / 2, refine);
        let at = |i, j| self.at(row + i, column + j);
        let corners = [at(0, 0), at(s, 0), at(s, s), at(0, s)];
        let mids = match refine {
            1 => [u32::MAX; 4],
            _ => [at(h, 0), at(s, h), at(h, s), at(0, h)],
        };
        let [a, b, c, d] = corners;
        let [ab, bc, cd, da] = mids;
        let nodes = if flip {
            [a, d, c, b, da, cd, bc, ab]
        } else {
            [a, b, c, d, ab, bc, cd, da]
        };
        Quad { nodes, part }
    }
}

/// Meshes one tooth pitch.
pub(super) fn section(common: &Common<'_>, tooth: &Tooth, choices: Choices) -> Section {
    let f = common.refine;
    let surface = Surface::new(common, tooth, choices);
    let rows = surface.start.len() - 1;
    let (layers, corner) = (f * common.layers, surface.corner);
    let core_columns = f * (tooth.across - 2 * common.layers);
    let low = rows - corner;
    let rim_columns = core_columns + 2 * low;
    let levels = common.levels.len() - 1;
    let skin = geometric(common.layers, common.skin_growth, f);
    let exists = |a: usize, b: usize| f == 1 || a & b & 1 == 0;
    let is_mid = |a: usize, b: usize| f == 2 && (a | b) & 1 == 1;

    let skin_point = |side: f64, j: usize, l: usize| -> Plane {
        let (a, b) = (surface.start[j], surface.end[j]);
        let t = skin[l];
        [side * (a[0] + (b[0] - a[0]) * t), a[1] + (b[1] - a[1]) * t]
    };
    let core_point = |j: usize, c: usize| -> Plane {
        let [u, v] = surface.end[j];
        let t = (2.0 * c as f64 - core_columns as f64) / core_columns as f64;
        let sag = (0.5 * u * (0.35 * surface.dip[j]).tan()).min(0.15 * common.rim_depth);
        [t * u, v - sag * (1.0 - t * t)]
    };
    let rim_top = |m: usize| -> (Plane, Option<(usize, usize)>) {
        if m <= low {
            let j = rows - m;
            (skin_point(-1.0, j, layers), Some((1, j)))
        } else if m < low + core_columns {
            (core_point(corner, m - low), None)
        } else {
            let j = corner + (m - low - core_columns);
            (skin_point(1.0, j, layers), Some((0, j)))
        }
    };
    // Columns gather evenly at the bore as far as they need not lean too much.
    let at_bore = |m: usize| {
        let t = (2.0 * m as f64 - rim_columns as f64) / rim_columns as f64;
        t * common.body.half_pitch()
    };
    let most = (0..=rim_columns)
        .map(|m| (at_bore(m) - rim_top(m).0[0]).abs())
        .fold(0.0, f64::max);
    let slender = common.depth / (2.0 * common.body.half_pitch());
    let even = slender.min(0.2 * common.depth / most.max(1e-300)).min(0.9);
    let foot = |m: usize, top: f64| {
        if m == 0 || m == rim_columns {
            top
        } else {
            top + (at_bore(m) - top) * even
        }
    };

    let mut s = Section {
        corner,
        ..Section::default()
    };
    let mut skins = [Block::new(rows, layers), Block::new(rows, layers)];
    let mut core = Block::new(corner, core_columns);
    let mut rim = Block::new(rim_columns, levels);
    let signs = [1.0, -1.0];

    let add = |s: &mut Section, p: Plane, mid: bool| {
        s.points.push(p);
        s.mid.push(mid);
        (s.points.len() - 1) as u32
    };
    // One cut first, the other last; between them from the right over the tooth to the left, so that
    // neighbours have near numbers.
    let cut_skin = |s: &mut Section, skins: &mut [Block; 2], side: usize| {
        for l in 0..=layers {
            let id = add(s, skin_point(signs[side], rows, l), is_mid(rows, l));
            skins[side].set(rows, l, id);
        }
    };
    let column = |s: &mut Section, rim: &mut Block, m: usize, top: Plane| {
        for d in 1..=levels {
            if exists(m, d) {
                let p = common.in_column(top, foot(m, top[0]), d);
                rim.set(m, d, add(s, p, is_mid(m, d)));
            }
        }
    };
    cut_skin(&mut s, &mut skins, 1);
    column(&mut s, &mut rim, 0, skin_point(-1.0, rows, layers));
    s.cut = s.points.len();
    for side in [1, 0] {
        for step in 0..rows {
            let j = if side == 1 { rows - 1 - step } else { step };
            for l in 0..=layers {
                if exists(j, l) {
                    let id = add(&mut s, skin_point(signs[side], j, l), is_mid(j, l));
                    skins[side].set(j, l, id);
                }
            }
        }
        if side == 1 {
            for j in 0..=corner {
                for c in 1..core_columns {
                    if exists(j, c) {
                        let id = add(&mut s, core_point(j, c), is_mid(j, c));
                        core.set(j, c, id);
                    }
                }
            }
        }
    }
    for j in 0..=corner {
        core.set(j, 0, skins[1].at(j, layers));
        core.set(j, core_columns, skins[0].at(j, layers));
    }
    for m in 1..rim_columns {
        column(&mut s, &mut rim, m, rim_top(m).0);
    }
    let before = s.points.len();
    cut_skin(&mut s, &mut skins, 0);
    column(&mut s, &mut rim, rim_columns, rim_top(rim_columns).0);
    debug_assert_eq!(s.points.len() - before, s.cut);
    for m in 0..=rim_columns {
        let id = match rim_top(m).1 {
            Some((side, j)) => skins[side].at(j, layers),
            None => core.at(corner, m - low),
        };
        rim.set(m, 0, id);
    }

    quads(&mut s, &surface, &skins, &core, &rim, common);
    s.bore = (0..=rim_columns).map(|m| rim.at(m, levels)).collect();
    follow(&mut s, &surface, &skins, &core);
    s
}

/// Elements of the blocks, from the right over the tooth to the left as the nodes; flanks on the way.
fn quads(
    s: &mut Section,
    surface: &Surface,
    skins: &[Block; 2],
    core: &Block,
    rim: &Block,
    common: &Common<'_>,
) {
    let f = common.refine;
    let rows = surface.start.len() - 1;
    let layers = f * common.layers;
    for side in [1, 0] {
        for step in (0..rows).step_by(f) {
            let j = if side == 1 { rows - f - step } else { step };
            let part = if j < surface.flank {
                Part::Flank
            } else {
                Part::Fillet
            };
            for l in (0..layers).step_by(f) {
                if l == 0 && j < surface.flank {
                    let face = if side == 1 { 5 } else { 2 };
                    s.flanks[side].faces.push((s.quads.len() as u32, face));
                }
                s.quads.push(skins[side].quad(j, l, f, side == 1, part));
            }
        }
        s.flanks[side].points = (0..=surface.flank)
            .rev()
            .map(|j| skins[side].at(j, 0))
            .collect();
        if side == 1 {
            for j in (0..surface.corner).step_by(f) {
                for c in (0..core.columns - 1).step_by(f) {
                    s.quads.push(core.quad(j, c, f, true, Part::Core));
                }
            }
        }
    }
    // The left flank was passed from the tip down.
    s.flanks[0].faces.reverse();
    let columns = rim.ids.len() / rim.columns - 1;
    for m in (0..columns).step_by(f) {
        for d in (0..rim.columns - 1).step_by(f) {
            let part = common.levels[d + f].0;
            s.quads.push(rim.quad(m, d, f, false, part));
        }
    }
}

/// Which points follow a modified flank, and how far: all of the row on the flank, the fillet less and less.
fn follow(s: &mut Section, surface: &Surface, skins: &[Block; 2], core: &Block) {
    let mut add = |id: u32, side: f64, j: usize, along: f64| {
        let (roll, row) = surface.follows[j];
        let weight = row * along;
        if id != u32::MAX && weight > 0.0 {
            s.followers.push(Follower {
                point: id,
                side,
                roll,
                weight,
            });
        }
    };
    let layers = skins[0].columns - 1;
    for j in 0..surface.start.len() {
        // Across a tooth down to its centreline, under the fillet down to the end of the skin.
        let inner = if j <= surface.corner {
            surface.end[j][0] / surface.start[j][0]
        } else {
            0.0
        };
        for (side, sign) in [(0, 1.0), (1, -1.0)] {
            for l in 0..=layers {
                let t = l as f64 / layers as f64;
                add(skins[side].at(j, l), sign, j, 1.0 + (inner - 1.0) * t);
            }
        }
        if j <= surface.corner {
            let columns = core.columns - 1;
            for c in 1..columns {
                let t = (2.0 * c as f64 - columns as f64) / columns as f64;
                add(core.at(j, c), t.signum(), j, inner * t.abs());
            }
        }
    }
}
