//! The generated parts of the annexes of `docs/protocol.md`: what is between `<!-- generated: NAME -->` and `<!-- end -->`.

mod budget;
mod conversation;
mod tables;

use std::fs;
use std::io;
use std::path::PathBuf;

#[cfg(test)]
pub use conversation::{Exchange, conversation};
#[cfg(test)]
pub use tables::longest_gap;

const START: &str = "<!-- generated: ";
const END: &str = "<!-- end -->";

/// An annex, and the functions that write its parts.
pub struct Annex {
    file: &'static str,
    /// The text of a part by its name, given the text as it is; `None` for an unknown name.
    part: fn(&str, &str) -> Option<String>,
}

/// The annexes with generated parts.
pub const ANNEXES: [Annex; 3] = [
    Annex { file: "bytes.md", part: |name, _| conversation::part(name).or_else(|| budget::part(name)) },
    Annex { file: "lashloop-drive.md", part: tables::of_drive },
    Annex { file: "bench-mode.md", part: tables::of_bench_mode },
];

impl Annex {
    fn path(&self) -> PathBuf {
        tests::workspace().join("docs/protocol").join(self.file)
    }

    /// The annex as it should be.
    fn generated(&self, text: &str) -> String {
        let (before, rest) = text.split_once(START).unwrap_or((text, ""));
        let mut generated = before.to_owned();
        for piece in rest.split(START).filter(|piece| !piece.is_empty()) {
            let (name, body) = piece.split_once(" -->\n").expect("a name ends its line");
            let (old, after) = body.split_once(END).expect("a generated part has an end");
            let part = (self.part)(name, old).unwrap_or_else(|| panic!("{}: no part {name}", self.file));
            generated += &format!("{START}{name} -->\n{}\n{END}{after}", part.trim_end());
        }
        generated
    }

    /// Writes the generated parts into the file.
    #[allow(dead_code, reason = "the tests only compare")]
    pub fn write(&self) -> io::Result<()> {
        let text = fs::read_to_string(self.path())?;
        fs::write(self.path(), self.generated(&text))
    }
}

#[test]
fn the_generated_parts_are_those_of_the_code() {
    for annex in &ANNEXES {
        let have = fs::read_to_string(annex.path()).expect("an annex");
        let want = annex.generated(&have);
        assert!(want.contains(START), "{} has no generated part", annex.file);
        let differing = have.lines().zip(want.lines()).find(|(have, want)| have != want);
        let remedy = "run `cargo run -p tests --example protocol_annexes`";
        assert!(differing.is_none() && have == want, "{}: {differing:?}; {remedy}", annex.file);
    }
}
