//! Name resolution: from a path in a module to the module that defines the item.

use std::collections::{BTreeMap, BTreeSet};

use syn::Item;

use super::mentions::{ImportKind, Mentions, Path};
use super::source_tree::{ModuleId, ROOT, SourceTree};

/// What a path names.
#[derive(Clone)]
enum Target {
    Module(ModuleId),
    Item(Definition),
}

/// An item and the module that defines it.
#[derive(Clone)]
pub(crate) struct Definition {
    pub(crate) module: ModuleId,
    pub(crate) name: String,
}

#[derive(Default)]
struct Scope {
    items: BTreeSet<String>,
    macros: BTreeSet<String>,
    aliases: BTreeMap<String, Vec<Path>>,
    globs: Vec<Path>,
}

pub(crate) struct Scopes<'a> {
    tree: &'a SourceTree,
    scopes: Vec<Scope>,
}

/// Names being resolved, against circular imports.
type Pending = BTreeSet<(ModuleId, String)>;

impl<'a> Scopes<'a> {
    pub(crate) fn of(tree: &'a SourceTree, mentions: &[Mentions]) -> Self {
        let scopes = tree.modules.iter().zip(mentions).map(|(module, mentions)| {
            let mut scope = Scope::default();
            for item in &module.items {
                if let Item::Macro(item) = item {
                    scope.macros.extend(item.ident.as_ref().map(ToString::to_string));
                } else {
                    scope.items.extend(defined_name(item));
                }
            }
            for import in &mentions.imports {
                match &import.kind {
                    ImportKind::Name(name) => {
                        scope.aliases.entry(name.clone()).or_default().push(import.path.clone());
                    }
                    ImportKind::Glob => scope.globs.push(import.path.clone()),
                }
            }
            scope
        });
        Self { tree, scopes: scopes.collect() }
    }

    /// `None` for modules and for names of other crates.
    pub(crate) fn item(&self, module: ModuleId, path: &[String]) -> Option<Definition> {
        match self.resolve(module, path, false, &mut Pending::new())? {
            Target::Item(definition) => Some(definition),
            Target::Module(_) => None,
        }
    }

    /// A `macro_rules!`, whose name is in scope in all descendants of its module.
    pub(crate) fn macro_rules(&self, module: ModuleId, path: &[String]) -> Option<Definition> {
        let [name] = path else { return self.item(module, path) };
        let mut ancestors = std::iter::successors(Some(module), |module| self.tree.modules[*module].parent);
        let definer = ancestors.find(|module| self.scopes[*module].macros.contains(name));
        definer.map(|module| Definition { module, name: name.clone() }).or_else(|| self.item(module, path))
    }

    fn resolve(
        &self,
        module: ModuleId,
        path: &[String],
        wants_module: bool,
        pending: &mut Pending,
    ) -> Option<Target> {
        let (first, rest) = path.split_first()?;
        let start = match first.as_str() {
            "crate" => Target::Module(ROOT),
            "self" => Target::Module(module),
            "super" => Target::Module(self.tree.modules[module].parent?),
            name => self.look_up(module, name, wants_module || !rest.is_empty(), pending)?,
        };
        match start {
            Target::Item(_) => Some(start),
            Target::Module(_) if rest.is_empty() => Some(start),
            Target::Module(module) => self.resolve(module, rest, wants_module, pending),
        }
    }

    /// Resolves a name in one module. A module and an item can have one name: `wants_module` prefers the module.
    fn look_up(
        &self,
        module: ModuleId,
        name: &str,
        wants_module: bool,
        pending: &mut Pending,
    ) -> Option<Target> {
        let key = (module, name.to_owned());
        if !pending.insert(key.clone()) {
            return None;
        }
        let scope = &self.scopes[module];
        let child = self.tree.modules[module].children.get(name).copied().map(Target::Module);
        let is_defined = scope.items.contains(name) || scope.macros.contains(name);
        let item = is_defined.then(|| Target::Item(Definition { module, name: name.to_owned() }));
        let mut found: Vec<_> = child.into_iter().chain(item).collect();
        for path in scope.aliases.get(name).into_iter().flatten() {
            found.extend(self.resolve(module, path, wants_module, pending));
        }
        // A glob import yields to every other name.
        if found.is_empty() {
            for path in &scope.globs {
                if let Some(Target::Module(source)) = self.resolve(module, path, true, pending) {
                    found.extend(self.look_up(source, name, wants_module, pending));
                }
            }
        }
        pending.remove(&key);
        let preferred = found.iter().find(|target| matches!(target, Target::Module(_)) == wants_module);
        preferred.or(found.first()).cloned()
    }
}

fn defined_name(item: &Item) -> Option<String> {
    let name = match item {
        Item::Const(item) => &item.ident,
        Item::Enum(item) => &item.ident,
        Item::Fn(item) => &item.sig.ident,
        Item::Static(item) => &item.ident,
        Item::Struct(item) => &item.ident,
        Item::Trait(item) => &item.ident,
        Item::TraitAlias(item) => &item.ident,
        Item::Type(item) => &item.ident,
        Item::Union(item) => &item.ident,
        _ => return None,
    };
    Some(name.to_string())
}
