//! A backlash shaft with encoders, delay and torque limit, its control law, and the figures of a run.

use std::fmt;

use lashloop_firmware::control::backlash_inverse::{
    BacklashInverse, BacklashInverseGains, BacklashInverseSetting,
};
use lashloop_firmware::control::braking_curve::{BrakingCurve, BrakingCurveSetting, BrakingCurveTuning};
use lashloop_firmware::control::dead_zone_observer::DeadZoneBounds;
use lashloop_firmware::control::nominal_model::NominalModel;
use lashloop_firmware::control::torque_knowledge::TorqueKnowledge;
use lashloop_firmware::law::Real;
use lashloop_plant::backlash_shaft::{BacklashShaft, ShaftParameters};
use lashloop_plant::{Mechanics, PlantError, Start, TransportDelay, Truth, TwoMass};

use crate::closed_loop::{Quantised, Reference, Sensors, Timing, regulate_to_zero, run, slow_sine};
use crate::law::Law;
use crate::paper;
use crate::trajectory::{Row, lost_motion_rad, settle_s, torque_variation_nm};

/// A plant behind a transport delay.
struct Delayed<P> {
    plant: P,
    delay_us: u32,
}

impl<P: TwoMass> TwoMass for Delayed<P> {
    type State = (P::State, TransportDelay);

    fn initial_state(&self, start: Start) -> Self::State {
        (self.plant.initial_state(start), TransportDelay::new(self.delay_us, 1000))
    }

    fn step(&self, (state, delay): &mut Self::State, torque_nm: f64, _: f64) -> Result<(), PlantError> {
        delay.step(torque_nm).try_for_each(|(torque_nm, held_s)| self.plant.step(state, torque_nm, held_s))
    }

    fn truth(&self, (state, _): &Self::State) -> Truth {
        self.plant.truth(state)
    }
}

/// Everything that a run depends on except its law.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DriveTrain {
    pub(crate) mechanics: Mechanics,
    pub(crate) parameters: ShaftParameters,
    pub(crate) counts: u32,
    pub(crate) delay_us: u32,
    /// The drive's torque limit.
    pub(crate) torque_limit_nm: f64,
}

impl DriveTrain {
    /// The paper's experiment with encoders of 4000 counts and a delay of one millisecond.
    pub(crate) fn paper() -> Self {
        Self {
            mechanics: Mechanics::paper(),
            parameters: ShaftParameters::paper(),
            counts: 4000,
            delay_us: 1000,
            torque_limit_nm: 20.0,
        }
    }

    /// The backlash inverse with its default gains. Its model holds table 1 and the motor's dry friction; it identifies
    /// the gap itself.
    pub(crate) fn backlash_inverse<F: Real>(&self) -> Law<F> {
        let model = NominalModel { motor_coulomb_nm: F::from_f64(0.02), ..NominalModel::default() };
        let count_rad = self.count_rad();
        let setting = BacklashInverseSetting {
            momentum_observer_rad_s: F::from_f64(60.0),
            dead_zone: DeadZoneBounds::default(),
            motor_resolution_rad: count_rad,
            load_resolution_rad: count_rad,
            torque_limit_nm: F::from_f64(self.torque_limit_nm),
            period_s: F::from_f64(1e-3),
        };
        let law = BacklashInverse::new(&model, BacklashInverseGains::default(), setting);
        Law::BacklashInverse(law.expect("valid law"))
    }

    /// The braking curve, likewise.
    pub(crate) fn braking_curve<F: Real>(&self) -> Law<F> {
        let model = NominalModel { motor_coulomb_nm: F::from_f64(0.02), ..NominalModel::default() };
        let count_rad = self.count_rad();
        let setting = BrakingCurveSetting {
            motor_resolution_rad: count_rad,
            load_resolution_rad: count_rad,
            torque_limit_nm: F::from_f64(self.torque_limit_nm),
            motor_speed_limit_rad_s: F::from_f64(1000.0),
            period_s: F::from_f64(1e-3),
        };
        // The torque of this drive train is exact.
        let exact = TorqueKnowledge {
            torque_offset_deviation: F::ZERO,
            torque_ripple_deviation: F::ZERO,
            ..TorqueKnowledge::default()
        };
        let (tuning, bounds) = (BrakingCurveTuning::default(), DeadZoneBounds::default());
        let law = BrakingCurve::new(&model, &tuning, &exact, &bounds, &setting);
        Law::BrakingCurve(law.expect("valid law"))
    }

    /// One count of either encoder.
    fn count_rad<F: Real>(&self) -> F {
        F::from_f64(core::f64::consts::TAU / f64::from(self.counts))
    }

    /// The drive's encoders and velocity filters.
    pub(crate) fn sensors<F: Real>(&self) -> Quantised<F> {
        Quantised::new(self.counts, 400.0, 200.0, 1e-3)
    }

    /// 25 s from the paper's start.
    pub(crate) fn regulate<F: Real>(&self, law: &Law<F>) -> Vec<Row> {
        self.follow(law, self.sensors(), paper::START, 25_000, regulate_to_zero)
    }

    pub(crate) fn follow<F: Real>(
        &self,
        law: &Law<F>,
        sensors: impl Sensors<F>,
        start: Start,
        periods: usize,
        reference: impl Fn(f64) -> Reference,
    ) -> Vec<Row> {
        let plant = BacklashShaft::new(self.mechanics, self.parameters, 16).expect("valid plant");
        let timing = Timing { period_s: 1e-3, periods, torque_limit_nm: self.torque_limit_nm };
        run(&Delayed { plant, delay_us: self.delay_us }, start, law, sensors, reference, timing)
    }

    /// Lost motion under a slow sine.
    pub(crate) fn lost_motion_rad<F: Real>(&self, law: &Law<F>) -> f64 {
        let start = Start::at_rest(0.0, 0.0);
        lost_motion_rad(&self.follow(law, self.sensors(), start, 80_000, slow_sine))
    }
}

/// Figures of a run with the reference zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Figures {
    pub(crate) settle_s: Option<f64>,
    /// Mean of the last second.
    pub(crate) static_error_rad: f64,
    /// Peak to peak in the last 10 s.
    pub(crate) hunting_rad: f64,
    pub(crate) torque_variation_nm: f64,
    pub(crate) dead_zone_error_rad: f64,
}

impl Figures {
    pub(crate) fn of(rows: &[Row]) -> Self {
        let load = |row: &Row| row.truth.load_position_rad;
        let last = rows.last().expect("a trajectory has rows");
        let second = &rows[rows.len() - 1000..];
        let ten_seconds = &rows[rows.len() - 10_000..];
        let highest = ten_seconds.iter().map(load).fold(f64::MIN, f64::max);
        let lowest = ten_seconds.iter().map(load).fold(f64::MAX, f64::min);
        Self {
            settle_s: settle_s(rows),
            static_error_rad: second.iter().map(load).sum::<f64>() / 1000.0,
            hunting_rad: highest - lowest,
            torque_variation_nm: torque_variation_nm(rows),
            dead_zone_error_rad: last.dead_zone_estimate_rad - last.truth.dead_zone_rad,
        }
    }
}

impl fmt::Display for Figures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let settle = self.settle_s.map_or_else(|| "never".to_owned(), |settle_s| format!("{settle_s:.2}"));
        write!(
            f,
            "{settle:>8} {:>11.1} {:>12.2} {:>13.0} {:>11.0}",
            self.static_error_rad * 1e3 + 0.0,
            self.hunting_rad * 1e3,
            self.torque_variation_nm,
            self.dead_zone_error_rad * 1e3 + 0.0,
        )
    }
}

/// Header of a table of [`Figures`].
pub(crate) const HEADER: &str = "settle s static mrad hunting mrad variation N m gap err mrad";
