//! Versions of the firmware, and the answer to `Hello`.

use lashloop_protocol::PROTOCOL_VERSION;
use lashloop_protocol::enums::{Controllers, State, Version};
use lashloop_protocol::message::Identity;
use lashloop_protocol::text::Text;

use super::parameters::{Parameters, TABLE};

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

/// The identity of a drive on `board`, in answer to the `Hello` of `session`.
pub(super) fn identity(board: &str, session: u32, state: State, parameters: &Parameters) -> Identity {
    Identity {
        protocol_version: PROTOCOL_VERSION,
        session,
        firmware: FIRMWARE_VERSION,
        build_id: BUILD_ID,
        state,
        board: Text::new(board),
        period_us: parameters.period_us,
        motor_counts_per_rev: parameters.motor_counts_per_rev,
        load_counts_per_rev: parameters.load_counts_per_rev,
        controllers: Controllers::all(),
        parameter_count: TABLE.len() as u8,
    }
}
