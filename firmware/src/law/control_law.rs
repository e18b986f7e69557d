//! The interface of a control law to the drive.

use super::drive_parameters::DriveParameters;
use super::measurement::{ControlOutput, Measurement};
use super::parameter_error::ParameterError;
use super::parameter_group::ParameterGroups;
use super::signal::Signals;

/// A control law: parameters in, then one torque for each measurement.
///
/// The value is the law with its constants and its state. The drive builds it on `Arm`, steps it once for each sample
/// while running, and drops it at the end of the run. A law has no clock, no input and no output besides these: equal
/// measurements give equal torques on every machine. Use [`Real`](crate::law::Real) or `libm` for functions such as
/// `tanh`; the operators of `f32` are exact everywhere.
///
/// The drive checks what comes before and after a law: range and type of each parameter, plausible encoder speeds, a
/// finite torque within `torque_limit_nm`, and the watchdog. A law can't reach the motor.
pub trait ControlLaw: Sized {
    /// Name in scenarios and records, at most 28 bytes; lower case with hyphens by convention.
    const NAME: &'static str;

    /// What the host may set: one group of [`parameters!`](crate::parameters), a tuple of groups, or `()`.
    type Parameters: ParameterGroups;

    /// What telemetry may carry: a struct of [`signals!`](crate::signals), or `()`.
    type Signals: Signals;

    /// Whether the reference is a torque and not a position of the load: then nothing says whether a motor runs away.
    const TAKES_TORQUE: bool = false;

    /// Names of the parameters that the law takes while the drive is armed or running. One that several laws have is live if
    /// each of them takes it.
    const LIVE: &'static [&'static str] = &[];

    /// The law in its initial state. The values are in their ranges; `drive` has the period, the encoders and the torque
    /// limit.
    ///
    /// # Errors
    /// A parameter beyond a limit that other parameters set; [`ParameterError::at_most`] checks one. `Arm` is then
    /// rejected as inconsistent, and the answer names the parameter by its index.
    fn new(parameters: Self::Parameters, drive: &DriveParameters) -> Result<Self, ParameterError>;

    /// Takes a new value of a parameter of [`Self::LIVE`], in force from the next step; all others are as in [`Self::new`]. A
    /// law that names such parameters implements it.
    ///
    /// # Errors
    /// As in [`Self::new`]. The law is then as before, and the drive keeps the value before.
    fn update(&mut self, _parameters: &Self::Parameters) -> Result<(), ParameterError> {
        Ok(())
    }

    /// Torque and signals for one sample. A torque that is not finite is a fault of the drive.
    fn step(&mut self, measurement: &Measurement<f32>) -> ControlOutput<Self::Signals>;
}
