//! Registers of TIM1, the timer of the modulation, which both families have at one place.

pub(crate) const CR1: u64 = 0x4001_0000;
pub(crate) const CR2: u64 = 0x4001_0004;
pub(crate) const CNT: u64 = 0x4001_0024;
pub(crate) const PSC: u64 = 0x4001_0028;
pub(crate) const ARR: u64 = 0x4001_002c;
pub(crate) const CCR1: u64 = 0x4001_0034;
pub(crate) const CCR4: u64 = 0x4001_0040;

/// In CR1: the counter runs, down, aligned to the centre.
pub(crate) const CEN: u64 = 1 << 0;
pub(crate) const DIR: u64 = 1 << 4;
pub(crate) const CMS: u64 = 0b11 << 5;

/// The timer's clock, MHz.
pub(crate) const CLOCK_MHZ: u64 = 168;
