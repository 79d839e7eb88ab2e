//! Buffers of a scene.

use super::active::{Active, Answer, Tangent};
use super::carriers::RelativeState;
use super::condensed::Condensed;
use super::low_rank::LowRank;
use super::nodal::{Nodal, Reduced};
use super::shafts::ShaftWork;
use crate::contact::Candidate;
use crate::contact::pairs::{Pressed, Roster};
use crate::kinematics::Row;
use gearbench_integrators::system::{At, State};

/// A state whose contacts are at hand.
#[derive(Default)]
pub(super) struct Reported {
    state: State,
    valid: bool,
}

impl Reported {
    /// Whether the contacts at hand are those at a state.
    pub fn is(&self, at: At<'_>) -> bool {
        let s = &self.state;
        self.valid && s.t == at.t && s.q == at.q && s.v == at.v && s.discrete == at.discrete
    }

    /// They are.
    pub fn keep(&mut self, at: At<'_>) {
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

    /// They are not, or what they depend on changed.
    pub fn forget(&mut self) {
        self.valid = false;
    }
}

/// Buffers; they grow to the largest number of contacts and stay.
#[derive(Default)]
pub(super) struct Workspace {
    pub candidates: Vec<Candidate>,
    /// Candidates before a zone switch.
    pub listed: Vec<Candidate>,
    pub active: Vec<Active>,
    /// Pairs of one line whose forces need no candidates.
    pub pressed: Vec<Pressed>,
    /// Pairs that are looked at, by mesh.
    pub rosters: Vec<Roster>,
    /// Their tangents, where these were asked for.
    pub tangents: Vec<Tangent>,
    /// How they answer to each other through bodies.
    pub answers: Vec<Answer>,
    /// Rows per active contact: normal, sliding, sliding one metre further along the normal, and how it moves along the path
    /// where that is no part of the first.
    pub rows: Vec<[Row; 4]>,
    pub condensed: Condensed,
    pub shafts: ShaftWork,
    /// The state as seen from carriers.
    pub relative: RelativeState,
    /// Contacts of gears with fields.
    pub nodal: Nodal,
    /// Their tangent.
    pub reduced: Reduced,
    /// Newton correction: terms of contacts and links.
    pub low_rank: LowRank,
    pub rhs: Vec<f64>,
    /// Forces along the path by compliance between contacts: whose, and how much.
    pub along_path: Vec<(usize, f64)>,
    /// Friction at an accepted state: cell, normal force, part of the sliding force.
    pub reached: Vec<(usize, f64, f64)>,
    /// The state that was reported of last, while the contacts are still those at it.
    pub reported: Reported,
    /// Row for a gap rate on its own.
    pub scratch: Row,
}

impl Workspace {
    /// How a contact answers to those that bend the same body; answers stand in the order of the contacts.
    pub fn answers_of(&self, contact: usize) -> &[Answer] {
        let from = self.answers.partition_point(|a| a.of < contact);
        let to = from + self.answers[from..].partition_point(|a| a.of == contact);
        &self.answers[from..to]
    }
}
