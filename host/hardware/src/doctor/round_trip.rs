//! The round trip: from a sample to its torque.

use std::time::{Duration, Instant};

use hdrhistogram::Histogram;
use lashloop_protocol::EncoderCounts;
use lashloop_protocol::message::{EncoderSample, TorqueAnswer};
use lashloop_protocol::sequence::of_step;
use lashloop_protocol::wire::Payload;

use lashloop_link::uart_model::transmission_time;
use lashloop_session::{Exchange, Session, SessionError};

/// Answer timeout, far longer than the round trip of any line fit for a bench.
const ANSWER_LIMIT: Duration = Duration::from_millis(500);
/// Time for the whole measurement, with [`ROUND_LIMIT`] for each sample on top.
const MEASUREMENT_LIMIT: Duration = Duration::from_secs(10);
/// Time for a sample of a long measurement.
const ROUND_LIMIT: Duration = Duration::from_millis(1);
/// Lost answers after which the drive counts as silent.
const LARGEST_LOSS: u32 = 5;
/// Significant digits of the histogram.
const DIGITS: u8 = 3;

/// Bytes of a control cycle in both directions.
pub const BYTES: usize = EncoderSample::LAYOUT.frame_len() + TorqueAnswer::LAYOUT.frame_len();

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Timing {
    pub answered: u32,
    /// Samples without an answer.
    pub lost: u32,
    /// Answers that no sample awaited.
    pub surplus: u32,
    /// Samples not sent, because the time limit of the measurement had passed.
    pub left_out: u32,
    pub p50: Duration,
    pub p99: Duration,
    pub max: Duration,
}

/// Time of a control cycle's bytes on a line at `baud` bit/s, without gaps.
#[must_use]
pub fn wire_time(baud: u32) -> Duration {
    transmission_time(BYTES as u64, baud.max(1))
}

/// Sends `rounds` samples, each after the answer to the previous one. The drive is disarmed: it answers with zero torque
/// and makes no control step. A drive that answers late ends the measurement early, after 10 s and 1 ms for each round.
///
/// # Errors
/// The link fails, or the drive is silent.
pub fn measure(session: &mut Session, rounds: u32) -> Result<Timing, SessionError> {
    let longest_ns = 2 * ANSWER_LIMIT.as_nanos() as u64;
    let mut times_ns =
        Histogram::<u64>::new_with_max(longest_ns, DIGITS).expect("the crate takes 0 to 5 digits");
    let (mut lost, mut left_out) = (0, 0);
    let surplus_before = session.line.surplus_answers();
    let give_up = Instant::now() + MEASUREMENT_LIMIT + rounds * ROUND_LIMIT;
    let [motor_counts, load_counts] = [EncoderCounts::default(); 2];
    for step in 0..rounds {
        let sample = EncoderSample { sequence: of_step(step), motor_counts, load_counts, reference_rad: 0.0 };
        let sent = Instant::now();
        if sent >= give_up {
            left_out = rounds - step;
            break;
        }
        match session.exchange(step, &sample, Instant::now() + ANSWER_LIMIT)? {
            Exchange::Answered(_) => times_ns.saturating_record(sent.elapsed().as_nanos() as u64),
            // A disarmed drive reports no fault; we count one as a lost answer.
            Exchange::Unanswered | Exchange::Faulted(_) | Exchange::Rejected => {
                lost += 1;
                if lost > LARGEST_LOSS {
                    return Err(session.line.silent("EncoderSample", ANSWER_LIMIT));
                }
            }
        }
    }
    let quantile = |fraction| Duration::from_nanos(times_ns.value_at_quantile(fraction));
    Ok(Timing {
        answered: times_ns.len() as u32,
        lost,
        surplus: session.line.surplus_answers() - surplus_before,
        left_out,
        p50: quantile(0.5),
        p99: quantile(0.99),
        max: Duration::from_nanos(times_ns.max()),
    })
}

#[cfg(test)]
mod tests {
    use lashloop_firmware::Laws;
    use lashloop_link::in_process::InProcess;
    use lashloop_link::{Link, LinkError};

    use super::*;

    /// A line that delivers everything twice.
    struct Twice(InProcess<Laws>);

    impl Link for Twice {
        fn inner(&mut self) -> Option<&mut dyn Link> {
            Some(&mut self.0)
        }

        fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
            self.0.send(bytes)
        }

        fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
            // The drive has output whole frames only, each shorter than half a buffer.
            let half = buffer.len() / 2;
            let count = self.0.receive(&mut buffer[..half], deadline)?;
            buffer.copy_within(..count, count);
            Ok(2 * count)
        }

        fn discard_input(&mut self) -> Result<(), LinkError> {
            self.0.discard_input()
        }
    }

    #[test]
    fn answers_that_no_sample_awaited_are_counted() {
        let surplus = |link| {
            let mut session = Session::open(link, 7).expect("a session");
            measure(&mut session, 100).expect("a measurement").surplus
        };
        assert_eq!(surplus(Box::<InProcess<Laws>>::default()), 0);
        // The copy of the last answer is unread.
        let twice = surplus(Box::new(Twice(InProcess::default())));
        assert!((99..=101).contains(&twice), "{twice}");
    }

    #[test]
    fn a_control_cycle_is_35_bytes_of_ten_bits() {
        assert_eq!(BYTES, 35);
        assert_eq!(wire_time(921_600), Duration::from_nanos(379_774));
        assert_eq!(wire_time(115_200), Duration::from_nanos(3_038_194));
    }
}
