//! The drive under test.
//!
//! Everything that determines a torque, without registers, files and clocks. The same code runs in the image on an
//! STM32F405-class microcontroller, in the native twin on a PC and in the bench's in-process device.
//!
//! | module | is |
//! |---|---|
//! | [`law`] | what a law is: parameters, signals, state, step; sets of laws |
//! | [`control`] | control laws, from encoder counts to a torque |
//! | [`Laws`] | the laws of Lashloop's own drive |
//! | [`contact`] | enable input, limit switches, home switch |
//! | [`direction`] | sign of an encoder or a power stage |
//! | [`power_stage`], [`actuator`] | from a torque to a duty; a stage that follows a drive |
//! | [`torque`] | from a torque to the duty of a bridge, by voltage or measured current |
//! | [`quadrature`] | hardware counters to the counts of the drive |
//! | [`drive`] | session, parameters and safety: a state machine with bytes and device time in, bytes and a torque out |
//! | [`store`] | parameters that survive power-off |
//! | `usb` (feature of that name) | the drive's own USB port, on any bus |
//! | `board` (feature `image`, Arm only) | the drive on the microcontroller, and `image!` |
//!
//! `no_std`, no allocation, no unsafe code. Floating-point functions come from `libm` only, so that every machine
//! computes the same bits.

#![no_std]
// The board takes peripherals and defines handlers of exceptions.
#![cfg_attr(not(all(feature = "image", target_os = "none")), forbid(unsafe_code))]
#![warn(missing_docs)]

#[cfg(test)]
extern crate std;

pub mod actuator;
#[cfg(all(feature = "image", target_os = "none"))]
pub mod board;
mod bridge_limits;
pub mod contact;
pub mod control;
pub mod direction;
pub mod drive;
pub mod input_filter;
pub mod law;
mod laws;
pub mod power_stage;
pub mod quadrature;
pub mod stage_mode;
pub mod store;
pub mod torque;
#[cfg(feature = "usb")]
pub mod usb;

pub use laws::Laws;
