//! What a program that the bench started is doing, as the kernel sees it.
//!
//! A program on a busy machine waits for a core, and one in a debugger is stopped. Neither is the drive's silence: a limit in
//! lockstep counts the time in which the program could have answered.

use std::fs;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Processor time that a program may take beyond the limit of an answer: emulators translate an image as they reach it.
const LONGEST_COMPUTATION: Duration = Duration::from_secs(5);
/// Time after which a program counts as silent that has computed for less than [`LEAST_SHARE`] of it. An idle emulator wakes
/// every millisecond, and on a busy machine it then waits for a core at every look.
const LONGEST_IDLING: Duration = Duration::from_secs(2);
/// As a divisor. An idle emulator takes 1/11 of a core; a program that computes gets more even among 12 of its priority on two
/// cores.
const LEAST_SHARE: u32 = 8;

/// The processes of a group, all their threads together.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Activity {
    /// Whether a thread computes or waits for a core.
    is_at_work: bool,
    /// Whether a thread is stopped or waits for a disk.
    is_held: bool,
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
            all.is_at_work |= state == "R";
            all.is_held |= ["D", "T", "t"].contains(&&*state);
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
    /// The first look since the program was last held.
    at_first: Option<(Instant, Activity)>,
    was_idle: bool,
    longest_computation: Duration,
}

impl Wait<'_> {
    /// Time between two calls of [`Self::is_excused`].
    pub const SLICE: Duration = Duration::from_millis(20);

    /// Whether the program is excused at the end of its time: it is at work or can't be, and the bench has not stopped it. It is
    /// not excused once it has slept at two looks in a row, or computed for less than 1/8 of more than 2 s, or for 5 s, or has
    /// ended.
    pub fn is_excused(&mut self) -> bool {
        if self.watch.is_suspended.load(Ordering::Relaxed) {
            return false;
        }
        Activity::of_group(self.watch.group)
            .is_some_and(|activity| self.is_excused_at(Instant::now(), activity))
    }

    fn is_excused_at(&mut self, now: Instant, activity: Activity) -> bool {
        if activity.is_held {
            (self.at_first, self.was_idle) = (None, false);
            return true;
        }
        let (since, first) = *self.at_first.get_or_insert((now, activity));
        let (waited, computed) = (now - since, activity.cpu.saturating_sub(first.cpu));
        let is_idle = !activity.is_at_work;
        let is_silent = is_idle && self.was_idle;
        self.was_idle = is_idle;
        let idles = waited > LONGEST_IDLING && computed * LEAST_SHARE < waited;
        !is_silent && !idles && computed < self.longest_computation
    }
}

#[cfg(test)]
mod tests {
    use std::os::unix::process::CommandExt;
    use std::process::{Child, Command, Stdio};
    use std::thread;

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

    /// How long a program is excused that computes for this share of the time and waits for a core at every look, in s.
    fn excused_s(share: f64) -> f64 {
        let watch = Watch::new(0);
        let (mut wait, started) = (watch.wait(), Instant::now());
        let looks = (0..1_000).map(|look| Wait::SLICE * look);
        let excused = looks.take_while(|elapsed| {
            let cpu = elapsed.mul_f64(share);
            let activity = Activity { is_at_work: true, cpu, ..Activity::default() };
            wait.is_excused_at(started + *elapsed, activity)
        });
        excused.last().unwrap_or_default().as_secs_f64()
    }

    #[test]
    fn an_idle_emulator_on_a_busy_machine_is_silent_after_2_s_and_a_starved_one_is_not() {
        assert_eq!(excused_s(0.09), 2.0);
        let starved = 2.0 / 12.0;
        assert!(excused_s(starved) > 15.0, "{} s", excused_s(starved));
        assert!((4.9..5.1).contains(&excused_s(1.0)), "{} s", excused_s(1.0));
    }

    #[test]
    fn a_program_is_excused_for_as_long_as_it_is_held() {
        let watch = Watch::new(0);
        let (mut wait, started) = (watch.wait(), Instant::now());
        let held = Activity { is_held: true, ..Activity::default() };
        let at_work = Activity { is_at_work: true, ..Activity::default() };
        assert!((0..60).all(|second| wait.is_excused_at(started + Duration::from_secs(second), held)));
        assert!(wait.is_excused_at(started + Duration::from_secs(61), at_work), "its time begins anew");
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
        let (_program, watch) = Running::start("exec sleep 1000");
        until(|| !is_at_work(&watch));
        assert_eq!(excused_looks(&watch), 1, "its answer may be on the way at the first look");
    }

    #[test]
    fn a_stopped_program_is_excused_unless_the_bench_has_stopped_it() {
        let (program, watch) = Running::start("read line");
        program.signal(Signal::STOP);
        until(|| Activity::of_group(watch.group).is_some_and(|it| it.is_held));
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
