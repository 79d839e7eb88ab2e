//! All modes of a mesh at its flank nodes, and residual compliances as dense matrices.

use super::*;

/// Modes of a whole mesh at its flank nodes and its hub, rigid motion left out.
pub(super) struct Shapes {
    pub(super) omega: Vec<f64>,
    pub(super) shapes: Vec<f64>,
    pub(super) hub: Vec<f64>,
}

impl Shapes {
    pub(super) fn of(
        mesh: &GearMesh,
        surface: &Surface,
        mounting: &Mounting,
        count: Option<usize>,
    ) -> Self {
        let (tie, r) = matrices(mesh, mounting);
        let rigid = mounting.motions().len();
        let count = count.map_or(tie.coordinates(), |c| c + rigid);
        let found = modes::lowest(&r, count, &Options::default()).unwrap();
        let kept = count - rigid;
        let mut s = Shapes {
            omega: found.omega2[rigid..].iter().map(|w| w.sqrt()).collect(),
            shapes: vec![0.0; surface.nodes() * kept],
            hub: vec![0.0; kept],
        };
        let mut full = vec![0.0; 3 * mesh.mesh.nodes.len()];
        let mut along = vec![0.0; surface.nodes()];
        for i in 0..kept {
            let reduced: Vec<f64> = found.vectors.col(i + rigid).iter().copied().collect();
            tie.expand(&reduced, &mut full);
            surface.along_directions(&full, &mut along);
            for (k, a) in along.iter().enumerate() {
                s.shapes[k * kept + i] = *a;
            }
            if mounting.free {
                s.hub[i] = reduced[3 * tie.free.len()];
            }
        }
        s
    }

    pub(super) fn kept(&self) -> KeptModes<'_> {
        KeptModes {
            omega: &self.omega,
            shapes: &self.shapes,
            hub: &self.hub,
            made_for: &[],
        }
    }

    /// The first `count` of the modes.
    pub(super) fn first(&self, count: usize) -> Shapes {
        let all = self.omega.len();
        Shapes {
            omega: self.omega[..count].to_vec(),
            shapes: (self.shapes.chunks_exact(all))
                .flat_map(|s| s[..count].to_vec())
                .collect(),
            hub: self.hub[..count].to_vec(),
        }
    }
}

pub(super) fn matrices(mesh: &GearMesh, mounting: &Mounting) -> (Tie, Reduced) {
    tied(mesh, &mounting.motions(), &mounting.added_in_motions())
}

pub(super) fn dense(r: &Residual) -> Vec<f64> {
    let n = r.hub.len();
    let nodes = 0..n as u32;
    nodes
        .clone()
        .flat_map(|i| nodes.clone().map(move |j| (i, j)))
        .map(|(i, j)| r.flanks.between(i, j, n))
        .collect()
}

pub(super) fn worst(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |l, (a, b)| l.max((a - b).abs()))
}

/// Returns the smallest eigenvalue of the compliance of flank nodes and hub together, relative to the largest; the hub
/// is in units that make its entry equal to one of the flanks.
pub(super) fn definiteness(r: &Residual) -> f64 {
    let n = r.hub.len();
    let c = dense(r);
    let unit = if r.hub_hub > 0.0 {
        (largest(&c) / r.hub_hub).sqrt()
    } else {
        1.0
    };
    // Outward by outward: the hub's rows count as they are.
    let all = Mat::from_fn(n + 1, n + 1, |i, j| match (i == n, j == n) {
        (false, false) => c[i * n + j],
        (true, false) => unit * r.hub[j],
        (false, true) => unit * r.hub[i],
        (true, true) => unit * unit * r.hub_hub,
    });
    let scale = largest(&c);
    let all = faer::Scale(1.0 / scale) * all;
    let values = all.self_adjoint_eigenvalues(Side::Lower).unwrap();
    values[0] / values[n]
}

/// Returns a hub that is free in all directions except, if it is fixed, its own motion.
pub(super) fn floating(mounting: Mounting) -> Mounting {
    let mounting = mounting.with_added(0.03, 4e-5);
    mounting.lateral([true; 6]).unwrap()
}

pub(super) fn mountings() -> [Mounting; 6] {
    let tilting = Mounting::gear(true, 0.0);
    let tilting = tilting.lateral([false, false, true, true, true, false]);
    [
        floating(Mounting::gear(true, 2e-4)),
        floating(Mounting::gear(false, 0.0)),
        tilting.unwrap(),
        Mounting::gear(false, 0.0),
        Mounting::gear(true, 0.0),
        Mounting::gear(true, 3e-4),
    ]
}
