//! The line to a specimen, with a virtual clock: a battery takes milliseconds.

use std::time::{Duration, Instant};

use lashloop_link::{Link, LinkError};

use super::description::{PARAMETERS, Table};
use super::{Character, Drive};
use crate::mutation::Sites;

/// Time of a byte on the line.
const BYTE_US: f64 = 2.0;

/// A specimen at the end of a line.
pub struct Specimen {
    drive: Drive,
    boot: Instant,
}

impl Specimen {
    pub fn new(sites: Sites) -> Self {
        Self::with(sites, &PARAMETERS)
    }

    /// With parameters of other types, defaults and ranges.
    pub fn with(sites: Sites, parameters: &'static Table) -> Self {
        Self { drive: Drive::new(sites, parameters, Character::USUAL), boot: Instant::now() }
    }

    /// Of another character.
    pub fn of(character: Character) -> Self {
        Self::like(Sites::new(None, None), character)
    }

    /// As [`Self::of`], with these sites.
    pub fn like(sites: Sites, character: Character) -> Self {
        Self { drive: Drive::new(sites, &PARAMETERS, character), boot: Instant::now() }
    }

    fn us(&self, instant: Instant) -> f64 {
        // Upwards, so that a wait never ends before its deadline.
        (instant.saturating_duration_since(self.boot).as_nanos() as f64 * 1e-3).ceil()
    }
}

impl Link for Specimen {
    fn inner(&mut self) -> Option<&mut dyn Link> {
        None
    }

    fn now(&mut self) -> Instant {
        self.boot + Duration::from_micros(self.drive.now_us as u64)
    }

    fn wait_until(&mut self, until: Instant) -> Result<(), LinkError> {
        let until_us = self.us(until);
        while self.drive.now_us < until_us {
            self.drive.pass_until(until_us);
        }
        Ok(())
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        for byte in bytes {
            let until_us = self.drive.now_us + BYTE_US;
            while self.drive.now_us < until_us {
                self.drive.pass_until(until_us);
            }
            let ended = self.drive.take(*byte);
            let loses = self.drive.character.loses_bursts;
            if ended && self.drive.at.flag("receiver", "the rest of a read is lost after a frame", loses) {
                break;
            }
        }
        Ok(())
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        let until_us = self.us(deadline);
        while self.drive.output.is_empty() && self.drive.now_us < until_us {
            self.drive.pass_until(until_us);
        }
        let count = self.drive.output.len().min(buffer.len());
        buffer[..count].copy_from_slice(&self.drive.output[..count]);
        self.drive.output.drain(..count);
        Ok(count)
    }

    fn discard_input(&mut self) -> Result<(), LinkError> {
        self.drive.output.clear();
        Ok(())
    }
}
