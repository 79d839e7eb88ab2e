//! Series of steps and tolerances of an integrator, the coarsest first.

use gearbench_integrators::Scheme;
use gearbench_integrators::{Resolution, Stepping};

/// Steps as multiples of the step of the scene: coarse enough to fail, fine enough to converge.
pub const FACTORS: [f64; 8] = [16.0, 8.0, 4.0, 2.0, 1.0, 0.5, 0.25, 0.125];
/// Steps as multiples of the step of the scene for full finite elements, whose runs take seconds: the step of the scene
/// is near their stability limit.
pub const FULL_FACTORS: [f64; 3] = [4.0, 2.0, 1.0];
pub const RTOLS: [f64; 7] = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8];
/// Tolerances of the method that is exact for modes: of second order at contacts, it pays tenfold for the last.
pub const EXACT_RTOLS: [f64; 5] = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5];
/// Step of a method that a scene gives a tolerance only [s].
const STEP: f64 = 1e-6;

/// Series of resolutions of an integrator; `None` takes the defaults.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Resolutions {
    /// Steps as multiples of the step of the scene.
    pub factors: Option<Vec<f64>>,
    /// Steps [s], in place of factors.
    pub steps: Option<Vec<f64>>,
    pub rtols: Option<Vec<f64>>,
    /// True if the model has full finite elements.
    pub full: bool,
}

impl Resolutions {
    /// Returns the series of a method: steps where it has fixed ones, tolerances where it is adaptive; the method that
    /// is exact for modes and can do both has both.
    pub fn of(&self, method: &Scheme) -> Vec<Scheme> {
        let info = method.method.info();
        let both = info.stepping == Stepping::Both && info.linear_part;
        let with = |resolution| method.method.at(resolution);
        let mut series = Vec::new();
        if info.stepping == Stepping::Fixed || both {
            let base = method.resolution.step().unwrap_or(STEP);
            let usual: &[f64] = if self.full { &FULL_FACTORS } else { &FACTORS };
            let steps = match (&self.steps, &self.factors) {
                (Some(steps), _) => steps.clone(),
                // A series that a scene chose for its small models would take hours with full ones.
                (None, Some(factors)) if !self.full => factors.iter().map(|f| f * base).collect(),
                _ => usual.iter().map(|f| f * base).collect(),
            };
            series.extend(descending(steps).map(Resolution::Step));
        }
        if info.stepping != Stepping::Fixed {
            let usual: &[f64] = if both { &EXACT_RTOLS } else { &RTOLS };
            let rtols = self.rtols.clone().unwrap_or_else(|| usual.to_vec());
            series.extend(descending(rtols).map(Resolution::Tolerance));
        }
        series.into_iter().map(with).collect()
    }
}

fn descending(mut all: Vec<f64>) -> impl Iterator<Item = f64> {
    all.sort_by(|a, b| b.total_cmp(a));
    all.dedup();
    all.into_iter()
}

#[cfg(test)]
mod tests {
    use super::*;
    use gearbench_integrators::MethodSpec;
    use gearbench_integrators::table::{DOPRI5, NEWMARK, RK4, TRIGONOMETRIC};

    fn series(
        resolutions: &Resolutions,
        method: MethodSpec,
        resolution: Resolution,
    ) -> Vec<Resolution> {
        let method = method.at(resolution);
        let all = resolutions.of(&method);
        assert!(all.iter().all(|m| m.method == method.method));
        all.iter().map(|m| m.resolution).collect()
    }

    #[test]
    fn steps_or_tolerances_or_both() {
        let usual = Resolutions::default();
        let fixed = series(&usual, RK4, Resolution::Step(1e-6));
        assert_eq!(fixed.len(), FACTORS.len());
        assert_eq!(fixed[0], Resolution::Step(16e-6));
        let adaptive = series(&usual, DOPRI5, Resolution::Tolerance(1e-6));
        assert_eq!(adaptive, RTOLS.map(Resolution::Tolerance));
        let both = series(&usual, TRIGONOMETRIC, Resolution::Step(1e-6));
        assert_eq!(both.len(), FACTORS.len() + EXACT_RTOLS.len());
    }

    #[test]
    fn what_is_asked_for_replaces_the_defaults() {
        let asked = Resolutions {
            steps: Some(vec![1e-7, 4e-7, 1e-7]),
            rtols: Some(vec![1e-5]),
            ..Resolutions::default()
        };
        assert_eq!(
            series(&asked, NEWMARK, Resolution::Step(3e-6)),
            [Resolution::Step(4e-7), Resolution::Step(1e-7)]
        );
        assert_eq!(
            series(&asked, "bdf".parse().unwrap(), Resolution::Tolerance(1e-6)),
            [Resolution::Tolerance(1e-5)]
        );
        let factors = Resolutions {
            factors: Some(vec![0.5, 2.0]),
            ..Resolutions::default()
        };
        let steps = series(&factors, NEWMARK, Resolution::Step(1e-6));
        assert_eq!(steps, [Resolution::Step(2e-6), Resolution::Step(5e-7)]);
        let full = Resolutions {
            full: true,
            ..factors
        };
        let steps = series(&full, NEWMARK, Resolution::Step(1e-6));
        assert_eq!(steps, FULL_FACTORS.map(|f| Resolution::Step(f * 1e-6)));
    }
}
