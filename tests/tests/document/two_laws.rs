//! A drive with two laws that differ in their signals. Together with those of the drive, the second one has more signals than
//! one telemetry message holds.

use lashloop_firmware::law::{
    ControlLaw, ControlOutput, DriveParameters, DriveSignals, Measurement, ParameterError, Signals,
};
use lashloop_protocol::message::Subscribe;

/// Index of the first signal that only the second law has.
pub const FIRST_OF_SECOND_LAW: usize = DriveSignals::TABLE.len();

/// A subscription to a signal that the first law lacks.
pub const OF_THE_SECOND_LAW: Subscribe = Subscribe { signals: 1 << FIRST_OF_SECOND_LAW, every: 1 };

lashloop_firmware::signals! {
    pub struct ManySignals {
        a: "", b: "", c: "", d: "", e: "", f: "", g: "", h: "", i: "", j: "", k: "", l: "", m: "",
    }
}

/// A law without parameters and signals. Torque zero.
pub struct Quiet;

/// A law with 13 signals: 0, 1, 2, and so on. Torque zero.
pub struct Talkative;

impl ControlLaw for Quiet {
    const NAME: &'static str = "quiet";
    type Parameters = ();
    type Signals = ();

    fn new((): (), _: &DriveParameters) -> Result<Self, ParameterError> {
        Ok(Self)
    }

    fn step(&mut self, _: &Measurement<f32>) -> ControlOutput<()> {
        ControlOutput { torque_nm: 0.0, signals: () }
    }
}

impl ControlLaw for Talkative {
    const NAME: &'static str = "talkative";
    type Parameters = ();
    type Signals = ManySignals;

    fn new((): (), _: &DriveParameters) -> Result<Self, ParameterError> {
        Ok(Self)
    }

    fn step(&mut self, _: &Measurement<f32>) -> ControlOutput<ManySignals> {
        let [a, b, c, d, e, f, g, h, i, j, k, l, m] = std::array::from_fn(|at| at as f32);
        ControlOutput { torque_nm: 0.0, signals: ManySignals { a, b, c, d, e, f, g, h, i, j, k, l, m } }
    }
}

lashloop_firmware::laws! {
    pub enum TwoLaws {
        Quiet(Quiet),
        Talkative(Talkative),
    }
}
