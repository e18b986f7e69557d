//! The electrical side of a motor at a bridge, before the mechanics of `lashloop commission`.

use std::path::Path;

use lashloop_bench::scenario::Scenario;
use lashloop_identify::Instruments;
use lashloop_identify::electrical::{ElectricalError, Motor, Stated, commission_motor};
use lashloop_identify::excitation::Limits;

use super::error::CliError;
use super::output::{outln, write_file};
use lashloop_hardware::commission::{MotionError, MotorOnDevice, OnDevice, pin_number};
use lashloop_hardware::identify::files::{MOTOR_FILE, motor_table, motor_toml};

/// Finds the electrical side of the motor and prints it; with a folder it writes it there.
pub(super) fn find(
    drive_train: &mut OnDevice<'_>,
    known: &Instruments,
    limits: &Limits,
    stated: Stated,
    out: Option<&Path>,
) -> Result<Motor, CliError> {
    let mut train = MotorOnDevice { train: drive_train, stated };
    let motor =
        commission_motor(&mut train, known, limits, MotorOnDevice::PERIOD_US, &stated).map_err(failed)?;
    outln!("{}\n", motor_table(&motor).trim_end());
    if let Some(folder) = out {
        let heading = "# Estimates of `lashloop`, for [bench] of a scenario.\n";
        write_file(&folder.join(MOTOR_FILE), &(heading.to_owned() + &motor_toml(&motor)))?;
        outln!("{}", folder.join(MOTOR_FILE).display());
    }
    Ok(motor)
}

/// The drive accepts no torque that its current limit doesn't make.
pub(super) fn check_torque(motor: &Motor, template: &Scenario, limits: &Limits) -> Result<(), CliError> {
    let current_a = pin_number(template, "current_limit_a");
    let constant_nm_a = motor.torque_constant_nm_a.map_or(f64::INFINITY, |it| it.value);
    let largest_nm = current_a * constant_nm_a;
    if limits.torque_nm <= largest_nm {
        return Ok(());
    }
    let problem = format!(
        "{} exceeds the {largest_nm:.3} N m of current_limit_a = {current_a} A at {constant_nm_a:.4} N m/A: lower it, or raise \
         current_limit_a",
        limits.torque_nm
    );
    Err(CliError::CommissionLimit { option: "--torque-limit", problem })
}

fn failed(error: ElectricalError<MotionError>) -> CliError {
    match error {
        ElectricalError::Motion(MotionError::Run(error)) => error.into(),
        ElectricalError::Motion(MotionError::Scenario(errors)) => CliError::Scenario(errors),
        other => CliError::Electrical(Box::new(other)),
    }
}
