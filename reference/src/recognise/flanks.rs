//! Which faces are flanks: those whose corners lie on the involute that most of them share.
//!
//! First the involute is fitted to the faces within [`CORE`] of the tooth height, then to all on it, down to the
//! fillet and up to the tip. Where the user specifies the radii of the flanks, only faces between these count, and
//! more material may be missing there than by typical reliefs.

use super::axis::{Axis, Cylinder};
use super::involute::{FlankPoint, Involute};
use super::skin::Skin;
use super::teeth::{self, Polar, Teeth, wrapped};
use super::{ACROSS, CORE, FINE, Patch, RELIEF, RecognisedGear, extent, median};
use crate::vector::snapped;
use gearbench_models::geometry::Side;
use std::collections::HashSet;

/// Tolerance of missing flank within the radii given by the user, relative to the tooth height.
const WIDE: f64 = 0.1;

/// Nodes nearer than this part of the tooth's height to a given radius are within it.
const EDGE: f64 = 1e-4;

/// The involute and the corner nodes that lie on it.
pub(super) struct Flanks {
    fit: Involute,
    /// Side of each face of the shell that is inclined to the circle.
    sides: Vec<(u32, Side)>,
    /// Node and flank of the members of the flanks.
    members: HashSet<(u32, u32, Side)>,
}

impl Flanks {
    pub(super) fn found(
        skin: &Skin<'_>,
        axis: &Axis,
        polar: &Polar,
        shell: &[u32],
        teeth: &Teeth,
        given: Option<[f64; 2]>,
    ) -> Option<Self> {
        let [low, high] =
            extent((skin.nodes_of(shell, false).iter()).map(|&n| polar[n as usize][0]));
        let height = high - low;
        let mut sides = Vec::new();
        let mut guesses = [Vec::new(), Vec::new()];
        let mut core = [Vec::new(), Vec::new()];
        for &f in shell {
            let [out, round, along] = teeth::turned_normal(skin, axis, f as usize);
            if round.abs() < ACROSS {
                continue;
            }
            let side = if round > 0.0 { Side::Left } else { Side::Right };
            sides.push((f, side));
            let Some(tooth) = teeth.of_face[f as usize] else {
                continue;
            };
            let corners = skin.facets[f as usize].corners();
            let radius = corners.iter().map(|&n| polar[n as usize][0]).sum::<f64>();
            let radius = radius / corners.len() as f64;
            if radius > low + CORE[0] * height {
                guesses[0].push(radius * round.abs() / round.hypot(out));
                guesses[1].push(-along / (radius * round));
            }
            for &n in corners {
                let part = (polar[n as usize][0] - low) / height;
                let point = point(polar, n, tooth, side);
                if part >= CORE[0] {
                    core[1].push((n, point));
                    if part <= CORE[1] {
                        core[0].push((n, point));
                    }
                }
            }
        }
        let [base, twist] = guesses.map(median);
        let mut start = Involute::guess(teeth.count, base?, twist?);
        start.phase = teeth.first;
        let [inner, wide] = core.map(|mut points| {
            points.sort_by_key(|(n, p)| (*n, p.tooth, p.side));
            points.dedup_by_key(|(n, p)| (*n, p.tooth, p.side));
            points.into_iter().map(|p| p.1).collect::<Vec<FlankPoint>>()
        });
        let [a, b] = extent(inner.iter().map(|p| p.radius));
        let enough = b - a > 0.1 * height;
        let fine = FINE * height;
        let mut fit = start.fitted_to_most(if enough { &inner } else { &wide }, fine)?;
        // Sides of teeth that are no involutes are refused, not fitted.
        if fit.residual[0] > 0.01 * height || fit.base_radius > high {
            return None;
        }
        let edge = EDGE * height;
        let beyond = |r: f64| given.is_some_and(|[a, b]| !(a - edge..=b + edge).contains(&r));
        // Then all that lies on it, down to the fillet and up to the tip.
        let mut members = HashSet::new();
        for _ in 0..6 {
            let near = (8.0 * fit.residual[0]).max(fine);
            let mut found = HashSet::new();
            let mut points = Vec::new();
            for &(f, side) in &sides {
                for &n in skin.facets[f as usize].corners() {
                    let place = polar[n as usize];
                    if place[0] < fit.base_radius * (1.0 - 1e-9) || beyond(place[0]) {
                        continue;
                    }
                    let p = point(polar, n, nearest(&fit, place, side), side);
                    let off = fit.distance(&p);
                    let on = off.abs() <= near;
                    // What a relief takes away lies within the tooth.
                    let relieved = off < 0.0
                        && match given {
                            Some(_) => -off < WIDE * height,
                            None => place[0] > low + CORE[1] * height && -off < RELIEF * height,
                        };
                    if !(on || relieved) {
                        continue;
                    }
                    if found.insert((n, p.tooth, side)) && on {
                        points.push(p);
                    }
                }
            }
            let same = found == members;
            members = found;
            fit = fit.fitted(&points)?;
            if same {
                break;
            }
        }
        Some(Flanks {
            fit,
            sides,
            members,
        })
    }

    /// The gear with its flanks in order.
    pub(super) fn told(
        self,
        skin: &Skin<'_>,
        mut axis: Axis,
        polar: &Polar,
        shell: &[u32],
        bore: Cylinder,
        bore_nodes: Vec<u32>,
    ) -> RecognisedGear {
        let Flanks {
            mut fit,
            sides,
            members,
        } = self;
        // The tooth next to the first direction across the axis is number 0.
        let pitch = fit.pitch_angle();
        let own = |place: [f64; 3]| wrapped(place[1] - fit.twist * place[2]);
        let shift = (-fit.phase / pitch).round();
        let zero = (shift as i64).rem_euclid(i64::from(fit.teeth)) as u32;
        let renumbered = |tooth: u32| (tooth + fit.teeth - zero) % fit.teeth;
        let mut patches = Patch::of_teeth(fit.teeth);
        for &(f, side) in &sides {
            let corners = skin.facets[f as usize].corners();
            let tooth = nearest(&fit, polar[corners[0] as usize], side);
            if corners.iter().all(|&n| members.contains(&(n, tooth, side))) {
                let place = 2 * renumbered(tooth) as usize + usize::from(side == Side::Right);
                patches[place].faces.push(f);
            }
        }
        patches.retain(|p| !p.faces.is_empty());
        let all: Vec<u32> = patches
            .iter()
            .flat_map(|p| p.faces.iter().copied())
            .collect();
        let on = skin.nodes_of(&all, false);
        let active = extent(on.iter().map(|&n| polar[n as usize][0]));
        let [back, front] = extent(on.iter().map(|&n| polar[n as usize][2]));

        let nodes = skin.nodes_of(shell, false);
        let spaces = |lowest: bool| {
            let mut best: Vec<Option<u32>> = vec![None; fit.teeth as usize];
            for &n in &nodes {
                let place = polar[n as usize];
                // Teeth about their centres, spaces between them.
                let turns = (own(place) - fit.phase) / pitch + if lowest { 0.0 } else { 0.5 };
                let k = (turns.floor() as i64).rem_euclid(i64::from(fit.teeth)) as usize;
                let better = |m: u32| (polar[m as usize][0] < place[0]) != lowest;
                if best[k].is_none_or(better) {
                    best[k] = Some(n);
                }
            }
            best.into_iter().flatten().collect::<Vec<u32>>()
        };
        let highest = spaces(false);
        let tops = highest.iter().map(|&n| polar[n as usize][0]);
        let top = median(tops).unwrap_or(active[1]);
        let within = 1e-4 * (top - active[0]);
        let tip = nodes.iter().copied();
        let tip = tip.filter(|&n| (polar[n as usize][0] - top).abs() < within);
        let tip = axis.cylinder(skin.nodes, tip.collect());
        let root = axis.cylinder(skin.nodes, spaces(true));

        let middle = 0.5 * (back + front);
        fit.phase += shift * pitch + fit.twist * middle;
        fit.phase = snapped(wrapped(fit.phase), 1.0);
        axis.point += middle * axis.direction;
        let size = active[1];
        axis.point = axis.point.map(|x| snapped(x, size));
        RecognisedGear {
            axis,
            fit,
            tip,
            root,
            bore,
            bore_nodes,
            active,
            width: front - back,
            flanks: patches,
        }
    }
}

fn point(polar: &Polar, node: u32, tooth: u32, side: Side) -> FlankPoint {
    let [radius, angle, height] = polar[node as usize];
    FlankPoint {
        radius,
        angle,
        height,
        tooth,
        side,
    }
}

/// The tooth whose flank of this side is next to a place.
fn nearest(fit: &Involute, [radius, angle, height]: [f64; 3], side: Side) -> u32 {
    let half = fit.half_angle_at(fit.roll(radius));
    let from = angle - fit.phase - fit.twist * height - side.sign() * half;
    let turns = (from / fit.pitch_angle()).round() as i64;
    turns.rem_euclid(i64::from(fit.teeth)) as u32
}
