//! The walks of `docs/extend` for laws, the library and continuous integration. Their Rust is tested with the crate's
//! documentation.

use std::path::PathBuf;

use tests::{program, walk};

fn walk_through(page: &str) {
    // The programs of the examples lie next to `lashloop`.
    let programs: PathBuf = program::example("own-law");
    walk::through(page, &[programs.parent().expect("the folder of the profile")]);
}

#[test]
fn the_walk_to_a_law_of_ones_own_leads_there() {
    walk_through("docs/extend/law.md");
}

#[test]
fn the_walk_to_the_library_leads_there() {
    walk_through("docs/extend/library.md");
}

#[test]
fn the_walk_to_continuous_integration_leads_there() {
    walk_through("docs/extend/ci.md");
}
