//! `cargo xtask site`: the documentation as a site with a search, in `target/site`.
//!
//! Its pages and the files that they link to have the places of the repository, so links need no change.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use regex_lite::Regex;

use crate::command::{cargo, command, output, run};
use crate::{paths, python};

/// Where MkDocs reads pages and files, as `mkdocs.yml` says.
const SOURCE: &str = "target/site-source";
const SITE: &str = "target/site";
/// The first page of rustdoc.
const API: &str = "lashloop/index.html";

/// Writes the site. A link without a target, an anchor that isn't there and a page that no menu names are errors.
pub(crate) fn make() -> Result<()> {
    stage()?;
    run(&mut python::tool("mkdocs build --strict"))?;
    println!("{}", paths::root().join(SITE).join("index.html").display());
    Ok(())
}

/// Adds the pages of rustdoc, as `api` of the site.
pub(crate) fn add_api() -> Result<()> {
    run(cargo("doc --workspace --no-deps").env("RUSTDOCFLAGS", "-D warnings"))?;
    let api = paths::root().join(SITE).join("api");
    run(command("cp", "-r").arg(paths::root().join("target/doc")).arg(&api))?;
    ensure!(api.join(API).is_file(), "rustdoc wrote no {API}");
    fs::write(api.join("index.html"), format!("<meta http-equiv=\"refresh\" content=\"0; url={API}\">\n"))?;
    Ok(())
}

/// Copies every tracked page, and what pages link to. A folder without a page of its own becomes a list of its files.
fn stage() -> Result<()> {
    let source = paths::root().join(SOURCE);
    paths::empty_folder(&source)?;
    let listed = output(&mut command("git", "ls-files"))?;
    let tracked: BTreeSet<&Path> = listed.lines().map(Path::new).collect();
    let link = Regex::new(r"\]\(([^)#:\s]+)(?:#[^)]*)?\)").expect("a constant");
    for page in tracked.iter().filter(|path| path.extension().is_some_and(|it| it == "md")) {
        copy(page, &source)?;
        let text = fs::read_to_string(paths::root().join(page))?;
        let folder = page.parent().unwrap_or(Path::new(""));
        for linked in link.captures_iter(&text).filter_map(|found| found.get(1)) {
            let target = resolved(&folder.join(linked.as_str()));
            if tracked.contains(&*target) {
                copy(&target, &source)?;
            } else if !target.as_os_str().is_empty() && !tracked.contains(&*target.join("README.md")) {
                list_files(&target, &tracked, &source)?;
            }
        }
    }
    Ok(())
}

/// A path without `..`.
fn resolved(path: &Path) -> PathBuf {
    path.components().fold(PathBuf::new(), |mut folder, part| {
        if part.as_os_str() == ".." {
            folder.pop();
        } else {
            folder.push(part);
        }
        folder
    })
}

fn copy(file: &Path, source: &Path) -> Result<()> {
    let to = source.join(file);
    fs::create_dir_all(to.parent().unwrap_or(source))?;
    fs::copy(paths::root().join(file), &to).with_context(|| format!("{} can't be copied", file.display()))?;
    Ok(())
}

/// Writes `index.html` with links to the files of a folder, and copies them.
fn list_files(folder: &Path, tracked: &BTreeSet<&Path>, source: &Path) -> Result<()> {
    let mut list = format!(
        "<!doctype html><meta charset=\"utf-8\"><title>{0}</title><h1>{0}</h1><ul>",
        folder.display()
    );
    let files: Vec<_> =
        tracked.iter().filter_map(|file| Some((file, file.strip_prefix(folder).ok()?))).collect();
    for (file, name) in &files {
        copy(file, source)?;
        write!(list, "<li><a href=\"{0}\">{0}</a>", name.display())?;
    }
    // A link to nothing is left to MkDocs, which names the page that has it.
    if !files.is_empty() {
        fs::write(source.join(folder).join("index.html"), list + "</ul>\n")?;
    }
    Ok(())
}
