//! The middleware against a scripted server: bytes in, bytes out.

use std::sync::{Arc, Mutex};

use super::*;

/// Answers each piece of bytes that it receives.
type Answers = Box<dyn FnMut(&[u8]) -> Vec<u8> + Send>;

/// A server with a clock of its own, which jumps to the deadline of a wait without a byte.
struct Server {
    answers: Answers,
    pending: VecDeque<u8>,
    received: Arc<Mutex<Vec<u8>>>,
    now: Instant,
    /// Time between two pieces.
    byte_time: Duration,
}

impl Link for Server {
    fn inner(&mut self) -> Option<&mut dyn Link> {
        None
    }

    fn now(&mut self) -> Instant {
        self.now
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.received.lock().unwrap().extend_from_slice(bytes);
        self.pending.extend((self.answers)(bytes));
        Ok(())
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        // Few bytes at a time: a command is often split.
        let count = self.pending.len().min(buffer.len()).min(5);
        for (place, byte) in buffer.iter_mut().zip(self.pending.drain(..count)) {
            *place = byte;
        }
        self.now = match count {
            0 => self.now.max(deadline),
            _ => self.now + self.byte_time,
        };
        Ok(count)
    }

    fn discard_input(&mut self) -> Result<(), LinkError> {
        self.pending.clear();
        Ok(())
    }
}

/// Takes no byte for a number of times.
struct Stuck(Box<dyn Link>, u32);

impl Link for Stuck {
    fn inner(&mut self) -> Option<&mut dyn Link> {
        Some(self.0.as_mut())
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        if let Some(left) = self.1.checked_sub(1) {
            self.1 = left;
            return Err(LinkError::Stuck);
        }
        self.0.send(bytes)
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        self.0.receive(buffer, deadline)
    }

    fn discard_input(&mut self) -> Result<(), LinkError> {
        self.0.discard_input()
    }
}

fn opened(
    baud: u32,
    answers: impl FnMut(&[u8]) -> Vec<u8> + Send + 'static,
) -> (Result<Rfc2217, NegotiationError>, Arc<Mutex<Vec<u8>>>) {
    let received = Arc::new(Mutex::new(Vec::new()));
    let server = Server {
        answers: Box::new(answers),
        pending: VecDeque::new(),
        received: Arc::clone(&received),
        now: Instant::now(),
        byte_time: Duration::ZERO,
    };
    (Rfc2217::open(Box::new(server), baud), received)
}

/// Takes every option and confirms every setting; anything else it echoes.
fn agreeable(bytes: &[u8]) -> Vec<u8> {
    let (mut bytes, mut commands, mut answer) = (bytes.to_vec(), Vec::new(), Vec::new());
    let data = Parser::default().take(&mut bytes, &mut commands);
    for command in commands {
        match command {
            Command::Negotiation(Verb::Will, option) => answer.extend([255, 253, option]),
            Command::Negotiation(Verb::Do, option) => answer.extend([255, 251, option]),
            Command::Negotiation(..) => {}
            Command::Subnegotiation(mut content) => {
                content[1] += 100;
                Command::Subnegotiation(content).append_to(&mut answer);
            }
        }
    }
    escape(&bytes[..data], &mut answer);
    answer
}

#[test]
fn the_port_is_negotiated_once_and_set_to_8n1() {
    let (port, received) = opened(921_600, agreeable);
    assert!(port.is_ok(), "{:?}", port.err());
    let wanted = [
        &[255, 251, 0, 255, 253, 0, 255, 251, 3, 255, 253, 3, 255, 251, 44, 255, 253, 44][..],
        &[255, 250, 44, 1, 0, 14, 16, 0, 255, 240],
        &[255, 250, 44, 2, 8, 255, 240],
        &[255, 250, 44, 3, 1, 255, 240],
        &[255, 250, 44, 4, 1, 255, 240],
        &[255, 250, 44, 5, 1, 255, 240],
        &[255, 250, 44, 10, 0, 255, 240],
        &[255, 250, 44, 11, 0, 255, 240],
    ];
    assert_eq!(*received.lock().unwrap(), wanted.concat());
}

#[test]
fn every_byte_of_a_frame_passes_both_ways() {
    let (port, received) = opened(9600, agreeable);
    let mut port = port.unwrap();
    received.lock().unwrap().clear();
    let frame = [255, 0, 13, 10, 255, 255, 240, 1];
    port.send(&frame).unwrap();
    assert_eq!(*received.lock().unwrap(), [255, 255, 0, 13, 10, 255, 255, 255, 255, 240, 1]);
    let (mut echoed, mut buffer) = (Vec::new(), [0; 64]);
    while echoed.len() < frame.len() {
        let deadline = port.now();
        let count = port.receive(&mut buffer, deadline).unwrap();
        assert!(count > 0, "{echoed:?}");
        echoed.extend_from_slice(&buffer[..count]);
    }
    assert_eq!(echoed, frame);
}

#[test]
fn a_server_without_the_option_is_named() {
    let (raw, _) = opened(9600, |_| Vec::new());
    assert!(matches!(raw, Err(NegotiationError::NotTelnet)));
    let (echo, _) = opened(9600, |bytes| bytes.iter().filter(|byte| **byte < 128).copied().collect());
    assert!(matches!(echo, Err(NegotiationError::NotTelnet)), "data alone isn't telnet");
    let (refusing, _) = opened(9600, |bytes| {
        let offers = bytes.chunks(3).filter(|command| command.starts_with(&[255, 251]));
        offers.flat_map(|command| [255, 254, command[2]]).collect()
    });
    assert!(matches!(refusing, Err(NegotiationError::NotOffered)));
}

#[test]
fn a_server_that_refuses_8_bit_data_is_an_error_in_either_direction() {
    for (accepted, refused) in [([255, 253, 0], [255, 254, 0]), ([255, 251, 0], [255, 252, 0])] {
        let (text, _) = opened(9600, move |bytes| {
            let mut answer = agreeable(bytes);
            if let Some(at) = answer.windows(3).position(|command| command == accepted) {
                answer[at..at + 3].copy_from_slice(&refused);
            }
            answer
        });
        assert!(matches!(text, Err(NegotiationError::NotBinary)), "{:?}", text.err());
        let (silent, _) = opened(9600, move |bytes| {
            let mut answer = agreeable(bytes);
            if let Some(at) = answer.windows(3).position(|command| command == accepted) {
                answer.drain(at..at + 3);
            }
            answer
        });
        assert!(matches!(silent, Err(NegotiationError::NotBinary)), "{:?}", silent.err());
    }
}

#[test]
fn bytes_that_could_not_be_sent_do_not_precede_the_next_ones() {
    let (port, received) = opened(9600, agreeable);
    let mut port = port.unwrap();
    received.lock().unwrap().clear();
    port.link = Box::new(Stuck(port.link, 1));
    assert!(matches!(port.send(&[1, 2]), Err(LinkError::Stuck)));
    port.send(&[3]).unwrap();
    assert_eq!(*received.lock().unwrap(), [3]);
}

#[test]
fn another_baud_rate_and_a_missing_confirmation_are_errors() {
    let (slower, _) = opened(921_600, |bytes| {
        let mut answer = agreeable(bytes);
        if let Some(at) = answer.windows(4).position(|command| command == [255, 250, 44, 101]) {
            answer[at + 4..at + 8].copy_from_slice(&115_200_u32.to_be_bytes());
        }
        answer
    });
    let error = slower.err().unwrap();
    assert_eq!(
        error.to_string(),
        "the server set the baud rate to 115200, not to 921600: choose one that its port supports, on both sides"
    );
    let (silent, _) = opened(9600, |bytes| if bytes[1] == 250 { Vec::new() } else { agreeable(bytes) });
    let want = Setting::all(9600)[0];
    assert!(matches!(silent, Err(NegotiationError::Unconfirmed(setting)) if setting == want));
}

#[test]
fn options_without_use_are_refused_once() {
    let (port, received) = opened(9600, |bytes| {
        let mut answer = agreeable(bytes);
        if bytes.starts_with(&[255, 251, 0]) {
            // WILL ECHO, DO LINEMODE, and twice an option that is on already.
            answer.extend([255, 251, 1, 255, 253, 34, 255, 251, 3, 255, 251, 3]);
        }
        answer
    });
    let mut port = port.unwrap();
    let now = port.now();
    assert_eq!(port.receive(&mut [0; 64], now).unwrap(), 0);
    let (mut sent, mut commands) = (received.lock().unwrap()[18..].to_vec(), Vec::new());
    Parser::default().take(&mut sent, &mut commands);
    commands.retain(|command| matches!(command, Command::Negotiation(..)));
    assert_eq!(commands, [Command::Negotiation(Verb::Dont, 1), Command::Negotiation(Verb::Wont, 34)]);
}

#[test]
fn a_purge_discards_what_arrived_before_its_confirmation() {
    let (port, _) = opened(9600, |bytes| {
        let purge = [255, 250, 44, 12, 3, 255, 240];
        if bytes == purge {
            return [&[1, 2, 3][..], &[255, 250, 44, 112, 3, 255, 240], &[4]].concat();
        }
        agreeable(bytes)
    });
    let mut port = port.unwrap();
    port.discard_input().unwrap();
    let (mut buffer, now) = ([0; 8], port.now());
    assert_eq!((port.receive(&mut buffer, now).unwrap(), buffer[0]), (1, 4));
}

#[test]
fn a_suspended_server_gets_no_data_until_it_resumes() {
    let (port, received) = opened(9600, agreeable);
    let mut port = port.unwrap();
    received.lock().unwrap().clear();
    port.is_suspended = true;
    assert!(matches!(port.send(&[1]), Err(LinkError::Stuck)));
    assert!(received.lock().unwrap().is_empty());
    port.handle(&Command::Subnegotiation(vec![44, 109]));
    port.send(&[1]).unwrap();
    assert_eq!(*received.lock().unwrap(), [1]);
}

#[test]
fn bytes_that_keep_arriving_extend_no_negotiation() {
    for flood in [&b"no telnet"[..], &[255, 241]] {
        let bytes = flood.repeat(100_000);
        let server = Server {
            answers: Box::new(move |_| bytes.clone()),
            pending: VecDeque::new(),
            received: Arc::default(),
            now: Instant::now(),
            byte_time: Duration::from_millis(10),
        };
        let Err(error) = Rfc2217::open(Box::new(server), 9600) else { panic!("negotiated with {flood:?}") };
        assert!(matches!(error, NegotiationError::NotTelnet | NegotiationError::NotOffered), "{error}");
    }
}
