//! How many systematic mutants of the specimen the battery finds.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::thread;

use lashloop::conformance::{CheckResult, CheckStatus, Reporter, run};

use crate::allowed::{EQUIVALENT, NOT_FOUND, Set};
use crate::mutation::{Checks, Mutant, Recorder, Sites};
use crate::specimen::Specimen;

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
        if matches!(result.status, CheckStatus::Failed { .. } | CheckStatus::NotJudged { .. }) {
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

/// The check that fails, if one does. The checks in which the mutant acts come first: the others can fail only if it acted
/// in the handshake before them.
fn hunt(mutant: Mutant, acts_in: &Checks, numbers: &BTreeMap<String, usize>) -> Option<String> {
    let likely = |number: usize| acts_in.contains(&number);
    let others = |number: usize| !acts_in.contains(&number);
    let stages: [&dyn Fn(usize) -> bool; 2] = [&likely, &others];
    let count = if acts_in.contains(&0) { 2 } else { 1 };
    stages[..count].iter().find_map(|checks| {
        let mut hunt = Hunt { numbers, checks: *checks, found_by: None };
        let link = Box::new(Specimen::new(Sites::new(Some(mutant), None)));
        let ended = catch_unwind(AssertUnwindSafe(|| run(link, 7, &mut hunt)));
        match ended {
            Ok(Ok(())) => hunt.found_by,
            Ok(Err(error)) => Some(error.to_string()),
            Err(_) => panic!("{mutant} panics"),
        }
    })
}

/// For a look at a single mutant: `MUTANT="site | part | Operator When"`.
#[test]
#[ignore = "for a person"]
fn one_mutant() {
    let wanted = std::env::var("MUTANT").expect("MUTANT");
    let census = census();
    let (mutant, acts) =
        census.recorder.mutants().into_iter().find(|(it, _)| it.to_string() == wanted).expect("a mutant");
    let mut all = Census { recorder: Arc::new(Recorder::default()), results: Vec::new() };
    println!(
        "acts in {:?}",
        acts.iter().map(|it| it.checked_sub(1).map(|it| &census.results[it].name)).collect::<Vec<_>>()
    );
    println!("{:?}", run(Box::new(Specimen::new(Sites::new(Some(mutant), None))), 7, &mut all));
    all.results.retain(|it| it.status != CheckStatus::Passed);
    println!("{:#?}", all.results);
}

#[test]
fn specimen_passes_every_check() {
    let mut results = census().results;
    results.retain(|it| it.status != CheckStatus::Passed);
    assert!(results.is_empty(), "{results:#?}");
}

/// A mutant with the check that fails, if one does.
type Result = (Mutant, Option<String>);

fn results() -> Vec<Result> {
    let census = census();
    let numbered = census.results.iter().enumerate();
    let numbers: BTreeMap<_, _> = numbered.map(|(place, it)| (it.name.clone(), place + 1)).collect();
    let mutants = census.recorder.mutants();
    let next = AtomicUsize::new(0);
    let results = Mutex::new(Vec::new());
    thread::scope(|scope| {
        for _ in 0..thread::available_parallelism().map_or(2, Into::into) {
            scope.spawn(|| {
                while let Some((mutant, acts_in)) = mutants.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let found_by = hunt(*mutant, acts_in, &numbers);
                    results.lock().expect("no panic").push((*mutant, found_by));
                }
            });
        }
    });
    let mut results = results.into_inner().expect("no panic");
    results.sort_by_key(|(mutant, _)| mutant.to_string());
    results
}

#[test]
fn nearly_all_systematic_mutants_are_found_and_none_that_the_page_allows() {
    let results = results();
    let in_set = |mutant: &Mutant, sets: &[Set]| sets.iter().any(|set| set.has(mutant));
    let (allowed, broken): (Vec<_>, Vec<_>) = results.iter().partition(|(it, _)| in_set(it, EQUIVALENT));
    let text = |(mutant, found_by): &&Result| format!("{mutant} | {}", found_by.as_deref().unwrap_or("-"));
    let wronged: Vec<_> = allowed.iter().filter(|(_, found_by)| found_by.is_some()).map(text).collect();
    let survivors: Vec<_> = broken.iter().filter(|(_, found_by)| found_by.is_none()).collect();
    let unexpected: Vec<_> =
        survivors.iter().filter(|(it, _)| !in_set(it, NOT_FOUND)).map(|it| text(it)).collect();
    let [found, all] = [broken.len() - survivors.len(), broken.len()];
    let percent = 100.0 * found as f64 / all as f64;
    let line = format!(
        "conformance: {found} of {all} mutants of a drive found ({percent:.1} %), {} survivors, {} allowed by the page",
        survivors.len(),
        allowed.len()
    );
    println!("{line}\nUNEXPECTED\n{}\nWRONGED\n{}", unexpected.join("\n"), wronged.join("\n"));
}
