//! Directions: dependencies between crates follow one table, and no files of a crate use each other in a cycle.
//!
//! The second check reads the source: method calls on inferred types leave no path to follow, everything else does.

mod crates;
mod file_graph;
mod mentions;
mod scopes;
mod source_tree;
#[cfg(test)]
mod tests;

use std::fs;
use std::path::Path;

use anyhow::{Result, ensure};

use crate::{metadata, paths};
use file_graph::FileGraph;
use source_tree::SourceTree;

/// Prints every wrong-way dependency and every cycle.
///
/// # Errors
/// There is one, or the source can't be read.
pub(crate) fn check() -> Result<()> {
    let metadata = metadata::read()?;
    let wrong_ways = crates::wrong_ways(&metadata)?;
    for sentence in &wrong_ways {
        println!("{sentence}");
    }
    let mut cycle_count = 0;
    for root in metadata::production_roots(&metadata)? {
        let graph = FileGraph::of(&SourceTree::load(&root, &read)?);
        for cycle in graph.cycles() {
            println!("cycle of {} files:\n{}", cycle.len(), graph.describe(&cycle));
            cycle_count += 1;
        }
    }
    ensure!(
        wrong_ways.is_empty() && cycle_count == 0,
        "{} wrong-way dependencies, {cycle_count} cycles",
        wrong_ways.len()
    );
    Ok(())
}

/// The text of a file of the workspace.
fn read(path: &Path) -> Option<String> {
    fs::read_to_string(paths::root().join(path)).ok()
}
