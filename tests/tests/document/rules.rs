//! The rules of `docs/protocol.md` and its annexes: numbered without a gap, none without a check or a reason, no "must" without a number.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;

use lashloop_conformance::unchecked::{Instead, UNCHECKED};
use regex_lite::Regex;

use crate::markdown::PROTOCOL;

/// A rule: `R` for the drive or `H` for the host, the section, and the number in the section.
type Rule = (char, u32, u32);

fn rule(text: &str) -> Rule {
    let parsed = text.split_at_checked(1).and_then(|(side, numbers)| {
        let (section, number) = numbers.split_once('.')?;
        Some((side.chars().next()?, section.parse().ok()?, number.parse().ok()?))
    });
    parsed.unwrap_or_else(|| panic!("{text:?} isn't a rule"))
}

/// The page and its annexes without their fenced blocks.
fn prose() -> String {
    PROTOCOL.split("\n```").step_by(2).collect::<Vec<_>>().join("\n")
}

/// The tags in a text.
fn tags(text: &str) -> impl Iterator<Item = Rule> {
    let tag = Regex::new(r"\[([RH]\d+\.\d+)\]").expect("a pattern");
    let found: Vec<_> = tag.captures_iter(text).map(|it| rule(&it[1])).collect();
    found.into_iter()
}

fn of_page() -> BTreeSet<Rule> {
    tags(&prose()).collect()
}

/// The rules of the checks.
fn checked() -> BTreeSet<Rule> {
    lashloop_conformance::list()
        .flat_map(|check| {
            assert!(!check.rules.is_empty(), "{}: {} cites no rule", check.group, check.name);
            check.rules.split(' ').map(rule).collect::<Vec<_>>()
        })
        .collect()
}

#[test]
fn rules_are_numbered_without_a_gap() {
    let mut numbers = BTreeMap::<_, Vec<_>>::new();
    for (side, section, number) in of_page() {
        numbers.entry((section, side)).or_default().push(number);
    }
    assert!(numbers.len() > 20, "{} kinds of rules", numbers.len());
    for ((section, side), numbers) in numbers {
        let want: Vec<_> = (1..).take(numbers.len()).collect();
        assert_eq!(numbers, want, "{side}{section}");
        let heading = format!("\n## {section}. ");
        let (_, after) = PROTOCOL.split_once(&heading).unwrap_or_else(|| panic!("no section {section}"));
        let section_text = after.split("\n## ").next().unwrap_or(after);
        let here: BTreeSet<_> = tags(section_text).collect();
        for number in numbers {
            assert!(
                here.contains(&(side, section, number)),
                "{side}{section}.{number} is not in its section"
            );
        }
    }
}

/// Paragraphs, list items and rows of tables. A row carries the tags of the sentence above its table.
fn statements() -> Vec<String> {
    let (mut statements, mut above) = (Vec::<String>::new(), String::new());
    let mut is_open = false;
    for line in prose().lines() {
        if line.starts_with('|') {
            statements.push(format!("{above} {line}"));
            is_open = false;
        } else if line.is_empty() || line.starts_with('#') {
            is_open = false;
        } else {
            match statements.last_mut() {
                Some(last) if is_open && !line.starts_with("- ") => {
                    last.push(' ');
                    last.push_str(line);
                }
                _ => statements.push(line.to_owned()),
            }
            is_open = true;
            above = tags(statements.last().expect("just pushed")).map(|it| format!("{it:?}")).collect();
        }
    }
    statements
}

#[test]
fn every_must_has_a_number() {
    let must = Regex::new(r"\bmust\b").expect("a pattern");
    let statements = statements();
    let mut obliging = 0;
    for statement in statements.iter().filter(|it| must.is_match(it)) {
        obliging += 1;
        assert!(tags(statement).next().is_some(), "no number: {statement}");
    }
    assert!(obliging > 40, "{obliging} statements with must");
}

#[test]
fn every_rule_is_checked_or_listed_with_a_reason() {
    let (page, checked) = (of_page(), checked());
    let unchecked: BTreeSet<_> = UNCHECKED.iter().map(|it| rule(it.rule)).collect();
    assert_eq!(unchecked.len(), UNCHECKED.len(), "a rule is listed twice");
    let names = |rules: BTreeSet<Rule>| -> Vec<_> {
        rules.into_iter().map(|(side, section, number)| format!("{side}{section}.{number}")).collect()
    };
    let none = Vec::<String>::new();
    assert_eq!(names(&checked & &unchecked), none, "have a check and are listed without one");
    assert_eq!(names(&checked - &page), none, "are cited by checks and not in the page");
    assert_eq!(names(&unchecked - &page), none, "are listed and not in the page");
    assert_eq!(names(&page - &(&checked | &unchecked)), none, "have neither check nor reason");
}

#[test]
fn the_tests_that_take_the_place_of_checks_exist() {
    for it in UNCHECKED {
        match it.instead {
            Instead::Nothing(reason) => assert!(reason.len() > 10, "{}: {reason:?}", it.rule),
            Instead::Test { file, name } => {
                let text = fs::read_to_string(tests::workspace().join(file))
                    .unwrap_or_else(|error| panic!("{}: {file}: {error}", it.rule));
                assert!(text.contains(&format!("fn {name}(")), "{}: {file} has no test {name}", it.rule);
            }
        }
    }
}

/// Words of a text and of its tables, without fenced blocks.
fn words(text: &str) -> usize {
    let prose = text.split("\n```").step_by(2).flat_map(str::split_whitespace);
    prose.filter(|word| word.contains(|it: char| it.is_ascii_alphanumeric())).count()
}

/// Words of the first reading: from the top to the answers, and from section 6 to the end of the page.
fn first_reading() -> usize {
    let until = |end: &str| PROTOCOL.find(end).unwrap_or_else(|| panic!("no heading {end:?}"));
    let beginning = &PROTOCOL[..until("\n### Hello")];
    words(beginning) + words(&PROTOCOL[until("\n## 6. ")..until("\n# The wire protocol: bytes")])
}

#[test]
fn the_first_reading_takes_half_an_hour_and_as_long_as_stated() {
    let stated = Regex::new(r"First reading, ([\d,]+) words with the tables, (\d+) minutes at (\d+) words")
        .expect("a pattern");
    let stated = stated.captures(PROTOCOL).expect("the reading order");
    let number = |at: usize| stated[at].replace(',', "").parse::<usize>().expect("a number");
    let words = first_reading();
    assert_eq!(number(1), words.next_multiple_of(100), "{words} words");
    assert_eq!(number(2), number(1).div_ceil(number(3)));
    assert!((200..=250).contains(&number(3)) && number(2) <= 30, "{}", &stated[0]);
}
