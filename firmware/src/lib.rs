//! The drive under test.
//!
//! Everything that decides a torque is here, free of registers, files and clocks, and is the same code in three places:
//! the image on an STM32F405-class microcontroller, the native twin on a PC, and the bench's in-process device.
//!
//! | module | is |
//! |---|---|
//! | [`control`] | the control laws of Merzouki and Cadiou, from encoder counts to a torque |
//! | [`drive`] | session, parameters, safety: a state machine with bytes and device time in, bytes out |
//! | `board` (in the image) | the drive on the microcontroller |
//!
//! `no_std`, no allocation, no unsafe code; floating-point functions only from `libm`, so that every place computes the
//! same bits.

#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod control;
pub mod drive;
