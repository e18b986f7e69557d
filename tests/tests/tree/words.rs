//! Words and phrases that the project doesn't use, each with the one to use instead.
//!
//! The table holds what can be recognised without judging a sentence; `CONTRIBUTING.md` has the rules of style.

use std::fs;
use std::process::Command;

use anyhow::{Context, Result};
use regex_lite::Regex;

use crate::metadata;

/// Patterns, without regard to case, and what to write.
const TABLE: [(&str, &str); 16] = [
    (r"\bnought", "zero"),
    (r"greet", "handshake"),
    (r"\b(clock|time) on the wall\b", "wall-clock time"),
    (r"\blast[ _]words", "fault frame"),
    (r"\bso many\b", "the name of the number"),
    (r"\b(nobody|somebody)\b", "the noun: no host, no detector, an operator"),
    (r"\bwhatever\b", "any, or the range"),
    (r"\bbeside\b", "next to, compared with, in addition to"),
    (r"\b(is|are) gone\b", "no longer exists, is removed, is closed"),
    (r"\b(is|are|was|were|be|been) told\b", "is sent, is set, is commanded"),
    (r"\btell(s|ing)? of\b|\btold of\b", "report, reports"),
    (
        r"\b(drive|bench|board|image|firmware|device|twin|emulator|program|host|session|law|bridge) (says|said|tells|told|hears|heard|believes|believed|asks|asked|dies|died|greets)\b",
        "sends, reports, receives, assumes, requests, stops",
    ),
    (r"\broom: |&mut room\b|&room\b|\blet (mut )?room\b|\broom\.|\b\w+_room\b", "buffer, capacity, space"),
    (r"\bvocabulary(::|\.rs)|\bmod vocabulary\b", "enums"),
    (r"\bbench-(peers|plant)\b", "benchmarks/codec, benchmarks/plant"),
    (
        r"ControllerId::(Faithful|Literal|Compensating)\b|\b(faithful|literal|compensating) (control )?law",
        "merzouki, merzouki-as-printed, backlash-inverse",
    ),
];

/// The files that are searched.
const PATHS: [&str; 6] = ["*.rs", "*.md", "*.py", "*.toml", "*.lua", ":!tests/tests/tree/words.rs"];

#[test]
fn words_of_the_project() -> Result<()> {
    let rules = compile()?;
    let files = metadata::output_of(Command::new("git").args(["ls-files", "--"]).args(PATHS))?;
    let mut found = Vec::new();
    for path in files.lines() {
        // A file that is deleted but not yet committed has no words.
        let Ok(text) = fs::read_to_string(tests::workspace().join(path)) else { continue };
        for (line, number) in text.lines().zip(1_u32..) {
            let words = find(&rules, path, line).into_iter();
            found.extend(words.map(|(word, instead)| format!("{path}:{number}: {word} -> {instead}")));
        }
    }
    assert!(found.is_empty(), "{} words to replace\n{}", found.len(), found.join("\n"));
    Ok(())
}

fn compile() -> Result<Vec<(Regex, &'static str)>> {
    let rules = TABLE.into_iter().map(|(pattern, instead)| {
        let rule = Regex::new(&format!("(?i){pattern}")).with_context(|| format!("the pattern {pattern}"))?;
        Ok((rule, instead))
    });
    rules.collect()
}

/// The words of a line, with what to write instead.
fn find<'a>(rules: &'a [(Regex, &str)], path: &str, line: &'a str) -> Vec<(&'a str, &'a str)> {
    // The changelog names old names where it says what replaced them.
    if path == "CHANGELOG.md" && line.contains("alias") {
        return Vec::new();
    }
    let words = rules
        .iter()
        .flat_map(|(rule, instead)| rule.find_iter(line).map(move |word| (word.as_str(), *instead)));
    words.collect()
}

#[test]
fn words_are_found_with_what_to_write_instead() {
    let rules = compile().expect("the table compiles");
    let words =
        |line| find(&rules, "docs/faults.md", line).into_iter().map(|(word, _)| word).collect::<Vec<_>>();
    assert_eq!(words("The drive says nought."), ["nought", "drive says"]);
    assert_eq!(words("fn encode(&self, room: &mut [u8])"), ["room: "]);
    assert_eq!(words("Greeting::send"), ["Greet"]);
    for line in ["a string literal", "a room of its own", "the operator says so", "besides, many so do"] {
        assert_eq!(words(line), <[&str; 0]>::default(), "{line}");
    }
}

#[test]
fn the_changelog_may_name_an_alias() {
    let rules = compile().expect("the table compiles");
    assert!(find(&rules, "CHANGELOG.md", "the literal law is an alias of merzouki-as-printed").is_empty());
    assert_eq!(find(&rules, "CHANGELOG.md", "the literal law").len(), 1);
}
