//! Buffers of a scene.

use super::active::{Active, ContactCoupling, Tangent};
use super::carriers::CarrierFrameState;
use super::condensed::CondensedCorrection;
use super::low_rank::LowRank;
use super::nodal::{Nodal, ReducedTangent};
use super::shafts::ShaftWork;
use crate::contact::Candidate;
use crate::contact::pairs::{LoadedPair, PairList};
use crate::kinematics::Row;
use gearbench_integrators::system::{State, StateView};

/// State of the last evaluation of the contacts.
#[derive(Default)]
pub(super) struct EvaluatedState {
    state: State,
    valid: bool,
}

impl EvaluatedState {
    /// Returns true if the stored contacts are those at a state.
    pub fn is(&self, at: StateView<'_>) -> bool {
        let s = &self.state;
        self.valid && s.t == at.t && s.q == at.q && s.v == at.v && s.discrete == at.discrete
    }

    /// Marks the stored contacts as those at a state.
    pub fn keep(&mut self, at: StateView<'_>) {
        let s = &mut self.state;
        s.t = at.t;
        for (own, given) in [
            (&mut s.q, at.q),
            (&mut s.v, at.v),
            (&mut s.discrete, at.discrete),
        ] {
            own.clear();
            own.extend_from_slice(given);
        }
        self.valid = true;
    }

    /// Marks the stored contacts as out of date.
    pub fn forget(&mut self) {
        self.valid = false;
    }
}

/// Buffers of a scene; they grow to the largest number of contacts and are reused.
#[derive(Default)]
pub(super) struct Workspace {
    pub candidates: Vec<Candidate>,
    /// Candidates before a zone transition.
    pub listed: Vec<Candidate>,
    pub active: Vec<Active>,
    /// Pairs of one line whose forces need no candidates.
    pub pressed: Vec<LoadedPair>,
    /// Lists of pairs, by mesh.
    pub pair_lists: Vec<PairList>,
    /// Tangents of the active contacts, where these were requested.
    pub tangents: Vec<Tangent>,
    /// Couplings of the active contacts through bodies.
    pub couplings: Vec<ContactCoupling>,
    /// Rows of each active contact: normal, sliding, sliding one metre further along the normal, and motion along the
    /// path where that is no part of the first.
    pub rows: Vec<[Row; 4]>,
    pub condensed: CondensedCorrection,
    pub shafts: ShaftWork,
    /// Carrier-frame state.
    pub relative: CarrierFrameState,
    /// Contacts of gears with fields.
    pub nodal: Nodal,
    /// Tangent of contacts of gears with fields.
    pub reduced: ReducedTangent,
    /// Newton correction: terms of contacts and links.
    pub low_rank: LowRank,
    pub rhs: Vec<f64>,
    /// Forces along the path from the compliance between contacts: index of the contact, and force.
    pub along_path: Vec<(usize, f64)>,
    /// Friction at an accepted state: cell, normal force, fraction of the sliding force.
    pub reached: Vec<(usize, f64, f64)>,
    /// State of the last report, while the contacts are still those at it.
    pub reported: EvaluatedState,
    /// Row for a single gap rate.
    pub scratch: Row,
}

impl Workspace {
    /// Returns the couplings of a contact to those on the same body; couplings are in the order of the contacts.
    pub fn couplings_of(&self, contact: usize) -> &[ContactCoupling] {
        let from = self.couplings.partition_point(|a| a.of < contact);
        let to = from + self.couplings[from..].partition_point(|a| a.of == contact);
        &self.couplings[from..to]
    }
}
