//! What an event must leave alone, and what ends with it.

use lashloop_protocol::enums::State;

use super::{Drive, defaults};

impl Drive {
    /// After an event, be it a request, refused or done, a frame or time. A mutant loses with it what must be kept.
    pub(super) fn after(&mut self, event: &'static str) {
        if !self.at.flag("keeps the parameters", event, true) {
            self.values = defaults();
        }
        if !self.at.flag("keeps the subscription", event, true) {
            (self.signals, self.every) = (0, 0);
        }
        if !self.at.flag("keeps the session", event, true) {
            self.session = None;
        }
        if !self.at.flag("keeps the fault report", event, true) {
            self.fault = None;
        }
        if !self.at.flag("keeps the line counts", event, true) {
            self.clear_counts();
        }
        if !self.at.flag("keeps the state", event, true) && self.state() != State::Boot {
            self.set_state(State::Idle);
        }
        if self.at.flag("feeds the watchdog", event, false) {
            self.fed_us = self.now_us;
        }
    }

    pub(super) const fn clear_counts(&mut self) {
        let counts = &mut self.counts;
        (counts.messages, counts.damaged, counts.refused, counts.overruns) = (0, 0, 0, 0);
    }
}
