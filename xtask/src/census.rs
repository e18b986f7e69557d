//! The mutation census of the drive's code: each bug of the list is planted in a copy of the tree, where the test that it names
//! has to fail.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use anyhow::{Context, Result, ensure};
use serde::Deserialize;

use crate::command;
use crate::paths;

/// The list of bugs.
const LIST: &str = "tests/census/board.json";
/// Fewest bugs that tests kill, in percent.
const LEAST_PERCENT: usize = 97;
/// A bug may make its test endless.
const TIMEOUT: &str = "timeout 900";

#[derive(Deserialize)]
struct Bug {
    /// A sentence.
    bug: String,
    /// The file in `firmware/src`, or from the root if it is one of `host`, with the text that occurs once and what becomes of it.
    file: String,
    text: String,
    becomes: String,
    /// Where its test runs: `unit` tests of the library, its tests as a `drive`, of its `store` and its `torque`, the `usb` class, the
    /// commissioning (`identify`), or the image of a board on virtual silicon.
    at: String,
    /// Name of the test that kills it.
    test: String,
    /// Why none does.
    survives: Option<String>,
    /// What the models lack to show it: it doesn't count.
    beyond_models: Option<String>,
}

/// Plants every bug whose line contains one of the filters, and prints what became of it.
///
/// # Errors
/// The copy can't be made, or a test fails without a bug.
pub(crate) fn run(filters: &[String]) -> Result<ExitCode> {
    let tree = copy()?;
    let mut bugs: Vec<Bug> = serde_json::from_slice(&fs::read(paths::root().join(LIST))?)?;
    bugs.retain(|it| {
        let texts = [&it.at, &it.file, &it.bug, &it.test];
        filters.iter().any(|filter| texts.iter().any(|text| text.contains(filter)))
    });
    if bugs.iter().any(|it| host_tests(&it.at).is_none()) {
        // Some tests take the images of several boards.
        ensure!(passes(&mut in_tree(&tree, "cargo xtask image"))?.is_some(), "an image doesn't build");
        ensure!(
            passes(&mut in_tree(&tree, "cargo xtask silicon"))?.is_some(),
            "virtual silicon doesn't build"
        );
    }
    let mut killed = 0;
    let places: BTreeSet<_> = bugs.iter().map(|it| it.at.as_str()).collect();
    for place in places {
        ensure!(passes(&mut build(&tree, place))?.is_some(), "{place} doesn't build without a bug");
        let tests: BTreeSet<_> = bugs.iter().filter(|it| it.at == place).map(|it| it.test.as_str()).collect();
        for test in tests {
            let output = passes(&mut run_test(&tree, place, test))?;
            ensure!(output.is_some_and(|it| it.contains(" 1 passed")), "{place}: {test} fails without a bug");
        }
        for bug in bugs.iter().filter(|it| it.at == place) {
            let folder = if bug.file.starts_with("host/") { "" } else { "firmware/src" };
            let path = tree.join(folder).join(&bug.file);
            let text =
                fs::read_to_string(&path).with_context(|| format!("{} can't be read", path.display()))?;
            ensure!(
                text.matches(&bug.text).count() == 1,
                "{}: the text isn't there once: {}",
                bug.file,
                bug.text
            );
            fs::write(&path, text.replacen(&bug.text, &bug.becomes, 1))?;
            let verdict = verdict(&tree, bug);
            fs::write(&path, text)?;
            let verdict = verdict?;
            killed += usize::from(verdict == "killed" && bug.beyond_models.is_none());
            println!("{verdict}  {}: {} ({}: {})", bug.file, bug.bug, bug.at, bug.test);
            if let (Some(reason), "SURVIVED") =
                (bug.survives.as_ref().or(bug.beyond_models.as_ref()), verdict)
            {
                println!("          {reason}");
            }
        }
        // Tests of another place may take this image.
        ensure!(passes(&mut build(&tree, place))?.is_some(), "{place} doesn't build after the bugs");
    }
    let counted = bugs.iter().filter(|it| it.beyond_models.is_none()).count();
    let percent = (100 * killed).checked_div(counted).unwrap_or(100);
    println!("{killed} of {counted} bugs killed: {percent} %, at least {LEAST_PERCENT} % wanted");
    Ok(if percent >= LEAST_PERCENT { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

fn verdict(tree: &Path, bug: &Bug) -> Result<&'static str> {
    Ok(if passes(&mut build(tree, &bug.at))?.is_none() {
        "does not compile"
    } else if passes(&mut run_test(tree, &bug.at, &bug.test))?.is_none() {
        "killed"
    } else {
        "SURVIVED"
    })
}

/// The output of a command that succeeds.
fn passes(command: &mut Command) -> Result<Option<String>> {
    let output = command.output().with_context(|| command::cannot_start(command))?;
    Ok(output.status.success().then(|| String::from_utf8_lossy(&output.stdout).into_owned()))
}

fn build(tree: &Path, at: &str) -> Command {
    match host_tests(at) {
        Some(tests) => in_tree(tree, &format!("cargo test {tests} --no-run")),
        None => in_tree(tree, &format!("cargo xtask image {at}")),
    }
}

fn run_test(tree: &Path, at: &str, test: &str) -> Command {
    let silicon = "--release --ignore-rust-version --manifest-path virtual-silicon/Cargo.toml \
                   --target-dir target/virtual-silicon --tests";
    in_tree(tree, &format!("{TIMEOUT} cargo test {} {test}", host_tests(at).unwrap_or(silicon)))
}

fn host_tests(at: &str) -> Option<&'static str> {
    match at {
        "unit" => Some("--package lashloop-firmware --features usb --lib"),
        "drive" => Some("--package lashloop-firmware --features usb --test drive"),
        "store" => Some("--package lashloop-firmware --test store"),
        "torque" => Some("--package lashloop-firmware --test torque"),
        "usb" => Some("--package tests --test usb_class"),
        "identify" => Some("--package lashloop-identify --test identify"),
        _ => None,
    }
}

fn in_tree(tree: &Path, line: &str) -> Command {
    let (program, arguments) = line.split_once(' ').unwrap_or((line, ""));
    let mut command = command::command(program, arguments);
    command.current_dir(tree).env_remove("CARGO_TARGET_DIR");
    command
}

/// The tree without its builds.
fn copy() -> Result<PathBuf> {
    let tree = paths::root().join("target/census/tree");
    let list = "ls-files --cached --others --exclude-standard";
    for file in command::output(&mut command::command("git", list))?.lines() {
        // One that was removed is still in the index.
        let Ok(bytes) = fs::read(paths::root().join(file)) else { continue };
        let to = tree.join(file);
        // A file that stays keeps its time, so that it isn't built again.
        if fs::read(&to).ok().as_ref() != Some(&bytes) {
            fs::create_dir_all(to.parent().context("a file is in a folder")?)?;
            fs::write(&to, bytes)?;
        }
    }
    Ok(tree)
}
