//! What a run prints while it lasts, and in which colour.

use std::process::Command;

use crate::support::{LASHLOOP, root, text};

/// Standard output and standard error of a run of 0.1 s with this environment.
fn run(environment: &[(&str, &str)]) -> (String, String) {
    let scenario = root().join("scenarios/faults.toml");
    let mut command = Command::new(LASHLOOP);
    command.arg("run").arg(scenario).args(["--device", "inproc"]);
    command.args(["--set", "run.duration_s=0.1", "--set", "expect=[]"]);
    for name in ["NO_COLOR", "CLICOLOR", "CLICOLOR_FORCE", "RUST_LOG"] {
        command.env_remove(name);
    }
    let output = command.envs(environment.iter().copied()).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    (text(&output.stdout).to_owned(), text(&output.stderr).to_owned())
}

#[test]
fn a_verdict_has_a_colour_unless_no_color_is_set() {
    let begins = |environment, with| assert!(run(environment).0.starts_with(with), "{environment:?}");
    begins(&[], "PASS, nothing expected  ");
    begins(&[("CLICOLOR_FORCE", "1")], "\u{1b}[1m\u{1b}[32mPASS, nothing expected\u{1b}[0m  ");
    begins(&[("CLICOLOR_FORCE", "1"), ("NO_COLOR", "1")], "PASS, nothing expected  ");
}

#[test]
fn a_short_run_shows_no_progress() {
    assert_eq!(run(&[]).1, "");
}
