//! How many systematic mutants of the specimen the battery finds.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::thread;

use lashloop_conformance::{CheckResult, CheckStatus, Reporter, run};

use crate::allowed::{EQUIVALENT, NOT_FOUND, Set};
use crate::is_optional;
use crate::mutation::{Checks, Mutant, Recorder, Sites};
use crate::specimen::Specimen;

/// Least mutants found, in percent of those that break a rule.
const LEAST_PERCENT: f64 = 97.0;
/// Number of the handshake before the first check.
const HANDSHAKE: usize = 0;

/// Counts the checks of an unchanged specimen for its recorder.
struct Census {
    recorder: Arc<Recorder>,
    results: Vec<CheckResult>,
}

impl Reporter for Census {
    fn connected(&mut self, _identity: &lashloop_protocol::message::Identity) {
        self.recorder.check.store(1, Ordering::Relaxed);
    }

    fn checked(&mut self, result: &CheckResult) {
        self.results.push(result.clone());
        self.recorder.check.store(self.results.len() + 1, Ordering::Relaxed);
    }
}

/// Runs some checks up to the first that fails.
struct Hunt<'a> {
    numbers: &'a BTreeMap<String, usize>,
    checks: &'a dyn Fn(usize) -> bool,
    found_by: Option<String>,
}

impl Reporter for Hunt<'_> {
    fn wants(&self, _group: &str, name: &str) -> bool {
        self.numbers.get(name).is_some_and(|number| (self.checks)(*number))
    }

    fn checked(&mut self, result: &CheckResult) {
        if matches!(result.status, CheckStatus::Failed { .. }) {
            self.found_by = Some(result.name.clone());
        }
    }

    fn is_interrupted(&self) -> bool {
        self.found_by.is_some()
    }
}

fn census() -> Census {
    let recorder = Arc::new(Recorder::default());
    let mut census = Census { recorder: recorder.clone(), results: Vec::new() };
    let specimen = Specimen::new(Sites::new(None, Some(recorder)));
    run(Box::new(specimen), 7, &mut census).expect("a drive");
    census
}

/// The check of these that fails, if one does.
fn hunt(mutant: Mutant, numbers: &BTreeMap<String, usize>, checks: &dyn Fn(usize) -> bool) -> Option<String> {
    let mut hunt = Hunt { numbers, checks, found_by: None };
    let link = Box::new(Specimen::new(Sites::new(Some(mutant), None)));
    match catch_unwind(AssertUnwindSafe(|| run(link, 7, &mut hunt))) {
        Ok(Ok(())) => hunt.found_by,
        Ok(Err(error)) => Some(error.to_string()),
        Err(_) => panic!("{mutant} panics"),
    }
}

/// The checks in which the mutant acts come first: the others can fail only if it acted in the handshake before them.
fn found_by(mutant: Mutant, acts_in: &Checks, numbers: &BTreeMap<String, usize>) -> Option<String> {
    let likely = hunt(mutant, numbers, &|number| acts_in.contains(&number));
    let is_elsewhere = likely.is_none() && acts_in.contains(&HANDSHAKE);
    if is_elsewhere { hunt(mutant, numbers, &|number| !acts_in.contains(&number)) } else { likely }
}

/// A mutant with the checks in which it acts, and what found it.
struct Found {
    mutant: Mutant,
    acts_in: Checks,
    by: Option<String>,
}

impl Found {
    fn is_in(&self, sets: &[Set]) -> bool {
        sets.iter().any(|set| set.has(&self.mutant))
    }

    fn text(&self) -> String {
        format!("{} | {}", self.mutant, self.by.as_deref().unwrap_or("-"))
    }
}

fn all_found(census: &Census, numbers: &BTreeMap<String, usize>) -> Vec<Found> {
    let mutants = census.recorder.mutants();
    let next = AtomicUsize::new(0);
    let results = Mutex::new(Vec::new());
    thread::scope(|scope| {
        for _ in 0..thread::available_parallelism().map_or(2, Into::into) {
            scope.spawn(|| {
                while let Some((mutant, acts_in)) = mutants.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let by = found_by(*mutant, acts_in, numbers);
                    let found = Found { mutant: *mutant, acts_in: acts_in.clone(), by };
                    results.lock().expect("no panic").push(found);
                }
            });
        }
    });
    let mut results = results.into_inner().expect("no panic");
    results.sort_by_key(|it| it.mutant.to_string());
    results
}

fn specimen() -> (Census, BTreeMap<String, usize>) {
    let census = census();
    let numbered = census.results.iter().enumerate();
    let numbers = numbered.map(|(place, it)| (it.name.clone(), place + 1)).collect();
    (census, numbers)
}

#[test]
fn specimen_passes_every_check() {
    let mut results = census().results;
    results.retain(|it| it.status != CheckStatus::Passed && !is_optional(it));
    assert!(results.is_empty(), "{results:#?}");
}

#[test]
fn nearly_every_mutant_is_found_and_none_that_the_page_allows() {
    let (census, numbers) = specimen();
    let results = all_found(&census, &numbers);
    let (allowed, broken): (Vec<_>, Vec<_>) = results.iter().partition(|it| it.is_in(EQUIVALENT));
    let survivors: Vec<_> = broken.iter().filter(|it| it.by.is_none()).collect();
    let percent = 100.0 * (broken.len() - survivors.len()) as f64 / broken.len() as f64;
    report(broken.len(), &survivors, allowed.len(), percent, &by_group(&census, &broken));
    survivors.iter().for_each(|it| println!("{}", it.text()));

    let wronged: Vec<_> = allowed.iter().filter(|it| it.by.is_some()).map(|it| it.text()).collect();
    let unexpected: Vec<_> = survivors.iter().filter(|it| !it.is_in(NOT_FOUND)).map(|it| it.text()).collect();
    let is_idle = |set: &&Set, mutants: &[&Found]| !mutants.iter().any(|it| set.has(&it.mutant));
    let survivors: Vec<&Found> = survivors.into_iter().copied().collect();
    let stale = EQUIVALENT.iter().filter(|set| is_idle(set, &allowed));
    let stale = stale.chain(NOT_FOUND.iter().filter(|set| is_idle(set, &survivors)));
    let stale: Vec<_> = stale.map(ToString::to_string).collect();
    let unbroken = unbroken(&census, &numbers, &broken);
    let wrong: String = [
        ("the page allows these mutants, and a check fails", wronged),
        ("no check fails for these mutants", unexpected),
        ("no mutant survives of these rows, which can go", stale),
        ("no mutant fails these checks", unbroken),
    ]
    .into_iter()
    .filter(|(_, lines)| !lines.is_empty())
    .map(|(what, lines)| format!("{what}:\n{}\n", lines.join("\n")))
    .collect();
    assert!(wrong.is_empty(), "{wrong}");
    assert!(
        percent >= LEAST_PERCENT,
        "{percent:.1} % of the mutants are found, of at least {LEAST_PERCENT} %"
    );
}

/// Checks that fail for no mutant, not even one that another check finds first.
fn unbroken(census: &Census, numbers: &BTreeMap<String, usize>, broken: &[&Found]) -> Vec<String> {
    let caught: BTreeSet<_> = broken.iter().filter_map(|it| it.by.as_deref()).collect();
    let judged = census.results.iter().filter(|it| it.status == CheckStatus::Passed);
    let others = judged.map(|it| it.name.as_str()).filter(|name| !caught.contains(name));
    others
        .filter(|name| {
            let number = numbers[*name];
            let acting = broken.iter().filter(|it| it.acts_in.contains(&number));
            !acting.into_iter().any(|it| hunt(it.mutant, numbers, &|wanted| wanted == number).is_some())
        })
        .map(ToOwned::to_owned)
        .collect()
}

/// For each group of checks how many of the mutants that act in it are found, by any check.
fn by_group(census: &Census, broken: &[&Found]) -> String {
    let mut groups = Vec::<(&str, usize, usize)>::new();
    for (place, check) in census.results.iter().enumerate() {
        if groups.last().is_none_or(|(group, ..)| *group != check.group) {
            let numbers = (1..).zip(&census.results).filter(|(_, it)| it.group == check.group);
            let numbers: BTreeSet<usize> = numbers.map(|(number, _)| number).collect();
            let acting = broken.iter().filter(|it| !it.acts_in.is_disjoint(&numbers));
            let (acting, found) =
                acting.fold((0, 0), |(all, found), it| (all + 1, found + usize::from(it.by.is_some())));
            groups.push((census.results[place].group, found, acting));
        }
    }
    let percent = |found: usize, acting: usize| 100.0 * found as f64 / acting.max(1) as f64;
    let of =
        |(group, found, acting): &(&str, usize, usize)| format!("{group} {:.1}", percent(*found, *acting));
    groups.iter().map(of).collect::<Vec<_>>().join(", ")
}

/// Writes the line that the test command prints at its end, and the survivors by site.
fn report(count: usize, survivors: &[&&Found], allowed: usize, percent: f64, groups: &str) {
    let mut sites = BTreeMap::<_, usize>::new();
    for it in survivors {
        *sites.entry(it.mutant.key.0).or_default() += 1;
    }
    let sites: Vec<_> = sites.into_iter().map(|(site, count)| format!("{site} {count}")).collect();
    let line = format!(
        "conformance: {} of {count} mutants of a drive found ({percent:.1} %; of those that act in {groups}), {} survivors: {}; \
         {allowed} more keep every rule\n",
        count - survivors.len(),
        survivors.len(),
        sites.join(", ")
    );
    print!("{line}");
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).with_file_name("reports");
    let written =
        fs::create_dir_all(&folder).and_then(|()| fs::write(folder.join("conformance-mutants.txt"), line));
    written.expect("a folder for reports");
}
