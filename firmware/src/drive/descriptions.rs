//! Names of laws and signals, in answer to the requests that describe the drive.

use lashloop_protocol::DriveMessage;
use lashloop_protocol::message::{LawDescription, SignalDescription};
use lashloop_protocol::text::Text;

use crate::law::Signal;

/// The description of a law; `None` if no law has this index.
pub(super) fn law(names: &[&str], index: u8) -> Option<DriveMessage> {
    let name = Text::new(names.get(usize::from(index))?);
    Some(LawDescription { index, name }.into())
}

/// The description of a signal; `None` if no signal has this index.
pub(super) fn signal(table: &[Signal], index: u8) -> Option<DriveMessage> {
    let Signal { name, unit, laws } = *table.get(usize::from(index))?;
    Some(SignalDescription { index, laws, name: Text::new(name), unit: Text::new(unit) }.into())
}
