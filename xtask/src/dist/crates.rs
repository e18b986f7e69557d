//! The crates as a registry has them: packed by cargo, and compiled from what is packed.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use serde_json::Value;

use super::profile::{Profile, VERSION};
use crate::command::{cargo, command, output, run};
use crate::paths;

/// Where the profiles begin in the manifest of the workspace.
const PROFILES: &str = "[profile.dev]\n";

/// Packs every public crate, and checks that they compile outside this tree with nothing but each other and the registry.
///
/// `cargo package` would compile each crate on its own, its dependencies too.
pub(super) fn make(profile: Profile) -> Result<PathBuf> {
    let names = public_crates()?;
    let mut package = cargo("package --quiet --no-verify --allow-dirty");
    for name in &names {
        package.args(["--package", name]);
    }
    run(&mut package)?;
    let folder = profile.target().join("crates");
    paths::empty_folder(&folder)?;
    for name in &names {
        let file = format!("{name}-{VERSION}.crate");
        fs::copy(paths::root().join("target/package").join(&file), folder.join(&file))
            .with_context(|| format!("{file} can't be copied"))?;
    }
    check(&profile.target().join("unpacked"), &folder, &names)?;
    Ok(folder)
}

/// The members of the workspace that may be published.
fn public_crates() -> Result<Vec<String>> {
    let metadata = output(&mut cargo("metadata --format-version 1 --no-deps"))?;
    let metadata: Value = serde_json::from_str(&metadata).context("the metadata of cargo aren't JSON")?;
    let packages = metadata["packages"].as_array().into_iter().flatten();
    let public = packages.filter(|package| package["publish"].is_null());
    let names: Vec<_> = public.filter_map(|package| Some(package["name"].as_str()?.to_owned())).collect();
    ensure!(!names.is_empty(), "cargo lists no public crate");
    Ok(names)
}

/// Unpacks the crates into a workspace of their own and compiles them, with the dependencies of this one.
fn check(workspace: &Path, crates: &Path, names: &[String]) -> Result<()> {
    paths::empty_folder(workspace)?;
    let (mut members, mut patches) = (String::new(), String::new());
    for name in names {
        let folder = format!("{name}-{VERSION}");
        run(command("tar", "-xzf").arg(crates.join(format!("{folder}.crate"))).arg("-C").arg(workspace))?;
        write!(members, "{folder:?},")?;
        writeln!(patches, "{name} = {{ path = {folder:?} }}")?;
    }
    let manifest = fs::read_to_string(paths::root().join("Cargo.toml"))?;
    let profiles = manifest.find(PROFILES).with_context(|| format!("Cargo.toml has no line {PROFILES}"))?;
    let profiles = &manifest[profiles..];
    fs::write(
        workspace.join("Cargo.toml"),
        format!(
            "[workspace]\nresolver = \"3\"\nmembers = [{members}]\n[patch.crates-io]\n{patches}\n{profiles}"
        ),
    )?;
    // The versions of this workspace, so that most are compiled already.
    fs::copy(paths::root().join("Cargo.lock"), workspace.join("Cargo.lock"))?;
    let mut check =
        cargo("check --quiet --workspace --features lashloop-cli/parquet,lashloop-protocol/tokio-codec");
    check.current_dir(workspace).env("CARGO_TARGET_DIR", paths::root().join("target"));
    run(&mut check).context("the packed crates don't compile: does one read a file outside its folder?")
}
