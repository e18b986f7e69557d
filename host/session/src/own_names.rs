//! The drive's own names of values that this bench doesn't know.

use std::fmt;

use lashloop_protocol::DriveMessage;
use lashloop_protocol::enums::{FaultCode, Outcome, State};
use lashloop_protocol::limits::{FAULT_NAMES, OUTCOME_NAMES, STATE_NAMES};
use lashloop_protocol::message::DescribeChoice;
use lashloop_protocol::wire::Payload;

use crate::line::Line;
use crate::request::ATTEMPT_LIMIT;
use crate::text::printable;

/// A value of a list that a drive may extend.
pub trait ListedValue: Copy + fmt::Display {
    /// Number of the list in `DescribeChoice`.
    const LIST: u8;

    /// The byte on the wire, if this bench has no name for it.
    fn unknown_byte(self) -> Option<u8>;
}

macro_rules! listed {
    ($($ty:ident $list:ident),*) => { $(
        impl ListedValue for $ty {
            const LIST: u8 = $list;

            fn unknown_byte(self) -> Option<u8> {
                (!self.is_named()).then_some(self.byte())
            }
        }
    )* };
}

listed!(FaultCode FAULT_NAMES, Outcome OUTCOME_NAMES, State STATE_NAMES);

impl Line {
    /// Name of a value: that of this bench, else the drive's own with its number, such as `BrakeOpen (77)`. `unknown 77`
    /// stands for a value without a name, and for a drive that is silent.
    pub fn name_of(&mut self, value: impl ListedValue) -> String {
        match self.own_name(value) {
            Some(name) => name,
            None => value.to_string(),
        }
    }

    /// The drive's own name of a value that this bench doesn't know, with its number.
    pub fn own_name<V: ListedValue>(&mut self, value: V) -> Option<String> {
        let choice = value.unknown_byte()?;
        let request = DescribeChoice { parameter: V::LIST, choice };
        let name = self.attempt(&request.into(), ATTEMPT_LIMIT, |answer| match answer {
            DriveMessage::ChoiceDescription(it) if (it.parameter, it.choice) == (V::LIST, choice) => {
                Some(Some(printable(it.name.as_str())))
            }
            DriveMessage::CommandResult(it) if it.request == DescribeChoice::LAYOUT.kind => Some(None),
            _ => None,
        });
        let name = name.ok().flatten().flatten().filter(|name| !name.is_empty())?;
        Some(format!("{name} ({choice})"))
    }
}
