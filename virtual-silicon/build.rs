//! The pin maps of `boards`, each by the name of its file.

use std::fmt::Write as _;
use std::path::Path;
use std::{env, fs};

fn main() {
    println!("cargo::rerun-if-changed=boards");
    let folder = Path::new(&env::var("CARGO_MANIFEST_DIR").expect("cargo sets it")).join("boards");
    let files = fs::read_dir(&folder).expect("the folder of the pin maps");
    let mut files: Vec<_> = files.map(|file| file.expect("an entry of it").path()).collect();
    files.retain(|file| file.extension().is_some_and(|extension| extension == "toml"));
    files.sort();
    let mut list = String::from("&[");
    for file in files {
        let name = file.file_stem().expect("a file").to_string_lossy();
        write!(list, "({name:?}, include_str!({file:?})),").expect("memory");
    }
    list.push(']');
    let out = Path::new(&env::var("OUT_DIR").expect("cargo sets it")).join("boards.rs");
    fs::write(out, list).expect("a file");
}
