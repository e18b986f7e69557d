//! What a program that the bench started is doing, as the kernel sees it.
//!
//! A program on a busy machine waits for a core, and one in a debugger is stopped. Neither is the drive's silence: a limit in
//! lockstep counts the time in which the program could have answered.

use std::fs;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Processor time that a program may take beyond the limit of an answer: emulators translate an image as they reach it.
const LONGEST_COMPUTATION: Duration = Duration::from_secs(5);

/// The processes of a group, all their threads together.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Activity {
    /// Whether a thread computes, waits for a core or for a disk, or is stopped.
    is_at_work: bool,
    /// Processor time so far.
    cpu: Duration,
    /// Time that threads have waited for a core.
    delay: Duration,
}

impl Activity {
    /// `None` if no process of the group is left.
    fn of_group(group: u32) -> Option<Self> {
        let processes = fs::read_dir("/proc").ok()?.flatten().filter_map(|entry| {
            let path = entry.path();
            (fields(&path)?.get(2)? == &group.to_string()).then_some(path)
        });
        let mut all = None;
        for thread in
            processes.flat_map(|path| fs::read_dir(path.join("task")).into_iter().flatten().flatten())
        {
            let all: &mut Self = all.get_or_insert_default();
            let Some(state) = fields(&thread.path()).and_then(|fields| fields.into_iter().next()) else {
                continue;
            };
            all.is_at_work |= ["R", "D", "T", "t"].contains(&&*state);
            let times = fs::read_to_string(thread.path().join("schedstat")).unwrap_or_default();
            let mut times =
                times.split(' ').map(|time| time.parse().map_or(Duration::ZERO, Duration::from_nanos));
            all.cpu += times.next().unwrap_or_default();
            all.delay += times.next().unwrap_or_default();
        }
        all
    }
}

/// The fields of a `stat` file after the name, which may contain any character: state, parent, group and so on.
fn fields(process: &Path) -> Option<Vec<String>> {
    let stat = fs::read_to_string(process.join("stat")).ok()?;
    Some(stat.rsplit_once(") ")?.1.split(' ').map(str::to_owned).collect())
}

/// Watches the processes of a group.
#[derive(Debug, Clone)]
pub struct Watch {
    group: u32,
    /// Whether the bench itself has stopped the group.
    is_suspended: Arc<AtomicBool>,
}

impl Watch {
    pub(super) fn new(group: u32) -> Self {
        Self { group, is_suspended: Arc::default() }
    }

    pub(super) fn suspended(&self, is_suspended: bool) {
        self.is_suspended.store(is_suspended, Ordering::Relaxed);
    }

    /// Time since its start in which the program computed or waited for a core, all threads together.
    #[must_use]
    pub fn busy(&self) -> Duration {
        Activity::of_group(self.group).map_or(Duration::ZERO, |it| it.cpu + it.delay)
    }

    /// The part of [`Self::busy`] in which it waited for a core.
    #[must_use]
    pub fn starved(&self) -> Duration {
        Activity::of_group(self.group).map_or(Duration::ZERO, |it| it.delay)
    }

    /// Begins a wait for the program.
    #[must_use]
    pub fn wait(&self) -> Wait<'_> {
        Wait { watch: self, at_first: None, was_idle: false, longest_computation: LONGEST_COMPUTATION }
    }
}

/// A wait for a program.
pub struct Wait<'a> {
    watch: &'a Watch,
    at_first: Option<Activity>,
    was_idle: bool,
    longest_computation: Duration,
}

impl Wait<'_> {
    /// Time between two calls of [`Self::is_excused`].
    pub const SLICE: Duration = Duration::from_millis(20);

    /// Whether the program is excused at the end of its time: it is at work or can't be, and the bench has not stopped it. It is
    /// not excused once it has slept at two looks in a row or computed for 5 s, or has ended.
    pub fn is_excused(&mut self) -> bool {
        if self.watch.is_suspended.load(Ordering::Relaxed) {
            return false;
        }
        let Some(now) = Activity::of_group(self.watch.group) else { return false };
        let computed = now.cpu.saturating_sub(self.at_first.get_or_insert(now).cpu);
        let is_idle = !now.is_at_work;
        let is_silent = is_idle && self.was_idle;
        self.was_idle = is_idle;
        !is_silent && computed < self.longest_computation
    }
}

#[cfg(test)]
mod tests {
    use std::os::unix::process::CommandExt;
    use std::process::{Child, Command, Stdio};
    use std::thread;
    use std::time::Instant;

    use rustix::process::{Pid, Signal, kill_process};

    use super::*;

    struct Running(Child);

    impl Running {
        /// Starts a program whose input stays open and empty.
        fn start(script: &str) -> (Self, Watch) {
            let mut command = Command::new("sh");
            command.args(["-c", script]).process_group(0).stdin(Stdio::piped());
            let child = command.spawn().unwrap();
            let watch = Watch::new(child.id());
            (Self(child), watch)
        }

        fn signal(&self, signal: Signal) {
            kill_process(Pid::from_child(&self.0), signal).unwrap();
        }
    }

    impl Drop for Running {
        fn drop(&mut self) {
            let _ = self.0.kill();
            let _ = self.0.wait();
        }
    }

    /// Looks until the program is no longer excused, for 20 s at most.
    fn excused_looks(watch: &Watch) -> usize {
        let mut wait = watch.wait();
        (0..1_000).take_while(|_| wait.is_excused()).inspect(|_| thread::sleep(Wait::SLICE)).count()
    }

    fn until(mut condition: impl FnMut() -> bool) {
        let give_up = Instant::now() + Duration::from_secs(30);
        while !condition() {
            assert!(Instant::now() < give_up);
            thread::sleep(Wait::SLICE);
        }
    }

    fn is_at_work(watch: &Watch) -> bool {
        Activity::of_group(watch.group).is_some_and(|it| it.is_at_work)
    }

    #[test]
    fn a_program_that_waits_for_input_is_not_excused() {
        let (_program, watch) = Running::start("sleep 1000");
        until(|| !is_at_work(&watch));
        assert_eq!(excused_looks(&watch), 1, "its answer may be on the way at the first look");
    }

    #[test]
    fn a_stopped_program_is_excused_unless_the_bench_has_stopped_it() {
        let (program, watch) = Running::start("read line");
        program.signal(Signal::STOP);
        until(|| is_at_work(&watch));
        let mut wait = watch.wait();
        assert!((0..10).all(|_| wait.is_excused()));
        watch.suspended(true);
        assert!(!wait.is_excused());
    }

    #[test]
    fn a_program_that_computes_is_excused_for_a_time() {
        let (_program, watch) = Running::start("while :; do :; done");
        until(|| is_at_work(&watch));
        let mut wait = Wait { longest_computation: Duration::from_millis(200), ..watch.wait() };
        assert!(wait.is_excused());
        until(|| !wait.is_excused());
        assert!(watch.busy() > wait.longest_computation);
    }

    #[test]
    fn a_program_that_has_ended_is_not_excused() {
        let (mut program, watch) = Running::start("exit");
        program.0.wait().unwrap();
        assert_eq!((excused_looks(&watch), watch.busy()), (0, Duration::ZERO));
    }
}
