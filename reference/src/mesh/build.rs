//! From the section of a tooth to the mesh of a gear or rack: turned tooth by tooth, drawn over the width
//! along the helix.

use super::error::MeshError;
use super::grading::{geometric, refined};
use super::params::{FineTeeth, GearMeshParams, RackMeshParams, Tooth, Web};
use super::profile::{Body, Plane};
use super::quality::ElementCheck;
use super::section::{Common, Section, section};
use super::{ElementKind, Face, GearMesh, Mesh, Part};
use gearbench_models::Vec3;
use gearbench_models::contact::flank_points::FlankGrid;
use gearbench_models::geometry::{Gear, Rack, Side};
use std::collections::BTreeMap;

/// More nodes than this are taken for a mistake.
const MOST_NODES: f64 = 5e7;
/// Greatest count of anything.
const MOST: usize = 1000;

/// Meshes a gear, or one sector of it.
///
/// # Errors
/// [`MeshError`] when a count is out of range, the gear is solid, or an element would be turned inside out.
pub fn gear(gear: &Gear, params: &GearMeshParams) -> Result<GearMesh, MeshError> {
    let p = params;
    let bore = gear.params().bore_radius;
    check_counts(p.tooth, p.layers, p.rim, p.width)?;
    check_ratios(p.flank_grading, p.skin_growth, p.rim_growth)?;
    if bore <= 0.0 {
        return Err(MeshError::NoBore {
            r_root: gear.r_root(),
            proposal: 0.5 * gear.r_root(),
        });
    }
    if p.sector && p.fine_teeth.is_some() {
        return Err(MeshError::SectorWithFineTeeth);
    }
    let body = Body::Gear(gear);
    if let Some(w) = &p.web {
        check_web(w, gear, p.width)?;
    }
    let b = gear.face_width();
    let planes = planes(p.width, b, p.web.as_ref(), refine(p.kind));
    let z = gear.teeth();
    Plan {
        body,
        kind: p.kind,
        common: Common::new(
            body,
            &p.tooth,
            refine(p.kind),
            p.layers,
            p.rim,
            (p.flank_grading, p.skin_growth, p.rim_growth),
            p.web.as_ref(),
        )?,
        planes,
        web: p.web,
        teeth: if p.sector { vec![0] } else { (0..z).collect() },
        all_teeth: z,
        closed: !p.sector,
        first_turn: 0,
        fine: p.fine_teeth.as_ref(),
        tooth: p.tooth,
        layers: p.layers,
    }
    .build()
}

/// Meshes one sector of a gear: [`gear`] with [`GearMeshParams::sector`].
///
/// # Errors
/// As [`gear`].
pub fn sector(gear: &Gear, params: &GearMeshParams) -> Result<GearMesh, MeshError> {
    let params = GearMeshParams {
        sector: true,
        ..params.clone()
    };
    self::gear(gear, &params)
}

/// Meshes a rack, cut square in the middle of the outer tooth spaces; its back is the `bore`.
///
/// # Errors
/// As [`gear`].
pub fn rack(rack: &Rack, params: &RackMeshParams) -> Result<GearMesh, MeshError> {
    let p = params;
    check_counts(p.tooth, p.layers, p.body, p.width)?;
    check_ratios(p.flank_grading, p.skin_growth, p.body_growth)?;
    let body = Body::Rack(rack);
    let n = rack.teeth();
    let first = rack.first_tooth();
    Plan {
        body,
        kind: p.kind,
        common: Common::new(
            body,
            &p.tooth,
            refine(p.kind),
            p.layers,
            p.body,
            (p.flank_grading, p.skin_growth, p.body_growth),
            None,
        )?,
        planes: planes(p.width, rack.face_width(), None, refine(p.kind)),
        web: None,
        teeth: (0..i64::from(n))
            .map(|k| (first + k).rem_euclid(i64::from(n)) as u32)
            .collect(),
        all_teeth: n,
        closed: false,
        first_turn: first,
        fine: p.fine_teeth.as_ref(),
        tooth: p.tooth,
        layers: p.layers,
    }
    .build()
}

/// 2 for elements with mid-side nodes.
fn refine(kind: ElementKind) -> usize {
    if kind.nodes() == 20 { 2 } else { 1 }
}

fn check_count(
    what: &'static str,
    value: usize,
    least: usize,
    expected: &'static str,
) -> Result<(), MeshError> {
    if (least..=MOST).contains(&value) {
        Ok(())
    } else {
        Err(MeshError::Invalid {
            what,
            value: value as f64,
            expected,
        })
    }
}

fn check_tooth(tooth: Tooth, layers: usize) -> Result<(), MeshError> {
    check_count("elements along the flank", tooth.flank, 1, "1 to 1000")?;
    check_count("elements along the fillet", tooth.fillet, 2, "2 to 1000")?;
    check_count("elements on the root arc", tooth.root, 1, "1 to 1000")?;
    check_count(
        "elements across the tooth",
        tooth.across,
        2 * layers + 1,
        "more than twice the layers of the skin (there is a skin on both sides), at most 1000",
    )
}

fn check_counts(tooth: Tooth, layers: usize, rim: usize, width: usize) -> Result<(), MeshError> {
    check_count("layers of the skin", layers, 1, "1 to 1000")?;
    check_tooth(tooth, layers)?;
    check_count("layers of the rim", rim, 1, "1 to 1000")?;
    check_count("layers over the width", width, 1, "1 to 1000")
}

fn check_ratios(flank: f64, skin: f64, rim: Option<f64>) -> Result<(), MeshError> {
    for (what, value) in [
        ("grading of the flank", flank),
        ("growth in the skin", skin),
        ("growth in the rim", rim.unwrap_or(1.0)),
    ] {
        if !(0.1..=10.0).contains(&value) {
            return Err(MeshError::Invalid {
                what,
                value,
                expected: "a ratio from 0.1 to 10; 1 is uniform",
            });
        }
    }
    Ok(())
}

fn check_web(w: &Web, gear: &Gear, width: usize) -> Result<(), MeshError> {
    check_count("layers of the web", w.layers, 1, "1 to 1000")?;
    check_count("layers of the hub", w.hub_layers, 1, "1 to 1000")?;
    check_count(
        "layers over the width of a gear with a web",
        width,
        3,
        "3 to 1000",
    )?;
    let (low, high, b) = (gear.params().bore_radius, gear.r_root(), gear.face_width());
    let fits = low < w.inner_radius
        && w.inner_radius < w.outer_radius
        && w.outer_radius < high
        && w.thickness > 0.0
        && w.thickness < b;
    if fits {
        Ok(())
    } else {
        Err(MeshError::Web {
            inner: w.inner_radius,
            outer: w.outer_radius,
            thickness: w.thickness,
            low,
            high,
            width: b,
        })
    }
}

/// Planes over the width; with a web two of them are its faces.
fn planes(layers: usize, b: f64, web: Option<&Web>, refine: usize) -> Vec<f64> {
    let even = |n: usize, from: f64, to: f64| {
        geometric(n, 1.0, 1)
            .into_iter()
            .map(move |t| from + (to - from) * t)
    };
    let mut ends: Vec<f64>;
    match web {
        None => ends = even(layers, -0.5 * b, 0.5 * b).collect(),
        Some(w) => {
            let side = sides(layers, b, w);
            let h = 0.5 * w.thickness;
            ends = even(side, -0.5 * b, -h).collect();
            ends.extend(even(layers - 2 * side, -h, h).skip(1));
            ends.extend(even(side, h, 0.5 * b).skip(1));
        }
    }
    refined(&ends, refine)
}

/// Layers beside the web, on each side.
fn sides(layers: usize, b: f64, w: &Web) -> usize {
    let wanted = (layers as f64 * 0.5 * (1.0 - w.thickness / b)).round() as usize;
    wanted.clamp(1, (layers - 1) / 2)
}

/// Everything that is known before nodes are made.
struct Plan<'a> {
    body: Body<'a>,
    kind: ElementKind,
    common: Common<'a>,
    planes: Vec<f64>,
    web: Option<Web>,
    /// Teeth in the order of their place.
    teeth: Vec<u32>,
    all_teeth: u32,
    /// The last tooth joins the first.
    closed: bool,
    /// Pitches by which the first of them is turned.
    first_turn: i64,
    fine: Option<&'a FineTeeth>,
    tooth: Tooth,
    layers: usize,
}

/// A section with its elements over the width.
struct Template {
    section: Section,
    /// For every point and plane whether a node stands there.
    used: Vec<bool>,
    /// (radius, angle) or (height, distance) of every point.
    rolled: Vec<[f64; 2]>,
    /// Quadrilateral and layer of every element.
    elements: Vec<(u32, u32)>,
    /// First element of each quadrilateral and layer, `u32::MAX` where the web leaves none.
    element_of: Vec<u32>,
}

impl Plan<'_> {
    fn build(&self) -> Result<GearMesh, MeshError> {
        let mut fine = vec![true; self.all_teeth as usize];
        let mut templates = vec![self.template(&self.tooth)];
        if let Some(f) = self.fine {
            check_tooth(f.others, self.layers)?;
            fine.fill(false);
            for &tooth in &f.teeth {
                match fine.get_mut(tooth as usize) {
                    Some(flag) => *flag = true,
                    None => {
                        return Err(MeshError::NoSuchTooth {
                            tooth,
                            last: self.all_teeth - 1,
                        });
                    }
                }
            }
            templates.push(self.template(&f.others));
        }
        let template = |tooth: u32| &templates[usize::from(!fine[tooth as usize])];
        let estimate: f64 = self
            .teeth
            .iter()
            .map(|&k| template(k).used.len() as f64)
            .sum();
        if estimate > MOST_NODES {
            return Err(MeshError::TooLarge {
                nodes: estimate,
                limit: MOST_NODES,
            });
        }
        for t in &templates {
            self.check(t)?;
        }

        let mut out = Assembly::new(self, estimate as usize);
        for (place, &tooth) in self.teeth.iter().enumerate() {
            out.tooth(self, template(tooth), place, tooth);
        }
        Ok(out.finish(self))
    }

    fn layers_over_width(&self) -> usize {
        (self.planes.len() - 1) / refine(self.kind)
    }

    fn template(&self, tooth: &Tooth) -> Template {
        let section = section(&self.common, tooth);
        let f = refine(self.kind);
        let (planes, layers) = (self.planes.len(), self.layers_over_width());
        let hollow = |part: Part, layer: usize| {
            part == Part::Web
                && self.web.is_some_and(|w| {
                    let middle = 0.5 * (self.planes[layer * f] + self.planes[(layer + 1) * f]);
                    middle.abs() > 0.5 * w.thickness
                })
        };
        let mut used = vec![false; section.points.len() * planes];
        let mut elements = Vec::with_capacity(section.quads.len() * layers);
        let mut element_of = vec![u32::MAX; section.quads.len() * layers];
        for (q, quad) in section.quads.iter().enumerate() {
            for layer in 0..layers {
                if hollow(quad.part, layer) {
                    continue;
                }
                element_of[q * layers + layer] = elements.len() as u32;
                elements.push((q as u32, layer as u32));
                for &n in &quad.nodes[..4 * f] {
                    for l in layer * f..=(layer + 1) * f {
                        used[n as usize * planes + l] |= l % f == 0 || !section.mid[n as usize];
                    }
                }
            }
        }
        let rolled = section
            .points
            .iter()
            .map(|&p: &Plane| self.body.rolled(p))
            .collect();
        Template {
            section,
            used,
            rolled,
            elements,
            element_of,
        }
    }

    /// Position of a point of a tooth `turn` pitches from tooth 0, in the plane `z`.
    fn place(&self, [a, b]: [f64; 2], turn: i64, z: f64) -> Vec3 {
        match self.body {
            Body::Gear(g) => {
                let angle = b + turn as f64 * g.pitch_angle() + self.twist(z);
                let (sin, cos) = angle.sin_cos();
                Vec3::new(a * cos, a * sin, z)
            }
            // Teeth point to -x, and the left side of a tooth is its lower one.
            Body::Rack(r) => Vec3::new(-a, turn as f64 * r.pitch() - b + self.twist(z), z),
        }
    }

    /// How far the section in the plane `z` is turned [rad] (a rack: moved [m]) by the helix. A rack has the
    /// opposite hand of its mate, so it moves the other way.
    fn twist(&self, z: f64) -> f64 {
        match self.body {
            Body::Gear(g) => z * g.params().helix_angle.tan() / g.r_reference(),
            Body::Rack(r) => -z * r.params().helix_angle.tan(),
        }
    }

    /// Shift of the flank of tooth 0 by its modifications [m] in (radial, tangential) coordinates of the plane
    /// z = 0: along the transverse normal, which is the line of action, so that end faces stay plane.
    fn shift(&self, g: &Gear, roll: f64, zeta: f64) -> [f64; 2] {
        let amount = g.flank_deviation(g.r_base().hypot(roll), zeta) / g.base_helix_angle().cos();
        let tangent_at = g.half_angle_at_roll(roll) - (roll / g.r_base()).atan();
        [amount * tangent_at.sin(), -amount * tangent_at.cos()]
    }

    /// All nodes of one tooth, as [point][plane].
    fn positions(&self, t: &Template, turn: i64, out: &mut Vec<Vec3>) {
        out.clear();
        for p in &t.rolled {
            out.extend(self.planes.iter().map(|&z| self.place(*p, turn, z)));
        }
        let Body::Gear(g) = self.body else { return };
        if g.params().modifications.is_none() {
            return;
        }
        let half = 0.5 * g.face_width();
        for (l, &z) in self.planes.iter().enumerate() {
            let (sin, cos) = (turn as f64 * g.pitch_angle() + self.twist(z)).sin_cos();
            for f in &t.section.followers {
                let [x, y] = self.shift(g, f.roll, z / half);
                let (x, y) = (f.weight * x, f.weight * f.side * y);
                out[f.point as usize * self.planes.len() + l] +=
                    Vec3::new(cos * x - sin * y, sin * x + cos * y, 0.0);
            }
        }
    }

    /// Node of a template for every node of an element.
    fn element_nodes(&self, t: &Template, (q, layer): (u32, u32)) -> impl Iterator<Item = usize> {
        let nodes = t.section.quads[q as usize].nodes;
        let planes = self.planes.len();
        let f = refine(self.kind);
        let l = layer as usize * f;
        let at = move |i: usize, plane: usize| nodes[i] as usize * planes + plane;
        let corners = (0..4)
            .map(move |i| at(i, l))
            .chain((0..4).map(move |i| at(i, l + f)));
        let mids = (4..8)
            .map(move |i| at(i, l))
            .chain((4..8).map(move |i| at(i, l + f)))
            .chain((0..4).map(move |i| at(i, l + 1)));
        corners.chain(mids.take(if f == 2 { 12 } else { 0 }))
    }

    /// Refuses a tooth with a bad element. All teeth of a template are its images by a turn.
    fn check(&self, t: &Template) -> Result<(), MeshError> {
        let mut positions = Vec::new();
        self.positions(t, 0, &mut positions);
        let check = ElementCheck::new(self.kind);
        let mut nodes = Vec::with_capacity(20);
        for &e in &t.elements {
            nodes.clear();
            nodes.extend(self.element_nodes(t, e).map(|n| positions[n]));
            let found = check.element(&nodes);
            if found.scaled_jacobian.is_nan() || found.scaled_jacobian <= 0.0 {
                let centre = nodes[..8].iter().sum::<Vec3>() / 8.0;
                return Err(MeshError::Inverted {
                    part: t.section.quads[e.0 as usize].part,
                    at: centre.into(),
                    jacobian: found.scaled_jacobian,
                });
            }
        }
        Ok(())
    }
}

/// The mesh on its way.
struct Assembly {
    nodes: Vec<Vec3>,
    connectivity: Vec<u32>,
    bore: Vec<u32>,
    flanks: Vec<FlankGrid>,
    node_sets: BTreeMap<String, Vec<u32>>,
    face_sets: BTreeMap<String, Vec<Face>>,
    /// Numbers of the nodes of a tooth, as [point][plane].
    ids: Vec<u32>,
    positions: Vec<Vec3>,
    /// Numbers on the first cut of all and on the last so far.
    first_cut: Vec<u32>,
    last_cut: Vec<u32>,
}

impl Assembly {
    fn new(plan: &Plan<'_>, nodes: usize) -> Self {
        let elements = nodes * plan.kind.nodes();
        Assembly {
            nodes: Vec::with_capacity(nodes),
            connectivity: Vec::with_capacity(elements),
            bore: Vec::new(),
            flanks: Vec::with_capacity(2 * plan.teeth.len()),
            node_sets: BTreeMap::new(),
            face_sets: BTreeMap::new(),
            ids: Vec::new(),
            positions: Vec::new(),
            first_cut: Vec::new(),
            last_cut: Vec::new(),
        }
    }

    fn tooth(&mut self, plan: &Plan<'_>, t: &Template, place: usize, tooth: u32) {
        let planes = plan.planes.len();
        let cut = t.section.cut * planes;
        let all = t.used.len();
        plan.positions(t, plan.first_turn + place as i64, &mut self.positions);
        self.ids.clear();
        self.ids.resize(all, u32::MAX);
        let mut from = 0;
        let mut to = all;
        if place > 0 {
            self.ids[..cut].copy_from_slice(&self.last_cut);
            from = cut;
        }
        if plan.closed && place + 1 == plan.teeth.len() {
            self.ids[all - cut..].copy_from_slice(&self.first_cut);
            to = all - cut;
        }
        for i in from..to {
            if t.used[i] {
                self.ids[i] = self.nodes.len() as u32;
                self.nodes.push(self.positions[i]);
            }
        }
        if place == 0 {
            self.first_cut = self.ids[..cut].to_vec();
        }
        self.last_cut.clear();
        self.last_cut.extend_from_slice(&self.ids[all - cut..]);

        let first_element = (self.connectivity.len() / plan.kind.nodes()) as u32;
        for &e in &t.elements {
            let ids = &self.ids;
            self.connectivity
                .extend(plan.element_nodes(t, e).map(|n| ids[n]));
        }
        for &p in &t.section.bore {
            let of_point = &self.ids[p as usize * planes..][..planes];
            self.bore
                .extend(of_point.iter().filter(|&&n| n != u32::MAX));
        }
        self.flanks_of(plan, t, tooth, first_element);
    }

    fn flanks_of(&mut self, plan: &Plan<'_>, t: &Template, tooth: u32, first_element: u32) {
        let (planes, f) = (plan.planes.len(), refine(plan.kind));
        let layers = plan.layers_over_width();
        for (line, side) in t.section.flanks.iter().zip(Side::BOTH) {
            let letter = if side == Side::Left { 'l' } else { 'r' };
            let name = format!("flank_{}{letter}", tooth + 1);
            let mut set = Vec::with_capacity(line.points.len() * planes);
            for &p in &line.points {
                let of_point = &self.ids[p as usize * planes..][..planes];
                set.extend(of_point.iter().filter(|&&n| n != u32::MAX));
            }
            // Contact sees the corner nodes: quadrilaterals with a node at each corner.
            let mut nodes = Vec::with_capacity((line.points.len() / f + 1) * (layers + 1));
            for &p in line.points.iter().step_by(f) {
                nodes.extend((0..=layers).map(|l| self.ids[p as usize * planes + l * f]));
            }
            let faces = line.faces.iter().flat_map(|&(q, face)| {
                (0..layers).map(move |l| Face {
                    element: first_element + t.element_of[q as usize * layers + l],
                    face,
                })
            });
            self.face_sets.insert(format!("s{name}"), faces.collect());
            self.node_sets.insert(name, set);
            self.flanks.push(FlankGrid {
                tooth,
                side,
                rows: (line.points.len() - 1) / f + 1,
                columns: layers + 1,
                positions: nodes.iter().map(|&n| self.nodes[n as usize]).collect(),
                nodes,
            });
        }
    }

    fn finish(mut self, plan: &Plan<'_>) -> GearMesh {
        self.bore.sort_unstable();
        self.bore.dedup();
        self.node_sets.insert("bore".into(), self.bore.clone());
        if matches!(plan.body, Body::Gear(_)) && !plan.closed {
            let present = |cut: &[u32]| cut.iter().copied().filter(|&n| n != u32::MAX).collect();
            self.node_sets
                .insert("cut_low".into(), present(&self.first_cut));
            self.node_sets
                .insert("cut_high".into(), present(&self.last_cut));
        }
        self.nodes.shrink_to_fit();
        self.connectivity.shrink_to_fit();
        GearMesh {
            mesh: Mesh {
                nodes: self.nodes,
                kind: plan.kind,
                connectivity: self.connectivity,
                node_sets: self.node_sets,
                face_sets: self.face_sets,
            },
            teeth: plan.all_teeth,
            bore: self.bore,
            flanks: self.flanks,
        }
    }
}
