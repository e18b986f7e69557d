//! Whether the motor turns as its torque says: a wrong direction of its encoder or of the power stage is said at once.
//!
//! Gears, friction and a load at rest take energy from the motor, so from rest on the work of its torque is not negative. With a
//! wrong direction it is, and the motor runs away from the reference, ever faster. A motor that brakes becomes slower, and one that
//! lowers a weight turns towards the reference. Only the first rad of a run is judged, if both masses rested before: later a
//! disturbance may do anything, and a shaft that is wound up turns the motor whatever its torque says.

use lashloop_protocol::enums::FaultCode;

use super::safety::Violation;
use crate::law::Real;

/// Motion of the motor that is judged, in rad.
const MOTION_RAD: f32 = 1.0;
/// Smallest mean torque that tells a direction, as a fraction of the torque limit.
const SMALLEST_TORQUE: f32 = 0.05;
/// A motor that runs away from rest is 2.4 times as fast in the second half of the motion; one that turns at a constant speed isn't
/// faster.
const FASTER: f32 = 1.1;
/// Motion of a load behind a soft shaft that tells its direction, as a fraction of that of the motor.
const SMALLEST_LOAD: f32 = 0.002;
/// Distance of the reference that tells a direction, in rad at the motor.
const SMALLEST_WAY_RAD: f32 = 0.01;

/// What turned: the detail of the fault.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Cause {
    /// The load stood still.
    Unknown = 0,
    /// The load turned with the motor.
    PowerStage = 1,
    /// The load turned against the motor.
    MotorEncoder = 2,
}

/// A motion since its begin, in rad at the motor.
#[derive(Clone, Copy, Default)]
struct Motion {
    steps: f32,
    motor_rad: f32,
    load_rad: f32,
    work_nm_rad: f32,
    /// The work without its sign.
    effort_nm_rad: f32,
}

impl Motion {
    fn is_against_torque(&self) -> bool {
        self.work_nm_rad < -0.5 * self.effort_nm_rad
    }

    /// What the load tells, if it has moved by more than this fraction of the motion of the motor.
    fn cause(&self, smallest: f32) -> Cause {
        let along_rad = if self.motor_rad < 0.0 { -self.load_rad } else { self.load_rad };
        let least_rad = smallest * Real::abs(self.motor_rad);
        if along_rad > least_rad {
            Cause::PowerStage
        } else if along_rad < -least_rad {
            Cause::MotorEncoder
        } else {
            Cause::Unknown
        }
    }

    /// Whether motor and load turn against each other, which no gap and no shaft explains.
    fn is_against_load(&self) -> bool {
        self.cause(0.5) == Cause::MotorEncoder
    }

    fn violation(&self) -> Violation {
        let (value, detail) = (Real::abs(self.motor_rad), self.cause(SMALLEST_LOAD) as u32);
        Violation { code: FaultCode::MotorAgainstTorque, value, limit: MOTION_RAD, detail }
    }
}

/// The first motion of the motor in a run.
pub(super) struct MotorDirection {
    torque_limit_nm: f32,
    is_judged: bool,
    motion: Motion,
    /// The motion when its first half was done.
    half: Option<Motion>,
}

impl MotorDirection {
    pub(super) fn new(torque_limit_nm: f32, from_rest: bool) -> Self {
        Self { torque_limit_nm, is_judged: !from_rest, motion: Motion::default(), half: None }
    }

    /// Whether nothing is left to check.
    pub(super) fn is_judged(&self) -> bool {
        self.is_judged
    }

    /// Takes the motion of motor and load in a period until it [`is_judged`](Self::is_judged), the way to the reference before the
    /// run's first motion, all in rad at the motor, and the torque in N m of that period.
    ///
    /// # Errors
    /// The motor ran away from its torque.
    pub(super) fn check(
        &mut self,
        [motor_rad, load_rad]: [f32; 2],
        way_rad: f32,
        torque_nm: f32,
    ) -> Result<(), Violation> {
        let all = &mut self.motion;
        all.steps += 1.0;
        all.motor_rad += motor_rad;
        all.load_rad += load_rad;
        all.work_nm_rad += torque_nm * motor_rad;
        all.effort_nm_rad += Real::abs(torque_nm * motor_rad);
        let (all, moved_rad) = (*all, Real::abs(all.motor_rad));
        if moved_rad < 0.5 * MOTION_RAD {
            self.half = None;
            return Ok(());
        }
        let half = *self.half.get_or_insert(all);
        // Nothing is forgotten: the work isn't negative since the rest before the run, and may be since any later instant.
        if moved_rad < MOTION_RAD || !self.has_torque() {
            return Ok(());
        }
        self.is_judged = true;
        let half_rad = Real::abs(half.motor_rad);
        let is_faster = (moved_rad - half_rad) * half.steps >= FASTER * half_rad * (all.steps - half.steps);
        let is_away = if all.motor_rad < 0.0 { way_rad } else { -way_rad } > SMALLEST_WAY_RAD;
        let runs_away = all.is_against_load() || is_faster && is_away;
        if all.is_against_torque() && runs_away { Err(all.violation()) } else { Ok(()) }
    }

    /// The cause of a twist beyond its limit, if a motor encoder of the wrong direction is.
    pub(super) fn explains_twist(&self) -> Option<Violation> {
        let is_explained = !self.is_judged
            && self.has_torque()
            && self.motion.is_against_load()
            && self.motion.is_against_torque();
        is_explained.then(|| self.motion.violation())
    }

    fn has_torque(&self) -> bool {
        let moved_rad = Real::abs(self.motion.motor_rad);
        self.motion.effort_nm_rad >= SMALLEST_TORQUE * self.torque_limit_nm * moved_rad
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMIT_NM: f32 = 20.0;

    /// A motor with this speed in rad per step, and what changes it: by 1 N m, and in each step.
    #[derive(Clone, Copy)]
    struct Motor {
        speed: f32,
        gain: f32,
        push: f32,
        /// Motion of the load by that of the motor.
        load: f32,
        /// Speed that a voltage of 1 N m leads to, if any.
        speed_per_nm: Option<f32>,
    }

    const REVERSED: Motor = Motor { speed: 0.0, gain: -1e-4, push: 0.0, load: 1.0, speed_per_nm: None };

    /// The verdict on a motor on its way to a reference, under a torque of its position.
    fn verdict(
        mut motor: Motor,
        reference_rad: f32,
        torque_nm: impl Fn(f32) -> f32,
    ) -> Result<(), Violation> {
        let mut direction = MotorDirection::new(LIMIT_NM, true);
        let mut at_rad = 0.0;
        for _ in 0..2_000 {
            let torque_nm = torque_nm(at_rad);
            motor.speed += motor.gain * torque_nm + motor.push;
            if let Some(speed_per_nm) = motor.speed_per_nm {
                motor.speed += 0.05 * (speed_per_nm * torque_nm - motor.speed);
            }
            at_rad += motor.speed;
            if !direction.is_judged() {
                direction.check([motor.speed, motor.load * motor.speed], reference_rad, torque_nm)?;
            }
        }
        Ok(())
    }

    #[test]
    fn a_motor_that_runs_away_from_its_torque_is_a_fault_within_a_rad() {
        for (load, detail) in [(1.0, 1), (-1.0, 2), (0.0, 0)] {
            for torque_nm in [1.5, -25.0] {
                let motor = Motor { load, ..REVERSED };
                let violation = verdict(motor, torque_nm, |_| torque_nm).expect_err("a fault");
                assert_eq!((violation.code, violation.detail), (FaultCode::MotorAgainstTorque, detail));
                assert!((1.0..1.2).contains(&violation.value), "{}", violation.value);
            }
        }
    }

    #[test]
    fn a_controller_with_the_wrong_sign_is_a_fault() {
        // A spring to 2 rad, pushed away by its own torque.
        let to = |at_rad: f32| 5.0 * (2.0 - at_rad);
        assert!(verdict(REVERSED, 2.0, to).is_err());
        assert_eq!(verdict(Motor { gain: 1e-4, ..REVERSED }, 2.0, to), Ok(()));
    }

    #[test]
    fn a_reversed_stage_without_a_current_loop_is_a_fault_too() {
        let motor = Motor { gain: 0.0, speed_per_nm: Some(-2e-3), ..REVERSED };
        assert!(verdict(motor, 2.0, |_| 10.0).is_err());
    }

    #[test]
    fn a_motor_that_moves_otherwise_is_not_at_fault() {
        let still = Motor { gain: 0.0, ..REVERSED };
        for (case, motor, reference_rad, torque_nm) in [
            ("brakes", Motor { speed: -0.02, gain: 1e-5, ..REVERSED }, 1.0, 2.0),
            ("is turned by hand", Motor { speed: -0.02, ..still }, 1.0, 2.0),
            ("needs three steps", Motor { speed: -0.4, ..still }, 1.0, 2.0),
            ("has too little torque to tell", REVERSED, 1.0, 0.04 * LIMIT_NM),
            ("lowers a weight", Motor { gain: 1e-4, push: -6e-4, ..REVERSED }, -3.0, 5.0),
            ("is pushed away while it holds its place", Motor { push: -1e-3, ..still }, 0.0, 2.0),
        ] {
            assert_eq!(verdict(motor, reference_rad, |_| torque_nm), Ok(()), "{case}");
        }
    }

    #[test]
    fn a_motor_that_drifts_and_brakes_later_is_not_at_fault() {
        // Too little torque to tell in the first rad; in the second one the motor gives back what the first one gave it.
        let mut direction = MotorDirection::new(LIMIT_NM, true);
        let (mut speed, mut at_rad) = (0.0_f32, 0.0_f32);
        while at_rad < 2.004 {
            let torque_nm = match at_rad {
                ..1.0 => 0.95,
                1.45..1.5 => 6.0,
                1.98.. => -48.0,
                _ => 0.0,
            };
            speed += 2e-6 * torque_nm;
            at_rad += speed;
            direction.check([speed, 0.0], -1.0, torque_nm).expect("no fault");
        }
        assert!(direction.is_judged());
    }

    #[test]
    fn dither_is_no_motion() {
        let mut direction = MotorDirection::new(LIMIT_NM, true);
        for step in 0..10_000 {
            let motor_rad = if step % 2 == 0 { 0.01 } else { -0.01 };
            assert_eq!(direction.check([motor_rad, 0.0], 1.0, -100.0 * motor_rad), Ok(()));
        }
        assert!(!direction.is_judged());
    }

    #[test]
    fn a_twist_is_explained_by_a_motor_that_turns_against_torque_and_load() {
        let after = |motor_rad: f32, load_rad: f32| {
            let mut direction = MotorDirection::new(LIMIT_NM, true);
            direction.check([motor_rad, load_rad], 1.0, 5.0).expect("less than the motion");
            direction.explains_twist().map(|it| it.detail)
        };
        assert_eq!(after(-0.2, 0.2), Some(2));
        assert_eq!(after(-0.2, 0.0), None, "the load encoder is lost");
        assert_eq!(after(0.2, -0.2), None, "the load encoder is reversed");
        assert_eq!(after(0.0, 0.2), None, "the motor encoder is lost");
    }
}
