//! A Linux guest with the kernel's own USB serial drivers, in QEMU: the bench in it runs as on a user's machine.
//!
//! | module | is |
//! |---|---|
//! | [`equipment`] | what `cargo xtask setup` unpacks for it, and whether that is all there |
//! | [`modules`] | the kernel's modules, in the order of their dependencies |
//! | [`cpio`] | the archive that the kernel unpacks as its first file system |
//! | [`request`] | the messages between a test and the guest's agent |
//! | `channel` | the channel that carries them, and its waits |
//! | [`guest`] | a running guest |
//! | [`adapter`] | a QEMU adapter that can be unplugged |
//!
//! The other side, the program `usb-guest`, is the guest's first process.

pub mod adapter;
mod channel;
pub mod cpio;
pub mod equipment;
pub mod guest;
pub mod modules;
pub mod request;
