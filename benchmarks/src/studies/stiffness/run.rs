//! Equilibria over a mesh cycle.

use super::plan::Entry;
use gearbench_models::gear::table::Model;
use gearbench_reference::statics::{Load, LoadedPair, MeshCycle, StaticsError};
use gearbench_reports::StiffnessCurve;
use std::time::Instant;

/// Stiffness of one model over a mesh cycle.
#[derive(Clone, Debug)]
pub struct Row {
    /// Label of the model, or the name of the formula.
    pub label: String,
    /// What its stiffness includes.
    pub includes: String,
    /// Formulas in it that have left their range: its numbers are no better than they are there.
    pub limits: Vec<String>,
    pub cycle: MeshCycle,
    /// What a norm states, see [`Entry::stated`].
    pub stated: Option<[f64; 2]>,
    /// Coordinates that were solved for.
    pub unknowns: usize,
    pub work: [u64; 2],
    /// Wall time of the set-up (meshes, factors) and of all equilibria [s].
    pub wall: [f64; 2],
}

pub fn solve(
    entry: &Entry,
    models: &[Model],
    load: Load,
    positions: usize,
    progress: impl FnMut(usize),
) -> Result<Row, StaticsError> {
    let start = Instant::now();
    let mut pair = LoadedPair::new(&entry.spec, &entry.modelling, models)?;
    let setup = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let cycle = MeshCycle::solve(&mut pair, load, positions, progress)?;
    Ok(Row {
        label: entry.label.clone(),
        includes: entry.includes.clone(),
        limits: entry.limits(),
        cycle,
        stated: entry.stated,
        unknowns: pair.unknowns(),
        work: pair.work(),
        wall: [setup, start.elapsed().as_secs_f64()],
    })
}

impl Row {
    /// Stiffness of one pair [N/m^2]: what a norm states, else the largest secant.
    pub fn single_stiffness(&self) -> f64 {
        (self.stated).map_or_else(|| self.cycle.single_stiffness(), |[pair, _]| pair)
    }

    /// Stiffness of the mesh [N/m^2]: what a norm states, else the mean secant.
    pub fn mesh_stiffness(&self) -> f64 {
        (self.stated).map_or_else(|| self.cycle.mesh_stiffness(), |[_, mesh]| mesh)
    }

    /// Position over the base pitch from the pitch point.
    pub(super) fn relative(&self, s: f64) -> f64 {
        (s - self.cycle.pitch_point) / self.cycle.base_pitch
    }

    /// What the chart draws.
    pub fn curve(&self) -> StiffnessCurve {
        let c = &self.cycle;
        let mut share: Vec<(f64, f64)> = Vec::new();
        for p in &c.positions {
            for pair in &p.pairs {
                let s = p.s + pair.offset as f64 * c.base_pitch;
                share.push((self.relative(s), pair.force / p.force));
            }
        }
        share.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (pair_position, pair_share) = share.into_iter().unzip();
        StiffnessCurve {
            label: self.label.clone(),
            position: c.positions.iter().map(|p| self.relative(p.s)).collect(),
            mesh: c
                .positions
                .iter()
                .map(|p| p.force / (p.approach * c.face_width))
                .collect(),
            error: c.positions.iter().map(|p| p.approach).collect(),
            pair_position,
            pair_share,
        }
    }
}
