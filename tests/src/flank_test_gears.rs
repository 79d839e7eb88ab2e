//! Two small gears that bring flanks as grids of nodes, for tests of the contact of flank points.
//!
//! [`RIGID`]: a rigid gear whose nodes follow the hub. [`NODAL`]: every node is a point mass with three free
//! coordinates on a spring to its place on the hub,
//!
//! ```text
//! m x_i'' = -k (x_i - a_i(phi)) - d (x_i' - a_i'(phi)) + contact,     a_i = c + R(phi) X_i
//! J phi'' = T + sum_i (k (x_i - a_i) + d (x_i' - a_i')) . da_i/dphi,  J = total - sum_i m r_i^2
//! ```
//!
//! with the displacements from the assembled positions as coordinates: linear masses, exact momentum.

use gearbench_integrators::system::{At, Coeffs, Energy, Singular};
use gearbench_models::Vec3;
use gearbench_models::error::{BuildError, GearPart};
use gearbench_models::gear::rigid::Rigid;
use gearbench_models::gear::table::{GearContext, Model, ParameterInfo};
use gearbench_models::gear::{Coordinates, GearModel, HubState, Magnitudes};
use gearbench_models::geometry::{FlankGrid, Flanks, Gear, Rack, Side};
use gearbench_models::kinematics::{Hub, Locus, Placement, Point, Row, Tooth};
use gearbench_models::spec::{Body, Value};

pub(crate) const fn takes(key: &'static str, meaning: &'static str) -> ParameterInfo {
    ParameterInfo {
        key,
        meaning,
        required: false,
    }
}

/// A rigid gear with flanks.
pub const RIGID: Model = Model {
    id: "rigid-flanks-test",
    title: "rigid gear with flanks of nodes (test)",
    parameters: &[
        takes("rows", "nodes along the profile"),
        takes("columns", "nodes over the width"),
        takes("lean_pitches", "how far tips stand off their involutes"),
    ],
    build: build_rigid,
};

/// A gear of point masses.
pub const NODAL: Model = Model {
    id: "nodal-test",
    title: "flank nodes as point masses on springs (test)",
    parameters: &[
        takes("rows", "nodes along the profile"),
        takes("columns", "nodes over the width"),
        takes("stiffness_n_per_m", "spring of a node"),
        takes("mass_kg", "of a node"),
        takes("damping_ns_per_m", "dashpot of a node"),
        takes("condensed", "1: asks for the condensed correction"),
    ],
    build: build_nodal,
};

pub(crate) fn number(context: &GearContext<'_>, key: &str, default: f64) -> f64 {
    match context.parameters.get(key) {
        Some(Value::Number(x)) => *x,
        _ => default,
    }
}

/// Grids of all flanks of a gear: involute from the form circle to the tip, equal steps of the length of roll.
pub fn grids(gear: &Gear, rows: usize, columns: usize) -> Flanks {
    let mut all = Vec::new();
    for tooth in 0..gear.teeth() {
        for side in Side::BOTH {
            let first = (all.len() * rows * columns) as u32;
            let point = |r: usize, c: usize| {
                let t = r as f64 / (rows - 1) as f64;
                let (low, high) = (gear.roll_length_form(), gear.roll_length_tip());
                let radius = gear.r_base().hypot(low + t * (high - low));
                let z = gear.face_width() * (c as f64 / (columns - 1) as f64 - 0.5);
                let angle = f64::from(tooth) * gear.pitch_angle()
                    + z * gear.base_helix_angle().tan() / gear.r_base()
                    + side.sign() * gear.half_angle_at(radius);
                Vec3::new(radius * angle.cos(), radius * angle.sin(), z)
            };
            all.push(FlankGrid {
                tooth,
                side,
                rows,
                columns,
                nodes: (first..).take(rows * columns).collect(),
                positions: (0..rows * columns)
                    .map(|i| point(i / columns, i % columns))
                    .collect(),
            });
        }
    }
    Flanks::new(all)
}

/// The same for a rack, in the frame of its geometry; teeth counted from the lowest.
pub fn rack_grids(rack: &Rack, rows: usize, columns: usize) -> Flanks {
    let mut all = Vec::new();
    for tooth in 0..rack.teeth() {
        for side in Side::BOTH {
            let first = (all.len() * rows * columns) as u32;
            let point = |r: usize, c: usize| {
                let t = r as f64 / (rows - 1) as f64;
                let height = t * rack.tip_height() - (1.0 - t) * rack.form_depth();
                let z = rack.face_width() * (c as f64 / (columns - 1) as f64 - 0.5);
                let y = (rack.first_tooth() + i64::from(tooth)) as f64 * rack.pitch()
                    - z * rack.params().helix_angle.tan()
                    - side.sign() * rack.half_thickness_at(height);
                Vec3::new(-height, y, z)
            };
            all.push(FlankGrid {
                tooth,
                side,
                rows,
                columns,
                nodes: (first..).take(rows * columns).collect(),
                positions: (0..rows * columns)
                    .map(|i| point(i / columns, i % columns))
                    .collect(),
            });
        }
    }
    Flanks::new(all)
}

pub(crate) fn flanks_of(context: &GearContext<'_>) -> Flanks {
    let count = |key, default| number(context, key, default) as usize;
    let (rows, columns) = (count("rows", 9.0), count("columns", 2.0));
    match context.body {
        Body::Gear(gear) => grids(gear, rows, columns),
        Body::Rack(rack) => rack_grids(rack, rows, columns),
    }
}

fn build_rigid(context: &GearContext<'_>) -> Result<Box<dyn GearModel>, BuildError> {
    let mut flanks = flanks_of(context);
    if let Body::Gear(gear) = context.body {
        flanks = leaning(gear, flanks, number(context, "lean_pitches", 0.0));
    }
    Ok(Box::new(RigidFlanks {
        rigid: Rigid::new(context.hub.clone(), context.lever),
        placement: context.placement,
        positions: undeformed(&flanks),
        flanks,
    }))
}

/// The flanks with each node turned in proportion to its height over the base circle, tips by so many pitches.
fn leaning(gear: &Gear, flanks: Flanks, pitches: f64) -> Flanks {
    let mut grids = flanks.grids().to_vec();
    for x in grids.iter_mut().flat_map(|g| &mut g.positions) {
        let height = (x.x.hypot(x.y) - gear.r_base()) / (gear.r_tip() - gear.r_base());
        let (sin, cos) = (height * pitches * gear.pitch_angle()).sin_cos();
        *x = Vec3::new(cos * x.x - sin * x.y, sin * x.x + cos * x.y, x.z);
    }
    Flanks::new(grids)
}

fn undeformed(flanks: &Flanks) -> Vec<Vec3> {
    flanks
        .grids()
        .iter()
        .flat_map(|g| g.positions.iter().copied())
        .collect()
}

/// See [`RIGID`].
struct RigidFlanks {
    rigid: Rigid,
    flanks: Flanks,
    placement: Placement,
    positions: Vec<Vec3>,
}

impl GearModel for RigidFlanks {
    fn id(&self) -> &'static str {
        RIGID.id
    }
    fn hub(&self) -> &Hub {
        self.rigid.hub()
    }

    fn hub_mut(&mut self) -> &mut Hub {
        self.rigid.hub_mut()
    }
    fn coordinates(&self) -> Coordinates {
        self.rigid.coordinates()
    }
    fn scales(&self, m: Magnitudes, q: &mut [f64], v: &mut [f64]) {
        self.rigid.scales(m, q, v);
    }
    fn initialise(&self, speed: f64, q: &mut [f64], v: &mut [f64], memory: &mut [f64]) {
        self.rigid.initialise(speed, q, v, memory);
    }
    fn contact_mass(&self) -> f64 {
        self.rigid.contact_mass()
    }
    fn tooth_travel(&self, at: At<'_>, tooth: Tooth) -> f64 {
        self.rigid.tooth_travel(at, tooth)
    }
    fn flanks(&self) -> Option<&Flanks> {
        Some(&self.flanks)
    }
    fn node_positions(&self, at: At<'_>, nodes: &[u32], out: &mut [Vec3]) {
        let pose = self.placement.pose(self.hub().travel(at.t, at.q));
        for (x, &i) in out.iter_mut().zip(nodes) {
            *x = pose.point(&self.positions[i as usize]);
        }
    }
    fn has_internal_force(&self) -> bool {
        false
    }
    fn uses_engagement(&self) -> bool {
        false
    }
    fn row(&self, at: At<'_>, p: &Point, n: &Vec3, row: &mut Row) {
        self.rigid.row(at, p, n, row);
    }
    fn solve_mass(&mut self, at: At<'_>, f_to_a: &mut [f64]) {
        self.rigid.solve_mass(at, f_to_a);
    }
    fn apply_mass(&mut self, at: At<'_>, x: &[f64], y: &mut [f64]) {
        self.rigid.apply_mass(at, x, y);
    }
    fn correct(
        &mut self,
        at: At<'_>,
        c: Coeffs,
        hub_damping: f64,
        x: &mut [f64],
    ) -> Result<(), Singular> {
        self.rigid.correct(at, c, hub_damping, x)
    }
    fn energy(&self, at: At<'_>) -> Energy {
        self.rigid.energy(at)
    }
    fn hub_state(&self, at: At<'_>) -> HubState {
        self.rigid.hub_state(at)
    }
}

/// See [`NODAL`].
struct Nodal {
    hub: Hub,
    lever: f64,
    placement: Placement,
    flanks: Flanks,
    /// Undeformed nodes in the own frame.
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
    let flanks = flanks_of(context);
    let positions = undeformed(&flanks);
    let m = number(context, "mass_kg", 1e-7);
    let of_nodes: f64 = positions.iter().map(|x| m * (x.x * x.x + x.y * x.y)).sum();
    let body = context.hub.inertia - of_nodes;
    if body <= 0.0 {
        return Err(BuildError::gear(
            context.name,
            GearPart::Inertia,
            "the nodes are too heavy",
        ));
    }
    Ok(Box::new(Nodal {
        hub: context.hub.clone(),
        lever: context.lever,
        placement: context.placement,
        flanks,
        positions,
        body,
        k: number(context, "stiffness_n_per_m", 1e8),
        m,
        d: number(context, "damping_ns_per_m", 0.0),
        condensed: number(context, "condensed", 0.0) != 0.0,
    }))
}

impl Nodal {
    fn first(&self) -> usize {
        self.hub.coordinates()
    }

    /// Three entries of node `i`.
    fn node(&self, x: &[f64], i: usize) -> Vec3 {
        let at = self.first() + 3 * i;
        Vec3::new(x[at], x[at + 1], x[at + 2])
    }

    /// Per node: index, place on the hub seen from the centre, its derivative by the angle, displacement from
    /// there.
    fn springs<'a>(&'a self, at: At<'a>) -> impl Iterator<Item = (usize, Vec3, Vec3, Vec3)> + 'a {
        let start = self.placement.pose(0.0);
        let now = self.placement.pose(self.hub.travel(at.t, at.q));
        self.positions.iter().enumerate().map(move |(i, x)| {
            let arm = now.turn(x);
            let off = start.turn(x) + self.node(at.q, i) - arm;
            (i, arm, Vec3::new(-arm.y, arm.x, 0.0), off)
        })
    }

    /// What a smooth surface rises above the face at a point.
    fn bulge(&self, at: At<'_>, p: &Point) -> Vec3 {
        let Locus::Quadrature { face, xi } = p.locus else {
            panic!("the point search gives points on faces")
        };
        let mut corners = [Vec3::zeros(); 4];
        self.node_positions(at, &self.flanks.corners(face), &mut corners);
        let mut bulge = p.x;
        for (x, n) in corners.iter().zip(Flanks::weights(xi)) {
            bulge -= n * x;
        }
        bulge
    }
}

impl GearModel for Nodal {
    fn id(&self) -> &'static str {
        NODAL.id
    }
    fn hub(&self) -> &Hub {
        &self.hub
    }

    fn hub_mut(&mut self) -> &mut Hub {
        &mut self.hub
    }
    fn coordinates(&self) -> Coordinates {
        Coordinates {
            n: self.first() + 3 * self.positions.len(),
            memory: 0,
        }
    }
    fn scales(&self, m: Magnitudes, q: &mut [f64], v: &mut [f64]) {
        q.fill(m.deflection);
        v.fill(m.speed);
        if self.first() > 0 {
            q[0] /= self.lever;
            v[0] /= self.lever;
        }
    }
    fn initialise(&self, speed: f64, q: &mut [f64], v: &mut [f64], _memory: &mut [f64]) {
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
    fn contact_mass(&self) -> f64 {
        self.m
    }
    fn pace(&self) -> f64 {
        (self.m / self.k).sqrt()
    }
    fn tooth_travel(&self, at: At<'_>, _tooth: Tooth) -> f64 {
        self.hub.travel(at.t, at.q)
    }
    fn flanks(&self) -> Option<&Flanks> {
        Some(&self.flanks)
    }
    fn node_positions(&self, at: At<'_>, nodes: &[u32], out: &mut [Vec3]) {
        let start = self.placement.pose(0.0);
        for (x, &i) in out.iter_mut().zip(nodes) {
            let i = i as usize;
            *x = start.point(&self.positions[i]) + self.node(at.q, i);
        }
    }
    fn uses_engagement(&self) -> bool {
        false
    }
    fn row(&self, at: At<'_>, p: &Point, n: &Vec3, row: &mut Row) {
        let Locus::Quadrature { face, xi } = p.locus else {
            panic!("the point search gives points on faces")
        };
        if self.first() > 0 {
            let bulge = self.bulge(at, p);
            row.push(0, bulge.x * n.y - bulge.y * n.x);
        }
        for (&node, w) in self.flanks.corners(face).iter().zip(Flanks::weights(xi)) {
            let values = [w * n.x, w * n.y, w * n.z];
            row.push_span(self.first() + 3 * node as usize, values);
        }
    }
    fn drift(&self, at: At<'_>, p: &Point, n: &Vec3) -> f64 {
        if self.first() > 0 {
            return 0.0;
        }
        let bulge = self.bulge(at, p);
        (bulge.x * n.y - bulge.y * n.x) * self.hub.speed(at.t, at.v)
    }
    fn internal_force(&mut self, at: At<'_>, f: &mut [f64]) {
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
    fn internal_tangent(&mut self, at: At<'_>, dq: &[f64], dv: &[f64], df: &mut [f64]) {
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
    fn solve_mass(&mut self, _at: At<'_>, f_to_a: &mut [f64]) {
        let first = self.first();
        if first > 0 {
            f_to_a[0] /= self.body;
        }
        for f in &mut f_to_a[first..] {
            *f /= self.m;
        }
    }
    fn apply_mass(&mut self, _at: At<'_>, x: &[f64], y: &mut [f64]) {
        for (y, x) in y.iter_mut().zip(x) {
            *y = self.m * x;
        }
        if self.first() > 0 {
            y[0] = self.body * x[0];
        }
    }
    fn correct(
        &mut self,
        at: At<'_>,
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
    fn prefers_condensed(&self) -> bool {
        self.condensed
    }
    fn energy(&self, at: At<'_>) -> Energy {
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
    fn dissipated(&self, at: At<'_>) -> f64 {
        let speed = self.hub.speed(at.t, at.v);
        self.springs(at)
            .map(|(i, _, t, _)| self.d * (self.node(at.v, i) - speed * t).norm_squared())
            .sum()
    }
    fn hub_state(&self, at: At<'_>) -> HubState {
        let speed = self.hub.speed(at.t, at.v);
        let mut momentum = self.body * speed;
        for (i, arm, _, off) in self.springs(at) {
            let (r, v) = (arm + off, self.node(at.v, i));
            momentum += self.m * (r.x * v.y - r.y * v.x);
        }
        HubState {
            travel: self.hub.travel(at.t, at.q),
            speed,
            momentum,
        }
    }
}
