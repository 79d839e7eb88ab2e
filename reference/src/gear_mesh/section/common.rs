//! Parts that all teeth of a mesh share, fine and coarse: skin, rim, web and hub.

use crate::gear_mesh::build::refine;
use crate::gear_mesh::error::Part;
use crate::gear_mesh::grading::{geometric, ratio_from_first};
use crate::gear_mesh::params::{Focus, GearMeshParams};
use crate::gear_mesh::profile::{Body, Plane, Root};

/// Data that all teeth of a mesh share, fine and coarse.
pub(in crate::gear_mesh) struct Common<'a> {
    pub body: Body<'a>,
    pub(super) root: Root<'a>,
    /// 2 when elements have mid-side nodes, else 1.
    pub(super) refine: usize,
    pub(super) layers: usize,
    pub(super) skin_growth: f64,
    pub(super) flank_grading: f64,
    pub(super) flank_focus: Option<Focus>,
    /// Thickness of the skin in the middle of the tooth space [m].
    pub(super) root_skin: f64,
    /// Unrolled depth of the rim, and of the whole body [m].
    pub(super) rim_depth: f64,
    pub(super) depth: f64,
    /// Levels from the skin to the bore: zone (rim, web, hub) and the part of it passed.
    pub(super) levels: Vec<(Part, f64)>,
    /// Unrolled heights at which the zones end.
    zone_ends: [f64; 3],
}

/// Part of the tooth's half thickness that the skin takes.
pub(super) fn skin_part(layers: usize, growth: f64, across: usize) -> f64 {
    let skin: f64 = (0..layers).map(|i| growth.powi(i as i32)).sum();
    let core = growth.powi(layers as i32) * 0.5 * (across - 2 * layers) as f64;
    skin / (skin + core)
}

impl<'a> Common<'a> {
    pub(in crate::gear_mesh) fn new(body: Body<'a>, p: &GearMeshParams, layers: usize) -> Self {
        let (refine, skin_growth) = (refine(p.kind), p.skin_growth);
        let depth = body.depth();
        let rim_depth = p
            .web
            .map_or(depth, |w| -body.unrolled_radius(w.outer_radius));
        let form = body.flank(0.0).0[0];
        let part = skin_part(layers, skin_growth, p.tooth.across);
        let root_skin = (0.7 * part * form).min(0.35 * rim_depth);
        let last = {
            let g = geometric(layers, skin_growth, 1);
            root_skin * (1.0 - g[layers - 1])
        };
        let growth = p.rim_growth.unwrap_or_else(|| {
            ratio_from_first(p.rim, 1.3 * last, rim_depth - root_skin, (1.0 / 1.5, 2.5))
        });
        let zone = |part: Part, fractions: Vec<f64>| fractions.into_iter().map(move |f| (part, f));
        let mut levels: Vec<_> = zone(Part::Rim, geometric(p.rim, growth, refine)).collect();
        let mut zone_ends = [-depth; 3];
        if let Some(w) = p.web {
            zone_ends[0] = -rim_depth;
            zone_ends[1] = body.unrolled_radius(w.inner_radius);
            levels.extend(zone(Part::Web, geometric(w.layers, 1.0, refine)).skip(1));
            levels.extend(zone(Part::Hub, geometric(w.hub_layers, 1.0, refine)).skip(1));
        }
        Common {
            body,
            root: Root::new(body),
            refine,
            layers,
            skin_growth,
            flank_grading: p.flank_grading,
            flank_focus: p.flank_focus,
            root_skin,
            rim_depth,
            depth,
            levels,
            zone_ends,
        }
    }

    /// Elements from the skin to the bore.
    pub(in crate::gear_mesh) fn level_count(&self) -> usize {
        (self.levels.len() - 1) / self.refine
    }

    /// The level `d` of a column that begins at `top` and arrives at the bore at `foot`.
    pub(super) fn in_column(&self, top: Plane, foot: f64, d: usize) -> Plane {
        if d == 0 {
            return top;
        }
        let (part, f) = self.levels[d];
        let (from, to) = match part {
            Part::Web => (self.zone_ends[0], self.zone_ends[1]),
            Part::Hub => (self.zone_ends[1], self.zone_ends[2]),
            _ => (top[1], self.zone_ends[0]),
        };
        let v = if f == 1.0 { to } else { from + (to - from) * f };
        let passed = (top[1] - v) / (top[1] + self.depth);
        [top[0] + (foot - top[0]) * passed, v]
    }
}
