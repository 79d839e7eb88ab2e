//! Theoretical limits as lines over the step.

use super::linearised::Linearised;
use super::{LimitError, LineKind, StepLine, first_unstable};
use gearbench_integrators::MethodSpec;
use gearbench_integrators::linear_stability::{Impulses, Stability};
use nalgebra::DMatrix;
use std::f64::consts::PI;

/// Multiples of pi that are marked.
const RESONANCES: u32 = 3;

impl Linearised {
    /// Lines over the fixed step of a method, named as in a scene: the largest stable step, the resonances of the
    /// trigonometric method, the limit that the penalty alone would set. None for methods that choose their steps; no
    /// [`LineKind::Stability`] for those that are stable at every step.
    pub fn lines(&mut self, method: MethodSpec) -> Result<Vec<StepLine>, LimitError> {
        let stability = method.stability();
        let mut lines = Vec::new();
        if let Some(step_s) = self.largest_step(&stability)? {
            lines.push(StepLine {
                label: format!("stability limit of {}", method.info().name),
                step_s,
                kind: LineKind::Stability,
            });
        }
        if let Stability::Impulses(_) = &stability
            && let Some(omega) = self.oscillators()
        {
            let highest = omega.into_iter().fold(0.0, f64::max);
            for k in (1..=RESONANCES).filter(|_| highest > 0.0) {
                lines.push(StepLine {
                    label: match k {
                        1 => "fastest mode: omega h = pi".into(),
                        k => format!("fastest mode: omega h = {k} pi"),
                    },
                    step_s: f64::from(k) * PI / highest,
                    kind: LineKind::Resonance,
                });
            }
        }
        let penalty = self
            .penalty_frequency()
            .and_then(|w| stability.largest_step(w, 0.0));
        if let Some(step_s) = penalty {
            lines.push(StepLine {
                label: "limit of the penalty alone, sqrt(k/m)".into(),
                step_s,
                kind: LineKind::Penalty,
            });
        }
        Ok(lines)
    }

    /// Returns the largest stable step [s]; `None` where every step is stable, or where no limit is marked: for the
    /// trigonometric method no limit below the first resonance.
    pub fn largest_step(&mut self, stability: &Stability) -> Result<Option<f64>, LimitError> {
        match stability {
            Stability::Impulses(impulses) => self.largest_impulse_step(*impulses),
            Stability::Controlled | Stability::Unconditional => Ok(None),
            other => self.linear()?.largest_step(other),
        }
    }

    /// Returns the largest step between impulses, up to the first resonance: where `2 + 2 cos - h^2 S F K_c F S` loses
    /// definiteness.
    fn largest_impulse_step(&mut self, impulses: Impulses) -> Result<Option<f64>, LimitError> {
        let Some(omega) = self.oscillators() else {
            return Ok(None);
        };
        // Without the forces that the method filters.
        let rest = self.rest(&omega, impulses, f64::MIN_POSITIVE)?;
        let stiffest = rest.symmetric_eigenvalues().max();
        if stiffest <= 0.0 {
            return Ok(None);
        }
        let highest = omega.iter().copied().fold(0.0, f64::max);
        let mut stable = |h: f64| -> Result<bool, LimitError> {
            let Some(weights) = omega
                .iter()
                .map(|w| impulses.weights(*w, h))
                .collect::<Option<Vec<_>>>()
            else {
                return Ok(false);
            };
            let rest = self.rest(&omega, impulses, h)?;
            let n = omega.len();
            let matrix = DMatrix::from_fn(n, n, |i, j| {
                let own = if i == j { weights[i][0] } else { 0.0 };
                own - weights[i][1] * weights[j][1] * rest[(i, j)]
            });
            Ok(matrix.cholesky().is_some())
        };
        let last = if highest > 0.0 {
            PI / highest
        } else {
            f64::INFINITY
        };
        // Each look takes the matrix at its step: begin near where the contact alone or the first resonance ends.
        let from = 0.25 * last.min(2.0 / stiffest.sqrt());
        let to = last.min(1e3 / stiffest.sqrt());
        first_unstable([from, to], |h| stable(h).map(|stable| !stable))
    }
}
