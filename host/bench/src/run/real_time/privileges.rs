//! What a thread asks of the system so that it wakes in time. A refusal is reported and is no error.

use std::num::NonZeroU64;

use rustix::mm::{MlockAllFlags, mlockall};
use rustix::thread::{CpuSet, sched_setaffinity, set_current_timer_slack};
use thread_priority::{
    RealtimeThreadSchedulePolicy, ThreadPriority, ThreadSchedulePolicy, set_thread_priority_and_policy,
    thread_native_id,
};

use super::RealTime;

/// Asks for everything in the name of the calling thread and says what was refused.
#[must_use]
pub fn obtain(options: &RealTime) -> Vec<String> {
    let mut refused = Vec::new();
    let mut note = |what: String, error: Option<String>| {
        refused.extend(error.map(|error| format!("{what}: {error}")));
    };
    // Half of the default lateness is the 50 us by which the kernel may gather wake-ups.
    let slack = set_current_timer_slack(NonZeroU64::new(1));
    note("timer slack of 1 ns".to_owned(), slack.err().map(|error| error.to_string()));
    if let Some(core) = options.core {
        note(format!("core {core}"), stay_on(core).err());
    }
    if options.lock_memory {
        let locked = mlockall(MlockAllFlags::CURRENT | MlockAllFlags::FUTURE);
        note("locked memory".to_owned(), locked.err().map(|error| error.to_string()));
    }
    if let Some(priority) = options.fifo_priority {
        note(format!("SCHED_FIFO priority {priority}"), go_first(priority).err());
    }
    refused
}

fn stay_on(core: usize) -> Result<(), String> {
    if core >= CpuSet::MAX_CPU {
        return Err(format!("the system knows cores 0 to {}", CpuSet::MAX_CPU - 1));
    }
    let mut cores = CpuSet::new();
    cores.set(core);
    sched_setaffinity(None, &cores).map_err(|error| error.to_string())
}

fn go_first(priority: u8) -> Result<(), String> {
    let fifo = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    let priority = ThreadPriority::Crossplatform(priority.try_into()?);
    set_thread_priority_and_policy(thread_native_id(), priority, fifo).map_err(|error| format!("{error:?}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_system_does_not_have_is_refused_in_words() {
        let options = RealTime { core: Some(100_000), ..RealTime::default() };
        let refused = std::thread::spawn(move || obtain(&options)).join().expect("a thread");
        assert_eq!(refused.len(), 1, "{refused:?}");
        assert!(refused[0].starts_with("core 100000: "), "{refused:?}");
    }
}
