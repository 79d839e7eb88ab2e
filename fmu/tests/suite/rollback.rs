//! A host that restores an earlier state gets bit for bit the results of a run without the detour.

use crate::host::Fmu;
use crate::{packed, shipped};

/// Random numbers: xorshift64* (S. Vigna, ACM TOMS 42, 2016).
pub struct Random(pub u64);

impl Random {
    pub fn below(&mut self, n: u64) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 33) % n
    }

    pub fn unit(&mut self) -> f64 {
        self.below(1 << 30) as f64 / f64::from(1 << 30)
    }
}

const STEP: f64 = 1e-5;

/// Torque of the host at the start of step `i` [N m], interpolated linearly within each step.
fn torque(i: usize) -> f64 {
    4.0 * (0.02 * i as f64).sin()
}

/// A step of the run without rollback.
fn step(fmu: &Fmu, i: usize) -> Vec<u64> {
    fmu.set("pinion.torque", torque(i));
    fmu.set("pinion.torque_end", torque(i + 1));
    fmu.step(i as f64 * STEP, STEP);
    fmu.look().iter().map(|x| x.to_bits()).collect()
}

fn goes_back(scene: &str, model: &str, method: &str, sequences: usize) {
    let file = shipped(scene, model);
    let package = packed(&file, model, method, &[]);
    let [straight, astray] = [(); 2].map(|()| {
        let fmu = Fmu::stepping(&package);
        fmu.interpolate();
        fmu.initialise(0.0);
        fmu
    });
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let mut moved = false;
    for i in 0..sequences {
        let kept = astray.keep();
        let mut t = i as f64 * STEP;
        for _ in 0..=random.below(3) {
            if random.below(2) == 0 {
                astray.set("wheel.torque", 50.0 * (random.unit() - 0.5));
                astray.set("pinion.torque_end", 50.0 * (random.unit() - 0.5));
            }
            let size = STEP * (0.1 + 2.0 * random.unit());
            astray.step(t, size);
            t += size;
            if random.below(4) == 0 {
                // Back in the middle, and on another way.
                let inner = astray.keep();
                astray.step(t, STEP);
                astray.go_back(&inner);
            }
        }
        let gone = astray.look();
        astray.go_back(&kept);
        moved |= gone != astray.look();
        assert_eq!(
            step(&straight, i),
            step(&astray, i),
            "{scene} {model} {method}, step {i}"
        );
    }
    assert!(moved, "nothing happened astray");
}

#[test]
fn a_thousand_ways_astray_leave_no_trace() {
    goes_back("hammer", "rigid", "velocity-verlet@1us", 1000);
}

#[test]
fn ways_astray_leave_no_trace_under_other_methods_and_models() {
    goes_back("hammer", "rigid", "dopri5@1e-7", 200);
    goes_back("hammer", "rigid", "bdf@1e-6", 40);
    goes_back("hammer", "rigid", "generalised-alpha(rho_inf=0.8)@1us", 200);
    goes_back("hammer", "rigid", "trigonometric@1us", 200);
    goes_back("hammer", "movable-teeth", "velocity-verlet@1us", 200);
    goes_back("driveline", "movable-teeth", "velocity-verlet@400ns", 100);
}

#[test]
fn ways_astray_leave_no_trace_in_elastic_gears() {
    // Modes, the solve of the contacts and what it starts from go back as well.
    goes_back("spur_impact", "elastic", "trigonometric@1us", 16);
    goes_back("spur_impact", "elastic", "velocity-verlet@500ns", 16);
    goes_back("spur_impact", "elastic-half-space", "trigonometric@1us", 16);
}
