//! A bench as it might be built, the law that is to run it, and how well that went.

use std::fmt;

use lashloop_firmware::control::Real;
use lashloop_firmware::control::backlash_inverse::{
    BacklashInverse, BacklashInverseGains, BacklashInverseSetting,
};
use lashloop_firmware::control::law::Law;
use lashloop_firmware::control::nominal_model::NominalModel;
use lashloop_plant::backlash_shaft::{BacklashShaft, ShaftParameters};
use lashloop_plant::{Mechanics, Plant, PlantError, Start, TransportDelay, Truth};

use crate::closed_loop::{Quantised, Reference, Row, Timing, run};
use crate::paper;

/// A plant behind a delay.
struct Delayed<P> {
    plant: P,
    delay_us: u32,
}

impl<P: Plant> Plant for Delayed<P> {
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

/// Everything a run depends on but the law.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Machine {
    pub(crate) mechanics: Mechanics,
    pub(crate) parameters: ShaftParameters,
    pub(crate) counts: u32,
    pub(crate) delay_us: u32,
    /// The drive's own limit.
    pub(crate) torque_limit_nm: f64,
}

impl Machine {
    /// The paper's experiment behind encoders of 4000 counts, a millisecond late.
    pub(crate) fn paper() -> Self {
        Self {
            mechanics: Mechanics::paper(),
            parameters: ShaftParameters::paper(),
            counts: 4000,
            delay_us: 1000,
            torque_limit_nm: 20.0,
        }
    }

    /// The backlash inverse with its default gains. Of the plant it knows table 1 and the motor's dry friction; the gap
    /// is its own to find.
    pub(crate) fn backlash_inverse<F: Real>(&self) -> Law<F> {
        let model = NominalModel { motor_coulomb_nm: F::from_f64(0.02), ..NominalModel::paper() };
        let setting = BacklashInverseSetting {
            momentum_observer_rad_s: F::from_f64(60.0),
            dead_zone_initial_rad: F::from_f64(0.16),
            dead_zone_max_rad: F::from_f64(3.0),
            load_resolution_rad: F::from_f64(core::f64::consts::TAU / f64::from(self.counts)),
            torque_limit_nm: F::from_f64(self.torque_limit_nm),
            period_s: F::from_f64(1e-3),
        };
        BacklashInverse::new(&model, BacklashInverseGains::paper(), setting).expect("valid law").into()
    }

    /// What the drive's encoders and velocity filters make of it.
    pub(crate) fn sensors<F: Real>(&self) -> Quantised<F> {
        Quantised::new(self.counts, 400.0, 200.0, 1e-3)
    }

    /// 25 s from the paper's start.
    pub(crate) fn regulate<F: Real>(&self, law: &Law<F>) -> Vec<Row> {
        self.follow(law, self.sensors(), paper::START, 25_000, crate::closed_loop::regulate_to_nought)
    }

    pub(crate) fn follow<F: Real>(
        &self,
        law: &Law<F>,
        sensors: impl crate::closed_loop::Sensors<F>,
        start: Start,
        periods: usize,
        reference: impl Fn(f64) -> Reference,
    ) -> Vec<Row> {
        let plant = BacklashShaft::new(self.mechanics, self.parameters, 16).expect("valid plant");
        let timing = Timing { period_s: 1e-3, periods, torque_limit_nm: self.torque_limit_nm };
        run(&Delayed { plant, delay_us: self.delay_us }, start, law, sensors, reference, timing)
    }

    /// Under 0.5 rad at 0.05 Hz: how far apart the load passes the middle of the reference's two ways.
    pub(crate) fn lost_motion_rad<F: Real>(&self, law: &Law<F>) -> f64 {
        let omega = core::f64::consts::TAU * 0.05;
        let sine = |time_s: f64| Reference {
            position_rad: 0.5 * (omega * time_s).sin(),
            velocity_rad_s: 0.5 * omega * (omega * time_s).cos(),
            acceleration_rad_s2: -0.5 * omega * omega * (omega * time_s).sin(),
        };
        let rows = self.follow(law, self.sensors(), Start::at_rest(0.0, 0.0), 80_000, sine);
        (rows[80_000].truth.load_position_rad - rows[70_000].truth.load_position_rad).abs()
    }
}

/// What a run is judged by, towards a reference of nought.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Figures {
    /// First sample after the last one beyond 0.05 rad; None if the last is.
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
        let outside = rows.iter().rposition(|row| load(row).abs() > 0.05);
        let second = &rows[rows.len() - 1000..];
        let ten_seconds = &rows[rows.len() - 10_000..];
        let highest = ten_seconds.iter().map(load).fold(f64::MIN, f64::max);
        let lowest = ten_seconds.iter().map(load).fold(f64::MAX, f64::min);
        Self {
            settle_s: rows.get(outside.map_or(0, |k| k + 1)).map(|row| row.time_s),
            static_error_rad: second.iter().map(load).sum::<f64>() / 1000.0,
            hunting_rad: highest - lowest,
            torque_variation_nm: rows
                .windows(2)
                .map(|pair| (pair[1].torque_nm - pair[0].torque_nm).abs())
                .sum(),
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

/// The head of a table of [`Figures`].
pub(crate) const HEAD: &str = "settle s static mrad hunting mrad variation N m gap err mrad";
