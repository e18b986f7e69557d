//! The names of the drive's own lists, which `DescribeChoice` requests by reserved numbers instead of a parameter: a host of
//! another minor version may lack some.

use lashloop_protocol::enums::{FaultCode, Outcome, State, TorqueFlags};
use lashloop_protocol::limits::{FAULT_NAMES, FLAG_NAMES, KIND_NAMES, OUTCOME_NAMES, STATE_NAMES};
use lashloop_protocol::{DriveMessage, HostMessage, Message};

const OF_HOST: usize = HostMessage::LAYOUTS.len();
const OF_DRIVE: usize = DriveMessage::LAYOUTS.len();

/// Kinds and names alone: the layouts hold their documentation too.
static KINDS: [(u8, &str); OF_HOST + OF_DRIVE] = {
    let mut kinds = [(0, ""); OF_HOST + OF_DRIVE];
    let mut at = 0;
    while at < kinds.len() {
        let layout =
            if at < OF_HOST { &HostMessage::LAYOUTS[at] } else { &DriveMessage::LAYOUTS[at - OF_HOST] };
        kinds[at] = (layout.kind, layout.name);
        at += 1;
    }
    kinds
};

/// Name of a value of a list; `None` if no list has this number, or the list no such value.
pub(super) fn name(list: u8, value: u8) -> Option<&'static str> {
    match list {
        FAULT_NAMES => FaultCode::LIST.name_of(value),
        OUTCOME_NAMES => Outcome::LIST.name_of(value),
        STATE_NAMES => State::LIST.name_of(value),
        FLAG_NAMES => TorqueFlags::SET.name_of(value),
        KIND_NAMES => KINDS.iter().find(|(kind, _)| *kind == value).map(|(_, name)| *name),
        _ => None,
    }
}
