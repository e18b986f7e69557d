//! A control law and a plant in one loop, without frames and without the drive's state machine.
//!
//! Row `k` holds the state at `k` periods, the torque applied from then on, and the dead-zone estimate in that torque.

use core::f64::consts::TAU;

use lashloop_firmware::control::sensing::{EncoderConfig, Sample, Sensing, SensingConfig};
use lashloop_firmware::law::{Measurement, Real};
use lashloop_plant::encoder::Encoder;
use lashloop_plant::{Start, Truth, TwoMass};

use crate::law::Law;
use crate::trajectory::Row;

/// Control period, length of the run and torque limit.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Timing {
    pub(crate) period_s: f64,
    pub(crate) periods: usize,
    pub(crate) torque_limit_nm: f64,
}

impl Timing {
    /// 25 s at 1 kHz without a limit, as in the recorded trajectories.
    pub(crate) const RECORDED: Self =
        Self { period_s: 1e-3, periods: 25_000, torque_limit_nm: f64::INFINITY };
}

/// Reference of the load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Reference {
    pub(crate) position_rad: f64,
    pub(crate) velocity_rad_s: f64,
    pub(crate) acceleration_rad_s2: f64,
}

/// The paper's reference: zero from the first instant.
pub(crate) fn regulate_to_zero(_time_s: f64) -> Reference {
    Reference { position_rad: 0.0, velocity_rad_s: 0.0, acceleration_rad_s2: 0.0 }
}

/// 0.5 rad at 0.05 Hz, for lost motion.
pub(crate) fn slow_sine(time_s: f64) -> Reference {
    let omega = TAU * 0.05;
    Reference {
        position_rad: 0.5 * (omega * time_s).sin(),
        velocity_rad_s: 0.5 * omega * (omega * time_s).cos(),
        acceleration_rad_s2: -0.5 * omega * omega * (omega * time_s).sin(),
    }
}

/// Sensors between the plant's truth and the law.
pub(crate) trait Sensors<F> {
    fn measure(&mut self, truth: &Truth, reference: Reference, applied_torque_nm: f64) -> Measurement<F>;
}

/// True positions and velocities, and the reference's true rates.
pub(crate) struct Ideal;

impl<F: Real> Sensors<F> for Ideal {
    fn measure(&mut self, truth: &Truth, reference: Reference, applied_torque_nm: f64) -> Measurement<F> {
        Measurement {
            motor_position_rad: F::from_f64(truth.motor_position_rad),
            motor_velocity_rad_s: F::from_f64(truth.motor_velocity_rad_s),
            load_position_rad: F::from_f64(truth.load_position_rad),
            load_velocity_rad_s: F::from_f64(truth.load_velocity_rad_s),
            twist_rad: F::from_f64(truth.twist_rad),
            reference_position_rad: F::from_f64(reference.position_rad),
            reference_velocity_rad_s: F::from_f64(reference.velocity_rad_s),
            reference_acceleration_rad_s2: F::from_f64(reference.acceleration_rad_s2),
            applied_torque_nm: F::from_f64(applied_torque_nm),
        }
    }
}

/// Two encoders and the drive's sensing.
pub(crate) struct Quantised<F> {
    encoders: [Encoder; 2],
    sensing: Sensing<F>,
}

impl<F: Real> Quantised<F> {
    pub(crate) fn new(
        counts: u32,
        motor_bandwidth_rad_s: f64,
        load_bandwidth_rad_s: f64,
        period_s: f64,
    ) -> Self {
        let encoders = [1, 2].map(|seed| Encoder::new(counts, 0.0, seed).expect("valid encoder"));
        let channel = |bandwidth| EncoderConfig {
            counts_per_revolution: counts,
            velocity_bandwidth_rad_s: F::from_f64(bandwidth),
        };
        let sensing = Sensing::new(SensingConfig {
            motor: channel(motor_bandwidth_rad_s),
            load: channel(load_bandwidth_rad_s),
            ratio: F::from_f64(3.0),
            period_s: F::from_f64(period_s),
        })
        .expect("valid sensing");
        Self { encoders, sensing }
    }
}

impl<F: Real> Sensors<F> for Quantised<F> {
    fn measure(&mut self, truth: &Truth, reference: Reference, applied_torque_nm: f64) -> Measurement<F> {
        let [motor, load] = &mut self.encoders;
        let sample = Sample {
            motor_counts: motor.read(truth.motor_position_rad) as i32,
            load_counts: load.read(truth.load_position_rad) as i32,
            reference_rad: F::from_f64(reference.position_rad),
            applied_torque_nm: F::from_f64(applied_torque_nm),
            elapsed_periods: 1,
        };
        self.sensing.step(&sample)
    }
}

/// Runs the loop. The first row is the start, the last one the state after `timing.periods`.
pub(crate) fn run<F: Real, P: TwoMass>(
    plant: &P,
    start: Start,
    law: &Law<F>,
    mut sensors: impl Sensors<F>,
    reference: impl Fn(f64) -> Reference,
    timing: Timing,
) -> Vec<Row> {
    let mut state = plant.initial_state(start);
    let mut law = law.clone();
    let mut applied_nm = 0.0;
    let mut rows = Vec::with_capacity(timing.periods + 1);
    for k in 0..=timing.periods {
        let time_s = k as f64 * timing.period_s;
        let truth = plant.truth(&state);
        let measurement = sensors.measure(&truth, reference(time_s), applied_nm);
        let output = law.step(&measurement);
        applied_nm = output.torque_nm.to_f64().clamp(-timing.torque_limit_nm, timing.torque_limit_nm);
        rows.push(Row {
            time_s,
            truth,
            torque_nm: applied_nm,
            dead_zone_estimate_rad: output.signals.dead_zone_estimate_rad.to_f64(),
        });
        plant.step(&mut state, applied_nm, timing.period_s).expect("the plant steps");
    }
    rows
}
