//! Directions: dependencies between crates follow one table, and no files of a crate use each other in a cycle.
//!
//! The second test reads the source: method calls on inferred types leave no path to follow, everything else does.

mod crates;
mod file_graph;
mod made_up_crates;
mod mentions;
mod scopes;
mod source_tree;

use anyhow::Result;

use crate::metadata;
use file_graph::FileGraph;
pub(crate) use source_tree::SourceTree;

#[test]
fn no_dependency_runs_against_its_direction() -> Result<()> {
    let wrong_ways = crates::wrong_ways(&metadata::read()?)?;
    assert!(wrong_ways.is_empty(), "wrong-way dependencies:\n{}", wrong_ways.join("\n"));
    Ok(())
}

#[test]
fn no_cycle_of_files() -> Result<()> {
    let mut cycles = Vec::new();
    for root in metadata::production_roots(&metadata::read()?)? {
        let graph = FileGraph::of(&SourceTree::read(&root.file)?);
        let describe = |cycle: &Vec<_>| format!("cycle of {} files:\n{}", cycle.len(), graph.describe(cycle));
        cycles.extend(graph.cycles().iter().map(describe));
    }
    assert!(cycles.is_empty(), "{} cycles\n{}", cycles.len(), cycles.join("\n"));
    Ok(())
}
