//! What an event must leave alone, and what ends with it.

use lashloop_protocol::enums::State;

use super::{Drive, NO_COUNTS};

impl Drive {
    /// After an event, be it a request, refused or done, a frame or time. A mutant loses with it what must be kept.
    pub(super) fn after(&mut self, event: &'static str) {
        let loses = |what, has_it| has_it && !self.at.flag(what, event, true);
        let counts = self.counts;
        let has_counts = [counts.messages, counts.damaged, counts.refused] != [0; 3];
        let is_running = self.state() == State::Running;
        let loses_parameters = loses("keeps the parameters", self.values != self.defaults());
        let loses_subscription = loses("keeps the subscription", self.signals != 0 || self.every != 0);
        let loses_session = loses("keeps the session", self.session.is_some());
        let loses_fault = loses("keeps the fault report", self.fault.is_some());
        let loses_counts = loses("keeps the line counts", has_counts);
        let loses_state = loses("keeps the state", !matches!(self.state(), State::Boot | State::Idle));
        let may_feed = is_running && !matches!(event, "an accepted sample" | "Start");
        if may_feed && self.at.flag("feeds the watchdog", event, false) {
            self.fed_us = self.now_us;
        }
        if loses_parameters {
            self.values = self.defaults();
        }
        if loses_subscription {
            (self.signals, self.every) = (0, 0);
        }
        if loses_session {
            self.session = None;
        }
        if loses_fault {
            self.fault = None;
        }
        if loses_counts {
            self.clear_counts();
        }
        if loses_state {
            self.set_state(State::Idle);
        }
    }

    pub(super) const fn clear_counts(&mut self) {
        self.counts = NO_COUNTS;
    }
}
