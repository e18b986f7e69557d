//! Rig files: runs within the limits of a rig, the lock, absent hardware, and `lashloop rig check`. The hardware is a native
//! twin on a pseudo-terminal.

mod bench;
mod checks;
mod commission;
mod runs;
