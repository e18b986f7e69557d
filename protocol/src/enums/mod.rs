//! Open lists of values and sets of flags that both sides use. Each list is one section of the specification.
//!
//! A value or a flag that a newer peer added is kept as received. `DescribeChoice` asks the drive for its name.

mod capabilities;
mod capture_trigger;
mod fault_code;
mod log_level;
mod outcome;
mod parameter_flags;
mod parameter_value;
mod state;
mod torque_status;
mod unknown_byte;
mod version;
mod zero_source;

pub use capabilities::Capabilities;
pub use capture_trigger::CaptureTrigger;
pub use fault_code::FaultCode;
pub use log_level::LogLevel;
pub use outcome::Outcome;
pub use parameter_flags::ParameterFlags;
pub use parameter_value::{ParameterType, ParameterValue};
pub use state::State;
pub use torque_status::{TorqueFlags, TorqueStatus};
pub use unknown_byte::UnknownByte;
pub use version::Version;
pub use zero_source::ZeroSource;

use crate::layout::{FlagSet, ValueList};

/// Every list of the contract.
pub const VALUE_LISTS: [ValueList; 7] = [
    State::LIST,
    FaultCode::LIST,
    Outcome::LIST,
    LogLevel::LIST,
    ParameterType::LIST,
    ZeroSource::LIST,
    CaptureTrigger::LIST,
];

/// Every set of flags of the contract.
pub const FLAG_SETS: [FlagSet; 3] = [TorqueFlags::SET, ParameterFlags::SET, Capabilities::SET];
