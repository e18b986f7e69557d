//! The table of `docs/faults.md` on the native twin, and its completeness.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use lashloop_bench::scenario::Scenario;
use tests::fault_table::{self, Row, rows};

/// Rows that wait for a lost answer need no core, so we run more rows at a time than a small machine has cores.
const AT_A_TIME: usize = 4;

#[test]
fn every_row_of_the_table_holds_on_the_native_twin() {
    check_every_row_on("native");
}

#[test]
fn every_row_of_the_table_holds_in_process() {
    check_every_row_on("inproc");
}

fn check_every_row_on(device: &str) {
    let (rows, next) = (rows(), AtomicUsize::new(0));
    thread::scope(|scope| {
        for _ in 0..AT_A_TIME {
            scope.spawn(|| {
                while let Some(row) = rows.get(next.fetch_add(1, Ordering::Relaxed)) {
                    row.check_on(device);
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
    let line = message.lines().find(|line| line.contains("fault.0.kind")).expect("a line about the kind");
    let (_, kinds) = line.split_once("must be ").expect("the list of kinds");
    let kinds: Vec<_> = kinds.split('"').skip(1).step_by(2).collect();
    assert!(kinds.len() >= 25, "{line}");
    let rows = rows();
    for kind in kinds {
        assert!(rows.iter().any(|row| row.kind() == kind), "docs/faults.md has no row for {kind}");
        assert!(fault_table::explains(kind), "docs/faults.md does not explain {kind}");
    }
}

#[test]
fn the_watchdog_removes_the_torque_in_time() {
    fault_table::check_watchdog_on("inproc", 0.001);
}

#[test]
fn a_pause_in_lockstep_trips_no_watchdog() {
    fault_table::check_pause_on("native");
}

#[test]
fn an_inapplicable_fault_is_rejected_before_the_run() {
    let row = Row { fault: "kind = \"device-hang\"; at_s = 2.0; for_s = 0.5".to_owned(), ..Row::default() };
    let twin = tests::twin::Twin::start();
    let (ended, records) = row.run_on(&twin.device());
    let ended = ended.with_code(2);
    let want = "lashloop: fault device-hang at 2 s can't be applied here: only a drive that the bench runs can be suspended: \
                use --device inproc, native or qemu, or link-stall\n";
    assert_eq!(ended.stderr, want);
    for file in ["record.json", "run.mcap", "summary.json"] {
        assert!(!records.path(file).exists(), "{file} of a run that did not begin");
    }
}
