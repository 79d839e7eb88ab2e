//! Model exchange: the host integrates `q' = v`, `v' = M^-1 f` and locates where event functions fall through zero.
//!
//! **Events.** A host ends its step slightly behind a root. Event functions that are not positive there and keep
//! falling switch their part of the branch; a function that was just switched, slightly off its root, rises by itself.
//! The slope of the function at the present state distinguishes both cases, not the history that the host has seen.
//!
//! **After steps** a scene may change the teeth in contact, which changes coordinates: it then requests an event.

use crate::instance::{CachedResults, CallResult, Instance, Kind, fail};
use gearbench_integrators::system::Events;
use gearbench_integrators::{SecondOrderSystem, State};

/// Time ahead at which the sign of the slope of event functions is determined, relative to the characteristic time.
const AHEAD: f64 = 1e-6;
/// Largest number of successive switches at one event.
const MOST_ROUNDS: usize = 50;

/// Result of an event update.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Update {
    /// True if the continuous states jumped.
    pub moved: bool,
    /// Next time of the host at which a load has a breakpoint [s].
    pub next: Option<f64>,
}

/// Refuses values that are not finite, and names the first one.
fn numbers(what: &str, all: &[f64]) -> CallResult {
    match all.iter().position(|x| !x.is_finite()) {
        None => Ok(()),
        Some(i) => fail(format!("{what} {} is {}, expected a number", i + 1, all[i])),
    }
}

impl Instance {
    /// Sets the time of the host [s].
    ///
    /// # Errors
    /// The instance is of another kind, or the time is not finite.
    pub fn set_time(&mut self, time: f64) -> CallResult {
        self.running(Kind::ModelExchange)?;
        if !time.is_finite() {
            return fail(format!("the time {time} is not a number"));
        }
        self.memory.state.t = self.in_scene(time);
        // What the host set holds now.
        self.memory.stale = true;
        self.known = CachedResults::default();
        Ok(())
    }

    /// Sets the continuous states: coordinates, then velocities.
    ///
    /// # Errors
    /// The instance is of another kind, the number of states is wrong, or a value is not finite.
    pub fn set_states(&mut self, x: &[f64]) -> CallResult {
        self.running(Kind::ModelExchange)?;
        self.count(x.len())?;
        numbers("continuous state", x)?;
        let State { q, v, .. } = &mut self.memory.state;
        let (of_q, of_v) = x.split_at(q.len());
        q.copy_from_slice(of_q);
        v.copy_from_slice(of_v);
        self.known = CachedResults::default();
        Ok(())
    }

    /// Writes the continuous states to `x`: coordinates, then velocities.
    ///
    /// # Errors
    /// The length of `x` is not the number of states.
    pub fn states(&self, x: &mut [f64]) -> CallResult {
        self.count(x.len())?;
        let State { q, v, .. } = &self.memory.state;
        let (of_q, of_v) = x.split_at_mut(q.len());
        of_q.copy_from_slice(q);
        of_v.copy_from_slice(v);
        Ok(())
    }

    /// Writes typical magnitudes of the continuous states to `x`; each is positive.
    ///
    /// # Errors
    /// The length of `x` is not the number of states.
    pub fn nominals(&self, x: &mut [f64]) -> CallResult {
        self.count(x.len())?;
        let (q, v) = x.split_at_mut(self.memory.state.q.len());
        self.coupled.scene.scales(q, v);
        // A magnitude has to be positive.
        for x in x {
            if !(*x > 0.0 && x.is_finite()) {
                *x = 1.0;
            }
        }
        Ok(())
    }

    /// Writes the time derivatives of the continuous states to `x`.
    ///
    /// # Errors
    /// The length of `x` is not the number of states, or a derivative is not finite.
    pub fn derivatives(&mut self, x: &mut [f64]) -> CallResult {
        self.count(x.len())?;
        numbers("derivative of state", self.rates())?;
        x.copy_from_slice(self.rates());
        Ok(())
    }

    /// Writes the values of the event functions to `z`.
    ///
    /// # Errors
    /// The length of `z` is not the number of event functions.
    pub fn event_functions(&mut self, z: &mut [f64]) -> CallResult {
        if z.len() != self.coupled.interface.event_functions {
            return fail(format!(
                "{} event indicators, but there are {}",
                z.len(),
                self.coupled.interface.event_functions
            ));
        }
        numbers("event indicator", self.watched())?;
        z.copy_from_slice(self.watched());
        Ok(())
    }

    fn count(&self, n: usize) -> CallResult {
        match n == self.coupled.interface.states {
            true => Ok(()),
            false => fail(format!(
                "{n} continuous states, but there are {}",
                self.coupled.interface.states
            )),
        }
    }

    /// Handles an event: switches the event functions that fall through zero until none does, then commits the state.
    ///
    /// # Errors
    /// The instance is of another kind, or contacts chatter.
    pub fn update(&mut self) -> CallResult<Update> {
        self.running(Kind::ModelExchange)?;
        self.settle();
        let before = self.memory.state.clone();
        let mut rounds = 0;
        loop {
            let fallen = self.falling();
            if fallen.is_empty() {
                break;
            }
            rounds += 1;
            if rounds > MOST_ROUNDS {
                return fail(format!("contacts chatter at {} s", self.time()));
            }
            for event in fallen {
                let scene = &mut self.coupled.scene;
                scene.transition(&mut self.memory.state, event);
            }
            self.known = CachedResults::default();
        }
        let state = &mut self.memory.state;
        self.coupled.scene.commit(state);
        self.known = CachedResults::default();
        let next = self.coupled.scene.next_breakpoint(self.memory.state.t);
        let moved = self.memory.state.q != before.q || self.memory.state.v != before.v;
        let shift = self.time() - self.memory.state.t;
        Ok(Update {
            moved,
            next: next.is_finite().then_some(next + shift),
        })
    }

    /// Notes a completed step of the host; returns true if the host must enter event mode.
    ///
    /// # Errors
    /// The instance is of another kind.
    pub fn completed(&mut self) -> CallResult<bool> {
        self.running(Kind::ModelExchange)?;
        self.settle();
        let mut after = self.memory.state.clone();
        self.coupled.scene.commit(&mut after);
        let state = &mut self.memory.state;
        if after.q != state.q || after.v != state.v {
            return Ok(true);
        }
        if after.discrete != state.discrete {
            state.discrete = after.discrete;
            self.known = CachedResults::default();
        }
        Ok(false)
    }

    /// Indices of event functions that are not positive and fall.
    fn falling(&mut self) -> Vec<usize> {
        let here = self.watched().to_vec();
        if here.iter().all(|z| *z > 0.0) {
            return Vec::new();
        }
        let n = self.memory.state.q.len();
        let rates = self.rates().to_vec();
        let scene = &mut self.coupled.scene;
        let mut ahead = self.memory.state.clone();
        let time = scene.characteristic_time(ahead.at());
        let h = AHEAD * if time.is_finite() { time } else { 1.0 };
        ahead.t += h;
        for i in 0..n {
            ahead.q[i] += h * (ahead.v[i] + 0.5 * h * rates[n + i]);
            ahead.v[i] += h * rates[n + i];
        }
        let mut after = vec![1.0; here.len()];
        scene.event_functions(ahead.at(), &mut after);
        let falls = |i: &usize| here[*i] <= 0.0 && after[*i] < here[*i];
        (0..here.len()).filter(falls).collect()
    }

    /// Time derivatives of coordinates and velocities.
    pub(crate) fn rates(&mut self) -> &[f64] {
        self.settle();
        let (scene, state) = (&mut self.coupled.scene, &self.memory.state);
        self.known.rates.get_or_insert_with(|| {
            let mut rates = state.v.clone();
            let mut a = vec![0.0; state.v.len()];
            scene.force(state.at(), &mut a);
            scene.solve_mass(state.at(), &mut a);
            rates.extend(a);
            rates
        })
    }

    /// The values of the event functions at the present state.
    pub(crate) fn watched(&mut self) -> &[f64] {
        self.settle();
        let count = self.coupled.interface.event_functions;
        let (scene, state) = (&mut self.coupled.scene, &self.memory.state);
        self.known.watched.get_or_insert_with(|| {
            let mut watched = vec![1.0; count];
            scene.event_functions(state.at(), &mut watched);
            watched
        })
    }
}
