//! A run: samples to torques, section 7 of the page.

use std::f64::consts::TAU;

use lashloop_protocol::enums::{FaultCode, ParameterValue};
use lashloop_protocol::message::{EncoderSample, TorqueAnswer};

use super::description::{
    CONTROLLER, COUNTS, DAMPING, GAIN, INTEGRAL_GAIN, OUTPUT, PARAMETER_COUNT, PERIOD, SIGNALS, SPEED_LIMITS,
    TORQUE_LIMIT, Table, WATCHDOG,
};
use crate::mutation::{Sites, Width};

const ENCODERS: [&str; 2] = ["motor", "load"];
const HALF: i64 = 1 << 23;
/// Half the ranges of positions in 26 and 27 bits, which are too few.
const FAR: [i64; 2] = [1 << 25, 1 << 26];
const BEYOND: [&str; 2] = ["position beyond 2^25", "position beyond 2^26"];
/// Up to here a whole number is one in single precision.
const EXACT: i64 = 1 << 24;
const LONGEST_GAP: i64 = 1000;

/// All parameters of a drive and their values, by index.
#[derive(Clone, Copy, PartialEq)]
pub struct Values {
    pub table: &'static Table,
    pub set: [ParameterValue; PARAMETER_COUNT],
}

impl Values {
    pub fn defaults(table: &'static Table) -> Self {
        Self { table, set: table.map(|parameter| parameter.default) }
    }
}

/// Place of a sample in the sequence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    First,
    Next,
    AfterGap,
    Repeated,
    Stray,
}

const PLACES: [Place; 5] = [Place::First, Place::Next, Place::AfterGap, Place::Repeated, Place::Stray];

/// Why a step ends the run: code, value, limit.
pub type Cause = (FaultCode, f64, f64);

/// The result of a control step.
pub struct Torque {
    pub nm: f32,
    pub is_saturated: bool,
    pub signals: [f32; SIGNALS.len()],
}

#[derive(Clone, Default)]
struct Encoder {
    reading: i64,
    position: i64,
    velocity_rad_s: f64,
}

/// A run since its `Start`.
#[derive(Clone)]
pub struct Run {
    /// The parameters at `Arm`.
    pub settings: Values,
    pub last: Option<u16>,
    pub answer: Option<TorqueAnswer>,
    pub steps: u16,
    encoders: [Encoder; 2],
    integral_nm: f64,
}

/// A parameter as a number.
pub fn number(value: ParameterValue) -> f64 {
    match value {
        ParameterValue::U32(value) => value.into(),
        ParameterValue::F32(value) => value.into(),
        ParameterValue::Unknown { .. } => f64::NAN,
    }
}

/// The encoder that moves by more counts in a period.
pub fn faster(values: &Values) -> usize {
    let counts =
        |encoder: usize| number(values.set[SPEED_LIMITS[encoder]]) * number(values.set[COUNTS[encoder]]);
    usize::from(counts(1) > counts(0))
}

/// A parameter in force where it has its effect. A mistaken drive takes the default.
pub fn setting(at: &Sites, values: &Values, index: usize) -> f64 {
    let parameter = &values.table[index];
    let value = (number(values.set[index]), Width::Real);
    at.number_or("effect of a parameter", parameter.name, value, Some(number(parameter.default)))
}

/// Counts of a period at the speed limit.
fn counts_per_period(at: &Sites, values: &Values, encoder: usize) -> f64 {
    let limit_rad_s = setting(at, values, SPEED_LIMITS[encoder]);
    limit_rad_s * setting(at, values, PERIOD) * 1e-6 * setting(at, values, COUNTS[encoder]) / TAU
}

/// The longest gap that leaves no position ambiguous, in periods; 0 if a single period does.
pub fn longest_gap(at: &Sites, values: &Values) -> i64 {
    let of_encoder = |encoder: usize| {
        let counts = counts_per_period(at, values, encoder);
        at.whole("longest gap", ENCODERS[encoder], ((HALF - 2) as f64 / counts) as i64)
    };
    at.whole("longest gap", "of both", LONGEST_GAP.min(of_encoder(0)).min(of_encoder(1)))
}

impl Run {
    pub fn new(settings: Values) -> Self {
        Self { settings, last: None, answer: None, steps: 0, encoders: Default::default(), integral_nm: 0.0 }
    }

    /// A `Start`. A mistaken drive continues where the run before ended.
    pub fn restarted(&self, at: &Sites) -> Self {
        let mut run = Self::new(self.settings);
        if self.last.is_none() {
            return run;
        }
        if !at.flag("Start resets", "the sequence", true) {
            (run.last, run.answer) = (self.last, self.answer);
        }
        if !at.flag("Start resets", "the encoders", true) {
            run.encoders = self.encoders.clone();
        }
        if self.integral_nm != 0.0 && !at.flag("Start resets", "the integral", true) {
            run.integral_nm = self.integral_nm;
        }
        run
    }

    pub fn watchdog_us(&self, at: &Sites) -> f64 {
        setting(at, &self.settings, WATCHDOG)
    }

    /// Periods since the last accepted sample, and the place of this one.
    pub fn place(&self, at: &Sites, sequence: u16) -> (i64, Place) {
        let Some(last) = self.last else {
            let is_first = i64::from(sequence) == at.whole("sequence", "of the first sample", 0);
            let place = if is_first { Place::First } else { Place::Stray };
            return (0, at.pick("sequence", "before the first sample", place, &PLACES));
        };
        let ahead = i64::from(sequence.wrapping_sub(last));
        let modulo = sequence >= last || at.flag("sequence", "is modulo 2^16", true);
        let ahead = if modulo { ahead } else { i64::from(sequence) - i64::from(last) };
        let ahead = at.whole("sequence", "periods ahead", ahead);
        let place = match ahead {
            0 => at.pick("sequence", "the last one", Place::Repeated, &PLACES),
            1 => at.pick("sequence", "the next one", Place::Next, &PLACES),
            2.. if ahead <= longest_gap(at, &self.settings) => {
                at.pick("sequence", "after a gap", Place::AfterGap, &PLACES)
            }
            2..=LONGEST_GAP => at.pick("sequence", "after an ambiguous gap", Place::Stray, &PLACES),
            0x8000.. => at.pick("sequence", "an older one", Place::Stray, &PLACES),
            _ => at.pick("sequence", "too far ahead", Place::Stray, &PLACES),
        };
        (ahead, place)
    }

    /// A control step over this many periods, 0 for the first. `live` are the parameters at present.
    pub fn step(
        &mut self,
        at: &Sites,
        live: &Values,
        sample: &EncoderSample,
        periods: i64,
    ) -> Result<Torque, Cause> {
        let readings = [sample.motor_counts, sample.load_counts].map(|it| i64::from(it.get()));
        let periods = at.whole("step", "elapsed periods", periods);
        let elapsed_s = periods as f64 * setting(at, &self.settings, PERIOD) * 1e-6;
        let of = |encoder| {
            if periods == 0 { self.first(at, encoder, readings) } else { self.moved(at, encoder, readings) }
        };
        let moved = [of(0), of(1)];
        let causes = [
            self.reference(at, sample),
            self.jump(at, 0, moved[0], elapsed_s),
            self.jump(at, 1, moved[1], elapsed_s),
        ];
        let mut causes = causes.into_iter().flatten();
        if let Some(first) = causes.next() {
            let second = causes.next().filter(|_| at.flag("step", "takes the second fault", false));
            return Err(second.unwrap_or(first));
        }
        for (index, encoder) in self.encoders.iter_mut().enumerate() {
            encoder.position += moved[index];
            for (bound, site) in FAR.into_iter().zip(BEYOND) {
                if !(-bound..bound).contains(&encoder.position) && !at.flag(site, ENCODERS[index], true) {
                    encoder.position = (encoder.position + bound).rem_euclid(2 * bound) - bound;
                }
            }
            if encoder.position.abs() > EXACT
                && at.flag("position in single precision", ENCODERS[index], false)
            {
                encoder.position = encoder.position as f32 as i64;
            }
            encoder.reading = readings[index];
            if periods > 0 {
                let counts_per_rev = setting(at, &self.settings, COUNTS[index]);
                let raw_rad_s = moved[index] as f64 / counts_per_rev * TAU / elapsed_s;
                encoder.velocity_rad_s += 0.5 * (raw_rad_s - encoder.velocity_rad_s);
            }
        }
        self.steps = self.steps.wrapping_add(1);
        self.law(at, live, f64::from(sample.reference_rad), periods as f64, elapsed_s)
    }

    /// The position of the first sample.
    fn first(&self, at: &Sites, encoder: usize, readings: [i64; 2]) -> i64 {
        let reading = (readings[encoder] as f64, Width::Reading);
        let other = Some(readings[1 - encoder] as f64);
        at.number_or("position of the first sample", ENCODERS[encoder], reading, other) as i64
    }

    /// The wrapped difference to the last reading.
    fn moved(&self, at: &Sites, encoder: usize, readings: [i64; 2]) -> i64 {
        let raw = readings[encoder] - self.encoders[encoder].reading;
        let wrapped = (raw + HALF).rem_euclid(2 * HALF) - HALF;
        let wraps = raw == wrapped || at.flag("difference is wrapped", ENCODERS[encoder], true);
        let wrapped = if wraps { wrapped } else { raw };
        at.whole("difference", ENCODERS[encoder], wrapped)
    }

    fn reference(&self, at: &Sites, sample: &EncoderSample) -> Option<Cause> {
        let reference_rad = sample.reference_rad;
        let parts = ["reference is NaN", "reference is infinite"];
        let [nan, infinite] = [reference_rad.is_nan(), reference_rad.is_infinite()];
        let breaks = at.flag("fault", parts[0], nan) | at.flag("fault", parts[1], infinite);
        breaks.then(|| (at.fault("reference", FaultCode::ReferenceNotFinite), reference_rad.into(), 0.0))
    }

    fn jump(&self, at: &Sites, encoder: usize, moved: i64, elapsed_s: f64) -> Option<Cause> {
        const SITES: [&str; 2] = ["motor jump", "load jump"];
        const CODES: [FaultCode; 2] = [FaultCode::MotorEncoderJump, FaultCode::LoadEncoderJump];
        if at.flag(SITES[encoder], "the first sample has no speed", elapsed_s == 0.0) {
            return None;
        }
        let elapsed_s = if elapsed_s == 0.0 { 1e-3 } else { elapsed_s };
        let moved = at.whole(SITES[encoder], "counts", moved);
        let forwards =
            if moved < 0 && at.flag(SITES[encoder], "backwards too", true) { -moved } else { moved };
        let counts = (forwards - at.whole(SITES[encoder], "counts forgiven", 1)).max(0);
        let speed_rad_s = counts as f64 / setting(at, &self.settings, COUNTS[encoder]) * TAU / elapsed_s;
        let limit_rad_s = setting(at, &self.settings, SPEED_LIMITS[encoder]);
        at.flag(SITES[encoder], "beyond the limit", speed_rad_s > limit_rad_s)
            .then(|| (at.fault(SITES[encoder], CODES[encoder]), speed_rad_s, limit_rad_s))
    }

    fn law(
        &mut self,
        at: &Sites,
        live: &Values,
        reference_rad: f64,
        periods: f64,
        elapsed_s: f64,
    ) -> Result<Torque, Cause> {
        let turns =
            [0, 1].map(|it| self.encoders[it].position as f64 / setting(at, &self.settings, COUNTS[it]));
        let [motor_rad, load_rad] = turns.map(|turns| turns * TAU);
        let [motor_rad_s, load_rad_s] = [0, 1].map(|it| self.encoders[it].velocity_rad_s);
        let error_rad = load_rad - reference_rad;
        let is_live = at.flag("live parameter", "has effect at once", true);
        let gain_nm_rad = setting(at, if is_live { live } else { &self.settings }, GAIN);
        let spring_nm = -gain_nm_rad * (error_rad + 0.25 * (motor_rad - load_rad));
        let damping_nm = -setting(at, &self.settings, DAMPING) * motor_rad_s;
        let law = setting(at, &self.settings, CONTROLLER);
        if law == 1.0 {
            self.integral_nm += setting(at, &self.settings, INTEGRAL_GAIN) * spring_nm * elapsed_s;
        }
        let output = match setting(at, &self.settings, OUTPUT) as u32 {
            2 => 0.5,
            3 => 2.0,
            _ => 1.0,
        };
        let requested_nm = output * (spring_nm + damping_nm + self.integral_nm);
        let limit_nm = setting(at, &self.settings, TORQUE_LIMIT);
        if at.flag("torque", "not finite is a fault", !(requested_nm as f32).is_finite()) {
            return Err((at.fault("torque", FaultCode::TorqueNotFinite), requested_nm, limit_nm));
        }
        let upper_nm = at.real("torque", "upper limit", limit_nm);
        let lower_nm = at.real("torque", "lower limit", -limit_nm);
        let signals = [
            load_rad,
            motor_rad,
            requested_nm,
            self.integral_nm,
            load_rad_s,
            motor_rad_s,
            error_rad,
            spring_nm,
            damping_nm,
            reference_rad,
            motor_rad - load_rad,
            periods,
            f64::from(self.steps),
            spring_nm,
            turns[1],
            turns[0],
        ];
        Ok(Torque {
            nm: requested_nm.min(upper_nm).max(lower_nm) as f32,
            is_saturated: requested_nm.abs() > limit_nm
                || requested_nm.abs() as f32 == limit_nm as f32
                    && at.flag("torque", "is saturated at its limit", false),
            signals: signals.map(|it| it as f32),
        })
    }
}
