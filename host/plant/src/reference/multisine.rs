//! Many frequencies at once, which repeat after a period.

use serde::Serialize;

use super::tones::Tones;

/// offset + amplitude times a sum of sines within +-1, with its tones at odd multiples of 1 / period.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Multisine {
    #[serde(flatten)]
    keys: MultisineKeys,
    #[serde(skip)]
    tones: Tones,
}

/// The numbers of a multisine.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MultisineKeys {
    /// Largest distance from the middle, in rad.
    pub amplitude_rad: f64,
    /// Time after which it repeats, in s.
    pub period_s: f64,
    /// Frequency of the lowest tone in Hz, rounded to an odd multiple of 1 / period.
    pub lowest_hz: f64,
    /// Frequency in Hz that no tone exceeds, unless it is below 1 / period.
    pub highest_hz: f64,
    /// Tones at most, at about equal ratios.
    pub lines: u32,
    /// Seed of their phases.
    pub phase_seed: u32,
    /// Middle in rad, where it begins.
    pub offset_rad: f64,
}

impl From<MultisineKeys> for Multisine {
    fn from(keys: MultisineKeys) -> Self {
        let [lowest, highest] = [keys.lowest_hz, keys.highest_hz].map(|it| it * keys.period_s);
        let harmonics = Tones::odd_harmonics(lowest, highest, keys.lines);
        Self { tones: Tones::new(keys.period_s, &harmonics, keys.phase_seed.into()), keys }
    }
}

impl Multisine {
    /// Its numbers.
    #[must_use]
    pub fn keys(&self) -> &MultisineKeys {
        &self.keys
    }

    /// Reference position in rad at a time of the run.
    #[must_use]
    pub fn position_rad(&self, t_s: f64) -> f64 {
        self.keys.offset_rad + self.keys.amplitude_rad * self.tones.at(t_s)
    }
}
