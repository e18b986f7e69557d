//! A host on tokio, with tokio-util's `Framed` and the protocol's codec: no other code of the bench is involved.

use std::fs::File;
use std::time::Duration;

use futures_util::{SinkExt, StreamExt};
use lashloop_protocol::codec::Codec;
use lashloop_protocol::enums::{Outcome, State};
use lashloop_protocol::message::{Arm, EncoderSample, Hello, Start, Stop, Subscribe};
use lashloop_protocol::{DriveMessage, EncoderCounts, HostMessage, Message, Numbered, PROTOCOL_VERSION};
use rustix::fs::{OFlags, fcntl_getfl, fcntl_setfl};
use tests::terminal::open_near_end;
use tests::twin::Twin;
use tests::wait::SOON;
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::net::unix::pipe::{Receiver, Sender};
use tokio_util::codec::Framed;

const SESSION: u32 = 0x1a5_4100;
/// Signal 0 of every Lashloop drive is `requested_torque_nm`.
const REQUESTED_TORQUE_EVERY_4: Subscribe = Subscribe { signals: 1, every: 4 };

/// A terminal as tokio reads and writes it: to the reactor it is a pipe in either direction.
fn asynchronous(terminal: File) -> impl AsyncRead + AsyncWrite + Unpin {
    let flags = fcntl_getfl(&terminal).expect("flags of the terminal");
    fcntl_setfl(&terminal, flags | OFlags::NONBLOCK).expect("a terminal that doesn't block");
    let reader = terminal.try_clone().expect("a second handle");
    let reader = Receiver::from_file_unchecked(reader).expect("a terminal to read");
    let writer = Sender::from_file_unchecked(terminal).expect("a terminal to write");
    tokio::io::join(reader, writer)
}

struct Line<Io> {
    frames: Framed<Io, Codec<DriveMessage, HostMessage>>,
    /// Number of the last request.
    number: u8,
}

impl<Io: AsyncRead + AsyncWrite + Unpin> Line<Io> {
    async fn request(&mut self, request: impl Into<HostMessage>) -> DriveMessage {
        let message = request.into();
        self.number = self.number % u8::MAX + 1;
        let request = Numbered { number: self.number, message };
        self.frames.send(request).await.expect("the line takes a frame");
        self.receive().await
    }

    async fn receive(&mut self) -> DriveMessage {
        let item = tokio::time::timeout(SOON, self.frames.next()).await.expect("the drive answers in time");
        let item = item.expect("the line stays up").expect("the line can be read").expect("a good frame");
        let expected = if item.message.layout().has_number() { self.number } else { 0 };
        assert_eq!(item.number, expected, "{item:?}");
        item.message
    }

    async fn command(&mut self, request: impl Into<HostMessage>) -> State {
        match self.request(request).await {
            DriveMessage::CommandResult(result) => {
                assert_eq!(result.outcome, Outcome::Accepted, "{result:?}");
                result.state
            }
            other => panic!("a result was expected, not {other:?}"),
        }
    }
}

async fn converse(terminal: File) -> Vec<f32> {
    let frames = Framed::new(asynchronous(terminal), Codec::default());
    let mut line = Line { frames, number: 0 };
    let DriveMessage::Identity(identity) = line.request(Hello::new(SESSION)).await else {
        panic!("an identity was expected")
    };
    assert_eq!((identity.protocol_version, identity.session), (PROTOCOL_VERSION, SESSION));
    assert_eq!((identity.board.as_str(), identity.state), ("native-twin", State::Idle));
    assert_eq!(line.command(REQUESTED_TORQUE_EVERY_4).await, State::Idle);
    assert_eq!(line.command(Arm { session: SESSION }).await, State::Armed);
    assert_eq!(line.command(Start { session: SESSION }).await, State::Running);
    let mut torques_nm = Vec::new();
    let [motor_counts, load_counts] = [301, 100].map(EncoderCounts::wrapping);
    for sequence in 0..10 {
        // At rest, off the reference and, read at the middles of the counts, without twist: 301.5 = 3 * 100.5.
        let sample = EncoderSample { sequence, motor_counts, load_counts, reference_rad: 0.0 };
        let DriveMessage::TorqueAnswer(answer) = line.request(sample).await else {
            panic!("a torque was expected")
        };
        assert_eq!((answer.sequence, answer.status.state), (sequence, State::Running));
        torques_nm.push(answer.torque_nm);
        if sequence % REQUESTED_TORQUE_EVERY_4.every == 0 {
            let DriveMessage::Telemetry(telemetry) = line.receive().await else {
                panic!("telemetry was expected")
            };
            assert_eq!(telemetry.sequence, sequence);
            assert_eq!(telemetry.values.as_slice(), [answer.torque_nm]);
        }
    }
    let DriveMessage::LineReport(report) = line.request(Stop {}).await else {
        panic!("a line report was expected")
    };
    // The ten samples and the stop itself.
    assert_eq!((report.messages, report.damaged, report.refused, report.overruns), (11, 0, 0, 0));
    let DriveMessage::CommandResult(stopped) = line.receive().await else { panic!("a result was expected") };
    assert_eq!((stopped.outcome, stopped.state), (Outcome::Accepted, State::Idle));
    let counters = line.frames.codec().counters();
    assert_eq!((counters.damaged(), counters.refused), (0, 0));
    torques_nm
}

#[test]
fn a_tokio_host_runs_the_twin() {
    let twin = Twin::start();
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().expect("a runtime");
    let terminal = open_near_end(twin.path());
    let conversation = async { tokio::time::timeout(Duration::from_secs(60), converse(terminal)).await };
    let torques_nm = runtime.block_on(conversation).expect("the conversation ends in time");
    // By default the drive is the plain cascade. At rest and without twist it gives -(k_p2 + N0) k_p1 theta_s.
    let want_nm = -13.0 * 100.5 * std::f32::consts::TAU / 131_072.0;
    assert_eq!(torques_nm.len(), 10);
    for have_nm in torques_nm {
        assert!((have_nm - want_nm).abs() <= 1e-6, "have {have_nm} N m, want {want_nm} N m");
    }
}
