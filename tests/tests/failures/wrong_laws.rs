//! Contact laws that no shipped contact follows, around a real scene, for failures that the shipped ones cannot
//! produce.

use gearbench_integrators::system::Singular;
use gearbench_integrators::{
    Change, Coeffs, Events, Layout, Outputs, Report, SecondOrderSystem, State, StateView,
};
use gearbench_models::scene::Scene;

/// Kind of a wrong law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WrongLaw {
    /// Open flanks attract each other, with a stiffness [N/m] up to a gap [m]: `N = -k g`.
    Glue { stiffness: f64, range: f64 },
    /// A contact that has closed opens at once, and closes again.
    Flips,
    /// The force of overlapping flanks is not a number.
    NoNumber,
}

/// Two gears in mesh under a wrong law. Their coordinates are the angles of their hubs.
pub struct WrongScene {
    pub scene: Scene,
    pub wrong: WrongLaw,
    /// Approach per unit rotation of each hub [m], and the gap at the start [m].
    pub effective_radii: [f64; 2],
    pub gap: f64,
    closed: Option<f64>,
}

impl WrongScene {
    pub fn new(scene: Scene, wrong: WrongLaw, effective_radii: [f64; 2], gap: f64) -> Self {
        WrongScene {
            scene,
            wrong,
            effective_radii,
            gap,
            closed: None,
        }
    }

    fn open(&self, at: StateView<'_>) -> f64 {
        self.gap - self.effective_radii[0] * at.q[0] - self.effective_radii[1] * at.q[1]
    }

    /// Returns the normal force of the attraction [N], negative, and its potential [J].
    fn pull(&self, at: StateView<'_>) -> (f64, f64) {
        let WrongLaw::Glue { stiffness, range } = self.wrong else {
            return (0.0, 0.0);
        };
        let g = self.open(at);
        if g <= 0.0 {
            (0.0, 0.0)
        } else if g < range {
            (-stiffness * g, 0.5 * stiffness * g * g)
        } else {
            (0.0, 0.5 * stiffness * range * range)
        }
    }
}

impl SecondOrderSystem for WrongScene {
    fn layout(&self) -> Layout {
        self.scene.layout()
    }
    fn scales(&self, q: &mut [f64], v: &mut [f64]) {
        SecondOrderSystem::scales(&self.scene, q, v);
    }
    fn characteristic_time(&self, at: StateView<'_>) -> f64 {
        self.scene.characteristic_time(at)
    }
    fn force(&mut self, at: StateView<'_>, f: &mut [f64]) {
        self.scene.force(at, f);
        let (n, _) = self.pull(at);
        for (f, effective_radius) in f.iter_mut().zip(self.effective_radii) {
            *f -= effective_radius * n;
            if self.wrong == WrongLaw::NoNumber && self.open(at) < 0.0 {
                *f = f64::NAN;
            }
        }
    }
    fn solve_mass(&mut self, at: StateView<'_>, f: &mut [f64]) {
        self.scene.solve_mass(at, f);
    }
    fn apply_mass(&mut self, at: StateView<'_>, x: &[f64], y: &mut [f64]) {
        self.scene.apply_mass(at, x, y);
    }
    fn correct(&mut self, at: StateView<'_>, c: Coeffs, x: &mut [f64]) -> Result<(), Singular> {
        self.scene.correct(at, c, x)
    }
    fn tangent_times(&mut self, at: StateView<'_>, dq: &[f64], dv: &[f64], df: &mut [f64]) {
        self.scene.tangent_times(at, dq, dv, df);
    }
    fn events(&mut self) -> Option<&mut dyn Events> {
        Some(self)
    }
    fn report(&mut self) -> Option<&mut dyn Report> {
        Some(self)
    }
}

impl Events for WrongScene {
    fn event_functions(&mut self, at: StateView<'_>, out: &mut [f64]) {
        self.scene.event_functions(at, out);
        if let Some(t) = self.closed {
            out[0] = t - at.t;
        }
    }
    fn begin(&mut self, s: &mut State, located: bool) {
        self.scene.begin(s, located);
    }
    fn transition(&mut self, s: &mut State, event: usize) -> Change {
        if self.wrong == WrongLaw::Flips {
            self.closed = Some(s.t);
        }
        self.scene.transition(s, event)
    }
    fn commit(&mut self, s: &mut State) -> Change {
        self.scene.commit(s)
    }
}

impl Report for WrongScene {
    fn channels(&self) -> &[String] {
        self.scene.channels()
    }
    fn output(&mut self, at: StateView<'_>, out: &mut Outputs) {
        self.scene.output(at, out);
        let (n, energy) = self.pull(at);
        out.energy.contact += energy;
        if n < 0.0 {
            for (name, value) in [("force:0", -n), ("normal_min:0", n)] {
                let c = gearbench_tests::named(&self.scene, name);
                out.channels[c] = value;
            }
        }
    }
}
