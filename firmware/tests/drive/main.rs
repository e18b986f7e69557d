//! The drive from the host's side: bytes in, bytes out, manual device time.

mod bench;
mod bench_arming;
mod bench_faults;
mod bench_limits;
mod capture;
mod growth;
mod host;
mod line;
mod lists;
mod live;
mod loader;
mod parameters;
mod pin_host;
mod pinned_torques;
mod running;
mod safety;
mod session;
mod telemetry;
mod wraparound;
