//! What a system without a capability does: no event function ever falls, nothing flies, nothing is reported.

use super::{At, Change, FlightPath, Outputs, SecondOrderSystem, State};

impl dyn SecondOrderSystem + '_ {
    /// [`Events::begin`](super::Events::begin).
    pub fn begin(&mut self, s: &mut State, located: bool) {
        if let Some(events) = self.events() {
            events.begin(s, located);
        }
    }

    /// [`Events::event_functions`](super::Events::event_functions).
    pub fn event_functions(&mut self, at: At<'_>, out: &mut [f64]) {
        match self.events() {
            Some(events) => events.event_functions(at, out),
            None => out.fill(1.0),
        }
    }

    /// [`Events::transition`](super::Events::transition).
    pub fn transition(&mut self, s: &mut State, event: usize) -> Change {
        (self.events()).map_or(Change::None, |e| e.transition(s, event))
    }

    /// [`Events::commit`](super::Events::commit).
    pub fn commit(&mut self, s: &mut State) -> Change {
        self.events().map_or(Change::None, |e| e.commit(s))
    }

    /// [`Events::next_breakpoint`](super::Events::next_breakpoint).
    pub fn next_breakpoint(&mut self, t: f64) -> f64 {
        self.events()
            .map_or(f64::INFINITY, |e| e.next_breakpoint(t))
    }

    /// [`FreeFlight::flight_path`](super::FreeFlight::flight_path).
    pub fn flight_path(&mut self, s: &State, later: f64, path: &mut FlightPath) -> f64 {
        (self.free_flight()).map_or(s.t, |f| f.flight_path(s, later, path))
    }

    /// [`FreeFlight::linear_path`](super::FreeFlight::linear_path).
    pub fn linear_path(&mut self, s: &State, path: &mut FlightPath) -> f64 {
        (self.free_flight()).map_or(s.t, |f| f.linear_path(s, path))
    }

    /// [`FreeFlight::steady_work`](super::FreeFlight::steady_work).
    pub fn steady_work(&mut self, from: At<'_>, to: At<'_>) -> Option<f64> {
        self.free_flight()?.steady_work(from, to)
    }

    /// [`Report::work_of_loads`](super::Report::work_of_loads).
    pub fn work_of_loads(&mut self, from: At<'_>, to: At<'_>) -> Option<f64> {
        self.report()?.work_of_loads(from, to)
    }

    /// [`Report::channels`](super::Report::channels).
    pub fn channels(&mut self) -> &[String] {
        self.report().map_or(&[], |r| r.channels())
    }

    /// [`Report::has_powers`](super::Report::has_powers).
    pub fn has_powers(&mut self) -> bool {
        self.report().is_none_or(|r| r.has_powers())
    }

    /// [`Report::has_jumps`](super::Report::has_jumps).
    pub fn has_jumps(&mut self) -> bool {
        self.report().is_none_or(|r| r.has_jumps())
    }

    /// [`Report::sample`](super::Report::sample).
    pub fn sample(&mut self, at: At<'_>, out: &mut Outputs) {
        if let Some(report) = self.report() {
            report.sample(at, out);
        }
    }

    /// [`Report::output`](super::Report::output).
    pub fn output(&mut self, at: At<'_>, out: &mut Outputs) {
        if let Some(report) = self.report() {
            report.output(at, out);
        }
    }
}
