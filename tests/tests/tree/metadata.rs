//! The workspace as cargo describes it.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, ensure};
use serde_json::Value;

/// Standard output of a program that runs in the workspace.
pub(crate) fn output_of(command: &mut Command) -> Result<String> {
    let output = command.current_dir(tests::workspace()).stderr(Stdio::inherit()).output();
    let output = output.with_context(|| format!("{command:?} can't be started"))?;
    ensure!(output.status.success(), "{command:?} ended with {}", output.status);
    Ok(String::from_utf8(output.stdout)?)
}

/// `cargo metadata` of the workspace members.
pub(crate) fn read() -> Result<Value> {
    let mut cargo = Command::new(env!("CARGO"));
    let text = output_of(cargo.args(["metadata", "--no-deps", "--format-version", "1"]))?;
    serde_json::from_str(&text).context("cargo metadata isn't JSON")
}

/// The root file of a library or a program.
pub(crate) struct Root {
    /// The folder of its package, relative to the workspace as the file is.
    pub(crate) package: PathBuf,
    pub(crate) file: PathBuf,
}

/// All libraries and programs of the workspace.
pub(crate) fn production_roots(metadata: &Value) -> Result<Vec<Root>> {
    let packages = metadata["packages"].as_array().context("cargo metadata has no packages")?;
    let mut roots = Vec::new();
    for package in packages {
        let folder = relative(&package["manifest_path"])?.parent().context("a manifest lies in a folder")?;
        for target in package["targets"].as_array().context("a package has no targets")? {
            let mut kinds = target["kind"].as_array().into_iter().flatten().filter_map(Value::as_str);
            if kinds.any(|kind| kind == "lib" || kind == "bin") {
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
