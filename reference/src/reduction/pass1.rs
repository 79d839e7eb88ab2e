//! Pass 1 as a whole: modes and static compliance of a gear, computed once and kept.

use super::compliance;
use super::store::Request;
use super::surface::Surface;
use super::{Basis, ReductionError, basis};

/// What is being computed, for whoever waits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Modes.
    Modes,
    /// Static compliance.
    Compliance,
}

impl Stage {
    /// In words.
    #[must_use]
    pub fn text(self) -> &'static str {
        match self {
            Stage::Modes => "modes",
            Stage::Compliance => "static compliance",
        }
    }
}

/// Computes what is asked for; `begin` hears of each stage.
///
/// # Errors
/// [`ReductionError`]: no flanks, bad elements, a body in pieces, modes that cannot be found.
pub fn compute(
    request: &Request<'_>,
    begin: &mut dyn FnMut(Stage),
) -> Result<Basis, ReductionError> {
    let Request {
        mesh,
        sector,
        material,
        mounting,
        wanted,
        compliance: with_compliance,
    } = *request;
    begin(Stage::Modes);
    let mut found = match sector {
        true => basis::of_sector(mesh, &material, &mounting, wanted)?,
        false => basis::of_mesh(mesh, &material, &mounting, wanted)?,
    };
    if with_compliance {
        begin(Stage::Compliance);
        found.compliance = Some(match sector {
            true => {
                let surface = Surface::of_sector(mesh)?;
                compliance::of_sector(mesh, &material, &surface, &mounting)?
            }
            false => compliance::of_mesh(mesh, &material, &Surface::new(mesh)?, &mounting)?,
        });
    }
    Ok(found)
}

impl Basis {
    /// The basis with some of its modes only, ascending; the compliance is that of the whole mesh as before.
    #[must_use]
    pub fn with_modes(&self, kept: &[usize]) -> Basis {
        let modes = self.omega.len();
        let pick = |x: &[f64]| kept.iter().map(|&i| x[i]).collect();
        let rows = self.shapes.chunks_exact(modes.max(1));
        Basis {
            omega: pick(&self.omega),
            family: kept.iter().map(|&i| self.family[i]).collect(),
            shapes: rows.flat_map(|row| kept.iter().map(|&i| row[i])).collect(),
            hub: pick(&self.hub),
            participation: pick(&self.participation),
            ..self.clone()
        }
    }
}
