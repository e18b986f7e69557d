//! How many systematic mutants of the specimen the battery finds.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::thread;

use lashloop::conformance::{CheckResult, CheckStatus, Reporter, run};

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

#[test]
fn specimen_passes_every_check() {
    let mut results = census().results;
    results.retain(|it| it.status != CheckStatus::Passed);
    assert!(results.is_empty(), "{results:#?}");
}

#[test]
fn systematic_mutants_are_found() {
    let census = census();
    let numbers: BTreeMap<_, _> =
        census.results.iter().enumerate().map(|(place, it)| (it.name.clone(), place + 1)).collect();
    let mutants = census.recorder.mutants();
    let next = AtomicUsize::new(0);
    let survivors = Mutex::new(Vec::new());
    thread::scope(|scope| {
        for _ in 0..thread::available_parallelism().map_or(2, Into::into) {
            scope.spawn(|| {
                while let Some((mutant, acts_in)) = mutants.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let started = std::time::Instant::now();
                    let found = hunt(*mutant, acts_in, &numbers);
                    let took = started.elapsed();
                    if took.as_millis() > 500 {
                        println!("slow {took:?} {mutant} {found:?}");
                    }
                    if found.is_none() {
                        survivors.lock().expect("no panic").push(*mutant);
                    }
                }
            });
        }
    });
    let survivors = survivors.into_inner().expect("no panic");
    println!(
        "{} sites, {} mutants, {} survivors",
        census.recorder.keys().len(),
        mutants.len(),
        survivors.len()
    );
    let mut lines: Vec<_> = survivors.iter().map(ToString::to_string).collect();
    lines.sort();
    println!("{}", lines.join("\n"));
}
