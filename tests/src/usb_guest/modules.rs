//! The kernel's modules, in the order of their dependencies.
//!
//! A module names those that it needs in its section `.modinfo`, so no index of `depmod` is needed.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use object::{Object, ObjectSection};

/// What the guest needs: its channel and its folders, and the drivers of USB.
const WANTED: [&str; 8] =
    ["virtio_pci", "virtio_console", "9pnet_virtio", "9p", "xhci_pci", "vhci_hcd", "ftdi_sio", "cdc_acm"];

/// The files of the wanted modules below a folder, each after those that it needs.
///
/// # Errors
/// A module is missing, and the kernel doesn't have it built in.
pub fn in_order(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut files = BTreeMap::new();
    collect(folder, &mut files)?;
    let built_in = built_in(folder);
    let mut order = Vec::new();
    for name in WANTED {
        add(name, &files, &built_in, &mut order)?;
    }
    Ok(order)
}

fn add(
    name: &str,
    files: &BTreeMap<String, PathBuf>,
    built_in: &[String],
    order: &mut Vec<PathBuf>,
) -> Result<()> {
    let Some(file) = files.get(name) else {
        let is_built_in = built_in.iter().any(|known| known == name);
        ensure!(is_built_in, "the kernel's package has no module {name}");
        return Ok(());
    };
    if order.contains(file) {
        return Ok(());
    }
    let text = fs::read(file).with_context(|| format!("{} can't be read", file.display()))?;
    for needed in needed(&text).with_context(|| format!("{} isn't a module", file.display()))? {
        add(&needed, files, built_in, order)?;
    }
    order.push(file.clone());
    Ok(())
}

/// The names in the entry `depends=` of a module.
fn needed(module: &[u8]) -> Result<Vec<String>> {
    let file = object::File::parse(module)?;
    let section = file.section_by_name(".modinfo").context("no section .modinfo")?;
    let entries = section.data()?.split(|byte| *byte == 0);
    let depends = entries.filter_map(|entry| entry.strip_prefix(b"depends=")).next().unwrap_or_default();
    let names = String::from_utf8_lossy(depends);
    Ok(names.split(',').filter(|name| !name.is_empty()).map(normalised).collect())
}

/// The kernel takes a hyphen and an underscore of a module's name for the same.
fn normalised(name: &str) -> String {
    name.replace('-', "_")
}

fn collect(folder: &Path, files: &mut BTreeMap<String, PathBuf>) -> Result<()> {
    let entries = fs::read_dir(folder).with_context(|| format!("{} can't be listed", folder.display()))?;
    for entry in entries {
        let path = entry?.path();
        if path.is_dir() {
            collect(&path, files)?;
        } else if let Some(name) = path.file_name().and_then(|name| name.to_str()?.strip_suffix(".ko")) {
            files.insert(normalised(name), path.clone());
        }
    }
    Ok(())
}

/// The modules that are part of the kernel itself, from the list of its package.
fn built_in(folder: &Path) -> Vec<String> {
    let text = fs::read_to_string(folder.join("modules.builtin")).unwrap_or_default();
    let names = text.lines().filter_map(|line| line.rsplit('/').next()?.strip_suffix(".ko"));
    names.map(normalised).collect()
}
