//! Errors of the library.

use std::{fmt, io};

use lashloop_bench::scenario::ScenarioErrors;
use lashloop_session::names::UnknownName;

use crate::execution::ExecutionError;
use crate::outcome::NoMetric;

/// Why a call of the library has no result.
#[derive(thiserror::Error)]
pub enum Error {
    /// The scenario is wrong, each error with its place.
    #[error(transparent)]
    Scenario(#[from] ScenarioErrors),
    /// No device has this name.
    #[error("{name:?} isn't a device: {problem}")]
    Device {
        /// The name.
        name: String,
        /// What is missing, or all forms there are.
        problem: String,
    },
    /// Drive, link or plant failed, or the scenario doesn't fit the drive.
    #[error(transparent)]
    Run(#[from] ExecutionError),
    /// The outcome has no value for a metric.
    #[error(transparent)]
    Metric(#[from] NoMetric),
    /// The outcome has no signal of this name.
    #[error("{}: {}", .0.name, .0)]
    Signal(#[from] UnknownName),
    /// The system refused a thread.
    #[error("the thread for child processes can't be started: {0}; is the machine out of threads or memory?")]
    Thread(#[source] io::Error),
}

/// The message: `main` and tests that return an error print it by `Debug`.
impl fmt::Debug for Error {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, out)
    }
}

#[cfg(test)]
mod tests {
    use crate::Bench;

    #[test]
    fn an_error_of_a_test_reads_as_its_message() {
        let error = Bench::new().device("no_such").expect_err("no device");
        assert_eq!(format!("{error:?}"), error.to_string());
        assert!(error.to_string().contains("isn't a device"), "{error}");
    }
}
