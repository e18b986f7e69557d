//! Drives behind a TCP port: what a user reads when the network fails.

use std::io::Write;
use std::net::{TcpListener, TcpStream};
use std::process::{Child, Command};
use std::thread;
use std::time::Instant;

use tests::c_drive;
use tests::loss::{assert_reported, scenario_in_progress};
use tests::program;

const SCENARIO: &str = "examples/drive-in-c/scenario.toml";

/// A port of this machine, as `--device` takes it after the scheme.
fn listener() -> (TcpListener, String) {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let address = listener.local_addr().expect("its address").to_string();
    (listener, address)
}

/// Serves the drive in C to the first connection.
fn serve(listener: TcpListener) -> thread::JoinHandle<(Child, TcpStream)> {
    // Built before a bench connects, which waits for the drive no longer than a user would.
    let drive = c_drive::path();
    thread::spawn(move || {
        let (stream, _) = listener.accept().expect("a connection");
        stream.set_nodelay(true).expect("a socket");
        let end = || std::os::fd::OwnedFd::from(stream.try_clone().expect("a duplicate"));
        let drive = Command::new(drive).stdin(end()).stdout(end()).spawn().expect("the drive starts");
        (drive, stream)
    })
}

fn sentence(device: &str) -> String {
    let ended = program::run(["run", SCENARIO, "--device", device]).with_code(4);
    assert_eq!(ended.stderr.lines().count(), 1, "{}", ended.stderr);
    ended.stderr
}

#[test]
fn a_drive_behind_a_port_runs_its_scenario() {
    let (listener, address) = listener();
    let server = serve(listener);
    let ended = program::run(["run", SCENARIO, "--device", &format!("tcp:{address}")]).with_code(0);
    assert!(ended.stdout.contains(&format!("tcp:{address} (c-example, ")), "{}", ended.stdout);
    let (mut drive, _) = server.join().expect("the server");
    assert!(drive.wait().expect("the drive ends").success(), "the drive sees the end of the line");
}

#[test]
fn a_connection_that_fails_is_named_with_its_remedy() {
    let refused = listener().1;
    for scheme in ["tcp", "rfc2217"] {
        let ended = sentence(&format!("{scheme}:{refused}"));
        assert!(ended.contains("connection refused; does the server run"), "{ended}");
        let ended = sentence(&format!("{scheme}:no-such-host.invalid:4000"));
        assert!(ended.contains("no host has the name no-such-host.invalid ("), "{ended}");
    }
}

#[test]
fn a_silent_server_times_out_with_advice() {
    let (listener, address) = listener();
    let _held = thread::spawn(move || listener.incoming().flatten().collect::<Vec<_>>());
    let ended = sentence(&format!("tcp:{address}"));
    assert!(ended.contains("no byte arrived: no drive, no power, or another port"), "{ended}");
    let ended = sentence(&format!("rfc2217:{address}"));
    assert!(ended.contains("name a server of raw bytes tcp:HOST:PORT"), "{ended}");
}

#[test]
fn a_telnet_server_is_recognised_on_a_raw_port() {
    let (listener, address) = listener();
    let _server = thread::spawn(move || {
        let (mut stream, _) = listener.accept().expect("a connection");
        stream.write_all(&[255, 251, 3, 255, 251, 1]).expect("a connection");
        thread::park();
    });
    let ended = sentence(&format!("tcp:{address}"));
    assert!(ended.contains("sends telnet commands, not raw bytes: name it rfc2217:HOST:PORT"), "{ended}");
}

#[test]
fn a_connection_that_is_closed_during_a_run_is_reported() {
    let (listener, address) = listener();
    let server = serve(listener);
    let (bench, records) = scenario_in_progress(SCENARIO, &format!("tcp:{address}"));
    let (mut drive, stream) = server.join().expect("the server");
    let lost_at = Instant::now();
    stream.shutdown(std::net::Shutdown::Both).expect("an open connection");
    let sentence = assert_reported(bench, &records, lost_at);
    assert!(sentence.contains("the far end closed the line"), "{sentence}");
    let _ = drive.wait();
}
