//! Samples: torque, telemetry and faults, in this order.

use lashloop_protocol::TelemetryValues;
use lashloop_protocol::enums::{Outcome, State, TorqueFlags, TorqueStatus};
use lashloop_protocol::message::{EncoderSample, FaultReport, Telemetry, TorqueAnswer};

use super::Drive;
use super::run::{Place, Torque};
use super::table::{Cell, cell};

impl Drive {
    pub(super) fn sample(&mut self, sample: &EncoderSample) {
        let is_running = self.state() == State::Running;
        if is_running
            && self.at.flag("watchdog", "is looked at when a sample arrives", true)
            && let Some(report) = self.watchdog()
        {
            self.torque(sample.sequence, 0.0, TorqueFlags::empty());
            self.send(report);
            return;
        }
        match cell(&self.at, "EncoderSample") {
            Cell::Refused(outcome) => self.result(&(*sample).into(), outcome),
            Cell::Done(State::Running) if is_running && self.run.is_some() => self.placed(sample),
            Cell::Done(state) => {
                self.set_state(state);
                self.torque(sample.sequence, 0.0, TorqueFlags::empty());
            }
        }
    }

    /// A sample in a run.
    fn placed(&mut self, sample: &EncoderSample) {
        let Some(mut run) = self.run.take() else { return };
        let (periods, place) = run.place(&self.at, sample.sequence);
        let answer = run.answer;
        self.run = Some(run.clone());
        match place {
            Place::Stray => {
                self.result(&(*sample).into(), Outcome::OutOfSequence);
                if !self.at.flag("stray sample", "keeps the stored answer", true)
                    && let Some(answer) = self.run.as_mut().and_then(|run| run.answer.as_mut())
                {
                    answer.torque_nm = 0.0;
                }
                self.after("a stray sample");
            }
            Place::Repeated => {
                if let Some(mut answer) = answer {
                    answer.status.flags |= TorqueFlags::REPEATED;
                    let flags = [TorqueFlags::SATURATED, TorqueFlags::GAP];
                    for (name, flag) in ["keeps SATURATED", "keeps GAP"].into_iter().zip(flags) {
                        if answer.status.flags.contains(flag) && !self.at.flag("repeated sample", name, true)
                        {
                            answer.status.flags.remove(flag);
                        }
                    }
                    self.send(answer);
                }
                if self.at.flag("repeated sample", "makes a step", false) {
                    drop(run.step(&self.at, &self.values, sample, 1));
                    self.run = Some(run);
                }
                if self.at.flag("repeated sample", "gets telemetry", false) {
                    self.telemetry(sample.sequence, &[0.0; 16]);
                }
                self.after("a repeated sample");
            }
            Place::First | Place::Next | Place::AfterGap => {
                run.last = Some(sample.sequence);
                let result =
                    run.step(&self.at, &self.values, sample, if place == Place::First { 0 } else { periods });
                self.run = Some(run);
                match result {
                    Ok(torque) => self.accepted(sample.sequence, place, &torque),
                    Err((code, value, limit)) => {
                        let report = self.trip(code, value, limit);
                        self.end_run(sample.sequence, place, report);
                    }
                }
                if self.state() == State::Running
                    && self.at.flag("watchdog", "is fed by an accepted sample", true)
                {
                    self.fed_us = self.now_us;
                }
                self.after("an accepted sample");
            }
        }
    }

    fn end_run(&mut self, sequence: u16, place: Place, report: FaultReport) {
        let mut flags = TorqueFlags::empty();
        flags.set(
            TorqueFlags::GAP,
            self.at.flag("fault of a sample", "is after a gap", place == Place::AfterGap),
        );
        let state = self.at.state("fault of a sample", "state afterwards", State::Faulted);
        self.set_state(state);
        if !self.at.flag("fault of a sample", "the torque comes first", true) {
            self.send(report);
            self.torque(sequence, 0.0, flags);
            return;
        }
        self.torque(sequence, 0.0, flags);
        self.send(report);
        if self.at.flag("fault of a sample", "gets telemetry", false) {
            self.telemetry(sequence, &[0.0; 16]);
        }
    }

    fn accepted(&mut self, sequence: u16, place: Place, torque: &Torque) {
        let mut flags = TorqueFlags::empty();
        flags.set(TorqueFlags::GAP, self.at.flag("torque", "is after a gap", place == Place::AfterGap));
        flags.set(TorqueFlags::SATURATED, self.at.flag("torque", "is saturated", torque.is_saturated));
        let steps =
            place != Place::AfterGap || self.at.flag("torque after a gap", "is that of its own step", true);
        let torque_nm = if steps { torque.nm } else { self.torque_nm };
        self.torque_nm = torque_nm;
        let answer = self.torque(sequence, torque_nm, flags);
        if let Some(run) = &mut self.run {
            run.answer = Some(answer);
        }
        self.telemetry(sequence, &torque.signals);
        self.capture_step(&torque.signals);
    }

    /// Sends a torque. Outside `Running` a mistaken drive sends the last one of the run.
    fn torque(&mut self, sequence: u16, torque_nm: f32, flags: TorqueFlags) -> TorqueAnswer {
        let state = self.state();
        let torque_nm = if state == State::Running {
            torque_nm
        } else {
            let stale_nm = Some(f64::from(self.torque_nm));
            let nm = (0.0, crate::mutation::Width::Real);
            self.at.number_or("torque outside Running", state.name(), nm, stale_nm) as f32
        };
        // The step takes 5.7 us.
        let compute_tenths_us = ((self.now_us - self.arrived_us) * 10.0) as u16 + 57;
        let status = TorqueStatus { state, flags };
        let answer = TorqueAnswer { sequence, torque_nm, status, compute_tenths_us };
        self.send(answer);
        answer
    }

    fn telemetry(&mut self, sequence: u16, signals: &[f32; 16]) {
        let steps = self.run.as_ref().map(|run| f64::from(run.steps));
        let counter = (f64::from(sequence), crate::mutation::Width::U16);
        let counter = self.at.number_or("telemetry", "counter", counter, steps) as i64;
        let every = (f64::from(self.every), crate::mutation::Width::U16);
        let every = self.at.number_or("telemetry", "every", every, None) as i64;
        let is_long = every > 0xff && self.at.flag("telemetry", "every of one byte", false);
        let every = if is_long { every & 0xff } else { every };
        let is_due = every != 0 && counter % every == 0;
        if !self.at.flag("telemetry", "is due", is_due) || self.signals == 0 {
            return;
        }
        let signals_in = (0..signals.len()).filter(|index| self.signals >> index & 1 == 1);
        let values: Vec<_> = signals_in.map(|index| signals[index]).collect();
        if let Some(values) = TelemetryValues::new(&values) {
            self.send(Telemetry { sequence, values });
        }
    }
}
