//! `lashloop test`, `check` and `completions`: folders of scenarios, and what editors and shells get.

use std::fs;
use std::path::Path;
use std::process::Command;

use rustix::process::Signal;
use tempfile::TempDir;
use tests::program::{self, Ended, Running};
use tests::{wait, workspace};

const SHORT: &str = "title = \"short\"\n[run]\nduration_s = 1.5\n[plant]\nmodel = \"smooth\"\n[controller]\nname = \"pd\"\n\
                     [reference]\nprofile = \"constant\"\nposition_rad = 0.0\n";
const PEAK: &str = "[[expect]]\nmetric = \"peak_tracking_error_rad\"\nunit = \"rad\"\n";
const NOISE: &str = "[[sweep.axis]]\nkey = \"encoders.noise_counts\"\nvalues = [0.1, 0.2, 0.3, 0.4]\n";

/// A folder of scenarios, and one for results.
struct Suite {
    folder: TempDir,
}

impl Suite {
    fn new(files: &[(&str, String)]) -> Self {
        let suite = Self { folder: tempfile::tempdir().expect("a folder") };
        for (name, text) in files {
            suite.write(name, text);
        }
        suite
    }

    fn write(&self, name: &str, text: &str) {
        fs::create_dir_all(self.folder.path().join("s")).expect("a folder");
        fs::write(self.folder.path().join("s").join(name), text).expect("a scenario");
    }

    fn path(&self, name: &str) -> String {
        self.folder.path().join(name).display().to_string()
    }

    fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    fn start(&self, options: &[&str]) -> Running {
        let scenarios = self.path("s");
        let common = ["test", scenarios.as_str(), "--device", "inproc"];
        Running::start(common.iter().chain(options))
    }

    fn run(&self, options: &[&str]) -> Ended {
        self.start(options).wait()
    }

    /// Status and case of each row.
    fn rows(&self, ended: &Ended) -> Vec<String> {
        let folder = self.path("s") + "/";
        let rows = ended.stdout.lines().filter(|line| line.contains(&folder) && !line.starts_with(' '));
        rows.map(|line| line.replace(&folder, "").split("  ").take(3).collect::<Vec<_>>().join(" "))
            .map(|row| row.split_whitespace().collect::<Vec<_>>().join(" "))
            .collect()
    }
}

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

    let text = suite.read("junit.xml");
    let document = roxmltree::Document::parse(&text).expect("XML");
    let root = document.root_element();
    let counts = ["tests", "failures", "errors", "skipped"].map(|name| root.attribute(name));
    assert_eq!(counts, [Some("8"), Some("1"), Some("1"), Some("1")]);
    assert_eq!(document.descendants().filter(|node| node.has_tag_name("testsuite")).count(), 5);

    // The record of the failure alone, with its report.
    let records: Vec<_> =
        ended.stdout.lines().filter_map(|line| line.trim().strip_prefix("record: ")).collect();
    let [record] = records[..] else { panic!("one record: {records:?}") };
    assert!(record.ends_with("/s/missed") && Path::new(record).join("summary.json").is_file(), "{record}");
    let page = suite.read("out/index.html");
    let address = page.split('"').find(|word| word.ends_with("missed/report.html")).expect("a link");
    assert!(Path::new(&out).join(address).is_file(), "{address}");
    let passed = Path::new(record).with_file_name("good");
    assert!(!passed.exists(), "a pass leaves no record");
}

#[test]
fn a_metric_that_leaves_its_baseline_fails_and_is_named() {
    let suite = Suite::new(&[("a.toml", SHORT.to_owned())]);
    let _ = suite.run(&["--update"]).with_code(0);
    let _ = suite.run(&[]).with_code(0);
    let baseline = suite.read("s/a.baseline.toml");
    let line = baseline.lines().find(|line| line.starts_with("peak_tracking_error_rad")).expect("a metric");
    assert_eq!(line, "peak_tracking_error_rad = { value = 1.5708, tolerance = 0.031 }");
    suite.write("a.baseline.toml", &baseline.replace(line, &line.replace("1.5708", "1.5")));
    let ended = suite.run(&[]).with_code(1);
    let sentence = "peak_tracking_error_rad: 1.5708 rad; leaves its baseline 1.5 +- 0.031 rad";
    assert!(ended.stdout.contains(sentence), "{}", ended.stdout);
    // An update takes the new value and keeps the tolerance.
    let _ = suite.run(&["--update"]).with_code(0);
    assert_eq!(suite.read("s/a.baseline.toml"), baseline);
}

#[test]
fn a_suite_that_was_cut_short_runs_what_is_missing() {
    let suite = Suite::new(&[("a.toml", format!("{SHORT}{NOISE}"))]);
    let out = suite.path("out");
    let _ = suite.run(&["--out", &out, "--jobs", "1"]).with_code(0);
    let whole = suite.read("out/cases.jsonl");
    assert_eq!(whole.lines().count(), 5, "{whole}");
    // Without --resume or --force nothing is overwritten.
    let refused = suite.run(&["--out", &out]).with_code(2);
    assert!(refused.stderr.contains("--resume to complete it, --force to replace it"), "{}", refused.stderr);
    let two: String = whole.split_inclusive('\n').take(3).collect();
    fs::write(suite.path("out/cases.jsonl"), two + "{\"case\"").expect("a torn journal");
    let ended = suite.run(&["--out", &out, "--resume", "--jobs", "1"]).with_code(0);
    assert_eq!(ended.stderr.lines().count(), 2, "two cases are run again: {}", ended.stderr);
    let digests = |text: &str| -> Vec<String> {
        let results =
            text.lines().skip(1).map(|line| serde_json::from_str::<serde_json::Value>(line).expect("JSON"));
        results.map(|result| result["torque_sha256"].as_str().expect("a digest").to_owned()).collect()
    };
    assert_eq!(digests(&suite.read("out/cases.jsonl")), digests(&whole));
    // A case whose scenario has changed is run again, the others are not.
    suite.write("a.toml", &format!("{SHORT}{}", NOISE.replace("0.4", "0.5")));
    let ended = suite.run(&["--out", &out, "--resume"]).with_code(0);
    assert_eq!(ended.stderr.lines().count(), 1, "{}", ended.stderr);
}

#[test]
fn an_interrupted_suite_ends_its_jobs_and_can_be_resumed() {
    let endless = SHORT.replace("1.5", "1e5");
    let suite = Suite::new(&[("a.toml", SHORT.to_owned()), ("b.toml", endless.clone()), ("c.toml", endless)]);
    let [out, junit] = ["out", "junit.xml"].map(|name| suite.path(name));
    let bench = suite.start(&["--out", &out, "--junit", &junit, "--jobs", "2"]);
    let has_result = || {
        let journal = fs::read_to_string(suite.path("out/cases.jsonl")).unwrap_or_default();
        (journal.lines().count() == 2).then_some(())
    };
    wait::look(std::time::Duration::from_secs(60), has_result).expect("the first result");
    bench.signal(Signal::INT);
    let ended = bench.wait().with_code(3);
    assert!(
        ended.stdout.contains("3 cases: 1 PASS, 0 FAIL, 0 INVALID, 0 ERROR, 0 SKIPPED, 2 not run"),
        "{}",
        ended.stdout
    );
    assert!(ended.stdout.ends_with("interrupted; --resume completes it\n"), "{}", ended.stdout);
    assert!(suite.read("junit.xml").contains("interrupted; 1 of 3 cases have a result"));
    for name in ["b.toml", "c.toml"] {
        suite.write(name, SHORT);
    }
    let ended = suite.run(&["--out", &out, "--resume"]).with_code(0);
    assert!(ended.stdout.contains("3 cases: 3 PASS"), "{}", ended.stdout);
    assert_eq!(ended.stderr.lines().count(), 2, "{}", ended.stderr);
}

#[test]
fn one_run_has_a_junit_report_with_a_verdict_or_without() {
    let suite =
        Suite::new(&[("a.toml", format!("{SHORT}{PEAK}max = 0.1\n")), ("b.toml", format!("{SHORT}{NOISE}"))]);
    let junit = suite.path("junit.xml");
    for (name, code, want) in [
        ("s/a.toml", 1, r#"failures="1" errors="0""#),
        ("s/b.toml", 2, "4 cases of a sweep are run by `lashloop test`"),
    ] {
        let run = ["run", &suite.path(name), "--device", "inproc", "--junit", &junit];
        let _ = program::run(run).with_code(code);
        assert!(suite.read("junit.xml").contains(want), "{}", suite.read("junit.xml"));
    }
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
fn a_check_reports_every_error_at_its_line_and_column() {
    let wrong =
        format!("{SHORT}{NOISE}").replace("duration_s = 1.5", "duration_s = -1").replace("0.4]", "-4]");
    let suite = Suite::new(&[("a.toml", wrong), ("b.toml", SHORT.to_owned())]);
    suite.write("b.baseline.toml", "[[case]]\n[case.metrics]\nspeed = { value = 1, tolerance = 1 }\n");
    let ended = program::run(["check", &suite.path("s")]).with_code(2);
    let places: Vec<_> = ended.stdout.lines().map(|line| line.replace(&suite.path("s/"), "")).collect();
    let starts = [
        "a.toml:3:1: run.duration_s: -1 is out of range",
        "a.toml:12:1: [sweep] encoders.noise_counts=-4: encoders.noise_counts: -4 is out of range",
        "b.baseline.toml:3:1: speed is no metric",
    ];
    assert_eq!(places.len(), starts.len(), "{}", ended.stdout);
    for (place, start) in places.iter().zip(starts) {
        assert!(place.starts_with(start), "{place}\nnot {start}");
    }
    let json = program::run(["check", "--json", &suite.path("s")]).with_code(2).stdout;
    let findings: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!((&findings[1]["line"], &findings[1]["column"]), (&12.into(), &1.into()));
    let ended = program::run(["check", "scenarios", "examples"]).with_code(2);
    assert!(!ended.stdout.contains("scenarios/"), "the scenarios of the tree are right: {}", ended.stdout);
}

#[test]
fn the_hook_rejects_a_commit_with_a_wrong_scenario() {
    let suite = Suite::new(&[]);
    let folder = suite.folder.path();
    let git = |arguments: &[&str]| {
        let path = format!("{}:{}", program::lashloop().parent().expect("a folder").display(), env!("PATH"));
        let identity = ["-c", "user.name=a", "-c", "user.email=a@example.org"];
        let mut command = Command::new("git");
        command.args(identity).args(arguments).current_dir(folder).env("PATH", path);
        command.output().expect("git starts")
    };
    assert!(git(&["init", "--quiet"]).status.success());
    let hooks = folder.join(".git/hooks");
    fs::create_dir_all(&hooks).expect("a folder");
    fs::copy(workspace().join("docs/ci/pre-commit"), hooks.join("pre-commit")).expect("the hook");
    fs::create_dir(folder.join("scenarios")).expect("a folder");
    for (text, is_right) in [(SHORT.to_owned(), true), (SHORT.replace("1.5", "-1"), false)] {
        fs::write(folder.join("scenarios/a.toml"), text).expect("a scenario");
        assert!(git(&["add", "."]).status.success());
        let commit = git(&["commit", "--quiet", "-m", "a scenario"]);
        let printed =
            String::from_utf8_lossy(&commit.stdout).into_owned() + &String::from_utf8_lossy(&commit.stderr);
        assert_eq!(commit.status.success(), is_right, "{printed}");
        assert_eq!(printed.contains("scenarios/a.toml:3:1: run.duration_s"), !is_right, "{printed}");
    }
}

#[test]
fn completions_and_man_pages_have_every_command() {
    let help = program::run(["--help"]).with_code(0).stdout;
    let (_, commands) = help.split_once("Run a drive on the bench:").expect("the first group");
    let (commands, _) = commands.split_once("Options:").expect("the options");
    let is_command = |line: &&str| line.starts_with("  ");
    let commands: Vec<_> =
        commands.lines().filter(is_command).filter_map(|line| line.split_whitespace().next()).collect();
    assert!(commands.len() > 20 && commands.contains(&"completions"), "{commands:?}");
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = program::run(["completions", shell]).with_code(0).stdout;
        for command in &commands {
            assert!(script.contains(command), "{shell} lacks {command}");
        }
    }
    let bash = program::run(["completions", "bash"]).with_code(0).stdout;
    let loaded =
        Command::new("bash").args(["-c", &format!("{bash}\ncomplete -p lashloop")]).output().expect("bash");
    assert!(loaded.status.success(), "{}", String::from_utf8_lossy(&loaded.stderr));
    let folder = tempfile::tempdir().expect("a folder");
    let man = folder.path().display().to_string();
    let _ = program::run(["completions", "--man", &man]).with_code(0);
    for command in &commands {
        let page = fs::read_to_string(folder.path().join(format!("lashloop-{command}.1"))).expect("a page");
        assert!(page.contains(".SH SYNOPSIS"), "{command}");
    }
}
