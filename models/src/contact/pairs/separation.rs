//! Separation of a gear's flank from the involute of its mate, over the gear's own path coordinate.
//!
//! While the involutes touch on the line of action, the gap is `L - s_a - s_b`. Modified flanks, and tips beyond the
//! end of the path, have the separation
//!
//! ```text
//! e(s) = min over rho <= rho_tip of  d(rho) + s_m(P(rho, s)) + s - L
//! ```
//!
//! with `d` the material removed at the length of roll `rho`, `P(rho, s)` the point of the flank there when the flank's
//! path coordinate is `s`, and `s_m` the path coordinate of the mate's involute through that point. An involute that turns
//! moves parallel to itself, so `e` depends on `s` alone and is exact whatever the mate's position; the gap
//! `L - s_a - s_b + e_a(s_a) + e_b(s_b)` is exact where one of both is the plain involute. Beyond the tip (`s > rho_tip`)
//! the edge of the tip slides on the mate's flank: `e` leaves zero with slope zero, so that a force grows from nothing when
//! a pair comes in before the path of contact, and goes to nothing when it leaves behind it (contact off the line of
//! action; R. G. Munro, L. Morrish, D. Palmer, *Proc. IMechE C* 213 (1999) 431-440). With the slope of `e` as the scale of
//! the gear's contact row, the force is the derivative of a potential.
//!
//! Frame: the line of action is the y axis, its origin the gear's tangent point; the gear's centre lies at `(-r_b, 0)`, its
//! mate's at `(r_m, L)`. A rack is the limit of an infinite radius: its flank moves parallel to its pitch line. Beyond it, an
//! internal gear has a negative base radius, lengths of roll and path coordinates below zero, and the same equations.

/// Number of samples of a separation beyond the tip.
const EDGE_SAMPLES: usize = 49;

/// Number of lengths of roll in the first search for the smallest separation.
const TRIED: usize = 33;

/// Separation up to which a tip edge is followed, in base pitches: several times the deflection of any loaded mesh.
const FOLLOWED: f64 = 0.03;

/// Geometry of a gear's tooth and its mate's in engagement.
#[derive(Clone, Copy, Debug)]
pub struct Engagement {
    /// Base radius of the gear [m], negative for an internal gear; `None` for a rack.
    pub base_radius: Option<f64>,
    /// Base radius of its mate [m]; `None` for a rack.
    pub mate_base_radius: Option<f64>,
    /// Distance between the tangent points [m].
    pub length: f64,
    /// Length of roll at the tip of the gear, on its own path coordinate [m].
    pub tip: f64,
    /// Length of roll at the tip of the mate, on its own path coordinate [m].
    pub mate_tip: f64,
    /// Transverse working pressure angle [rad].
    pub pressure_angle: f64,
    /// Cosine of the base helix angle.
    pub helix_cos: f64,
    /// Base pitch of both gears [m].
    pub base_pitch: f64,
}

impl Engagement {
    /// Returns the point of roll `rho` at path coordinate `s`, and its derivative by `s`.
    fn point(&self, rho: f64, s: f64) -> ([f64; 2], [f64; 2]) {
        match self.base_radius {
            Some(rb) => {
                let (sin, cos) = ((s - rho) / rb).sin_cos();
                // From the gear's centre.
                let x = rb * cos - rho * sin;
                let y = rb * sin + rho * cos;
                ([x - rb, y], [-y / rb, x / rb])
            }
            None => {
                let slope = self.pressure_angle.tan();
                ([-slope * (s - rho), s], [-slope, 1.0])
            }
        }
    }

    /// Returns the distance beyond the tip over which its edge is followed on the mate's flank [m]: up to a separation
    /// that no load closes, or to the tip of the mate.
    pub fn followed(&self) -> f64 {
        let follows = |u: f64| {
            self.of_point(self.tip, self.tip + u)
                .is_some_and(|e| e.0 <= FOLLOWED * self.base_pitch)
        };
        let (mut near, mut far) = (0.0, 0.5 * self.base_pitch);
        for _ in 0..50 {
            let middle = 0.5 * (near + far);
            if follows(middle) {
                near = middle;
            } else {
                far = middle;
            }
        }
        // Never of no length, so that a table over it has a step.
        near.max(1e-6 * self.base_pitch)
    }

    /// Returns the separation of the point of roll `rho` from the mate's involute in the transverse plane at path
    /// coordinate `s` [m], and its derivative by `s`; `None` beyond the mate's involute.
    fn of_point(&self, rho: f64, s: f64) -> Option<(f64, f64)> {
        let (p, dp) = self.point(rho, s);
        let Some(rm) = self.mate_base_radius else {
            // A straight flank across the line of action.
            return Some((s - p[1], 1.0 - dp[1]));
        };
        let (x, y) = (p[0] - rm, p[1] - self.length);
        let square = x * x + y * y - rm * rm;
        let reach = rm * rm + self.mate_tip * self.mate_tip;
        let beyond = match rm > 0.0 {
            true => x * x + y * y > reach * (1.0 + 1e-9),
            false => x * x + y * y < reach * (1.0 - 1e-9),
        };
        if square <= 0.0 || beyond {
            return None;
        }
        let roll = square.sqrt().copysign(rm);
        // Angle from where this point of the involute lies on the line of action, at (-rm, -roll).
        let turned = (-rm * y + roll * x).atan2(-rm * x - roll * y);
        let (sin, cos) = turned.sin_cos();
        let along = -dp[0] * sin + dp[1] * cos;
        Some((roll + rm * turned + s - self.length, 1.0 - along))
    }

    /// Returns the minimum of removed material plus separation over the flank up to its tip: value and slope by `s`
    /// [m], both normal to the flanks.
    fn least(&self, s: f64, removed: &impl Fn(f64) -> f64) -> Option<(f64, f64)> {
        let at = |rho: f64| {
            self.of_point(rho, s)
                .map(|(e, slope)| (removed(rho) + self.helix_cos * e, self.helix_cos * slope))
        };
        let value = |rho: f64| at(rho).map_or(f64::INFINITY, |e| e.0);
        let beside = 0.05 * self.base_pitch;
        let high = (s + beside).min(self.tip);
        let low = s.min(self.tip) - beside;
        let step = (high - low) / (TRIED - 1) as f64;
        let tried = |i: usize| low + i as f64 * step;
        let best = (0..TRIED).min_by(|i, j| value(tried(*i)).total_cmp(&value(tried(*j))))?;
        let (mut a, mut b) = (
            tried(best.saturating_sub(1)),
            tried((best + 1).min(TRIED - 1)),
        );
        // Golden section: removed material may have a kink.
        let part = 0.5 * (5.0_f64.sqrt() - 1.0);
        for _ in 0..60 {
            let (x, y) = (b - part * (b - a), a + part * (b - a));
            if value(x) <= value(y) {
                b = y;
            } else {
                a = x;
            }
        }
        // The tip itself is a candidate that golden section only comes close to.
        let inside = 0.5 * (a + b);
        let rho = if value(high) <= value(inside) {
            high
        } else {
            inside
        };
        at(rho).filter(|e| e.0.is_finite())
    }
}

/// Separation over the path coordinate of the gear: zero up to the tip on a plain involute.
#[derive(Clone, Debug)]
pub struct Separation {
    /// Separation of a modified flank, up to the tip.
    flank: Option<Table>,
    /// Separation of the tip edge, beyond the tip.
    edge: Table,
}

impl Separation {
    /// Computes the separation of a gear in mesh. `removed` is the material removed over the length of roll [m] of a
    /// modified flank, sampled `samples` times from `start` to the tip.
    pub fn new(
        of: &Engagement,
        start: f64,
        samples: usize,
        removed: Option<&dyn Fn(f64) -> f64>,
    ) -> Self {
        let plain = |_: f64| 0.0;
        let removed_or_none: &dyn Fn(f64) -> f64 = removed.unwrap_or(&plain);
        let least = |s: f64| of.least(s, &removed_or_none);
        let at_tip = least(of.tip).map_or(0.0, |e| e.0);
        let sample = |s: f64, _: usize| least(s).unwrap_or((at_tip, 0.0));
        // The tip of the mate is described by the mate's own edge.
        let on_flank = |s: f64, _: usize| {
            let unending = Engagement {
                mate_tip: match of.mate_base_radius {
                    Some(rm) if rm < 0.0 => 0.0,
                    _ => f64::INFINITY,
                },
                ..*of
            };
            unending.least(s, &removed_or_none).unwrap_or((at_tip, 0.0))
        };
        Separation {
            flank: removed.map(|_| Table::sample([start, of.tip], samples, on_flank)),
            edge: Table::sample([of.tip, of.tip + of.followed()], EDGE_SAMPLES, |s, i| {
                if i == 0 && removed.is_none() {
                    (0.0, 0.0)
                } else {
                    sample(s, i)
                }
            }),
        }
    }

    /// Returns the separation with a constant amount of additional removed material [m].
    #[must_use]
    pub fn raised(&self, by: f64) -> Self {
        let mut raised = self.clone();
        if by != 0.0 {
            for table in [raised.flank.as_mut(), Some(&mut raised.edge)]
                .into_iter()
                .flatten()
            {
                for (value, _) in &mut table.samples {
                    *value += by;
                }
            }
        }
        raised
    }

    /// Returns true if the separation is zero up to the tip.
    pub fn is_plain(&self) -> bool {
        self.flank.is_none()
    }

    /// Returns the length of roll at the tip, and the path coordinate up to which the edge is followed [m].
    pub fn edge(&self) -> [f64; 2] {
        [self.edge.start, self.edge.end()]
    }

    /// Returns a lower bound of the separation [m].
    pub fn lowest(&self) -> f64 {
        // The deviation at the edge only increases the gap.
        self.flank.as_ref().map_or(0.0, Table::lowest)
    }

    /// Returns value [m], slope [-] and curvature [1/m] at `s`.
    #[inline]
    pub fn eval(&self, s: f64) -> [f64; 3] {
        if s > self.edge.start {
            return self.edge.eval(s);
        }
        match &self.flank {
            None => [0.0; 3],
            Some(flank) => flank.eval(s),
        }
    }
}

/// Values and slopes at equal steps, with cubic (Hermite) interpolation and linear extrapolation.
#[derive(Clone, Debug)]
struct Table {
    start: f64,
    step: f64,
    samples: Vec<(f64, f64)>,
}

impl Table {
    fn sample(
        [start, end]: [f64; 2],
        samples: usize,
        mut f: impl FnMut(f64, usize) -> (f64, f64),
    ) -> Self {
        let step = (end - start) / (samples - 1) as f64;
        Table {
            start,
            step,
            samples: (0..samples)
                .map(|i| f(start + i as f64 * step, i))
                .collect(),
        }
    }

    fn end(&self) -> f64 {
        self.start + self.step * (self.samples.len() - 1) as f64
    }

    /// Returns a lower bound of the table, including a tenth of its length beyond both ends.
    fn lowest(&self) -> f64 {
        let span = self.end() - self.start;
        let beyond = [-0.1, 1.1].map(|x| self.eval(self.start + x * span)[0]);
        let values = self.samples.iter().map(|s| s.0).chain(beyond);
        // A cubic swings below its samples by no more than its slopes allow.
        let steepest = self.samples.iter().map(|s| s.1.abs()).fold(0.0, f64::max);
        values.fold(f64::INFINITY, f64::min) - 0.5 * steepest * self.step
    }

    #[inline]
    fn eval(&self, s: f64) -> [f64; 3] {
        let last = self.samples.len() - 1;
        let x = (s - self.start) / self.step;
        if x <= 0.0 {
            let (value, slope) = self.samples[0];
            return [value + slope * (s - self.start), slope, 0.0];
        }
        if x >= last as f64 {
            let (value, slope) = self.samples[last];
            return [value + slope * (s - self.end()), slope, 0.0];
        }
        let i = x as usize;
        let u = x - i as f64;
        let ((p0, m0), (p1, m1)) = (self.samples[i], self.samples[i + 1]);
        let h = self.step;
        let d = p1 - p0;
        let (a, b) = (h * m0 - d, d - h * m1);
        let r = 1.0 - u;
        let value = p0 + u * d + u * r * (r * a + u * b);
        let slope = d + (1.0 - 2.0 * u) * (r * a + u * b) + u * r * (b - a);
        let curvature = -2.0 * (r * a + u * b) + 2.0 * (1.0 - 2.0 * u) * (b - a);
        [value, slope / h, curvature / (h * h)]
    }
}

#[cfg(test)]
mod tests;
