//! What may be in the dependency tree: `deny.toml`, judged by cargo-deny.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};

use crate::command::{cargo, command, first_line, run};
use crate::paths;

const VERSION: &str = "0.20.2";

/// Checks licences, sources, and crates in two versions. An exception that nothing needs is an error too.
///
/// # Errors
/// A rule is broken, or cargo-deny can't be had.
pub(crate) fn check() -> Result<()> {
    run(&mut command(cargo_deny()?, "check --deny warnings licenses bans sources"))
}

/// Breaks each rule once, in a package of its own, and has cargo-deny find it by the same `deny.toml`.
///
/// # Errors
/// A planted break isn't found.
pub(crate) fn finds_planted_breaks() -> Result<()> {
    let folder = tempfile::tempdir()?;
    plant(folder.path())?;
    let mut deny = command(cargo_deny()?, "--config");
    deny.arg(paths::root().join("deny.toml")).args(["check", "licenses", "bans", "sources"]);
    let judged = deny.current_dir(folder.path()).output()?;
    let printed = String::from_utf8_lossy(&judged.stderr);
    for (planted, found) in [
        ("a licence", "error[rejected]"),
        ("a crate in two versions", "error[duplicate]: found 2 duplicate entries for crate 'twice'"),
        ("a git source", "error[source-not-allowed]"),
    ] {
        ensure!(printed.contains(found), "cargo-deny doesn't refuse {planted}:\n{printed}");
    }
    Ok(())
}

/// A package that depends on a GPL crate, on two versions of one, and on a git repository.
fn plant(folder: &Path) -> Result<()> {
    for (at, name, version, licence) in [
        ("copyleft", "copyleft", "0.1.0", "GPL-3.0-only"),
        ("old", "twice", "0.1.0", "MIT"),
        ("new", "twice", "1.0.0", "MIT"),
        ("elsewhere", "elsewhere", "0.1.0", "MIT"),
    ] {
        package(&folder.join(at), name, version, licence, "[workspace]\n")?;
    }
    let elsewhere = folder.join("elsewhere");
    for arguments in ["init --quiet", "add .", "-c user.name=x -c user.email=x@x.invalid commit --quiet -m x"]
    {
        run(command("git", arguments).current_dir(&elsewhere))?;
    }
    let dependencies = format!(
        "[dependencies]\ncopyleft = {{ path = \"copyleft\" }}\ntwice = {{ path = \"old\" }}\nagain = {{ package = \"twice\", \
         path = \"new\" }}\nelsewhere = {{ git = \"file://{}\" }}\n[workspace]\nexclude = [\"copyleft\", \"old\", \"new\", \
         \"elsewhere\"]\n",
        elsewhere.display()
    );
    package(folder, "planted", "0.1.0", "MIT", &dependencies)
}

fn package(folder: &Path, name: &str, version: &str, licence: &str, rest: &str) -> Result<()> {
    fs::create_dir_all(folder.join("src"))?;
    fs::write(folder.join("src/lib.rs"), "")?;
    let package = format!(
        "[package]\nname = \"{name}\"\nversion = \"{version}\"\nlicense = \"{licence}\"\npublish = false\n"
    );
    Ok(fs::write(folder.join("Cargo.toml"), package + rest)?)
}

/// The program, compiled first if this machine lacks it.
fn cargo_deny() -> Result<PathBuf> {
    let tools = paths::root().join("target/tools");
    let program = tools.join("bin/cargo-deny");
    if first_line(&mut command(&program, "--version")).is_none_or(|line| !line.ends_with(VERSION)) {
        println!("check: compiles cargo-deny {VERSION} into {}", tools.display());
        // Compiling takes longer than a check, so nothing is optimised.
        let install = format!("install cargo-deny --version ={VERSION} --locked --debug --quiet --root");
        run(cargo(&install).arg(&tools)).context("cargo-deny can't be compiled: is there a network?")?;
    }
    Ok(program)
}
