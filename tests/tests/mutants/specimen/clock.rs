//! What a drive does as time passes, and the time in its messages.

use lashloop_protocol::enums::{FaultCode, State};
use lashloop_protocol::message::FaultReport;
use lashloop_protocol::{DriveMessage, Message};

use super::{Drive, description, run};
use crate::mutation::Width;

/// Time after which a mistaken drive repeats its report.
const REPEATED_US: f64 = 300_000.0;
/// A word that a mistaken drive computes its limit in: clock ticks for each microsecond. 0 for none.
const TICKS_PER_US: [u64; 6] = [0, 1_000, 168, 200, 240, 480];

impl Drive {
    /// A message with the device time, if the drive has one.
    pub(super) fn timed(&self, mut message: DriveMessage) -> DriveMessage {
        let name = message.layout().name;
        let Some(time_us) = message.device_time_us_mut() else { return message };
        let has_it = self.character.has_clock;
        if self.at.flag("device time", name, has_it) {
            *time_us = Some(self.now_us as u32);
        }
        message
    }

    /// The limit of the watchdog as a mistaken drive computes it.
    fn limit_us(&self, limit_us: f64) -> f64 {
        let ticks = self.at.pick("watchdog", "ticks of 32 bits for a us", 0, &TICKS_PER_US);
        if ticks == 0 { limit_us } else { f64::from((limit_us as u64 * ticks) as u32) / ticks as f64 }
    }

    /// Looks at the watchdog; its report if it trips.
    pub(super) fn watchdog(&mut self) -> Option<FaultReport> {
        let runs = self.at.flag("watchdog", "runs", self.state() == State::Running);
        let has_run = self.run.as_ref().is_some_and(|run| run.last.is_some());
        let runs_on = match self.state() {
            State::Armed => has_run && self.at.flag("watchdog", "runs on in Armed after a run", false),
            State::Boot => self.watches_in_boot,
            _ => false,
        };
        if !runs && !runs_on {
            return None;
        }
        let silence_us = self.now_us - self.fed_us;
        let limit_us = match &self.run {
            Some(run) => run.watchdog_us(&self.at),
            None => run::setting(&self.at, &self.values, description::WATCHDOG),
        };
        let reported_us = limit_us;
        let limit_us = self.at.real("watchdog", "limit", self.limit_us(limit_us));
        let is_late = silence_us > limit_us
            || self.at.flag("watchdog", "trips at its limit", false) && silence_us == limit_us;
        if !self.at.flag("watchdog", "is late", is_late) {
            return None;
        }
        let code = self.at.fault("watchdog", FaultCode::Watchdog);
        let limit_s = reported_us * 1e-6;
        let silence = (silence_us * 1e-6, Width::Real);
        let silence_s = self.at.number_or("watchdog", "silence", silence, Some(limit_s));
        let report = self.trip(code, silence_s, limit_s);
        let state = self.at.state("watchdog", "state afterwards", State::Faulted);
        self.set_state(state);
        Some(report)
    }

    /// Lets time pass, with a look at the watchdog now and then.
    pub(super) fn pass_until(&mut self, until_us: f64) {
        while self.now_us < until_us {
            let is_running = self.state() == State::Running;
            let look_us = self.character.look_us;
            let between_us = if is_running {
                self.at.real("watchdog", "time between two looks", look_us)
            } else {
                look_us
            };
            let next_us = self.polled_us + between_us.max(100.0);
            self.now_us = next_us.min(until_us).max(self.now_us);
            if self.now_us < next_us {
                return;
            }
            self.polled_us = self.now_us;
            if let Some(report) = self.watchdog() {
                self.send(report);
            }
            self.repeat_report();
            self.after("a millisecond");
            if !self.output.is_empty() {
                return;
            }
        }
    }

    fn repeat_report(&mut self) {
        let is_faulted = self.state() == State::Faulted;
        if !is_faulted || self.now_us < self.repeated_us + REPEATED_US {
            return;
        }
        self.repeated_us = self.now_us;
        if self.at.flag("Faulted", "repeats its report", false)
            && let Some(report) = self.fault
        {
            self.send(report);
        }
    }
}
