//! Load of the machine, without which a measured time is meaningless.

use std::fs;
use std::thread;

/// Load of the last minute, as a number and a word.
pub fn word() -> String {
    let cores = thread::available_parallelism().map_or(1, usize::from);
    let load =
        fs::read_to_string("/proc/loadavg").ok().and_then(|text| text.split(' ').next()?.parse::<f64>().ok());
    match load {
        None => "unknown".into(),
        // The load includes this process.
        Some(load) if load <= cores as f64 => format!("quiet ({load} on {cores} cores)"),
        Some(load) => format!("busy ({load} on {cores} cores)"),
    }
}
