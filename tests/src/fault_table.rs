//! The table of `docs/faults.md`: what becomes of a run with a fault in it. It is read here and held against runs, so the
//! document says what happens and nothing else.

use std::fs;
use std::path::PathBuf;

use lashloop_decode::capture::reader;
use lashloop_protocol::enums::State;
use lashloop_protocol::layout::Direction;
use lashloop_protocol::message::EncoderSample;
use lashloop_protocol::wire::Payload;
use lashloop_protocol::{Decoder, DriveMessage, HostMessage, Message};
use serde_json::Value;
use tempfile::TempDir;

use crate::paper::PATIENCE;
use crate::program::{self, Ended};
use crate::records::Records;
use crate::workspace;

const DOCUMENT: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/faults.md"));

/// The capture of the line, next to the record.
const LINE: &str = "line.pcapng";

/// Counts of the link that show a loss.
const COUNTS: [&str; 6] = ["crc_errors", "lost", "late", "resumes", "damaged_at_drive", "overruns_at_drive"];

/// A row of the table.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Row {
    /// The keys of the fault, apart by semicolons.
    pub fault: String,
    /// Further settings of the run.
    pub with: Vec<String>,
    /// The side that detects the fault, and by what.
    pub detected_by: Vec<String>,
    /// The reaction of drive and bench.
    pub reaction: String,
    /// PASS, FAIL, INVALID or `exit 4`.
    pub ends: String,
    /// Until when.
    pub within: String,
}

impl Row {
    fn read(line: &str) -> Self {
        let cells: Vec<_> =
            line.trim_matches('|').split('|').map(|cell| cell.trim().replace('`', "")).collect();
        let [fault, with, detected_by, reaction, ends, within] = &cells[..] else {
            panic!("not six cells: {line}")
        };
        let list = |cell: &str| -> Vec<String> {
            cell.split(", ").filter(|item| !item.is_empty()).map(str::to_owned).collect()
        };
        Self {
            fault: fault.clone(),
            with: list(with),
            detected_by: list(detected_by),
            reaction: reaction.clone(),
            ends: ends.clone(),
            within: within.clone(),
        }
    }

    /// The kind of the fault.
    ///
    /// # Panics
    /// The row has none.
    #[must_use]
    pub fn kind(&self) -> &str {
        self.fault.split('"').nth(1).unwrap_or_else(|| panic!("no kind in {}", self.fault))
    }

    /// The step in which it begins.
    fn step(&self) -> usize {
        let key = self.fault.split("; ").find_map(|key| key.strip_prefix("at_s = "));
        let at_s: f64 =
            key.and_then(|time| time.parse().ok()).unwrap_or_else(|| panic!("no time in {}", self.fault));
        (at_s * 1e3).round() as usize
    }

    fn scenario(&self, folder: &TempDir) -> PathBuf {
        let healthy = fs::read_to_string(workspace().join("scenarios/faults.toml")).expect("the scenario");
        let path = folder.path().join("faults.toml");
        let text = format!("{healthy}\n[[fault]]\n{}\n", self.fault.replace("; ", "\n"));
        fs::write(&path, text).expect("a scenario of the test");
        path
    }

    /// Runs the row on a device.
    #[must_use]
    pub fn run_on(&self, device: &str) -> (Ended, Records) {
        let (folder, records) = (tempfile::tempdir().expect("a temporary folder"), Records::new());
        let (scenario, out) = (self.scenario(&folder).display().to_string(), records.out());
        let line = records.path(LINE).display().to_string();
        let mut arguments = vec!["run", &scenario, "--device", device, "--out", &out, "--capture", &line];
        arguments.extend(self.with.iter().flat_map(|setting| ["--set", setting]));
        if !self.detected_by.iter().any(|by| by.starts_with("bench")) {
            // This row loses nothing, and a busy machine must not add a loss.
            arguments.extend(PATIENCE);
        }
        (program::run(arguments), records)
    }

    /// Runs the row on a device and compares the run with the row.
    ///
    /// # Panics
    /// The run contradicts the row; the panic shows both.
    pub fn check_on(&self, device: &str) {
        let (ended, records) = self.run_on(device);
        let context = format!("{self:?} on {device}\n{}{}", ended.stdout, ended.stderr);
        let code = match self.ends.as_str() {
            "PASS" => 0,
            "FAIL" => 1,
            "INVALID" => 3,
            "exit 4" => 4,
            other => panic!("{other} isn't an end: {context}"),
        };
        assert_eq!(ended.code, Some(code), "{context}");
        let summary = records.summary_text().map(|_| records.summary());
        assert_eq!(summary.is_some(), code != 4, "a run has a summary if it has a verdict: {context}");
        for detector in &self.detected_by {
            assert!(is_detected(detector, &ended, summary.as_ref()), "not {detector}: {context}");
        }
        if let Some(summary) = &summary {
            self.check_summary(summary, device, &context);
        }
        self.check_bound(&records, &context);
        self.check_reaction(&records, &context);
    }

    /// What drive and bench did about it, by the frames on the line and the rows of the record.
    fn check_reaction(&self, records: &Records, context: &str) {
        let unanswered = held_where_unanswered(records, context);
        let sent: Vec<DriveMessage> = messages(Direction::DriveToHost, records, context);
        let shows_it = sent.iter().position(|message| match message {
            DriveMessage::FaultReport(_) => true,
            DriveMessage::CommandResult(result) => {
                (result.request, result.state) == (EncoderSample::LAYOUT.kind, State::Boot)
            }
            _ => false,
        });
        let torque_after = sent[shows_it.unwrap_or(sent.len())..].iter().any(gives_torque);
        let torque_while_not_running = sent.iter().any(|message| {
            matches!(message, DriveMessage::TorqueAnswer(answer) if answer.status.state != State::Running)
                && gives_torque(message)
        });
        assert!(!torque_after && !torque_while_not_running, "a torque after the fault: {context}");
        match self.reaction.as_str() {
            "torque zero" => assert!(shows_it.is_some(), "the drive runs on: {context}"),
            "torque held" => assert!(unanswered > 0 && shows_it.is_none(), "nothing to hold: {context}"),
            "none" => assert!(unanswered == 0 && shows_it.is_none(), "a reaction: {context}"),
            "run ended" => assert!(nothing_follows_the_last_sample(records, context), "{context}"),
            other => panic!("{other} isn't a reaction: {context}"),
        }
    }

    /// Nothing but what the row names was noticed, and the log has the fault.
    fn check_summary(&self, summary: &Value, device: &str, context: &str) {
        let names = |count: &str| self.detected_by.iter().any(|by| by.split(' ').next_back() == Some(count));
        // A program that a busy machine stops beyond the time for an answer has its answer counted as lost and then as late.
        let may_be_late = names("lost") && device != "inproc";
        for count in COUNTS {
            let named = names(count) || (count == "late" && may_be_late);
            assert!(named || summary["link"][count] == 0, "{count} as well: {context}");
        }
        let fired = &summary["faults"][0];
        assert_eq!((&fired["kind"], &fired["step"]), (&self.kind().into(), &self.step().into()), "{context}");
        if self.detected_by == ["undetected"] {
            let missed = summary["expectations"].as_array().into_iter().flatten();
            assert!(missed.into_iter().all(|finding| finding["ok"] == true), "{context}");
        }
    }

    /// The last row of a run that was ended is not later than the table says.
    fn check_bound(&self, records: &Records, context: &str) {
        let rows = records.trace().len();
        match self.within.split_once(' ') {
            Some((steps, "steps")) => {
                let bound: usize = steps.parse().unwrap_or_else(|_| panic!("{steps} steps: {context}"));
                assert!((self.step()..=self.step() + bound).contains(&rows), "{rows} rows: {context}");
            }
            _ if self.within == "the end" => assert_eq!(rows, 8_000, "{context}"),
            _ => panic!("{} isn't a bound: {context}", self.within),
        }
    }
}

fn is_detected(detector: &str, ended: &Ended, summary: Option<&Value>) -> bool {
    let text = |key: &str| summary.and_then(|summary| summary[key].as_str()).unwrap_or_default();
    match detector.split_once(' ') {
        None if detector == "undetected" => text("verdict") == "PASS",
        Some(("bench" | "drive", count)) if COUNTS.contains(&count) => {
            summary.is_some_and(|summary| summary["link"][count].as_u64().is_some_and(|count| count > 0))
        }
        Some(("bench", "restart")) => text("end").starts_with("the drive started anew"),
        Some(("bench", "closed line")) => ended.stderr.contains("the far end closed the line"),
        Some(("bench", "silence")) => ended.stderr.contains("the drive was silent for 6.0 s"),
        Some(("drive", fault)) => text("end").starts_with(&format!("the drive latched {fault} at sample ")),
        Some(("verdict", metric)) => summary
            .and_then(|summary| summary["expectations"].as_array())
            .into_iter()
            .flatten()
            .any(|finding| finding["metric"] == metric && finding["ok"] == false),
        _ => panic!("{detector} isn't a detector"),
    }
}

/// Checks that a step without an answer has the torque of the step before. Returns the number of such steps.
fn held_where_unanswered(records: &Records, context: &str) -> usize {
    let (answered, torque_nm) = (records.timing().column("answered"), records.trace().column("torque_nm"));
    let unanswered: Vec<_> = (1..answered.len()).filter(|step| answered[*step] == 0.0).collect();
    for &step in &unanswered {
        assert_eq!(torque_nm[step], torque_nm[step - 1], "step {step}: {context}");
    }
    unanswered.len()
}

/// Whether an emergency stop at most follows the last sample.
fn nothing_follows_the_last_sample(records: &Records, context: &str) -> bool {
    let sent: Vec<HostMessage> = messages(Direction::HostToDrive, records, context);
    let last = sent.iter().rposition(|message| matches!(message, HostMessage::EncoderSample(_)));
    let rest = &sent[last.expect("a run has samples") + 1..];
    rest.iter().all(|message| matches!(message, HostMessage::EmergencyStop(_)))
}

/// The messages of one direction that arrived whole.
fn messages<M: Message>(direction: Direction, records: &Records, context: &str) -> Vec<M> {
    let bytes = fs::read(records.path(LINE)).unwrap_or_else(|error| panic!("no capture, {error}: {context}"));
    let mut decoder = Decoder::new();
    reader::packets(&bytes)
        .map(|packet| packet.expect("a whole packet"))
        .filter(|packet| packet.direction == Some(direction))
        .flat_map(|packet| {
            let mut rest = &packet.bytes[..];
            std::iter::from_fn(|| decoder.next(&mut rest)).collect::<Vec<_>>()
        })
        .filter_map(|item| item.ok().map(|it| it.message))
        .collect()
}

fn gives_torque(message: &DriveMessage) -> bool {
    matches!(message, DriveMessage::TorqueAnswer(answer) if answer.torque_nm != 0.0)
}

/// The table.
///
/// # Panics
/// The document has none.
#[must_use]
pub fn rows() -> Vec<Row> {
    let rows: Vec<_> =
        DOCUMENT.lines().filter(|line| line.starts_with("| `kind = ")).map(Row::read).collect();
    assert!(!rows.is_empty(), "docs/faults.md has no table");
    rows
}

/// Whether the list of kinds has this one, with what it is.
#[must_use]
pub fn explains(kind: &str) -> bool {
    let row = DOCUMENT.lines().find(|line| line.starts_with(&format!("| `{kind}` |")));
    row.is_some_and(|row| row.split('|').nth(3).is_some_and(|what| what.trim().len() > 10))
}

/// The scenario without a fault passes.
///
/// # Panics
/// It doesn't.
pub fn check_healthy_on(device: &str) {
    let records = Records::new();
    let out = records.out();
    let arguments = ["run", "scenarios/faults.toml", "--device", device, "--out", &out];
    let _ = program::run(arguments.into_iter().chain(PATIENCE)).with_code(0);
    let summary = records.summary();
    for count in COUNTS {
        assert_eq!(summary["link"][count], 0, "{count}");
    }
    assert_eq!(summary["faults"].as_array().map(Vec::len), Some(0));
}

/// The drive's watchdog takes the torque away when samples stay away for its time, `late_s` later at most: by the clock of the
/// drive.
///
/// # Panics
/// It doesn't.
pub fn check_watchdog_on(device: &str, late_s: f64) {
    let row = Row {
        fault: "kind = \"link-stall\"; at_s = 2.0; for_s = 0.001; way = \"to-drive\"".to_owned(),
        with: vec!["controller.parameters.watchdog_us=200000".to_owned()],
        ..Row::default()
    };
    let (ended, records) = row.run_on(device);
    let ended = ended.with_code(3);
    let summary = records.summary();
    let end = summary["end"].as_str().expect("an end");
    let figures = end
        .strip_prefix("the drive latched Watchdog at sample 1999: no sample for ")
        .and_then(|rest| rest.strip_suffix(" ms: the bench was late, or the line lost samples"))
        .unwrap_or_else(|| panic!("{end}"));
    let (value, limit) = figures.split_once(" ms, above watchdog_us, ").expect("a limit");
    let [value_s, limit_s] = [value, limit].map(|it| 1e-3 * it.parse::<f64>().expect("a time"));
    assert!((limit_s - 0.2).abs() < 1e-6, "{end}");
    assert!(value_s >= limit_s && value_s < limit_s + late_s, "{end}");
    assert!(ended.stdout.contains("ENDED  the drive latched Watchdog"), "{}", ended.stdout);
}

/// A bench that is stopped for longer than a drive on a real bench would bear is waited for in lockstep, and the run is the
/// same.
///
/// # Panics
/// It isn't.
pub fn check_pause_on(device: &str) {
    use rustix::process::Signal;
    let run = |pause: bool| {
        let records = Records::new();
        // Longer than the signal takes on a busy machine, and no longer: QEMU has a third of the steps in that time.
        let duration = if device == "qemu" { "run.duration_s=8" } else { "run.duration_s=24" };
        let arguments = ["run", "scenarios/faults.toml", "--device", device, "--out", &records.out()];
        let arguments = arguments.into_iter().chain(["--set", duration, "--set", "expect=[]"]);
        let bench = program::Running::start(arguments.chain(["--set", "record.flush_rows=10"]));
        if pause {
            records.wait_for_rows();
            bench.signal(Signal::STOP);
            std::thread::sleep(std::time::Duration::from_millis(400));
            bench.signal(Signal::CONT);
        }
        let _ = bench.wait().with_code(0);
        let summary = records.summary();
        let wall_s = summary["wall_s"].as_f64().expect("a time");
        assert!(!pause || wall_s > 0.4, "the pause was not in the run of {wall_s} s");
        summary["torque_sha256"].clone()
    };
    assert_eq!(run(true), run(false));
}
