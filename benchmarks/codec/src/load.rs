//! How busy the machine is besides: a time without it means nothing.

use std::fs;
use std::thread;

/// The load of the last minute in numbers and in a word.
pub fn word() -> String {
    let cores = thread::available_parallelism().map_or(1, usize::from);
    let load =
        fs::read_to_string("/proc/loadavg").ok().and_then(|text| text.split(' ').next()?.parse::<f64>().ok());
    match load {
        None => "unknown".into(),
        // We are one of those who wait for a core.
        Some(load) if load <= cores as f64 => format!("quiet ({load} on {cores} cores)"),
        Some(load) => format!("busy ({load} on {cores} cores)"),
    }
}
