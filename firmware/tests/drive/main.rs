//! The drive as a host meets it: bytes in, bytes out, device time by hand.

mod host;
mod parameters;
mod running;
mod safety;
mod session;
mod wrapping;
