//! The native twin conforms to the protocol, and the report shows every check.

use tests::battery::{self, LASHLOOP_BENCH_SKIPS, LASHLOOP_SKIPS};
use tests::program::run;
use tests::twin::Twin;

/// The number of checks, of which all passed but those that the Lashloop drive's description excludes. Tests of the checks
/// make them on a drive that has everything.
fn all_passed(stdout: &str) -> usize {
    battery::all_passed(stdout, LASHLOOP_SKIPS)
}

#[test]
fn the_native_twin_passes_every_check_it_can_show() {
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
fn a_drive_in_process_passes_every_check_it_can_show() {
    all_passed(&run(["conformance", "--device", "inproc"]).with_code(0).stdout);
}

#[test]
fn a_drive_in_process_passes_every_check_of_bench_mode_with_a_plant_at_its_pins() {
    let plant = "scenarios/bench-smooth-after.toml";
    let ended = run(["conformance", "--device", "inproc", "--bench-mode", "--plant", plant]).with_code(0);
    battery::all_passed(&ended.stdout, LASHLOOP_BENCH_SKIPS);
}

#[test]
fn a_program_that_ends_by_itself_breaks_a_rule_and_one_that_is_killed_does_not() {
    for (command, code) in [("exec:false", 1), ("exec:sh -c 'kill -SEGV $$'", 1), ("exec:sh -c 'kill $$'", 4)]
    {
        let ended = run(["conformance", "--device", command]).with_code(code);
        let line = "FAIL          run: the drive runs to the last check; expected a program that ends with its input";
        assert_eq!(ended.stdout.contains(line), code == 1, "{command}: {}{}", ended.stdout, ended.stderr);
    }
}

#[test]
fn a_plant_of_hil_mode_is_refused() {
    let plant = "scenarios/smooth-after.toml";
    let ended = run(["conformance", "--device", "inproc", "--bench-mode", "--plant", plant]).with_code(2);
    assert!(ended.stderr.contains("take a scenario with run.mode = \"bench\""), "{}", ended.stderr);
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
    let mut wanted: Vec<_> = lashloop_conformance::list().map(|it| it.group).collect();
    wanted.dedup();
    assert_eq!(groups, wanted);
    assert!(groups.len() > 10, "{groups:?}");
}

#[test]
fn a_silent_drive_leaves_an_error_with_its_diagnosis_in_the_junit_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("conformance.xml");
    let file = path.display().to_string();
    let _ = run(["conformance", "--device", "exec:sleep 60", "--junit", &file]).with_code(4);
    let text = std::fs::read_to_string(&path).expect("a report");
    let document = roxmltree::Document::parse(&text).expect("XML");
    let suites = document.root_element();
    assert_eq!((suites.attribute("tests"), suites.attribute("errors")), (Some("1"), Some("1")), "{text}");
    let error = document.descendants().find(|it| it.has_tag_name("error")).expect("an error");
    let message = error.attribute("message").expect("a message");
    assert!(message.contains("the drive was silent for 2.5 s"), "{message}");
}

#[test]
fn the_list_has_every_check_and_every_rule_without_one() {
    let listed = run(["conformance", "--list"]).with_code(0).stdout;
    let checks = lashloop_conformance::list().count();
    let unchecked = lashloop_conformance::unchecked::UNCHECKED.len();
    assert_eq!(listed.lines().count(), checks + unchecked, "{listed}");
    assert_eq!(listed.lines().filter(|line| line.contains("  no check: ")).count(), unchecked, "{listed}");
    let ran = run(["conformance", "--device", "inproc"]).with_code(0).stdout;
    assert_eq!(all_passed(&ran), checks, "{ran}");
}

#[test]
fn an_unwritable_report_is_named() {
    let ended = run(["conformance", "--device", "inproc", "--junit", "/nowhere/report.xml"]).with_code(2);
    assert!(
        ended.stderr.starts_with("lashloop: /nowhere/report.xml: can't be written: "),
        "{}",
        ended.stderr
    );
}
