//! The licences of the crates that are part of a program.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result};
use serde_json::Value;

use crate::command::{cargo, output};

/// Beginnings of the names of files with a licence or a notice.
const FILES: [&str; 5] = ["LICENSE", "LICENCE", "COPYING", "NOTICE", "UNLICENSE"];

const RUST: &str = "The Rust standard library is licensed under MIT or Apache-2.0.\n";
const GLIBC: &str = "\
The GNU C library is linked statically. It is licensed under LGPL-2.1 or later; `cargo xtask dist` in the sources of this
program links it with another version.
";

/// Every crate in the programs of `names` for `target` with its licence, and the texts, each once.
pub(crate) fn collect(names: &[&str], target: &str, features: &str, has_glibc: bool) -> Result<String> {
    let arguments = format!("metadata --format-version 1 --filter-platform {target} {features}");
    let metadata = output(&mut cargo(&arguments))?;
    let metadata: Value = serde_json::from_str(&metadata).context("the metadata of cargo aren't JSON")?;
    let packages: BTreeMap<_, _> =
        list(&metadata["packages"]).filter_map(|it| Some((it["id"].as_str()?, it))).collect();
    let nodes: BTreeMap<_, _> =
        list(&metadata["resolve"]["nodes"]).filter_map(|it| Some((it["id"].as_str()?, it))).collect();
    let root = |name: &&str| packages.iter().find(|(_, it)| it["name"] == **name).map(|(id, _)| *id);
    let mut found = BTreeSet::new();
    let roots = names.iter().map(|name| root(name).with_context(|| format!("no package {name}")));
    let mut open = roots.collect::<Result<Vec<_>>>()?;
    while let Some(id) = open.pop() {
        if found.insert(id) {
            let dependencies = nodes.get(id).into_iter().flat_map(|node| list(&node["deps"]));
            let normal = dependencies.filter(|it| list(&it["dep_kinds"]).any(|kind| kind["kind"].is_null()));
            open.extend(normal.filter_map(|it| it["pkg"].as_str()));
        }
    }
    let mut text = format!("{RUST}{}\n", if has_glibc { GLIBC } else { "" });
    let mut texts: BTreeMap<String, Vec<String>> = BTreeMap::new();
    // Crates of the workspace have no source and our licence.
    for it in found.iter().filter_map(|id| packages.get(id)).filter(|it| !it["source"].is_null()) {
        let word = |key: &str| it[key].as_str().unwrap_or("unknown").to_owned();
        let name = format!("{} {}", word("name"), word("version"));
        writeln!(text, "{name}: {}", word("license"))?;
        let folder = it["manifest_path"].as_str().and_then(|path| Path::new(path).parent());
        for licence in folder.map(licences_in).transpose()?.unwrap_or_default() {
            texts.entry(licence).or_default().push(name.clone());
        }
    }
    for (licence, names) in texts {
        write!(text, "\n{}\n{}\n\n{}\n", "-".repeat(72), names.join(", "), licence.trim_end())?;
    }
    Ok(text)
}

fn list(value: &Value) -> impl Iterator<Item = &Value> {
    value.as_array().into_iter().flatten()
}

fn licences_in(folder: &Path) -> Result<Vec<String>> {
    let mut licences = Vec::new();
    for entry in fs::read_dir(folder).with_context(|| format!("{} can't be read", folder.display()))? {
        let entry = entry?;
        let name = entry.file_name().to_string_lossy().to_uppercase();
        if entry.file_type()?.is_file() && FILES.iter().any(|start| name.starts_with(start)) {
            licences.push(String::from_utf8_lossy(&fs::read(entry.path())?).into_owned());
        }
    }
    Ok(licences)
}
