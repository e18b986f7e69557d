//! The paths that a module's items mention.

use proc_macro2::{TokenStream, TokenTree};
use syn::visit::{self, Visit};
use syn::{Item, ItemUse, Macro, UseTree, Visibility};

use crate::production;

pub(crate) type Path = Vec<String>;

/// One imported name of a `use` declaration.
pub(crate) struct Import {
    pub(crate) path: Path,
    pub(crate) kind: ImportKind,
    /// `pub`, `pub(crate)` or the like.
    pub(crate) is_reexport: bool,
}

pub(crate) enum ImportKind {
    /// The name in the importing module.
    Name(String),
    Glob,
}

#[derive(Default)]
pub(crate) struct Mentions {
    pub(crate) imports: Vec<Import>,
    pub(crate) paths: Vec<Path>,
    pub(crate) macros: Vec<Path>,
}

impl Mentions {
    pub(crate) fn of(items: &[Item]) -> Self {
        let mut mentions = Self::default();
        for item in items {
            mentions.visit_item(item);
        }
        mentions
    }

    fn import(&mut self, tree: &UseTree, prefix: &Path, is_reexport: bool) {
        let with = |name: &syn::Ident| {
            let mut path = prefix.clone();
            if name != "self" || path.is_empty() {
                path.push(name.to_string());
            }
            path
        };
        match tree {
            UseTree::Path(part) => self.import(&part.tree, &with(&part.ident), is_reexport),
            UseTree::Group(group) => {
                for tree in &group.items {
                    self.import(tree, prefix, is_reexport);
                }
            }
            UseTree::Name(name) => {
                let path = with(&name.ident);
                let kind = ImportKind::Name(path.last().cloned().unwrap_or_default());
                self.imports.push(Import { path, kind, is_reexport });
            }
            UseTree::Rename(rename) => {
                let kind = ImportKind::Name(rename.rename.to_string());
                self.imports.push(Import { path: with(&rename.ident), kind, is_reexport });
            }
            UseTree::Glob(_) => {
                self.imports.push(Import { path: prefix.clone(), kind: ImportKind::Glob, is_reexport });
            }
        }
    }

    /// Paths of at least two segments among unparsed tokens.
    fn tokens(&mut self, tokens: TokenStream) {
        let mut path = Path::new();
        let mut colons = 0;
        for token in tokens {
            match &token {
                TokenTree::Ident(name) if path.is_empty() || colons == 2 => path.push(name.to_string()),
                TokenTree::Punct(punct) if punct.as_char() == ':' && !path.is_empty() && colons < 2 => {
                    colons += 1;
                    continue;
                }
                _ => {
                    self.end_of_path(&mut path);
                    match token {
                        TokenTree::Ident(name) => path.push(name.to_string()),
                        TokenTree::Group(group) => self.tokens(group.stream()),
                        _ => {}
                    }
                }
            }
            colons = 0;
        }
        self.end_of_path(&mut path);
    }

    fn end_of_path(&mut self, path: &mut Path) {
        let path = std::mem::take(path);
        if path.len() > 1 {
            self.paths.push(path);
        }
    }
}

impl<'ast> Visit<'ast> for Mentions {
    fn visit_item(&mut self, item: &'ast Item) {
        if !production::is_test_only(production::attributes(item)) {
            visit::visit_item(self, item);
        }
    }

    fn visit_impl_item_fn(&mut self, function: &'ast syn::ImplItemFn) {
        if !production::is_test_only(&function.attrs) {
            visit::visit_impl_item_fn(self, function);
        }
    }

    fn visit_item_use(&mut self, declaration: &'ast ItemUse) {
        if declaration.leading_colon.is_none() {
            let is_reexport = !matches!(declaration.vis, Visibility::Inherited);
            self.import(&declaration.tree, &Path::new(), is_reexport);
        }
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        if path.leading_colon.is_none() {
            self.paths.push(segments(path));
        }
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, invocation: &'ast Macro) {
        self.macros.push(segments(&invocation.path));
        self.tokens(invocation.tokens.clone());
    }

    fn visit_attribute(&mut self, attribute: &'ast syn::Attribute) {
        if let syn::Meta::List(list) = &attribute.meta {
            self.tokens(list.tokens.clone());
        }
    }

    fn visit_visibility(&mut self, _: &'ast Visibility) {}
}

fn segments(path: &syn::Path) -> Path {
    path.segments.iter().map(|segment| segment.ident.to_string()).collect()
}
