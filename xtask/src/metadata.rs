//! The workspace as cargo describes it.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use serde_json::Value;

use crate::{command, paths};

/// `cargo metadata` of the workspace members.
pub(crate) fn read() -> Result<Value> {
    let text = command::output(command::cargo().args(["metadata", "--no-deps", "--format-version", "1"]))?;
    serde_json::from_str(&text).context("cargo metadata isn't JSON")
}

/// The root files of all libraries and programs, relative to the workspace.
pub(crate) fn production_roots(metadata: &Value) -> Result<Vec<PathBuf>> {
    let packages = metadata["packages"].as_array().context("cargo metadata has no packages")?;
    let targets = packages.iter().filter_map(|package| package["targets"].as_array()).flatten();
    let roots = targets.filter(|target| {
        let kinds = target["kind"].as_array().into_iter().flatten();
        kinds.filter_map(Value::as_str).any(|kind| kind == "lib" || kind == "bin")
    });
    roots
        .map(|target| {
            let path = Path::new(target["src_path"].as_str().context("a target has no source")?);
            Ok(path.strip_prefix(paths::root()).unwrap_or(path).to_owned())
        })
        .collect()
}
