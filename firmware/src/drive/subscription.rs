//! What the host has subscribed to: signals, and every how many samples.

use lashloop_protocol::enums::Outcome;
use lashloop_protocol::limits::{MAX_SIGNALS, MAX_TELEMETRY_VALUES};
use lashloop_protocol::message::{Subscribe, Telemetry};
use lashloop_protocol::telemetry_values::TelemetryValues;

use super::refusal::Refusal;
use crate::law::Signal;

/// Signals of telemetry and its rate. Both are zero without a subscription.
#[derive(Clone, Copy, Default)]
pub(super) struct Subscription {
    /// Bit `n` for the signal with index `n`.
    signals: u32,
    /// Telemetry follows the torque of every sample whose sequence is a multiple of this number.
    every: u16,
}

impl Subscription {
    /// The subscription of a request.
    ///
    /// # Errors
    /// [`Outcome::UnknownIndex`] for a bit without a signal, [`Outcome::OutOfRange`] for more signals than one frame
    /// carries.
    pub(super) fn requested(request: &Subscribe, table: &[Signal]) -> Result<Self, Outcome> {
        let Subscribe { signals, every } = *request;
        check_indices(signals, table)?;
        if signals.count_ones() as usize > MAX_TELEMETRY_VALUES {
            return Err(Outcome::OutOfRange);
        }
        Ok(Self { signals, every })
    }

    /// Checks that a law has every subscribed signal.
    ///
    /// # Errors
    /// The first signal that the law lacks.
    pub(super) fn check(&self, law: u32, table: &[Signal]) -> Result<(), Refusal> {
        check_law(self.signals, law, table)
    }

    /// Whether any sample has telemetry, if there are signals.
    pub(super) fn has_rate(&self) -> bool {
        self.every > 0
    }

    /// Whether telemetry follows the torque of this sample.
    pub(super) fn is_due(&self, sequence: u16) -> bool {
        self.has_rate() && sequence.is_multiple_of(self.every)
    }

    /// The subscribed ones of all signals' values; `None` without a subscribed signal.
    pub(super) fn telemetry(&self, sequence: u16, all: &[f32; MAX_SIGNALS]) -> Option<Telemetry> {
        let mut values = heapless::Vec::<f32, MAX_TELEMETRY_VALUES>::new();
        let subscribed = all.iter().enumerate().filter(|(index, _)| self.signals >> index & 1 != 0);
        values.extend(subscribed.map(|(_, value)| *value).take(MAX_TELEMETRY_VALUES));
        TelemetryValues::new(&values).map(|values| Telemetry { sequence, values })
    }
}

/// Checks that every bit stands for a signal.
///
/// # Errors
/// [`Outcome::UnknownIndex`] if one doesn't.
pub(super) fn check_indices(signals: u32, table: &[Signal]) -> Result<(), Outcome> {
    if (signals as u64) >> table.len() == 0 { Ok(()) } else { Err(Outcome::UnknownIndex) }
}

/// Checks that a law has every one of these signals.
///
/// # Errors
/// The first signal that the law lacks.
pub(super) fn check_law(signals: u32, law: u32, table: &[Signal]) -> Result<(), Refusal> {
    let mut named = (0..).zip(table).filter(|(index, _)| signals >> index & 1 != 0);
    match named.find(|(_, signal)| u32::from(signal.laws) >> law & 1 == 0) {
        None => Ok(()),
        Some((detail, _)) => Err(Refusal { outcome: Outcome::SignalOfOtherLaw, detail }),
    }
}
