//! Any bytes: a scenario or a message, never a panic.

use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};

use crate::{SHORTEST, read, set};

/// What a hand, an editor or an enemy might leave in a file.
const SCRAPS: [&str; 20] = [
    "",
    "=",
    "[",
    "]",
    "[[",
    "\"",
    "'",
    "\n",
    ".",
    "{",
    "}",
    "#",
    "-",
    "nan",
    "1e999",
    "9223372036854775808",
    "\u{0}",
    "\u{1f9ed}",
    "expect",
    "[[expect]]\n",
];

fn below(random: &mut Pcg64Mcg, limit: usize) -> usize {
    (random.next_u64() % limit as u64) as usize
}

/// Replaces a few characters by scraps or by another piece of the text itself.
fn mutate(text: &str, random: &mut Pcg64Mcg) -> String {
    let mut characters: Vec<char> = text.chars().collect();
    for _ in 0..=below(random, 4) {
        let from = below(random, characters.len() + 1);
        let to = (from + below(random, 12)).min(characters.len());
        let scrap: Vec<char> = if below(random, 2) == 0 {
            SCRAPS[below(random, SCRAPS.len())].chars().collect()
        } else {
            let start = below(random, characters.len() + 1);
            characters[start..(start + below(random, 40)).min(characters.len())].to_vec()
        };
        characters.splice(from..to, scrap);
    }
    characters.into_iter().collect()
}

#[test]
fn a_mutated_scenario_is_read_or_refused_with_messages() {
    let mut random = Pcg64Mcg::seed_from_u64(13);
    let whole = include_str!("../../../../scenarios/smooth-before.toml");
    let (mut good, mut bad) = (0, 0);
    for _ in 0..4000 {
        for text in [SHORTEST, whole] {
            match read(&mutate(text, &mut random), &[]) {
                Ok(_) => good += 1,
                Err(messages) => {
                    assert!(messages.lines().all(|line| line.starts_with("x.toml:")), "{messages}");
                    bad += 1;
                }
            }
        }
    }
    // Mutations that hit comments leave a good scenario; both kinds have to occur for this to test anything.
    assert!(good > 100 && bad > 1000, "{good} good, {bad} bad");
}

#[test]
fn a_mutated_option_is_applied_or_refused_with_messages() {
    let mut random = Pcg64Mcg::seed_from_u64(14);
    for _ in 0..4000 {
        let option = mutate("expect.0.max=[1, 2]", &mut random);
        if let Err(messages) = read(SHORTEST, &set([&option])) {
            assert!(messages.starts_with("--set ") || messages.starts_with("x.toml:"), "{messages}");
        }
    }
}

#[test]
fn depth_does_not_overflow_the_stack() {
    let deep = 100_000;
    for text in [
        format!("{}x = 1", "a.".repeat(deep)),
        format!("[{}x]", "a.".repeat(deep)),
        format!("x = {}{}", "[".repeat(deep), "]".repeat(deep)),
        format!("x = {}", "{a = ".repeat(deep)),
    ] {
        assert!(read(&text, &[]).is_err());
    }
    assert!(read(SHORTEST, &set([&format!("{}x=1", "a.".repeat(deep))])).is_err());
    assert!(read(SHORTEST, &set([&format!("title={}", "[".repeat(deep))])).is_err());
}

#[test]
fn a_whole_page_in_a_value_stays_out_of_the_message() {
    let page = "x".repeat(100_000);
    let messages = read(&format!("{SHORTEST}{page} = \"{page}\"\n"), &[]).expect_err("no such key");
    assert!(messages.len() < 500, "{} bytes", messages.len());
}
