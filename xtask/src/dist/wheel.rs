//! The wheel: the Python package with the files of the archive, so that `pip install` brings the program.

use std::env::consts::ARCH;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;

use anyhow::{Context, Result, ensure};

use super::loader::Glibc;
use super::profile::{LOADER, NAME, Profile, VERSION};
use crate::command::{command, output, run};
use crate::python::{self, Project};

/// Variables of the environment that `clients/python/hatch_build.py` reads: the folder with the files, and the wheel's tag.
const FILES: &str = "LASHLOOP_WHEEL_FILES";
const TAG: &str = "LASHLOOP_WHEEL_TAG";

pub(super) fn make(profile: Profile, contents: &Path, glibc: Glibc) -> Result<PathBuf> {
    let folder = profile.target();
    let tag = format!("py3-none-manylinux_{}_{}_{ARCH}", glibc.0, glibc.1);
    let pip =
        "pip wheel --quiet --disable-pip-version-check --no-deps --retries 2 --timeout 30 . --wheel-dir";
    run(Project::Package.tool(pip).arg(&folder).env(FILES, contents).env(TAG, &tag))
        .context("no wheel: `cargo xtask setup` makes the environment that builds it")?;
    let wheel = folder.join(format!("{NAME}-{VERSION}-{tag}.whl"));
    ensure!(wheel.is_file(), "pip wrote no {}", wheel.display());
    check(&wheel, &folder)?;
    Ok(wheel)
}

/// Of the files that `clients/python/hatch_build.py` adds.
const INSTALLED: [&str; 5] = [
    "man/man1/lashloop.1",
    "bash-completion/completions/lashloop",
    "zsh/site-functions/_lashloop",
    "fish/vendor_completions.d/lashloop.fish",
    "doc/lashloop/THIRD-PARTY.txt",
];

/// A run from Python, with the program that the wheel brings.
const RUN: &str = "\
import lashloop
print(lashloop.run('scenarios/smooth-after.toml', device='inproc').verdict, lashloop.find_program())";

/// Installs the wheel into an environment of its own, runs the program and the Python package, and removes it again.
fn check(wheel: &Path, folder: &Path) -> Result<()> {
    let environment = folder.join("environment");
    python::make_environment(&environment)?;
    let python = environment.join("bin/python");
    let pip = "-m pip --quiet --disable-pip-version-check --retries 2 --timeout 30";
    run(command(&python, pip).arg("install").arg(wheel)).context("the wheel can't be installed")?;
    let program = environment.join("bin").join(NAME);
    // Neither a variable of this shell nor its PATH helps.
    let demo = output(command(&program, "paper demo --out").arg(folder.join("demo")).env_clear())?;
    ensure!(demo.contains("PASS") && folder.join("demo/demo.svg").is_file(), "no demo:\n{demo}");
    let ran = output(command(&python, "-c").arg(RUN).env_clear())?;
    ensure!(ran.trim_end() == format!("PASS {}", program.display()), "a run from Python prints {ran:?}");
    let fmu = folder.join("plant.fmu");
    run(command(&program, "fmu export scenarios/smooth-after.toml --of plant --out").arg(&fmu))?;
    run(command(environment.join("bin").join(LOADER), "--version").stdout(Stdio::null()))?;
    fs::remove_file(&fmu)?;
    for file in INSTALLED {
        ensure!(environment.join("share").join(file).is_file(), "share/{file} isn't installed");
    }
    run(command(&python, pip).args(["uninstall", "--yes", NAME]))?;
    ensure!(!program.exists(), "{} is left by an uninstall", program.display());
    Ok(())
}
