//! A gear for tests of the contact of flank points: every node is a point mass with three free coordinates on a spring
//! to its place on the hub,
//!
//! ```text
//! m x_i'' = -k (x_i - a_i(phi)) - d (x_i' - a_i'(phi)) + contact,     a_i = c + R(phi) X_i
//! J phi'' = T + sum_i (k (x_i - a_i) + d (x_i' - a_i')) . da_i/dphi,  J = total - sum_i m r_i^2
//! ```
//!
//! with the displacements from the assembled positions as coordinates: linear masses, exact momentum.

use crate::flank_test_gears::{NodeParameters, flanks_of, undeformed};
use gearbench_integrators::system::{Coeffs, Energy, Power, Singular, StateView};
use gearbench_models::Vec3;
use gearbench_models::declare_parameters;
use gearbench_models::error::{BuildError, GearPart};
use gearbench_models::gear::parameters::number;
use gearbench_models::gear::properties::Properties;
use gearbench_models::gear::table::{GearContext, Model};
use gearbench_models::gear::{
    FlankNodes, FlankSurface, GearModel, HubBody, HubState, LargeGear, condense_by, respond_by,
};
use gearbench_models::geometry::Flanks;
use gearbench_models::kinematics::{Locus, Placement, Point, Row};
use gearbench_models::spec::Body;

declare_parameters! {
    /// Parameters of the gear of point masses.
    struct NodalParameters model "nodal-test" {
        /// spring of a node
        #[serde(deserialize_with = "number")]
        stiffness_n_per_m: f64,
        /// of a node
        #[serde(deserialize_with = "number")]
        mass_kg: f64,
        /// dashpot of a node
        #[serde(deserialize_with = "number")]
        damping_ns_per_m: f64,
        /// true asks for the condensed correction
        condensed: bool,
        flatten nodes: NodeParameters,
    }
}

/// Row of a gear of point masses in the table of models.
pub const NODAL: Model = Model::of::<NodalParameters>(
    "flank nodes as point masses on springs (test)",
    Properties::NONE,
    build_nodal,
);

/// A gear of point masses; see [`NODAL`].
struct Nodal {
    hub: HubBody,
    placement: Placement,
    flanks: Flanks,
    /// Undeformed nodes in the gear frame.
    positions: Vec<Vec3>,
    body: f64,
    k: f64,
    m: f64,
    d: f64,
    condensed: bool,
}

fn build_nodal(context: &GearContext<'_>) -> Result<Box<dyn GearModel>, BuildError> {
    if matches!(context.body, Body::Rack(_)) {
        return Err(BuildError::gear(
            context.name,
            GearPart::Model,
            "the nodal test gear is no rack",
        ));
    }
    let given = context.parameters::<NodalParameters>()?;
    let flanks = flanks_of(context.body, &given.nodes);
    let positions = undeformed(&flanks);
    let m = given.mass_kg.unwrap_or(1e-7);
    let of_nodes: f64 = positions.iter().map(|x| m * (x.x * x.x + x.y * x.y)).sum();
    let body = context.hub.inertia - of_nodes;
    if body <= 0.0 {
        return Err(BuildError::gear(
            context.name,
            GearPart::Inertia,
            "the nodes are too heavy",
        ));
    }
    let k = given.stiffness_n_per_m.unwrap_or(1e8);
    let (first, own) = (context.hub.coordinates(), 3 * positions.len());
    let on_hub = |x: f64, of_node: f64| {
        let hub = std::iter::repeat_n(x, first);
        hub.chain(std::iter::repeat_n(of_node, own)).collect()
    };
    let hub = HubBody {
        own,
        contact_mass: m,
        characteristic_time: (m / k).sqrt(),
        scales: on_hub(context.effective_radius, 1.0),
        masses: on_hub(body, m),
        ..HubBody::new(context.hub.clone(), context.effective_radius)
    };
    Ok(Box::new(Nodal {
        hub,
        placement: context.placement,
        flanks,
        positions,
        body,
        k,
        m,
        d: given.damping_ns_per_m.unwrap_or(0.0),
        condensed: given.condensed == Some(true),
    }))
}

impl Nodal {
    fn first(&self) -> usize {
        self.hub.coordinates()
    }

    /// Returns the three entries of node `i`.
    fn node(&self, x: &[f64], i: usize) -> Vec3 {
        let at = self.first() + 3 * i;
        Vec3::new(x[at], x[at + 1], x[at + 2])
    }

    /// Returns for each node the index, the position on the hub from the centre, its derivative by the angle, and the
    /// displacement from there.
    fn springs<'a>(
        &'a self,
        at: StateView<'a>,
    ) -> impl Iterator<Item = (usize, Vec3, Vec3, Vec3)> + 'a {
        let start = self.placement.pose(0.0);
        let now = self.placement.pose(self.hub.displacement(at.t, at.q));
        self.positions.iter().enumerate().map(move |(i, x)| {
            let arm = now.turn(x);
            let off = start.turn(x) + self.node(at.q, i) - arm;
            (i, arm, Vec3::new(-arm.y, arm.x, 0.0), off)
        })
    }

    /// Returns the rise of a smooth surface above the face at a point.
    fn bulge(&self, at: StateView<'_>, p: &Point) -> Vec3 {
        let Locus::Quadrature { face, xi } = p.locus else {
            panic!("the point search gives points on faces")
        };
        let mut corners = [Vec3::zeros(); 4];
        self.positions(at, &self.flanks.corners(face), &mut corners);
        let mut bulge = p.x;
        for (x, n) in corners.iter().zip(Flanks::weights(xi)) {
            bulge -= n * x;
        }
        bulge
    }
}

impl GearModel for Nodal {
    fn hub(&self) -> &HubBody {
        &self.hub
    }
    fn hub_mut(&mut self) -> &mut HubBody {
        &mut self.hub
    }
    fn initialise(&self, speed: f64, q: &mut [f64], v: &mut [f64], _discrete: &mut [f64]) {
        q.fill(0.0);
        v.fill(0.0);
        if self.first() > 0 {
            v[0] = speed;
        }
        let start = self.placement.pose(0.0);
        for (x, v) in self
            .positions
            .iter()
            .zip(v[self.first()..].chunks_exact_mut(3))
        {
            let arm = start.turn(x);
            (v[0], v[1]) = (-speed * arm.y, speed * arm.x);
        }
    }
    fn row(&self, at: StateView<'_>, p: &Point, n: &Vec3, row: &mut Row) -> f64 {
        let Locus::Quadrature { face, xi } = p.locus else {
            panic!("the point search gives points on faces")
        };
        let bulge = self.bulge(at, p);
        let mut prescribed = bulge.x * n.y - bulge.y * n.x;
        if self.first() > 0 {
            row.push(0, prescribed);
            prescribed = 0.0;
        }
        prescribed *= self.hub.speed(at.t, at.v);
        for (&node, w) in self.flanks.corners(face).iter().zip(Flanks::weights(xi)) {
            let values = [w * n.x, w * n.y, w * n.z];
            row.push_span(self.first() + 3 * node as usize, values);
        }
        prescribed
    }
    fn forces(&mut self, at: StateView<'_>, f: &mut [f64]) {
        let first = self.first();
        let speed = self.hub.speed(at.t, at.v);
        let mut torque = 0.0;
        for (i, _, t, off) in self.springs(at) {
            let force = self.k * off + self.d * (self.node(at.v, i) - speed * t);
            torque += force.dot(&t);
            for (f, x) in f[first + 3 * i..].iter_mut().zip(force.iter()) {
                *f -= x;
            }
        }
        if first > 0 {
            f[0] += torque;
        }
    }
    fn tangent(&mut self, at: StateView<'_>, dq: &[f64], dv: &[f64], df: &mut [f64]) {
        assert_eq!(self.d, 0.0, "the tangent of the dashpots is not written");
        let first = self.first();
        let turn = if first > 0 { dq[0] } else { 0.0 };
        let _ = dv;
        let mut torque = 0.0;
        for (i, arm, t, off) in self.springs(at) {
            let force = self.k * (self.node(dq, i) - turn * t);
            torque += force.dot(&t) - self.k * turn * off.dot(&arm);
            for (f, x) in df[first + 3 * i..].iter_mut().zip(force.iter()) {
                *f -= x;
            }
        }
        if first > 0 {
            df[0] += torque;
        }
    }
    fn correct(
        &mut self,
        at: StateView<'_>,
        c: Coeffs,
        hub_damping: f64,
        x: &mut [f64],
    ) -> Result<(), Singular> {
        self.solve(at, c, hub_damping, x)
    }
    fn energy(&self, at: StateView<'_>) -> Energy {
        let mut e = Energy::default();
        if self.first() > 0 {
            e.kinetic += 0.5 * self.body * at.v[0] * at.v[0];
        }
        for (i, _, _, off) in self.springs(at) {
            e.kinetic += 0.5 * self.m * self.node(at.v, i).norm_squared();
            e.strain += 0.5 * self.k * off.norm_squared();
        }
        e
    }
    fn powers(&self, at: StateView<'_>) -> Power {
        let speed = self.hub.speed(at.t, at.v);
        let lost = |(i, _, t, _): (usize, Vec3, Vec3, Vec3)| {
            self.d * (self.node(at.v, i) - speed * t).norm_squared()
        };
        Power {
            dissipated: self.springs(at).map(lost).sum(),
            ..Power::default()
        }
    }
    fn hub_state(&self, at: StateView<'_>) -> HubState {
        let speed = self.hub.speed(at.t, at.v);
        let mut momentum = self.body * speed;
        for (i, arm, _, off) in self.springs(at) {
            let (r, v) = (arm + off, self.node(at.v, i));
            momentum += self.m * (r.x * v.y - r.y * v.x);
        }
        HubState {
            displacement: self.hub.displacement(at.t, at.q),
            speed,
            momentum,
        }
    }
    fn surface(&self) -> Option<FlankSurface<'_>> {
        Some(FlankSurface {
            flanks: &self.flanks,
            nodes: self,
            displacement: None,
        })
    }
    fn large(&self) -> Option<&dyn LargeGear> {
        self.condensed.then_some(self)
    }
}

impl FlankNodes for Nodal {
    fn positions(&self, at: StateView<'_>, nodes: &[u32], out: &mut [Vec3]) {
        let start = self.placement.pose(0.0);
        for (x, &i) in out.iter_mut().zip(nodes) {
            let i = i as usize;
            *x = start.point(&self.positions[i]) + self.node(at.q, i);
        }
    }
}

impl LargeGear for Nodal {
    fn condensed(
        &self,
        at: StateView<'_>,
        c: Coeffs,
        hub_damping: f64,
        coordinates: &[u32],
        g: &mut [f64],
    ) -> Result<(), Singular> {
        let mut x = vec![0.0; at.q.len()];
        condense_by(&mut x, coordinates, g, |x| {
            self.solve(at, c, hub_damping, x)
        })
    }
    fn add_response(
        &self,
        at: StateView<'_>,
        c: Coeffs,
        hub_damping: f64,
        touched: (&[u32], &[f64]),
        x: &mut [f64],
    ) -> Result<(), Singular> {
        respond_by(touched, x, |y| self.solve(at, c, hub_damping, y))
    }
    fn factorisations(&self) -> u64 {
        0
    }
}

impl Nodal {
    fn solve(
        &self,
        at: StateView<'_>,
        c: Coeffs,
        hub_damping: f64,
        x: &mut [f64],
    ) -> Result<(), Singular> {
        let first = self.first();
        let node = c.m * self.m + c.k * self.k + c.d * self.d;
        let coupling = c.k * self.k + c.d * self.d;
        if node == 0.0 {
            return Err(Singular);
        }
        if first > 0 {
            let mut hub = c.m * self.body + c.d * hub_damping;
            let mut rhs = x[0];
            for (i, arm, t, off) in self.springs(at) {
                hub += coupling * t.dot(&t) + c.k * self.k * off.dot(&arm);
                hub -= coupling * coupling * t.dot(&t) / node;
                rhs += coupling / node * t.dot(&self.node(x, i));
            }
            x[0] = rhs / hub;
        }
        let turn = if first > 0 { x[0] } else { 0.0 };
        for (i, _, t, _) in self.springs(at) {
            for (x, t) in x[first + 3 * i..].iter_mut().zip(t.iter()) {
                *x = (*x + coupling * turn * t) / node;
            }
        }
        Ok(())
    }
}
