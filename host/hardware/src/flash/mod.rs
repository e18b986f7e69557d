//! Firmware onto a drive: by a debug probe, or by the chip's own boot loader over USB or a UART.
//!
//! ```text
//! ELF ──▶ image ──▶ the first available method ──▶ its program ──▶ drive restarts ──▶ handshake ──▶ its build = the image's?
//! ```
//!
//! | module | is |
//! |---|---|
//! | [`way`] | the methods whose programs are installed |
//! | [`image`] | [`Image`]: the bytes for the flash, and the build, from an ELF |
//! | [`program`] | a program of another project, run with a limit of time and without its output |
//! | [`error`](mod@error) | [`FlashError`] |
//! | [`target`] | the chip as its loaders see it |
//! | [`probe`], [`dfu`], [`uart`] | one method each: whether it is available, and its command lines |
//! | [`writer`] | the choice of a method, and the writing |
//! | [`confirmation`] | the handshake after it |
//!
//! The programs read back what they wrote. "Flashed" is the drive's own report of the build, nothing less.

pub mod confirmation;
pub mod dfu;
pub mod error;
pub mod image;
pub mod probe;
pub mod program;
pub mod target;
pub mod uart;
pub mod way;
pub mod writer;

pub use error::FlashError;
pub use image::Image;
pub use target::Target;
