//! The drive from the host's side: bytes in, bytes out, manual device time.

mod host;
mod parameters;
mod pinned_torques;
mod running;
mod safety;
mod session;
mod telemetry;
mod wraparound;
