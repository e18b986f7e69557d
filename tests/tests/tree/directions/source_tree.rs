//! The modules of one crate, read from its root file.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use syn::{Attribute, Expr, ExprLit, Item, Lit, Meta, MetaNameValue};

use crate::production;

/// Index of a module in its tree.
pub(crate) type ModuleId = usize;

pub(crate) const ROOT: ModuleId = 0;

/// Production code alone: test-only modules and items are omitted.
#[derive(Default)]
pub(crate) struct SourceTree {
    pub(crate) modules: Vec<Module>,
}

pub(crate) struct Module {
    /// The file of the module's items. An inline module has its parent's.
    pub(crate) file: PathBuf,
    pub(crate) parent: Option<ModuleId>,
    pub(crate) children: BTreeMap<String, ModuleId>,
    pub(crate) items: Vec<Item>,
}

impl SourceTree {
    /// Reads the tree below a root file of the workspace, given by its path in it.
    ///
    /// # Errors
    /// A file is missing or isn't Rust.
    pub(crate) fn read(root: &Path) -> Result<Self> {
        Self::load(root, &|path| fs::read_to_string(tests::workspace().join(path)).ok())
    }

    pub(crate) fn files(&self) -> impl Iterator<Item = PathBuf> {
        self.modules.iter().map(|module| module.file.clone())
    }

    /// The path of a module without its extension: where the files of the modules below it are.
    pub(crate) fn folder(&self, id: ModuleId) -> PathBuf {
        let file = &self.modules[id].file;
        match file.parent() {
            Some(folder) if file.ends_with("mod.rs") => folder.to_owned(),
            _ => file.with_extension(""),
        }
    }

    /// The two modules of one parent that lead to these two; `None` if one of them is above the other.
    pub(crate) fn siblings(&self, one: ModuleId, other: ModuleId) -> Option<(ModuleId, ModuleId)> {
        let (one, other) = (self.path_from_root(one), self.path_from_root(other));
        one.into_iter().zip(other).find(|(one, other)| one != other)
    }

    fn path_from_root(&self, id: ModuleId) -> Vec<ModuleId> {
        let mut path: Vec<_> = std::iter::successors(Some(id), |id| self.modules[*id].parent).collect();
        path.reverse();
        path
    }

    /// Reads the tree below `root`. `read` returns a file's text, or `None` if the file doesn't exist.
    ///
    /// # Errors
    /// A file is missing or isn't Rust.
    pub(crate) fn load(root: &Path, read: &dyn Fn(&Path) -> Option<String>) -> Result<Self> {
        let mut tree = Self::default();
        let text = read(root).with_context(|| format!("{}: no such file", root.display()))?;
        let folder = root.parent().unwrap_or(Path::new("")).to_owned();
        let file = parse(root, &text)?;
        tree.add(None, root.to_owned(), &folder, file, read)?;
        Ok(tree)
    }

    fn add(
        &mut self,
        parent: Option<ModuleId>,
        file: PathBuf,
        folder: &Path,
        items: Vec<Item>,
        read: &dyn Fn(&Path) -> Option<String>,
    ) -> Result<ModuleId> {
        let id = self.modules.len();
        let (modules, items): (Vec<_>, Vec<_>) = items
            .into_iter()
            .filter(|item| !production::is_test_only(production::attributes(item)))
            .partition(|item| matches!(item, Item::Mod(_)));
        self.modules.push(Module { file: file.clone(), parent, children: BTreeMap::new(), items });
        for item in modules {
            let Item::Mod(module) = item else { continue };
            let name = module.ident.to_string();
            let folder = folder.join(&name);
            let child = match module.content {
                Some((_, items)) => self.add(Some(id), file.clone(), &folder, items, read)?,
                None => {
                    let places = match path_attribute(&module.attrs) {
                        Some(path) => vec![file.with_file_name(path)],
                        None => vec![folder.with_extension("rs"), folder.join("mod.rs")],
                    };
                    let found = places.into_iter().find_map(|place| read(&place).map(|text| (place, text)));
                    let (place, text) =
                        found.with_context(|| format!("{}: no file of module {name}", file.display()))?;
                    let items = parse(&place, &text)?;
                    self.add(Some(id), place, &folder, items, read)?
                }
            };
            self.modules[id].children.insert(name, child);
        }
        Ok(id)
    }
}

/// The file that `#[path = "..."]` names, relative to the file of the declaration.
fn path_attribute(attributes: &[Attribute]) -> Option<String> {
    attributes.iter().find_map(|attribute| match &attribute.meta {
        Meta::NameValue(MetaNameValue {
            path,
            value: Expr::Lit(ExprLit { lit: Lit::Str(name), .. }),
            ..
        }) if path.is_ident("path") => Some(name.value()),
        _ => None,
    })
}

fn parse(path: &Path, text: &str) -> Result<Vec<Item>> {
    let file = syn::parse_file(text).with_context(|| format!("{} isn't Rust", path.display()))?;
    Ok(if production::is_test_only(&file.attrs) { Vec::new() } else { file.items })
}
