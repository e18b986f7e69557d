//! The Python package in `clients/python`: its virtual environment in `target/python`, and its checks.

use std::fs;
use std::io::{self, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail};

use crate::test_counts::Counts;
use crate::{command, paths};

/// The oldest Python the package runs with, as `requires-python` in its `pyproject.toml` has it.
const OLDEST: (u32, u32) = (3, 10);

/// Makes the virtual environment with the package, editable, and its pinned test dependencies, unless it is there.
///
/// # Errors
/// A sentence that says what could not be installed and what to do.
pub(crate) fn set_up(apt_install: impl FnOnce(&[&str]) -> Result<()>) -> Result<()> {
    let wanted =
        fs::read_to_string(package().join("pyproject.toml")).context("the Python package is not here")?;
    if works(&interpreter()) && fs::read_to_string(installed()).is_ok_and(|found| found == wanted) {
        return Ok(());
    }
    if find_python().is_none()
        && let Err(error) = apt_install(&["python3", "python3-venv"])
    {
        eprintln!("setup: {error:#}");
    }
    make_environment()?;
    install().context("the Python package could not be installed into target/python: is there a network?")?;
    fs::write(installed(), wanted).context("target/python can't be written")
}

/// Lints, checks types and formatting.
///
/// # Errors
/// Which tool found something.
pub(crate) fn lint() -> Result<()> {
    command::run(tool("ruff").args(["check", "."]))?;
    command::run(tool("ruff").args(["format", "--check", "."]))?;
    command::run(&mut tool("mypy"))
}

/// Runs pytest and counts.
///
/// # Errors
/// It can't be run.
pub(crate) fn test() -> Result<Counts> {
    // The package drives the Rust twin, built as the Rust tests build it.
    let twin = paths::root().join("target/release/lashloop");
    command::run(
        command::cargo()
            .args(["build", "--quiet", "--release", "--workspace", "--bin", "lashloop", "--target-dir"])
            .arg(paths::root().join("target")),
    )?;
    let mut tests = tool("pytest");
    tests.env("LASHLOOP_BIN", twin).stdin(Stdio::null()).stdout(Stdio::piped());
    let mut child = tests.spawn().with_context(|| command::cannot_start(&tests))?;
    let stdout = child.stdout.take().context("the output of pytest was not kept")?;
    let counts = Counts::of_pytest(BufReader::new(stdout), io::stdout())?;
    let status = child.wait()?;
    // What dies before its last line has no count.
    if !status.success() && counts.failed == 0 {
        println!("pytest ended with {status}");
        return Ok(Counts { failed: 1, ..counts });
    }
    if counts.passed == 0 {
        bail!("pytest ran no test");
    }
    Ok(counts)
}

fn package() -> PathBuf {
    paths::root().join("clients/python")
}

fn environment() -> PathBuf {
    paths::root().join("target/python")
}

fn interpreter() -> PathBuf {
    environment().join("bin/python")
}

/// What was installed: the package's `pyproject.toml` at that time.
fn installed() -> PathBuf {
    environment().join("installed-pyproject.toml")
}

fn tool(name: &str) -> Command {
    let mut command = Command::new(interpreter());
    command.args(["-m", name]).current_dir(package());
    command
}

fn works(python: &Path) -> bool {
    command::first_line(Command::new(python).args(["-c", "print(1)"])).is_some()
}

/// A Python that is new enough and can make a virtual environment with a pip of its own. That of the system is tried too: the one in
/// `PATH` may be another, which Debian's packages don't complete.
fn find_python() -> Option<PathBuf> {
    candidates().find(|python| can(python, "import ensurepip, venv"))
}

fn candidates() -> impl Iterator<Item = PathBuf> {
    let names = ["python3", "/usr/bin/python3"];
    names.into_iter().filter_map(|name| {
        if name.starts_with('/') { Some(name.into()) } else { command::find_program(name) }
    })
}

/// Whether this Python is new enough and can do so much.
fn can(python: &Path, what: &str) -> bool {
    let program = format!("import sys; {what}; print(sys.version_info >= {OLDEST:?})");
    command::first_line(Command::new(python).args(["-c", &program])).is_some_and(|line| line == "True")
}

fn make_environment() -> Result<()> {
    let (python, without_pip) = match find_python() {
        Some(python) => (python, false),
        // One without ensurepip can still make an environment, for a pip from elsewhere to fill.
        None => (candidates().find(|python| can(python, "import venv, pip")).with_context(no_python)?, true),
    };
    let mut make = Command::new(&python);
    make.args(["-m", "venv", "--clear"]);
    if without_pip {
        make.arg("--without-pip");
    }
    command::run(make.arg(environment()))?;
    if without_pip {
        let mut bring = Command::new(python);
        bring.args(["-m", "pip", "--python"]).arg(interpreter()).args(["install", "--quiet", "pip"]);
        command::run(&mut bring).context("pip could not be put into target/python")?;
    }
    Ok(())
}

fn no_python() -> String {
    let (major, minor) = OLDEST;
    format!(
        "there is no Python {major}.{minor} or newer that can make a virtual environment: install one with `venv` and `ensurepip` \
         (python3 and python3-venv on Debian) and call again"
    )
}

fn install() -> Result<()> {
    let mut pip = tool("pip");
    pip.args(["install", "--quiet", "--disable-pip-version-check", "--retries", "2", "--timeout", "30"]);
    command::run(pip.args(["--editable", ".[test]"]))
}
