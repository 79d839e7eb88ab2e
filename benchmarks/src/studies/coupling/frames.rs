//! Scene with gears whose frames follow prescribed trajectories; all other coordinates are free.
//!
//! The frame of a gear is its motion as a whole, `u = r^T M x / J` with `J = r^T M r` and the motion `r` of all its coordinates
//! by unit turn of the hub: teeth that have coordinates of their own turn with it, modes do not. Of the forces `f` a led gear
//! keeps what deforms it,
//!
//! ```text
//! M x'' = f + M r (u^'' - r^T f / J)
//! ```
//!
//! so that `u''` is the acceleration of the course and nothing else changes. Coordinates stay coordinates, which methods step
//! like others: a frame along a line or a parabola without any error. Kicks that dashpots answer to implicitly do not move it
//! ([`HalfStepImpulse::filter`]).

use super::step_polynomial::StepPolynomial;
use gearbench_integrators::system::{
    Change, Events, HalfStepImpulse, Layout, MemberContact, ModalSplit, Outputs, Report,
    SecondOrderSystem, State, StateView,
};
use gearbench_models::scene::Scene;
use gearbench_models::spec::{Load, SceneSpec};

/// Frame of a gear whose motion is that of a hub in the host.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Name of the gear.
    pub name: String,
    /// Coordinates that move with the frame by as much as the hub, that of the hub first, and their inertia.
    pub moves: Vec<(usize, f64)>,
    /// Total inertia of these coordinates [kg m^2] or [kg].
    pub inertia: f64,
    /// Loads on the hub of the gear.
    pub loads: Vec<Load>,
}

impl Frame {
    /// Computes the displacement of the frame from coordinates, or its velocity from their rates.
    pub fn mean(&self, x: &[f64]) -> f64 {
        let sum: f64 = self.moves.iter().map(|(i, m)| m * x[*i]).sum();
        sum / self.inertia
    }

    /// Moves the whole gear so that the frame is at the displacement `at`.
    pub fn move_to(&self, x: &mut [f64], at: f64) {
        let by = at - self.mean(x);
        // A single coordinate is at the place itself, without rounding.
        match self.moves.as_slice() {
            [(only, _)] => x[*only] = at,
            all => all.iter().for_each(|(i, _)| x[*i] += by),
        }
    }

    /// Force on the frame by forces on coordinates.
    fn total(&self, f: &[f64]) -> f64 {
        self.moves.iter().map(|(i, _)| f[*i]).sum()
    }

    /// Computes the sum of the loads on the hub [N m] or [N].
    pub fn load(&self, t: f64, speed: f64) -> f64 {
        let of = |l: &Load| match l {
            Load::Applied(p) => p.value(t),
            Load::Viscous(c) => -c * speed,
        };
        self.loads.iter().map(of).sum()
    }
}

/// Reason why the hubs of a scene cannot be moved to a host.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum HostError {
    /// The gears are on shafts or on a carrier.
    #[error("its gears are on shafts or on a carrier, whose motions are not those of single hubs")]
    Shafts,
    /// No hub of the scene is free.
    #[error("every gear is fixed or driven, so that there is no hub for a host")]
    NoneFree,
    /// A hub has inertia coupling with other coordinates.
    #[error(
        "the hub of `{0}` has inertia coupling with other coordinates, by gyroscopic terms or by tilting"
    )]
    Shared(String),
}

impl HostError {
    /// Returns advice on how to change the scene.
    pub fn help(&self) -> &'static str {
        match self {
            HostError::Shafts => {
                "use a scene of gears on separate hubs; `gearbench fmu` couples drivelines through torques on hubs"
            }
            HostError::NoneFree => "free a gear: mount = \"revolute\", or \"prismatic\" of a rack",
            HostError::Shared(_) => {
                "remove the gyroscopic terms (spin_terms = \"none\"), or fix the tilt of the hub"
            }
        }
    }
}

/// Returns the frames of the free hubs of a scene.
///
/// # Errors
/// [`HostError`].
pub fn frames(spec: &SceneSpec, scene: &mut Scene) -> Result<Vec<Frame>, HostError> {
    if spec.joins_members() {
        return Err(HostError::Shafts);
    }
    let s = scene.initial();
    let mut masses = vec![0.0; s.q.len()];
    scene.apply_mass(s.at(), &vec![1.0; s.q.len()], &mut masses);
    let mut found = Vec::new();
    for gear in scene.gears().iter().filter(|g| g.model.hub().is_free()) {
        if gear.model.coupled_mass().is_some() {
            return Err(HostError::Shared(gear.name.clone()));
        }
        let range = gear.range();
        let own = gear
            .model
            .teeth()
            .map_or(range.end, |_| range.start + gear.model.hub().first());
        let moves: Vec<(usize, f64)> = std::iter::once(range.start)
            .chain(own..range.end)
            .map(|i| (i, masses[i]))
            .collect();
        found.push(Frame {
            name: gear.name.clone(),
            inertia: moves.iter().map(|(_, m)| m).sum(),
            moves,
            loads: gear.loads.clone(),
        });
    }
    match found.is_empty() {
        true => Err(HostError::NoneFree),
        false => Ok(found),
    }
}

/// A scene whose hubs follow prescribed trajectories.
pub struct PrescribedScene<'a> {
    scene: &'a mut Scene,
    frames: &'a [Frame],
    /// Prescribed trajectory of each hub.
    pub courses: Vec<StepPolynomial>,
    channels: Vec<String>,
    f: Vec<f64>,
    filter: Vec<f64>,
}

impl<'a> PrescribedScene<'a> {
    /// Creates the scene with its hubs at rest.
    pub fn new(scene: &'a mut Scene, frames: &'a [Frame]) -> Self {
        let n = scene.layout().n;
        let of = |f: &Frame| format!("hub_force:{}", f.name);
        PrescribedScene {
            scene,
            frames,
            courses: vec![StepPolynomial::default(); frames.len()],
            channels: frames.iter().map(of).collect(),
            f: vec![0.0; n],
            filter: Vec::new(),
        }
    }

    /// Computes the force or torque of the gears on each frame, without the loads on its hub [N m] or [N].
    pub fn forces(&mut self, at: StateView<'_>, out: &mut Vec<f64>) {
        self.scene.force(at, &mut self.f);
        out.clear();
        let of = |frame: &Frame| frame.total(&self.f) - frame.load(at.t, frame.mean(at.v));
        out.extend(self.frames.iter().map(of));
    }

    /// Replaces the resultant of the forces on each frame by the force for its prescribed acceleration; forces that
    /// deform the gears remain.
    fn lead(&self, t: f64, f: &mut [f64]) {
        for (frame, course) in self.frames.iter().zip(&self.courses) {
            let by = course.acceleration(t) - frame.total(f) / frame.inertia;
            frame.moves.iter().for_each(|(i, m)| f[*i] += m * by);
        }
    }

    /// Prescribes the accelerations of the frames by a derivative `of` their trajectories.
    fn lead_accelerations(&self, a: &mut [f64], of: impl Fn(&StepPolynomial) -> f64) {
        for (frame, course) in self.frames.iter().zip(&self.courses) {
            frame.move_to(a, of(course));
        }
    }

    /// Returns the filter of a half-step impulse that moves no hub.
    fn without_hubs(&mut self, kick: &HalfStepImpulse<'_>) -> Vec<f64> {
        let mut filter = std::mem::take(&mut self.filter);
        filter.clear();
        filter.extend_from_slice(kick.filter);
        filter.resize(self.f.len(), 1.0);
        for frame in self.frames {
            frame.moves.iter().for_each(|(i, _)| filter[*i] = 0.0);
        }
        filter
    }
}

impl SecondOrderSystem for PrescribedScene<'_> {
    fn layout(&self) -> Layout {
        self.scene.layout()
    }

    fn scales(&self, q: &mut [f64], v: &mut [f64]) {
        self.scene.scales(q, v);
    }

    fn characteristic_time(&self, at: StateView<'_>) -> f64 {
        self.scene.characteristic_time(at)
    }

    fn force(&mut self, at: StateView<'_>, f: &mut [f64]) {
        self.scene.force(at, f);
        self.lead(at.t, f);
    }

    fn force_after(&mut self, at: StateView<'_>, kick: &HalfStepImpulse<'_>, f: &mut [f64]) {
        let filter = self.without_hubs(kick);
        let kick = HalfStepImpulse {
            filter: &filter,
            ..*kick
        };
        self.scene.force_after(at, &kick, f);
        self.filter = filter;
        self.lead(at.t, f);
    }

    fn solve_mass(&mut self, at: StateView<'_>, f_to_a: &mut [f64]) {
        self.scene.solve_mass(at, f_to_a);
    }

    fn apply_mass(&mut self, at: StateView<'_>, x: &[f64], y: &mut [f64]) {
        self.scene.apply_mass(at, x, y);
    }

    fn tangent_times(&mut self, at: StateView<'_>, dq: &[f64], dv: &[f64], df: &mut [f64]) {
        self.scene.tangent_times(at, dq, dv, df);
        for frame in self.frames {
            let by = frame.total(df) / frame.inertia;
            frame.moves.iter().for_each(|(i, m)| df[*i] -= m * by);
        }
    }

    fn events(&mut self) -> Option<&mut dyn Events> {
        Some(self)
    }

    fn modal(&mut self) -> Option<&mut dyn ModalSplit> {
        match self.scene.modal().is_some() {
            true => Some(self),
            false => None,
        }
    }

    fn report(&mut self) -> Option<&mut dyn Report> {
        Some(self)
    }
}

impl Events for PrescribedScene<'_> {
    fn begin(&mut self, s: &mut State, located: bool) {
        self.scene.begin(s, located);
    }

    fn event_functions(&mut self, at: StateView<'_>, out: &mut [f64]) {
        self.scene.event_functions(at, out);
    }

    fn transition(&mut self, s: &mut State, event: usize) -> Change {
        self.scene.transition(s, event)
    }

    fn commit(&mut self, s: &mut State) -> Change {
        self.scene.commit(s)
    }

    fn next_breakpoint(&self, t: f64) -> f64 {
        self.scene.next_breakpoint(t)
    }
}

impl ModalSplit for PrescribedScene<'_> {
    fn oscillators(&self, omega: &mut [f64], zeta: &mut [f64]) {
        self.scene.oscillators(omega, zeta);
    }

    fn prepare(&mut self, lag: &[f64]) {
        self.scene.prepare(lag);
    }

    fn remainder(&mut self, at: StateView<'_>, a: &mut [f64]) {
        self.scene.remainder(at, a);
        self.lead_accelerations(a, |course| course.acceleration(at.t));
    }

    fn remainder_after(&mut self, at: StateView<'_>, kick: &HalfStepImpulse<'_>, a: &mut [f64]) {
        let filter = self.without_hubs(kick);
        let kick = HalfStepImpulse {
            filter: &filter,
            ..*kick
        };
        self.scene.remainder_after(at, &kick, a);
        self.filter = filter;
        self.lead_accelerations(a, |course| course.acceleration(at.t));
    }

    fn steady(&mut self, at: StateView<'_>, a: &mut [f64]) -> f64 {
        let until = self.scene.steady(at, a);
        self.lead_accelerations(a, |_| 0.0);
        until
    }

    fn free_until(&mut self, s: &State) -> f64 {
        s.t
    }
}

/// Histories see the channels of the scene; `output` has the forces on hubs in their place, and their power.
impl Report for PrescribedScene<'_> {
    fn channels(&self) -> &[String] {
        &self.channels
    }

    fn has_jumps(&self) -> bool {
        self.scene.has_jumps()
    }

    fn output(&mut self, at: StateView<'_>, out: &mut Outputs) {
        let mut forces = std::mem::take(&mut out.channels);
        self.forces(at, &mut forces);
        let powers = forces.iter().zip(self.frames);
        out.power.external = powers.map(|(f, frame)| f * frame.mean(at.v)).sum();
        out.channels = forces;
    }

    fn sample(&mut self, at: StateView<'_>, out: &mut Outputs) {
        self.scene.sample(at, out);
    }

    fn touches(&mut self, at: StateView<'_>, out: &mut Vec<MemberContact>) {
        self.scene.touches(at, out);
    }
}
