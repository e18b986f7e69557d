//! Counting the code lines of a file.

use std::collections::BTreeSet;

use anyhow::Result;
use syn::spanned::Spanned;
use syn::visit::{self, Visit};

use crate::production;

/// Lines that are neither blank nor comment nor part of a test-only item.
///
/// # Errors
/// The text isn't Rust.
pub(crate) fn count(text: &str) -> Result<usize> {
    let file = syn::parse_file(text)?;
    let mut tests = TestLines::default();
    tests.visit_file(&file);
    let is_code = |line: &str| !line.trim().is_empty() && !line.trim_start().starts_with("//");
    Ok(text.lines().zip(1..).filter(|(line, number)| is_code(line) && !tests.0.contains(number)).count())
}

/// Numbers of the lines of test-only items, from 1.
#[derive(Default)]
struct TestLines(BTreeSet<usize>);

impl TestLines {
    fn add(&mut self, span: proc_macro2::Span) {
        self.0.extend(span.start().line..=span.end().line);
    }
}

impl<'ast> Visit<'ast> for TestLines {
    fn visit_item(&mut self, item: &'ast syn::Item) {
        if production::is_test_only(production::attributes(item)) {
            self.add(item.span());
        } else {
            visit::visit_item(self, item);
        }
    }

    fn visit_impl_item_fn(&mut self, function: &'ast syn::ImplItemFn) {
        if production::is_test_only(&function.attrs) {
            self.add(function.span());
        } else {
            visit::visit_impl_item_fn(self, function);
        }
    }
}

#[test]
fn comments_blank_lines_and_tests_are_no_code_lines() {
    let text = "//! A module.\n\n/// Doc.\nfn f() {\n    // Why.\n    g(); // here\n}\n\n#[cfg(test)]\nmod tests {\n    fn t() {}\n}\nstruct S;\n";
    assert_eq!(count(text).expect("Rust"), 4);
}
