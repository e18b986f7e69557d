//! A core for each worker thread of a harness, which its child processes inherit.
//!
//! An emulated board and its bench take turns. On one core a turn is a switch of context; on two, the kernel wakes an idle
//! core for every frame, and a run takes several times as long.

use std::sync::atomic::{AtomicUsize, Ordering};

use rustix::thread::{CpuSet, sched_getaffinity, sched_setaffinity};

/// Keeps the present thread, and the processes it starts, on one core; worker threads take the cores in turn.
///
/// A system that refuses costs time alone, so the error is dropped.
pub fn keep() {
    thread_local!(static KEPT: () = {
        let _ = choose();
    });
    KEPT.with(|()| ());
}

fn choose() -> rustix::io::Result<()> {
    static WORKERS: AtomicUsize = AtomicUsize::new(0);
    let allowed = sched_getaffinity(None)?;
    let cores: Vec<_> = (0..CpuSet::MAX_CPU).filter(|core| allowed.is_set(*core)).collect();
    let mut own = CpuSet::new();
    own.set(cores[WORKERS.fetch_add(1, Ordering::Relaxed) % cores.len()]);
    sched_setaffinity(None, &own)
}
