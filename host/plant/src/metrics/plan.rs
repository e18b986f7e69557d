//! What is known of a run before it starts, as far as metrics need it.

use std::ops::Range;

use super::channel::Channel;
use super::measured::Measured;
use super::meter::{NewMeter, Setup};
use super::metric;
use super::query::{Quantity, Query};
use super::sample::Sample;
use super::signal_table::{DRIVE_PREFIX, SignalTable};
use super::statistic::StatisticMeter;
use crate::Signal;
use crate::reference::Reference;

/// Longest rehearsal. A longer run, of 33 minutes at 1 kHz, finds its obstacles at its end.
const MAX_REHEARSED: u32 = 2_000_000;

/// A run before its start.
#[derive(Debug, Clone, Copy)]
pub struct Plan<'a> {
    /// Time between two samples, above 0.
    pub period_s: f64,
    /// Number of samples.
    pub steps: u32,
    /// The reference, if one is known.
    pub reference: Option<&'a Reference>,
    /// The signals of plant and telemetry.
    pub signals: &'a SignalTable,
}

/// Signals that every query of `quantity` finds, for a check before plant and drive are known.
#[must_use]
pub fn assumed_signals(quantity: &Quantity) -> SignalTable {
    let mut signals = metric::needed_signals();
    if let Quantity::Statistic { signal, .. } = quantity {
        let assumed = |name: &str| Signal { name: name.to_owned().into(), unit: "".into() };
        match signal.strip_prefix(DRIVE_PREFIX) {
            Some(name) => signals.drive.push(assumed(name)),
            None => signals.plant.push(assumed(signal)),
        }
    }
    signals
}

/// What a run starts from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunStart {
    /// Position of the load at the first sample.
    pub load_position_rad: f64,
    /// Period of the drive's telemetry in samples; 0 for none.
    pub telemetry_every: u16,
}

impl Plan<'_> {
    /// The samples that a query asks about, counted from 0; beyond the run's last one if its window is.
    pub(super) fn samples(&self, query: &Query) -> Range<u32> {
        let at = |time_s: f64| (time_s / self.period_s).round() as u32;
        query.window.map_or(0..self.steps, |window| at(window.from_s)..window.to_s.map_or(self.steps, at))
    }

    /// Builds the meter of a query, or reports why the run can't have one.
    pub(super) fn meter(&self, query: &Query) -> NewMeter {
        let setup = Setup {
            period_s: self.period_s,
            signals: self.signals,
            middle_rad: self.reference.and_then(Reference::middle_rad),
            final_rad: self.final_rad(self.samples(query).end.min(self.steps)),
        };
        match &query.quantity {
            Quantity::Metric(metric) => metric.meter(&setup),
            Quantity::Statistic { signal, statistic } => {
                let channel = Channel::named(self.signals, signal).ok_or(Measured::UnknownSignal)?;
                Ok(Box::new(StatisticMeter::new(channel, *statistic)))
            }
        }
    }

    /// Why no run of this plan has a value for `query`; `None` if a run can have one. Rehearses the run with a load that
    /// keeps its first error, so that the metric itself decides.
    #[must_use]
    pub fn obstacle(&self, query: &Query, run: &RunStart) -> Option<Measured> {
        let mut meter = match self.meter(query) {
            Ok(meter) => meter,
            Err(reason) => return Some(reason),
        };
        let Range { start: first, end } = self.samples(query);
        if first >= end || end > self.steps {
            return Some(Measured::RunTooShort);
        }
        let reference = self.reference?;
        if end - first > MAX_REHEARSED {
            return None;
        }
        let at = |step: u32| reference.position_rad(f64::from(step) * self.period_s);
        // A later error isn't known before the run, so we take any that isn't zero.
        let error_rad = if first == 0 { run.load_position_rad - at(0) } else { 1.0 };
        let plant = vec![0.0; self.signals.plant.len()];
        let drive = vec![0.0; self.signals.drive.len()];
        for step in first..end {
            let reference_rad = at(step);
            meter.push(&Sample {
                time_s: f64::from(step) * self.period_s,
                reference_rad,
                load_position_rad: if step == 0 { run.load_position_rad } else { reference_rad + error_rad },
                motor_position_rad: 0.0,
                torque_nm: 0.0,
                plant: &plant,
                drive: (run.telemetry_every > 0 && step % u32::from(run.telemetry_every) == 0)
                    .then_some(&drive),
            });
        }
        match meter.measured() {
            Measured::Value(_) | Measured::Never | Measured::NotFinite => None,
            reason => Some(reason),
        }
    }

    /// The reference's value at the last sample before `end`, if it is at rest there.
    fn final_rad(&self, end: u32) -> Option<f64> {
        let at = |step: u32| Some(self.reference?.position_rad(f64::from(step) * self.period_s));
        let last = end.checked_sub(1)?;
        let final_rad = at(last)?;
        (last == 0 || at(last - 1) == Some(final_rad)).then_some(final_rad)
    }
}

#[cfg(test)]
mod tests;
