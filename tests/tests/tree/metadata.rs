//! The packages of the repository as cargo describes them.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, ensure};
use serde_json::Value;

/// Kinds of targets with production code.
const KINDS: [&str; 5] = ["lib", "bin", "cdylib", "proc-macro", "custom-build"];

/// Standard output of a program that runs in the workspace.
pub(crate) fn output_of(command: &mut Command) -> Result<String> {
    let output = command.current_dir(tests::workspace()).stderr(Stdio::inherit()).output();
    let output = output.with_context(|| format!("{command:?} can't be started"))?;
    ensure!(output.status.success(), "{command:?} ended with {}", output.status);
    Ok(String::from_utf8(output.stdout)?)
}

/// Every package of the repository, members of the workspace or not, as `cargo metadata` describes it.
pub(crate) fn packages() -> Result<Vec<Value>> {
    let mut packages = packages_of(Path::new("Cargo.toml"))?;
    let manifests = output_of(Command::new("git").args(["ls-files", "--", "*/Cargo.toml"]))?;
    for manifest in manifests.lines().map(Path::new) {
        let is_known = |package: &Value| relative(&package["manifest_path"]).is_ok_and(|it| it == manifest);
        if !packages.iter().any(is_known) && tests::workspace().join(manifest).exists() {
            packages.extend(packages_of(manifest)?);
        }
    }
    Ok(packages)
}

/// The packages of the workspace with this manifest.
fn packages_of(manifest: &Path) -> Result<Vec<Value>> {
    let mut cargo = Command::new(env!("CARGO"));
    let arguments = ["metadata", "--no-deps", "--format-version", "1", "--manifest-path"];
    let text = output_of(cargo.args(arguments).arg(manifest))?;
    let mut metadata: Value = serde_json::from_str(&text).context("cargo metadata isn't JSON")?;
    serde_json::from_value(metadata["packages"].take()).context("cargo metadata has no packages")
}

/// The root file of a library, a program or a build script.
pub(crate) struct Root {
    /// The folder of its package, relative to the workspace as the file is.
    pub(crate) package: PathBuf,
    pub(crate) file: PathBuf,
}

/// All libraries, programs and build scripts of the repository.
pub(crate) fn production_roots() -> Result<Vec<Root>> {
    let mut roots = Vec::new();
    for package in packages()? {
        let folder = relative(&package["manifest_path"])?.parent().context("a manifest lies in a folder")?;
        for target in package["targets"].as_array().context("a package has no targets")? {
            let mut kinds = target["kind"].as_array().into_iter().flatten().filter_map(Value::as_str);
            if kinds.any(|kind| KINDS.contains(&kind)) {
                roots.push(Root {
                    package: folder.to_owned(),
                    file: relative(&target["src_path"])?.to_owned(),
                });
            }
        }
    }
    Ok(roots)
}

fn relative(path: &Value) -> Result<&Path> {
    let path = Path::new(path.as_str().context("cargo metadata has no path")?);
    Ok(path.strip_prefix(tests::workspace()).unwrap_or(path))
}
