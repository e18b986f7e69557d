//! Encoders, period and speed limits of a check: as near to those wished as the drive takes them.
//!
//! Many drives have the one encoder and the one period that they were built with. What is tried is a number of counts in a
//! period, so a check is the same for all of them and only the figures in rad/s differ.

use std::f64::consts::TAU;

use lashloop_protocol::EncoderCounts;
use lashloop_protocol::enums::ParameterValue;
use lashloop_protocol::sequence::LONGEST_GAP;

use super::encoder::Encoder;

use crate::conformance::assertion::{Failure, RuleResult};
use crate::conformance::client::Client;
use crate::conformance::range::{holds, nearest_real, nearest_whole};

const PERIOD_US: u32 = 1_000;
/// Coarse enough that the largest speed in a period fits into a counter, fine enough that a count is a small part of it.
const COUNTS_PER_REV: u32 = 65_536;
/// What the speed limits allow: few enough for gaps of 1000 periods, many enough that one more is a small part of it.
const COUNTS_PER_PERIOD: f64 = 500.0;
/// Counts that a difference of readings tells apart either way, without the one that an encoder may show too much.
pub(super) const COUNTS_TOLD_APART: f64 = (EncoderCounts::MAX.get() - 1) as f64;
/// Within this share of a bound a drive that counts in single precision may round to its other side.
const ROUNDING: f64 = 1e-5;

type Setting = (&'static str, ParameterValue);

/// An encoder that a drive is set to.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scale {
    period_us: u32,
    counts_per_rev: u32,
    pub(super) speed_limit_rad_s: f32,
}

impl Scale {
    fn fitted(
        client: &Client,
        encoder: Encoder,
        period_us: u32,
        counts_per_rev: u32,
    ) -> Result<Self, Failure> {
        let counts_per_rev = nearest_whole(client.parameter(encoder.counts_per_rev())?, counts_per_rev)?;
        let mut scale = Self { period_us, counts_per_rev, speed_limit_rad_s: 0.0 };
        let wished_rad_s = scale.limit_rad_s(COUNTS_PER_PERIOD);
        scale.speed_limit_rad_s = nearest_real(client.parameter(encoder.speed_limit())?, wished_rad_s)?;
        Ok(scale)
    }

    /// What one count in a period means.
    pub(super) fn speed_per_count_rad_s(&self) -> f64 {
        TAU / f64::from(self.counts_per_rev) / (f64::from(self.period_us) * 1e-6)
    }

    /// The speed limit that allows so many counts in a period.
    pub(super) fn limit_rad_s(&self, counts_per_period: f64) -> f32 {
        (counts_per_period * self.speed_per_count_rad_s()) as f32
    }

    /// Counts in a period that the speed limit allows.
    pub(super) fn counts_per_period(&self) -> f64 {
        f64::from(self.speed_limit_rad_s) / self.speed_per_count_rad_s()
    }

    /// Counts in a period that are a jump, half as fast again as the limit if a difference of readings can show it.
    pub(super) fn jump_counts(&self) -> Result<i64, Failure> {
        // A drive takes one count off, and the fraction is lost here.
        let counts = ((1.5 * self.counts_per_period()) as i64 + 2).min(EncoderCounts::MAX.get().into());
        if (counts - 1) as f64 <= (1.0 + ROUNDING) * self.counts_per_period() {
            return Err(Failure::Skipped {
                reason: "not run: no reading is faster than the lowest speed limit that the drive takes",
            });
        }
        Ok(counts)
    }
}

/// All that a drive is set to before a check of its encoders.
#[derive(Debug, Clone, Copy)]
pub(in crate::conformance) struct Setup {
    pub(super) motor: Scale,
    pub(super) load: Scale,
}

impl Setup {
    /// For checks that any encoder will do for, if it isn't too fine.
    pub(in crate::conformance) fn coarse(client: &Client) -> Result<Self, Failure> {
        Self::of(client, COUNTS_PER_REV)
    }

    /// With encoders as near to this resolution as the drive takes them.
    pub(super) fn of(client: &Client, counts_per_rev: u32) -> Result<Self, Failure> {
        let period_us = nearest_whole(client.parameter("period_us")?, PERIOD_US)?;
        let scale = |encoder| Scale::fitted(client, encoder, period_us, counts_per_rev);
        Ok(Self { motor: scale(Encoder::Motor)?, load: scale(Encoder::Load)? })
    }

    pub(super) const fn scale(&self, encoder: Encoder) -> Scale {
        match encoder {
            Encoder::Motor => self.motor,
            Encoder::Load => self.load,
        }
    }

    pub(super) const fn scale_mut(&mut self, encoder: Encoder) -> &mut Scale {
        match encoder {
            Encoder::Motor => &mut self.motor,
            Encoder::Load => &mut self.load,
        }
    }

    /// Periods after which a sample is still taken, however the drive rounds.
    pub(in crate::conformance) fn longest_gap(&self) -> u16 {
        [self.motor, self.load]
            .map(|it| ((1.0 - ROUNDING) * COUNTS_TOLD_APART / it.counts_per_period()) as u16)
            .into_iter()
            .fold(LONGEST_GAP, u16::min)
    }

    pub(super) fn settings(&self) -> [Setting; 5] {
        use ParameterValue::{F32, U32};
        [
            ("period_us", U32(self.motor.period_us)),
            (Encoder::Motor.counts_per_rev(), U32(self.motor.counts_per_rev)),
            (Encoder::Load.counts_per_rev(), U32(self.load.counts_per_rev)),
            (Encoder::Motor.speed_limit(), F32(self.motor.speed_limit_rad_s)),
            (Encoder::Load.speed_limit(), F32(self.load.speed_limit_rad_s)),
        ]
    }

    /// Leaves the check out if the drive's ranges don't hold these settings: which ones it offers is its own affair.
    pub(super) fn allowed(&self, client: &Client) -> RuleResult {
        for (name, value) in self.settings() {
            if !holds(client.parameter(name)?, value) {
                return Err(Failure::Skipped { reason: "not run: the drive takes no such speed limits" });
            }
        }
        Ok(())
    }

    /// Greets, sets all this, arms and starts. Leaves the check out if no drive may arm with it.
    pub(in crate::conformance) fn start(&self, client: &mut Client) -> RuleResult {
        self.allowed(client)?;
        if self.longest_gap() == 0 {
            return Err(Failure::Skipped {
                reason: "not run: with the encoders, period and speed limits that the drive takes positions can't be told apart",
            });
        }
        client.running(&self.settings())
    }
}
