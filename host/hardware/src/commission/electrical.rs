//! A motor at the bridge of a device: held currents are a run.

use lashloop_bench::run::End;
use lashloop_bench::scenario::Scenario;
use lashloop_bench::scenario::controller::ParameterValue;
use lashloop_identify::electrical::{ElectricalTrain, HeldCurrents, MadeSteps, Stated, Steps};
use lashloop_identify::excitation::{Guard, Limits};
use lashloop_record::columns::Columns;
use lashloop_session::names::UnknownName;

use super::drive_train::{MotionError, OnDevice};
use super::scenario::{given, motion, pin_number, set_pin};
use super::trip::trip;
use crate::identify::record::{NoSeries, counts};

/// Control period of the electrical motions, in us.
const PERIOD_US: u32 = 1000;
/// Part of the stated inductance that the drive gets: a loop that is slow and stable, whatever the motor has.
const SLOW: f64 = 0.25;
/// Signals of the drive.
const TORQUE: &str = "measured_torque_nm";
const VOLTAGE: &str = "bridge_voltage_v";

/// What a scenario states of the motor, if a current sensor makes its torque in bench mode.
#[must_use]
pub fn stated(scenario: &Scenario, limits: &Limits) -> Option<Stated> {
    let by_current = ParameterValue::Text("current".to_owned());
    if scenario.run.mode.is_hil() || given(scenario, "torque_source") != Some(&by_current) {
        return None;
    }
    let number = |name| pin_number(scenario, name);
    let torque_constant_nm_a = number("torque_constant_nm_a");
    Some(Stated {
        resistance_ohm: number("motor_resistance_ohm"),
        inductance_h: number("motor_inductance_h"),
        torque_constant_nm_a,
        largest_a: number("current_limit_a").min(limits.torque_nm / torque_constant_nm_a),
        pulse_s: match given(scenario, "pwm_frequency_hz") {
            Some(ParameterValue::Number(frequency_hz)) => 1.0 / frequency_hz,
            _ => 1.0 / 20_000.0,
        },
    })
}

/// A motor whose currents are runs on a device.
pub struct MotorOnDevice<'a, 'b> {
    pub train: &'b mut OnDevice<'a>,
    pub stated: Stated,
}

impl MotorOnDevice<'_, '_> {
    /// Control period of its motions, in us.
    pub const PERIOD_US: u32 = PERIOD_US;

    fn scenario(&self, held: &HeldCurrents) -> Result<Scenario, MotionError> {
        let torque_nm: Vec<_> =
            held.current_a.iter().map(|it| it * self.stated.torque_constant_nm_a).collect();
        let table = self.train.folder.join(format!("{}.csv", held.name));
        let mut settings = motion(&torque_nm, f64::from(PERIOD_US) / 1e6, &table)
            .map_err(|source| MotionError::Table { path: table.clone(), source })?;
        settings.extend([
            format!("run.control_period_us={PERIOD_US}"),
            "bench.sample_every=1".to_owned(),
            "telemetry.every_steps=1".to_owned(),
            format!("telemetry.signals=[{TORQUE:?}, {VOLTAGE:?}]"),
        ]);
        let mut scenario = (self.train.scenario)(&settings)?;
        set_pin(&mut scenario, "motor_inductance_h", SLOW * self.stated.inductance_h);
        if let Some(largest_v) = held.largest_v {
            // What the bus has shows only while the bridge is on.
            let part = largest_v / pin_number(&scenario, "supply_v");
            let is_centred = given(&scenario, "stage_mode")
                != Some(&ParameterValue::Text("pwm-dir".to_owned()))
                && given(&scenario, "stage_mode") != Some(&ParameterValue::Text("two-pwm-brake".to_owned()));
            let duty = if is_centred { 0.5 + 0.5 * part } else { part };
            let duty_max = pin_number(&scenario, "duty_max").min(duty);
            set_pin(&mut scenario, "duty_max", duty_max);
        }
        Ok(scenario)
    }
}

impl ElectricalTrain for MotorOnDevice<'_, '_> {
    type Error = MotionError;

    fn hold(&mut self, held: &HeldCurrents, guard: Guard) -> Result<Option<MadeSteps>, MotionError> {
        let scenario = self.scenario(held)?;
        let Some(ran) = self.train.run(&held.name, None, scenario, guard)? else { return Ok(None) };
        let trip = trip(&ran.end);
        if ran.halt.is_none() && trip.is_none() && ran.end != End::Complete {
            return Err(MotionError::Ended { motion: held.name.clone(), end: ran.end.to_string() });
        }
        let no_series = |source| MotionError::Series { motion: held.name.clone(), source };
        let steps = steps(&ran.columns, self.stated.torque_constant_nm_a).map_err(no_series)?;
        let load_rad = column(&ran.columns, "load_position_rad").map_err(no_series)?;
        let counts_per_rev = self.train.instruments.load_counts_per_rev;
        let load_counts =
            [load_rad.first(), load_rad.last()].map(|it| it.map_or(0, |it| counts(*it, counts_per_rev)));
        Ok(Some(MadeSteps { steps, load_counts, halt: ran.halt, trip }))
    }
}

fn column<'a>(columns: &'a Columns, name: &str) -> Result<&'a [f64], NoSeries> {
    let known = || columns.signals().iter().map(|signal| &*signal.name);
    Ok(columns.get(name).ok_or_else(|| UnknownName::new("the record", "column", name, known()))?)
}

/// The steps of a record. A telemetry belongs to the step of its time.
fn steps(columns: &Columns, torque_constant_nm_a: f64) -> Result<Steps, NoSeries> {
    let period_s = f64::from(PERIOD_US) / 1e6;
    let torque = column(columns, &format!("drive.{TORQUE}"))?;
    let voltage = column(columns, &format!("drive.{VOLTAGE}"))?;
    let time_s = column(columns, "telemetry_time_s")?;
    let first_s = column(columns, "time_s")?.first().copied().unwrap_or_default();
    let mut current_a = vec![f64::NAN; time_s.len()];
    let mut voltage_v = current_a.clone();
    for (row, time_s) in time_s.iter().enumerate() {
        let at = ((time_s - first_s) / period_s).round();
        if at.is_finite() && at >= 0.0 && (at as usize) < current_a.len() {
            current_a[at as usize] = torque[row] / torque_constant_nm_a;
            voltage_v[at as usize] = voltage[row];
        }
    }
    let commanded_a = column(columns, "torque_nm")?.iter().map(|it| it / torque_constant_nm_a).collect();
    let motor_rad = column(columns, "motor_position_rad")?.to_vec();
    Ok(Steps { period_s, commanded_a, current_a, voltage_v, motor_rad })
}
