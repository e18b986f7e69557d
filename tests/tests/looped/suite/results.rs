//! Rows, exit codes and reports of a suite.

use std::ffi::OsStr;
use std::fs;
use std::os::unix::ffi::OsStrExt;
use std::path::Path;

use rustix::process::Signal;
use tests::program::Running;
use tests::{program, wait};

use super::fixture::{NOISE, PEAK, SHORT, Suite};

#[test]
fn every_scenario_of_a_folder_has_a_row_and_the_worst_is_the_exit_code() {
    let suite = Suite::new(&[
        ("bad.toml", SHORT.replace("duration_s", "duration_ms")),
        ("good.toml", format!("{SHORT}{PEAK}max = 10.0\n")),
        ("missed.toml", format!("{SHORT}{PEAK}max = 0.1\n")),
        ("pins.toml", SHORT.replace("[run]", "[run]\nmode = \"bench\"").replace("smooth", "backlash-shaft")),
        ("swept.toml", format!("{SHORT}{NOISE}")),
    ]);
    let [out, junit, html] = ["out", "junit.xml", "out/index.html"].map(|name| suite.path(name));
    // The native twin has no pins.
    let options = ["--out", &out, "--junit", &junit, "--html", &html, "--jobs", "2", "--device", "native"];
    let scenarios = suite.path("s");
    let ended = program::run(["test", &scenarios].iter().copied().chain(options)).with_code(2);
    let swept =
        ["0.1", "0.2", "0.3", "0.4"].map(|noise| format!("PASS swept.toml: encoders.noise_counts={noise}"));
    let first = ["ERROR bad.toml", "PASS good.toml", "FAIL missed.toml", "SKIPPED pins.toml"];
    let want: Vec<_> = first.into_iter().map(str::to_owned).chain(swept).collect();
    assert_eq!(suite.rows(&ended), want, "{}", ended.stdout);
    assert!(
        ended.stdout.contains("8 cases: 5 PASS, 1 FAIL, 0 INVALID, 1 ERROR, 1 SKIPPED; "),
        "{}",
        ended.stdout
    );
    assert!(ended.stdout.contains("bad.toml:3: run.duration_ms: 1.5 is in a wrong unit"), "{}", ended.stdout);
    let missed = ended.stdout.lines().find(|line| line.contains("peak_tracking_error_rad: 1.57"));
    assert!(missed.is_some_and(|line| line.ends_with("; misses at most 0.1 rad")), "{}", ended.stdout);

    assert_eq!(suite.junit_counts("junit.xml"), [8, 1, 1, 1]);
    let text = suite.read("junit.xml");
    let document = roxmltree::Document::parse(&text).expect("XML");
    assert_eq!(document.descendants().filter(|node| node.has_tag_name("testsuite")).count(), 5);

    // The record of the failure alone, with its report.
    let records: Vec<_> =
        ended.stdout.lines().filter_map(|line| line.trim().strip_prefix("record: ")).collect();
    let [record] = records[..] else { panic!("one record: {records:?}") };
    assert!(
        record.contains("/records/missed-") && Path::new(record).join("summary.json").is_file(),
        "{record}"
    );
    assert_eq!(suite.badge("out/index.html"), "ERROR");
    let page = suite.read("out/index.html");
    let address = page.split('"').find(|word| word.ends_with("/report.html")).expect("a link");
    assert!(Path::new(&out).join(address).is_file(), "{address}");
    let folders = fs::read_dir(suite.path("out/records")).expect("the records");
    assert_eq!(folders.count(), 1, "a pass leaves no record");
}

#[test]
fn one_run_has_a_junit_report_with_a_verdict_or_without() {
    let suite =
        Suite::new(&[("a.toml", format!("{SHORT}{PEAK}max = 0.1\n")), ("b.toml", format!("{SHORT}{NOISE}"))]);
    let junit = suite.path("junit.xml");
    for (name, code, want) in [
        ("s/a.toml", 1, r#"failures="1" errors="0""#),
        ("s/c.toml", 2, "t be read: No such file"),
        ("s/b.toml", 2, "4 cases of a sweep are run by `lashloop test`"),
    ] {
        let run = ["run", &suite.path(name), "--device", "inproc", "--junit", &junit];
        let _ = program::run(run).with_code(code);
        assert!(suite.read("junit.xml").contains(want), "{}", suite.read("junit.xml"));
    }
    // What can't be written is an error before the run; after an error it is a warning.
    let nowhere = suite.path("nowhere/junit.xml");
    let run = ["run", &suite.path("s/a.toml"), "--device", "inproc", "--junit", &nowhere];
    let ended = program::run(run).with_code(2);
    assert!(ended.stdout.is_empty() && ended.stderr.contains("with --junit"), "{}", ended.stderr);
    let run = ["run", &suite.path("s/a.toml"), "--device", "exec:false", "--junit", "/dev/full"];
    let ended = program::run(run).with_code(4);
    assert!(ended.stderr.contains("lashloop: warning: /dev/full"), "{}", ended.stderr);
}

#[test]
fn a_report_replaces_no_scenario_and_no_file_of_a_record() {
    let suite = Suite::new(&[("a.toml", SHORT.to_owned())]);
    let [scenario, baseline, record] =
        ["s/a.toml", "s/a.baseline.toml", "record"].map(|name| suite.path(name));
    fs::write(&baseline, "").expect("a baseline");
    let run = ["run", &scenario, "--device", "inproc"];
    let _ = program::run(run.iter().chain(&["--out", &record])).with_code(0);
    let summary = suite.path("record/summary.json");
    for (option, file) in
        [("--html", &scenario), ("--junit", &scenario), ("--junit", &baseline), ("--html", &summary)]
    {
        let before = fs::read_to_string(file).expect("a file");
        let refused = suite.run(&[option, file]).with_code(2);
        assert!(refused.stderr.contains("name another file"), "{}", refused.stderr);
        assert_eq!(fs::read_to_string(file).expect("a file"), before, "{option} {file}");
    }
    for file in [&scenario, &summary] {
        let before = fs::read_to_string(file).expect("a file");
        let _ = program::run(run.iter().chain(&["--junit", file])).with_code(2);
        assert_eq!(fs::read_to_string(file).expect("a file"), before, "{file}");
    }
}

#[test]
fn a_killed_command_leaves_no_report_that_has_passed() {
    let suite = Suite::new(&[("a.toml", SHORT.to_owned())]);
    let [out, junit, html] = ["out", "junit.xml", "index.html"].map(|name| suite.path(name));
    let (scenario, reports) = (suite.path("s/a.toml"), ["--junit", &junit, "--html", &html]);
    let _ = suite.run(&reports).with_code(0);
    let passed = suite.read("junit.xml");
    suite.write("a.toml", &SHORT.replace("1.5", "1e5"));
    let has_new_junit = || suite.junit_counts("junit.xml")[3] == 1;
    let kill = |bench: Running, has_new_reports: &dyn Fn() -> bool| {
        wait::until("the new reports", || has_new_reports().then_some(()));
        bench.signal(Signal::KILL);
        assert_eq!(bench.wait().code, None);
        assert!(has_new_reports());
    };
    kill(suite.start(&[&["--out", &out], &reports[..]].concat()), &|| {
        has_new_junit() && suite.badge("index.html") == "INCOMPLETE"
    });
    fs::write(&junit, passed).expect("a report");
    kill(Running::start(["run", &scenario, "--device", "inproc", "--junit", &junit]), &has_new_junit);
    assert!(suite.read("junit.xml").contains("the run has not ended"));
    // A suite that is refused leaves the reports of the results that stay.
    let before = [suite.read("junit.xml"), suite.read("index.html")];
    let _ = suite.run(&[&["--out", &out], &reports[..]].concat()).with_code(2);
    assert_eq!([suite.read("junit.xml"), suite.read("index.html")], before);
}

#[test]
fn one_drive_takes_one_job() {
    let ended =
        program::run(["test", "scenarios", "--device", "tcp:localhost:1", "--jobs", "2"]).with_code(2);
    assert!(
        ended.stderr.contains("--jobs 2 needs as many drives, and --device tcp:localhost:1 is one"),
        "{}",
        ended.stderr
    );
}

#[test]
fn a_suite_without_a_run_never_passes() {
    let bench_mode = SHORT.replace("[run]", "[run]\nmode = \"bench\"").replace("smooth", "backlash-shaft");
    let suite = Suite::new(&[("a.toml", bench_mode.clone()), ("b.toml", bench_mode)]);
    let [junit, html] = ["junit.xml", "index.html"].map(|name| suite.path(name));
    let ended = suite.run(&["--device", "native", "--junit", &junit, "--html", &html]).with_code(2);
    assert_eq!(suite.rows(&ended), ["SKIPPED a.toml", "SKIPPED b.toml"]);
    assert_eq!(suite.junit_counts("junit.xml"), [3, 2, 0, 1], "{}", suite.read("junit.xml"));
    assert_eq!(suite.badge("index.html"), "NO VERDICT");
}

#[test]
fn a_suite_that_can_not_record_leaves_no_earlier_report() {
    let suite = Suite::new(&[("a.toml", SHORT.to_owned())]);
    let [out, junit, html] = ["out", "junit.xml", "index.html"].map(|name| suite.path(name));
    let options = ["--junit", &junit, "--html", &html];
    let _ = suite.run(&options).with_code(0);
    assert_eq!(suite.badge("index.html"), "PASS");
    fs::create_dir(suite.path("out")).expect("a folder");
    fs::write(suite.path("out/records"), "no folder").expect("a file");
    let ended = suite.run(&[&["--out", &out], &options[..]].concat()).with_code(2);
    assert!(ended.stderr.contains("out/records"), "{}", ended.stderr);
    assert_eq!(suite.junit_counts("junit.xml"), [1, 0, 0, 1], "{}", suite.read("junit.xml"));
    assert!(!fs::exists(suite.path("index.html")).expect("a folder"));
}

#[test]
fn no_record_is_inside_another() {
    let suite = Suite::new(&[
        ("a/b.toml", format!("{SHORT}{PEAK}max = 0.1\n")),
        // Ends after the other, as a pass without a record.
        ("a.toml", SHORT.replace("1.5", "10")),
    ]);
    let out = suite.path("out");
    let _ = suite.run(&["--out", &out, "--jobs", "2"]).with_code(1);
    let journal = suite.journal();
    let record = journal.iter().find_map(|result| result["record"].as_str()).expect("the record of b");
    assert!(Path::new(record).join("summary.json").is_file(), "{record}");
}

#[test]
fn equal_cases_of_a_sweep_are_one() {
    let suite = Suite::new(&[("a.toml", format!("{SHORT}{}", NOISE.replace("0.2, 0.3", "0.1, 0.4")))]);
    let ended = suite.run(&[]).with_code(0);
    assert!(ended.stdout.contains("\n2 cases: 2 PASS"), "{}", ended.stdout);
}

#[test]
fn a_path_without_a_unicode_name_is_a_case() {
    let suite = Suite::new(&[("a.toml", SHORT.to_owned())]);
    let [out, html] = ["out", "index.html"].map(|name| suite.path(name));
    let folder = suite.folder.path().join("s");
    let files = [&b"\xfe.toml"[..], b"\xff.toml"].map(|name| folder.join(OsStr::from_bytes(name)));
    for file in &files {
        fs::copy(folder.join("a.toml"), file).expect("a scenario");
    }
    let options = ["--device", "inproc", "--keep-passes", "--out", &out, "--html", &html].map(OsStr::new);
    let words = [OsStr::new("test"), files[0].as_os_str(), files[1].as_os_str()];
    let ended = program::run(words.into_iter().chain(options)).with_code(0);
    assert!(ended.stdout.contains("\n2 cases: 2 PASS"), "{}", ended.stdout);
    assert_eq!(fs::read_dir(suite.path("out/records")).expect("records").count(), 2);
}
