//! Words and phrases that the project doesn't use, each with the one to use instead.
//!
//! The table holds what can be recognised without judging a sentence; `CONTRIBUTING.md` has the rules of style.

use std::fs;
use std::process::Command;

use anyhow::{Context, Result};
use regex_lite::Regex;

use crate::metadata;

/// Patterns, without regard to case, and what to write.
const TABLE: [(&str, &str); 9] = [
    (r"\b(is|are) no\b", "isn't a, aren't, or what it is"),
    (r"\b(is|are) none that\b", "isn't one that, or what it is"),
    (r"\bin place of\b", "instead of"),
    (r"\beither way\b", "in both directions, in both cases"),
    (r"\bgoes on\b", "continues"),
    (r"\bthe begin\b", "the start"),
    (r"\bhardly\b", "barely, almost no, is unlikely to"),
    (r"\bfor ever\b", "forever"),
    (r"\bless the\b", "minus the"),
];

/// What the patterns find and is good English.
const ACCEPTED: &str =
    r"(?i)\bthere (is|are) no\b|\b(is|are) no (longer|more|worse|wider|older|later|earlier)\b";

/// The files that are searched.
const PATHS: [&str; 6] = ["*.rs", "*.md", "*.py", "*.toml", "*.lua", ":!tests/tests/tree/words.rs"];

#[test]
fn words_of_the_project() -> Result<()> {
    let words = Words::new()?;
    let files = metadata::output_of(Command::new("git").args(["ls-files", "--"]).args(PATHS))?;
    let mut found = Vec::new();
    for path in files.lines() {
        // A file that is deleted but not yet committed has no words.
        let Ok(text) = fs::read_to_string(tests::workspace().join(path)) else { continue };
        for (line, number) in text.lines().zip(1_u32..) {
            found.extend(
                words.find(line).map(|(word, instead)| format!("{path}:{number}: {word} -> {instead}")),
            );
        }
    }
    assert!(found.is_empty(), "{} words to replace\n{}", found.len(), found.join("\n"));
    Ok(())
}

struct Words {
    rules: Vec<(Regex, &'static str)>,
    accepted: Regex,
}

impl Words {
    fn new() -> Result<Self> {
        let rules = TABLE.into_iter().map(|(pattern, instead)| {
            let rule =
                Regex::new(&format!("(?i){pattern}")).with_context(|| format!("the pattern {pattern}"))?;
            Ok((rule, instead))
        });
        Ok(Self { rules: rules.collect::<Result<_>>()?, accepted: Regex::new(ACCEPTED)? })
    }

    /// The words of a line, with what to write instead.
    fn find<'a>(&'a self, line: &'a str) -> impl Iterator<Item = (&'a str, &'static str)> {
        let accepted: Vec<_> = self.accepted.find_iter(line).map(|words| words.range()).collect();
        let words = self
            .rules
            .iter()
            .flat_map(move |(rule, instead)| rule.find_iter(line).map(move |words| (words, *instead)));
        words
            .filter(move |(words, _)| !accepted.iter().any(|accepted| accepted.contains(&words.start())))
            .map(|(words, instead)| (words.as_str(), instead))
    }
}

#[test]
fn words_are_found_with_what_to_write_instead() {
    let rules = Words::new().expect("the table compiles");
    let words = |line| rules.find(line).map(|(word, _)| word).collect::<Vec<_>>();
    assert_eq!(words("A run goes on for ever."), ["goes on", "for ever"]);
    assert_eq!(words("/// Is no scenario, in place of one."), ["Is no", "in place of"]);
    assert_eq!(words("if there is no file, it is no file"), ["is no"]);
    for line in
        ["there are no samples", "the rest is no older", "a beginning", "unless the drive", "it is none"]
    {
        assert_eq!(words(line), <[&str; 0]>::default(), "{line}");
    }
}
