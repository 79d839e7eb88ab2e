//! The lines of action as a contact search: candidates, gaps, event functions of the contact zone.

use super::lines::{LinesOfAction, MeshedGears, ZONE_EVENTS, all_open};
use crate::Vec3;
use crate::contact::candidate::Candidate;
use crate::contact::gear_state::{CandidateSelection, GearState, ZoneChange};
use crate::geometry::Side;

impl LinesOfAction {
    /// Returns the number of contact slots, an upper bound of simultaneous candidates.
    pub fn slots(&self) -> usize {
        self.lines.len() * self.pairs
    }

    /// Returns the length of the discrete state of the search.
    pub fn discrete(&self) -> usize {
        2 * self.lines.len()
    }

    /// Returns the number of event functions of the search.
    pub fn event_count(&self) -> usize {
        if self.whole_mesh {
            0
        } else {
            ZONE_EVENTS * self.lines.len()
        }
    }

    /// Sets the discrete state from a state.
    pub fn begin(&self, a: GearState<'_>, b: GearState<'_>, discrete: &mut [f64]) {
        let gears = &MeshedGears::new(&a, &b);
        for (line, m) in self.lines.iter().zip(discrete.chunks_exact_mut(2)) {
            let (lo, hi) = self.zone_now(line, gears);
            m[0] = lo as f64;
            m[1] = hi as f64;
        }
    }

    /// Appends candidates.
    pub fn candidates(
        &self,
        a: GearState<'_>,
        b: GearState<'_>,
        discrete: &[f64],
        selection: CandidateSelection<'_>,
        out: &mut Vec<Candidate>,
    ) {
        let gears = &MeshedGears::new(&a, &b);
        let first = out.len();
        for (l, line) in self.lines.iter().enumerate() {
            let skip = match selection {
                CandidateSelection::Closed(modes) => {
                    all_open(&modes[2 * l * self.pairs..][..2 * self.pairs])
                }
                CandidateSelection::Touching(reach) => self.clearly_open(line, gears, reach),
                CandidateSelection::Listed | CandidateSelection::Watched(_) => false,
            };
            if skip {
                continue;
            }
            self.collect(l, gears, discrete, selection, out);
        }
        self.couple(&mut out[first..], |slot| match selection {
            CandidateSelection::Closed(modes) | CandidateSelection::Watched(modes) => {
                Some(modes[2 * slot] != 0.0)
            }
            CandidateSelection::Listed | CandidateSelection::Touching(_) => None,
        });
    }

    /// Computes the event functions of the discrete state, and the gaps [m] of all its pairs by slot; other entries of
    /// `gaps` are not changed.
    pub fn watch(
        &self,
        a: GearState<'_>,
        b: GearState<'_>,
        discrete: &[f64],
        event_functions: &mut [f64],
        gaps: &mut [f64],
    ) {
        let gears = &MeshedGears::for_gaps(&a, &b);
        if self.whole_mesh {
            for l in 0..self.lines.len() {
                let range = self.pairs_of(l, gears, discrete, true);
                self.gaps_of_pairs(l, range, gears, gaps);
            }
            return;
        }
        for (l, g) in event_functions.chunks_exact_mut(ZONE_EVENTS).enumerate() {
            let (lo, hi) = (discrete[2 * l] as i64, discrete[2 * l + 1] as i64);
            self.watch_line(l, (lo, hi), gears, g, gaps);
        }
    }

    /// Computes the event functions of the zone alone, without the gaps of [`Self::watch`].
    pub fn watch_zones(
        &self,
        a: GearState<'_>,
        b: GearState<'_>,
        discrete: &[f64],
        event_functions: &mut [f64],
    ) {
        let gears = &MeshedGears::new(&a, &b);
        for (l, zone) in event_functions.chunks_exact_mut(ZONE_EVENTS).enumerate() {
            self.watch_zone(l, gears, discrete, zone);
        }
    }

    /// Computes the event functions of one line.
    #[inline]
    pub(super) fn watch_zone(
        &self,
        l: usize,
        gears: &MeshedGears<'_>,
        discrete: &[f64],
        event_functions: &mut [f64],
    ) {
        let (lo, hi) = (discrete[2 * l] as i64, discrete[2 * l + 1] as i64);
        let place = |pair: i64| self.place(&self.lines[l], gears, pair);
        self.set_zone_events([lo - 1, lo, hi, hi + 1].map(place), event_functions);
    }

    /// Switches the zone at event function `i`.
    pub fn transition(&self, event: usize, discrete: &mut [f64]) -> ZoneChange {
        let l = event / ZONE_EVENTS;
        let slot = |p: f64| l * self.pairs + (p as i64).rem_euclid(self.pairs as i64) as usize;
        let m = &mut discrete[2 * l..2 * l + 2];
        let mut change = ZoneChange::default();
        match event % ZONE_EVENTS {
            0 => {
                change.left = Some(slot(m[1]));
                m[1] -= 1.0;
            }
            1 => {
                change.left = Some(slot(m[0]));
                m[0] += 1.0;
            }
            2 => {
                m[0] -= 1.0;
                change.entered = Some(slot(m[0]));
            }
            _ => {
                m[1] += 1.0;
                change.entered = Some(slot(m[1]));
            }
        }
        change
    }

    /// Returns the ends of the line of action of a flank [m], for figures.
    pub fn line(&self, side: Side) -> Option<[Vec3; 2]> {
        let line = self.lines.iter().find(|l| l.side == side)?;
        // A rack has no tangent point, and those of an internal gear are both on one side: the line is shown as far as the path
        // of contact reaches.
        let [start, end] = match self.mesh.views[1].base_radius {
            Some(_) if self.mesh.length > 0.0 => [0.0, self.mesh.length],
            Some(_) => self.mesh.zone,
            None => [0.0, 1.2 * self.mesh.zone[1]],
        };
        Some([start, end].map(|s| line.origin + s * line.transverse))
    }

    /// Returns the midpoint of the path of contact and of the width [m], and the normal from gear a to gear b there.
    pub fn middle_of(&self, side: Side) -> Option<(Vec3, Vec3)> {
        let mut lines = self.lines.iter().filter(|l| l.side == side);
        let (first, last) = (lines.next()?, lines.next_back());
        let origin = last.map_or(first.origin, |l| 0.5 * (first.origin + l.origin));
        let s = 0.5 * (self.zone[0] + self.zone[1]);
        Some((origin + s * first.transverse, first.normal))
    }

    /// Returns the flank side of a candidate.
    pub fn side_of(&self, c: &Candidate) -> Side {
        self.lines[c.slot / self.pairs].side
    }
}
