//! The record of a motion: tooth outlines of all gears, and poses, tooth displacements and contacts at instants of a run.
//!
//! A point `p` of a gear's own frame has, in a frame of the motion, the place
//!
//! ```text
//! x = origin + shift + T(tilt) A R_z(turn) (p + displacement of its tooth)
//! ```
//!
//! with the axes `A` at the start, as columns, and the least rotation `T` that moves the axis of the gear to the
//! direction `(tilt_x, tilt_y, sqrt(1 - tilt^2))` in these axes.
//!
//! Natural modes have the same record without times: frame 0 is the state at rest, and each further frame the amplitude of
//! one mode. With the weight `w = sin(omega t)` times a magnification, turn, shift, tilt and displacements of the teeth are
//! `w` times those of the frame.

use super::checks::{each, same_length};
use super::{FlankValue, Quantised};
use serde::{Deserialize, Serialize};

/// Motion of all gears of a run at some instants.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct GearMotion {
    /// Axes of a picture in space: to the right, upwards and towards the reader, those of the first gear at rest.
    pub view: [[f64; 3]; 3],
    /// The gears, in the order of the scene.
    pub bodies: Vec<ToothedBody>,
    /// Times of the frames, ascending \[s\]; empty for modes, whose frames are the state at rest and the amplitudes.
    pub time_s: Vec<f64>,
    /// Poses of the members: the gears in the order of the scene, and behind them the bodies without teeth.
    pub paths: Vec<BodyPath>,
    /// Bodies without teeth, in the order of the scene.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub plain_bodies: Vec<PlainBody>,
    /// Shafts between members.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub shafts: Vec<ShaftShape>,
    /// Members on bearings, by their places in the list of paths.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub bearings: Vec<usize>,
    /// Displacements of teeth; of gears with rigid teeth there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub teeth: Vec<ToothDisplacements>,
    /// Gears of each mesh, by their places in the list of bodies.
    pub meshes: Vec<[usize; 2]>,
    /// Contacts with their forces.
    pub contacts: FrameContacts,
}

/// Body without teeth on a shaft; a scene has no shape for it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct PlainBody {
    /// Name of the body.
    pub name: String,
    /// Moment of inertia about its axis \[kg m^2\]; 0 for a mere place on the shaft, for example that of a bearing.
    pub inertia_kgm2: f64,
    /// Planets whose axes rotate with the body, by their places in the list of bodies; empty unless it is a carrier.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub planets: Vec<usize>,
}

/// Shaft between members.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct ShaftShape {
    /// Name of the shaft.
    pub name: String,
    /// Members that it carries, by their places in the list of paths, in the order along the shaft.
    pub members: Vec<usize>,
    /// Places of the members from the start of the shaft, ascending \[m\].
    pub places_m: Vec<f64>,
    /// Sections from the start of the shaft on; none for a rigid shaft, which has no diameter.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sections: Vec<ShaftSection>,
}

/// Piece of a shaft with one cross-section.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct ShaftSection {
    /// Length \[m\].
    pub length_m: f64,
    /// Outer diameter \[m\]; absent for a coupling.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub diameter_m: Option<f64>,
}

/// Toothed body in its own frame, as one pitch of its outline in sections across the axis.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct ToothedBody {
    /// Name of the gear.
    pub gear: String,
    /// Number of teeth.
    pub teeth: u32,
    /// Number of the first tooth: 0, of a rack that of its lowest tooth.
    pub first_tooth: i64,
    /// True of a rack, whose teeth follow each other along y and point to -x.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub is_rack: bool,
    /// True of an internal gear.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub is_internal: bool,
    /// Distance of neighbouring teeth \[rad\], of a rack \[m\].
    pub pitch: f64,
    /// Radius of the bore (0 of a solid gear) or of the rim of an internal gear, and x of the back of a rack \[m\].
    pub back_m: f64,
    /// Heights of the sections along the axis, ascending \[m\].
    pub heights_m: Vec<f64>,
    /// True if all sections are alike; the points are then those of one.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub is_prism: bool,
    /// Points x, y of tooth 0, section by section, from the middle of one tooth space to that of the next \[m\].
    pub points_m: Quantised,
}

/// Pose of a gear at the frames of a motion.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct BodyPath {
    /// Axes of the gear at the start in space; the third is that of its rotation.
    pub axes: [[f64; 3]; 3],
    /// Place of the origin at the first frame \[m\].
    pub origin_m: [f64; 3],
    /// Rotation about its axis by frame \[rad\].
    pub turn_rad: Quantised,
    /// Displacement of the origin from the first frame, x, y, z by frame \[m\]; absent if it rests.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shift_m: Option<Quantised>,
    /// Direction of the axis in the axes of the start, two components by frame \[-\]; absent if it keeps its direction.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tilt: Option<Quantised>,
}

/// Displacements of the teeth of a gear beyond its rigid motion, along both flanks.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct ToothDisplacements {
    /// Place of the gear in the list of bodies, from 0.
    pub body: usize,
    /// True if the teeth are elastic, false if each moves as a rigid tooth on a spring.
    pub is_elastic: bool,
    /// Radii of the points along a flank, from the root to the tip; of a rack their x \[m\].
    pub rows_m: Vec<f64>,
    /// Heights of the columns of points along the axis \[m\].
    pub heights_m: Vec<f64>,
    /// Number of displaced teeth by frame.
    pub counts: Vec<usize>,
    /// Displaced teeth of all frames, one frame after the other, from 0.
    pub teeth: Vec<u32>,
    /// Displacements x, y in the frame of tooth 0, moved to the tooth: for each tooth by height, flank (the one at y > 0 first) and row
    /// \[m\].
    pub displacements_m: Quantised,
}

/// Contacts of all frames, one frame after the other: slices of lines of contact over the width.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct FrameContacts {
    /// Number of contacts by frame.
    pub counts: Vec<usize>,
    /// Mesh, counted from 1.
    pub meshes: Vec<usize>,
    /// Teeth of both gears, counted from 1.
    pub teeth: Vec<[i64; 2]>,
    /// Side of the flank, 0 left and 1 right.
    pub sides: Vec<u8>,
    /// Places x, y, z \[m\].
    pub points_m: Quantised,
    /// Forces x, y, z on the second gear of the mesh \[N\].
    pub forces_n: Quantised,
    /// Part of the face width that the contact represents \[m\].
    pub widths_m: Quantised,
    /// Half width along the profile, 0 where it is not known \[m\].
    pub half_widths_m: Quantised,
    /// Quantity of the values.
    pub value: FlankValue,
    /// Largest pressure, or force per width \[Pa, N/m\].
    pub values: Quantised,
}

/// Pose of a gear at one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FramePose {
    /// Axes of the gear's own frame in space.
    pub axes: [[f64; 3]; 3],
    /// Place of its origin \[m\].
    pub origin_m: [f64; 3],
}

impl FramePose {
    /// Returns the place of a point of the gear's own frame \[m\].
    pub fn point(&self, p: [f64; 3]) -> [f64; 3] {
        let turned = self.turn(p);
        [0, 1, 2].map(|k| self.origin_m[k] + turned[k])
    }

    /// Returns a direction of the gear's own frame in space.
    pub fn turn(&self, p: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|k| (0..3).map(|i| p[i] * self.axes[i][k]).sum())
    }
}

/// Returns the least rotation that moves z to the direction with two given components, as columns.
fn least_rotation([x, y]: [f64; 2]) -> [[f64; 3]; 3] {
    let c = (1.0 - x * x - y * y).max(0.0).sqrt();
    let k = 1.0 / (1.0 + c);
    [
        [1.0 - k * x * x, -k * x * y, -x],
        [-k * x * y, 1.0 - k * y * y, -y],
        [x, y, c],
    ]
}

impl BodyPath {
    /// Builds the path from the poses of a gear at some instants; `turned` has its approximate rotation at each, by
    /// which whole turns are counted [rad].
    pub fn of(poses: &[FramePose], turned: &[f64]) -> BodyPath {
        let Some(first) = poses.first() else {
            return BodyPath::default();
        };
        let dot = |a: &[f64; 3], b: &[f64; 3]| (0..3).map(|k| a[k] * b[k]).sum::<f64>();
        let mut path = BodyPath {
            axes: first.axes,
            origin_m: first.origin_m,
            ..BodyPath::default()
        };
        let (mut turns, mut shifts, mut tilts) = (Vec::new(), Vec::new(), Vec::new());
        for (pose, about) in poses.iter().zip(turned) {
            let own = pose.axes.map(|axis| path.axes.map(|a| dot(&a, &axis)));
            let tilt = [own[2][0], own[2][1]];
            let base = least_rotation(tilt);
            let turn = dot(&base[1], &own[0]).atan2(dot(&base[0], &own[0]));
            let whole = (about - turned[0] - turn) / std::f64::consts::TAU;
            turns.push(turn + whole.round() * std::f64::consts::TAU);
            tilts.extend(tilt);
            shifts.extend((0..3).map(|k| pose.origin_m[k] - path.origin_m[k]));
        }
        let moves = |all: &[f64], least: f64| all.iter().any(|x| x.abs() > least);
        path.turn_rad = Quantised::of(&turns, TURN);
        path.shift_m = moves(&shifts, SHIFT).then(|| Quantised::of(&shifts, SHIFT));
        path.tilt = moves(&tilts, TURN).then(|| Quantised::of(&tilts, TURN));
        path
    }

    /// Returns the poses at all frames.
    ///
    /// # Errors
    /// Its numbers cannot be read.
    pub fn poses(&self) -> Result<Vec<FramePose>, String> {
        self.magnified(1.0)
    }

    /// Returns the poses at all frames with `factor` times their motion from the first frame.
    ///
    /// # Errors
    /// Its numbers cannot be read.
    pub fn magnified(&self, factor: f64) -> Result<Vec<FramePose>, String> {
        let turns = self.turn_rad.values()?;
        let of = |q: &Option<Quantised>, n: usize| match q {
            Some(q) => q.values(),
            None => Ok(vec![0.0; n * turns.len()]),
        };
        let (shifts, tilts) = (of(&self.shift_m, 3)?, of(&self.tilt, 2)?);
        let start = turns.first().copied().unwrap_or(0.0);
        let pose = |(i, turn): (usize, &f64)| {
            let tilt = [tilts[2 * i], tilts[2 * i + 1]].map(|x| factor * x);
            // A magnified tilt is less than a right angle.
            let part = MOST_TILT / tilt[0].hypot(tilt[1]).max(MOST_TILT);
            let base = least_rotation(tilt.map(|x| part * x));
            let (sin, cos) = (start + factor * (turn - start)).sin_cos();
            let own = [
                [0, 1, 2].map(|k| cos * base[0][k] + sin * base[1][k]),
                [0, 1, 2].map(|k| cos * base[1][k] - sin * base[0][k]),
                base[2],
            ];
            let start = FramePose {
                axes: self.axes,
                origin_m: [0.0; 3],
            };
            FramePose {
                axes: own.map(|axis| start.turn(axis)),
                origin_m: [0, 1, 2].map(|k| self.origin_m[k] + factor * shifts[3 * i + k]),
            }
        };
        Ok(turns.iter().enumerate().map(pose).collect())
    }
}

/// Largest sine of the tilt of an axis in a magnified motion.
const MOST_TILT: f64 = 0.9;
/// Displacement of an axis beyond which it is part of the picture, for example that of a planet [m].
const WANDERS: f64 = 1e-3;
/// Resolution of places, angles and outlines: invisible at any magnification of a picture.
const SHIFT: f64 = 1e-9;
const TURN: f64 = 1e-8;
/// Largest number of teeth of a body that is drawn.
const MOST_TEETH: u32 = 10_000;
/// Resolution of points of outlines \[m\].
pub const OUTLINE: f64 = 2e-8;

/// One pitch of a body in a section across its axis.
#[derive(Clone, Debug, PartialEq)]
pub struct BodySection {
    /// Height of the section along the axis \[m\].
    pub height_m: f64,
    /// Points x, y of tooth 0, from the middle of one tooth space to that of the next \[m\].
    pub points_m: Vec<[f64; 2]>,
}

impl ToothedBody {
    /// Returns the sections of its pitch.
    ///
    /// # Errors
    /// Its numbers cannot be read.
    pub fn sections(&self) -> Result<Vec<BodySection>, String> {
        let all = self.points_m.values()?;
        let points: Vec<[f64; 2]> = all.chunks_exact(2).map(|p| [p[0], p[1]]).collect();
        let sections = self.heights_m.len().max(1);
        let stored = if self.is_prism { 1 } else { sections };
        let each = points.len() / stored;
        let of = |i: usize| {
            let from = if stored == 1 { 0 } else { i * each };
            points[from..from + each].to_vec()
        };
        let section = |(i, z): (usize, &f64)| BodySection {
            height_m: *z,
            points_m: of(i),
        };
        Ok(self.heights_m.iter().enumerate().map(section).collect())
    }

    /// Returns the sine and the cosine of the angle of a tooth from tooth 0; those of 0 for a rack.
    pub fn direction_of(&self, tooth: i64) -> (f64, f64) {
        match self.is_rack {
            true => (0.0, 1.0),
            false => (tooth as f64 * self.pitch).sin_cos(),
        }
    }

    /// Returns the closed outline of the whole body in the section at a place of the list, in its own frame \[m\]; of an
    /// internal gear first the rim, joined to the hole in the middle of a tooth space.
    ///
    /// # Errors
    /// Its numbers cannot be read.
    pub fn outline(&self, section: usize) -> Result<Vec<[f64; 2]>, String> {
        let sections = self.sections()?;
        let Some(BodySection {
            points_m: pitch, ..
        }) = sections.get(section)
        else {
            return Ok(Vec::new());
        };
        let mut all = Vec::new();
        let n = i64::from(self.teeth);
        let open = &pitch[..pitch.len().saturating_sub(1)];
        if self.is_rack {
            for k in (self.first_tooth..self.first_tooth + n).rev() {
                all.extend(open.iter().map(|[x, y]| [*x, y + k as f64 * self.pitch]));
            }
            let end = pitch.last().map_or(0.0, |p| p[1]) + self.first_tooth as f64 * self.pitch;
            let root = pitch.last().map_or(0.0, |p| p[0]);
            let begin = all.first().map_or(0.0, |p| p[1]);
            all.extend([[root, end], [self.back_m, end], [self.back_m, begin]]);
            return Ok(all);
        }
        for k in 0..n {
            let (sin, cos) = (k as f64 * self.pitch).sin_cos();
            all.extend(
                open.iter()
                    .map(|[x, y]| [cos * x - sin * y, sin * x + cos * y]),
            );
        }
        if self.is_internal {
            let circle = 4 * n;
            let first = all.first().copied();
            let rim = (0..=circle).map(|k| {
                let angle = (k as f64 / circle as f64 - 0.5 / n as f64) * std::f64::consts::TAU;
                [self.back_m * angle.cos(), self.back_m * angle.sin()]
            });
            all = rim.chain(first).chain(all.into_iter().rev()).collect();
        }
        Ok(all)
    }
}

impl GearMotion {
    /// True if all axes are parallel and keep their direction, and all sections of the bodies are alike, so that one
    /// section shows everything.
    pub fn is_plane(&self) -> bool {
        let Some(first) = self.paths.first() else {
            return true;
        };
        let parallel = |p: &BodyPath| {
            let dot: f64 = (0..3).map(|k| p.axes[2][k] * first.axes[2][k]).sum();
            dot.abs() > 1.0 - 1e-12 && p.tilt.is_none()
        };
        self.bodies.iter().all(|b| b.is_prism) && self.paths.iter().all(parallel)
    }

    /// True if gears are seen best in space: axes are not parallel, teeth are not straight, gears are inside one another,
    /// planets wander, or, of modes, bodies without teeth move with the gears.
    pub fn is_spatial(&self) -> bool {
        let wanders = self.paths.iter().any(|p| {
            let moved = (p.shift_m.as_ref()).map_or(0.0, |q| q.step * 2f64.powi(q.bits.into()));
            moved > WANDERS
        });
        let turns = |b: &PlainBody| b.inertia_kgm2 > 0.0 && b.planets.is_empty();
        !self.is_plane()
            || self.bodies.iter().any(|b| b.is_internal)
            || (wanders && self.bodies.len() > 2)
            || (self.is_of_modes() && self.plain_bodies.iter().any(turns))
    }

    /// Returns the largest displacement of a point of the gears from frame 0 to another, at least that of bodies without
    /// teeth at half the radius of the smallest gear, as they are drawn \[m\].
    ///
    /// # Errors
    /// Its numbers cannot be read.
    pub fn largest_displacement(&self, frame: usize) -> Result<f64, String> {
        let mut largest: f64 = 0.0;
        let mut reaches = Vec::new();
        for body in &self.bodies {
            let points = body.points_m.values()?;
            let reach = points.chunks_exact(2).map(|p| p[0].hypot(p[1]));
            reaches.push(match body.is_rack {
                true => 0.0,
                false => reach.fold(0.0, f64::max),
            });
        }
        let smallest = (reaches.iter().copied().filter(|r| *r > 0.0)).fold(f64::INFINITY, f64::min);
        let drawn = if smallest.is_finite() {
            0.5 * smallest
        } else {
            0.0
        };
        reaches.resize(self.paths.len(), drawn);
        for (path, reach) in self.paths.iter().zip(reaches) {
            let of = |q: &Option<Quantised>, n: usize| -> Result<f64, String> {
                let Some(q) = q else { return Ok(0.0) };
                let all = q.values()?;
                let own = all.get(n * frame..n * (frame + 1)).unwrap_or_default();
                Ok(own.iter().map(|x| x * x).sum::<f64>().sqrt())
            };
            let turns = path.turn_rad.values()?;
            let turn = (turns.get(frame).zip(turns.first())).map_or(0.0, |(a, b)| (a - b).abs());
            let moved = of(&path.shift_m, 3)? + reach * (turn + of(&path.tilt, 2)?);
            largest = largest.max(moved);
        }
        for teeth in &self.teeth {
            let each = teeth.heights_m.len() * teeth.rows_m.len() * 4;
            let before: usize = teeth.counts.iter().take(frame).sum();
            let own = teeth.counts.get(frame).copied().unwrap_or(0);
            let all = teeth.displacements_m.values()?;
            let own = all.get(before * each..(before + own) * each);
            let sizes = own
                .unwrap_or_default()
                .chunks_exact(2)
                .map(|d| d[0].hypot(d[1]));
            largest = sizes.fold(largest, f64::max);
        }
        Ok(largest)
    }

    /// Returns the place of the frame that is nearest to a time \[s\].
    pub fn nearest(&self, time: f64) -> Option<usize> {
        let off = |i: &usize| (self.time_s[*i] - time).abs();
        (0..self.time_s.len()).min_by(|a, b| off(a).total_cmp(&off(b)))
    }

    /// Returns the number of frames.
    pub fn frames(&self) -> usize {
        self.contacts.counts.len()
    }

    /// True for natural modes: frame 0 is the state at rest, and each further frame the amplitude of a mode.
    pub fn is_of_modes(&self) -> bool {
        self.time_s.is_empty() && self.frames() > 0
    }

    /// Checks the lengths of its lists and the ranges of its numbers.
    pub(crate) fn validate(&self) -> Result<(), String> {
        let frames = self.frames();
        if !self.time_s.windows(2).all(|t| t[0] < t[1]) {
            return Err("time_s is not ascending".into());
        }
        if !self.is_of_modes() {
            same_length("contacts.counts", frames, "time_s", self.time_s.len())?;
        }
        let members = self.bodies.len() + self.plain_bodies.len();
        same_length(
            "paths",
            self.paths.len(),
            "bodies and plain_bodies",
            members,
        )?;
        each("plain_bodies", &self.plain_bodies, |b| {
            match b.planets.iter().all(|p| *p < self.bodies.len()) {
                true => Ok(()),
                false => Err("has a planet that is no body".into()),
            }
        })?;
        each("shafts", &self.shafts, |s| {
            same_length("places_m", s.places_m.len(), "members", s.members.len())?;
            match s.members.iter().all(|m| *m < members) {
                true => Ok(()),
                false => Err("has a member without a path".into()),
            }
        })?;
        if self.bearings.iter().any(|m| *m >= members) {
            return Err("bearings has a member without a path".into());
        }
        each("bodies", &self.bodies, |b| {
            if !(1..=MOST_TEETH).contains(&b.teeth) || b.heights_m.is_empty() {
                return Err(format!(
                    "has {} `teeth` and {} `heights_m`, expected 1 to {MOST_TEETH} and at least 1",
                    b.teeth,
                    b.heights_m.len()
                ));
            }
            let stored = if b.is_prism { 1 } else { b.heights_m.len() };
            let n = b
                .points_m
                .values()
                .map_err(|e| format!("points_m {e}"))?
                .len();
            match n >= 6 * stored && n.is_multiple_of(2 * stored) {
                true => b.points_m.validate(n).map_err(|e| format!("points_m {e}")),
                false => Err(format!(
                    "points_m has {n} numbers, expected as many points in each of {stored} sections"
                )),
            }
        })?;
        each("paths", &self.paths, |p| {
            let check = |key: &str, q: &Quantised, n: usize| {
                q.validate(n * frames).map_err(|e| format!("{key} {e}"))
            };
            check("turn_rad", &p.turn_rad, 1)?;
            p.shift_m
                .as_ref()
                .map_or(Ok(()), |q| check("shift_m", q, 3))?;
            p.tilt.as_ref().map_or(Ok(()), |q| check("tilt", q, 2))
        })?;
        each("teeth", &self.teeth, |t| {
            if t.body >= self.bodies.len() || t.rows_m.len() < 2 || t.heights_m.is_empty() {
                return Err("has no body, fewer than 2 `rows_m` or no `heights_m`".into());
            }
            same_length("counts", t.counts.len(), "the frames", frames)?;
            same_length("teeth", t.teeth.len(), "the sum of counts", sum(&t.counts))?;
            let n = t.teeth.len() * t.heights_m.len() * t.rows_m.len() * 4;
            (t.displacements_m.validate(n)).map_err(|e| format!("displacements_m {e}"))
        })?;
        let c = &self.contacts;
        let known = |m: &usize| (1..=self.meshes.len()).contains(m);
        let bodies = self.meshes.iter().flatten();
        if !c.meshes.iter().all(known) || bodies.clone().any(|b| *b >= self.bodies.len()) {
            return Err("contacts.meshes or `meshes` has the number of no mesh or no body".into());
        }
        let n = sum(&c.counts);
        same_length("contacts.meshes", c.meshes.len(), "the sum of counts", n)?;
        same_length("contacts.teeth", c.teeth.len(), "the sum of counts", n)?;
        same_length("contacts.sides", c.sides.len(), "the sum of counts", n)?;
        [
            ("points_m", &c.points_m, 3),
            ("forces_n", &c.forces_n, 3),
            ("widths_m", &c.widths_m, 1),
            ("half_widths_m", &c.half_widths_m, 1),
            ("values", &c.values, 1),
        ]
        .into_iter()
        .try_for_each(|(key, q, by)| {
            q.validate(n * by)
                .map_err(|e| format!("contacts.{key} {e}"))
        })
    }
}

fn sum(counts: &[usize]) -> usize {
    counts.iter().fold(0, |a, b| a.saturating_add(*b))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pose from three rotations, by the product of their matrices.
    fn pose(turn: f64, [a, b]: [f64; 2], origin: [f64; 3]) -> FramePose {
        let z = [a, b, (1.0 - a * a - b * b).sqrt()];
        let base = least_rotation([a, b]);
        let (sin, cos) = turn.sin_cos();
        FramePose {
            axes: [
                [0, 1, 2].map(|k| cos * base[0][k] + sin * base[1][k]),
                [0, 1, 2].map(|k| cos * base[1][k] - sin * base[0][k]),
                z,
            ],
            origin_m: origin,
        }
    }

    #[test]
    fn the_least_rotation_is_a_rotation_about_an_axis_in_the_plane() {
        let r = least_rotation([0.03, -0.05]);
        for i in 0..3 {
            for j in 0..3 {
                let dot: f64 = (0..3).map(|k| r[i][k] * r[j][k]).sum();
                assert!((dot - f64::from(u8::from(i == j))).abs() < 1e-15);
            }
        }
        // The axis (-y, x, 0) is at rest.
        let axis = [0.05, 0.03, 0.0];
        let turned: Vec<f64> = (0..3)
            .map(|k| (0..3).map(|i| axis[i] * r[i][k]).sum())
            .collect();
        assert!(
            (0..3).all(|k| (turned[k] - axis[k]).abs() < 1e-16),
            "{turned:?}"
        );
    }

    #[test]
    fn paths_return_poses_within_their_resolution_over_many_turns() {
        let n = 400;
        let angle = |i: usize| 0.3 * i as f64;
        let poses: Vec<FramePose> = (0..n)
            .map(|i| {
                let t = i as f64 / n as f64;
                pose(
                    0.4 + angle(i),
                    [1e-3 * t, -2e-3 * t * t],
                    [0.1, 0.02 * t, 1e-5 * t],
                )
            })
            .collect();
        let about: Vec<f64> = (0..n).map(|i| angle(i) + 0.01 * (i as f64).sin()).collect();
        let path = BodyPath::of(&poses, &about);
        let found = path.poses().unwrap();
        let turns = path.turn_rad.values().unwrap();
        for (i, (x, y)) in poses.iter().zip(&found).enumerate() {
            let p = [0.05, 0.01, -0.02];
            let off: f64 = (0..3)
                .map(|k| (x.point(p)[k] - y.point(p)[k]).powi(2))
                .sum();
            assert!(off.sqrt() < 5e-9, "frame {i}: {}", off.sqrt());
            assert!(
                (turns[i] - angle(i)).abs() < 1e-4,
                "{} {}",
                turns[i],
                angle(i)
            );
        }
    }

    #[test]
    fn gears_at_rest_have_neither_shift_nor_tilt() {
        let poses = [0.0, 0.1].map(|turn| pose(turn, [0.0; 2], [0.1, 0.0, 0.0]));
        let path = BodyPath::of(&poses, &[0.0, 0.1]);
        assert!(path.shift_m.is_none() && path.tilt.is_none());
    }
}
