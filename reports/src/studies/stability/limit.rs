//! The largest stable step of a map, compared with that of theory.

use super::{Cell, Columns, LineKind, Map};
use crate::record::Status;

/// Narrowest bracket of the largest stable step: its upper end over its lower end.
pub const BRACKET: f64 = 1.02;

/// True if a run became unstable. A run with an adhesive contact force has a force history that no contact has, but its
/// energy did not grow: it counts as stable.
#[must_use]
pub fn is_lost(status: Status) -> bool {
    status.is_failure() && status != Status::AdhesiveForce
}

/// The largest stable step at the scene's own parameters, with the next larger step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Limit {
    /// Largest step up to which every run was stable \[s\].
    pub stable_s: Option<f64>,
    /// The next larger one that was tried, which failed \[s\].
    pub unstable_s: Option<f64>,
    /// Status of the run at `unstable_s`.
    pub status: Option<Status>,
    /// True if some larger steps are stable again.
    pub holds_again: bool,
    /// Largest step up to which every run was within the tolerance \[s\].
    pub accurate_s: Option<f64>,
    /// Smallest step at which a contact pulled \[s\].
    pub pulls_from_s: Option<f64>,
}

impl Limit {
    /// Returns the step at which a further run narrows the bracket, the geometric mean of its ends; `None` once it is
    /// narrow enough.
    #[must_use]
    pub fn next(&self) -> Option<f64> {
        let (a, b) = (self.stable_s?, self.unstable_s?);
        (b / a > BRACKET).then(|| (a * b).sqrt())
    }
}

impl Map {
    /// Returns the largest stable step at the scene's own parameters; `None` for tolerances. Runs that were stopped for
    /// their many steps have no verdict on stability: those at the smallest steps are skipped.
    pub fn limit(&self) -> Option<Limit> {
        if self.columns != Columns::Step {
            return None;
        }
        let mut tried: Vec<&Cell> = self.row(self.own_row()).iter().collect();
        tried.extend(&self.refined);
        tried.sort_by(|a, b| a.at.total_cmp(&b.at));
        let first = tried.iter().position(|c| c.status != Status::Timeout)?;
        let tried = &tried[first..];
        let failed = tried.iter().position(|c| is_lost(c.status));
        let held = &tried[..failed.unwrap_or(tried.len())];
        let off = held.iter().position(|c| !c.status.holds());
        let accurate = &held[..off.unwrap_or(held.len())];
        Some(Limit {
            stable_s: held.last().map(|c| c.at),
            unstable_s: failed.map(|i| tried[i].at),
            status: failed.map(|i| tried[i].status),
            holds_again: failed.is_some_and(|i| tried[i..].iter().any(|c| !is_lost(c.status))),
            accurate_s: accurate.last().map(|c| c.at),
            pulls_from_s: (tried.iter())
                .find(|c| c.status == Status::AdhesiveForce)
                .map(|c| c.at),
        })
    }

    /// Returns the smallest step in a row at which the method is unstable by theory, with the label of the theory.
    pub fn theory(&self, row: usize) -> Option<(f64, &str)> {
        (self.lines.iter())
            .filter(|l| l.kind == LineKind::Stability)
            .filter_map(|l| Some(((*l.step_s.get(row)?)?, l.label.as_str())))
            .min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// Returns the largest stable step over that of theory, where both are known.
    pub fn ratio(&self) -> Option<f64> {
        let limit = self.limit()?;
        let (found, theory) = (limit.stable_s?, self.theory(self.own_row())?.0);
        limit.unstable_s.map(|_| found / theory)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::studies::stability::MapAxis;

    /// Returns a map of one axis whose own row ended as given, other rows converged.
    fn map(own: &[(f64, Status)]) -> Map {
        let at: Vec<f64> = own.iter().map(|x| x.0).collect();
        let cell = |at: f64, status| Cell {
            at,
            status,
            ..Cell::default()
        };
        let other = at.iter().map(|h| cell(*h, Status::Converged));
        let row = own.iter().map(|(h, s)| cell(*h, *s));
        Map {
            model: "rigid".into(),
            integrator: "rk4".into(),
            axes: vec![MapAxis {
                values: vec![0.1, 1.0],
                own: 1,
                ..MapAxis::default()
            }],
            cells: other.chain(row).collect(),
            at,
            duration_s: 1.0,
            ..Map::default()
        }
    }

    #[test]
    fn the_limit_is_below_the_first_failure() {
        use Status::{AdhesiveForce, BlowUp, Converged, EnergyGrowth, Inaccurate, Timeout};
        let mut m = map(&[
            (1e-8, Timeout),
            (1e-7, Converged),
            (5e-7, AdhesiveForce),
            (1e-6, Inaccurate),
            (1e-5, EnergyGrowth),
            (1e-4, Inaccurate),
            (1e-3, BlowUp),
        ]);
        m.validate().unwrap();
        let l = m.limit().unwrap();
        assert_eq!((l.stable_s, l.unstable_s), (Some(1e-6), Some(1e-5)));
        assert_eq!((l.status, l.accurate_s), (Some(EnergyGrowth), Some(1e-7)));
        assert!(l.holds_again && l.pulls_from_s == Some(5e-7));
        // Runs that close in move both ends.
        while let Some(h) = m.limit().unwrap().next() {
            let status = if h < 4.2e-6 { Inaccurate } else { BlowUp };
            m.refined.push(Cell {
                at: h,
                status,
                ..Cell::default()
            });
            assert!(m.refined.len() < 20);
        }
        let l = m.limit().unwrap();
        let (a, b) = (l.stable_s.unwrap(), l.unstable_s.unwrap());
        assert!(a < 4.2e-6 && 4.2e-6 <= b && b / a <= BRACKET, "{a} {b}");
    }

    #[test]
    fn ends_without_a_limit() {
        use Status::{BlowUp, Converged, Timeout};
        let all = map(&[(1e-7, Converged), (1e-6, Converged)]);
        let l = all.limit().unwrap();
        assert_eq!(
            (l.stable_s, l.unstable_s, l.next()),
            (Some(1e-6), None, None)
        );
        let none = map(&[(1e-7, BlowUp), (1e-6, BlowUp)]).limit().unwrap();
        assert_eq!((none.stable_s, none.unstable_s), (None, Some(1e-7)));
        assert_eq!(map(&[(1e-7, Timeout)]).limit(), None);
        let mut adaptive = map(&[(1e-7, Converged)]);
        adaptive.columns = Columns::Tolerance;
        assert_eq!(adaptive.limit(), None);
    }

    #[test]
    fn rows_run_over_the_first_axis_first() {
        let mut m = map(&[(1e-7, Status::Converged)]);
        m.axes.push(MapAxis {
            values: vec![5.0, 6.0, 7.0],
            own: 2,
            ..MapAxis::default()
        });
        assert_eq!((m.rows(), m.own_row()), (6, 5));
        assert_eq!(m.values(3), [1.0, 6.0]);
        assert!(m.validate().unwrap_err().contains("cells"));
    }

    #[test]
    fn what_is_not_finite_is_refused() {
        let mut m = map(&[(1e-7, Status::Converged)]);
        m.cells[0].error = Some(f64::NAN);
        assert!(m.validate().unwrap_err().contains("not finite"));
    }
}
