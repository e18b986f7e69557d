//! The parameters as the configuration of sensing and control law.

use core::f32::consts::TAU;

use lashloop_protocol::enums::{ControllerId, DisturbingTorqueSource};

use super::parameters::Parameters;
use crate::control::ParameterError;
use crate::control::backlash_inverse::{BacklashInverse, BacklashInverseGains, BacklashInverseSetting};
use crate::control::cascade::CascadeGains;
use crate::control::dead_zone_observer::DeadZoneObserver;
use crate::control::law::Law;
use crate::control::merzouki::{self, Merzouki};
use crate::control::momentum_observer::MomentumObserver;
use crate::control::nominal_model::NominalModel;
use crate::control::pd::Pd;
use crate::control::sensing::{EncoderConfig, SensingConfig};

pub(super) fn sensing_config(parameters: &Parameters, period_s: f32) -> SensingConfig<f32> {
    let encoder = |counts_per_revolution, velocity_bandwidth_rad_s| EncoderConfig {
        counts_per_revolution,
        velocity_bandwidth_rad_s,
    };
    SensingConfig {
        motor: encoder(parameters.motor_counts_per_rev, parameters.motor_filter_rad_s),
        load: encoder(parameters.load_counts_per_rev, parameters.load_filter_rad_s),
        ratio: parameters.reduction_ratio,
        period_s,
    }
}

pub(super) fn law(parameters: &Parameters, period_s: f32) -> Result<Law<f32>, ParameterError> {
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
        max_rad: parameters.dead_zone_max_rad,
    };
    let merzouki = |source| Merzouki::new(&model, gains, observer, source, period_s).map(Law::Merzouki);
    Ok(match choice("controller", parameters.controller, ControllerId::ALL)? {
        ControllerId::Pd => Law::Pd(Pd::new(&model, gains)),
        ControllerId::Merzouki => merzouki(source(parameters, &model, period_s)?)?,
        ControllerId::MerzoukiAsPrinted => merzouki(merzouki::DisturbingTorqueSource::AsPrinted)?,
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

fn source(
    parameters: &Parameters,
    model: &NominalModel<f32>,
    period_s: f32,
) -> Result<merzouki::DisturbingTorqueSource<f32>, ParameterError> {
    let source = parameters.disturbing_torque_source;
    Ok(match choice("disturbing_torque_source", source, DisturbingTorqueSource::ALL)? {
        DisturbingTorqueSource::Model => merzouki::DisturbingTorqueSource::NominalModel,
        DisturbingTorqueSource::Observed => merzouki::DisturbingTorqueSource::Observed(
            MomentumObserver::new(model, parameters.momentum_observer_rad_s, period_s),
        ),
    })
}

/// The value of this number in a list of the protocol, whose numbers begin at 1.
fn choice<T: Copy>(name: &'static str, number: u32, list: &[T]) -> Result<T, ParameterError> {
    let index = (number as usize).wrapping_sub(1);
    list.get(index).copied().ok_or(ParameterError {
        name,
        value: number as f32,
        max: list.len() as f32,
        given_by: "the protocol's list of values",
    })
}
