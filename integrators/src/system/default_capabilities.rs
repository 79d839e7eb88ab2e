//! Defaults for systems without a capability: no event function falls, there is no free flight, and nothing is
//! reported.

use super::{Change, FlightPath, Outputs, SecondOrderSystem, State, StateView};

impl dyn SecondOrderSystem + '_ {
    /// Calls [`Events::begin`](super::Events::begin), if the system has events.
    pub fn begin(&mut self, s: &mut State, located: bool) {
        if let Some(events) = self.events() {
            events.begin(s, located);
        }
    }

    /// Calls [`Events::event_functions`](super::Events::event_functions), or writes +1 for a system without events.
    pub fn event_functions(&mut self, at: StateView<'_>, out: &mut [f64]) {
        match self.events() {
            Some(events) => events.event_functions(at, out),
            None => out.fill(1.0),
        }
    }

    /// Calls [`Events::transition`](super::Events::transition), if the system has events.
    pub fn transition(&mut self, s: &mut State, event: usize) -> Change {
        (self.events()).map_or(Change::None, |e| e.transition(s, event))
    }

    /// Calls [`Events::commit`](super::Events::commit), if the system has events.
    pub fn commit(&mut self, s: &mut State) -> Change {
        self.events().map_or(Change::None, |e| e.commit(s))
    }

    /// Calls [`Events::next_breakpoint`](super::Events::next_breakpoint), or returns infinity for a system without
    /// events.
    pub fn next_breakpoint(&mut self, t: f64) -> f64 {
        self.events()
            .map_or(f64::INFINITY, |e| e.next_breakpoint(t))
    }

    /// Calls [`FreeFlight::flight_path`](super::FreeFlight::flight_path), or returns `s.t` for a system without free
    /// flights.
    pub fn flight_path(&mut self, s: &State, later: f64, path: &mut FlightPath) -> f64 {
        (self.free_flight()).map_or(s.t, |f| f.flight_path(s, later, path))
    }

    /// Calls [`FreeFlight::steady_work`](super::FreeFlight::steady_work), or returns `None` for a system without free
    /// flights.
    pub fn steady_work(&mut self, from: StateView<'_>, to: StateView<'_>) -> Option<f64> {
        self.free_flight()?.steady_work(from, to)
    }

    /// Calls [`Report::work_of_loads`](super::Report::work_of_loads), or returns `None` for a system without reports.
    pub fn work_of_loads(&mut self, from: StateView<'_>, to: StateView<'_>) -> Option<f64> {
        self.report()?.work_of_loads(from, to)
    }

    /// Calls [`Report::channels`](super::Report::channels), or returns no channels for a system without reports.
    pub fn channels(&mut self) -> &[String] {
        self.report().map_or(&[], |r| r.channels())
    }

    /// Calls [`Report::has_powers`](super::Report::has_powers), or returns true for a system without reports.
    pub fn has_powers(&mut self) -> bool {
        self.report().is_none_or(|r| r.has_powers())
    }

    /// Calls [`Report::has_jumps`](super::Report::has_jumps), or returns true for a system without reports.
    pub fn has_jumps(&mut self) -> bool {
        self.report().is_none_or(|r| r.has_jumps())
    }

    /// Calls [`Report::sample`](super::Report::sample), if the system has reports.
    pub fn sample(&mut self, at: StateView<'_>, out: &mut Outputs) {
        if let Some(report) = self.report() {
            report.sample(at, out);
        }
    }

    /// Calls [`Report::output`](super::Report::output), if the system has reports.
    pub fn output(&mut self, at: StateView<'_>, out: &mut Outputs) {
        if let Some(report) = self.report() {
            report.output(at, out);
        }
    }
}
