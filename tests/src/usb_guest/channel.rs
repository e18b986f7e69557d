//! The channel to the guest's agent: numbered requests, and waits by the clock of the guest.

use std::io::{self, BufRead, Write};

use anyhow::{Context, Result, bail};

use super::request::{Answer, Numbered, Request, UNASKED};

/// Time for a request, in seconds of the guest: more than the agent grants anything.
const REQUEST_LIMIT_S: u32 = 200;

/// The channel to the agent. Reads end with an error when nothing arrives for longer than a guest stands still.
pub(super) struct Channel<R, W> {
    answers: R,
    requests: W,
    /// The part of a line that has arrived.
    partial: Vec<u8>,
    /// Number of the last request.
    number: u32,
    /// Seconds of the guest since it came up.
    pub(super) seconds: u32,
}

impl<R: BufRead, W: Write> Channel<R, W> {
    /// A channel to a guest that comes up.
    pub(super) fn new(answers: R, requests: W) -> Self {
        Self { answers, requests, partial: Vec::new(), number: UNASKED, seconds: 0 }
    }

    /// Waits until the guest is up.
    ///
    /// # Errors
    /// It stands still or ends.
    pub(super) fn await_up(&mut self) -> Result<()> {
        match self.next()?.message {
            Answer::Up => Ok(()),
            other => bail!("the guest came up with {other:?}"),
        }
    }

    /// Sends a request and waits for its answer. Answers to earlier requests are discarded.
    ///
    /// # Errors
    /// The guest stands still or has ended, or does not answer within its own time.
    pub(super) fn request(&mut self, request: &Request) -> Result<Answer> {
        let number = self.send(request)?;
        let began = self.seconds;
        loop {
            let Numbered { number: answered, message } = self.next()?;
            if answered == number {
                return Ok(message);
            }
            if self.seconds - began > REQUEST_LIMIT_S {
                bail!("no answer within {REQUEST_LIMIT_S} s of the guest's clock");
            }
        }
    }

    /// Sends a request and returns its number.
    ///
    /// # Errors
    /// The guest has ended.
    pub(super) fn send(&mut self, request: &Request) -> Result<u32> {
        self.number += 1;
        let mut line = serde_json::to_vec(&Numbered { number: self.number, message: request })?;
        line.push(b'\n');
        self.requests.write_all(&line)?;
        Ok(self.number)
    }

    fn next(&mut self) -> Result<Numbered<Answer>> {
        // What has arrived of a line stays in `partial` if the rest does not come in time.
        let read = self.answers.read_until(b'\n', &mut self.partial);
        if !self.partial.ends_with(b"\n") {
            let error = read.err().unwrap_or_else(|| io::ErrorKind::UnexpectedEof.into());
            return Err(error).context("the guest stands still or has ended");
        }
        let line = std::mem::take(&mut self.partial);
        let answer: Numbered<Answer> = serde_json::from_slice(&line)
            .with_context(|| format!("the guest sent {:?}", String::from_utf8_lossy(&line)))?;
        self.seconds += u32::from(answer.message == Answer::Second);
        Ok(answer)
    }
}

#[cfg(test)]
mod tests {
    use std::io::{BufReader, Read};

    use super::*;

    /// Pieces of text, one for each read; an empty one is a read that times out.
    struct Pieces(Vec<String>);

    impl Read for Pieces {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            if self.0.is_empty() {
                return Ok(0);
            }
            let piece = self.0.remove(0);
            if piece.is_empty() {
                return Err(io::ErrorKind::WouldBlock.into());
            }
            buffer[..piece.len()].copy_from_slice(piece.as_bytes());
            Ok(piece.len())
        }
    }

    fn line(number: u32, message: Answer) -> String {
        serde_json::to_string(&Numbered { number, message }).expect("JSON") + "\n"
    }

    fn channel(pieces: Vec<String>) -> Channel<BufReader<Pieces>, Vec<u8>> {
        Channel::new(BufReader::new(Pieces(pieces)), Vec::new())
    }

    const READ: Request = Request::PowerOff;

    #[test]
    fn a_late_answer_is_discarded() {
        let stands_still = String::new();
        let mut channel = channel(vec![stands_still, line(1, Answer::Started(6)), line(2, Answer::Done)]);
        assert!(channel.request(&READ).is_err(), "given up");
        assert_eq!(channel.request(&READ).expect("an answer"), Answer::Done);
    }

    #[test]
    fn a_line_that_comes_in_two_parts_is_one_answer() {
        let whole = line(2, Answer::Text("x".to_owned()));
        let (one, other) = whole.split_at(9);
        let mut channel = channel(vec![one.to_owned(), String::new(), other.to_owned()]);
        assert!(channel.request(&READ).is_err(), "the rest does not come in time");
        assert_eq!(channel.request(&READ).expect("an answer"), Answer::Text("x".to_owned()));
    }

    #[test]
    fn a_request_is_bounded_by_the_clock_of_the_guest() {
        let seconds = |count: u32| vec![line(UNASKED, Answer::Second); count as usize];
        let answered = |seconds_before: u32| {
            let mut channel = channel([seconds(seconds_before), vec![line(1, Answer::Done)]].concat());
            channel.request(&READ).is_ok()
        };
        assert!(answered(REQUEST_LIMIT_S) && !answered(REQUEST_LIMIT_S + 1));
    }

    #[test]
    fn a_guest_that_has_ended_is_an_error() {
        assert!(channel(Vec::new()).await_up().is_err());
        assert!(channel(vec![line(UNASKED, Answer::Up)]).await_up().is_ok());
    }
}
