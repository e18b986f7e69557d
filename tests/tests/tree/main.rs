//! Tests of the source tree: the directions of dependencies, the words, and the size of production code. `cargo xtask check`
//! runs them.

mod census;
mod code_lines;
mod directions;
mod lines;
mod metadata;
mod production;
mod versions;
mod words;
