//! A page of `docs/extend` as a walk: its files are written and its commands run, in order, in a folder of their own.
//!
//! A fence of `sh` is a list of commands. A fence with a second word, as in `python my_drive.py`, is that file. Any other
//! fence is text.

use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::Command;

use crate::{program, workspace};

/// Walks through a page, with `programs` ahead in `PATH`.
///
/// # Panics
/// A command fails; the panic shows its output. Or the page has no command.
pub fn through(page: &str, programs: &[&Path]) {
    through_by(page, programs, || Command::new("sh"));
}

/// As [`through`], by a shell with variables of its own.
///
/// # Panics
/// As [`through`].
pub fn through_by(page: &str, programs: &[&Path], shell: impl Fn() -> Command) {
    let folder = tempfile::tempdir().expect("a folder");
    for entry in ["campaigns", "clients", "examples", "protocol", "scenarios"] {
        symlink(workspace().join(entry), folder.path().join(entry)).expect("a link");
    }
    through_in(folder.path(), page, programs, shell);
}

/// Walks through a page in a copy of the workspace, with what is built there of images.
///
/// # Panics
/// As [`through`], or the workspace can't be copied.
pub fn through_in_a_copy(page: &str) {
    let folder = tempfile::tempdir().expect("a folder");
    fs::create_dir(folder.path().join("target")).expect("a folder");
    let copied = Command::new("sh")
        .args(["-ec", "git ls-files -z | xargs -0 cp -p --parents -t \"$1\"; cp -a target/image target/thumbv7em-none-eabihf \"$1/target\"", "sh"])
        .arg(folder.path())
        .current_dir(workspace())
        .status();
    assert!(copied.expect("sh starts").success(), "the workspace can't be copied");
    through_in(folder.path(), page, &[], || Command::new("sh"));
}

fn through_in(folder: &Path, page: &str, programs: &[&Path], shell: impl Fn() -> Command) {
    let text = fs::read_to_string(workspace().join(page)).expect("the page");
    let lashloop = program::lashloop().parent().expect("the folder of the profile");
    let folders = programs.iter().copied().chain([lashloop]).map(|folder| folder.display().to_string());
    let path = folders.chain(std::env::var("PATH")).collect::<Vec<_>>().join(":");
    let mut commands = 0;
    for (info, contents) in fences(&text) {
        match info.split_once(' ') {
            Some((_, file)) => fs::write(folder.join(file), contents).expect("a file of the page"),
            None if info == "sh" => {
                commands += 1;
                let ended = shell().args(["-exc", &contents]).env("PATH", &path).current_dir(folder).output();
                let ended = ended.expect("sh starts");
                let [stdout, stderr] =
                    [&ended.stdout, &ended.stderr].map(|text| String::from_utf8_lossy(text));
                assert!(ended.status.success(), "{page}: {}\n{contents}\n{stdout}\n{stderr}", ended.status);
            }
            None => {}
        }
    }
    assert!(commands > 0, "{page} has no command");
}

/// The information and the contents of each fence.
fn fences(text: &str) -> Vec<(String, String)> {
    let mut fences = Vec::new();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        if let Some(info) = line.strip_prefix("```") {
            let contents: String =
                lines.by_ref().take_while(|line| *line != "```").map(|line| format!("{line}\n")).collect();
            fences.push((info.to_owned(), contents));
        }
    }
    fences
}
