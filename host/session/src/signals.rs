//! The drive's signals, as the drive describes them, and the subscription to them.

use lashloop_plant::Signal;
use lashloop_protocol::limits::MAX_TELEMETRY_VALUES;

use crate::laws::LawMask;

/// A signal of the drive.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DriveSignal {
    /// Index on the wire.
    pub index: u8,
    /// The laws that have it.
    pub laws: LawMask,
    /// Name and unit.
    pub signal: Signal,
}

/// The signals that telemetry carries, and its rate.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Subscription {
    signals: Vec<DriveSignal>,
    /// Period of the telemetry in samples; 0 for none.
    pub every: u16,
}

impl Subscription {
    /// A subscription to `signals`, [`MAX_TELEMETRY_VALUES`] at most, in any order. Without a signal or with `every` 0 there
    /// isn't telemetry.
    #[must_use]
    pub fn new(mut signals: Vec<DriveSignal>, every: u16) -> Self {
        signals.sort_by_key(|signal| signal.index);
        signals.dedup_by_key(|signal| signal.index);
        if every == 0 {
            signals.clear();
        }
        Self { every: if signals.is_empty() { 0 } else { every }, signals }
    }

    /// All signals of a law, those of the drive itself first. Of more than [`MAX_TELEMETRY_VALUES`] the second value has those
    /// that are left out.
    #[must_use]
    pub fn to_all(available: &[DriveSignal], law: u8, every: u16) -> (Self, Vec<DriveSignal>) {
        let mut signals: Vec<_> = available.iter().filter(|it| it.laws.contains(law)).cloned().collect();
        signals.sort_by_key(|it| (std::cmp::Reverse(it.laws.0.count_ones()), it.index));
        let left_out = signals.split_off(signals.len().min(MAX_TELEMETRY_VALUES));
        (Self::new(signals, every), left_out)
    }

    /// The signals in the order of their values in a telemetry.
    #[must_use]
    pub fn signals(&self) -> &[DriveSignal] {
        &self.signals
    }

    /// The signals as the bits of `Subscribe`.
    #[must_use]
    pub fn bits(&self) -> u32 {
        bits(&self.signals)
    }
}

/// A bit for each signal, by its index.
pub(crate) fn bits(signals: &[DriveSignal]) -> u32 {
    let bits = signals.iter().filter_map(|it| 1_u32.checked_shl(it.index.into()));
    bits.fold(0, |bits, bit| bits | bit)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn signal(index: u8, laws: u16) -> DriveSignal {
        DriveSignal {
            index,
            laws: LawMask(laws),
            signal: Signal { name: format!("s{index}").into(), unit: "".into() },
        }
    }

    fn indices(subscription: &Subscription) -> Vec<u8> {
        subscription.signals().iter().map(|it| it.index).collect()
    }

    #[test]
    fn values_arrive_in_ascending_order_of_the_index() {
        let subscription = Subscription::new(vec![signal(5, 1), signal(0, 3), signal(31, 1)], 10);
        assert_eq!((indices(&subscription), subscription.bits()), (vec![0, 5, 31], 0x8000_0021));
    }

    #[test]
    fn no_rate_and_no_signal_are_no_telemetry() {
        assert_eq!(Subscription::new(vec![signal(5, 1)], 0), Subscription::default());
        assert_eq!(Subscription::new(Vec::new(), 10), Subscription::default());
    }

    #[test]
    fn the_default_has_the_drive_s_signals_and_as_many_of_the_law_as_fit() {
        // Signal 20 is the drive's, 0 to 14 are those of law 1, 15 is another law's.
        let mut available: Vec<_> = (0..15).map(|index| signal(index, 2)).collect();
        available.extend([signal(15, 1), signal(20, 3)]);
        let (subscription, left_out) = Subscription::to_all(&available, 1, 10);
        assert_eq!(indices(&subscription), (0..12).chain([20]).collect::<Vec<_>>());
        assert_eq!(left_out.iter().map(|it| it.index).collect::<Vec<_>>(), [12, 13, 14]);
    }
}
