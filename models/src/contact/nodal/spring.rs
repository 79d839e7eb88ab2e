//! Points of a nodal solve, and their contributions to its equations.

use crate::law::{Friction, FrictionForce, Law, LawForce, SeenBy, retarded};

/// Index of missing nodes, for a gear without a field.
pub const UNUSED: u32 = u32::MAX;

/// A contact point of the solve: nodes, weights, law and results.
#[derive(Clone, Debug)]
pub struct Spring {
    /// Indices of the solved nodes; unused entries have no weight.
    pub nodes: [u32; 8],
    /// Weights of the nodes.
    pub weights: [f64; 8],
    /// Gap before residual compliance [m].
    pub gap0: f64,
    /// Rate of the gap without contact [m/s].
    pub rate: f64,
    /// Sliding speed of the slave relative to the master without contact [m/s].
    pub slip: f64,
    /// Friction of the point, if any.
    pub friction: Option<Friction>,
    /// Stiffness of the contact law.
    pub stiffness: f64,
    /// Contact law with the damper of the point.
    pub law: Law,
    /// Retardation time of the flanks [s].
    pub retardation: f64,
    /// Rate of the gap before residual compliance, without contact [m/s].
    pub rate_before: f64,
    /// Result: gap with residual compliance [m].
    pub gap: f64,
    /// Result: normal force and derivatives; zero for an open point.
    pub force: LawForce,
    /// Result: friction on the slave, along the profile.
    pub friction_force: FrictionForce,
    /// Result: gap [m] and normal force [N] of the elastic law alone.
    pub elastic: (f64, f64),
    /// Result: stiffness of the elastic law at that gap [N/m].
    pub elastic_stiffness: f64,
    /// Result: derivatives of the gap that the law sees by the gap and by its rate, both before residual compliance.
    pub seen_by: SeenBy,
}

impl Spring {
    /// Creates a point from nodes with weights, gap and rate without contact, stiffness and law, before any solve.
    pub fn new(
        (nodes, weights): ([u32; 8], [f64; 8]),
        (gap0, rate): (f64, f64),
        stiffness: f64,
        law: Law,
    ) -> Self {
        Spring {
            nodes,
            weights,
            gap0,
            rate,
            slip: 0.0,
            friction: None,
            stiffness,
            law,
            retardation: 0.0,
            rate_before: rate,
            gap: gap0,
            force: LawForce::default(),
            friction_force: FrictionForce::default(),
            elastic: (gap0, 0.0),
            elastic_stiffness: 0.0,
            seen_by: SeenBy::default(),
        }
    }

    /// Sets gap and normal force at a gap with residual compliance, at the rate of the point and that before residual
    /// compliance.
    #[inline]
    pub(super) fn press(&mut self, gap: f64, rate: f64, before: f64) {
        self.gap = gap;
        let (seen, by) = retarded(gap, [self.gap0, before], self.retardation);
        self.seen_by = by;
        self.force = self.law.at_point(seen, rate, self.stiffness);
    }

    /// Returns the damping of the retardation [N s/m]: the negative derivative of the normal force by the rate of the gap
    /// before residual compliance, without the point's own dashpot.
    #[inline]
    pub(super) fn retarded_damping(&self) -> f64 {
        -self.force.dn_dg * self.seen_by.rate
    }

    /// Returns the first and last node with a weight.
    pub(super) fn span(&self) -> Option<(usize, usize)> {
        let all = self.nodes.iter().zip(self.weights);
        let own = all.filter(|(_, w)| *w != 0.0).map(|(n, _)| *n as usize);
        Some((own.clone().min()?, own.max()?))
    }

    /// Returns the weighted displacement `w . u`.
    #[inline]
    pub fn along(&self, u: &[f64]) -> f64 {
        let mut sum = 0.0;
        for (&i, w) in self.nodes.iter().zip(&self.weights) {
            sum += w * u[i as usize];
        }
        sum
    }

    /// Returns the stiffness with which the point supports its nodes [N/m]. It grows from zero with the overlap, so
    /// that rates have no jump where points close.
    #[inline]
    pub fn holding(&self, deepest: f64) -> f64 {
        let gap = self.elastic.0;
        if gap >= 0.0 {
            return 0.0;
        }
        self.elastic_stiffness * (-gap / (HOLDS * deepest)).min(1.0)
    }

    /// Adds the multiple `x w` to `f`.
    #[inline]
    pub fn add(&self, x: f64, f: &mut [f64]) {
        for (&i, w) in self.nodes.iter().zip(&self.weights) {
            f[i as usize] += x * w;
        }
    }
}

/// Fraction of the deepest elastic overlap above which a point supports its nodes with its full stiffness in the
/// computation of rates.
const HOLDS: f64 = 0.1;

/// Returns the deepest overlap of points under their elastic forces [m].
pub fn deepest(springs: &[Spring]) -> f64 {
    springs.iter().fold(0.0, |d, s| d.max(-s.elastic.0))
}

/// Displacements at the nodes of a point, cached for its neighbours on the same faces.
#[derive(Default)]
pub(super) struct CachedDisplacements {
    nodes: [u32; 8],
    u: [f64; 8],
    filled: bool,
}

impl CachedDisplacements {
    /// Returns the weighted displacement `w . u` of a point.
    #[inline]
    pub(super) fn along(&mut self, s: &Spring, u: &[f64]) -> f64 {
        if !self.filled || self.nodes != s.nodes {
            self.nodes = s.nodes;
            self.u = s.nodes.map(|i| u[i as usize]);
            self.filled = true;
        }
        let mut pairs = [0.0; 4];
        for j in 0..4 {
            pairs[j] = s.weights[j] * self.u[j] + s.weights[4 + j] * self.u[4 + j];
        }
        (pairs[0] + pairs[2]) + (pairs[1] + pairs[3])
    }
}

/// Adds stiffness `k w w^T` and force `f w` of points to a matrix and a vector, face by face; `place` returns the
/// storage position of an entry of the matrix, if it has one.
#[inline]
pub(super) fn add_points<'a>(
    points: impl Iterator<Item = (&'a Spring, f64, f64)>,
    place: impl Fn(usize, usize) -> Option<usize>,
    matrix: &mut [f64],
    vector: &mut [f64],
) {
    let (mut nodes, mut filled) = ([0; 8], false);
    let (mut s, mut f) = ([[0.0; 8]; 8], [0.0; 8]);
    let mut flush = |nodes: &[u32; 8], s: &mut [[f64; 8]; 8], f: &mut [f64; 8]| {
        for i in 0..8 {
            let at = nodes[i] as usize;
            for j in 0..8 {
                if let Some(place) = place(at, nodes[j] as usize) {
                    matrix[place] += s[i][j];
                }
            }
            vector[at] += f[i];
        }
        *s = [[0.0; 8]; 8];
        *f = [0.0; 8];
    };
    for (spring, k, force) in points {
        if nodes != spring.nodes {
            if filled {
                flush(&nodes, &mut s, &mut f);
            }
            nodes = spring.nodes;
        }
        filled = true;
        let w = &spring.weights;
        for i in 0..8 {
            let kw = k * w[i];
            for j in 0..8 {
                s[i][j] += kw * w[j];
            }
            f[i] += force * w[i];
        }
    }
    if filled {
        flush(&nodes, &mut s, &mut f);
    }
}

/// Returns the force of the elastic law of a point at a gap; zero for an open point.
#[inline]
pub(super) fn elastic_at(s: &Spring, gap: f64) -> LawForce {
    if gap >= 0.0 {
        return LawForce::default();
    }
    let force = s.law.smooth(gap, 0.0, 0.0, s.stiffness);
    LawForce {
        dn_dgdot: 0.0,
        ..force
    }
}
