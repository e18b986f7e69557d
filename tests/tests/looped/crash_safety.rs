//! The record after a kill of the bench, on a full disk, and with a closed reader.

use std::collections::BTreeMap;
use std::fs;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use rustix::process::Signal;
use tests::paper::RUNS;
use tests::program::Running;
use tests::records::Records;
use tests::relay::{Action, Relay};
use tests::twin::Twin;
use tests::{program, wait, workspace};

/// A relay that counts the forwarded torques.
fn counting_relay(twin: &Twin) -> (Relay, Arc<AtomicU32>) {
    let answered = Arc::new(AtomicU32::new(0));
    let seen = Arc::clone(&answered);
    let relay = Relay::start(twin.path(), move |frame| {
        if let Some(torque) = frame.torque() {
            seen.fetch_max(u32::from(torque.sequence) + 1, Ordering::Relaxed);
        }
        Action::Forward
    });
    (relay, answered)
}

#[test]
fn a_killed_bench_leaves_every_whole_chunk_of_rows() {
    const CHUNK: usize = 64;
    let twin = Twin::start();
    let (relay, answered) = counting_relay(&twin);
    let records = Records::new();
    let (out, flush) = (records.out(), format!("record.flush_rows={CHUNK}"));
    let arguments = ["run", "scenarios/smooth-after.toml", "--device", relay.device(), "--out", &out];
    let bench =
        Running::start(arguments.into_iter().chain(["--set", "run.duration_s=100000", "--set", &flush]));
    wait::until("a few chunks", || (answered.load(Ordering::Relaxed) > 1_000).then_some(()));
    bench.signal(Signal::KILL);
    assert_eq!(bench.wait().code, None);
    let answered = answered.load(Ordering::Relaxed) as usize;
    for rows in [records.trace().len(), records.timing().len()] {
        assert_eq!(rows % CHUNK, 0, "chunks are whole");
        // The bench may not have read the last answer, and a row is complete with the next step.
        assert!(
            (answered.saturating_sub(CHUNK + 2)..=answered).contains(&rows),
            "{rows} rows of {answered} steps"
        );
    }
    assert_eq!(records.summary_text(), None, "a run without a verdict leaves no summary");
}

/// Runs a bench under a limit of file size, which acts like a disk that fills up during the run.
fn with_files_up_to(blocks: u32, records: &Records, settings: &[&str]) -> (Option<i32>, String) {
    // With SIGXFSZ ignored, a write beyond the limit fails.
    let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" \"$@\"");
    let output = Command::new("sh")
        .args(["-c", &script])
        .arg(program::lashloop())
        .args([
            "run",
            "scenarios/smooth-after.toml",
            "--device",
            "native",
            "--force",
            "--out",
            &records.out(),
        ])
        .args(settings.iter().flat_map(|setting| ["--set", setting]))
        .current_dir(workspace())
        .output()
        .expect("sh starts");
    (output.status.code(), String::from_utf8(output.stderr).expect("UTF-8"))
}

#[test]
fn a_disk_that_fills_up_ends_the_run_and_leaves_whole_rows() {
    for flush_rows in [1, 100, 1000] {
        let records = Records::new();
        fs::write(records.path("summary.json"), "{}\n").expect("the summary of an earlier run");
        fs::write(records.path("record.json"), "{\"format\": 2}\n").expect("the manifest of an earlier run");
        let setting = format!("record.flush_rows={flush_rows}");
        let (code, stderr) = with_files_up_to(400, &records, &[&setting]);
        assert_eq!(code, Some(2), "{stderr}");
        assert!(stderr.contains("run.mcap: can't be written: ") && stderr.lines().count() == 1, "{stderr}");
        let rows = records.trace().len();
        assert!(
            (flush_rows..25_000).contains(&rows) && rows.is_multiple_of(flush_rows),
            "{rows} rows with {setting}"
        );
        assert_eq!(records.timing().len(), rows);
        assert_eq!(records.summary_text(), None, "the old summary is removed ahead of the new samples");
    }
}

#[test]
fn a_disk_full_at_the_start_is_named_before_the_run() {
    let records = Records::new();
    let short = ["--device", "inproc", "--set", "run.duration_s=0.1", "--set", "expect=[]", "--report"];
    let out = records.out();
    let _ = program::run(["run", "scenarios/shaft-pd.toml", "--out", &out].iter().chain(&short)).with_code(0);
    let files = || {
        let entries = fs::read_dir(records.path("")).expect("the folder").flatten();
        entries.map(|it| (it.file_name(), fs::read(it.path()).expect("a file"))).collect::<BTreeMap<_, _>>()
    };
    let before = files();
    let (code, stderr) = with_files_up_to(0, &records, &[]);
    assert_eq!(code, Some(2), "{stderr}");
    assert!(stderr.contains("record/scenario.toml: can't be written: File too large"), "{stderr}");
    assert!(before.len() == 5 && before == files(), "the earlier record has changed: {:?}", files().keys());
}

#[test]
fn a_summary_that_does_not_fit_leaves_whole_samples() {
    // Manifest, scenario and two steps fit into run.mcap; the summary, of more than 3,072 bytes, does not.
    let records = Records::new();
    let (code, stderr) = with_files_up_to(36, &records, &["run.duration_s=0.002"]);
    assert_eq!(code, Some(2), "{stderr}");
    assert!(stderr.contains("run.mcap: can't be written: "), "{stderr}");
    assert_eq!((records.trace().len(), records.summary_text()), (2, None));
    let files: Vec<_> =
        fs::read_dir(records.out()).expect("the folder").flatten().map(|it| it.file_name()).collect();
    assert_eq!(files.len(), 3, "all but the summary: {files:?}");
    let ended = program::run(["export", &records.out(), "--to", "csv"]).with_code(0);
    assert!(
        ended.stderr.contains("interrupted: no summary.json, 2 steps reached the disk"),
        "{}",
        ended.stderr
    );
}

#[test]
fn a_record_is_replaced_by_force_only_and_latest_follows() {
    let records = Records::new();
    let out = records.out();
    let short = ["--device", "inproc", "--set", "run.duration_s=0.1", "--set", "expect=[]", "--out", &out];
    let run =
        |more: &[&str]| program::run(["run", "scenarios/shaft-pd.toml"].iter().chain(&short).chain(more));
    let _ = run(&[]).with_code(0);
    let refused = run(&[]).with_code(2);
    assert!(
        refused.stderr.contains("holds a record") && refused.stderr.contains("--force"),
        "{}",
        refused.stderr
    );
    let _ = run(&["--force", "--set", "run.seed=5"]).with_code(0);
    assert_eq!(records.record().manifest.seed, 5);
    let latest = records.path("../latest").canonicalize().expect("a link");
    assert_eq!(latest, records.path("").canonicalize().expect("the folder"));
}

#[test]
fn a_refused_run_keeps_the_record_of_an_earlier_run() {
    let records = Records::new();
    let out = records.out();
    let run = |limit_nm| {
        let setting = format!("controller.parameters.torque_limit_nm={limit_nm}");
        program::run([
            "run",
            "scenarios/shaft-pd.toml",
            "--device",
            "inproc",
            "--force",
            "--out",
            &out,
            "--set",
            &setting,
        ])
    };
    let files = || {
        ["record.json", "run.mcap", "summary.json"]
            .map(|name| fs::read(records.path(name)).unwrap_or_else(|error| panic!("{name}: {error}")))
    };
    let _ = run(25).with_code(0);
    let before = files();
    let _ = run(2000).with_code(2);
    assert!(before == files(), "a file of the first run has changed");
}

#[test]
fn a_gate_that_cannot_be_computed_leaves_a_complete_record() {
    let records = Records::new();
    // The gate starts the plant a second time.
    let lab = records.path("../lab");
    fs::create_dir(&lab).expect("a folder");
    let example = workspace().join("examples/plant-process");
    let plant = fs::read_to_string(example.join("plant.py")).expect("the example");
    let once = "import os\nos.mkdir('used')\n";
    fs::write(lab.join("plant.py"), once.to_owned() + &plant).expect("a plant");
    fs::copy(example.join("plant.toml"), lab.join("plant.toml")).expect("a scenario");
    let (scenario, out) = (lab.join("plant.toml"), records.out());
    let scenario = scenario.to_str().expect("UTF-8");
    let ended = program::run([
        "run",
        scenario,
        "--device",
        "inproc",
        "--set",
        "run.duration_s=0.1",
        "--out",
        &out,
        "--gate",
    ]);
    assert!(ended.code != Some(0) && ended.stderr.contains("FileExistsError"), "{}", ended.stderr);
    let summary = records.summary();
    assert_eq!((&summary["verdict"], &summary["end"]), (&"INVALID".into(), &"complete".into()));
    assert_eq!(records.trace().len(), 100);
}

#[test]
fn a_closed_reader_changes_neither_verdict_nor_record() {
    let records = Records::new();
    let mut bench = Command::new(program::lashloop())
        .args(["run", &RUNS[2].scenario(), "--device", "native", "--out", &records.out()])
        .current_dir(workspace())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("lashloop starts");
    drop((bench.stdout.take(), bench.stderr.take()));
    let status = wait::until("the end of the run", || bench.try_wait().expect("it can be waited for"));
    assert_eq!(status.code(), Some(0));
    assert_eq!((&records.summary()["verdict"], records.trace().len()), (&"PASS".into(), 25_000));
}

#[test]
fn an_interrupted_run_with_large_chunks_loses_no_row() {
    for signal in [Signal::INT, Signal::TERM] {
        let twin = Twin::start();
        let (relay, answered) = counting_relay(&twin);
        let records = Records::new();
        let out = records.out();
        let arguments = ["run", "scenarios/smooth-after.toml", "--device", relay.device(), "--out", &out];
        let never = ["--set", "run.duration_s=100000", "--set", "record.flush_rows=1000000"];
        let bench = Running::start(arguments.into_iter().chain(never));
        wait::until("some steps", || (answered.load(Ordering::Relaxed) > 500).then_some(()));
        bench.signal(signal);
        let _ = bench.wait().with_code(3);
        let rows = records.trace().len();
        assert_eq!((rows, records.timing().len()), (answered.load(Ordering::Relaxed) as usize, rows));
        assert_eq!(records.summary()["steps"].as_u64(), Some(rows as u64));
    }
}
