//! The program, a short run and tshark.

use std::env;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use lashloop_decode::message::AnyMessage;
use lashloop_protocol::enums::{Outcome, State};
use lashloop_protocol::message::{CommandResult, Subscribe};
use lashloop_protocol::wire::Payload;
use lashloop_protocol::{DriveMessage, Message};
use lashloop_record::reader::Record;
use tempfile::TempDir;

use crate::examples::{self, NUMBER};

pub const LASHLOOP: &str = env!("CARGO_BIN_EXE_lashloop");
/// Control steps of [`short_run`].
pub const STEPS: usize = 200;

pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().nth(2).unwrap()
}

pub fn lashloop(arguments: &[&str], input: &[u8]) -> Output {
    let mut command = Command::new(LASHLOOP);
    command.args(arguments).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    child.stdin.take().unwrap().write_all(input).unwrap();
    child.wait_with_output().unwrap()
}

pub fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

/// The frames of every pinned message, the host's first.
pub fn example_frames() -> Vec<Vec<u8>> {
    let from_host = examples::from_host().into_iter().map(|message| message.numbered_frame(NUMBER).to_vec());
    let from_drive =
        examples::from_drive().into_iter().map(|message| message.numbered_frame(NUMBER).to_vec());
    from_host.chain(from_drive).collect()
}

/// The frame of the pinned message of this name.
pub fn example_frame(name: &str) -> Vec<u8> {
    let at = AnyMessage::LAYOUTS.iter().position(|layout| layout.name == name);
    example_frames().swap_remove(at.unwrap_or_else(|| panic!("no message {name}")))
}

/// The pinned subscription, accepted, with the description of one of its signals before it and its telemetry after it.
pub fn subscribed_frames() -> Vec<Vec<u8>> {
    let accepted = CommandResult {
        request: Subscribe::LAYOUT.kind,
        outcome: Outcome::Accepted,
        state: State::Idle,
        detail: 0,
        device_time_us: None,
    };
    let accepted = DriveMessage::from(accepted).numbered_frame(NUMBER).to_vec();
    let [description, subscribe, telemetry] =
        ["SignalDescription", "Subscribe", "Telemetry"].map(example_frame);
    vec![description, subscribe, accepted, telemetry]
}

pub struct Run {
    _folder: TempDir,
    pub capture: PathBuf,
    /// Column `torque_nm` of the record.
    pub torques_nm: Vec<f64>,
}

/// A run with the native twin, a process of its own, over a pseudo-terminal.
pub fn short_run() -> Run {
    let folder = tempfile::tempdir().unwrap();
    let capture = folder.path().join("line.pcapng");
    let scenario = root().join("scenarios/smooth-after.toml");
    let duration = format!("run.duration_s={}", STEPS as f64 * 1e-3);
    let [scenario, out, file] = [&scenario, folder.path(), &capture].map(|path| path.to_str().unwrap());
    let ended = lashloop(&["run", scenario, "--set", &duration, "--out", out, "--capture", file], &[]);
    // A run this short misses its expectations; only its record matters here.
    assert_eq!(ended.status.code(), Some(1), "{}", text(&ended.stderr));
    let torques_nm = Record::read(folder.path()).unwrap().trace.get("torque_nm").unwrap().to_vec();
    Run { _folder: folder, capture, torques_nm }
}

/// Output of tshark with the dissector. `None`, with a notice on standard error, if tshark is missing.
pub fn tshark(capture: &Path, arguments: &[&str]) -> Option<String> {
    let path = env::var_os("PATH").unwrap_or_default();
    if !env::split_paths(&path).any(|folder| folder.join("tshark").is_file()) {
        let notice = "SKIPPED: the Wireshark dissector is not tested, because tshark is missing; \
                        `cargo xtask setup` installs it, or on Debian `apt-get install tshark`";
        assert!(env::var_os("LASHLOOP_REQUIRE_EQUIPMENT").is_none(), "{notice}");
        // Directly to standard error: the test runner captures the output of passing tests.
        let _ = writeln!(io::stderr(), "{notice}");
        return None;
    }
    let script = format!("lua_script:{}", root().join("tools/wireshark/lashloop.lua").display());
    let mut command = Command::new("tshark");
    command.args(["-X", &script, "-r"]).arg(capture).args(arguments);
    let output = command.stdin(Stdio::null()).output().unwrap();
    let errors = text(&output.stderr);
    assert!(output.status.success() && !errors.to_lowercase().contains("lua"), "{errors}");
    Some(text(&output.stdout).to_owned())
}
