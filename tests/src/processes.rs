//! Other processes, as `/proc` shows them.

use std::fs;

use rustix::process::{Pid, Signal, kill_process};

/// State letter and parent of a process; `None` if no process has this number.
fn status(id: u32) -> Option<(char, u32)> {
    let line = fs::read_to_string(format!("/proc/{id}/stat")).ok()?;
    // The name in parentheses may contain any character, so we parse after its end.
    let (_, rest) = line.rsplit_once(") ")?;
    let mut fields = rest.split(' ');
    Some((fields.next()?.chars().next()?, fields.next()?.parse().ok()?))
}

/// Whether a process runs. A zombie does not.
#[must_use]
pub fn runs(id: u32) -> bool {
    status(id).is_some_and(|(state, _)| !matches!(state, 'Z' | 'X'))
}

/// The running children of a process.
#[must_use]
pub fn children(parent: u32) -> Vec<u32> {
    let processes = fs::read_dir("/proc").into_iter().flatten().flatten();
    processes
        .filter_map(|entry| entry.file_name().to_str()?.parse().ok())
        .filter(|&id| runs(id) && status(id).is_some_and(|(_, its_parent)| its_parent == parent))
        .collect()
}

/// First 15 bytes of the name of the program of a process, as the kernel keeps it.
#[must_use]
pub fn name(id: u32) -> String {
    fs::read_to_string(format!("/proc/{id}/comm")).unwrap_or_default().trim_end().to_owned()
}

/// Processor time of a process, user and system, in clock ticks.
#[must_use]
pub fn cpu_ticks(id: u32) -> u64 {
    let line = fs::read_to_string(format!("/proc/{id}/stat")).unwrap_or_default();
    // `utime` and `stime`, the 14th and 15th field; two fields precede the end of the name.
    let fields = line.rsplit_once(") ").map(|(_, rest)| rest.split(' ').skip(11).take(2));
    fields.into_iter().flatten().filter_map(|field| field.parse::<u64>().ok()).sum()
}

/// Sends a signal.
///
/// # Panics
/// No process has this number.
pub fn signal(id: u32, signal: Signal) {
    let pid = i32::try_from(id).ok().and_then(Pid::from_raw).expect("a process number");
    kill_process(pid, signal).unwrap_or_else(|error| panic!("process {id} can't be signalled: {error}"));
}
