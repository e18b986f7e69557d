//! Frequency responses of a loop, measured: one run that excites it, and the responses that its counts and torques show.
//!
//! In HIL mode a torque is added to that of the drive, so the loop is measured as it is closed: sensitivity, open loop, plant. In
//! bench mode nothing but the reference can be moved; plant and closed loop are measured, and the drive can be a real one.

use std::f64::consts::TAU;
use std::fmt;
use std::path::Path;
use std::sync::Arc;

use lashloop_bench::atomic_file::WriteError;
use lashloop_bench::run::{Clock, End, Step, StepObserver, takes_torque};
use lashloop_bench::scenario::{RunMode, Scenario};
use lashloop_bench::supervisor::Supervisor;
use lashloop_plant::reference::{Interpolation, Reference, Table, TableError, Trapezoid};
use lashloop_protocol::EncoderCounts;
use lashloop_response::response::{Excited, Signals};
use lashloop_response::{Fit, FitError, Margins, Measured, Plan, PlanError, ResponseError};

use crate::execution::{ExecutionError, OpenDrive, Place};

/// Share of the steps that may be at a limit of the torque: above it a response is that of the limit too.
const MOST_SATURATED: f64 = 0.01;

/// Why a response can't be measured.
#[derive(thiserror::Error)]
pub enum BodeError {
    /// The plan is wrong.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The run failed.
    #[error(transparent)]
    Run(#[from] ExecutionError),
    /// The run ended before the measurement.
    #[error(
        "the run ended after {at_s:.2} s of {of_s:.2} s: {end}; take smaller --amplitudes, or correct what the drive reports"
    )]
    Ended {
        /// How it ended.
        end: String,
        /// When.
        at_s: f64,
        /// Duration of the measurement.
        of_s: f64,
    },
    /// The torque was at a limit.
    #[error(
        "the torque was at a limit of {limit_nm} N m in {share:.0} % of the steps, so the response is that of the limit; take \
         smaller --amplitudes"
    )]
    Saturated {
        /// The limit.
        limit_nm: f64,
        /// Share of the steps, in %.
        share: f64,
    },
    /// The signals show no response.
    #[error(transparent)]
    Response(#[from] ResponseError),
    /// The reference can't be made.
    #[error(transparent)]
    Reference(#[from] TableError),
}

/// As the message: a test that unwraps an error shows what to do.
impl fmt::Debug for BodeError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, out)
    }
}

/// A measurement at one amplitude.
#[derive(Debug)]
pub struct Measurement {
    /// Largest excitation, in N m or in rad.
    pub amplitude: f64,
    /// What was excited.
    pub excited: Excited,
    /// The responses.
    pub measured: Measured,
    /// Margins of the loop; none of them if the reference was excited.
    pub margins: Margins,
    /// The drive train that explains the plant, or why none does.
    pub fit: Result<Fit, FitError>,
    /// Root mean square of the twist theta_e - N0 theta_s while it was measured, in rad, with the N0 of the
    /// scenario, else the fitted one.
    pub twist_rms_rad: Option<f64>,
    /// Largest torque of the drive in N m.
    pub largest_torque_nm: f64,
    /// Duration in s.
    pub duration_s: f64,
    /// Whether the load turned in one direction while it was measured. If not, dry friction may have held it and the gap may
    /// have opened, and the fit is that of such a load.
    pub is_in_motion: bool,
}

/// The scenario that measures by this excitation, around this reference or in motion from there on.
fn exciting(
    scenario: &Scenario,
    plan: &Plan,
    values: &[f32],
    middle_rad: f64,
    speed_rad_s: f64,
) -> Result<Scenario, BodeError> {
    let mut exciting = scenario.clone();
    exciting.run.duration_s = values.len() as f64 * plan.period_s();
    exciting.expectations.clear();
    exciting.faults.clear();
    exciting.telemetry.every_steps = 0;
    exciting.telemetry.signals = None;
    exciting.reference = match exciting.run.mode {
        RunMode::Hil => {
            exciting.excitation_nm = Arc::from(values);
            if speed_rad_s == 0.0 {
                Reference::Constant { position_rad: middle_rad }
            } else {
                Reference::Trapezoid(Trapezoid {
                    from_rad: middle_rad,
                    // It never arrives.
                    to_rad: middle_rad + 2.0 * speed_rad_s * (exciting.run.duration_s + 1.0),
                    start_s: 0.0,
                    velocity_rad_s: speed_rad_s.abs(),
                    acceleration_rad_s2: speed_rad_s.abs(),
                })
            }
        }
        RunMode::Bench => {
            let mut text = "time_s,position_rad\n".to_owned();
            for (step, value) in values.iter().enumerate() {
                text +=
                    &format!("{:?},{:?}\n", step as f64 * plan.period_s(), middle_rad + f64::from(*value));
            }
            Reference::Table(Table::from_text(Path::new("excitation"), &text, Interpolation::Hold)?)
        }
    };
    Ok(exciting)
}

/// Measures the responses of a scenario. In HIL mode the load moves at `speed_rad_s` meanwhile; dry friction is then a constant, and
/// as long as the excitation is smaller, it keeps a gap closed. `None` if a signal of the user ends the run.
///
/// # Errors
/// The plan is wrong, the run failed or ended early, the torque was at its limit, or nothing is coherent.
pub fn measure(
    scenario: &Scenario,
    place: Place<'_>,
    clock: Clock,
    supervisor: &Supervisor,
    plan: &Plan,
    speed_rad_s: f64,
) -> Result<Option<Measurement>, BodeError> {
    let planned = plan.make()?;
    let excited = if scenario.run.mode.is_hil() { Excited::Torque } else { Excited::Reference };
    let mut collected = Collected::new(scenario);
    let mut drive = OpenDrive::open(scenario, place, clock, supervisor)?;
    // A torque as the reference keeps the load in motion. A position that isn't the start would twist the shaft on arrival.
    let middle_rad = match scenario.reference {
        Reference::Constant { position_rad } if takes_torque(scenario, &drive.device().session) => {
            position_rad
        }
        _ => scenario.plant.initial.load_position_rad,
    };
    let mut exciting = exciting(scenario, plan, &planned.values, middle_rad, speed_rad_s)?;
    let outcome = drive.run(&mut exciting, vec![&mut collected], None)?;
    let duration_s = exciting.run.duration_s;
    match outcome.end {
        End::Complete => {}
        End::Interrupted => return Ok(None),
        end => {
            let at_s = outcome.steps as f64 * plan.period_s();
            return Err(BodeError::Ended { end: end.to_string(), at_s, of_s: duration_s });
        }
    }
    let largest_torque_nm = collected.check_saturation(scenario, &planned.values, excited)?;
    let excitation: Vec<f64> = match excited {
        Excited::Torque => planned.values.iter().map(|it| f64::from(*it)).collect(),
        Excited::Reference => collected.reference_rad.clone(),
    };
    let [motor_rad, load_rad] = &collected.positions_rad;
    let signals = Signals {
        excitation: &excitation,
        torque_nm: &collected.torque_nm,
        motor_rad,
        load_rad,
        count_rad: collected.counts_per_rad.map(f64::recip),
    };
    let is_in_motion = moves(load_rad, signals.count_rad[1]);
    let measured = Measured::of(&planned, excited, signals)?;
    let delay_s = f64::from(scenario.plant.torque_delay_us()) / 1e6;
    let fit = Fit::of(&measured, plan.period_s(), delay_s);
    let of_fit = || fit.as_ref().ok().map(|fit| fit.train.reduction_ratio);
    let ratio = scenario.plant.number("reduction_ratio").or_else(of_fit);
    Ok(Some(Measurement {
        amplitude: plan.amplitude,
        excited,
        margins: Margins::of(&measured),
        measured,
        twist_rms_rad: ratio.map(|ratio| signals.twist_rms_rad(&planned, ratio)),
        fit,
        largest_torque_nm,
        duration_s,
        is_in_motion,
    }))
}

/// Counts of the load by which it may turn back and still counts as in motion, and by which it must get on.
const BACK_COUNTS: f64 = 3.0;
const ON_COUNTS: f64 = 100.0;

/// Whether a load turns in one direction in the second half of a run, in which it is measured in any case.
fn moves(load_rad: &[f64], count_rad: f64) -> bool {
    let half = &load_rad[load_rad.len() / 2..];
    let (Some(first), Some(last)) = (half.first(), half.last()) else { return false };
    let travel_rad = last - first;
    let mut furthest = f64::NEG_INFINITY;
    let mut back_rad = 0.0_f64;
    for position in half.iter().map(|it| it * travel_rad.signum()) {
        furthest = furthest.max(position);
        back_rad = back_rad.max(furthest - position);
    }
    travel_rad.abs() > ON_COUNTS * count_rad && back_rad <= BACK_COUNTS * count_rad
}

/// What a measurement needs of the steps.
struct Collected {
    /// Counts per rad of motor and load.
    counts_per_rad: [f64; 2],
    /// The latest reading of both encoders, and their counts since the first.
    readings: Option<[EncoderCounts; 2]>,
    counts: [i64; 2],
    positions_rad: [Vec<f64>; 2],
    torque_nm: Vec<f64>,
    reference_rad: Vec<f64>,
}

impl Collected {
    fn new(scenario: &Scenario) -> Self {
        let encoders = &scenario.encoders;
        let counts_per_rad = [encoders.motor_counts_per_rev, encoders.load_counts_per_rev];
        Self {
            counts_per_rad: counts_per_rad.map(|counts| f64::from(counts) / TAU),
            readings: None,
            counts: [0; 2],
            positions_rad: [Vec::new(), Vec::new()],
            torque_nm: Vec::new(),
            reference_rad: Vec::new(),
        }
    }

    /// The largest torque of the drive in N m.
    ///
    /// # Errors
    /// The drive or the plant limits too many of them.
    fn check_saturation(
        &self,
        scenario: &Scenario,
        excitation: &[f32],
        excited: Excited,
    ) -> Result<f64, BodeError> {
        let largest_nm = self.torque_nm.iter().fold(0.0_f64, |largest, it| largest.max(it.abs()));
        let steps = self.torque_nm.len().max(1) as f64;
        let check = |limit_nm: f64, at_limit: usize| {
            let share = at_limit as f64 / steps;
            if share <= MOST_SATURATED {
                Ok(())
            } else {
                Err(BodeError::Saturated { limit_nm, share: 100.0 * share })
            }
        };
        // A torque that isn't constant takes its very largest value again and again only at a limit.
        let varies = self.torque_nm.windows(2).any(|pair| pair[0] != pair[1]);
        if varies && excited == Excited::Torque {
            check(largest_nm, self.torque_nm.iter().filter(|it| it.abs() == largest_nm).count())?;
        }
        if let (Some(limit_nm), Excited::Torque) = (scenario.plant.number("torque_saturation_nm"), excited) {
            let sums = self.torque_nm.iter().zip(excitation).map(|(torque, d)| torque + f64::from(*d));
            check(limit_nm, sums.filter(|it| it.abs() > limit_nm).count())?;
        }
        Ok(largest_nm)
    }
}

impl StepObserver for Collected {
    fn step(&mut self, step: &Step) -> Result<(), WriteError> {
        if let Some(sample) = &step.sample {
            let now = [sample.motor_counts, sample.load_counts];
            let before = self.readings.replace(now).unwrap_or(now);
            for ((counts, now), before) in self.counts.iter_mut().zip(now).zip(before) {
                *counts += i64::from(now.wrapping_sub(before));
            }
        }
        for at in 0..2 {
            self.positions_rad[at].push(self.counts[at] as f64 / self.counts_per_rad[at]);
        }
        self.torque_nm.push(step.row.torque_nm);
        self.reference_rad.push(step.row.reference_rad);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_load_that_turns_back_is_not_in_motion() {
        const COUNT_RAD: f64 = 1e-3;
        let load = |ripple_rad: f64, speed: f64| -> Vec<f64> {
            (0..2_000)
                .map(|step| f64::from(step) * 1e-3)
                .map(|time_s| speed * time_s + ripple_rad * (20.0 * time_s).sin())
                .collect()
        };
        assert!(moves(&load(0.04, 1.0), COUNT_RAD), "its speed changes, and never its direction");
        assert!(moves(&load(0.04, -1.0), COUNT_RAD));
        assert!(!moves(&load(0.06, 1.0), COUNT_RAD), "it turns back by 7 counts");
        assert!(!moves(&load(0.01, 0.0), COUNT_RAD));
        assert!(!moves(&[], COUNT_RAD));
    }
}
