//! The names of the drive's own lists.

use lashloop_protocol::enums::{FaultCode, Outcome, State, TorqueFlags};
use lashloop_protocol::limits::{FAULT_NAMES, FLAG_NAMES, KIND_NAMES, OUTCOME_NAMES, STATE_NAMES};
use lashloop_protocol::message::DescribeChoice;
use lashloop_protocol::{DriveMessage, HostMessage, Message};

use crate::host::Host;

/// The names of all values of a list, as the drive describes them.
fn described(list: u8) -> Vec<(u8, String)> {
    let mut host = Host::new();
    let mut names = Vec::new();
    for choice in 0..=u8::MAX {
        match host.send(DescribeChoice { parameter: list, choice })[..] {
            [DriveMessage::ChoiceDescription(it)] => {
                assert_eq!((it.parameter, it.choice), (list, choice));
                names.push((choice, it.name.to_string()));
            }
            [DriveMessage::CommandResult(it)] => assert_eq!(it.outcome, Outcome::UnknownIndex),
            ref other => panic!("{other:?}"),
        }
    }
    names
}

fn owned(names: impl IntoIterator<Item = (u8, &'static str)>) -> Vec<(u8, String)> {
    let mut names: Vec<_> = names.into_iter().map(|(value, name)| (value, name.to_owned())).collect();
    names.sort();
    names
}

#[test]
fn the_drive_names_every_fault_outcome_state_and_flag() {
    for (list, values) in [
        (FAULT_NAMES, FaultCode::LIST.values),
        (OUTCOME_NAMES, Outcome::LIST.values),
        (STATE_NAMES, State::LIST.values),
        (FLAG_NAMES, TorqueFlags::SET.flags),
    ] {
        assert_eq!(described(list), owned(values.iter().copied()), "list {list}");
    }
    assert!(described(FAULT_NAMES).contains(&(1, "Watchdog".to_owned())));
    assert!(described(FLAG_NAMES).contains(&(0x40, "GAP".to_owned())));
}

#[test]
fn the_drive_names_every_kind_of_message_of_both_sides() {
    let layouts = HostMessage::LAYOUTS.iter().chain(DriveMessage::LAYOUTS);
    assert_eq!(described(KIND_NAMES), owned(layouts.map(|layout| (layout.kind, layout.name))));
}

#[test]
fn a_number_between_parameters_and_lists_names_nothing() {
    for list in 240..KIND_NAMES {
        assert_eq!(described(list), [], "list {list}");
    }
}
