//! Jumps of the speed of a hub that the host moves: accelerations of zero duration.

use crate::instance::Instance;
use gearbench_integrators::SecondOrderSystem;
use gearbench_models::spec::Profile;

/// Acceleration of a hub for the difference quotient of forces [rad/s^2] or [m/s^2]: forces are linear in it.
const SHAKE: f64 = 1e6;

impl Instance {
    /// Changes speeds by a jump of the speed of a hub: `M^-1 df/da` times the jump, with the accelerations `a` that a motion
    /// prescribes. Bodies whose coordinates do not move in the frame of the hub stay as they are.
    pub(crate) fn apply_speed_jump(&mut self, member: usize, motion: &Profile, jump: f64) {
        if jump == 0.0 {
            return;
        }
        let s = &mut self.memory.state;
        let scene = &mut self.coupled.scene;
        let (place, speed) = (motion.integral(s.t), motion.value(s.t));
        let mut under = |acceleration: f64| {
            let integral = [place, speed, 0.5 * acceleration, 0.0];
            scene.drive(
                member,
                Profile::Polynomial {
                    from: s.t,
                    integral,
                },
            );
            let mut a = vec![0.0; s.q.len()];
            scene.force(s.at(), &mut a);
            scene.solve_mass(s.at(), &mut a);
            a
        };
        let (rest, moved) = (under(0.0), under(SHAKE));
        for ((v, rest), moved) in s.v.iter_mut().zip(rest).zip(moved) {
            *v += jump * ((moved - rest) / SHAKE);
        }
    }
}
