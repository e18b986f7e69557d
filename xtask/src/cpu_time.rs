//! Processor time of chores: on a machine that others use, it compares better than wall-clock time.

use std::fs;
use std::time::Duration;

use rustix::param::clock_ticks_per_second;

/// Processor time of all child processes that have ended, theirs included; `None` without `/proc`.
pub(crate) fn of_children() -> Option<Duration> {
    let stat = fs::read_to_string("/proc/self/stat").ok()?;
    ticks_of_children(&stat)
        .map(|ticks| Duration::from_secs_f64(ticks as f64 / clock_ticks_per_second() as f64))
}

/// Fields 16 and 17, proc_pid_stat(5): user and system time of children. The name in field 2 may hold blanks.
fn ticks_of_children(stat: &str) -> Option<u64> {
    let (_, fields) = stat.rsplit_once(')')?;
    let mut fields = fields.split_whitespace().skip(13);
    let mut next = || fields.next()?.parse::<u64>().ok();
    Some(next()? + next()?)
}

const UNIT: &str = " s of CPU";

/// A line for the log that [`read`] reads.
pub(crate) fn line(time: Duration) -> String {
    format!("{:.0}{UNIT}", time.as_secs_f64())
}

/// The time in the last line of a chore before its sum, as text.
pub(crate) fn read(line: &str) -> Option<&str> {
    line.strip_prefix("all: ").filter(|time| time.ends_with(UNIT))
}

/// Whether the line is a time and nothing else.
pub(crate) fn is_time(line: &str) -> bool {
    line.ends_with(UNIT)
}

#[cfg(test)]
mod tests {
    use std::process::Command;
    use std::time::Duration;

    use super::{is_time, line, of_children, read, ticks_of_children};

    #[test]
    fn times_of_children_are_found_behind_a_name_with_blanks() {
        let stat = "7 (a ) b) S 1 7 7 0 -1 0 0 0 0 0 3 4 1200 34 20 0 1 0 99";
        assert_eq!(ticks_of_children(stat), Some(1234));
        assert_eq!(ticks_of_children("7 (a) S 1"), None);
    }

    #[test]
    fn a_child_that_computes_takes_time() {
        let before = of_children().expect("/proc");
        let busy =
            Command::new("sh").args(["-c", "i=0; while [ $i -lt 200000 ]; do i=$((i+1)); done"]).status();
        assert!(busy.expect("a shell").success());
        assert!(of_children().expect("/proc") > before);
    }

    #[test]
    fn a_time_is_read_as_it_is_written() {
        let text = line(Duration::from_millis(61_400));
        assert_eq!(read(&format!("all: {text}")), Some("61 s of CPU"));
        assert!(is_time(&format!("clippy: 31s, {text}")));
        assert_eq!(read("all: 3 passed, 0 failed"), None);
    }
}
