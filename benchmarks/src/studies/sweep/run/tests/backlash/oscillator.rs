//! Oscillator with backlash and its independent integration, the reference of the gears.

use std::f64::consts::TAU;

pub(super) const Z: f64 = 0.05;
pub(super) const FM: f64 = 0.1;

/// Parameters of a case of the oscillator.
#[derive(Clone, Copy)]
pub(super) struct Case {
    /// Name of the shipped scene, and the frequency there.
    pub(super) scene: &'static str,
    pub(super) w: f64,
    pub(super) e: f64,
    pub(super) fa: f64,
}

pub(super) const PARAMETRIC: Case = Case {
    scene: "backlash_parametric",
    w: 0.85,
    e: 0.2,
    fa: 0.0,
};
pub(super) const FORCED: Case = Case {
    scene: "backlash_forced",
    w: 0.8,
    e: 0.0,
    fa: 0.05,
};

/// Independent integration of the oscillator with fixed steps, divided where the contact opens or closes.
pub(super) struct IndependentOscillator {
    pub(super) case: Case,
    pub(super) w: f64,
    pub(super) t: f64,
    pub(super) x: [f64; 2],
}

impl IndependentOscillator {
    fn rate(&self, t: f64, [x, v]: [f64; 2], closed: bool) -> [f64; 2] {
        let g = if closed { x - 1.0 } else { 0.0 };
        let Case { e, fa, .. } = self.case;
        let cos = (self.w * t).cos();
        [
            v,
            FM + fa * self.w * self.w * cos - 2.0 * Z * v - (1.0 + e * cos) * g,
        ]
    }

    fn rk4(&self, h: f64, closed: bool) -> [f64; 2] {
        let add = |a: [f64; 2], k: [f64; 2], h: f64| [a[0] + h * k[0], a[1] + h * k[1]];
        let (t, x) = (self.t, self.x);
        let k1 = self.rate(t, x, closed);
        let k2 = self.rate(t + 0.5 * h, add(x, k1, 0.5 * h), closed);
        let k3 = self.rate(t + 0.5 * h, add(x, k2, 0.5 * h), closed);
        let k4 = self.rate(t + h, add(x, k3, h), closed);
        [0, 1].map(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
    }

    fn step(&mut self, mut h: f64) {
        while h > 0.0 {
            // On the boundary the sign of the speed decides between contact and separation.
            let off = self.x[0] - 1.0;
            let closed = off > 1e-13 || (off.abs() <= 1e-13 && self.x[1] > 0.0);
            let stays = |x: [f64; 2]| (x[0] > 1.0) == closed;
            let mut to = h;
            if !stays(self.rk4(h, closed)) {
                let (mut a, mut b) = (0.0, h);
                for _ in 0..60 {
                    let m = 0.5 * (a + b);
                    if stays(self.rk4(m, closed)) {
                        a = m;
                    } else {
                        b = m;
                    }
                }
                to = b;
            }
            self.x = self.rk4(to, closed);
            self.t += to;
            h = if to < h { h - to } else { 0.0 };
        }
    }

    /// Integrates on at another frequency with continuous phase, and returns the rms of the last of some periods.
    pub(super) fn at(&mut self, w: f64, periods: usize) -> f64 {
        self.t *= self.w / w;
        self.w = w;
        const STEPS: usize = 500;
        let h = TAU / w / STEPS as f64;
        for _ in 0..(periods - 1) * STEPS {
            self.step(h);
        }
        let x: Vec<f64> = (0..STEPS)
            .map(|_| {
                self.step(h);
                self.x[0]
            })
            .collect();
        let mean = x.iter().sum::<f64>() / STEPS as f64;
        (x.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / STEPS as f64).sqrt()
    }
}
