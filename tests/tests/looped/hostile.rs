//! Far ends that aren't drives, and drives that keep a command waiting: every command ends soon, with one diagnosis.

use std::fs;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, Instant};

use lashloop_protocol::DriveMessage;
use lashloop_protocol::enums::LogLevel;
use lashloop_protocol::message::{
    ChoiceDescription, Identity, LawDescription, Log, ParameterDescription, SignalDescription,
};
use lashloop_protocol::text::Text;
use lashloop_record::reader::Record;
use tests::program;
use tests::relay::{Action, Relay};
use tests::twin::Twin;

const SCENARIO: &str = "scenarios/smooth-after.toml";

/// Far ends without a good frame, and the words of their diagnosis. Random bytes arrive as fast as a pipe takes them, the others at
/// the rate of a line.
const FAR_ENDS: [(&str, &str); 6] = [
    ("exec:sleep 100", "no byte arrived: no drive, no power, or another port or baud rate"),
    ("exec:cat", "the far end returns the bench's own frames"),
    ("exec:sh -c 'while echo y; do sleep 0.01; done'", "the far end sends text, \"y\""),
    ("exec:sh -c 'while head -c 64 /dev/zero; do sleep 0.01; done'", "zero bytes alone"),
    ("exec:cat /dev/urandom", "no frame of a drive: another baud rate"),
    ("exec:sh -c 'stty sane <$0; exec cat <$0' {tty}", "a terminal in cooked mode echoes"),
];

/// Time for a handshake of 2.5 s and the end of the process, with 10 s on top for a busy machine.
const LIMIT: Duration = Duration::from_secs(14);

fn commands(device: &str) -> [Vec<&str>; 4] {
    [
        vec!["run", SCENARIO, "--device", device],
        vec!["parameters", "list", "--device", device],
        vec!["doctor", device],
        vec!["conformance", "--device", device],
    ]
}

#[test]
fn every_command_ends_with_the_same_diagnosis() {
    // The first run may have to build the program.
    let _ = program::run(["--version"]).with_code(0);
    for (device, words) in FAR_ENDS {
        for arguments in commands(device) {
            let started = Instant::now();
            let ended = program::run(&arguments).with_code(4);
            let took = ended.at - started;
            let output = format!("{}{}", ended.stdout, ended.stderr);
            assert!(output.contains(words), "{arguments:?}: {output}");
            assert!(took < LIMIT, "{arguments:?} took {took:?}");
        }
    }
}

/// A name that clears a terminal, sets its title and reverses the direction of the text.
const EVIL: &str = "\u{1b}[2J\u{1b}]0;x\u{7}\u{202e}";

/// The messages of a good drive with evil texts. Indices keep the names apart.
fn with_evil_texts(message: DriveMessage) -> DriveMessage {
    let evil = |index: u8| format!("{EVIL}{index}");
    match message {
        DriveMessage::Identity(it) => Identity { board: Text::new(EVIL), ..it }.into(),
        DriveMessage::LawDescription(it) => {
            let name = if it.index < 2 { it.name } else { Text::new(&evil(it.index)) };
            LawDescription { name, ..it }.into()
        }
        // The scenario chooses "model".
        DriveMessage::ChoiceDescription(it) if it.name.as_str() != "model" => {
            ChoiceDescription { name: Text::new(&evil(it.choice)), ..it }.into()
        }
        DriveMessage::ParameterDescription(it) => {
            ParameterDescription { unit: Text::new("\u{9b}31m"), ..it }.into()
        }
        DriveMessage::SignalDescription(it) => {
            SignalDescription { name: Text::new(&evil(it.index)), unit: Text::new("\u{1b}c"), ..it }.into()
        }
        DriveMessage::TorqueAnswer(it) if it.sequence == 3 => {
            Log { level: LogLevel::Warning, text: Text::new(EVIL), device_time_us: None }.into()
        }
        other => other,
    }
}

fn assert_harmless(what: &str, text: &str) {
    let is_harmful =
        |c: char| (c.is_control() && !"\n\r\t".contains(c)) || matches!(c, '\u{202a}'..='\u{202e}');
    let found: Vec<_> = text.lines().filter(|line| line.contains(is_harmful)).collect();
    assert!(found.is_empty(), "{what}: {found:?}");
}

fn assert_files_harmless(folder: &Path) {
    let files = fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("a file").path());
    let is_text = |file: &PathBuf| file.extension().is_some_and(|it| it != "pcapng" && it != "mcap");
    for file in files.filter(is_text) {
        let text = fs::read_to_string(&file).expect("a text");
        assert_harmless(&file.display().to_string(), &text);
    }
}

#[test]
fn text_of_a_drive_reaches_no_output_raw() {
    let twin = Twin::start();
    let relay = Relay::start(twin.path(), |frame| match frame.from_drive() {
        Some(message) => frame.replaced(with_evil_texts(message)),
        None => Action::Forward,
    });
    let folder = tempfile::tempdir().expect("a folder");
    let [record, capture] = ["record", "line.pcapng"].map(|name| folder.path().join(name));
    let [record, capture] = [&record, &capture].map(|path| path.to_str().expect("a path of ASCII"));
    let device = relay.device();
    let mut run = vec!["run", SCENARIO, "--device", device, "--out", record, "--capture", capture];
    run.extend(["--set", "run.duration_s=0.1"]);
    let commands = [
        run,
        vec!["parameters", "list", "--device", device],
        vec!["parameters", "dump", "--device", device],
        vec!["doctor", device],
        vec!["plot", record],
        vec!["decode", capture],
        vec!["decode", capture, "--json"],
    ];
    let mut shown = 0;
    for arguments in commands {
        let ended = program::run(&arguments);
        for text in [&ended.stdout, &ended.stderr] {
            assert_harmless(&format!("{arguments:?}"), text);
            shown += text.matches("\\u{1b}").count();
        }
    }
    assert!(shown > 10, "the texts are shown, escaped: {shown}");
    assert_files_harmless(record.as_ref());
    let logs = Record::read(record.as_ref()).expect("a record").logs;
    let [log] = &logs[..] else { panic!("one text in the place of an answer: {logs:?}") };
    assert!((3..=4).contains(&log.step) && log.text.starts_with("Warning: "), "{log:?}");
}

#[test]
fn a_drive_that_answers_just_in_time_does_not_hold_a_run() {
    let twin = Twin::start();
    let relay = Relay::start(twin.path(), |frame| {
        if frame.torque().is_some() {
            thread::sleep(Duration::from_millis(800));
        }
        Action::Forward
    });
    let started = Instant::now();
    // A machine that stands still must not be taken for a silent host.
    let patient = ["--set", "link.silence_limit_ms=20000"];
    // 15 samples of 0.8 s exceed 10 s and 0.1 s a sample; all 25,000 would take more than five hours.
    let run = ["run", SCENARIO, "--device", relay.device()];
    let ended = program::run(run.into_iter().chain(patient)).with_code(4);
    let took = ended.at - started;
    assert!(ended.stderr.contains("link.mean_wait_ms = 100 for each sample"), "{}", ended.stderr);
    assert!((Duration::from_secs(10)..Duration::from_secs(30)).contains(&took), "took {took:?}");
}
