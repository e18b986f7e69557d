//! From one encoder sample to what the controller asks for: sensing and law, built from the parameters.

use core::f32::consts::TAU;

use lashloop_protocol::EncoderCounts;
use lashloop_protocol::enums::{ControllerId, DisturbingTorqueSource};
use lashloop_protocol::message::EncoderSample;
use lashloop_protocol::sequence::LONGEST_GAP;

use super::parameters::Parameters;
use crate::control::backlash_inverse::{BacklashInverse, BacklashInverseGains, BacklashInverseSetting};
use crate::control::cascade::CascadeGains;
use crate::control::dead_zone_observer::DeadZoneObserver;
use crate::control::law::{Law, LawState};
use crate::control::merzouki::{self, Merzouki};
use crate::control::merzouki_as_printed::MerzoukiAsPrinted;
use crate::control::nominal_model::NominalModel;
use crate::control::parameter::within;
use crate::control::pd::Pd;
use crate::control::sensing::{EncoderConfig, Sample, Sensing, SensingConfig, SensingState};
use crate::control::{ControlOutput, Controller, ParameterError};

/// Most counts that a difference of two readings tells apart from a whole turn of their range, either way, but for one:
/// an encoder may show one count more than it has turned.
const COUNTS_TOLD_APART: f32 = (EncoderCounts::MAX.get() - 1) as f32;

pub(super) struct ControlLoop {
    sensing: Sensing<f32>,
    sensing_state: SensingState<f32>,
    law: Law<f32>,
    law_state: LawState<f32>,
    /// Counters of motor and load: the readings without their wraps.
    previous_counts: Option<(i32, i32)>,
    longest_gap: u16,
    motor_rad_s_per_count: f32,
    load_rad_s_per_count: f32,
}

impl ControlLoop {
    /// # Errors
    /// Names the parameter that does not go with the others.
    pub(super) fn new(parameters: &Parameters) -> Result<Self, ParameterError> {
        let period_s = parameters.period_us as f32 * 1e-6;
        let sensing = Sensing::new(sensing_config(parameters, period_s))?;
        let law = law(parameters, period_s)?;
        let [motor_rad_s_per_count, load_rad_s_per_count] =
            [parameters.motor_counts_per_rev, parameters.load_counts_per_rev]
                .map(|counts| TAU / (counts as f32 * period_s));
        let mut longest_gap = LONGEST_GAP;
        for (name, limit_rad_s, rad_s_per_count) in [
            ("motor_speed_limit_rad_s", parameters.motor_speed_limit_rad_s, motor_rad_s_per_count),
            ("load_speed_limit_rad_s", parameters.load_speed_limit_rad_s, load_rad_s_per_count),
        ] {
            let fastest_rad_s = COUNTS_TOLD_APART * rad_s_per_count;
            within(name, limit_rad_s, 0.0, fastest_rad_s)?;
            longest_gap = longest_gap.min((fastest_rad_s / limit_rad_s) as u16);
        }
        Ok(Self {
            sensing_state: sensing.initial_state(),
            sensing,
            law_state: law.initial_state(),
            law,
            previous_counts: None,
            longest_gap,
            motor_rad_s_per_count,
            load_rad_s_per_count,
        })
    }

    /// Periods after which a sample is still taken.
    pub(super) fn longest_gap(&self) -> u16 {
        self.longest_gap
    }

    /// How fast motor and load must have turned at least since the last sample, in rad/s, either way; zero for the first
    /// one. A count is taken off: an encoder that shows one count more may have turned hardly at all.
    pub(super) fn speeds(&self, sample: &EncoderSample, periods: u32) -> (f32, f32) {
        let Some((motor, load)) = self.previous_counts else { return (0.0, 0.0) };
        let speed = |reading, counter, scale: f32| {
            moved(reading, counter).unsigned_abs().saturating_sub(1) as f32 * scale / periods as f32
        };
        (
            speed(sample.motor_counts, motor, self.motor_rad_s_per_count),
            speed(sample.load_counts, load, self.load_rad_s_per_count),
        )
    }

    /// One control step. `applied_torque_nm` is what the motor has been given since the last one.
    pub(super) fn step(
        &mut self,
        sample: &EncoderSample,
        periods: u32,
        applied_torque_nm: f32,
    ) -> ControlOutput<f32> {
        let (motor_counts, load_counts) = match self.previous_counts {
            None => (sample.motor_counts.get(), sample.load_counts.get()),
            Some((motor, load)) => (
                motor.wrapping_add(moved(sample.motor_counts, motor)),
                load.wrapping_add(moved(sample.load_counts, load)),
            ),
        };
        self.previous_counts = Some((motor_counts, load_counts));
        let measurement = self.sensing.step(
            &mut self.sensing_state,
            &Sample {
                motor_counts,
                load_counts,
                reference_rad: sample.reference_rad,
                applied_torque_nm,
                elapsed_periods: periods,
            },
        );
        self.law.step(&mut self.law_state, &measurement)
    }
}

/// Counts that an encoder has moved from where its counter stood to this reading.
fn moved(reading: EncoderCounts, counter: i32) -> i32 {
    reading.wrapping_sub(EncoderCounts::wrapping(counter.into()))
}

fn sensing_config(parameters: &Parameters, period_s: f32) -> SensingConfig<f32> {
    SensingConfig {
        motor: EncoderConfig {
            counts_per_revolution: parameters.motor_counts_per_rev,
            velocity_bandwidth_rad_s: parameters.motor_filter_rad_s,
        },
        load: EncoderConfig {
            counts_per_revolution: parameters.load_counts_per_rev,
            velocity_bandwidth_rad_s: parameters.load_filter_rad_s,
        },
        ratio: parameters.reduction_ratio,
        period_s,
    }
}

fn law(parameters: &Parameters, period_s: f32) -> Result<Law<f32>, ParameterError> {
    let model = NominalModel {
        motor_inertia_kg_m2: parameters.motor_inertia_kg_m2,
        motor_friction_nm_s_rad: parameters.motor_friction_nm_s_rad,
        load_inertia_kg_m2: parameters.load_inertia_kg_m2,
        load_friction_nm_s_rad: parameters.load_friction_nm_s_rad,
        ratio: parameters.reduction_ratio,
        stiffness_nm_rad: parameters.stiffness_nm_rad,
        dead_zone_rad: parameters.dead_zone_rad,
        motor_coulomb_nm: parameters.motor_coulomb_nm,
    };
    let gains = CascadeGains {
        motor_position: parameters.k_p1,
        motor_velocity: parameters.k_d1,
        load_position: parameters.k_p2,
        load_velocity: parameters.k_d2,
        elastic: parameters.k_1,
    };
    let observer = DeadZoneObserver {
        load_error_gain: parameters.k_21,
        elastic_error_gain: parameters.k_22,
        initial_rad: parameters.dead_zone_initial_rad,
        min_rad: 0.0,
        max_rad: parameters.dead_zone_max_rad,
    };
    // A byte without a name can't get past the parameter's range; the plain cascade is the harmless reading.
    let id = u8::try_from(parameters.controller).ok().and_then(ControllerId::from_byte);
    Ok(match id.unwrap_or(ControllerId::Pd) {
        ControllerId::Pd => Law::Pd(Pd::new(&model, gains)?),
        ControllerId::MerzoukiAsPrinted => {
            Law::MerzoukiAsPrinted(MerzoukiAsPrinted::new(&model, gains, observer, period_s)?)
        }
        ControllerId::Merzouki => {
            Law::Merzouki(Merzouki::new(&model, gains, observer, source(parameters), period_s)?)
        }
        ControllerId::BacklashInverse => {
            Law::BacklashInverse(backlash_inverse(parameters, &model, period_s)?)
        }
    })
}

fn backlash_inverse(
    parameters: &Parameters,
    model: &NominalModel<f32>,
    period_s: f32,
) -> Result<BacklashInverse<f32>, ParameterError> {
    let gains = BacklashInverseGains {
        approach_rate_1_s: parameters.approach_rate_1_s,
        approach_speed_rad_s: parameters.approach_speed_rad_s,
        load_velocity_gain_nm_s_rad: parameters.load_velocity_gain_nm_s_rad,
        load_integral_gain_nm_rad: parameters.load_integral_gain_nm_rad,
        load_integral_limit_nm: parameters.load_integral_limit_nm,
        transmitted_limit_nm: parameters.transmitted_limit_nm,
        gap_crossing_nm: parameters.gap_crossing_nm,
        twist_gain_nm_rad: parameters.twist_gain_nm_rad,
        twist_damping_nm_s_rad: parameters.twist_damping_nm_s_rad,
        load_observer_rad_s: parameters.load_observer_rad_s,
        identification_min_nm: parameters.identification_min_nm,
        arrival_band_rad: parameters.arrival_band_rad,
        hold_fraction: parameters.hold_fraction,
    };
    let setting = BacklashInverseSetting {
        momentum_observer_rad_s: parameters.momentum_observer_rad_s,
        dead_zone_initial_rad: parameters.dead_zone_initial_rad,
        dead_zone_max_rad: parameters.dead_zone_max_rad,
        load_resolution_rad: TAU / parameters.load_counts_per_rev as f32,
        torque_limit_nm: parameters.torque_limit_nm,
        period_s,
    };
    BacklashInverse::new(model, gains, setting)
}

fn source(parameters: &Parameters) -> merzouki::DisturbingTorqueSource<f32> {
    if parameters.disturbing_torque_source == DisturbingTorqueSource::Model as u32 {
        merzouki::DisturbingTorqueSource::NominalModel
    } else {
        merzouki::DisturbingTorqueSource::Observed { pole_rad_s: parameters.momentum_observer_rad_s }
    }
}
