//! Buffers of a scene.

use super::active::{Active, Answer, Tangent};
use super::condensed::Condensed;
use super::nodal::{Nodal, Reduced};
use crate::contact::Candidate;
use crate::kinematics::Row;

/// Buffers; they grow to the largest number of contacts and stay.
#[derive(Default)]
pub(super) struct Workspace {
    pub candidates: Vec<Candidate>,
    /// Candidates before a zone switch.
    pub listed: Vec<Candidate>,
    pub active: Vec<Active>,
    /// Their tangents, where these were asked for.
    pub tangents: Vec<Tangent>,
    /// How they answer to each other through bodies.
    pub answers: Vec<Answer>,
    /// Three rows per active contact: normal, sliding, sliding one metre further along the normal.
    pub rows: Vec<[Row; 3]>,
    pub condensed: Condensed,
    /// Contacts of gears with fields.
    pub nodal: Nodal,
    /// Their tangent.
    pub reduced: Reduced,
    /// Newton correction: rows V, columns Z, small matrix, small vector.
    pub v: Vec<f64>,
    pub z: Vec<f64>,
    pub small: Vec<f64>,
    pub rhs: Vec<f64>,
    /// Forces along the path by compliance between contacts: whose, and how much.
    pub along_path: Vec<(usize, f64)>,
    /// Friction at an accepted state: cell, normal force, part of the sliding force.
    pub reached: Vec<(usize, f64, f64)>,
    /// Row for a gap rate on its own.
    pub scratch: Row,
}
