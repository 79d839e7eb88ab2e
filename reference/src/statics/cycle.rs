//! A mesh cycle: the same load at positions over one base pitch.

use super::loaded::{LoadedContact, LoadedPair, StaticsError};

/// Load of the gears over a mesh cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Load {
    /// Equal approach [m] at every position.
    Approach(f64),
    /// Equal force [N] along the line of action in the transverse plane at every position: torque over transverse base
    /// radius.
    Force(f64),
}

/// Static contact over one base pitch.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshCycle {
    /// Pitch point [m].
    pub pitch_point: f64,
    /// Base pitch [m].
    pub base_pitch: f64,
    /// Path of contact [m].
    pub path: [f64; 2],
    /// Common face width [m].
    pub face_width: f64,
    /// Equilibria at equal steps from half a base pitch before the pitch point, which is one of them.
    pub positions: Vec<LoadedContact>,
    /// Tangent stiffness there [N/m].
    pub tangent: Vec<f64>,
}

impl MeshCycle {
    /// Solves for `count` positions.
    pub fn solve(
        pair: &mut LoadedPair,
        load: Load,
        count: usize,
        mut progress: impl FnMut(usize),
    ) -> Result<Self, StaticsError> {
        let layout = pair.layout();
        let (pitch_point, base_pitch) = (layout.pitch_point, layout.base_pitch);
        let (path, face_width) = (layout.path, layout.face_width);
        let count = count.max(1);
        let (mut positions, mut tangent) = (Vec::new(), Vec::new());
        for i in 0..count {
            let steps = i as f64 - (count / 2) as f64;
            let s = pitch_point + base_pitch * steps / count as f64;
            let found = match load {
                Load::Approach(d) => pair.at_approach(s, d)?,
                Load::Force(f) => pair.under_force(s, f)?,
            };
            tangent.push(pair.tangent(&found)?);
            positions.push(found);
            progress(i + 1);
        }
        Ok(MeshCycle {
            pitch_point,
            base_pitch,
            path,
            face_width,
            positions,
            tangent,
        })
    }

    fn mean(&self, f: impl Fn(&LoadedContact) -> f64) -> f64 {
        self.positions.iter().map(f).sum::<f64>() / self.positions.len() as f64
    }

    /// Largest less least transmission error [m].
    pub fn peak_to_peak(&self) -> f64 {
        let d = self.positions.iter().map(|p| p.approach);
        d.clone().fold(f64::MIN, f64::max) - d.fold(f64::MAX, f64::min)
    }

    /// Mean transmission error [m].
    pub fn mean_error(&self) -> f64 {
        self.mean(|p| p.approach)
    }

    /// Mean secant stiffness of the mesh over the width [N/m^2], the mesh stiffness `c_gamma`.
    pub fn mesh_stiffness(&self) -> f64 {
        self.mean(|p| p.force / p.approach) / self.face_width
    }

    /// Mean tangent stiffness of the mesh over the width [N/m^2].
    pub fn mesh_tangent(&self) -> f64 {
        self.tangent.iter().sum::<f64>() / (self.tangent.len() as f64 * self.face_width)
    }

    /// Returns the secant stiffness of one pair over the width [N/m^2] at its positions [m] along the path, ascending,
    /// from the pairs of all positions. Positions without contact are left out.
    pub fn pair_stiffness(&self) -> Vec<(f64, f64)> {
        let mut curve: Vec<(f64, f64)> = Vec::new();
        for p in &self.positions {
            for pair in p.pairs.iter().filter(|pair| pair.force > 0.0) {
                let s = p.s + pair.offset as f64 * self.base_pitch;
                curve.push((s, pair.force / (p.approach * self.face_width)));
            }
        }
        curve.sort_by(|a, b| a.0.total_cmp(&b.0));
        curve
    }

    /// Secant stiffness of the pair at the pitch point over the width [N/m^2].
    pub fn at_pitch_point(&self) -> f64 {
        let at = &self.positions[self.positions.len() / 2];
        at.pair(0) / (at.approach * self.face_width)
    }

    /// Returns the largest secant stiffness of one pair over the width [N/m^2], `c'` of ISO 6336.
    pub fn single_stiffness(&self) -> f64 {
        self.pair_stiffness().iter().fold(0.0, |m, p| p.1.max(m))
    }
}
