//! Links from the elements of shafts, with their deformation and forces.

use super::beam::DeformationKind;
use super::guides::{CELLS, GuideFriction, of_guide};
use super::plan::{Element, ElementDamping, Plan};
use crate::kinematics::Direction;
use crate::scene::carriers::Ground;
use crate::scene::members::SceneGear;
use crate::spec::ShaftDamping;
use gearbench_integrators::system::StateView;
use nalgebra::{DMatrix, SymmetricEigen};

/// Weight relative to the largest below which an entry is rounding of axes that are rotated against each other.
const ROUNDING: f64 = 1e-13;
/// Eigenvalue relative to the highest below which it is that of a rigid motion.
const AT_REST: f64 = 1e-9;
/// Norm below which a rigid link depends on the previous ones.
const DEPENDENT: f64 = 1e-12;

/// Deformation of a link per unit motion of a member along one of its directions.
#[derive(Clone, Copy, Debug)]
pub(super) struct Share {
    pub member: usize,
    pub direction: usize,
    pub weight: f64,
}

/// The part of a scene that a link stands for.
#[derive(Clone, Debug)]
pub(in crate::scene) enum Origin {
    /// A piece of a shaft, by the index of the shaft.
    Shaft(usize),
    /// A stage without teeth, by its index.
    Stage(usize),
    /// The support of one member.
    Guide,
    /// The ground that fixes or drives a member of a planetary set, with its motion.
    Ground(Ground),
}

/// A mode of deformation of a piece of a shaft, or of a stage, between two members.
#[derive(Clone, Debug)]
pub(in crate::scene) struct Link {
    pub kind: DeformationKind,
    /// Coordinates of the scene and their weights.
    pub row: Vec<(usize, f64)>,
    /// Driven directions of the members.
    pub(super) driven: Vec<Share>,
    /// All directions, including fixed ones.
    pub(super) shares: Vec<Share>,
    pub members: [usize; 2],
    /// Stiffness; infinite for a rigid link.
    pub stiffness: f64,
    pub damping: f64,
    pub(super) origin: Origin,
    /// Friction of a guide.
    pub(super) guide_friction: Option<GuideFriction>,
}

impl Link {
    /// Returns the part of the scene that the link stands for.
    pub fn origin(&self) -> &Origin {
        &self.origin
    }

    /// Returns the ground that the link fixes a member to, if any.
    pub(super) fn ground(&self) -> Option<&Ground> {
        match &self.origin {
            Origin::Ground(ground) => Some(ground),
            Origin::Shaft(_) | Origin::Stage(_) | Origin::Guide => None,
        }
    }

    pub fn is_rigid(&self) -> bool {
        self.stiffness.is_infinite()
    }

    /// Returns the scalar product `row . x`.
    pub fn dot(&self, x: &[f64]) -> f64 {
        self.row.iter().map(|&(i, w)| w * x[i]).sum()
    }

    /// Adds a multiple of the row: `y += factor row`.
    pub fn add_to(&self, factor: f64, y: &mut [f64]) {
        for &(i, w) in &self.row {
            y[i] += factor * w;
        }
    }

    /// Returns the part of the rate of deformation from driven hubs.
    pub fn drift(&self, gears: &[SceneGear], at: StateView<'_>) -> f64 {
        let of = |s: &Share| {
            let own = gears[s.member].at(at);
            let motion = gears[s.member].model.hub().motion(own.t, own.q, own.v);
            s.weight * motion.v[s.direction]
        };
        self.driven.iter().map(of).sum()
    }

    /// Returns the deformation and its rate.
    pub fn deformation(&self, gears: &[SceneGear], at: StateView<'_>) -> [f64; 2] {
        let (mut d, mut rate) = (self.dot(at.q), self.dot(at.v));
        for s in &self.driven {
            let own = gears[s.member].at(at);
            let motion = gears[s.member].model.hub().motion(own.t, own.q, own.v);
            d += s.weight * motion.x[s.direction];
            rate += s.weight * motion.v[s.direction];
        }
        [d, rate]
    }

    /// Returns the prescribed acceleration of the row of a rigid link.
    pub fn acceleration(&self, t: f64) -> f64 {
        self.ground().map_or(0.0, |g| g.motion(t)[1])
    }

    /// Returns the force of an elastic link along its row.
    pub fn force(&self, gears: &[SceneGear], at: StateView<'_>) -> f64 {
        let motion = self.deformation(gears, at);
        -(self.stiffness * motion[0] + self.damping * motion[1]) - self.friction(motion, at)
    }

    /// Returns the friction force at a deformation and its rate.
    pub fn friction(&self, motion: [f64; 2], at: StateView<'_>) -> f64 {
        let of = |guide_friction: &GuideFriction| {
            guide_friction.law.force() * guide_friction.part(motion, at.discrete).z
        };
        self.guide_friction.as_ref().map_or(0.0, of)
    }

    /// Returns the slopes of the restoring force of an elastic link by its deformation and its rate.
    pub fn slopes(&self, gears: &[SceneGear], at: StateView<'_>) -> [f64; 2] {
        let Some(guide_friction) = &self.guide_friction else {
            return [self.stiffness, self.damping];
        };
        let part = guide_friction.part(self.deformation(gears, at), at.discrete);
        let force = guide_friction.law.force();
        [
            self.stiffness + force * part.by_place,
            self.damping + force * part.by_speed,
        ]
    }
}

/// Links of the shafts of a scene.
#[derive(Clone, Debug, Default)]
pub(in crate::scene) struct Shafts {
    /// Elastic links, then rigid ones.
    pub links: Vec<Link>,
    /// Number of elastic links.
    pub elastic: usize,
    /// Links whose torques are reported, by span; `None` where the hubs are fixed.
    pub torques: Vec<Option<usize>>,
    /// True if a link has damping.
    pub damped: bool,
    /// Shortest natural time of a link on the members that it joins [s].
    pub characteristic_time: f64,
    /// Products `M^-1 C`, column by column, and `C^T M^-1 C` of rigid links, for constant diagonal masses.
    pub(super) inverse: Vec<f64>,
    pub(super) small: Vec<f64>,
}

impl Shafts {
    /// Creates the links of a plan between members with known coordinates, and the links that fix or drive gears of
    /// planetary sets. `mass` is the diagonal of the mass matrix, `cell` the position in the discrete state of the
    /// histories of guides, `speed` a typical one along lines of action.
    pub fn new(
        plan: &Plan,
        ground: &[Ground],
        gears: &[SceneGear],
        (mass, cell, speed): (&[f64], usize, f64),
    ) -> Self {
        let mut of_spans = Vec::new();
        let mut all = Vec::new();
        // For every link of an element, whether it has the damping of its shaft.
        let mut shares = Vec::new();
        for element in &plan.elements {
            let links = of_element(element, gears);
            shares.extend(
                links
                    .iter()
                    .map(|_| element.damping == ElementDamping::OfShaft),
            );
            if element.begins {
                let torsion = links
                    .iter()
                    .position(|l| l.kind == DeformationKind::Torsion);
                of_spans.push(torsion.map(|k| all.len() + k));
            }
            all.extend(links);
        }
        all.extend(ground.iter().map(|g| of_ground(g, gears)));
        let guides = plan.guides.iter().enumerate();
        all.extend(guides.map(|(i, g)| of_guide(g, gears, (cell + CELLS * i, speed))));
        for (shaft, damping) in plan.damping.iter().enumerate() {
            for kind in [
                DeformationKind::Torsion,
                DeformationKind::Stretching,
                DeformationKind::Bending,
            ] {
                let is_of = |l: &Link| matches!(l.origin, Origin::Shaft(of) if of == shaft);
                let mut own: Vec<(&mut Link, bool)> = (all.iter_mut())
                    .zip(shares.iter().copied())
                    .filter(|(l, _)| is_of(l) && l.kind == kind && !l.is_rigid())
                    .collect();
                let time = match damping {
                    ShaftDamping::None => 0.0,
                    ShaftDamping::Time(time) => *time,
                    ShaftDamping::Ratio(ratio) => {
                        lowest(&own, mass, gears).map_or(0.0, |w| 2.0 * ratio / w)
                    }
                };
                for (link, _) in own.iter_mut().filter(|(_, shares)| *shares) {
                    link.damping = time * link.stiffness;
                }
            }
        }
        // Elastic links first, then those rigid links that are linearly independent.
        let (mut places, mut links) = (vec![None; all.len()], Vec::new());
        for (i, link) in all.iter().enumerate().filter(|(_, l)| !l.is_rigid()) {
            places[i] = Some(links.len());
            links.push(link.clone());
        }
        let elastic = links.len();
        let mut basis: Vec<Vec<f64>> = Vec::new();
        for (i, link) in all.iter().enumerate().filter(|(_, l)| l.is_rigid()) {
            let mut row = vec![0.0; mass.len()];
            link.add_to(1.0, &mut row);
            row.iter_mut().zip(mass).for_each(|(r, m)| *r /= m.sqrt());
            let size = dot(&row, &row);
            for known in &basis {
                let along = dot(known, &row);
                row.iter_mut().zip(known).for_each(|(r, k)| *r -= along * k);
            }
            let left = dot(&row, &row);
            if left > DEPENDENT * size {
                row.iter_mut().for_each(|r| *r /= left.sqrt());
                basis.push(row);
                places[i] = Some(links.len());
                links.push(link.clone());
            }
        }
        let fastest = |l: &Link| {
            let yielding: f64 = l.row.iter().map(|&(i, w)| w * w / mass[i]).sum();
            let [by_place, by_speed] = l
                .guide_friction
                .map_or([0.0; 2], |guide_friction| guide_friction.law.steepest());
            ((l.stiffness + by_place) * yielding)
                .sqrt()
                .max(by_speed * yielding)
        };
        Shafts {
            elastic,
            torques: of_spans.iter().map(|s| s.and_then(|i| places[i])).collect(),
            damped: links
                .iter()
                .any(|l| l.damping > 0.0 || l.guide_friction.is_some()),
            characteristic_time: (links[..elastic].iter())
                .map(|l| fastest(l).recip())
                .fold(f64::INFINITY, f64::min),
            links,
            inverse: Vec::new(),
            small: Vec::new(),
        }
    }

    pub fn is_empty(&self) -> bool {
        self.links.is_empty()
    }

    pub fn springs(&self) -> &[Link] {
        &self.links[..self.elastic]
    }

    pub fn rigid(&self) -> &[Link] {
        &self.links[self.elastic..]
    }

    /// Returns the grounds that fix and drive gears of planetary sets.
    pub fn grounds(&self) -> impl Iterator<Item = &Ground> {
        self.rigid().iter().filter_map(Link::ground)
    }

    /// Stores the products with the inverse of a constant diagonal mass.
    pub fn note_masses(&mut self, inverse_mass: &[f64]) {
        let n = inverse_mass.len();
        let rigid = &self.links[self.elastic..];
        if rigid.is_empty() || n == 0 {
            return;
        }
        let mut inverse = vec![0.0; n * rigid.len()];
        for (link, column) in rigid.iter().zip(inverse.chunks_exact_mut(n)) {
            link.add_to(1.0, column);
            column
                .iter_mut()
                .zip(inverse_mass)
                .for_each(|(x, m)| *x *= m);
        }
        self.small = small(rigid, &inverse, n);
        self.inverse = inverse;
    }
}

/// Computes `C^T Z`, row by row.
pub(super) fn small(links: &[Link], columns: &[f64], n: usize) -> Vec<f64> {
    let row = |l: &Link| -> Vec<f64> { columns.chunks_exact(n).map(|z| l.dot(z)).collect() };
    links.iter().flat_map(row).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Returns the links of an element with free or driven members.
fn of_element(element: &Element, gears: &[SceneGear]) -> Vec<Link> {
    let mut links = Vec::new();
    for mode in &element.modes {
        let mut link = Link {
            kind: mode.kind,
            row: Vec::new(),
            driven: Vec::new(),
            shares: Vec::new(),
            members: element.members,
            stiffness: mode.stiffness,
            damping: match element.damping {
                ElementDamping::Time(time) if mode.stiffness.is_finite() => time * mode.stiffness,
                ElementDamping::OfShaft | ElementDamping::Time(_) => 0.0,
            },
            origin: element.origin.clone(),
            guide_friction: None,
        };
        for ((end, &member), axes) in mode.ends.iter().zip(&element.members).zip(&element.axes) {
            let gear = &gears[member];
            let hub = gear.model.hub();
            let largest = end.iter().fold(0.0_f64, |m, w| m.max(w.abs()));
            let free: Vec<usize> = hub.free_directions().collect();
            for (direction, what) in hub.directions().iter().enumerate() {
                // Along the direction of the hub, by the axes of the end.
                let first = 3 * (direction / 3);
                let axis = &hub.axes[direction % 3];
                let weight: f64 = (0..3).map(|k| end[first + k] * axes[k].dot(axis)).sum();
                if weight.abs() <= ROUNDING * largest {
                    continue;
                }
                let share = Share {
                    member,
                    direction,
                    weight,
                };
                link.shares.push(share);
                match what {
                    Direction::Fixed => {}
                    Direction::Driven(_) => link.driven.push(share),
                    Direction::Free => {
                        let own = free.iter().position(|d| *d == direction).unwrap_or(0);
                        link.row.push((gear.offset + own, weight));
                        if direction == hub.moving() {
                            let shapes = hub.hub_shapes.iter().enumerate();
                            let first = gear.offset + hub.first();
                            link.row
                                .extend(shapes.map(|(i, h)| (first + i, weight * h)));
                        }
                    }
                }
            }
        }
        if !link.row.is_empty() {
            links.push(link);
        }
    }
    links
}

/// Returns a rigid link between the ground and the own motion of a free member.
pub(super) fn to_ground(member: usize, gears: &[SceneGear]) -> Link {
    let gear = &gears[member];
    let hub = gear.model.hub();
    let first = gear.offset + hub.first();
    let shapes = hub.hub_shapes.iter().enumerate();
    let shapes = shapes.map(|(i, h)| (first + i, *h));
    Link {
        kind: DeformationKind::Torsion,
        row: std::iter::once((gear.offset, 1.0)).chain(shapes).collect(),
        driven: Vec::new(),
        shares: vec![Share {
            member,
            direction: hub.moving(),
            weight: 1.0,
        }],
        members: [member; 2],
        stiffness: f64::INFINITY,
        damping: 0.0,
        origin: Origin::Guide,
        guide_friction: None,
    }
}

/// Returns the link of the ground of a planetary set.
fn of_ground(ground: &Ground, gears: &[SceneGear]) -> Link {
    Link {
        origin: Origin::Ground(ground.clone()),
        ..to_ground(ground.member, gears)
    }
}

/// Returns the lowest positive angular frequency of some elastic links with the masses that they join [rad/s]: of
/// bodies as a whole, whatever the mode shapes of their hubs.
fn lowest(links: &[(&mut Link, bool)], mass: &[f64], gears: &[SceneGear]) -> Option<f64> {
    let of_hub = |i: usize| {
        let moves = |g: &&SceneGear| g.range().contains(&i);
        let owner = gears.iter().find(moves);
        owner.is_some_and(|g| i < g.offset + g.model.hub().first())
    };
    let mut touched: Vec<usize> = links
        .iter()
        .flat_map(|(l, _)| l.row.iter().map(|r| r.0))
        .filter(|i| of_hub(*i))
        .collect();
    touched.sort_unstable();
    touched.dedup();
    let n = touched.len();
    if n == 0 {
        return None;
    }
    let mut matrix = DMatrix::<f64>::zeros(n, n);
    for (link, _) in links {
        let of = |i: usize, w: f64| (touched.binary_search(&i).unwrap_or(0), w / mass[i].sqrt());
        let hubs = || link.row.iter().filter(|(i, _)| of_hub(*i));
        for &(i, wi) in hubs() {
            for &(j, wj) in hubs() {
                let ((i, wi), (j, wj)) = (of(i, wi), of(j, wj));
                matrix[(i, j)] += link.stiffness * wi * wj;
            }
        }
    }
    let eigenvalues = SymmetricEigen::new(matrix).eigenvalues;
    let highest = eigenvalues.iter().fold(0.0_f64, |m, x| m.max(*x));
    let above = eigenvalues.iter().filter(|x| **x > AT_REST * highest);
    let lowest = above.fold(f64::INFINITY, |m, x| m.min(*x));
    lowest.is_finite().then(|| lowest.sqrt())
}
