//! An instance of an FMU: scene, state and inputs of the host.
//!
//! **Inputs** act through the scene's own loads and prescribed motions. They are constant over a communication step; a
//! hub that the host moves continues at its speed. With the parameter `interpolate` loads vary linearly, and motions
//! along the cubic Hermite polynomial through both displacements with both speeds, from the inputs to those that end in
//! `_end`. If the speeds are the slope between the displacements, the cubic is a line, as in linear interpolation.
//! Instead of values at the end a host may give first and second time derivatives at the start, for one step: a load is
//! then a quadratic, and the values at the end of a motion are those of the derivatives.
//!
//! **Steps.** The method continues from the present state: as long as inputs do not change, communication points are no
//! more than samples of one run. Where inputs change, the method restarts, as at a breakpoint of a load; where the host
//! makes a hub jump, so do the contacts. A jump of speed is an acceleration of zero duration: it changes at once the
//! velocities that respond to accelerations of the hub, such as those of the modes of elastic gears in its frame
//! (`jumps`), so that piecewise linear motion of a hub excites them as smooth motion does.
//!
//! **Rollback.** A [`Snapshot`] contains all that the next step depends on, including the method with its history. It can
//! be stored as bytes (`stored`).

use gearbench::fmu::coupled::{Coupled, InputQuantity};
use gearbench::fmu::interface::{Interface, Quantity, Role};
use gearbench::fmu::settings::{OpenError, OpenedScene, open};
use gearbench_integrators::system::{Events, Report};
use gearbench_integrators::{Change, Integrator, NullSink, Outputs, Scheme, State, TimePlan, Work};
use gearbench_models::spec::Profile;
use std::fmt;
use std::path::Path;

/// Relative difference above which the displacement or speed of a moved hub has jumped; relative to at least 1 rad or
/// m.
const JUMP: f64 = 1e-12;
/// Largest difference between the time that a host names and the time of the instance, relative to its step.
const OFF_TIME: f64 = 1e-6;

/// Type of an instance: co-simulation or model exchange.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Co-simulation: the instance integrates its states itself.
    CoSimulation,
    /// Model exchange: the host integrates the states.
    ModelExchange,
}

/// Message of a failed call.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure(pub String);

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// Result of a call, with the message of a failure.
pub type CallResult<T = ()> = Result<T, Failure>;

pub(crate) fn fail<T>(why: impl Into<String>) -> CallResult<T> {
    Err(Failure(why.into()))
}

/// Inputs that the host set at a port: `[load, -]` or `[displacement, speed]`, now and at the end of the step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct PortInput {
    pub(crate) now: [f64; 2],
    pub(crate) end: [f64; 2],
    /// First and second time derivatives of both, for the next step.
    pub(crate) derivatives: [[f64; 2]; 2],
}

/// Phase of the life cycle of an instance; it decides which calls are allowed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Phase {
    Instantiated,
    Initialising,
    Running,
    Terminated,
}

/// All data that a step depends on, apart from the integration method.
#[derive(Clone, Debug)]
pub(crate) struct Memory {
    pub(crate) phase: Phase,
    /// State of the scene, in the time of the scene.
    pub(crate) state: State,
    /// Time of the host at time zero of the scene [s].
    pub(crate) shift: f64,
    /// Stop time of the host, if it defined one [s].
    pub(crate) stop: Option<f64>,
    pub(crate) given: Vec<PortInput>,
    pub(crate) interpolate: bool,
    /// Loads and prescribed motions that act in the scene, by port.
    pub(crate) applied: Vec<Profile>,
    /// True if the host set inputs that are not applied yet.
    pub(crate) stale: bool,
    /// True if the host set derivatives of inputs for the next step.
    pub(crate) extrapolates: bool,
    /// True if the last step had such derivatives.
    pub(crate) extrapolated: bool,
    /// True if inputs changed since the last step of the method.
    pub(crate) changed: bool,
    /// True if the discrete state is consistent with the continuous state.
    pub(crate) begun: bool,
    /// True if the integration method has run since the last reset.
    pub(crate) ran: bool,
}

/// Results that are stored for the present state, until state or inputs change.
#[derive(Default)]
pub(crate) struct CachedResults {
    pub(crate) outputs: Option<Outputs>,
    pub(crate) slopes: Option<[Vec<f64>; 2]>,
    pub(crate) rates: Option<Vec<f64>>,
    pub(crate) watched: Option<Vec<f64>>,
}

/// A copy of the state of an instance, to which the host can return.
pub struct Snapshot {
    pub(crate) memory: Memory,
    pub(crate) method: Box<dyn Integrator>,
}

/// An instance of the FMU: scene, state, inputs and integration method.
pub struct Instance {
    kind: Kind,
    pub(crate) coupled: Coupled,
    pub(crate) scheme: Scheme,
    pub(crate) events: bool,
    pub(crate) memory: Memory,
    method: Box<dyn Integrator>,
    pub(crate) known: CachedResults,
}

impl Instance {
    /// Opens the resources of an FMU.
    ///
    /// # Errors
    /// A resource is missing or was changed.
    pub fn open(kind: Kind, resources: &Path, token: &str) -> Result<Self, OpenError> {
        let OpenedScene {
            coupled,
            scheme,
            events,
        } = open(resources, token)?;
        if kind == Kind::ModelExchange && !coupled.interface.exchanges {
            return Err(OpenError::Changed(
                "the scene has too many coordinates for model exchange".into(),
            ));
        }
        let memory = start(&coupled);
        let mut instance = Instance {
            kind,
            coupled,
            scheme,
            // A host of model exchange locates events itself.
            events: events || kind == Kind::ModelExchange,
            memory,
            method: scheme.method.build(),
            known: CachedResults::default(),
        };
        instance.apply_all();
        Ok(instance)
    }

    /// Resets the instance to its state after opening.
    pub fn reset(&mut self) {
        self.memory = start(&self.coupled);
        self.method = self.scheme.method.build();
        self.known = CachedResults::default();
        self.apply_all();
    }

    /// The type of the instance.
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// The variables of the model description.
    pub fn interface(&self) -> &Interface {
        &self.coupled.interface
    }

    /// Sets the start time of the host, which becomes time zero of the scene, and its stop time.
    ///
    /// # Errors
    /// The instance is initialised already, or the times are not finite or in the wrong order.
    pub fn set_experiment(&mut self, time: f64, stop: Option<f64>) -> CallResult {
        if self.memory.phase != Phase::Instantiated {
            return fail("the instance is initialised already; reset it first");
        }
        if !time.is_finite() {
            return fail(format!("the start time {time} is not a number"));
        }
        if let Some(stop) = stop.filter(|stop| stop.is_nan() || time.is_nan() || *stop < time) {
            return fail(format!(
                "the stop time is {stop} s, expected the start time {time} s or later"
            ));
        }
        self.memory.shift = time;
        self.memory.stop = stop;
        Ok(())
    }

    /// Begins the initialisation.
    ///
    /// # Errors
    /// The instance is initialised already.
    pub fn enter_initialisation(&mut self) -> CallResult {
        if self.memory.phase != Phase::Instantiated {
            return fail("the instance is initialised already; reset it first");
        }
        self.memory.phase = Phase::Initialising;
        Ok(())
    }

    /// Ends the simulation: variables can be read, and the instance can be reset or freed.
    ///
    /// # Errors
    /// The instance is not initialised yet, or terminated already.
    pub fn terminate(&mut self) -> CallResult {
        self.running(self.kind)?;
        self.memory.phase = Phase::Terminated;
        Ok(())
    }

    /// Ends the initialisation; the instance can then be stepped.
    ///
    /// # Errors
    /// The initialisation was not begun.
    pub fn exit_initialisation(&mut self) -> CallResult {
        if self.memory.phase != Phase::Initialising {
            return fail("the initialisation was not begun");
        }
        self.settle();
        self.memory.phase = Phase::Running;
        Ok(())
    }

    /// Checks that the instance is of a kind and in its running phase.
    ///
    /// # Errors
    /// The instance is of another kind, not initialised yet or terminated.
    pub(crate) fn running(&self, kind: Kind) -> CallResult {
        if self.kind != kind {
            return fail("the call does not belong to this kind of instance");
        }
        match self.memory.phase {
            Phase::Running => Ok(()),
            Phase::Terminated => fail("the instance is terminated; reset it first"),
            Phase::Instantiated | Phase::Initialising => {
                fail("the instance is not initialised yet")
            }
        }
    }

    /// Time of the host [s].
    pub fn time(&self) -> f64 {
        self.memory.state.t + self.memory.shift
    }

    /// Converts a time of the host to a time of the scene [s].
    pub(crate) fn in_scene(&self, time: f64) -> f64 {
        time - self.memory.shift
    }

    fn role(&self, reference: u32) -> CallResult<Role> {
        match self.coupled.interface.variables.get(reference as usize) {
            Some(variable) => Ok(variable.role),
            None => fail(format!("there is no variable with reference {reference}")),
        }
    }

    /// The value of a variable.
    ///
    /// # Errors
    /// The variable does not exist, or is not a number.
    pub fn get(&mut self, reference: u32) -> CallResult<f64> {
        let role = self.role(reference)?;
        self.settle();
        let n = self.memory.state.q.len();
        Ok(match role {
            Role::Time => self.time(),
            Role::Interpolate => return fail("`interpolate` is a Boolean"),
            Role::Input {
                port,
                quantity,
                end,
            } => *place(&mut self.memory.given[port], quantity, end),
            Role::Output(channel) => self.outputs().channels[channel],
            Role::State(i) if i < n => self.memory.state.q[i],
            Role::State(i) => self.memory.state.v[i - n],
            Role::Derivative(i) => self.rates()[i],
            Role::EventFunction(i) => self.watched()[i],
        })
    }

    /// Sets an input; before the end of the initialisation also a state.
    ///
    /// # Errors
    /// The variable cannot be set, or the value is not finite.
    pub fn set(&mut self, reference: u32, value: f64) -> CallResult {
        let role = self.role(reference)?;
        if !value.is_finite() {
            let name = &self.coupled.interface.variables[reference as usize].name;
            return fail(format!("{name}: {value} is not a number"));
        }
        match role {
            _ if self.memory.phase == Phase::Terminated => {
                return fail("the instance is terminated; reset it first");
            }
            Role::Input {
                port,
                quantity,
                end,
            } => {
                *place(&mut self.memory.given[port], quantity, end) = value;
                // Values at the end of a step act in steps alone.
                self.memory.stale |= !end;
            }
            Role::State(i) if self.memory.phase != Phase::Running => {
                let State { q, v, .. } = &mut self.memory.state;
                let n = q.len();
                *(if i < n { &mut q[i] } else { &mut v[i - n] }) = value;
                self.memory.begun = false;
                self.known = CachedResults::default();
            }
            _ => {
                let name = &self.coupled.interface.variables[reference as usize].name;
                return fail(format!("`{name}` cannot be set now"));
            }
        }
        Ok(())
    }

    /// Sets the first or second time derivative of an input at the start of the next communication step. It is valid in
    /// that step alone.
    ///
    /// # Errors
    /// The variable is no input, the order or the value is out of range, or inputs run to their `_end` values.
    pub fn set_input_derivative(&mut self, reference: u32, order: i32, value: f64) -> CallResult {
        if self.kind != Kind::CoSimulation {
            return fail("derivatives of inputs belong to co-simulation");
        }
        let name = |x: &Self| {
            x.coupled.interface.variables[reference as usize]
                .name
                .clone()
        };
        let Role::Input {
            port,
            quantity,
            end: false,
        } = self.role(reference)?
        else {
            return fail(format!("`{}` has no derivatives to be set", name(self)));
        };
        if self.memory.phase == Phase::Terminated {
            return fail("the instance is terminated; reset it first");
        }
        if self.memory.interpolate {
            return fail("`interpolate` is true: inputs run to the values that end in _end");
        }
        if !(order == 1 || order == 2) || !value.is_finite() {
            return fail(format!(
                "derivative {order} of `{}` is {value}; orders are 1 and 2, values are finite",
                name(self)
            ));
        }
        let input = &mut self.memory.given[port];
        input.derivatives[order as usize - 1][index(quantity)] = value;
        self.memory.extrapolates = true;
        Ok(())
    }

    /// The value of a Boolean variable.
    ///
    /// # Errors
    /// The variable is not a Boolean.
    pub fn get_flag(&self, reference: u32) -> CallResult<bool> {
        match self.role(reference)? {
            Role::Interpolate => Ok(self.memory.interpolate),
            _ => fail(format!("variable {reference} is no Boolean")),
        }
    }

    /// Sets a Boolean variable.
    ///
    /// # Errors
    /// The variable is not a Boolean, or the initialisation has ended.
    pub fn set_flag(&mut self, reference: u32, value: bool) -> CallResult {
        match (self.role(reference)?, self.memory.phase) {
            (Role::Interpolate, Phase::Running) => {
                fail("`interpolate` can only be set before the end of the initialisation")
            }
            (Role::Interpolate, _) => {
                self.memory.interpolate = value;
                Ok(())
            }
            _ => fail(format!("variable {reference} is no Boolean")),
        }
    }

    /// Advances the scene by a communication step; returns the time at its end.
    ///
    /// # Errors
    /// The step begins at another time than the present one, exceeds the stop time, or fails in the method.
    pub fn step(&mut self, from: f64, size: f64) -> CallResult<f64> {
        self.running(Kind::CoSimulation)?;
        if !(size > 0.0 && size.is_finite()) {
            return fail(format!(
                "the communication step of {size} s is not positive"
            ));
        }
        let here = self.memory.state.t;
        if (self.in_scene(from) - here).abs() > OFF_TIME * size {
            return fail(format!(
                "a step from {from} s, but the instance is at {} s",
                self.time()
            ));
        }
        // The sum of many steps misses the stop time by their rounding.
        let rounding = |stop: f64| OFF_TIME * size + 8.0 * f64::EPSILON * stop.abs();
        if let Some(stop) = (self.memory.stop).filter(|stop| from + size > stop + rounding(*stop)) {
            return fail(format!(
                "a step from {from} s to {} s, but the stop time is {stop} s",
                from + size
            ));
        }
        let to = self.in_scene(from + size);
        // Inputs with derivatives in the step before are constant again in this one.
        let extrapolated = self.memory.extrapolated;
        self.memory.extrapolated = std::mem::take(&mut self.memory.extrapolates);
        match self.memory.interpolate {
            true => self.apply(|acts, given| piece(acts, given, [here, to])),
            false if self.memory.extrapolated => {
                self.apply(|acts, given| extrapolation(acts, given, [here, to]));
                for input in &mut self.memory.given {
                    input.derivatives = Default::default();
                }
            }
            false if self.memory.stale || extrapolated => {
                self.apply(|acts, given| constant_profile(acts, given, here))
            }
            false => {}
        }
        let change = match std::mem::take(&mut self.memory.changed) {
            true => Change::Restart,
            false => Change::None,
        };
        let plan = TimePlan {
            events: self.events,
            ..TimePlan::new(to, self.scheme.resolution)
        };
        self.known = CachedResults::default();
        self.memory.begun = true;
        self.memory.ran = true;
        let Memory { state, .. } = &mut self.memory;
        let scene = &mut self.coupled.scene;
        let mut work = Work::default();
        let done = (self.method).resume(scene, state, change, &plan, &mut NullSink, &mut work);
        done.map_err(|e| Failure(e.to_string()))?;
        Ok(self.time())
    }

    /// Copies the state of the instance.
    pub fn snapshot(&self) -> Snapshot {
        Snapshot {
            memory: self.memory.clone(),
            method: self.method.duplicate(),
        }
    }

    /// Restores a copy of the state.
    pub fn restore(&mut self, snapshot: &Snapshot) {
        self.memory = snapshot.memory.clone();
        self.method = snapshot.method.duplicate();
        self.known = CachedResults::default();
        // Data that the scene stores for a method belong to one run.
        self.memory.begun &= self.memory.ran;
        self.apply_all();
    }

    /// Applies pending inputs and makes the discrete state consistent with the continuous state.
    pub(crate) fn settle(&mut self) {
        if self.memory.stale {
            let t = self.memory.state.t;
            self.apply(|acts, given| constant_profile(acts, given, t));
        }
        if !self.memory.begun {
            self.coupled
                .scene
                .begin(&mut self.memory.state, self.events);
            self.memory.begun = true;
        }
    }

    /// Outputs of the scene at the present state.
    fn outputs(&mut self) -> &Outputs {
        let (scene, state) = (&mut self.coupled.scene, &self.memory.state);
        self.known.outputs.get_or_insert_with(|| {
            let mut out = Outputs::default();
            scene.sample(state.at(), &mut out);
            out
        })
    }

    /// Applies the profiles of loads and motions that `of` derives from the inputs.
    fn apply(&mut self, of: impl Fn(InputQuantity, &PortInput) -> Profile) {
        let t = self.memory.state.t;
        let (mut jumped, mut shaken) = (false, Vec::new());
        for (i, port) in self.coupled.ports.iter().enumerate() {
            let (new, old) = (
                of(port.acts, &self.memory.given[i]),
                &self.memory.applied[i],
            );
            if new == *old {
                continue;
            }
            if port.acts == InputQuantity::Motion {
                let apart = |a: f64, b: f64| (a - b).abs() > JUMP * a.abs().max(1.0);
                jumped |= apart(new.integral(t), old.integral(t));
                jumped |= apart(new.value(t), old.value(t));
                shaken.push((port.member, new.clone(), new.value(t) - old.value(t)));
            }
            self.memory.applied[i] = new;
            self.memory.changed = true;
            self.known = CachedResults::default();
        }
        self.memory.stale = false;
        // A host of model exchange looks at many times of one step.
        if jumped && self.kind == Kind::CoSimulation {
            self.memory.begun = false;
            self.method = self.scheme.method.build();
        }
        // In model exchange the host owns the states and sets the motion at each of them, so no jump of speed is
        // applied.
        if self.kind == Kind::CoSimulation && self.memory.phase == Phase::Running {
            for (member, motion, jump) in shaken {
                self.apply_speed_jump(member, &motion, jump);
            }
        }
        self.apply_all();
    }

    fn apply_all(&mut self) {
        for (port, profile) in self.coupled.ports.iter().zip(&self.memory.applied) {
            let profile = profile.clone();
            match port.acts {
                InputQuantity::Load(place) => self.coupled.scene.apply(port.member, place, profile),
                InputQuantity::Motion => self.coupled.scene.drive(port.member, profile),
            }
        }
    }
}

/// The initial state of the scene.
fn start(coupled: &Coupled) -> Memory {
    let given: Vec<PortInput> = (coupled.ports.iter())
        .map(|port| {
            let now = match port.acts {
                InputQuantity::Load(_) => [0.0; 2],
                InputQuantity::Motion => [0.0, port.speed],
            };
            PortInput {
                now,
                end: now,
                ..PortInput::default()
            }
        })
        .collect();
    let ports = coupled.ports.iter().zip(&given);
    Memory {
        phase: Phase::Instantiated,
        state: coupled.scene.initial(),
        shift: 0.0,
        stop: None,
        applied: ports
            .map(|(port, given)| constant_profile(port.acts, given, 0.0))
            .collect(),
        given,
        interpolate: false,
        stale: false,
        extrapolates: false,
        extrapolated: false,
        changed: false,
        begun: false,
        ran: false,
    }
}

/// The stored value of an input.
fn place(given: &mut PortInput, quantity: Quantity, end: bool) -> &mut f64 {
    let of = if end { &mut given.end } else { &mut given.now };
    &mut of[index(quantity)]
}

/// Index of a quantity in the values of its port.
fn index(quantity: Quantity) -> usize {
    match quantity {
        Quantity::Load | Quantity::Place => 0,
        Quantity::Speed => 1,
    }
}

/// The profile of an input that is constant from a time on.
fn constant_profile(acts: InputQuantity, given: &PortInput, t: f64) -> Profile {
    let [a, b] = given.now;
    match acts {
        InputQuantity::Load(_) => Profile::Constant(a),
        InputQuantity::Motion => Profile::Polynomial {
            from: t,
            integral: [a, b, 0.0, 0.0],
        },
    }
}

/// The profile of an input that varies to its value at the end of a step.
fn piece(acts: InputQuantity, given: &PortInput, times: [f64; 2]) -> Profile {
    match acts {
        InputQuantity::Load(_) if given.now[0] == given.end[0] => Profile::Constant(given.now[0]),
        InputQuantity::Load(_) => Profile::line(times, [given.now[0], given.end[0]]),
        InputQuantity::Motion => Profile::motion(times, given.now, given.end),
    }
}

/// The profile of an input over a step, by its value and its derivatives at the start. A moved hub follows the cubic
/// through the displacements and speeds at both ends.
fn extrapolation(acts: InputQuantity, given: &PortInput, times: [f64; 2]) -> Profile {
    let [first, second] = given.derivatives;
    let [from, to] = times;
    let h = to - from;
    let end = |i: usize| given.now[i] + h * (first[i] + 0.5 * h * second[i]);
    match acts {
        InputQuantity::Load(_) if first[0] == 0.0 && second[0] == 0.0 => {
            Profile::Constant(given.now[0])
        }
        InputQuantity::Load(_) => Profile::Polynomial {
            from,
            integral: [0.0, given.now[0], 0.5 * first[0], second[0] / 6.0],
        },
        InputQuantity::Motion if given.derivatives == [[0.0; 2]; 2] => {
            constant_profile(acts, given, from)
        }
        InputQuantity::Motion => Profile::motion(times, given.now, [end(0), end(1)]),
    }
}
