//! From the section of a tooth to the mesh of a gear or rack: turned tooth by tooth, drawn over the width
//! along the helix.

use super::assembly::Assembly;
use super::checks::{check_counts, check_kind, check_ratios, check_web};
use super::conical;
use super::error::MeshError;
use super::params::{GearMeshParams, Tooth};
use super::profile::{Body, Plane};
use super::section::{Choices, Common, Follower, Section, section};
use super::width::planes;
use super::{GearMesh, Part};
use crate::limits;
use crate::mesh::{ElementCheck, ElementKind};
use gearbench_models::Vec3;
use gearbench_models::geometry::{Gear, Rack, Side};

/// Memory of a node with its share of elements and sets while a mesh is made [bytes].
const NODE_BYTES: f64 = 160.0;

/// Meshes a gear, or one sector of it.
pub fn gear(gear: &Gear, params: &GearMeshParams) -> Result<GearMesh, MeshError> {
    plan(Body::Gear(gear), params)?.build()
}

/// Meshes one sector of a gear: [`gear`] with [`GearMeshParams::sector`].
pub fn sector(gear: &Gear, params: &GearMeshParams) -> Result<GearMesh, MeshError> {
    let params = GearMeshParams {
        sector: true,
        ..params.clone()
    };
    self::gear(gear, &params)
}

/// Meshes a rack, cut square in the middle of the outer tooth spaces; its back is the `bore`.
pub fn rack(rack: &Rack, params: &GearMeshParams) -> Result<GearMesh, MeshError> {
    plan(Body::Rack(rack), params)?.build()
}

/// Checks the requested parameters.
fn plan<'a>(body: Body<'a>, p: &'a GearMeshParams) -> Result<Plan<'a>, MeshError> {
    check_kind(p.kind)?;
    let layers = check_counts(p)?;
    check_ratios(p)?;
    let (teeth, all_teeth, first_turn, face_width) = match body {
        Body::Gear(g) => {
            if p.sector && p.fine_teeth.is_some() {
                return Err(MeshError::SectorWithFineTeeth);
            }
            if let Some(w) = &p.web {
                if g.is_internal() {
                    return Err(MeshError::InternalWithWeb);
                }
                check_web(w, g, p.width)?;
                for end in [-0.5, 0.5].iter().filter(|_| g.is_conical()) {
                    let section = conical::at_height(g, end * g.face_width())?;
                    check_web(w, &section, p.width)?;
                }
            }
            let n = g.teeth();
            let teeth = 0..if p.sector { 1 } else { n };
            // Seen from the roots of an internal gear, teeth count from the left to the right.
            let in_place = |k: u32| if g.is_internal() { (n - k) % n } else { k };
            (teeth.map(in_place).collect(), n, 0, g.face_width())
        }
        Body::Rack(r) => {
            if p.sector || p.web.is_some() {
                return Err(MeshError::RackWithWebOrSector);
            }
            let (n, first) = (i64::from(r.teeth()), r.first_tooth());
            // The section's left side points down: teeth join from the highest to the lowest.
            let teeth = (0..n).rev().map(|k| (first + k).rem_euclid(n) as u32);
            (teeth.collect(), r.teeth(), first + n - 1, r.face_width())
        }
    };
    Ok(Plan {
        body,
        params: p,
        common: Common::new(body, p, layers),
        planes: planes(p.width, face_width, p.web.as_ref(), refine(p.kind)),
        teeth,
        all_teeth,
        closed: matches!(body, Body::Gear(_)) && !p.sector,
        first_turn,
        layers,
    })
}

/// 2 for elements with mid-side nodes.
pub(super) fn refine(kind: ElementKind) -> usize {
    if kind.nodes() == 20 { 2 } else { 1 }
}

/// Data that are known before nodes are created.
pub(super) struct Plan<'a> {
    pub(super) body: Body<'a>,
    pub(super) params: &'a GearMeshParams,
    pub(super) common: Common<'a>,
    pub(super) planes: Vec<f64>,
    /// Teeth in the order of their place.
    pub(super) teeth: Vec<u32>,
    pub(super) all_teeth: u32,
    /// The last tooth joins the first.
    pub(super) closed: bool,
    /// Number of pitches between tooth 0 and the first tooth.
    pub(super) first_turn: i64,
    pub(super) layers: usize,
}

/// Positions of the points of a section in a plane.
pub(super) struct Layer {
    /// (radius, angle) or (height, distance) of every point.
    pub(super) rolled: Vec<[f64; 2]>,
    /// Points that follow modified flanks.
    pub(super) followers: Vec<Follower>,
}

/// A section with its elements over the width.
pub(super) struct Template {
    pub(super) section: Section,
    /// True for every point and plane with a node.
    pub(super) used: Vec<bool>,
    /// Of all planes, or of each where they differ.
    layers: Vec<Layer>,
    /// Quadrilateral and layer of every element.
    pub(super) elements: Vec<(u32, u32)>,
    /// First element of each quadrilateral and layer, `u32::MAX` where the web leaves none.
    pub(super) element_of: Vec<u32>,
}

impl Template {
    fn layer(&self, plane: usize) -> &Layer {
        &self.layers[plane.min(self.layers.len() - 1)]
    }
}

impl Plan<'_> {
    fn build(&self) -> Result<GearMesh, MeshError> {
        let mut fine = vec![true; self.all_teeth as usize];
        if let Some(f) = &self.params.fine_teeth {
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
        }
        let counts = |tooth: u32| match &self.params.fine_teeth {
            Some(f) if !fine[tooth as usize] => &f.others,
            _ => &self.params.tooth,
        };
        let estimate: f64 = self.teeth.iter().map(|&k| self.nodes_of(counts(k))).sum();
        let what = format!("the mesh of about {estimate:.2e} nodes");
        limits::check(what, NODE_BYTES * estimate, "use fewer elements")?;
        let mut templates = vec![self.template(&self.params.tooth)?];
        if let Some(f) = &self.params.fine_teeth {
            templates.push(self.template(&f.others)?);
        }
        let template = |tooth: u32| &templates[usize::from(!fine[tooth as usize])];
        for t in &templates {
            self.check(t)?;
        }

        let mut out = Assembly::new(self, estimate as usize);
        for (place, &tooth) in self.teeth.iter().enumerate() {
            out.tooth(self, template(tooth), place, tooth);
        }
        Ok(out.finish(self))
    }

    /// About as many nodes has a tooth.
    fn nodes_of(&self, t: &Tooth) -> f64 {
        let core = t.across - 2 * self.layers;
        let root = t.fillet + t.root;
        let levels = self.common.level_count();
        let quads = 2 * (t.flank + root) * self.layers
            + (t.flank + t.fillet) * core
            + (2 * root + core) * levels;
        let layers = self.layers_over_width() as f64;
        // Three more nodes for every element that has mid-side nodes.
        match refine(self.params.kind) {
            1 => quads as f64 * (layers + 1.0),
            _ => quads as f64 * (4.0 * layers + 3.0),
        }
    }

    pub(super) fn layers_over_width(&self) -> usize {
        (self.planes.len() - 1) / refine(self.params.kind)
    }

    fn template(&self, tooth: &Tooth) -> Result<Template, MeshError> {
        let (section, over_width) = match self.body {
            Body::Gear(g) if g.is_conical() => {
                conical::over_width(g, &self.planes, (self.params, tooth, self.layers))?
            }
            body => {
                let section = section(&self.common, tooth, Choices::of(&self.common, tooth));
                let points = section.points.iter();
                let layer = Layer {
                    rolled: points.map(|&p: &Plane| body.rolled(p)).collect(),
                    followers: section.followers.clone(),
                };
                (section, vec![layer])
            }
        };
        let f = refine(self.params.kind);
        let (planes, layers) = (self.planes.len(), self.layers_over_width());
        let hollow = |part: Part, layer: usize| {
            part == Part::Web
                && self.params.web.is_some_and(|w| {
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
        Ok(Template {
            section,
            used,
            layers: over_width,
            elements,
            element_of,
        })
    }

    /// Pitches from tooth 0 to a place.
    pub(super) fn turn(&self, place: usize) -> i64 {
        match self.body {
            Body::Gear(g) if !g.is_internal() => self.first_turn + place as i64,
            _ => self.first_turn - place as i64,
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
            Body::Gear(g) => g.twist_at(z),
            Body::Rack(r) => -z * r.params().helix_angle.tan(),
        }
    }

    /// Shift of the flank of tooth 0 by its modifications [m] in (radial, tangential) coordinates of its section:
    /// along the transverse normal, which is the line of action, so that end faces stay plane.
    fn shift(&self, g: &Gear, (side, roll): (Side, f64), z: f64) -> [f64; 2] {
        let radius = g.r_base().hypot(roll);
        let (amount, tangent_at) = if g.is_conical() {
            conical::removed(g, side, radius, z)
        } else {
            let removed = g.flank_deviation(side, radius, z / (0.5 * g.face_width()));
            let tangent_at = g.half_angle_at_roll(roll) - (roll / g.r_base()).atan();
            (removed / g.base_helix_angle().cos(), tangent_at)
        };
        [amount * tangent_at.sin(), -amount * tangent_at.cos()]
    }

    /// Computes all nodes of one tooth, as [point][plane].
    pub(super) fn positions(&self, t: &Template, turn: i64, out: &mut Vec<Vec3>) {
        out.clear();
        for p in 0..t.section.points.len() {
            let planes = self.planes.iter().enumerate();
            out.extend(planes.map(|(l, &z)| self.place(t.layer(l).rolled[p], turn, z)));
        }
        let Body::Gear(g) = self.body else { return };
        if g.params().modifications.is_none() {
            return;
        }
        for (l, &z) in self.planes.iter().enumerate() {
            let (sin, cos) = (turn as f64 * g.pitch_angle() + self.twist(z)).sin_cos();
            for f in &t.layer(l).followers {
                let side = g.side_from_root(f.flank());
                let [x, y] = self.shift(g, (side, f.roll), z);
                let (x, y) = (f.weight * x, f.weight * side.sign() * y);
                out[f.point as usize * self.planes.len() + l] +=
                    Vec3::new(cos * x - sin * y, sin * x + cos * y, 0.0);
            }
        }
    }

    /// Node of a template for every node of an element.
    pub(super) fn element_nodes(
        &self,
        t: &Template,
        (q, layer): (u32, u32),
    ) -> impl Iterator<Item = usize> {
        let nodes = t.section.quads[q as usize].nodes;
        let planes = self.planes.len();
        let f = refine(self.params.kind);
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
        let check = ElementCheck::new(self.params.kind);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear_mesh::tests::{small, spur};

    /// An inverted element, constructed by hand because no valid input is known to give one, is refused with its
    /// position.
    #[test]
    fn an_element_turned_inside_out_is_refused_with_its_place() {
        let (g, p) = (spur(20), small());
        let plan = plan(Body::Gear(&g), &p).unwrap();
        plan.check(&plan.template(&p.tooth).unwrap()).unwrap();
        for part in [Part::Flank, Part::Fillet, Part::Core, Part::Rim] {
            let mut bad = plan.template(&p.tooth).unwrap();
            let quad = bad.section.quads.iter().find(|q| q.part == part).unwrap();
            let [a, c] = [quad.nodes[0], quad.nodes[2]].map(|n| n as usize);
            bad.layers[0].rolled.swap(a, c);
            let e = plan.check(&bad).unwrap_err();
            let MeshError::Inverted { at, jacobian, .. } = e else {
                panic!("{e}")
            };
            assert!(jacobian <= 0.0);
            assert!(at.iter().all(|x| x.abs() < g.r_tip()));
            assert!(e.to_string().contains("use "), "{e}");
            // A node that is not a number must not slip through either.
            bad.layers[0].rolled[a] = [f64::NAN; 2];
            assert!(plan.check(&bad).is_err());
        }
    }
}
