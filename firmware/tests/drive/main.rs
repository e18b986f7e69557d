//! The drive from the host's side: bytes in, bytes out, manual device time.

mod host;
mod parameters;
mod running;
mod safety;
mod session;
mod wraparound;
