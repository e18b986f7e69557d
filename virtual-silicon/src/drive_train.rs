//! A plant between bridge and encoders.
//!
//! Each PWM period the plant takes a step under the torque of the duty that the bridge carries at its start. With a motor at the
//! bridge it takes one in each half of a period, and one when the converters start. The edges of both encoders occur at their own instants within the period, as positions pass the counts on a straight line. A timer
//! therefore counts at most one edge at a time, as on a board.

use std::collections::VecDeque;
use std::f64::consts::TAU;
use std::time::Duration;

use anyhow::{Context, Result};
use lashloop_plant::Plant;

use crate::motor_at_bridge::MotorAtBridge;
use crate::pins::Pins;
use crate::quadrature::{Channel, Edge, Quadrature};
use crate::wiring::Encoder;

/// Step of the plant: the period of a PWM of 20 kHz.
const STEP: Duration = Duration::from_micros(50);

/// What lies between duty and torque, and between position and count.
#[derive(Debug, Clone, Copy, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scales {
    /// Torque at duty 1, N m; at duty 0.5 the torque is 0, at duty 0 its negative. Not for a motor at the bridge.
    #[serde(default)]
    pub nm_per_full_duty: f64,
    /// Counts per revolution of the encoder at the motor.
    pub motor_counts_per_rev: f64,
    /// Counts per revolution of the encoder at the load.
    pub load_counts_per_rev: f64,
}

/// A plant at the pins. A bridge that is off leaves its motor without torque.
pub struct DriveTrain {
    plant: Box<dyn Plant>,
    scales: Scales,
    motor: Quadrature,
    load: Quadrature,
    /// Edges until the plant's next step, in their order, each with the count after it.
    edges: VecDeque<(Duration, Encoder, Edge, i64)>,
    /// Counts of motor and load at the last edges.
    shown: [i64; 2],
    next_step: Option<Duration>,
    /// Device time of the plant.
    at: Duration,
    torque_nm: f64,
    /// The motor; `None` for an amplifier that makes the torque.
    motor_at_bridge: Option<MotorAtBridge>,
    cut: Vec<(Encoder, Channel)>,
    indices: Vec<Index>,
}

/// The index of an encoder: high at one count of each revolution.
#[derive(Debug, Clone, Copy)]
struct Index {
    encoder: Encoder,
    at_count: i64,
    counts_per_rev: i64,
    is_high: bool,
}

impl DriveTrain {
    /// A plant with its encoders at the counts of its positions.
    #[must_use]
    pub fn new(plant: Box<dyn Plant>, scales: Scales) -> Self {
        let (motor, load) = counts(&*plant, &scales);
        let shown = [motor.floor() as i64, load.floor() as i64];
        Self {
            plant,
            scales,
            motor: Quadrature::at(shown[0]),
            load: Quadrature::at(shown[1]),
            edges: VecDeque::new(),
            shown,
            next_step: None,
            at: Duration::ZERO,
            torque_nm: 0.0,
            motor_at_bridge: None,
            cut: Vec::new(),
            indices: Vec::new(),
        }
    }

    /// The same with an index of an encoder at this count, and each revolution from there.
    #[must_use]
    pub fn with_index(mut self, encoder: Encoder, at_count: i64, counts_per_rev: i64) -> Self {
        self.indices.push(Index { encoder, at_count, counts_per_rev, is_high: false });
        self
    }

    /// Drives the index of an encoder if its level changes at this count.
    fn drive_index(&mut self, chip: &mut Pins<'_>, encoder: Encoder, count: i64) {
        for index in self.indices.iter_mut().filter(|index| index.encoder == encoder) {
            let is_high = (count - index.at_count).rem_euclid(index.counts_per_rev) == 0;
            if std::mem::replace(&mut index.is_high, is_high) != is_high {
                chip.drive_index(encoder, is_high);
            }
        }
    }

    /// The same plant behind a motor at the bridge.
    #[must_use]
    pub fn behind_motor(self, motor: MotorAtBridge) -> Self {
        Self { motor_at_bridge: Some(motor), ..self }
    }

    /// The motor at the bridge.
    pub fn motor_at_bridge(&mut self) -> Option<&mut MotorAtBridge> {
        self.motor_at_bridge.as_mut()
    }

    /// The plant.
    #[must_use]
    pub fn plant(&self) -> &dyn Plant {
        &*self.plant
    }

    /// Torque at the motor in this period, N m.
    #[must_use]
    pub fn torque_nm(&self) -> f64 {
        self.torque_nm
    }

    /// Count of an encoder, as its edges so far show it.
    #[must_use]
    pub fn count(&self, encoder: Encoder) -> i64 {
        let [motor, load] = self.shown;
        match encoder {
            Encoder::Motor => motor,
            Encoder::Load => load,
        }
    }

    /// Cuts the wire of one channel of an encoder for good.
    pub fn cut(&mut self, chip: &mut Pins<'_>, encoder: Encoder, channel: Channel) {
        self.cut.push((encoder, channel));
        chip.open_encoder(encoder, channel);
    }

    /// Drives the edges that are due and steps the plant if its step is due. Returns the device time of the next turn.
    ///
    /// # Errors
    /// The plant can't be followed.
    pub fn turn(&mut self, chip: &mut Pins<'_>) -> Result<Duration> {
        let now = chip.now();
        while let Some((_, encoder, edge, count)) = self.edges.pop_front_if(|(at, ..)| *at <= now) {
            match encoder {
                Encoder::Motor => self.shown[0] = count,
                Encoder::Load => self.shown[1] = count,
            }
            if !self.cut.contains(&(encoder, edge.channel)) {
                chip.drive_encoder(encoder, edge);
            }
            self.drive_index(chip, encoder, count);
        }
        for index in self.indices.iter().filter(|_| self.next_step.is_none()) {
            chip.drive_index(index.encoder, index.is_high);
        }
        let due = *self.next_step.get_or_insert_with(|| {
            chip.set_encoder(Encoder::Motor, self.motor);
            chip.set_encoder(Encoder::Load, self.load);
            // The amplifier is ready.
            chip.drive_break(Some(false));
            self.at = now;
            now
        });
        let due = if due <= now || chip.samples() && self.motor_at_bridge.is_some() {
            let step = match &mut self.motor_at_bridge {
                // The plant is ahead of the chip by a step.
                None => self.step(now, STEP, chip)?,
                // It is behind: the bridge may have changed meanwhile.
                Some(_) => self.follow_motor(now, chip)?,
            };
            *self.next_step.insert(now + step)
        } else {
            due
        };
        Ok(self.edges.front().map_or(due, |(at, ..)| due.min(*at)))
    }

    /// Steps motor and plant up to now, and shows the sensor what it has to show. Returns the time until the next step.
    fn follow_motor(&mut self, now: Duration, chip: &mut Pins<'_>) -> Result<Duration> {
        let elapsed = now.saturating_sub(self.at);
        let Some(motor) = &mut self.motor_at_bridge else { return Ok(STEP) };
        if !elapsed.is_zero() {
            self.torque_nm = motor.step(&*self.plant, elapsed.as_secs_f64());
            let shown = elapsed.min(motor.least_half_period());
            // Its edges are shown half a period late: their instants lie behind.
            self.step_plant(now, elapsed, shown)?;
        }
        let Some(motor) = &mut self.motor_at_bridge else { return Ok(STEP) };
        motor.look(chip);
        self.at = now;
        Ok(motor.half_period())
    }

    fn step(&mut self, now: Duration, step: Duration, chip: &mut Pins<'_>) -> Result<Duration> {
        self.torque_nm = chip.driving().map_or(0.0, |duty| (2.0 * duty - 1.0) * self.scales.nm_per_full_duty);
        self.step_plant(now, step, step)?;
        Ok(step)
    }

    /// Steps the plant, whose edges come from now on within a time, and after all earlier ones: a channel that overtakes the other one
    /// turns the count the wrong way.
    fn step_plant(&mut self, now: Duration, step: Duration, shown: Duration) -> Result<()> {
        let first = self.edges.back().map_or(now, |(last, ..)| now.max(*last));
        let before = counts(&*self.plant, &self.scales);
        self.plant.step(self.torque_nm, step.as_secs_f64()).context("the plant can't be followed")?;
        let after = counts(&*self.plant, &self.scales);
        let ways = [
            (Encoder::Motor, &mut self.motor, before.0, after.0),
            (Encoder::Load, &mut self.load, before.1, after.1),
        ];
        for (encoder, quadrature, from, to) in ways {
            let target = to.floor() as i64;
            loop {
                let count = quadrature.count();
                let Some(edge) = quadrature.step_towards(target) else { break };
                // The count changes where the position passes the greater of its two sides.
                let passed = count.max(quadrature.count()) as f64;
                let fraction = ((passed - from) / (to - from)).clamp(0.0, 1.0);
                self.edges.push_back((first + shown.mul_f64(fraction), encoder, edge, quadrature.count()));
            }
        }
        self.edges.make_contiguous().sort_by_key(|(at, ..)| *at);
        Ok(())
    }
}

/// Positions of motor and load in counts.
fn counts(plant: &dyn Plant, scales: &Scales) -> (f64, f64) {
    let positions = plant.positions();
    let motor = positions.motor_position_rad / TAU * scales.motor_counts_per_rev;
    (motor, positions.load_position_rad / TAU * scales.load_counts_per_rev)
}
