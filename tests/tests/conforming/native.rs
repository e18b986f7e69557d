//! The native twin keeps to the protocol, and the report says so.

use tests::bench::run;
use tests::twin::Twin;

/// What a run that skipped no check ends with, and how many checks it made.
fn all_passed(stdout: &str) -> usize {
    let last = stdout.lines().last().unwrap_or_default();
    let passed = last.strip_suffix(" passed, 0 failed, 0 skipped").and_then(|count| count.parse().ok());
    let passed = passed.unwrap_or_else(|| panic!("not all checks passed\n{stdout}"));
    let lines = stdout.lines().filter(|line| line.starts_with("PASS ")).count();
    assert_eq!(lines, passed, "a line for each check");
    passed
}

#[test]
fn the_native_twin_passes_every_check_and_none_is_skipped() {
    let ended = run(["conformance", "--device", "native"]).with_code(0);
    assert!(ended.stdout.starts_with("native (native-twin, firmware "), "{}", ended.stdout);
    all_passed(&ended.stdout);
}

#[test]
fn a_drive_on_a_terminal_passes_every_check() {
    let twin = Twin::start();
    all_passed(&run(["conformance", "--device", &twin.device()]).with_code(0).stdout);
}

#[test]
fn in_process_three_checks_are_skipped_aloud() {
    let ended = run(["conformance", "--device", "inproc"]).with_code(0);
    let skipped: Vec<_> = ended.stdout.lines().filter(|line| line.starts_with("SKIPPED ")).collect();
    assert_eq!(skipped.len(), 3, "{}", ended.stdout);
    for line in skipped {
        assert!(line.ends_with("not run: in process no device time passes"), "{line}");
    }
    assert!(ended.stdout.ends_with(" passed, 0 failed, 3 skipped\n"), "{}", ended.stdout);
}

#[test]
fn the_junit_file_has_every_check_as_a_case_of_its_group() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("conformance.xml");
    let file = path.display().to_string();
    let ended = run(["conformance", "--device", "native", "--junit", &file]).with_code(0);
    let text = std::fs::read_to_string(&path).expect("a report");
    let document = roxmltree::Document::parse(&text).expect("XML");
    let suites = document.root_element();
    assert_eq!(suites.attribute("tests"), Some(&*all_passed(&ended.stdout).to_string()));
    assert_eq!((suites.attribute("failures"), suites.attribute("errors")), (Some("0"), Some("0")));
    let groups: Vec<_> = suites
        .children()
        .filter(|it| it.has_tag_name("testsuite"))
        .filter_map(|it| it.attribute("name"))
        .collect();
    let wanted =
        ["handshake", "transitions", "parameters", "samples", "encoders", "safety", "line", "latency"];
    assert_eq!(groups, wanted);
}

#[test]
fn a_report_that_can_t_be_written_is_named() {
    let ended = run(["conformance", "--device", "inproc", "--junit", "/nowhere/report.xml"]).with_code(2);
    assert!(
        ended.stderr.starts_with("lashloop: /nowhere/report.xml: can't be written: "),
        "{}",
        ended.stderr
    );
}
