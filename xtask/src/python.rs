//! The Python package in `clients/python` and the tests in `tests/browser`: their virtual environment in `target/python`, and
//! their checks.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};

use crate::command::{cargo, command, first_line, run};
use crate::counts::Counts;
use crate::paths;

/// The oldest Python the package runs with, as `requires-python` in its `pyproject.toml` has it.
const OLDEST: (u32, u32) = (3, 10);

/// Creates the virtual environment with the package, editable, and its pinned test dependencies, those in JavaScript too.
///
/// # Errors
/// What could not be installed, and what to do.
pub(crate) fn set_up() -> Result<()> {
    make_environment(&environment())?;
    run(&mut Project::Package.tool(
        "pip install --quiet --disable-pip-version-check --no-compile --retries 2 --timeout 30 --editable .[test,browser]",
    ))
    .context("the Python package could not be installed into target/python: is there a network?")?;
    for file in READERS {
        fs::copy(readers().join(file), environment().join(file)).context("target/python can't be written")?;
    }
    let npm = "ci --ignore-scripts --no-audit --no-fund --loglevel=error";
    run(command(environment().join("bin/npm"), npm).current_dir(environment()))
        .context("the readers of MCAP in JavaScript could not be installed into target/python")?;
    fs::write(installed(), manifest()?).context("target/python can't be written")
}

/// Whether the virtual environment works and has what `pyproject.toml` names.
pub(crate) fn is_set_up() -> bool {
    first_line(&mut command(interpreter(), "--version")).is_some()
        && fs::read_to_string(installed()).is_ok_and(|found| manifest().is_ok_and(|wanted| found == wanted))
}

/// A Python that is new enough and can create a virtual environment with pip.
pub(crate) fn find() -> Option<&'static str> {
    find_with("ensurepip, venv")
}

/// A folder with Python, its settings, and its tests.
#[derive(Clone, Copy)]
pub(crate) enum Project {
    Package,
    /// Pages in headless Chromium.
    BrowserTests,
}

impl Project {
    fn folder(self) -> PathBuf {
        paths::root().join(match self {
            Self::Package => "clients/python",
            Self::BrowserTests => "tests/browser",
        })
    }

    /// Checks lints, format and types.
    pub(crate) fn lint(self) -> Result<()> {
        let checks = ["ruff check .", "ruff format --check .", "mypy"];
        checks.into_iter().try_for_each(|check| run(&mut self.tool(check)))
    }

    /// Runs pytest.
    ///
    /// # Errors
    /// pytest can't be run, or ran no test.
    pub(crate) fn test(self) -> Result<Counts> {
        // The tests run the program and the native twin, built as the Rust tests build it.
        let target = paths::root().join("target");
        run(cargo("programs --quiet --target-dir").arg(&target))?;
        // A copy: builds of the chores that run at the same time replace the program.
        let folder = environment().join("program");
        fs::create_dir_all(&folder)?;
        for file in PROGRAMS {
            fs::copy(target.join("debug").join(file), folder.join(file))
                .with_context(|| format!("{file} can't be copied"))?;
        }
        let mut tests = self.tool("pytest");
        tests.env("LASHLOOP_BIN", folder.join(PROGRAMS[0]));
        let counts = Counts::of_output(tests, Counts::of_pytest, |line| println!("{line}"))?;
        ensure!(counts != Counts::default(), "pytest ran no test");
        Ok(counts)
    }

    /// A module of the virtual environment, run as a program in this folder, with its arguments.
    pub(crate) fn tool(self, module: &str) -> Command {
        let mut command = tool(module);
        command.current_dir(self.folder());
        command
    }
}

/// A module of the virtual environment, run as a program in the workspace, with its arguments.
pub(crate) fn tool(module: &str) -> Command {
    command(interpreter(), &format!("-m {module}"))
}

/// What is installed: the text of `pyproject.toml` and that of the lock file of the readers.
fn manifest() -> Result<String> {
    let files = [Project::Package.folder().join("pyproject.toml"), readers().join(READERS[1])];
    let texts = files
        .iter()
        .map(|path| fs::read_to_string(path).with_context(|| format!("{} can't be read", path.display())));
    texts.collect()
}

/// The program, what it starts, and what it puts into FMUs.
const PROGRAMS: [&str; 3] = ["lashloop", "lashloop-fmu", "liblashloop_fmu.so"];

/// The packages of the readers of MCAP in JavaScript.
const READERS: [&str; 2] = ["package.json", "package-lock.json"];

fn readers() -> PathBuf {
    Project::Package.folder().join("tests/readers")
}

fn environment() -> PathBuf {
    paths::root().join("target/python")
}

/// A copy of the manifest that was installed.
fn installed() -> PathBuf {
    environment().join("installed-manifest.txt")
}

fn interpreter() -> PathBuf {
    environment().join("bin/python")
}

/// A Python that is new enough and has the modules. We try the system's too: Debian's packages don't complete another Python
/// that comes first in `PATH`.
fn find_with(modules: &str) -> Option<&'static str> {
    let program = format!("import sys, {modules}; print(sys.version_info >= {OLDEST:?})");
    ["python3", "/usr/bin/python3"]
        .into_iter()
        .find(|python| first_line(command(python, "-c").arg(&program)).is_some_and(|line| line == "True"))
}

/// Makes an empty virtual environment with pip, instead of what is in the folder.
///
/// # Errors
/// No Python here can.
pub(crate) fn make_environment(folder: &Path) -> Result<()> {
    if let Some(python) = find() {
        return run(command(python, "-m venv --clear").arg(folder));
    }
    // A Python without ensurepip can still create an environment, which its own pip fills.
    let (major, minor) = OLDEST;
    let python = find_with("venv, pip").with_context(|| {
        format!(
            "no Python {major}.{minor} or newer can create a virtual environment here: install one with `venv` and \
             `ensurepip` (python3 and python3-venv on Debian) and call again"
        )
    })?;
    run(command(python, "-m venv --clear --without-pip").arg(folder))?;
    run(command(python, "-m pip --python").arg(folder.join("bin/python")).args(["install", "--quiet", "pip"]))
        .with_context(|| format!("pip could not be installed into {}", folder.display()))
}
