//! Instructions of the codec on a Cortex-M4F, counted by the emulator.
//!
//! QEMU takes the same time for every instruction here, so the counts are the same in every run and on every machine. They
//! are instructions, not cycles: flash wait states and the pipeline are not included.

use std::fmt;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc;
use std::thread;
use std::time::{Duration, Instant};

/// The image prints all its counts within a second.
const LIMIT: Duration = Duration::from_secs(60);

/// Instructions for one message.
#[derive(Debug, PartialEq, Eq)]
pub struct Cost {
    pub message: String,
    pub frame_bytes: u32,
    pub encode: u32,
    pub decode: u32,
}

/// All counts of the image.
#[derive(Debug, PartialEq, Eq)]
pub struct Costs {
    /// For a loop of 2,002 instructions and its call.
    pub known_loop: u32,
    pub messages: Vec<Cost>,
}

impl fmt::Display for Costs {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            out,
            "| message | bytes | encode, instructions | decode, instructions |\n|---|---|---|---|"
        )?;
        for Cost { message, frame_bytes, encode, decode } in &self.messages {
            writeln!(out, "| {message} | {frame_bytes} | {encode} | {decode} |")?;
        }
        writeln!(out, "a loop of 2,002 instructions and its call: {}", self.known_loop)
    }
}

/// The emulator. Dropping it kills the process.
struct Emulator(Child);

impl Drop for Emulator {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Runs the image.
///
/// # Panics
/// The image does not print its counts within a minute.
pub fn count(image: &Path) -> Costs {
    let words = ["-M", "netduinoplus2", "-icount", "shift=6", "-display", "none", "-monitor", "none"];
    let mut emulator = Emulator(
        Command::new("qemu-system-arm")
            .args(words)
            .args(["-serial", "null", "-serial", "stdio", "-kernel"])
            .arg(image)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .spawn()
            .expect("the emulator starts"),
    );
    let output = emulator.0.stdout.take().expect("a pipe");
    let (sender, lines) = mpsc::channel();
    thread::spawn(move || {
        BufReader::new(output).lines().map_while(Result::ok).try_for_each(|line| sender.send(line))
    });
    let deadline = Instant::now() + LIMIT;
    let printed: Vec<String> = std::iter::from_fn(|| {
        let left = deadline.saturating_duration_since(Instant::now());
        Some(lines.recv_timeout(left).expect("the image prints \"end\" in time"))
    })
    .take_while(|line| line != "end")
    .collect();
    parse(&printed).unwrap_or_else(|| panic!("the image printed {printed:?}"))
}

fn parse(lines: &[String]) -> Option<Costs> {
    let (known, messages) = lines.split_first()?;
    let known_loop = known.strip_prefix("loop-of-2002 ")?.parse().ok()?;
    let messages = messages.iter().map(|line| {
        let mut words = line.split(' ');
        let message = words.next()?.to_owned();
        let [frame_bytes, encode, decode] = words.map(str::parse).collect::<Result<Vec<_>, _>>().ok()?[..]
        else {
            return None;
        };
        Some(Cost { message, frame_bytes, encode, decode })
    });
    Some(Costs { known_loop, messages: messages.collect::<Option<_>>()? })
}
