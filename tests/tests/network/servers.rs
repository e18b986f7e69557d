//! Each server passes the bytes of the native twin, or of the image, through a port of this machine. The torques must be
//! those of the direct line, bit for bit.

use std::fs;
use std::net::{TcpListener, TcpStream};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};

use tests::program;
use tests::records::Records;
use tests::twin::Twin;
use tests::{python, wait, workspace};

/// Long enough for every value of a byte to pass, and short for a server that takes milliseconds for each step.
const DURATION: &str = "run.duration_s=0.5";

pub(crate) fn ser2net_missing() -> Option<String> {
    find("ser2net").is_none().then(|| "ser2net is not installed: run `cargo xtask setup`".to_owned())
}

pub(crate) fn emulator_missing() -> Option<String> {
    let has_all = find("qemu-system-arm").is_some() && image().is_file();
    (!has_all).then(|| "no emulator or no image: run `cargo xtask setup` and `cargo xtask image`".to_owned())
}

fn image() -> PathBuf {
    workspace().join("target/lashloop-firmware.elf")
}

fn find(program: &str) -> Option<PathBuf> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let folders = std::env::split_paths(&path).chain([PathBuf::from("/usr/sbin")]);
    folders.map(|folder| folder.join(program)).find(|path| path.is_file())
}

/// A server in a process of its own. Dropping it kills the process.
struct Server {
    child: Child,
    port: u16,
    _folder: tempfile::TempDir,
}

impl Server {
    /// Starts the command that `build` makes for a free port and a folder, and waits for the port to open.
    fn start(build: impl FnOnce(u16, &tempfile::TempDir) -> Command) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let port =
            TcpListener::bind("127.0.0.1:0").and_then(|it| it.local_addr()).expect("a free port").port();
        let mut command = build(port, &folder);
        let child = command.stdin(Stdio::null()).stdout(Stdio::null()).spawn().expect("the server starts");
        let server = Self { child, port, _folder: folder };
        server.wait_until_open();
        server
    }

    /// The kernel lists the ports that are listened on; a connection would occupy the serial port.
    fn wait_until_open(&self) {
        let port = format!("0100007F:{:04X} 00000000:0000 0A", self.port);
        wait::until("the port of the server", || {
            fs::read_to_string("/proc/net/tcp").expect("the list of ports").contains(&port).then_some(())
        });
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn ser2net(twin: &Twin, accepter: &str) -> Server {
    Server::start(|port, folder| {
        let file = folder.path().join("ser2net.yaml");
        // Without the delay that collects characters, or each step takes milliseconds.
        let configuration = format!(
            "connection: &drive\n  accepter: {accepter}tcp,127.0.0.1,{port}\n  connector: serialdev,{},115200n81,local\n  \
             options:\n    chardelay: false\n",
            twin.device()
        );
        fs::write(&file, configuration).expect("the configuration");
        let mut command = Command::new(find("ser2net").expect("ser2net"));
        command.args(["-n", "-c"]).arg(file).stderr(Stdio::null());
        command
    })
}

/// Torques of a run on the native twin, without a server.
fn direct() -> String {
    torques("native")
}

fn torques(device: &str) -> String {
    let records = Records::new();
    let arguments = [
        "run",
        "scenarios/smooth-after.toml",
        "--device",
        device,
        "--out",
        &records.out(),
        "--set",
        DURATION,
    ];
    // The run is too short for the expectation of the scenario.
    let _ = program::run(arguments).with_code(1);
    let summary = records.summary();
    assert_eq!(
        (&summary["link"]["lost"], &summary["link"]["crc_errors"]),
        (&0.into(), &0.into()),
        "{device}"
    );
    summary["torque_sha256"].as_str().expect("a digest").to_owned()
}

pub(crate) fn ser2net_raw() {
    let twin = Twin::start();
    let server = ser2net(&twin, "");
    assert_eq!(torques(&format!("tcp:127.0.0.1:{}", server.port)), direct());
}

pub(crate) fn ser2net_rfc2217() {
    let twin = Twin::start();
    let server = ser2net(&twin, "telnet(rfc2217),");
    assert_eq!(torques(&format!("rfc2217:127.0.0.1:{}", server.port)), direct());
}

pub(crate) fn ser2net_confused() {
    let twin = Twin::start();
    let server = ser2net(&twin, "telnet(rfc2217),");
    let device = format!("tcp:127.0.0.1:{}", server.port);
    let ended = program::run(["run", "scenarios/smooth-after.toml", "--device", &device]).with_code(4);
    assert!(ended.stderr.contains("name it rfc2217:HOST:PORT"), "{}", ended.stderr);
}

pub(crate) fn pyserial() {
    let twin = Twin::start();
    let server = Server::start(|port, _| {
        let mut command = Command::new(python::interpreter());
        command.arg(workspace().join("tests/data/rfc2217_server.py")).arg(twin.path()).arg(port.to_string());
        command
    });
    assert_eq!(torques(&format!("rfc2217:127.0.0.1:{}", server.port)), direct());
}

pub(crate) fn qemu() {
    let server = Server::start(|port, _| {
        let mut command = Command::new("qemu-system-arm");
        let uart = format!("tcp:127.0.0.1:{port},server=on,wait=off,nodelay=on");
        command.args([
            "-M",
            "netduinoplus2",
            "-display",
            "none",
            "-monitor",
            "none",
            "-serial",
            "null",
            "-serial",
        ]);
        command.arg(uart).arg("-kernel").arg(image());
        command
    });
    assert_eq!(torques(&format!("tcp:127.0.0.1:{}", server.port)), direct());
    // A connection isn't part of the board: the next run finds it as the last one left it.
    drop(TcpStream::connect(("127.0.0.1", server.port)));
    assert_eq!(torques(&format!("tcp:127.0.0.1:{}", server.port)), direct());
}
