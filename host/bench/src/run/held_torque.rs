//! The torque on the motor, held while the drive gives no new one.

use std::time::Duration;

/// The torque on the motor.
#[derive(Debug)]
pub(super) struct HeldTorque {
    /// The torque in N m; 0 while the drive is disarmed.
    pub(super) torque_nm: f32,
    /// Steps since the one that the torque was computed for.
    periods: u32,
    period: Duration,
    /// How long the drive gives torque without a sample; `None` in lockstep, where device time is not the plant's.
    watchdog: Option<Duration>,
}

impl HeldTorque {
    pub(super) fn new(period: Duration, watchdog: Option<Duration>) -> Self {
        Self { torque_nm: 0.0, periods: 0, period, watchdog }
    }

    /// The torque of a step, whose own one is new or is missing.
    pub(super) fn advance(&mut self, is_new: bool) -> f32 {
        self.periods = if is_new { 0 } else { self.periods.saturating_add(1) };
        if self.watchdog.is_some_and(|watchdog| self.period * self.periods >= watchdog) {
            // Lost samples trip the drive's watchdog; lost answers don't. The bench can't distinguish them.
            self.torque_nm = 0.0;
        }
        self.torque_nm
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD: Duration = Duration::from_millis(1);

    #[test]
    fn a_torque_is_held_until_the_watchdog_would_trip() {
        let mut torque = HeldTorque::new(PERIOD, Some(3 * PERIOD));
        torque.torque_nm = 2.0;
        let steps = [true, false, false, false].map(|is_new| torque.advance(is_new));
        assert_eq!(steps, [2.0, 2.0, 2.0, 0.0]);
    }

    #[test]
    fn without_a_watchdog_a_torque_is_held_without_limit() {
        let mut torque = HeldTorque::new(PERIOD, None);
        torque.torque_nm = 2.0;
        assert!((0..1_000_000).all(|_| torque.advance(false) == 2.0));
    }
}
