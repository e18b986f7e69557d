//! A plant that turns both encoders at speeds of the test, under any torque.

use std::sync::{Arc, Mutex};

use lashloop_plant::{Plant, PlantError, Positions, Signal};
use lashloop_silicon::drive_train::{DriveTrain, Scales};

/// Speeds of motor and load in counts per second. A clone sets the same ones.
#[derive(Clone, Default)]
pub struct Speeds(Arc<Mutex<[f64; 2]>>);

impl Speeds {
    pub fn set(&self, motor: f64, load: f64) {
        *self.0.lock().expect("no panic while it is held") = [motor, load];
    }
}

/// Positions are counts: the scales of the drive train turn a radian into one.
struct Turntable {
    speeds: Speeds,
    counts: [f64; 2],
}

impl Plant for Turntable {
    fn signals(&self) -> &[Signal] {
        &[]
    }

    fn truth(&self, _: &mut [f64]) {}

    fn positions(&self) -> Positions {
        let [motor_position_rad, load_position_rad] = self.counts;
        Positions { motor_position_rad, load_position_rad }
    }

    fn step(&mut self, _torque_nm: f64, dt_s: f64) -> Result<(), PlantError> {
        let speeds = *self.speeds.0.lock().expect("no panic while it is held");
        for (count, speed) in self.counts.iter_mut().zip(speeds) {
            *count += speed * dt_s;
        }
        Ok(())
    }
}

/// A drive train that follows these speeds, from these counts on.
pub fn drive_train(speeds: &Speeds, from: (i64, i64)) -> DriveTrain {
    let scales = Scales {
        nm_per_full_duty: 1.0,
        motor_counts_per_rev: std::f64::consts::TAU,
        load_counts_per_rev: std::f64::consts::TAU,
    };
    // Off the edge between two counts.
    let counts = [from.0 as f64 + 0.5, from.1 as f64 + 0.5];
    DriveTrain::new(Box::new(Turntable { speeds: speeds.clone(), counts }), scales)
}
