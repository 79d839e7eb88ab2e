//! Shapes of shafts, bodies without teeth, carriers and bearings of a motion, for the still picture and for the viewer of
//! moving gears.
//!
//! A part is a series of rings of points. Each ring has the frame of a member, or of a place on a shaft, which is a cubic
//! between the members. A scene gives no shape for rigid shafts, bodies, carriers and bearings: theirs follow from the gears.

use super::{Point, cross, dot, sum, unit};
use crate::record::{FramePose, GearMotion, ShaftShape, ToothedBody};
use serde::Serialize;

/// Rings between two members of a shaft, and sides of shafts, collars, pins and bodies without teeth.
const STATIONS: usize = 10;
const SHAFT_SIDES: usize = 12;
const COLLAR_SIDES: usize = 24;
const PIN_SIDES: usize = 20;
const BODY_SIDES: usize = 8;

/// Parts of a motion beyond its gears, and what a section across the axes shows of them.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Mechanism {
    /// Parts in space.
    pub parts: Vec<Part>,
    /// Signs in a section across the axes.
    signs: Vec<Sign>,
    /// Shafts along which rings are placed.
    shafts: Vec<ShaftLine>,
    /// Members that move together, besides those in mesh.
    joints: Vec<Vec<usize>>,
}

/// Kind of a part, which has a colour of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum PartKind {
    /// Shaft, or body without teeth.
    Turning,
    /// Planet carrier with its pins.
    Carrier,
    /// Bearing.
    Bearing,
}

/// Part in space: the surface through its rings, each in the order of a right-handed rotation about the way along them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Part {
    /// Kind of the part.
    pub kind: PartKind,
    /// True if the last ring is joined with the first one; otherwise both are ends.
    pub is_hollow: bool,
    /// Rings of as many points each.
    pub rings: Vec<Ring>,
}

/// Ring of points in a frame.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Ring {
    frame: Frame,
    #[serde(flatten)]
    shape: Shape,
}

/// Frame that a ring moves with.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
enum Frame {
    /// The frame of a member.
    Member(usize),
    /// The frame of a member at the first instant.
    Rest(usize),
    /// The frame of a place on a shaft \[m\].
    Shaft(usize, f64),
}

/// Points of a ring in its frame \[m\].
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
enum Shape {
    /// Corners of a regular polygon about the axis.
    Circle {
        at: Point,
        radius: f64,
        sides: usize,
    },
    /// Any polygon.
    Corners(Vec<Point>),
}

/// Sign in a section across the axis of its member.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct Sign {
    kind: SignKind,
    member: usize,
    /// Place in the frame of the member \[m\].
    at: Point,
    /// Radius, of an arm its width \[m\].
    radius: f64,
    /// Direction of the mark of rotation, in the x and y of the member.
    #[serde(skip_serializing_if = "Option::is_none")]
    mark: Option<[f64; 2]>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
enum SignKind {
    Arm,
    Disc,
    Bearing,
}

/// Shaft as the frames of its members: their places \[m\], and one direction in the x and y of each, which is the same for
/// all of them at the first instant (tooth 0 of gears is anywhere).
#[derive(Clone, Debug, PartialEq, Serialize)]
struct ShaftLine {
    members: Vec<usize>,
    places_m: Vec<f64>,
    marks: Vec<[f64; 2]>,
}

/// Section of a shaft from one place to another \[m\].
struct Section {
    from: f64,
    to: f64,
    radius: f64,
    is_coupling: bool,
}

/// Returns the heights of both ends of a body.
fn ends(b: &ToothedBody) -> [f64; 2] {
    [b.heights_m.first(), b.heights_m.last()].map(|z| z.copied().unwrap_or(0.0))
}

fn is_round(b: &ToothedBody) -> bool {
    !b.is_rack && !b.is_internal
}

/// Motion with what shapes are derived from.
struct Source<'a> {
    motion: &'a GearMotion,
    start: Vec<FramePose>,
    /// Radius of each body, and the least one of round bodies.
    reaches: Vec<f64>,
    reach: f64,
}

impl<'a> Source<'a> {
    fn of(motion: &'a GearMotion) -> Option<Self> {
        let paths = motion.paths.iter();
        let start: Option<Vec<FramePose>> = paths
            .map(|p| p.magnified(0.0).ok()?.first().copied())
            .collect();
        let all = motion.bodies.iter();
        let reaches: Vec<f64> = all.clone().map(super::reach).collect();
        let least = |round: bool| {
            let own = all
                .clone()
                .zip(&reaches)
                .filter(|(b, _)| !round || is_round(b));
            own.map(|(_, r)| *r).fold(f64::INFINITY, f64::min)
        };
        let reach = [least(true), least(false)]
            .into_iter()
            .find(|r| r.is_finite());
        Some(Source {
            motion,
            start: start?,
            reach: reach.filter(|r| *r > 0.0)?,
            reaches,
        })
    }

    fn gears(&self) -> usize {
        self.motion.bodies.len()
    }

    fn gear(&self, member: usize) -> Option<&'a ToothedBody> {
        self.motion.bodies.get(member)
    }

    /// Radius of a pin or shaft that fits into a gear.
    fn bore(&self, member: usize) -> f64 {
        match self.gear(member).filter(|b| is_round(b)) {
            Some(b) if b.back_m > 0.0 => 0.96 * b.back_m,
            Some(_) => 0.2 * self.reaches[member],
            None => 0.2 * self.reach,
        }
    }

    fn shaft_of(&self, member: usize) -> Option<(&'a ShaftShape, f64)> {
        let shafts = self.motion.shafts.iter();
        let mut places = shafts.filter_map(|s| {
            let k = s.members.iter().position(|m| *m == member)?;
            Some((s, *s.places_m.get(k)?))
        });
        places.next()
    }

    /// Radius of a shaft without a diameter: the least bore of its gears.
    fn drawn_radius(&self, s: &ShaftShape) -> f64 {
        let gears = s.members.iter().filter(|m| **m < self.gears());
        gears
            .map(|m| self.bore(*m))
            .fold(0.3 * self.reach, f64::min)
    }

    fn sections(&self, s: &ShaftShape) -> Vec<Section> {
        let ordinary = self.drawn_radius(s);
        if s.sections.is_empty() {
            let of = |place: Option<&f64>| place.copied().unwrap_or(0.0);
            return vec![Section {
                from: of(s.places_m.first()),
                to: of(s.places_m.last()),
                radius: ordinary,
                is_coupling: false,
            }];
        }
        let mut from = 0.0;
        let all = s.sections.iter().map(|x| {
            let section = Section {
                from,
                to: from + x.length_m,
                radius: x.diameter_m.map_or(1.5 * ordinary, |d| 0.5 * d),
                is_coupling: x.diameter_m.is_none(),
            };
            from = section.to;
            section
        });
        all.collect()
    }

    fn radius_at(&self, s: &ShaftShape, place: f64) -> f64 {
        let sections = self.sections(s);
        let mut all = sections.iter().filter(|x| !x.is_coupling);
        let own = |x: &&Section| (x.from - 1e-9..=x.to + 1e-9).contains(&place);
        let found = all.clone().find(own).or_else(|| all.next());
        found.map_or_else(|| self.drawn_radius(s), |x| x.radius)
    }

    fn line(&self, s: &ShaftShape) -> ShaftLine {
        let first = s
            .members
            .first()
            .map_or([1.0, 0.0, 0.0], |m| self.start[*m].axes[0]);
        ShaftLine {
            members: s.members.clone(),
            places_m: s.places_m.clone(),
            marks: (s.members.iter())
                .map(|m| [0, 1].map(|k| dot(&first, &self.start[*m].axes[k])))
                .collect(),
        }
    }

    /// Place of the pin of a planet in the frame of its carrier, with which it moves.
    fn pin(&self, carrier: usize, planet: usize) -> Point {
        let then = &self.start[carrier];
        let off = sum(&self.start[planet].origin_m, &then.origin_m, -1.0);
        then.axes.map(|axis| dot(&axis, &off))
    }

    /// Returns the carriers: member and planets.
    fn carriers(&self) -> impl Iterator<Item = (usize, &'a [usize])> {
        let all = self.motion.plain_bodies.iter().enumerate();
        let first = self.gears();
        all.filter(|(_, b)| !b.planets.is_empty())
            .map(move |(i, b)| (first + i, b.planets.as_slice()))
    }

    /// Returns the members on bearings that are drawn, each with the radius of what runs in them: planets run on pins.
    fn bearings(&self) -> impl Iterator<Item = (usize, f64)> {
        let is_planet = |m: &usize| self.carriers().any(|(_, planets)| planets.contains(m));
        let all = self.motion.bearings.iter().copied();
        all.filter(move |m| !is_planet(m) && self.gear(*m).is_none_or(is_round))
            .map(|m| match self.shaft_of(m) {
                Some((s, place)) => (m, self.radius_at(s, place)),
                None => (m, 0.96 * self.bore(m)),
            })
    }
}

/// Rounds a length to what a picture can show, which keeps the data of a page short [m].
fn rounded(x: f64) -> f64 {
    (x * 1e7).round() / 1e7
}

fn circle(frame: Frame, at: Point, radius: f64, sides: usize) -> Ring {
    Ring {
        frame,
        shape: Shape::Circle {
            at: at.map(rounded),
            radius: rounded(radius),
            sides,
        },
    }
}

/// Returns a cylinder about the axis of a frame between two heights.
fn cylinder(
    kind: PartKind,
    frame: Frame,
    (at, heights): (Point, [f64; 2]),
    (radius, sides): (f64, usize),
) -> Part {
    let ring = |z| circle(frame, [at[0], at[1], at[2] + z], radius, sides);
    Part {
        kind,
        is_hollow: false,
        rings: heights.map(ring).into(),
    }
}

/// Returns a hollow cylinder about the axis of a frame.
fn collar(kind: PartKind, frame: Frame, (middle, half): (f64, f64), radii: [f64; 2]) -> Part {
    let ring = |side: f64, r: f64| circle(frame, [0.0, 0.0, middle + side * half], r, COLLAR_SIDES);
    let [inner, outer] = radii;
    Part {
        kind,
        is_hollow: true,
        rings: vec![
            ring(-1.0, outer),
            ring(1.0, outer),
            ring(1.0, inner),
            ring(-1.0, inner),
        ],
    }
}

impl Mechanism {
    /// Derives the mechanism of a motion; of a motion whose numbers cannot be read it is empty.
    pub fn of(motion: &GearMotion) -> Mechanism {
        let Some(source) = Source::of(motion) else {
            return Mechanism::default();
        };
        let mut parts = Vec::new();
        for (i, s) in motion.shafts.iter().enumerate() {
            parts.extend(shaft_parts(&source, i, s));
        }
        parts.extend(plain_parts(&source));
        for (carrier, planets) in source.carriers() {
            parts.extend(carrier_parts(&source, carrier, planets));
        }
        for bearing in source.bearings() {
            parts.extend(bearing_parts(&source, bearing));
        }
        let joined = source
            .carriers()
            .map(|(c, planets)| [&[c], planets].concat());
        Mechanism {
            parts,
            signs: signs(&source),
            shafts: motion.shafts.iter().map(|s| source.line(s)).collect(),
            joints: (motion.shafts.iter().map(|s| s.members.clone()))
                .chain(joined)
                .collect(),
        }
    }

    /// Returns the points of a ring in space, at poses of all members and those at the first instant.
    pub fn points(&self, ring: &Ring, poses: &[FramePose], start: &[FramePose]) -> Vec<Point> {
        let pose = match ring.frame {
            Frame::Member(m) => poses[m],
            Frame::Rest(m) => start[m],
            Frame::Shaft(s, place) => self.shafts[s].station(poses, place),
        };
        match &ring.shape {
            Shape::Corners(all) => all.iter().map(|p| pose.point(*p)).collect(),
            Shape::Circle { at, radius, sides } => (0..*sides)
                .map(|n| {
                    let (sin, cos) = (std::f64::consts::TAU * n as f64 / *sides as f64).sin_cos();
                    pose.point([at[0] + radius * cos, at[1] + radius * sin, at[2]])
                })
                .collect(),
        }
    }
}

impl ShaftLine {
    fn mark(&self, k: usize, poses: &[FramePose]) -> Point {
        let [x, y] = self.marks[k];
        poses[self.members[k]].turn([x, y, 0.0])
    }

    /// Returns the frame of a place: a cubic between members, with an even twist, and the frame of the nearest member
    /// beyond them.
    fn station(&self, poses: &[FramePose], place: f64) -> FramePose {
        let places = &self.places_m;
        let last = places.len() - 1;
        let framed = |origin: Point, side: Point, axis: Point| FramePose {
            axes: [side, cross(&axis, &side), axis],
            origin_m: origin,
        };
        if last == 0 || place <= places[0] || place >= places[last] {
            let n = if place >= places[last] { last } else { 0 };
            let end = &poses[self.members[n]];
            let origin = sum(&end.origin_m, &end.axes[2], place - places[n]);
            return framed(origin, self.mark(n, poses), end.axes[2]);
        }
        let k = places[1..last].iter().take_while(|p| **p < place).count();
        let [a, b] = [k, k + 1].map(|n| &poses[self.members[n]]);
        let length = places[k + 1] - places[k];
        let t = (place - places[k]) / length;
        let weights = [
            (1.0 + 2.0 * t) * (1.0 - t).powi(2),
            length * t * (1.0 - t).powi(2),
            t * t * (3.0 - 2.0 * t),
            length * t * t * (t - 1.0),
        ];
        let of = [a.origin_m, a.axes[2], b.origin_m, b.axes[2]];
        let origin = [0, 1, 2].map(|n| weights.iter().zip(&of).map(|(w, v)| w * v[n]).sum());
        let [from, to] = [k, k + 1].map(|n| self.mark(n, poses));
        let across = cross(&a.axes[2], &from);
        let (sin, cos) = (t * dot(&to, &across).atan2(dot(&to, &from))).sin_cos();
        let axis = unit(&[0, 1, 2].map(|n| (1.0 - t) * a.axes[2][n] + t * b.axes[2][n]));
        let along = sum(&from.map(|x| cos * x), &across, sin);
        framed(origin, unit(&sum(&along, &axis, -dot(&along, &axis))), axis)
    }
}

/// Returns the sections of a shaft, and the webs between it and the bores of its gears.
fn shaft_parts(source: &Source<'_>, number: usize, s: &ShaftShape) -> Vec<Part> {
    let mut parts = Vec::new();
    if s.members.is_empty() {
        return parts;
    }
    for x in source.sections(s).iter().filter(|x| x.to > x.from) {
        let inside = s.places_m.iter().filter(|z| **z > x.from && **z < x.to);
        let cuts: Vec<f64> = std::iter::once(x.from)
            .chain(inside.copied())
            .chain([x.to])
            .collect();
        let steps = cuts.windows(2).flat_map(|cut| {
            (1..=STATIONS).map(move |n| cut[0] + (cut[1] - cut[0]) * n as f64 / STATIONS as f64)
        });
        let places = std::iter::once(x.from).chain(steps);
        let ring = |z| {
            circle(
                Frame::Shaft(number, rounded(z)),
                [0.0; 3],
                x.radius,
                SHAFT_SIDES,
            )
        };
        parts.push(Part {
            kind: PartKind::Turning,
            is_hollow: false,
            rings: places.map(ring).collect(),
        });
    }
    for (m, place) in s.members.iter().zip(&s.places_m) {
        let radius = source.radius_at(s, *place);
        let body = source.gear(*m).filter(|b| is_round(b));
        if let Some(b) = body.filter(|b| b.back_m >= 1.02 * radius) {
            let [low, high] = ends(b);
            let across = (0.5 * (low + high), 0.2 * (high - low));
            let radii = [0.98 * radius, b.back_m];
            parts.push(collar(PartKind::Turning, Frame::Member(*m), across, radii));
        }
    }
    parts
}

/// Returns the bodies without teeth: discs of one size, as a scene has no shape for them.
fn plain_parts(source: &Source<'_>) -> Vec<Part> {
    let all = source.motion.plain_bodies.iter().enumerate();
    let discs = all.filter(|(_, b)| b.inertia_kgm2 > 0.0 && b.planets.is_empty());
    let disc = |(i, _)| {
        let member = source.gears() + i;
        let (s, place) = source.shaft_of(member)?;
        let radius = (0.45 * source.reach).max(1.6 * source.radius_at(s, place));
        let heights = [-0.3 * radius, 0.3 * radius];
        let frame = Frame::Member(member);
        Some(cylinder(
            PartKind::Turning,
            frame,
            ([0.0; 3], heights),
            (radius, BODY_SIDES),
        ))
    };
    discs.filter_map(disc).collect()
}

/// Returns a carrier: arms behind the planets, seen from the end of its axis, and pins.
fn carrier_parts(source: &Source<'_>, carrier: usize, planets: &[usize]) -> Vec<Part> {
    let bodies: Vec<&ToothedBody> = planets.iter().filter_map(|p| source.gear(*p)).collect();
    let low = bodies
        .iter()
        .map(|b| ends(b)[0])
        .fold(f64::INFINITY, f64::min);
    let least = planets.iter().filter_map(|p| source.reaches.get(*p));
    let thick = 0.12 * least.copied().fold(f64::INFINITY, f64::min);
    let wide = 0.5 * planets.iter().map(|p| source.bore(*p)).fold(0.0, f64::max);
    if !(low.is_finite() && thick.is_finite()) {
        return Vec::new();
    }
    let levels = [low - 1.4 * thick, low - 0.4 * thick];
    let frame = Frame::Member(carrier);
    let round = |at: Point, heights, radius| {
        cylinder(PartKind::Carrier, frame, (at, heights), (radius, PIN_SIDES))
    };
    let mut parts = vec![round([0.0; 3], levels, 1.8 * wide)];
    for (planet, body) in planets.iter().zip(&bodies) {
        let pin = source.pin(carrier, *planet);
        let off = unit(&cross(&[0.0, 0.0, 1.0], &unit(&pin)));
        let arm = |z: f64| {
            let sides = [
                ([0.0; 3], -wide),
                (pin, -wide),
                (pin, wide),
                ([0.0; 3], wide),
            ];
            let corners = sides.map(|(p, side)| {
                let [x, y, height] = sum(&p, &off, side);
                [x, y, height + z].map(rounded)
            });
            Ring {
                frame,
                shape: Shape::Corners(corners.into()),
            }
        };
        parts.push(Part {
            kind: PartKind::Carrier,
            is_hollow: false,
            rings: levels.map(arm).into(),
        });
        parts.push(round(pin, levels, 1.25 * wide));
        parts.push(round(
            pin,
            [levels[1], ends(body)[1] + 0.3 * thick],
            source.bore(*planet),
        ));
    }
    parts
}

/// Returns the rings of a bearing, which keep the place of the axis at the start; a gear has them on both sides, and a stub of
/// shaft where it has none.
fn bearing_parts(source: &Source<'_>, (member, radius): (usize, f64)) -> Vec<Part> {
    let half = 0.35 * radius;
    let beyond = |by: f64| {
        source
            .gear(member)
            .map(|b| [ends(b)[0] - by * half, ends(b)[1] + by * half])
    };
    let places = beyond(1.6).map_or_else(|| vec![0.0], Vec::from);
    let ring = |z: &f64| {
        let radii = [1.12 * radius, 1.6 * radius];
        collar(PartKind::Bearing, Frame::Rest(member), (*z, half), radii)
    };
    let mut parts: Vec<Part> = places.iter().map(ring).collect();
    if let Some(heights) = beyond(3.4).filter(|_| source.shaft_of(member).is_none()) {
        let at = ([0.0; 3], heights);
        parts.push(cylinder(
            PartKind::Turning,
            Frame::Member(member),
            at,
            (radius, SHAFT_SIDES),
        ));
    }
    parts
}

/// Returns the signs of a section: arms of carriers, shafts with a mark of their rotation, pins, bearings.
fn signs(source: &Source<'_>) -> Vec<Sign> {
    let mut all = Vec::new();
    let sign = |kind, member, at: Point, radius, mark| Sign {
        kind,
        member,
        at: at.map(rounded),
        radius: rounded(radius),
        mark,
    };
    for (carrier, planets) in source.carriers() {
        let wide = planets.iter().map(|p| source.bore(*p)).fold(0.0, f64::max);
        for p in planets {
            let pin = source.pin(carrier, *p);
            all.push(sign(SignKind::Arm, carrier, pin, wide, None));
            all.push(sign(SignKind::Disc, carrier, pin, source.bore(*p), None));
        }
    }
    for s in &source.motion.shafts {
        let Some(k) = s.members.iter().position(|m| *m < source.gears()) else {
            continue;
        };
        let radius = source.radius_at(s, s.places_m[k]);
        let mark = source.line(s).marks[k];
        all.push(sign(
            SignKind::Disc,
            s.members[k],
            [0.0; 3],
            radius,
            Some(mark),
        ));
    }
    for (member, radius) in source.bearings() {
        all.push(sign(SignKind::Bearing, member, [0.0; 3], radius, None));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::{BodyPath, PlainBody, Quantised, ShaftSection};

    const AXES: [Point; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

    fn body() -> ToothedBody {
        let points = [0.03, -0.003, 0.033, 0.0, 0.03, 0.003];
        ToothedBody {
            teeth: 30,
            pitch: std::f64::consts::TAU / 30.0,
            back_m: 0.01,
            heights_m: vec![-0.01, 0.01],
            is_prism: true,
            points_m: Quantised::of(&points, 1e-9),
            ..ToothedBody::default()
        }
    }

    /// Path of a member from a place, with its rotation and the x of its displacement at the second frame.
    fn path(origin_m: Point, turn: f64, x: f64) -> BodyPath {
        BodyPath {
            axes: AXES,
            origin_m,
            turn_rad: Quantised::of(&[0.0, turn], 1e-9),
            shift_m: Some(Quantised::of(&[0.0, 0.0, 0.0, x, 0.0, 0.0], 1e-9)),
            tilt: None,
        }
    }

    /// Points of all rings of a part at a frame.
    fn rings(motion: &GearMotion, part: &Part, frame: usize) -> Vec<Vec<Point>> {
        let mechanism = Mechanism::of(motion);
        let poses = |n: usize| -> Vec<FramePose> {
            (motion.paths.iter())
                .map(|p| p.poses().unwrap()[n])
                .collect()
        };
        let (poses, start) = (poses(frame), poses(0));
        (part.rings.iter())
            .map(|ring| mechanism.points(ring, &poses, &start))
            .collect()
    }

    fn middle(points: &[Point]) -> Point {
        [0, 1, 2].map(|k| points.iter().map(|p| p[k]).sum::<f64>() / points.len() as f64)
    }

    fn close(a: &Point, b: &Point) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() < 2e-7)
    }

    /// Volume that the surface of a part surrounds; faces that point inwards count as negative.
    fn volume(part: &Part, mut rings: Vec<Vec<Point>>) -> f64 {
        let of = |a: &Point, b: &Point, c: &Point| dot(a, &cross(b, c)) / 6.0;
        let fan = |all: &[Point]| -> f64 {
            (1..all.len() - 1)
                .map(|n| of(&all[0], &all[n], &all[n + 1]))
                .sum()
        };
        let ends = match part.is_hollow {
            true => {
                rings.push(rings[0].clone());
                0.0
            }
            false => fan(&rings[rings.len() - 1]) - fan(&rings[0]),
        };
        let sides = rings.windows(2).map(|pair| {
            let [a, b] = [&pair[0], &pair[1]];
            let quads = (0..a.len()).map(|n| {
                let next = (n + 1) % a.len();
                fan(&[a[n], a[next], b[next], b[n]])
            });
            quads.sum::<f64>()
        });
        ends + sides.sum::<f64>()
    }

    fn planetary() -> GearMotion {
        let quarter = std::f64::consts::FRAC_PI_2;
        GearMotion {
            bodies: vec![body()],
            paths: vec![
                path([0.05, 0.0, 0.0], 0.3, 0.0),
                path([0.0; 3], quarter, 0.0),
            ],
            plain_bodies: vec![PlainBody {
                inertia_kgm2: 1.0,
                planets: vec![0],
                ..PlainBody::default()
            }],
            bearings: vec![0],
            ..GearMotion::default()
        }
    }

    #[test]
    fn pins_rotate_with_their_carrier() {
        let motion = planetary();
        let mechanism = Mechanism::of(&motion);
        let pin = mechanism.parts.last().unwrap();
        assert_eq!(pin.kind, PartKind::Carrier);
        for (frame, expected) in [(0, [0.05, 0.0]), (1, [0.0, 0.05])] {
            for ring in rings(&motion, pin, frame) {
                let [x, y, z] = middle(&ring);
                assert!(close(&[x, y, z], &[expected[0], expected[1], z]), "{x} {y}");
                assert!(ring.iter().all(|p| p[0].hypot(p[1]) < 0.05 + 0.0097));
            }
        }
        assert_eq!(mechanism.joints, [[1, 0]]);
        // A planet on its pin has no bearing in the housing.
        assert!(mechanism.parts.iter().all(|p| p.kind == PartKind::Carrier));
    }

    #[test]
    fn shafts_pass_through_their_members_and_bend_between_them() {
        let motion = GearMotion {
            bodies: vec![body(), body()],
            paths: vec![path([0.0; 3], 0.0, 0.0), path([0.0, 0.0, 0.1], 0.4, 1e-3)],
            shafts: vec![ShaftShape {
                members: vec![0, 1],
                places_m: vec![0.0, 0.1],
                sections: vec![ShaftSection {
                    length_m: 0.1,
                    diameter_m: Some(0.016),
                }],
                ..ShaftShape::default()
            }],
            bearings: vec![1],
            ..GearMotion::default()
        };
        let parts = Mechanism::of(&motion).parts;
        let shaft = rings(&motion, &parts[0], 1);
        let places = [
            (0, [0.0; 3]),
            (5, [0.5e-3, 0.0, 0.05]),
            (10, [1e-3, 0.0, 0.1]),
        ];
        for (n, expected) in places {
            assert!(
                close(&middle(&shaft[n]), &expected),
                "{:?}",
                middle(&shaft[n])
            );
        }
        // The twist is even: the marks of the members are 0.4 rad from each other.
        let angle = |n: usize| {
            let [m, p] = [middle(&shaft[n]), shaft[n][0]];
            (p[1] - m[1]).atan2(p[0] - m[0])
        };
        assert!((angle(5) - 0.2).abs() < 1e-2 && (angle(10) - 0.4).abs() < 1e-6);
        // Webs reach from the shaft to the bore, and bearings stay where the axis was at the start.
        let kinds = parts.iter().map(|p| p.kind);
        assert_eq!(kinds.filter(|k| *k == PartKind::Turning).count(), 3);
        let bearing = parts.iter().find(|p| p.kind == PartKind::Bearing).unwrap();
        assert!(middle(&rings(&motion, bearing, 1)[0])[0].abs() < 1e-9);
    }

    #[test]
    fn faces_point_outwards() {
        for motion in [planetary(), {
            let mut alone = planetary();
            alone.plain_bodies.clear();
            alone.paths.truncate(1);
            alone
        }] {
            let parts = Mechanism::of(&motion).parts;
            assert!(parts.len() >= 3);
            for part in &parts {
                let volume = volume(part, rings(&motion, part, 1));
                assert!(volume > 1e-8, "{part:?}: {volume}");
            }
        }
    }
}
