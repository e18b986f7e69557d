//! The privileges by which a thread wakes in time. A refusal is reported and isn't an error.

use std::num::NonZeroU64;

use rustix::mm::{MlockAllFlags, mlockall};
use rustix::thread::{CpuSet, sched_getaffinity, sched_setaffinity, set_current_timer_slack};
use thread_priority::{
    RealtimeThreadSchedulePolicy, ThreadPriority, ThreadSchedulePolicy, set_thread_priority_and_policy,
    thread_native_id,
};

use crate::run::clock::RealTime;

/// Requests all options for the calling thread and returns what the system refused.
#[must_use]
pub fn obtain(options: &RealTime) -> Vec<String> {
    let mut refused = Vec::new();
    let mut note = |what: String, error: Option<String>| {
        refused.extend(error.map(|error| format!("{what}: {error}")));
    };
    // By default the kernel may delay wake-ups by 50 us, which is half of the usual lateness.
    let slack = set_current_timer_slack(NonZeroU64::new(1));
    note("timer slack of 1 ns".to_owned(), slack.err().map(|error| error.to_string()));
    if let Some(core) = options.core {
        note(format!("core {core}"), pin_to(core).err());
    }
    if options.lock_memory {
        let locked = mlockall(MlockAllFlags::CURRENT | MlockAllFlags::FUTURE);
        note("locked memory".to_owned(), locked.err().map(|error| error.to_string()));
    }
    if let Some(priority) = options.fifo_priority {
        note(format!("SCHED_FIFO priority {priority}"), set_fifo_priority(priority).err());
    }
    refused
}

/// The cores that this process may run on; none if the system doesn't say.
#[must_use]
pub fn usable_cores() -> Vec<usize> {
    let cores = sched_getaffinity(None).unwrap_or_default();
    (0..CpuSet::MAX_CPU).filter(|core| cores.is_set(*core)).collect()
}

fn pin_to(core: usize) -> Result<(), String> {
    if core >= CpuSet::MAX_CPU {
        return Err(format!("the system numbers cores from 0 to {}", CpuSet::MAX_CPU - 1));
    }
    let mut cores = CpuSet::new();
    cores.set(core);
    sched_setaffinity(None, &cores).map_err(|error| error.to_string())
}

fn set_fifo_priority(priority: u8) -> Result<(), String> {
    let fifo = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    let priority = ThreadPriority::Crossplatform(priority.try_into()?);
    set_thread_priority_and_policy(thread_native_id(), priority, fifo).map_err(|error| format!("{error:?}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_core_that_does_not_exist_is_refused_by_its_number() {
        let options = RealTime { core: Some(100_000), ..RealTime::default() };
        let refused = std::thread::spawn(move || obtain(&options)).join().expect("a thread");
        assert_eq!(refused.len(), 1, "{refused:?}");
        assert!(refused[0].starts_with("core 100000: "), "{refused:?}");
    }
}
