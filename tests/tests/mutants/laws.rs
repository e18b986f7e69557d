//! The laws of the drive under test: that of a complete drive, and one with as many signals as exercise every rule.

use lashloop_firmware::control::pd::Pd;
use lashloop_firmware::law::{ControlLaw, ControlOutput, DriveParameters, Measurement, ParameterError};

lashloop_firmware::laws! {
    /// Two laws with different signals.
    pub enum TestLaws {
        /// A law of the Lashloop drive.
        Pd(Pd),
        /// More signals than a telemetry holds.
        ManySignals(ManySignals),
    }
}

lashloop_firmware::signals! {
    /// Fourteen signals: one more than a telemetry holds.
    pub struct Fourteen {
        a_rad: "rad",
        b_rad: "rad",
        c_rad: "rad",
        d_rad: "rad",
        e_rad: "rad",
        f_rad: "rad",
        g_rad: "rad",
        h_rad: "rad",
        i_rad: "rad",
        j_rad: "rad",
        k_rad: "rad",
        l_rad: "rad",
        m_rad: "rad",
        n_rad: "rad",
    }
}

/// A spring to the reference.
pub struct ManySignals;

impl ControlLaw for ManySignals {
    const NAME: &'static str = "many-signals";
    type Parameters = ();
    type Signals = Fourteen;

    fn new((): (), _drive: &DriveParameters) -> Result<Self, ParameterError> {
        Ok(Self)
    }

    fn step(&mut self, measurement: &Measurement<f32>) -> ControlOutput<Fourteen> {
        let error_rad = measurement.reference_position_rad - measurement.load_position_rad;
        let signals = Fourteen {
            a_rad: error_rad * 1.0,
            b_rad: error_rad * 2.0,
            c_rad: error_rad * 3.0,
            d_rad: error_rad * 4.0,
            e_rad: error_rad * 5.0,
            f_rad: error_rad * 6.0,
            g_rad: error_rad * 7.0,
            h_rad: error_rad * 8.0,
            i_rad: error_rad * 9.0,
            j_rad: error_rad * 10.0,
            k_rad: error_rad * 11.0,
            l_rad: error_rad * 12.0,
            m_rad: error_rad * 13.0,
            n_rad: error_rad * 14.0,
        };
        ControlOutput { torque_nm: error_rad, signals }
    }
}
