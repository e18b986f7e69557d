//! Why a record can't be replayed.

use lashloop_bench::device::DeviceError;
use lashloop_session::SetError;

/// Why a record can't be replayed, and what to do.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// The samples were not recorded.
    #[error("{record} has no {what}; {remedy}")]
    Missing {
        /// The record.
        record: String,
        /// What is missing.
        what: &'static str,
        /// Why, and what to do.
        remedy: &'static str,
    },
    /// The record begins in the middle of a run.
    #[error(
        "{record} begins at step {step}: the drive's state there is not recorded, so a replay needs the run from its start"
    )]
    Start {
        /// The record.
        record: String,
        /// Its first step.
        step: i64,
    },
    /// The firmware lacks a parameter of the record.
    #[error("{device} has no parameter {name}, which was {value} in the record: {source}")]
    Parameter {
        /// The device.
        device: String,
        /// The parameter.
        name: String,
        /// Its value in the record.
        value: String,
        /// The parameters that the firmware has.
        source: Box<SetError>,
    },
    /// The firmware has the parameter but not this value.
    #[error("{device} does not take {name} = {value}, as in the record: {source}")]
    Value {
        /// The device.
        device: String,
        /// The parameter.
        name: String,
        /// Its value in the record.
        value: String,
        /// Why.
        source: Box<SetError>,
    },
    /// Device or link failed.
    #[error(transparent)]
    Device(#[from] DeviceError),
}
