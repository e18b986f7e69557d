//! A message of either direction. The highest bit of the kind is the direction.

use lashloop_protocol::layout::{Direction, MessageLayout};
use lashloop_protocol::wire::BodyError;
use lashloop_protocol::{DriveMessage, HostMessage, MAX_FRAME, Message, Numbered};

/// A message of either direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AnyMessage {
    Host(HostMessage),
    Drive(DriveMessage),
}

/// Set in the kind of every message of the drive.
const FROM_DRIVE: u8 = 0x80;

/// The direction of a kind, known or not.
pub(super) fn direction_of(kind: u8) -> Direction {
    if kind & FROM_DRIVE == 0 { Direction::HostToDrive } else { Direction::DriveToHost }
}

impl Message for AnyMessage {
    const LAYOUTS: &'static [MessageLayout] = &{
        let (host, drive) = (HostMessage::LAYOUTS, DriveMessage::LAYOUTS);
        let mut all = [host[0]; HostMessage::LAYOUTS.len() + DriveMessage::LAYOUTS.len()];
        let mut at = 0;
        while at < all.len() {
            all[at] = if at < host.len() { host[at] } else { drive[at - host.len()] };
            at += 1;
        }
        all
    };

    fn decode_body(body: &[u8]) -> Result<Numbered<Self>, BodyError> {
        if body.first().is_some_and(|kind| kind & FROM_DRIVE != 0) {
            DriveMessage::decode_body(body).map(|it| it.map(Self::Drive))
        } else {
            HostMessage::decode_body(body).map(|it| it.map(Self::Host))
        }
    }

    fn layout(&self) -> &'static MessageLayout {
        match self {
            Self::Host(message) => message.layout(),
            Self::Drive(message) => message.layout(),
        }
    }

    fn write_numbered<'buffer>(&self, number: u8, buffer: &'buffer mut [u8; MAX_FRAME]) -> &'buffer [u8] {
        match self {
            Self::Host(message) => message.write_numbered(number, buffer),
            Self::Drive(message) => message.write_numbered(number, buffer),
        }
    }
}
