//! Functions that are defined for any gear by its capabilities: free functions, and methods of `dyn GearModel`.

use super::capabilities::ToothCoordinates;
use super::flank_displacement::FlankDisplacement;
use super::model::GearModel;
use crate::geometry::Flanks;
use crate::kinematics::Tooth;
use gearbench_integrators::system::{Coeffs, Singular, StateView};

/// Returns the work of a steady `load` on the hub of a gear between two states [J].
pub fn work_on_hub(gear: &dyn GearModel, from: StateView<'_>, to: StateView<'_>, load: f64) -> f64 {
    if !gear.hub().is_free() || load == 0.0 {
        return 0.0;
    }
    load * (gear.hub_state(to).displacement - gear.hub_state(from).displacement)
}

/// Computes [`LargeGear::condensed`](super::LargeGear::condensed) for any gear, with one solve per coordinate.
pub fn condensed(
    gear: &mut dyn GearModel,
    at: StateView<'_>,
    c: Coeffs,
    hub_damping: f64,
    coordinates: &[u32],
    g: &mut [f64],
) -> Result<(), Singular> {
    if let Some(large) = gear.large() {
        return large.condensed(at, c, hub_damping, coordinates, g);
    }
    let mut x = vec![0.0; at.q.len()];
    condense_by(&mut x, coordinates, g, |x| {
        gear.correct(at, c, hub_damping, x)
    })
}

/// Computes [`LargeGear::add_response`](super::LargeGear::add_response) for any gear, with one solve.
pub fn add_response(
    gear: &mut dyn GearModel,
    at: StateView<'_>,
    c: Coeffs,
    hub_damping: f64,
    touched: (&[u32], &[f64]),
    x: &mut [f64],
) -> Result<(), Singular> {
    if let Some(large) = gear.large() {
        return large.add_response(at, c, hub_damping, touched, x);
    }
    respond_by(touched, x, |y| gear.correct(at, c, hub_damping, y))
}

/// Restricts a matrix to some coordinates, column by column; `solve` applies the matrix in place, `x` is work space.
pub fn condense_by(
    x: &mut [f64],
    coordinates: &[u32],
    g: &mut [f64],
    mut solve: impl FnMut(&mut [f64]) -> Result<(), Singular>,
) -> Result<(), Singular> {
    let n = coordinates.len();
    for (j, &unit) in coordinates.iter().enumerate() {
        x.fill(0.0);
        x[unit as usize] = 1.0;
        solve(x)?;
        for (i, &coordinate) in coordinates.iter().enumerate() {
            g[i * n + j] = x[coordinate as usize];
        }
    }
    Ok(())
}

/// Adds the response of a matrix to entries at some coordinates; `solve` applies the matrix in place.
pub fn respond_by(
    (coordinates, forces): (&[u32], &[f64]),
    x: &mut [f64],
    mut solve: impl FnMut(&mut [f64]) -> Result<(), Singular>,
) -> Result<(), Singular> {
    let mut y = vec![0.0; x.len()];
    for (&i, f) in coordinates.iter().zip(forces) {
        y[i as usize] += f;
    }
    solve(&mut y)?;
    for (x, y) in x.iter_mut().zip(&y) {
        *x += y;
    }
    Ok(())
}

impl dyn GearModel + '_ {
    /// Returns the grids of the flanks, if the gear has any.
    pub fn flanks(&self) -> Option<&Flanks> {
        self.surface().map(|s| s.flanks)
    }

    /// Returns the flank displacement operator, if the gear has one.
    #[inline]
    pub fn displacement(&self) -> Option<&dyn FlankDisplacement> {
        self.surface()?.displacement
    }

    /// Returns the angle or displacement of a tooth from its assembled position.
    pub fn tooth_displacement(&self, at: StateView<'_>, tooth: Tooth) -> f64 {
        match self.teeth() {
            Some(teeth) => teeth.displacement(at, tooth),
            None => self.hub().displacement_at(at),
        }
    }

    /// Returns true if the tooth springs depend on the contact radius.
    pub fn follows_contact(&self) -> bool {
        self.teeth().is_some_and(ToothCoordinates::follows_contact)
    }
}
