//! Telnet (RFC 854): commands between the bytes of data, each after an IAC.

/// Interpret as command. As data the byte is sent twice.
pub(super) const IAC: u8 = 255;
const SB: u8 = 250;
const SE: u8 = 240;

/// Longest subnegotiation that is kept: the option, a command and its longest value. A server's signature may be longer
/// and is cut.
const LONGEST: usize = 16;

/// What one side says of an option.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Verb {
    Will = 251,
    Wont = 252,
    Do = 253,
    Dont = 254,
}

impl Verb {
    fn of(byte: u8) -> Option<Self> {
        [Self::Will, Self::Wont, Self::Do, Self::Dont].into_iter().find(|verb| *verb as u8 == byte)
    }
}

/// A telnet command.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Command {
    /// Offers, requests or refuses an option.
    Negotiation(Verb, u8),
    /// The option and what follows it.
    Subnegotiation(Vec<u8>),
}

impl Command {
    /// Appends the command to `bytes`.
    pub(super) fn append_to(&self, bytes: &mut Vec<u8>) {
        match self {
            Self::Negotiation(verb, option) => bytes.extend([IAC, *verb as u8, *option]),
            Self::Subnegotiation(content) => {
                bytes.extend([IAC, SB]);
                escape(content, bytes);
                bytes.extend([IAC, SE]);
            }
        }
    }
}

/// Appends data to `bytes`, with every IAC doubled.
pub(super) fn escape(data: &[u8], bytes: &mut Vec<u8>) {
    for &byte in data {
        if byte == IAC {
            bytes.push(IAC);
        }
        bytes.push(byte);
    }
}

#[derive(Debug, Default)]
enum State {
    #[default]
    Data,
    /// After an IAC in the data.
    Command,
    /// After the verb of a negotiation.
    Option(Verb),
    Subnegotiation(Vec<u8>),
    /// After an IAC in a subnegotiation.
    SubnegotiationCommand(Vec<u8>),
}

/// Separates data from commands. A command may be split over any number of calls.
#[derive(Debug, Default)]
pub(super) struct Parser {
    state: State,
}

impl Parser {
    /// Moves the data to the front of `bytes`, appends the commands to `commands`, and returns the number of data bytes.
    pub(super) fn take(&mut self, bytes: &mut [u8], commands: &mut Vec<Command>) -> usize {
        let mut data = 0;
        for at in 0..bytes.len() {
            if let Some(byte) = self.byte(bytes[at], commands) {
                bytes[data] = byte;
                data += 1;
            }
        }
        data
    }

    fn byte(&mut self, byte: u8, commands: &mut Vec<Command>) -> Option<u8> {
        let mut data = None;
        self.state = match (std::mem::take(&mut self.state), byte) {
            (State::Data, IAC) => State::Command,
            (State::Data, _) => {
                data = Some(byte);
                State::Data
            }
            (State::Command, IAC) => {
                data = Some(IAC);
                State::Data
            }
            (State::Command, SB) => State::Subnegotiation(Vec::new()),
            // Commands of one byte, such as NOP, have no meaning for a serial port.
            (State::Command, _) => Verb::of(byte).map_or(State::Data, State::Option),
            (State::Option(verb), _) => {
                commands.push(Command::Negotiation(verb, byte));
                State::Data
            }
            (State::Subnegotiation(content), IAC) => State::SubnegotiationCommand(content),
            (State::Subnegotiation(content), _) => State::Subnegotiation(appended(content, byte)),
            (State::SubnegotiationCommand(content), IAC) => State::Subnegotiation(appended(content, IAC)),
            // SE. Any other command ends a subnegotiation that the server has left incomplete.
            (State::SubnegotiationCommand(content), _) => {
                commands.push(Command::Subnegotiation(content));
                State::Data
            }
        };
        data
    }
}

fn appended(mut content: Vec<u8>, byte: u8) -> Vec<u8> {
    if content.len() < LONGEST {
        content.push(byte);
    }
    content
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Data and commands of a stream that arrives in pieces of `size`.
    fn parsed(stream: &[u8], size: usize) -> (Vec<u8>, Vec<Command>) {
        let (mut parser, mut data, mut commands) = (Parser::default(), Vec::new(), Vec::new());
        for piece in stream.chunks(size) {
            let mut piece = piece.to_vec();
            let count = parser.take(&mut piece, &mut commands);
            data.extend_from_slice(&piece[..count]);
        }
        (data, commands)
    }

    #[test]
    fn commands_leave_the_data_wherever_the_stream_is_cut() {
        let stream =
            [1, 255, 255, 2, 255, 251, 0, 0, 255, 241, 3, 255, 250, 44, 101, 255, 255, 7, 255, 240, 4];
        let commands =
            vec![Command::Negotiation(Verb::Will, 0), Command::Subnegotiation(vec![44, 101, 255, 7])];
        for size in 1..=stream.len() {
            assert_eq!(parsed(&stream, size), (vec![1, 255, 2, 0, 3, 4], commands.clone()), "{size}");
        }
    }

    #[test]
    fn every_byte_passes_as_data_once_escaped() {
        let data: Vec<u8> = (0..=255).chain([255, 255, 240, 255]).collect();
        let mut stream = Vec::new();
        escape(&data, &mut stream);
        assert_eq!(stream.len(), data.len() + 4);
        assert_eq!(parsed(&stream, 7), (data, Vec::new()));
    }

    #[test]
    fn a_command_is_parsed_back_from_its_bytes() {
        for command in [
            Command::Negotiation(Verb::Dont, 255),
            Command::Subnegotiation(vec![44, 1, 0, 14, 16, 0]),
            Command::Subnegotiation(vec![44, 1, 255, 240, 255, 255]),
        ] {
            let mut bytes = Vec::new();
            command.append_to(&mut bytes);
            assert_eq!(parsed(&bytes, 2), (Vec::new(), vec![command]));
        }
    }

    #[test]
    fn an_endless_subnegotiation_takes_no_memory() {
        let stream = [&[255, 250, 44, 100][..], &[65; 10_000], &[255, 240, 9]].concat();
        let (data, commands) = parsed(&stream, 1_000);
        assert_eq!(data, [9]);
        assert!(matches!(&commands[..], [Command::Subnegotiation(content)] if content.len() == LONGEST));
    }
}
