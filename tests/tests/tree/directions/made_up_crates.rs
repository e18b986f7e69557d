//! Made-up crates with and without cycles.

use std::path::Path;

use super::source_tree::SourceTree;
use super::use_graph::UseGraph;

/// The cycles among the files of a crate, given as file names and texts.
fn cycles(files: &[(&str, &str)]) -> Vec<String> {
    cycles_of(UseGraph::of_files, files)
}

fn cycles_of(graph: fn(&SourceTree) -> UseGraph, files: &[(&str, &str)]) -> Vec<String> {
    let read = |path: &Path| {
        files.iter().find(|(name, _)| Path::new(name) == path).map(|(_, text)| (*text).to_owned())
    };
    let tree = SourceTree::load(Path::new("lib.rs"), &read).expect("a crate");
    let graph = graph(&tree);
    graph.cycles().iter().map(|cycle| graph.describe(cycle)).collect()
}

#[test]
fn a_cycle_is_printed_with_its_files_and_names() {
    let found = cycles(&[
        ("lib.rs", "mod a; mod b; mod c;"),
        ("a.rs", "use crate::b::B; pub struct A(B);"),
        ("b.rs", "pub struct B; fn f() { crate::c::call() }"),
        ("c.rs", "pub fn call() { let _: super::a::A; }"),
    ]);
    assert_eq!(found, ["  a.rs -> b.rs: B\n  b.rs -> c.rs: call\n  c.rs -> a.rs: A\n"]);
}

#[test]
fn straight_dependencies_are_no_cycle() {
    let found = cycles(&[
        ("lib.rs", "mod a; mod b; fn f() { a::call(); }"),
        ("a.rs", "use crate::b::*; pub fn call() { g() }"),
        ("b.rs", "pub fn g() {}"),
    ]);
    assert!(found.is_empty(), "{found:?}");
}

#[test]
fn a_reexport_is_no_edge_and_is_followed_to_the_definition() {
    let parent = ("lib.rs", "mod a;");
    let child = ("a/child.rs", "use super::sibling::S; pub struct C(S);");
    let sibling = ("a/sibling.rs", "pub struct S;");
    let found = cycles(&[parent, ("a.rs", "mod child; mod sibling; pub use child::C;"), child, sibling]);
    assert!(found.is_empty(), "{found:?}");
    let sibling = ("a/sibling.rs", "use super::C; pub struct S; fn f(_: C) {}");
    let found = cycles(&[parent, ("a.rs", "mod child; mod sibling; pub use child::*;"), child, sibling]);
    assert_eq!(found, ["  a/child.rs -> a/sibling.rs: S\n  a/sibling.rs -> a/child.rs: C\n"]);
}

#[test]
fn a_parent_that_uses_a_child_of_its_own_items_is_a_cycle() {
    let found = cycles(&[
        ("lib.rs", "mod a;"),
        ("a/mod.rs", "mod child; pub struct P; fn f() { child::g() }"),
        ("a/child.rs", "pub fn g() { let _ = super::P; }"),
    ]);
    assert_eq!(found, ["  a/child.rs -> a/mod.rs: P\n  a/mod.rs -> a/child.rs: g\n"]);
}

#[test]
fn test_code_makes_no_edge() {
    let found = cycles(&[
        ("lib.rs", "mod a; mod b; #[cfg(test)] mod no_such_file;"),
        (
            "a.rs",
            "pub struct A; #[cfg(test)] mod tests { use crate::b::B; } #[cfg(all(test, unix))] use crate::b::B;",
        ),
        ("b.rs", "use crate::a::A; pub struct B(A);"),
    ]);
    assert!(found.is_empty(), "{found:?}");
}

#[test]
fn paths_in_macros_and_attributes_count() {
    let found = cycles(&[
        ("lib.rs", "mod a; mod b;"),
        ("a.rs", "pub fn call() { println!(\"{}\", crate::b::text()) }"),
        ("b.rs", "pub fn text() {} #[derive(X)] struct S { #[arg(value_parser = crate::a::call)] x: u8 }"),
    ]);
    assert_eq!(found, ["  a.rs -> b.rs: text\n  b.rs -> a.rs: call\n"]);
}

#[test]
fn modules_that_use_each_other_through_other_files_are_a_cycle() {
    let files = [
        ("lib.rs", "mod a; mod b;"),
        ("a/mod.rs", "mod one; mod other;"),
        ("a/one.rs", "use crate::b::B; pub struct One(B); pub struct Two;"),
        ("a/other.rs", "use super::one::Two; pub struct Other(Two);"),
        ("b.rs", "mod user; pub struct B;"),
        ("b/user.rs", "use crate::a::other::Other;"),
    ];
    assert!(cycles(&files).is_empty());
    assert_eq!(cycles_of(UseGraph::of_modules, &files), ["  a -> b: B\n  b -> a: Other\n"]);
}

#[test]
fn a_module_and_those_below_it_are_one() {
    let found = cycles_of(
        UseGraph::of_modules,
        &[
            ("lib.rs", "mod a; pub struct Root(a::P);"),
            ("a/mod.rs", "mod child; pub struct P; fn f() { child::g() }"),
            ("a/child.rs", "pub fn g() { let _ = (super::P, crate::Root); }"),
        ],
    );
    assert!(found.is_empty(), "{found:?}");
}
