//! COM-PORT-OPTION (RFC 2217): the settings of the far serial port, as subnegotiations.

use super::telnet::Command;

/// Number of the telnet option.
pub(super) const COM_PORT: u8 = 44;
/// A server's command has the number of the client's plus this.
const BY_SERVER: u8 = 100;

const SET_BAUD_RATE: u8 = 1;
const SET_DATA_SIZE: u8 = 2;
const SET_PARITY: u8 = 3;
const SET_STOP_SIZE: u8 = 4;
const SET_CONTROL: u8 = 5;
const FLOW_SUSPEND: u8 = 8;
const FLOW_RESUME: u8 = 9;
const SET_LINE_STATE_MASK: u8 = 10;
const SET_MODEM_STATE_MASK: u8 = 11;
const PURGE: u8 = 12;

/// Names of the settings, in the order of their commands.
const NAMES: [&str; 4] = ["baud rate", "number of data bits", "parity code", "stop bit code"];

/// A setting that the server confirms by its value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Setting {
    /// `SET_BAUD_RATE` to `SET_STOP_SIZE`.
    pub(super) command: u8,
    /// Its value as on the wire.
    pub value: u32,
}

impl Setting {
    /// 8 data bits, no parity, one stop bit at `baud` bits per second.
    pub(super) fn all(baud: u32) -> [Self; 4] {
        [(SET_BAUD_RATE, baud), (SET_DATA_SIZE, 8), (SET_PARITY, 1), (SET_STOP_SIZE, 1)]
            .map(|(command, value)| Self { command, value })
    }

    /// Its name in an error message.
    #[must_use]
    pub fn name(self) -> &'static str {
        NAMES[usize::from(self.command - SET_BAUD_RATE)]
    }

    /// A baud rate has four bytes, the others have one.
    pub(super) fn request(self) -> Command {
        let first = if self.command == SET_BAUD_RATE { 0 } else { 3 };
        to_server(self.command, &self.value.to_be_bytes()[first..])
    }
}

/// Settings that need no confirmation: no flow control, and no notices about line and modem lines.
pub(super) fn unconfirmed() -> [Command; 3] {
    [
        to_server(SET_CONTROL, &[1]),
        to_server(SET_LINE_STATE_MASK, &[0]),
        to_server(SET_MODEM_STATE_MASK, &[0]),
    ]
}

/// Empties both buffers of the server.
pub(super) fn purge() -> Command {
    to_server(PURGE, &[3])
}

fn to_server(command: u8, value: &[u8]) -> Command {
    Command::Subnegotiation([&[COM_PORT, command], value].concat())
}

/// What a server reports.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Report {
    /// The setting in force.
    Confirmed(Setting),
    /// Its buffers are empty.
    Purged,
    /// The client must not send data.
    Suspended(bool),
}

impl Report {
    /// Reads the content of a subnegotiation; `None` for a report that the bench does not need.
    pub(super) fn of(content: &[u8]) -> Option<Self> {
        let (&[COM_PORT, command], value) = content.split_first_chunk()? else { return None };
        let confirmed = |command, value| Self::Confirmed(Setting { command, value });
        Some(match command.checked_sub(BY_SERVER)? {
            SET_BAUD_RATE => confirmed(SET_BAUD_RATE, u32::from_be_bytes(*value.first_chunk()?)),
            command @ SET_BAUD_RATE..=SET_STOP_SIZE => confirmed(command, (*value.first()?).into()),
            PURGE => Self::Purged,
            FLOW_SUSPEND => Self::Suspended(true),
            FLOW_RESUME => Self::Suspended(false),
            _ => return None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_baud_rate_is_four_bytes_big_endian() {
        let mut bytes = Vec::new();
        Setting::all(921_600)[0].request().append_to(&mut bytes);
        assert_eq!(bytes, [255, 250, 44, 1, 0, 14, 16, 0, 255, 240]);
        let confirmed = Report::of(&[44, 101, 0, 14, 16, 0]);
        assert_eq!(confirmed, Some(Report::Confirmed(Setting::all(921_600)[0])));
    }

    #[test]
    fn reports_are_those_of_the_server_alone() {
        assert_eq!(Report::of(&[44, 102, 8]), Some(Report::Confirmed(Setting::all(921_600)[1])));
        assert_eq!(Report::of(&[44, 108]), Some(Report::Suspended(true)));
        assert_eq!(Report::of(&[44, 109]), Some(Report::Suspended(false)));
        assert_eq!(Report::of(&[44, 112, 3]), Some(Report::Purged));
        for other in [&[44, 2, 8][..], &[44, 101, 0, 14], &[44, 107, 0], &[24, 101, 0, 0, 0, 0], &[44], &[]] {
            assert_eq!(Report::of(other), None, "{other:?}");
        }
    }
}
