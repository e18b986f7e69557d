//! Passes memory map and linker script to the image.

use std::env;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let folder = env::var("CARGO_MANIFEST_DIR").expect("cargo sets CARGO_MANIFEST_DIR");
    println!("cargo::rustc-link-search={folder}/../../firmware");
    println!("cargo::rustc-link-arg-bins=-Tlink.x");
}
