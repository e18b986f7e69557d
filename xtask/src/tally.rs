//! The sum of a chore: every test counts one, and so does every other step.

use std::process::ExitCode;

use anyhow::Result;

use crate::test_counts::Counts;

/// A step that fails doesn't keep later steps from running: one call shows everything that is wrong.
#[derive(Default)]
pub(crate) struct Tally(Counts);

impl Tally {
    pub(crate) fn step(&mut self, name: &str, run: impl FnOnce() -> Result<()>) {
        self.counted(name, || run().map(|()| Counts { passed: 1, failed: 0 }));
    }

    pub(crate) fn counted(&mut self, name: &str, run: impl FnOnce() -> Result<Counts>) {
        println!("== {name}");
        match run() {
            Ok(counts) => self.add(counts),
            Err(error) => {
                println!("{name} failed: {error:#}");
                self.add(Counts { passed: 0, failed: 1 });
            }
        }
    }

    pub(crate) fn add(&mut self, counts: Counts) {
        self.0 += counts;
    }

    /// Prints the sum alone on the last line.
    pub(crate) fn finish(self) -> ExitCode {
        println!("{}", self.0);
        if self.0.failed == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
    }
}
