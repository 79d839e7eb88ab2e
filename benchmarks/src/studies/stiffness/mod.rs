//! Static mesh stiffness of the models of a scene, beside ISO 6336 and the analytic tooth compliance.
//!
//! All rows go through the same equilibria ([`MeshCycle`]); the norm and the analytic curve are those of rigid gears
//! with that stiffness of a pair.

pub mod arguments;
pub mod command;

use gearbench_models::error::BuildError;
use gearbench_models::gear::rigid;
use gearbench_models::gear::table::{Model, properties_of};
use gearbench_models::spec::{Modelling, SceneSpec};
use gearbench_models::stiffness::{
    Foundation, Hertz, IsoVariation, PairStiffness, RootLength, ToothModel,
};
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
    /// Equilibria over the cycle.
    pub cycle: MeshCycle,
    /// Coordinates that were solved for.
    pub unknowns: usize,
    /// Equilibria and Newton iterations.
    pub work: [u64; 2],
    /// Wall time of the set-up (meshes, factors) and of all equilibria [s].
    pub wall: [f64; 2],
}

/// A model to load.
pub struct Entry {
    /// Label.
    pub label: String,
    /// What its stiffness includes.
    pub includes: String,
    /// Gears and mesh.
    pub spec: SceneSpec,
    /// Models and contact.
    pub modelling: Modelling,
}

/// Rigid gears with the stiffness of the norm, and with the analytic compliance of teeth, bodies and contact, in
/// place of a model of the same gears.
#[must_use]
pub fn formulas(spec: &SceneSpec, modelling: &Modelling) -> [Entry; 2] {
    let with = |label: &str, includes: &str, stiffness: PairStiffness| {
        let mut modelling = modelling.clone();
        modelling.gears.fill(rigid::spec());
        for contact in &mut modelling.contacts {
            contact.stiffness = stiffness.clone();
            contact.exponent = 1.0;
            contact.points = None;
        }
        Entry {
            label: label.into(),
            includes: includes.into(),
            spec: spec.clone(),
            modelling,
        }
    };
    [
        with(
            "ISO 6336-1",
            "c' of the norm with its 0.8, CR = 1, parabola with the norm's mean; for 100 N/mm and more",
            PairStiffness::Iso6336 {
                variation: IsoVariation::IsoMean,
            },
        ),
        with(
            "analytic",
            "Weber-Banaschek tooth, Sainsot-Velex body, linear Hertz contact, in series",
            PairStiffness::Compliance {
                tooth: ToothModel::WeberBanaschek,
                foundation: Foundation::SainsotVelex(RootLength::default()),
                hertz: Hertz::Linear,
            },
        ),
    ]
}

/// What the stiffness of a modelling includes, in words.
#[must_use]
pub fn includes(modelling: &Modelling, models: &[Model]) -> String {
    let mut gears = (modelling.gears.iter()).map(|g| properties_of(models, &g.id));
    let all_rigid = gears.clone().all(|p| p.rigid);
    let contact = modelling.contacts.first();
    if gears.any(|p| p.full_order) {
        let penalty = contact.and_then(|c| c.points).map_or(String::new(), |p| {
            format!(", penalty {:.1e} Pa/m", p.penalty)
        });
        return format!("teeth, body to the rigid bore, contact over the mesh{penalty}");
    }
    let law = contact.map_or(String::new(), |c| c.stiffness.describe());
    if all_rigid {
        law
    } else {
        format!("the model's own springs in series with {law}")
    }
}

/// Solves one entry.
///
/// # Errors
/// [`StaticsError`] of its assembly or of a position.
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
        cycle,
        unknowns: pair.unknowns(),
        work: pair.work(),
        wall: [setup, start.elapsed().as_secs_f64()],
    })
}

/// The error of an assembly, if that is what went wrong.
#[must_use]
pub fn build_error(e: &StaticsError) -> Option<&BuildError> {
    match e {
        StaticsError::Build(e) => Some(e),
        _ => None,
    }
}

impl Row {
    /// Position over the base pitch from the pitch point.
    fn relative(&self, s: f64) -> f64 {
        (s - self.cycle.pitch_point) / self.cycle.base_pitch
    }

    /// What the chart draws.
    #[must_use]
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

    /// The cycle as a table, SI units in the header.
    #[must_use]
    pub fn csv(&self) -> String {
        let c = &self.cycle;
        let offsets = c.positions.iter().flat_map(|p| &p.pairs).map(|p| p.offset);
        let (low, high) = offsets.fold((0, 0), |(a, b), j| (a.min(j), b.max(j)));
        let mut text = String::from(
            "path_coordinate_m,position_base_pitches,transmission_error_m,force_n,secant_n_per_m,tangent_n_per_m",
        );
        for j in low..=high {
            text.push_str(&format!(",force_pair_{j}_n"));
        }
        text.push('\n');
        for (p, tangent) in c.positions.iter().zip(&c.tangent) {
            text.push_str(&format!(
                "{:.9e},{:.6},{:.9e},{:.9e},{:.9e},{:.9e}",
                p.s,
                self.relative(p.s),
                p.approach,
                p.force,
                p.force / p.approach,
                tangent
            ));
            for j in low..=high {
                text.push_str(&format!(",{:.9e}", p.pair(j)));
            }
            text.push('\n');
        }
        text
    }
}

/// One line per row, SI units in the header.
#[must_use]
pub fn summary_csv(rows: &[Row]) -> String {
    let mut text = String::from(
        "model,single_stiffness_n_per_m2,at_pitch_point_n_per_m2,mesh_stiffness_n_per_m2,mesh_tangent_n_per_m2,transmission_error_mean_m,transmission_error_peak_to_peak_m,unknowns,equilibria,newton_iterations,setup_s,solve_s,includes\n",
    );
    for r in rows {
        let c = &r.cycle;
        text.push_str(&format!(
            "{},{:.6e},{:.6e},{:.6e},{:.6e},{:.6e},{:.6e},{},{},{},{:.3},{:.3},\"{}\"\n",
            r.label,
            c.single_stiffness(),
            c.at_pitch_point(),
            c.mesh_stiffness(),
            c.mesh_tangent(),
            c.mean_error(),
            c.peak_to_peak(),
            r.unknowns,
            r.work[0],
            r.work[1],
            r.wall[0],
            r.wall[1],
            r.includes.replace('"', "'")
        ));
    }
    text
}
