//! `lashloop test --dry-run`, and the git hook that calls it.

use std::fs;
use std::process::{Command, Output};

use tests::{program, workspace};

use super::fixture::{NOISE, SHORT, Suite, with_table};

#[test]
fn a_check_reports_every_error_at_its_line_and_column() {
    let wrong =
        format!("{SHORT}{NOISE}").replace("duration_s = 1.5", "duration_s = -1").replace("0.4]", "-4]");
    let suite = Suite::new(&[("a.toml", wrong), ("b.toml", SHORT.to_owned())]);
    suite.write("b.baseline.toml", "[[case]]\n[case.metrics]\nspeed = { value = 1, tolerance = 1 }\n");
    let ended = program::run(["test", "--dry-run", &suite.path("s")]).with_code(2);
    let places: Vec<_> = ended.stdout.lines().map(|line| line.replace(&suite.path("s/"), "")).collect();
    let starts = [
        "a.toml:3:1: run.duration_s: -1 is out of range",
        "a.toml:12:1: [sweep] encoders.noise_counts=-4: encoders.noise_counts: -4 is out of range",
        "b.baseline.toml:3:1: speed isn't a metric",
    ];
    assert_eq!(places.len(), starts.len(), "{}", ended.stdout);
    for (place, start) in places.iter().zip(starts) {
        assert!(place.starts_with(start), "{place}\nnot {start}");
    }
    let json = program::run(["test", "--dry-run", "--json", &suite.path("s")]).with_code(2).stdout;
    let findings: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!((&findings[1]["line"], &findings[1]["column"]), (&12.into(), &1.into()));
    let ended = program::run(["test", "--dry-run", "scenarios", "examples"]).with_code(2);
    assert!(!ended.stdout.contains("scenarios/"), "the scenarios of the tree are right: {}", ended.stdout);
}

/// A repository with the hook.
struct Repository {
    suite: Suite,
}

impl Repository {
    fn new() -> Self {
        let repository = Self { suite: Suite::new(&[]) };
        assert!(repository.git(&["init", "--quiet"]).status.success());
        let hooks = repository.suite.folder.path().join(".git/hooks");
        fs::create_dir_all(&hooks).expect("a folder");
        fs::copy(workspace().join("docs/ci/pre-commit"), hooks.join("pre-commit")).expect("the hook");
        fs::create_dir(repository.suite.folder.path().join("scenarios")).expect("a folder");
        repository
    }

    fn git(&self, arguments: &[&str]) -> Output {
        let path = format!("{}:{}", program::lashloop().parent().expect("a folder").display(), env!("PATH"));
        let identity = ["-c", "user.name=a", "-c", "user.email=a@example.org"];
        let mut command = Command::new("git");
        command.args(identity).args(arguments).current_dir(self.suite.folder.path()).env("PATH", path);
        command.output().expect("git starts")
    }

    fn write(&self, name: &str, text: &str) {
        fs::write(self.suite.folder.path().join("scenarios").join(name), text).expect("a file");
    }

    fn stage(&self, name: &str, text: &str) {
        self.write(name, text);
        assert!(self.git(&["add", "."]).status.success());
    }

    /// The error that rejects a commit of what is staged; `None` if the commit is made.
    fn rejection(&self) -> Option<String> {
        let commit = self.git(&["commit", "--quiet", "-m", "a scenario"]);
        let printed = [commit.stdout, commit.stderr].concat();
        (!commit.status.success()).then(|| String::from_utf8_lossy(&printed).into_owned())
    }
}

#[test]
fn the_hook_rejects_a_commit_with_a_wrong_scenario() {
    let repository = Repository::new();
    let wrong = SHORT.replace("1.5", "-1");
    repository.stage("a.toml", SHORT);
    assert_eq!(repository.rejection(), None);
    repository.stage("a.toml", &wrong);
    let rejection = repository.rejection().expect("a wrong scenario");
    assert!(rejection.starts_with("scenarios/a.toml:3:1: run.duration_s"), "{rejection}");
    // What is staged counts, not what is in the folder.
    repository.write("a.toml", SHORT);
    let rejection = repository.rejection().expect("a wrong scenario");
    assert!(rejection.starts_with("scenarios/a.toml:3:1: run.duration_s"), "{rejection}");
    repository.stage("b.toml", SHORT);
    repository.write("b.toml", &wrong);
    assert_eq!(repository.rejection(), None);
}

#[test]
fn the_hook_checks_the_files_that_a_scenario_needs() {
    let repository = Repository::new();
    repository.write("reference.csv", "time_s,position_rad\n0,0\n2,0\n");
    repository.stage("a.toml", &with_table("reference.csv"));
    assert_eq!(repository.rejection(), None);
    // A baseline alone, and the removal of a file that a scenario names.
    repository.stage("a.baseline.toml", "[[case]]\n[case.metrics]\nspeed = { value = 1, tolerance = 1 }\n");
    let rejection = repository.rejection().expect("a wrong baseline");
    assert!(rejection.starts_with("scenarios/a.baseline.toml:3:1: speed isn't a metric"), "{rejection}");
    assert!(repository.git(&["rm", "--quiet", "--force", "scenarios/a.baseline.toml"]).status.success());
    assert!(repository.git(&["rm", "--quiet", "--cached", "scenarios/reference.csv"]).status.success());
    let rejection = repository.rejection().expect("a reference without its table");
    assert!(rejection.contains("scenarios/a.toml:"), "{rejection}");
    // The table may be outside the folder of the scenarios.
    repository.write("../table.csv", "time_s,position_rad\n0,0\n2,0\n");
    repository.stage("a.toml", &with_table("../table.csv"));
    assert_eq!(repository.rejection(), None);
    repository.stage("../table.csv", "time_s,position_rad\n0,0\n2,x\n");
    let rejection = repository.rejection().expect("a wrong table");
    assert!(rejection.contains("table.csv"), "{rejection}");
    // A commit without a scenario is not held up.
    assert!(repository.git(&["rm", "--quiet", "--cached", "scenarios/a.toml"]).status.success());
    assert_eq!(repository.rejection(), None);
}
