//! A quantity with its interval.

use serde::Serialize;

/// Probability that an interval contains the truth.
pub const CONFIDENCE: f64 = 0.95;
/// Standard deviations on each side of an interval. 1.96 would be those of a normal distribution; quantisation isn't noise,
/// and on random plants its errors are up to this much larger.
pub(crate) const DEVIATIONS: f64 = 3.2;

/// A value with the ends of its interval of [`CONFIDENCE`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Estimate {
    /// Most likely value.
    pub value: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// One quantity of the drive train.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Quantity {
    /// Name with its unit; that of the plant's key if the plant has one.
    pub name: &'static str,
    /// Unit; empty for a pure number.
    pub unit: &'static str,
    /// What it is.
    pub meaning: &'static str,
    /// `None` if the motions don't show it.
    pub estimate: Option<Estimate>,
    /// The key of the plant model `backlash-shaft`, or `None`.
    #[serde(skip)]
    pub plant_key: Option<&'static str>,
    /// Name in the parameters of a drive, or `None`.
    #[serde(skip)]
    pub drive_parameter: Option<&'static str>,
}
