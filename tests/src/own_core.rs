//! A core for each worker of a harness, which its child processes inherit.
//!
//! An emulated board and its bench take turns. On one core a turn is a switch of context; on two, the kernel wakes an idle
//! core for every frame, and a run takes several times as long.

use std::env;
use std::sync::atomic::{AtomicUsize, Ordering};

use rustix::thread::{CpuSet, sched_getaffinity, sched_setaffinity};

/// Keeps the present thread, and the processes it starts, on one core; worker threads take the cores in turn. A test in a
/// process of its own is its harness's worker of number `LASHLOOP_WORKER`.
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
    let named = env::var("LASHLOOP_WORKER").ok().and_then(|number| number.parse().ok());
    let worker = named.unwrap_or_else(|| WORKERS.fetch_add(1, Ordering::Relaxed));
    let mut own = CpuSet::new();
    own.set(cores[worker % cores.len()]);
    sched_setaffinity(None, &own)
}
