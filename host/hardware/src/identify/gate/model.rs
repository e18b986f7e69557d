//! The plant of a scenario under recorded torques, with the band of what it may differ by.

use lashloop_bench::run::RunError;
use lashloop_bench::run::simulator::Simulator;
use lashloop_bench::scenario::Scenario;
use lashloop_identify::Instruments;
use lashloop_plant::{PlantValue, TORQUE_DELAY_US};

use super::motion::RecordedMotion;

/// Positions of motor and load at each sample, in rad.
pub(super) type Positions = Vec<[f64; 2]>;

/// Standard deviations of the delay within the band: in process the delay is 0.
const DEVIATIONS: u32 = 3;

/// The model of a scenario, and its band.
pub(super) struct Model<'a> {
    scenario: Scenario,
    recorded: &'a RecordedMotion,
    pub(super) positions_rad: Positions,
    /// Square of the band of motor and load at each sample, in rad^2.
    pub(super) squares: Vec<[f64; 2]>,
}

impl<'a> Model<'a> {
    /// The model as the scenario has it, with a band of one count.
    pub(super) fn new(
        scenario: &Scenario,
        recorded: &'a RecordedMotion,
        count_rad: [f64; 2],
    ) -> Result<Self, RunError> {
        let positions_rad = replay(scenario, recorded, &recorded.torque_nm)?;
        let squares = vec![count_rad.map(|count_rad| count_rad.powi(2)); positions_rad.len()];
        Ok(Self { scenario: scenario.clone(), recorded, positions_rad, squares })
    }

    /// Widens the band by what another value of a key moves, the farther of both ends at each sample.
    pub(super) fn vary(&mut self, key: &'static str, ends: [PlantValue; 2]) -> Result<(), RunError> {
        let moved = ends.map(|end| {
            let mut scenario = self.scenario.clone();
            scenario.plant.values.insert(key, end);
            replay(&scenario, self.recorded, &self.recorded.torque_nm)
        });
        self.widen(moved)
    }

    /// Begins as a bench does: the torque has a delay and a step, and the motor stands somewhere in the gap.
    pub(super) fn begin_as_bench(
        &mut self,
        instruments: &Instruments,
        count_rad: [f64; 2],
    ) -> Result<(), RunError> {
        let Instruments {
            torque_delay_us, torque_delay_deviation_us, torque_step_nm, encoder_error_rad, ..
        } = *instruments;
        let delay = |us: u32| PlantValue::Integer(us.into());
        let late_us = DEVIATIONS * torque_delay_deviation_us;
        let ends_us = [torque_delay_us.saturating_sub(late_us), torque_delay_us + late_us];
        // A wrong delay would be taken for twist.
        let mut nearest: Option<(f64, f64, Scenario)> = None;
        for us in [torque_delay_us, ends_us[0], ends_us[1]] {
            self.scenario.plant.values.insert(TORQUE_DELAY_US, delay(us));
            let (away, doubt_rad, turned) = self.find_twist(count_rad)?;
            if nearest.as_ref().is_none_or(|it| away < it.0) {
                nearest = Some((away, doubt_rad, turned));
            }
        }
        let (_, doubt_rad, scenario) = nearest.expect("a delay was tried");
        self.scenario = scenario;
        self.positions_rad = replay(&self.scenario, self.recorded, &self.recorded.torque_nm)?;
        let turned = [-doubt_rad, doubt_rad]
            .map(|by_rad| replay(&turned(&self.scenario, by_rad), self.recorded, &self.recorded.torque_nm));
        self.widen(turned)?;
        // A displacement is of two readings, each off by up to a count: in all (2 q)^2.
        for square in &mut self.squares {
            *square = [0, 1].map(|encoder| square[encoder] + 3.0 * count_rad[encoder].powi(2));
        }
        // An eccentric encoder shows a displacement wrong by up to its error for each rad, and by up to two of them.
        let first = self.recorded.positions_rad.first().copied().unwrap_or_default();
        for (square, positions) in self.squares.iter_mut().zip(&self.recorded.positions_rad) {
            for encoder in 0..2 {
                let moved_rad = (positions[encoder] - first[encoder]).abs();
                square[encoder] += (encoder_error_rad[encoder] * moved_rad.min(2.0)).powi(2);
            }
        }
        self.vary(TORQUE_DELAY_US, ends_us.map(delay))?;
        if torque_step_nm > 0.0 {
            // Where a power stage rounds to is not known.
            let rounded = [-0.375, -0.125, 0.125, 0.375].map(|place| {
                let shift_nm = place * torque_step_nm;
                let round = |nm: &f32| {
                    (((f64::from(*nm) + shift_nm) / torque_step_nm).round() * torque_step_nm - shift_nm)
                        as f32
                };
                let torque_nm: Vec<_> = self.recorded.torque_nm.iter().map(round).collect();
                replay(&self.scenario, self.recorded, &torque_nm)
            });
            self.widen(rounded)?;
        }
        Ok(())
    }

    /// Turns the motor, within the gap, to where the model follows the start of the record best. Returns the distance of the
    /// model, how far from there the motor may stand, and the scenario with the motor there.
    fn find_twist(&self, count_rad: [f64; 2]) -> Result<(f64, f64, Scenario), RunError> {
        /// Samples that the search follows.
        const FOLLOWED: usize = 1000;
        /// Places on both sides of the middle that are tried at first, and halvings of their distance.
        const PLACES: i32 = 8;
        const HALVINGS: u32 = 10;
        let plant = &self.scenario.plant;
        let (Some(half_gap_rad), Some(ratio)) =
            (plant.number("dead_zone_rad"), plant.number("reduction_ratio"))
        else {
            return Ok((0.0, 0.0, self.scenario.clone()));
        };
        let start = plant.initial;
        let middle_rad = ratio * start.load_position_rad - start.motor_position_rad;
        let torque_nm = &self.recorded.torque_nm[..self.recorded.torque_nm.len().min(FOLLOWED)];
        let distance = |by_rad: f64| -> Result<f64, RunError> {
            let model = replay(&turned(&self.scenario, by_rad), self.recorded, torque_nm)?;
            let pairs = model.iter().zip(&self.recorded.positions_rad);
            let squares = pairs.map(|(model, recorded)| {
                (0..2).map(|it| ((model[it] - recorded[it]) / count_rad[it]).powi(2)).sum::<f64>()
            });
            Ok(squares.sum())
        };
        let mut step_rad = half_gap_rad / f64::from(PLACES);
        let mut best = (f64::INFINITY, 0.0);
        for place in -PLACES..=PLACES {
            let by_rad = middle_rad + f64::from(place) * step_rad;
            let away = distance(by_rad)?;
            if away < best.0 {
                best = (away, by_rad);
            }
        }
        for _ in 0..HALVINGS {
            step_rad /= 2.0;
            for by_rad in [best.1 - step_rad, best.1 + step_rad] {
                let away = distance(by_rad)?;
                if away < best.0 {
                    best = (away, by_rad);
                }
            }
            if step_rad < 0.25 * count_rad[0] {
                break;
            }
        }
        // The counts at the first sample are off by up to one of either encoder.
        let doubt_rad = step_rad + count_rad[0] + ratio * count_rad[1];
        Ok((best.0, doubt_rad, turned(&self.scenario, best.1)))
    }

    fn widen<const N: usize>(&mut self, moved: [Result<Positions, RunError>; N]) -> Result<(), RunError> {
        let mut largest = vec![[0.0_f64; 2]; self.positions_rad.len()];
        for moved in moved {
            for ((largest, moved), model) in largest.iter_mut().zip(moved?).zip(&self.positions_rad) {
                for encoder in 0..2 {
                    largest[encoder] = largest[encoder].max((moved[encoder] - model[encoder]).abs());
                }
            }
        }
        for (square, largest) in self.squares.iter_mut().zip(largest) {
            for encoder in 0..2 {
                square[encoder] += largest[encoder].powi(2);
            }
        }
        Ok(())
    }
}

/// The scenario with the motor turned at its start.
fn turned(scenario: &Scenario, by_rad: f64) -> Scenario {
    let mut scenario = scenario.clone();
    scenario.plant.initial.motor_position_rad += by_rad;
    scenario
}

/// Positions of the scenario's plant under these torques. The encoders of a bench count from the first sample on, so there
/// the positions begin as the recorded ones.
fn replay(scenario: &Scenario, recorded: &RecordedMotion, torque_nm: &[f32]) -> Result<Positions, RunError> {
    let mut simulator = Simulator::new(scenario)?;
    let mut positions: Positions = Vec::with_capacity(torque_nm.len());
    for (step, &torque_nm) in (0..).zip(torque_nm) {
        let (_, observation) = simulator.observe(step)?;
        positions.push([observation.row.motor_position_rad, observation.row.load_position_rad]);
        simulator.step(step, torque_nm)?;
    }
    let first = positions.first().zip(recorded.positions_rad.first());
    if let Some((model, recorded)) = first.filter(|_| !scenario.run.mode.is_hil()) {
        let shift = [0, 1].map(|encoder| recorded[encoder] - model[encoder]);
        for position in &mut positions {
            *position = [0, 1].map(|encoder| position[encoder] + shift[encoder]);
        }
    }
    Ok(positions)
}
