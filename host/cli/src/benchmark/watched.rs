//! The loop as it is watched: by a record on the disk, and by a live page whose reader takes nothing.

use std::io::{self, Write as _};
use std::net::{Ipv4Addr, SocketAddr, TcpStream};

use lashloop_bench::run::{self, Clock, DeviceUnderTest, Outcome};
use lashloop_bench::scenario::Scenario;
use lashloop_record::folder::RecordFolder;
use lashloop_record::source::RunSource;
use lashloop_record::writer::RecordWriter;
use rustix::net::sockopt::set_socket_recv_buffer_size;
use rustix::net::{AddressFamily, SocketFlags, SocketType, connect, socket_with};

use crate::error::{CliError, system};
use crate::monitor::Monitor;
use lashloop_live::Live;

/// Makes the run with a record in a temporary folder.
pub(super) fn recorded(
    scenario: &Scenario,
    device: &mut DeviceUnderTest,
    clock: Clock,
) -> Result<Outcome, CliError> {
    let parent = tempfile::tempdir().map_err(system("create a temporary folder"))?;
    let folder = RecordFolder::claim(&parent.path().join("run"), false)?;
    let mut record = RecordWriter::new(folder, RunSource::default());
    Ok(run::run(scenario, device, clock, &mut record)?)
}

/// Makes the run with a live page and its stalled reader.
pub(super) fn live(
    scenario: &Scenario,
    device: &mut DeviceUnderTest,
    clock: Clock,
) -> Result<Outcome, CliError> {
    let server = Live::start(SocketAddr::from((Ipv4Addr::LOCALHOST, 0)), None)?;
    let reader = stalled_reader(server.address()).map_err(system("connect to the live page"))?;
    let mut monitor = Monitor::new(scenario, None, Some(server.publisher()));
    let outcome = run::run(scenario, device, clock, &mut monitor)?;
    // The server would wait for the reader to take the end.
    drop(reader);
    Ok(outcome)
}

const RECEIVE_BUFFER_BYTES: usize = 2048;
/// The key is any 16 bytes in base64.
const REQUEST: &[u8] =
    b"GET /feed HTTP/1.1\r\nHost: localhost\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n\
    Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n";

/// A reader of the live page that never reads, with a small buffer: what is sent to it gets stuck at once.
fn stalled_reader(address: SocketAddr) -> io::Result<TcpStream> {
    let socket = socket_with(AddressFamily::INET, SocketType::STREAM, SocketFlags::CLOEXEC, None)?;
    set_socket_recv_buffer_size(&socket, RECEIVE_BUFFER_BYTES)?;
    connect(&socket, &address)?;
    let mut stream = TcpStream::from(socket);
    stream.write_all(REQUEST)?;
    Ok(stream)
}
