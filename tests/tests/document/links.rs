//! Links and file names in the documents lead somewhere.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use tests::workspace;

/// First parts of names that are written like paths but are built, typed or looked up elsewhere.
const ELSEWHERE: [&str; 2] = ["target", "out"];

fn documents() -> Vec<PathBuf> {
    let root = workspace();
    let folders = ["docs", "docs/extend", "docs/hardware", "docs/protocol"]
        .map(|folder| fs::read_dir(root.join(folder)).expect("a folder"));
    let mut documents: Vec<_> = folders
        .into_iter()
        .flatten()
        .map(|entry| entry.expect("an entry of the folder").path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "md"))
        .collect();
    documents.extend(["README.md", "CONTRIBUTING.md", "CHANGELOG.md"].map(|name| root.join(name)));
    documents.sort();
    documents
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The text without its fenced blocks: their brackets and slashes are code.
fn prose(text: &str) -> String {
    text.split("\n```").step_by(2).collect::<Vec<_>>().join("\n")
}

/// The targets of all links and pictures that are not addresses.
fn links(text: &str) -> impl Iterator<Item = &str> {
    let targets = text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    targets.filter(|target| !target.contains("://"))
}

/// The pieces in backticks that read as the path of a file or folder.
fn paths(text: &str) -> impl Iterator<Item = &str> {
    let is_part = |c: char| c.is_ascii_alphanumeric() || "._-".contains(c);
    text.lines().flat_map(|line| line.split('`').skip(1).step_by(2)).filter(move |piece| {
        let parts: Vec<_> = piece.trim_end_matches('/').split('/').collect();
        parts.len() > 1
            && parts.iter().all(|part| !part.is_empty() && part.chars().all(is_part))
            && !ELSEWHERE.contains(&parts[0])
    })
}

/// The anchors of a document's headings, as GitHub makes them.
fn anchors(text: &str) -> BTreeSet<String> {
    let headings = text.lines().filter_map(|line| line.strip_prefix('#'));
    let anchor = |heading: &str| -> String {
        let heading = heading.trim_start_matches('#').trim().to_lowercase();
        let kept = heading.chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c));
        kept.map(|c| if c == ' ' { '-' } else { c }).collect()
    };
    headings.map(anchor).collect()
}

#[test]
fn every_relative_link_leads_to_a_file_and_a_heading() {
    let mut broken = Vec::new();
    for document in documents() {
        let text = prose(&read(&document));
        for link in links(&text) {
            let (file, anchor) =
                link.split_once('#').map_or((link, None), |(file, anchor)| (file, Some(anchor)));
            let folder = document.parent().expect("a document is in a folder");
            let target = if file.is_empty() { document.clone() } else { folder.join(file) };
            let leads = match anchor {
                Some(anchor) => target.is_file() && anchors(&read(&target)).contains(anchor),
                None => target.exists(),
            };
            if !leads {
                broken.push(format!("{}: {link}", document.display()));
            }
        }
    }
    assert!(broken.is_empty(), "links that lead nowhere:\n{}", broken.join("\n"));
}

#[test]
fn every_path_in_backticks_is_in_the_tree() {
    let mut missing = Vec::new();
    for document in documents().iter().filter(|document| !document.ends_with("CHANGELOG.md")) {
        let text = prose(&read(document));
        let absent = paths(&text).filter(|path| !workspace().join(path).exists());
        missing.extend(absent.map(|path| format!("{}: {path}", document.display())));
    }
    assert!(missing.is_empty(), "files that are not there:\n{}", missing.join("\n"));
}

#[test]
fn the_index_lists_every_document() {
    let index = read(&workspace().join("docs/README.md"));
    let listed: BTreeSet<_> = links(&index).collect();
    for document in documents() {
        let name =
            document.strip_prefix(workspace()).expect("a document of the workspace").display().to_string();
        let link = name.strip_prefix("docs/").map_or(format!("../{name}"), str::to_owned);
        assert!(link == "README.md" || listed.contains(link.as_str()), "docs/README.md does not list {name}");
    }
}
