//! Directions: dependencies between crates follow one table, and in a crate neither files nor modules use each other in a
//! cycle. Packages outside the workspace count too.
//!
//! The second test reads the source: method calls on inferred types leave no path to follow, everything else does.

mod crates;
mod made_up_crates;
mod mentions;
mod scopes;
mod source_tree;
mod use_graph;

use anyhow::Result;

use crate::metadata;
pub(crate) use source_tree::SourceTree;
use use_graph::UseGraph;

#[test]
fn no_dependency_runs_against_its_direction() -> Result<()> {
    let wrong_ways = crates::wrong_ways(&metadata::packages()?)?;
    assert!(wrong_ways.is_empty(), "wrong-way dependencies:\n{}", wrong_ways.join("\n"));
    Ok(())
}

#[test]
fn no_cycle_of_files_or_modules() -> Result<()> {
    let mut cycles = Vec::new();
    for root in metadata::production_roots()? {
        let tree = SourceTree::read(&root.file)?;
        for (what, graph) in [("files", UseGraph::of_files(&tree)), ("modules", UseGraph::of_modules(&tree))]
        {
            let describe =
                |cycle: &Vec<_>| format!("cycle of {} {what}:\n{}", cycle.len(), graph.describe(cycle));
            cycles.extend(graph.cycles().iter().map(describe));
        }
    }
    assert!(cycles.is_empty(), "{} cycles\n{}", cycles.len(), cycles.join("\n"));
    Ok(())
}
