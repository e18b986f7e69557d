//! The clock of a drive on the host's time, read at the shortest round trip.
//!
//! Samples have no numbers, so a run reads no clock. A message of a run is off by what both clocks have drifted since the answer to
//! `Start`: 50 us for each second at 50 ppm.

use std::time::{Duration, Instant};

/// Time after which a reading has lost 1 us, as clocks of quartz do: a later one with a longer round trip may be better.
const US_PER_US_OF_DRIFT: u32 = 10_000;

/// When a drive formed a message, on the host's time. Instants are of the link's time.
#[derive(Debug, Default)]
pub(crate) struct DeviceClock {
    /// Number of the present request, and when its first copy was sent.
    asked: Option<(u8, Instant)>,
    best: Option<Reading>,
}

/// The clock of the drive at an instant.
#[derive(Debug, Clone, Copy)]
struct Reading {
    device_us: u32,
    at: Instant,
    /// Twice the largest error of `at`.
    round_trip: Duration,
}

impl DeviceClock {
    /// A request is about to be sent, perhaps again: either copy may be the one that is answered.
    pub(crate) fn ask(&mut self, number: u8, now: Instant) {
        if self.asked.is_none_or(|(asked, _)| asked != number) {
            self.asked = Some((number, now));
        }
    }

    /// A message of this device time has arrived. If it answers the present request, it is a reading.
    pub(crate) fn hear(&mut self, number: u8, device_us: u32, now: Instant) {
        let Some((_, sent)) = self.asked.filter(|(asked, _)| number != 0 && *asked == number) else { return };
        let round_trip = now.saturating_duration_since(sent);
        let is_better = |best: Reading| {
            let drift = now.saturating_duration_since(best.at) / US_PER_US_OF_DRIFT;
            round_trip <= best.round_trip + drift
        };
        if self.best.is_none_or(is_better) {
            self.best = Some(Reading { device_us, at: sent + round_trip / 2, round_trip });
        }
    }

    /// When the drive formed a message of this device time that arrives now; `None` before the first reading.
    pub(crate) fn time_of(&self, device_us: u32, now: Instant) -> Option<Instant> {
        let Reading { device_us: read_us, at, .. } = self.best?;
        let since_us = now.saturating_duration_since(at).as_micros();
        // Device time wraps around every 71 minutes; the message is from the half of that before its arrival.
        let ago_us = read_us.wrapping_add(since_us as u32).wrapping_sub(device_us).cast_signed();
        // A drive with a faster clock seems to send from the future.
        now.checked_sub(Duration::from_micros(u64::try_from(ago_us).unwrap_or(0)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const US: Duration = Duration::from_micros(1);

    /// A drive that booted at an instant of the host's time, behind a line with these delays to it and back.
    struct FarDrive {
        boot: Instant,
        clock: DeviceClock,
    }

    impl FarDrive {
        fn us_at(&self, at: Instant) -> u32 {
            at.saturating_duration_since(self.boot).as_micros() as u32
        }

        fn exchange(&mut self, number: u8, sent: Instant, [there_us, back_us]: [u32; 2]) {
            let formed = sent + there_us * US;
            self.clock.ask(number, sent);
            let device_us = self.us_at(formed);
            self.clock.hear(number, device_us, formed + back_us * US);
        }

        /// Where the host places a message that the drive forms at this instant.
        fn placed(&self, formed: Instant, back_us: u32) -> Instant {
            self.clock.time_of(self.us_at(formed), formed + back_us * US).expect("a reading")
        }
    }

    /// A drive that has run for this long, after some exchanges on a line of very different delays.
    fn drive(now: Instant, has_run: Duration, shortest_us: [u32; 2]) -> FarDrive {
        let mut drive = FarDrive { boot: now - has_run, clock: DeviceClock::default() };
        for (number, delays_us) in (1..).zip([[900, 40], [30, 2_000], shortest_us, [400, 400]]) {
            drive.exchange(number, now + u32::from(number) * 10_000 * US, delays_us);
        }
        drive
    }

    #[test]
    fn logs_of_two_drives_whose_clocks_keep_time_align_within_20_us() {
        let turn = Duration::from_micros(u64::from(u32::MAX) + 1);
        let now = Instant::now() + turn;
        let first = drive(now, Duration::from_secs(3), [25, 45]);
        // Its device time wraps around within the first second.
        let second = drive(now, turn - Duration::from_millis(500), [40, 30]);
        for after_ms in [100, 499, 501, 900, 60_000, 3_000_000, 9_000_000] {
            let formed = now + Duration::from_millis(after_ms);
            let [a, b] = [first.placed(formed, 5_000), second.placed(formed, 70)];
            let apart = a.max(b) - a.min(b);
            assert!(apart <= 20 * US, "{apart:?} apart after {after_ms} ms");
            assert!(a.max(formed) - a.min(formed) <= 20 * US, "after {after_ms} ms");
        }
    }

    #[test]
    fn no_message_is_formed_after_its_arrival() {
        let start = Instant::now();
        let mut clock = DeviceClock::default();
        assert_eq!(clock.time_of(5, start), None, "nothing is known of the drive's clock");
        clock.ask(1, start);
        clock.hear(1, 1_000_000, start);
        assert_eq!(
            clock.time_of(3_000_000, start + Duration::from_secs(1)),
            Some(start + Duration::from_secs(1))
        );
    }

    #[test]
    fn only_an_answer_to_the_present_request_is_a_reading() {
        let start = Instant::now();
        let mut clock = DeviceClock::default();
        clock.ask(1, start);
        clock.ask(2, start + 100 * US);
        clock.hear(1, 77, start + 110 * US);
        clock.hear(0, 77, start + 110 * US);
        assert!(clock.best.is_none());
        // A retry: the drive may have answered the first copy.
        clock.ask(2, start + 500 * US);
        clock.hear(2, 77, start + 510 * US);
        assert_eq!(clock.best.map(|it| it.round_trip), Some(410 * US));
    }
}
