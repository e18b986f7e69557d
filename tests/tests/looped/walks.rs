//! The walks of `docs/extend` for laws, plants, the library and continuous integration. The tests of the crate's documentation have
//! their Rust.

use tests::walk::through;

#[test]
fn the_walk_to_an_own_law_leads_there() {
    through("docs/extend/law.md", &[]);
}

#[test]
fn the_walk_to_an_own_plant_leads_there() {
    through("docs/extend/plant.md", &[]);
}

#[test]
fn the_walk_to_the_library_leads_there() {
    through("docs/extend/library.md", &[]);
}

#[test]
fn the_walk_to_continuous_integration_leads_there() {
    through("docs/extend/ci.md", &[]);
}
