//! Versions of the firmware, and the answer to `Hello`.

use lashloop_protocol::enums::{Capabilities, State, Version};
use lashloop_protocol::message::Identity;
use lashloop_protocol::text::Text;
use lashloop_protocol::{MINOR_VERSION, PROTOCOL_VERSION};

use crate::law::{DriveParameters, LawSet};

/// Version of this firmware.
pub const FIRMWARE_VERSION: Version = Version {
    major: parse(env!("CARGO_PKG_VERSION_MAJOR")),
    minor: parse(env!("CARGO_PKG_VERSION_MINOR")),
    patch: parse(env!("CARGO_PKG_VERSION_PATCH")),
};

const fn parse(number: &str) -> u8 {
    match u8::from_str_radix(number, 10) {
        Ok(number) => number,
        Err(_) => panic!("every part of the package version must be 0 to 255"),
    }
}

/// First 32 bits of the commit this firmware was built from; 0 if unknown.
pub const BUILD_ID: u32 = match u32::from_str_radix(env!("LASHLOOP_BUILD_ID"), 16) {
    Ok(id) => id,
    Err(_) => 0,
};

/// Whether the sources of this firmware differed from that commit when it was built, or whether that is unknown.
pub const BUILD_IS_DIRTY: bool = !matches!(env!("LASHLOOP_BUILD_DIRTY").as_bytes(), b"0");

/// The identity of a drive on `board`, in answer to the `Hello` of `session`.
pub(super) fn identity<L: LawSet>(
    board: &str,
    session: u32,
    state: State,
    parameters: &DriveParameters,
    parameter_count: u8,
    capabilities: Capabilities,
) -> Identity {
    Identity {
        protocol_version: PROTOCOL_VERSION,
        minor_version: MINOR_VERSION,
        session,
        firmware: FIRMWARE_VERSION,
        build_id: BUILD_ID,
        dirty: u8::from(BUILD_IS_DIRTY),
        state,
        board: Text::new(board),
        period_us: parameters.period_us,
        motor_counts_per_rev: parameters.motor_counts_per_rev,
        load_counts_per_rev: parameters.load_counts_per_rev,
        law_count: L::NAMES.len() as u8,
        signal_count: L::SIGNALS.len() as u8,
        parameter_count,
        capabilities,
        device_time_us: None,
    }
}
