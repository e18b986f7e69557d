//! Drives that are lost during a run and return: by themselves, or as another process under the same name, like a board
//! that is unplugged and plugged in again.

use std::fs;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::time::Instant;

use lashloop_bench::run::End;
use lashloop_bench::timing::StepOutcome;
use lashloop_protocol::{DriveMessage, HostMessage};
use rustix::process::Signal;
use serde_json::Value;
use tests::loss;
use tests::paper::PATIENCE;
use tests::program::{self, Running};
use tests::records::{Records, Trace};
use tests::relay::{Action, Relay};
use tests::scripted::Script;
use tests::twin::Twin;

const RESUME: [&str; 6] = [
    "--set",
    "link.on_loss=\"resume\"",
    "--set",
    "link.resume_limit_ms=60000",
    "--set",
    "record.flush_rows=10",
];

/// The scenario of the fault table with one more fault.
fn faulty(folder: &Records, fault: &str) -> String {
    let healthy = fs::read_to_string(tests::workspace().join("scenarios/faults.toml")).expect("the scenario");
    let path = folder.path("faulty.toml");
    fs::write(&path, format!("{healthy}\n[[fault]]\n{fault}\n")).expect("a scenario of the test");
    path.display().to_string()
}

fn run_faulty(fault: &str, device: &str, settings: &[&str], code: i32) -> (Value, Trace) {
    let records = Records::new();
    let (scenario, out) = (faulty(&records, fault), records.out());
    let arguments = ["run", &scenario, "--device", device, "--out", &out];
    let settings = settings.iter().flat_map(|setting| ["--set", setting]);
    let _ = program::run(arguments.into_iter().chain(RESUME).chain(settings)).with_code(code);
    (records.summary(), records.trace())
}

/// Steps at which the torque drops to zero: those of a loss. At the start of the scenario the torque is zero without a
/// loss.
fn without_torque(trace: &Trace) -> Vec<usize> {
    let torque_nm = trace.column("torque_nm");
    (1..torque_nm.len()).filter(|step| torque_nm[*step] == 0.0 && torque_nm[step - 1] != 0.0).collect()
}

const RESET: &str = "kind = \"device-reset\"\nat_s = 2.0";

#[test]
fn a_restarted_drive_has_no_torque_until_armed_again() {
    for device in ["native", "inproc"] {
        let (summary, trace) = run_faulty(RESET, device, &["allow.resumes=1", "allow.lost=1"], 0);
        let link = &summary["link"];
        assert_eq!(
            (&link["resumes"], &link["lost"], &link["late"]),
            (&1.into(), &1.into(), &0.into()),
            "{device}"
        );
        assert_eq!(without_torque(&trace), [2000], "{device}: the step of the loss");
        assert_eq!(trace.len(), 8_000);
        assert_eq!(summary["end"], "complete");
    }
}

#[test]
fn more_restarts_than_allowed_make_the_run_invalid() {
    let (summary, _) = run_faulty(RESET, "native", &["allow.lost=1"], 3);
    assert_eq!((&summary["end"], &summary["link"]["resumes"]), (&"complete".into(), &1.into()));
}

#[test]
fn a_restart_ends_the_run_unless_the_scenario_resumes() {
    let (summary, trace) = run_faulty(RESET, "native", &["link.on_loss=\"end\"", "allow.resumes=1"], 3);
    assert_eq!((&summary["verdict"], trace.len()), (&"INVALID".into(), 2_000));
    let end = summary["end"].as_str().expect("an end");
    assert!(end.starts_with("the drive started anew in the middle of the run"), "{end}");
}

#[test]
fn a_cut_line_resumes_without_torque() {
    let cut = "kind = \"link-cut\"\nat_s = 2.0\nfor_s = 0.3";
    let (summary, trace) = run_faulty(cut, "native", &["allow.resumes=1", "allow.lost=1"], 0);
    assert_eq!(without_torque(&trace), [2000]);
    assert!(summary["wall_s"].as_f64().is_some_and(|wall_s| wall_s > 0.3), "{summary}");
    // The cut ends before the next step of the plant begins.
    assert_eq!(summary["faults"][0]["until_step"], 2001);
}

#[test]
fn in_real_time_a_lost_drive_leaves_the_plant_without_torque() {
    let settings = [
        "run.duration_s=4",
        "controller.parameters.watchdog_us=5000000",
        "link.on_loss=resume",
        "allow.resumes=1",
        "allow.late=1000000",
        "allow.lost=1000000",
    ];
    let made = Script {
        scenario: "scenarios/faults.toml",
        faults: "[[fault]]\nkind = \"link-cut\"\nat_s = 1.5\nfor_s = 0.4\n",
        settings: &settings,
        ..Script::default()
    }
    .run();
    let (outcome, torque_nm) = (made.outcome(), made.torque_nm());
    assert_eq!((outcome.link.resumes, &outcome.end), (1, &End::Complete));
    assert_eq!(torque_nm.len(), 4_000, "every step has its row");
    // The load moves, so a connected drive gives torque. The bench tries again every 50 ms.
    let away = 1_500..1_900 + 50;
    let gives = |step: &usize| torque_nm[*step] != 0.0;
    assert!(
        gives(&1_499) && !away.clone().any(|step| step < 1_900 && gives(&step)),
        "no torque without a drive"
    );
    assert!(made.with(StepOutcome::Answered).contains(&away.end) && gives(&away.end), "and some with it");
}

#[test]
fn a_drive_that_hangs_past_its_limit_is_resumed() {
    let hang = "kind = \"device-hang\"\nat_s = 2.0\nfor_s = 1.0";
    let limits = ["link.answer_timeout_ms=300", "link.silence_limit_ms=600"];
    // The adaptive law restarts, so the load settles later than without the fault.
    let allowances = ["allow.resumes=9", "allow.lost=99", "expect.1.max=6.0"];
    for device in ["native", "inproc"] {
        let (summary, trace) = run_faulty(hang, device, &[limits.as_slice(), &allowances].concat(), 0);
        assert!(summary["link"]["resumes"].as_u64().is_some_and(|resumes| resumes >= 1), "{summary}");
        let zero = without_torque(&trace);
        // The first steps of a silence hold the torque; the step that ends the silence has none.
        assert!(zero.first().is_some_and(|step| (2001..=2004).contains(step)), "{device}: {zero:?}");
    }
}

#[test]
fn a_drive_that_stays_away_ends_the_run_with_exit_code_4() {
    let records = Records::new();
    let scenario = faulty(&records, "kind = \"link-cut\"\nat_s = 2.0\nfor_s = 600.0");
    let out = records.out();
    let arguments =
        ["run", &scenario, "--device", "native", "--out", &out, "--set", "link.on_loss=\"resume\""];
    let ended = program::run(arguments.into_iter().chain(["--set", "link.resume_limit_ms=500"])).with_code(4);
    assert!(ended.stderr.contains("the far end closed the line"), "{}", ended.stderr);
    assert_eq!((records.trace().len(), records.summary_text()), (2_000, None));
    let failure = records.record().failure.expect("why there is no summary").error;
    assert!(failure.contains("the far end closed the line"), "{failure}");
    let compared = program::run(["diff", &out, &out]).with_code(1).stdout;
    assert!(compared.contains("no verdict: the far end") || compared.contains(&failure), "{compared}");
    let _ = program::run(["report", &out]).with_code(0);
    let page = std::fs::read_to_string(records.path("report.html")).expect("a page");
    assert!(page.contains("The run failed at 1.999 s"), "no reason on the page");
}

#[test]
fn the_bench_does_not_wait_for_its_own_dead_twin() {
    let records = Records::new();
    let out = records.out();
    let arguments = ["run", "scenarios/faults.toml", "--device", "native", "--out", &out];
    let endless = ["--set", "run.duration_s=100000"];
    let bench = Running::start(arguments.into_iter().chain(RESUME).chain(endless));
    records.wait_for_rows();
    let [twin] = tests::processes::children(bench.id())[..] else { panic!("the bench has one child") };
    let lost_at = Instant::now();
    tests::processes::signal(twin, Signal::KILL);
    let ended = bench.wait().with_code(4);
    assert!(ended.at.saturating_duration_since(lost_at) < loss::LIMIT, "{}", ended.stderr);
    assert!(ended.stderr.contains("signal: 9"), "{}", ended.stderr);
}

/// A name that points to the terminal of a drive, like `/dev/serial/by-id/...` to that of a board.
struct Name {
    folder: tempfile::TempDir,
}

impl Name {
    fn of(path: &Path) -> Self {
        let name = Self { folder: tempfile::tempdir().expect("a folder for the name") };
        symlink(path, name.path()).expect("a name");
        name
    }

    fn path(&self) -> PathBuf {
        self.folder.path().join("usb-Lashloop_drive-if00")
    }

    /// Redirects the name: the board is plugged in again, and its terminal has another number.
    fn point_to(&self, path: &Path) {
        let _ = fs::remove_file(self.path());
        symlink(path, self.path()).expect("a name");
    }

    fn remove(&self) {
        fs::remove_file(self.path()).expect("the name exists");
    }
}

/// Starts a run on a name and waits for its first rows.
fn started(name: &Name, settings: &[&str]) -> (Running, Records) {
    let records = Records::new();
    let (device, out) = (name.path().display().to_string(), records.out());
    let arguments = ["run", "scenarios/smooth-after.toml", "--device", &device, "--out", &out];
    let settings = settings.iter().flat_map(|setting| ["--set", setting]);
    let bench = Running::start(arguments.into_iter().chain(RESUME).chain(PATIENCE).chain(settings));
    records.wait_for_rows();
    (bench, records)
}

#[test]
fn a_drive_that_reconnects_resumes_from_disarmed() {
    let first = Twin::start();
    let name = Name::of(first.path());
    // Longer than the disconnection takes on any machine; the expectation is met by then.
    let settings = ["run.duration_s=200", "allow.resumes=1", "allow.lost=2"];
    let (bench, records) = started(&name, &settings);
    name.remove();
    drop(first);
    let second = Twin::start();
    name.point_to(second.path());
    let ended = bench.wait();
    let summary = records.summary();
    assert_eq!(summary["link"]["resumes"], 1, "{}", ended.stdout);
    assert_eq!(summary["end"], "complete");
    let answered = records.timing().column("answered");
    let unanswered: Vec<_> = (0..answered.len()).filter(|step| answered[*step] == 0.0).collect();
    let torque_nm = records.trace().column("torque_nm");
    let [.., lost] = unanswered[..] else { panic!("a step was lost") };
    assert_eq!(torque_nm[lost], 0.0, "the motor has no torque until the new start");
    // The adaptive law restarts in the new drive, so the run may miss its expectation; the verdict must not stem from the
    // line.
    assert!(matches!(ended.code, Some(0 | 1)), "{}{}", ended.stdout, ended.stderr);
    assert!(!ended.stdout.contains("BROKEN"), "{}", ended.stdout);
}

#[test]
fn a_reconnect_is_invalid_without_an_allowance() {
    let first = Twin::start();
    let name = Name::of(first.path());
    let (bench, records) = started(&name, &["run.duration_s=200", "allow.lost=2"]);
    drop(first);
    let second = Twin::start();
    name.point_to(second.path());
    let ended = bench.wait().with_code(3);
    assert!(ended.stdout.contains("BROKEN resumes: 1 counted, allow.resumes is 0"), "{}", ended.stdout);
    assert_eq!(records.summary()["verdict"], "INVALID");
}

#[test]
fn a_disconnect_without_resume_ends_with_exit_code_4() {
    let first = Twin::start();
    let name = Name::of(first.path());
    let (bench, records) = started(&name, &["run.duration_s=200", "link.on_loss=\"end\"", "allow.resumes=9"]);
    let lost_at = Instant::now();
    drop(first);
    let _ = loss::assert_reported(bench, &records, lost_at);
}

/// A line that is disconnected at a frame of the bench, which the drive doesn't get.
fn cut_at(drive: &Twin, is_last: fn(&HostMessage) -> bool) -> Relay {
    Relay::start(drive.path(), move |frame| match frame.from_bench() {
        Some(message) if is_last(&message) => Action::Disconnect,
        _ => Action::Forward,
    })
}

/// What the bench sends before the first sample, in this order.
const BEFORE_SAMPLES: [fn(&HostMessage) -> bool; 4] = [
    |it| matches!(it, HostMessage::Hello(_)),
    |it| matches!(it, HostMessage::SetParameter(_)),
    |it| matches!(it, HostMessage::Arm(_)),
    |it| matches!(it, HostMessage::Start(_)),
];

#[test]
fn a_loss_before_the_first_sample_ends_the_run() {
    for is_last in BEFORE_SAMPLES {
        let (drive, records) = (Twin::start(), Records::new());
        let relay = cut_at(&drive, is_last);
        let arguments = ["run", "scenarios/faults.toml", "--device", relay.device(), "--out", &records.out()];
        let ended = program::run(arguments.into_iter().chain(RESUME)).with_code(4);
        let _ = relay.disconnected_at();
        assert!(ended.stderr.contains("the far end closed the line"), "{}", ended.stderr);
        assert_eq!(records.summary_text(), None);
    }
}

#[test]
fn a_loss_from_the_first_sample_on_is_resumed() {
    let (drive, records) = (Twin::start(), Records::new());
    let mut relay = cut_at(&drive, |it| matches!(it, HostMessage::EncoderSample(_)));
    let name = Name::of(Path::new(relay.device()));
    let (device, out) = (name.path().display().to_string(), records.out());
    let arguments = ["run", "scenarios/faults.toml", "--device", &device, "--out", &out];
    let settings = ["run.duration_s=2", "allow.resumes=3", "allow.lost=3"];
    let settings = settings.iter().flat_map(|setting| ["--set", setting]);
    let bench = Running::start(arguments.into_iter().chain(RESUME).chain(PATIENCE).chain(settings));
    for is_last in BEFORE_SAMPLES {
        let _ = relay.disconnected_at();
        let next = cut_at(&drive, is_last);
        name.point_to(Path::new(next.device()));
        relay = next;
    }
    let _ = relay.disconnected_at();
    name.point_to(drive.path());
    let ended = bench.wait();
    let summary = records.summary();
    // Of the first drive, and of those that were lost with `Arm` and `Start`.
    assert_eq!((&summary["end"], &summary["link"]["resumes"]), (&"complete".into(), &3.into()));
    assert!(!ended.stdout.contains("BROKEN"), "{}", ended.stdout);
}

#[test]
fn another_firmware_under_the_name_is_never_armed() {
    let first = Twin::start();
    let name = Name::of(first.path());
    let (bench, _records) = started(&name, &["run.duration_s=200", "allow.resumes=1", "allow.lost=2"]);
    let second = Twin::start();
    let armed = std::sync::Arc::new(std::sync::atomic::AtomicBool::new(false));
    let seen = std::sync::Arc::clone(&armed);
    let relay = Relay::start(second.path(), move |frame| {
        if let Some(DriveMessage::Identity(mut identity)) = frame.from_drive() {
            identity.build_id ^= 1;
            return frame.replaced(identity);
        }
        if let Some(HostMessage::Arm(_)) = frame.from_bench() {
            seen.store(true, std::sync::atomic::Ordering::Relaxed);
        }
        Action::Forward
    });
    name.point_to(Path::new(relay.device()));
    drop(first);
    let ended = bench.wait().with_code(4);
    assert!(ended.stderr.contains("it came back with another firmware than build "), "{}", ended.stderr);
    assert!(!armed.load(std::sync::atomic::Ordering::Relaxed), "the other firmware was armed");
}
