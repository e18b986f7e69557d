//! Which file uses which, which module uses which, and the cycles among them.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::path::PathBuf;

use super::mentions::Mentions;
use super::scopes::Scopes;
use super::source_tree::{ModuleId, SourceTree};

/// Edges by the user's path, then by the path of what it uses, with the items that make each edge.
#[derive(Default)]
pub(crate) struct UseGraph(BTreeMap<PathBuf, BTreeMap<PathBuf, BTreeSet<String>>>);

impl UseGraph {
    /// Edges between files.
    pub(crate) fn of_files(tree: &SourceTree) -> Self {
        let file = |id: ModuleId| tree.modules[id].file.clone();
        Self::new(tree, |user, used| Some((file(user), file(used))))
    }

    /// Edges between the modules of one parent, each with all modules below it.
    pub(crate) fn of_modules(tree: &SourceTree) -> Self {
        let folder = |id| tree.folder(id);
        Self::new(tree, |user, used| {
            tree.siblings(user, used).map(|(user, used)| (folder(user), folder(used)))
        })
    }

    /// `edge` gives the ends of an edge between two modules. A re-export or a `mod` declaration alone makes none: the edge
    /// is where the name is used.
    fn new(tree: &SourceTree, edge: impl Fn(ModuleId, ModuleId) -> Option<(PathBuf, PathBuf)>) -> Self {
        let mentions: Vec<_> = tree.modules.iter().map(|module| Mentions::of(&module.items)).collect();
        let scopes = Scopes::of(tree, &mentions);
        let mut graph = Self::default();
        for (id, mentions) in mentions.iter().enumerate() {
            let imports = mentions.imports.iter().filter(|import| !import.is_reexport);
            let paths = imports.map(|import| &import.path).chain(&mentions.paths);
            let items = paths.filter_map(|path| scopes.item(id, path));
            let macros = mentions.macros.iter().filter_map(|path| scopes.macro_rules(id, path));
            for used in items.chain(macros) {
                if let Some((user, used_by_it)) = edge(id, used.module) {
                    graph.add(user, used_by_it, used.name);
                }
            }
        }
        graph
    }

    fn add(&mut self, user: PathBuf, used: PathBuf, name: String) {
        if user != used {
            self.0.entry(user).or_default().entry(used).or_default().insert(name);
        }
    }

    /// For every edge of a cycle the shortest cycle through it, each once, the shortest first.
    pub(crate) fn cycles(&self) -> Vec<Vec<PathBuf>> {
        let edges = self.0.iter().flat_map(|(user, edges)| edges.keys().map(move |used| (user, used)));
        let cycles: BTreeSet<_> = edges
            .filter_map(|(user, used)| self.shortest_path(used, user))
            .map(|mut cycle| {
                let first = (0..cycle.len()).min_by_key(|index| &cycle[*index]).unwrap_or(0);
                cycle.rotate_left(first);
                (cycle.len(), cycle)
            })
            .collect();
        cycles.into_iter().map(|(_, cycle)| cycle).collect()
    }

    /// All paths from `from` to `to`, both included.
    fn shortest_path(&self, from: &PathBuf, to: &PathBuf) -> Option<Vec<PathBuf>> {
        let mut previous = BTreeMap::from([(from, None)]);
        let mut queue = VecDeque::from([from]);
        while let Some(node) = queue.pop_front() {
            if node == to {
                let mut path: Vec<_> =
                    std::iter::successors(Some(to), |node| previous[*node]).cloned().collect();
                path.reverse();
                return Some(path);
            }
            for next in self.0.get(node).into_iter().flat_map(BTreeMap::keys) {
                previous.entry(next).or_insert_with(|| {
                    queue.push_back(next);
                    Some(node)
                });
            }
        }
        None
    }

    /// One line for each edge of a cycle.
    pub(crate) fn describe(&self, cycle: &[PathBuf]) -> String {
        let next = cycle.iter().cycle().skip(1);
        let edges = cycle.iter().zip(next).map(|(user, used)| {
            let names: Vec<_> = self.0[user][used].iter().map(String::as_str).collect();
            format!("  {} -> {}: {}\n", user.display(), used.display(), names.join(", "))
        });
        edges.collect()
    }
}
