//! Drives that the bench starts by `exec:`, the drive in C among them: their line, their errors and their end.

use std::fs;
use std::process::Command;
use std::time::Instant;

use rustix::process::Signal;
use tests::battery::{ONE_LAW_SKIPS, all_passed};
use tests::loss::{assert_reported, scenario_in_progress};
use tests::program::{self, Ended, Running};
use tests::{c_drive, processes, wait, workspace};

const SCENARIO: &str = "examples/drive-in-c/scenario.toml";

fn run_on(device: &str) -> Ended {
    program::run(["run", SCENARIO, "--device", device])
}

#[test]
fn the_drive_in_c_conforms_on_pipes_and_on_a_terminal() {
    let on_terminal = format!("exec:sh -c '{} <$0 >$0' {{tty}}", c_drive::path().display());
    for device in [c_drive::device(), on_terminal] {
        let ended = program::run(["conformance", "--device", &device]).with_code(0);
        assert!(
            ended.stdout.starts_with(&format!("{device} (c-example, firmware 1.0.0, ")),
            "{}",
            ended.stdout
        );
        all_passed(&ended.stdout, ONE_LAW_SKIPS);
    }
}

#[test]
fn the_drive_in_c_runs_its_scenario() {
    let ended = run_on(&c_drive::device()).with_code(0);
    assert!(ended.stdout.starts_with("PASS  "), "{}", ended.stdout);
}

#[test]
fn a_changed_program_is_named_with_the_first_step_that_differs() {
    let folder = tempfile::tempdir().expect("a folder");
    let (source, drive) = (folder.path().join("source"), folder.path().join("drive"));
    fs::copy(c_drive::path(), &drive).expect("a drive");
    let [device, record] =
        [format!("exec:{}", drive.display()), folder.path().join("a").display().to_string()];
    let short = ["--set", "run.duration_s=0.2", "--set", "expect=[]", "--out", &record];
    let _ = program::run(["run", SCENARIO, "--device", &device].iter().chain(&short)).with_code(0);
    let refused = program::run(["rerun", &record]).with_code(2);
    assert!(refused.stderr.contains(&format!("give --device '{device}'")), "{}", refused.stderr);
    let _ = program::run(["rerun", &record, "--device", &device]).with_code(0);

    let example = workspace().join("examples/drive-in-c");
    fs::create_dir(&source).expect("a folder");
    for file in fs::read_dir(&example).expect("the example").flatten() {
        let text = fs::read_to_string(file.path());
        // A larger step of the encoders, as a typing error would make.
        let text = text.map(|text| text.replace("TAU = 6.283185307f", "TAU = 6.283186f"));
        text.map_or(Ok(()), |text| fs::write(source.join(file.file_name()), text)).expect("a source");
    }
    let include = format!("LASHLOOP={}", workspace().join("protocol/include").display());
    let built = Command::new("make")
        .args(["-B", &include, "CFLAGS=-O1", "DRIVE=../drive.new"])
        .current_dir(&source)
        .output()
        .expect("make starts");
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    fs::rename(folder.path().join("drive.new"), &drive).expect("another drive of this name");
    let rerun = program::run(["rerun", &record, "--device", &device]).with_code(1);
    for words in ["sha256 of drive", "First difference: step 0,", "torque_nm"] {
        assert!(rerun.stdout.contains(words), "no {words:?} in {}", rerun.stdout);
    }
    let replay = program::run(["replay", &record, "--device", &device]).with_code(1);
    assert!(replay.stdout.contains("\nfirst       step 0, 0 s: recorded "), "{}", replay.stdout);
}

/// Its last byte is that of a step, the same in each attempt.
#[test]
fn case_whose_drive_ends_is_an_invalid_row_of_its_campaign() {
    let records = tests::records::Records::new();
    let (file, scenario) = (records.path("ends.toml"), workspace().join(SCENARIO));
    let text = format!(
        "title = \"ends\"\nscenario = {scenario:?}\nset = [\"run.duration_s=5\", \"expect=[]\"]\n[[part]]\nname = \"one\"\n\
         [[part.axis]]\nkey = \"run.seed\"\nvalues = [1]\n"
    );
    fs::write(&file, text).expect("a campaign");
    let device = format!("exec:sh -c '{} | dd bs=1 count=20000 status=none'", c_drive::path().display());
    let (file, out) = (file.display().to_string(), records.path("out").display().to_string());
    let ended = program::run(["campaign", &file, "--device", &device, "--out", &out]).with_code(0);
    assert!(
        ended.stdout.contains("1 case INVALID without a run; the first:\ncase 0: the "),
        "{}",
        ended.stdout
    );
    let again = program::run(["campaign", "rerun", &out, "--case", "0"]).with_code(0);
    assert!(again.stdout.contains("INVALID, no run: the "), "{}", again.stdout);
}

#[test]
fn the_walk_to_a_drive_in_c_leads_there() {
    tests::walk::through("docs/extend/drive-in-c.md", &[]);
}

#[test]
fn a_command_that_does_not_serve_is_reported_with_its_last_words() {
    let cases = [
        ("exec:./no-such-drive", "exec:./no-such-drive: no file ./no-such-drive; a relative path"),
        ("exec:no-such-drive -v", "exec:no-such-drive -v: no program no-such-drive in PATH"),
        ("exec:examples/drive-in-c/drive.c", "may not be executed: chmod +x examples/drive-in-c/drive.c"),
        (
            "exec:sh -c 'echo no supply voltage >&2; exit 3'",
            "exit status: 3, standard error \"no supply voltage\"",
        ),
        (
            "exec:sh -c 'echo no supply voltage; exit 3' {tty}",
            "exit status: 3, standard error \"no supply voltage\"",
        ),
        ("exec:sh -c 'kill -SEGV $$'", "signal: 11 (SIGSEGV)"),
        ("exec:sh -c 'echo waiting for power >&2; exec sleep 100'", "standard error \"waiting for power\""),
    ];
    for (device, part) in cases {
        let ended = run_on(device).with_code(4);
        assert!(ended.stderr.contains(part), "{device}: {}", ended.stderr);
        assert_eq!(ended.stderr.lines().count(), 1, "{}", ended.stderr);
    }
}

#[test]
fn a_command_has_the_environment_and_the_working_folder_of_the_bench() {
    let device =
        "exec:sh -c 'test -f scenarios/smooth-after.toml && test -n \"$PATH\" && echo both >&2; exit 1'";
    let ended = run_on(device).with_code(4);
    assert!(ended.stderr.contains("standard error \"both\""), "{}", ended.stderr);
}

/// An endless run on a drive that starts a process of its own, and the numbers of guard, drive and that process.
fn run_with_family() -> (Running, tests::records::Records, [u32; 3]) {
    let device = format!("exec:sh -c 'sleep 1000 & exec {}'", c_drive::path().display());
    let (bench, records) = scenario_in_progress(SCENARIO, &device);
    let only = |parent| match processes::children(parent)[..] {
        [child] => child,
        ref others => panic!("not one child of {parent}: {others:?}"),
    };
    let guard = only(bench.id());
    let drive = only(guard);
    (bench, records, [guard, drive, only(drive)])
}

fn assert_ended(family: [u32; 3]) {
    wait::until("the end of every process", || (!family.into_iter().any(processes::runs)).then_some(()));
}

#[test]
fn every_process_of_a_command_ends_with_the_bench() {
    for signal in [Signal::KILL, Signal::TERM, Signal::INT] {
        let (bench, _records, family) = run_with_family();
        bench.signal(signal);
        let _ = bench.wait();
        assert_ended(family);
    }
}

#[test]
fn a_killed_drive_is_reported_and_takes_its_processes_with_it() {
    let (bench, records, family) = run_with_family();
    let [_, drive, _] = family;
    processes::signal(drive, Signal::KILL);
    let sentence = assert_reported(bench, &records, Instant::now());
    assert!(
        sentence.contains("the command (process ") && sentence.contains("signal: 9 (SIGKILL)"),
        "{sentence}"
    );
    assert_ended(family);
}

#[test]
fn a_killed_bench_ends_a_suspended_drive_too() {
    let (bench, _records, family) = run_with_family();
    let [_, drive, other] = family;
    for id in [drive, other] {
        processes::signal(id, Signal::STOP);
    }
    bench.signal(Signal::KILL);
    let _ = bench.wait();
    assert_ended(family);
}

#[test]
fn a_drive_has_time_to_write_its_files_at_the_end() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("coverage");
    let device = format!("exec:sh -c '{}; echo complete > {}'", c_drive::path().display(), file.display());
    let _ = run_on(&device).with_code(0);
    assert_eq!(fs::read_to_string(file).expect("the file of the drive"), "complete\n");
}
