//! Errors of the torque of a drive in bench mode: the time until it acts, and the steps of the duty.

use lashloop_bench::scenario::Scenario;
use lashloop_identify::Instruments;

/// Time from a tick to its torque at the motor: the drive's step, and up to two periods of a PWM of 20 kHz.
pub const TORQUE_DELAY_US: u32 = 75;
/// Steps of the duty on the boards of the tree: 168 MHz at 20 kHz.
const DUTY_STEPS: f64 = 8_400.0;

/// What is given of the instruments of a scenario. In HIL mode the scenario states noise and eccentricity of its encoders.
/// In bench mode nothing is stated of them, and the torque has a delay and a step of its own; `torque_per_duty_nm` is the
/// scale of its power stage.
#[must_use]
pub fn instruments(scenario: &Scenario, torque_per_duty_nm: Option<f64>, delay_us: u32) -> Instruments {
    let encoders = &scenario.encoders;
    let [motor, load] = [encoders.motor_counts_per_rev, encoders.load_counts_per_rev];
    if scenario.run.mode.is_hil() {
        let noise_counts = [encoders.motor_noise_counts, encoders.load_noise_counts]
            .map(|own| own.unwrap_or(encoders.noise_counts));
        return Instruments {
            noise_counts: noise_counts[0].max(noise_counts[1]),
            encoder_error_rad: [encoders.motor_eccentricity_rad, encoders.load_eccentricity_rad],
            ..Instruments::exact(motor, load, scenario.plant.torque_delay_us())
        };
    }
    Instruments {
        encoder_error_rad: Instruments::UNSTATED_ENCODER_ERROR_RAD,
        torque_delay_deviation_us: delay_us.div_ceil(3),
        torque_step_nm: torque_per_duty_nm.map_or(0.0, |scale_nm| scale_nm.abs() / DUTY_STEPS),
        ..Instruments::exact(motor, load, delay_us)
    }
}
