//! The conversation of the document, byte by byte, with the image on virtual silicon.

use std::io::{Read, Write};
use std::process::{Child, ChildStdout, Command, Stdio};
use std::time::{Duration, Instant};

use lashloop_firmware::drive::PinParameters;
use lashloop_firmware::law::ParameterGroup;
use lashloop_protocol::enums::Capabilities;
use lashloop_protocol::message::{CommandResult, Identity, LineReport, ParameterReport, TorqueAnswer};
use lashloop_protocol::{Decoder, DriveMessage, Message};
use rustix::event::{PollFd, PollFlags, Timespec, poll};

use crate::equipment;
use crate::script::{Side, script};

/// Time that an answer may take on a busy machine.
const PATIENCE: Duration = Duration::from_secs(20);
/// Longest time that a control step of `pd` may take, as the drive reports it.
const LONGEST_STEP_TENTHS_US: u16 = 1000;

/// Parameters of bench mode, which the board offers after all others.
const OF_BENCH_MODE: u8 = PinParameters::TABLE.len() as u8;

/// The image's end of the line. Dropping it ends the process.
struct Line {
    silicon: Child,
    from_drive: ChildStdout,
}

impl Line {
    fn start() -> Self {
        let mut silicon = Command::new(equipment::program())
            .arg(equipment::image())
            .arg("--lockstep")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("lashloop-silicon starts");
        let from_drive = silicon.stdout.take().expect("its standard output");
        Self { silicon, from_drive }
    }

    fn send(&mut self, bytes: &[u8]) {
        self.silicon.stdin.as_mut().expect("its standard input").write_all(bytes).expect("a pipe");
    }

    /// The next `count` bytes of the drive.
    fn receive(&mut self, count: usize) -> Vec<u8> {
        let deadline = Instant::now() + PATIENCE;
        let mut bytes = Vec::new();
        while bytes.len() < count {
            let left = deadline.saturating_duration_since(Instant::now());
            let timeout =
                Timespec { tv_sec: left.as_secs().cast_signed(), tv_nsec: left.subsec_nanos().into() };
            let mut fds = [PollFd::new(&self.from_drive, PollFlags::IN)];
            let ready = poll(&mut fds, Some(&timeout)).expect("a pipe can be polled");
            assert!(ready > 0, "{} of {count} bytes came: {bytes:02x?}", bytes.len());
            let mut piece = vec![0; count - bytes.len()];
            let read = self.from_drive.read(&mut piece).expect("a pipe");
            assert!(read > 0, "the line closed after {bytes:02x?}");
            bytes.extend(&piece[..read]);
        }
        bytes
    }

    /// Closes the line, and returns the exit code of the process.
    fn close(mut self) -> Option<i32> {
        drop(self.silicon.stdin.take());
        self.silicon.wait().expect("it can be waited for").code()
    }
}

impl Drop for Line {
    fn drop(&mut self) {
        let _ = self.silicon.kill();
        let _ = self.silicon.wait();
    }
}

/// The documented frame with what depends on build, board and clock as in the frame that came.
fn as_came(documented: &[u8], came: &[u8]) -> Vec<u8> {
    let decode = |frame: &[u8]| Decoder::new().next::<DriveMessage>(&mut &frame[..]);
    let (Some(Ok(documented_item)), Some(Ok(came))) = (decode(documented), decode(came)) else {
        return documented.to_vec();
    };
    let message = match (documented_item.message, came.message) {
        (DriveMessage::Identity(identity), DriveMessage::Identity(came)) => {
            let Identity { firmware, build_id, dirty, capabilities, device_time_us, .. } = came;
            // The page has the conversation of a drive without pins.
            let parameter_count = identity.parameter_count + OF_BENCH_MODE;
            assert_eq!(capabilities, Capabilities::all());
            Identity { firmware, build_id, dirty, parameter_count, capabilities, device_time_us, ..identity }
                .into()
        }
        (DriveMessage::ParameterReport(report), DriveMessage::ParameterReport(came)) => {
            ParameterReport { device_time_us: came.device_time_us, ..report }.into()
        }
        (DriveMessage::LineReport(report), DriveMessage::LineReport(came)) => {
            LineReport { device_time_us: came.device_time_us, ..report }.into()
        }
        (DriveMessage::CommandResult(result), DriveMessage::CommandResult(came)) => {
            CommandResult { device_time_us: came.device_time_us, ..result }.into()
        }
        (DriveMessage::TorqueAnswer(answer), DriveMessage::TorqueAnswer(came)) => {
            let compute_tenths_us = came.compute_tenths_us;
            assert!(
                compute_tenths_us <= LONGEST_STEP_TENTHS_US,
                "a step took {compute_tenths_us} tenths of a us"
            );
            TorqueAnswer { compute_tenths_us, ..answer }.into()
        }
        _ => return documented.to_vec(),
    };
    DriveMessage::numbered_frame(&message, documented_item.number).to_vec()
}

/// Boots from the crystal: the identity has the board of a crystal, and no log line reports another clock.
pub(crate) fn byte_by_byte() {
    let mut line = Line::start();
    line.send(&[0]);
    for (number, (side, frame)) in script().into_iter().enumerate() {
        match side {
            Side::Host => line.send(&frame),
            Side::Drive => {
                // Fields with other values may have other zeros; the length of a frame stays.
                let came = line.receive(frame.len());
                assert_eq!(came, as_came(&frame, &came), "frame {number} of the document");
            }
        }
    }
    assert_eq!(line.close(), Some(0), "an access that the chip doesn't serve");
}
