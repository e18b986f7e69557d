//! The time that a lockstep run waits for its drive, all samples together.
//!
//! Each answer has a timeout. A drive that uses it up sample after sample would hold a run for hours.

use std::time::Duration;

use lashloop_session::SessionError;

/// Waiting time that a run may have beyond its mean, for single answers that are late or lost.
const ALLOWANCE: Duration = Duration::from_secs(10);

/// Wall-clock time spent waiting for answers to samples.
#[derive(Debug)]
pub(super) struct WaitingTime {
    /// Most time for a sample on average.
    mean_limit: Duration,
    /// Most time that counts for a sample: the bench itself may have been stopped meanwhile.
    most: Duration,
    waited: Duration,
    samples: u32,
}

impl WaitingTime {
    pub(super) fn new(mean_limit: Duration, answer_timeout: Duration) -> Self {
        Self { mean_limit, most: answer_timeout, waited: Duration::ZERO, samples: 0 }
    }

    /// Counts the wait for a sample. `busy` is the time in which a program that the bench started computed or waited for a core: the
    /// translation of an image and a busy machine count against no limit.
    ///
    /// # Errors
    /// All waits together, without `busy`, exceed 10 s and the mean limit for each sample.
    pub(super) fn spend(
        &mut self,
        wait: Duration,
        busy: impl FnOnce() -> Duration,
    ) -> Result<(), SessionError> {
        self.waited += wait.min(self.most);
        self.samples += 1;
        let limit = ALLOWANCE + self.mean_limit * self.samples;
        if self.waited <= limit || self.waited <= limit + busy() {
            return Ok(());
        }
        Err(SessionError::SlowTorques {
            waited: self.waited,
            samples: self.samples,
            allowance: ALLOWANCE,
            mean_limit: self.mean_limit,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TIMEOUT: Duration = Duration::from_secs(1);

    fn waiting_time() -> WaitingTime {
        WaitingTime::new(Duration::from_millis(100), TIMEOUT)
    }

    /// Samples until the limit, if each takes `wait`.
    fn samples_until_the_limit(wait: Duration) -> Option<usize> {
        let mut time = waiting_time();
        (1..=100_000).find(|_| time.spend(wait, Duration::default).is_err())
    }

    #[test]
    fn a_drive_that_answers_just_in_time_ends_the_run_after_ten_seconds_and_the_mean() {
        // 12 samples take 11.2 s at most, 11 take 11.1 s.
        assert_eq!(samples_until_the_limit(Duration::from_millis(999)), Some(12));
    }

    #[test]
    fn a_drive_as_slow_as_the_mean_ends_no_run() {
        assert_eq!(samples_until_the_limit(Duration::from_millis(100)), None);
        assert_eq!(samples_until_the_limit(Duration::from_millis(101)), Some(10_001));
    }

    #[test]
    fn a_program_that_computes_is_waited_for_and_one_that_sleeps_is_not() {
        let mut time = waiting_time();
        let samples = (1..=100).take_while(|samples| time.spend(TIMEOUT, || TIMEOUT * *samples / 2).is_ok());
        // Half of the time counts, less a tenth for each sample.
        assert_eq!(samples.count(), 25);
    }

    #[test]
    fn a_bench_that_was_stopped_counts_one_timeout() {
        let mut time = waiting_time();
        assert!(time.spend(Duration::from_secs(3600), Duration::default).is_ok());
        assert_eq!(time.waited, TIMEOUT);
    }
}
