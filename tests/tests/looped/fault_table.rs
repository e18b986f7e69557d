//! The table of `docs/faults.md` on the native twin, and that it is complete.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use lashloop::scenario::Scenario;
use tests::fault_table::{self, rows};

/// Rows that wait for a lost answer need no core, so more of them run at a time than there are cores.
const AT_A_TIME: usize = 4;

#[test]
fn every_row_of_the_table_holds_on_the_native_twin() {
    let (rows, next) = (rows(), AtomicUsize::new(0));
    thread::scope(|scope| {
        for _ in 0..AT_A_TIME {
            scope.spawn(|| {
                while let Some(row) = rows.get(next.fetch_add(1, Ordering::Relaxed)) {
                    row.check_on("native");
                }
            });
        }
    });
}

#[test]
fn the_run_without_faults_passes() {
    fault_table::check_healthy_on("native");
}

#[test]
fn the_table_has_every_kind_of_fault() {
    let unknown = "title = \"x\"\n[[fault]]\nkind = \"x\"\nat_s = 0\n";
    let message = Scenario::from_str("x", unknown, &[]).expect_err("no such kind").to_string();
    let line = message.lines().find(|line| line.contains("fault.0.kind")).expect("a line about it");
    let (_, kinds) = line.split_once("must be ").expect("the kinds there are");
    let kinds: Vec<_> = kinds.split('"').skip(1).step_by(2).collect();
    assert!(kinds.len() >= 25, "{line}");
    let rows = rows();
    for kind in kinds {
        assert!(rows.iter().any(|row| row.kind() == kind), "docs/faults.md has no row for {kind}");
    }
}

#[test]
fn the_watchdog_takes_the_torque_away_within_its_own_time() {
    fault_table::check_watchdog_on("native");
}

#[test]
fn a_bench_that_pauses_in_lockstep_trips_no_watchdog() {
    fault_table::check_pause_on("native");
}
