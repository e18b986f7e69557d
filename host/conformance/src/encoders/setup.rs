//! Encoders, period and speed limits of a check, as near to the wished ones as the drive's ranges allow.
//!
//! Many drives have one fixed resolution and period. The checks count in counts per period, so they are equal for all
//! drives; only the speeds in rad/s differ.

use std::f64::consts::TAU;

use lashloop_protocol::sequence::LONGEST_GAP;

use super::encoder::Encoder;
use crate::assertion::{Failure, RuleResult, skip};
use crate::client::Client;
use crate::prelude::wire::*;
use crate::range::{holds, in_type_of, nearest_real, nearest_whole};

/// What a setup comes as near to as the drive's ranges allow, of motor and load.
pub(super) struct Wish {
    pub(super) period_us: u32,
    pub(super) counts_per_rev: [u32; 2],
    /// Speed limits in counts per period.
    pub(super) counts_per_period: [f64; 2],
}

/// For checks that allow any resolution. The period isn't that of most drives after power-up: a drive must use the one set.
///
/// The resolutions are coarse enough that the largest distance of a period fits the counter, and fine enough that one count is
/// a small part of it. They are different: a drive must not use one for the other. The speed limits are few enough counts for
/// gaps of 1000 periods, and between two whole numbers, so that rounding in the drive decides nothing.
pub(super) const COARSE: Wish =
    Wish { period_us: 800, counts_per_rev: [65_536, 40_000], counts_per_period: [500.5, 700.5] };
/// With another period and the resolutions of the other encoder.
pub(super) const OTHER: Wish = Wish { period_us: 3_000, counts_per_rev: [40_000, 65_536], ..COARSE };
/// With high speed limits, for long paths in few samples.
pub(super) const FAST: Wish = Wish { counts_per_period: [8_000.5, 7_000.5], ..COARSE };
/// With speed limits of less than a count per period: every count is fast.
pub(super) const SLOWEST: Wish = Wish { counts_per_period: [0.25, 0.25], ..COARSE };
/// As [`FAST`], with equal encoders.
pub(super) const EQUAL: Wish =
    Wish { counts_per_rev: [65_536; 2], counts_per_period: [8_000.5; 2], ..COARSE };

/// Largest unambiguous difference of two readings in either direction, less one count of quantisation.
pub(super) const UNAMBIGUOUS_COUNTS: f64 = (EncoderCounts::MAX.get() - 1) as f64;
/// Fraction of a bound within which a drive in single precision may round to its other side.
pub(super) const ROUNDING: f64 = 1e-5;

/// A parameter and its value.
pub(crate) type Setting = (&'static str, ParameterValue);

/// Resolution, period and speed limit of one encoder.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scale {
    period_us: u32,
    counts_per_rev: u32,
    pub(super) speed_limit_rad_s: f32,
}

impl Scale {
    fn fitted(client: &Client, encoder: Encoder, period_us: u32, wish: &Wish) -> Result<Self, Failure> {
        let wished = wish.counts_per_rev[encoder.index];
        let counts_per_rev = nearest_whole(client.parameter(encoder.counts_per_rev)?, wished)?;
        let mut scale = Self { period_us, counts_per_rev, speed_limit_rad_s: 0.0 };
        let wished_rad_s = scale.limit_rad_s(wish.counts_per_period[encoder.index]);
        scale.speed_limit_rad_s = nearest_real(client.parameter(encoder.speed_limit)?, wished_rad_s)?;
        Ok(scale)
    }

    /// Speed of one count per period, in rad/s.
    pub(super) fn speed_per_count_rad_s(&self) -> f64 {
        TAU / f64::from(self.counts_per_rev) / (f64::from(self.period_us) * 1e-6)
    }

    /// Speed limit that allows `counts_per_period`, in rad/s.
    pub(super) fn limit_rad_s(&self, counts_per_period: f64) -> f32 {
        (counts_per_period * self.speed_per_count_rad_s()) as f32
    }

    /// Counts per period at the speed limit.
    pub(super) fn counts_per_period(&self) -> f64 {
        f64::from(self.speed_limit_rad_s) / self.speed_per_count_rad_s()
    }
}

/// The settings of a drive for a check of its encoders.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Setup {
    /// In the order of [`Encoder::BOTH`].
    pub(super) scales: [Scale; 2],
    /// Instead of the default.
    pub(super) law: Option<u8>,
}

impl Setup {
    /// As [`COARSE`].
    pub(crate) fn coarse(client: &Client) -> Result<Self, Failure> {
        Self::of(client, &COARSE)
    }

    pub(super) fn of(client: &Client, wish: &Wish) -> Result<Self, Failure> {
        let period_us = nearest_whole(client.parameter("period_us")?, wish.period_us)?;
        let scale = |encoder| Scale::fitted(client, encoder, period_us, wish);
        Ok(Self { scales: [scale(Encoder::MOTOR)?, scale(Encoder::LOAD)?], law: None })
    }

    /// The angle of the load at these counts, in rad.
    pub(super) fn angle_rad(&self, counts: i64) -> f64 {
        counts as f64 * TAU / f64::from(self.scale(Encoder::LOAD).counts_per_rev)
    }

    pub(crate) const fn scale(&self, encoder: Encoder) -> Scale {
        self.scales[encoder.index]
    }

    /// Longest gap that the drive must accept, in periods, independent of its rounding.
    pub(crate) fn longest_gap(&self) -> u16 {
        self.scales
            .map(|it| ((1.0 - ROUNDING) * UNAMBIGUOUS_COUNTS / it.counts_per_period()) as u16)
            .into_iter()
            .fold(LONGEST_GAP, u16::min)
    }

    pub(crate) fn settings(&self) -> Vec<Setting> {
        let [motor, load] = self.scales;
        let law = self.law.map(|law| (CONTROLLER, U32(law.into())));
        let encoders = [
            ("period_us", U32(motor.period_us)),
            (Encoder::MOTOR.counts_per_rev, U32(motor.counts_per_rev)),
            (Encoder::LOAD.counts_per_rev, U32(load.counts_per_rev)),
            (Encoder::MOTOR.speed_limit, F32(motor.speed_limit_rad_s)),
            (Encoder::LOAD.speed_limit, F32(load.speed_limit_rad_s)),
        ];
        encoders.into_iter().chain(law).collect()
    }

    /// Skips the check if the drive's ranges exclude these settings. A drive may choose its ranges freely.
    pub(crate) fn allowed(&self, client: &Client) -> RuleResult {
        for (name, value) in self.settings() {
            let parameter = client.parameter(name)?;
            if !holds(parameter, in_type_of(parameter, value)) {
                return skip("not run: the drive's range excludes these speed limits");
            }
        }
        Ok(())
    }

    /// Starts a run with these settings. Skips the check if they leave positions ambiguous.
    pub(crate) fn start(&self, client: &mut Client) -> RuleResult {
        self.allowed(client)?;
        if self.longest_gap() == 0 {
            return skip(
                "not run: the encoders, period and speed limits of this drive leave positions ambiguous",
            );
        }
        client.running_if_consistent(&self.settings())
    }
}
