//! Hidden plants: drawn at random, reached through torques and counts only.
//!
//! Inertias, stiffness, damping, frictions and lag are within a factor of 2 of the paper's bench, evenly in their logarithm;
//! the gap is 0.02 to 0.5 rad wide. The plant is integrated in four times as many steps as the estimator's model.

use lashloop_identify::excitation::{DriveTrain, Guard, Halt, Made, PlannedMotion};
use lashloop_identify::{Instruments, Series, SeriesError};
use lashloop_plant::backlash_shaft::{BacklashShaft, CoggingParameters, ShaftParameters};
use lashloop_plant::encoder::Encoder;
use lashloop_plant::random::{Pcg64Mcg, SeedableRng, uniform};
use lashloop_plant::{Mechanics, Plant, RunningPlant, Start, TransportDelay};

const DELAY_US: u32 = 1000;
const SUBSTEPS: u32 = 16;

/// What plants without errors have no truth of.
const ERRORS: [&str; 7] = [
    "cogging_per_turn",
    "cogging_phase_rad",
    "torque_uncertainty_nm",
    "motor_eccentricity_rad",
    "motor_eccentricity_phase_rad",
    "load_eccentricity_rad",
    "load_eccentricity_phase_rad",
];

/// A drive train whose parameters a commissioning doesn't get.
pub struct HiddenPlant {
    /// Masses, spring and gap.
    pub mechanics: Mechanics,
    /// Damping, dry friction and lag.
    pub shaft: ShaftParameters,
    /// Of motor and load.
    pub counts_per_rev: [u32; 2],
    /// 1 or -1, of motor and load.
    pub signs: [i64; 2],
    /// Where it stands before the first motion.
    pub start: Start,
    /// The plant in its present state, from the first motion on.
    present: Option<Present>,
    /// What torque and encoders are off by.
    pub errors: Errors,
    /// What a commissioning gets of the encoders, of motor and load.
    encoder_error_rad: [f64; 2],
    /// Time without torque before each motion, in s.
    pub between_s: f64,
}

/// What torque and encoders of a plant are off by. All phases are 0 at the zero of the encoders.
#[derive(Debug, Clone, Copy, Default)]
pub struct Errors {
    /// Offset of the torque at the motor.
    pub offset_nm: f64,
    /// Amplitude of the cogging.
    pub cogging_nm: f64,
    /// Its periods per turn of the motor.
    pub per_turn: u32,
    /// Of the encoders of motor and load.
    pub eccentricity_rad: [f64; 2],
    /// Angle of the load by which the drive train is turned at the start.
    pub turned_rad: f64,
    /// Edges of both encoders jitter uniformly by up to this in either direction.
    pub noise_counts: f64,
}

struct Present {
    plant: RunningPlant<BacklashShaft>,
    encoders: [Encoder; 2],
}

impl HiddenPlant {
    /// Control period of its motions.
    pub const PERIOD_US: u32 = 1000;

    /// PCG XSL 128/64, seeded with the number of the plant.
    pub fn draw(seed: u64) -> Self {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let mut within = |low: f64, high: f64| low + (high - low) * uniform(&mut random);
        let (mut mechanics, mut shaft) = (Mechanics::paper(), ShaftParameters::paper());
        for value in [
            &mut mechanics.motor_inertia_kg_m2,
            &mut mechanics.motor_friction_nm_s_rad,
            &mut mechanics.load_inertia_kg_m2,
            &mut mechanics.load_friction_nm_s_rad,
            &mut mechanics.stiffness_nm_rad,
            &mut shaft.shaft_damping_nm_s_rad,
            &mut shaft.load.coulomb_nm,
            &mut shaft.motor.coulomb_nm,
            &mut shaft.current_lag_s,
        ] {
            *value *= within(-1.0, 1.0).exp2();
        }
        for value in [&mut shaft.load.velocity_rad_s, &mut shaft.motor.velocity_rad_s] {
            *value *= within(-0.5, 0.5).exp2();
        }
        mechanics.ratio = within(2.0, 6.0);
        mechanics.dead_zone_rad = 0.5 * within(0.02, 0.5);
        shaft.load.stiction_nm = shaft.load.coulomb_nm * within(1.0, 1.5);
        shaft.motor.stiction_nm = shaft.motor.coulomb_nm * within(1.0, 1.5);
        shaft.load_asymmetry = within(-0.2, 0.2);
        let counts_per_rev = [within(2e3, 1e4) as u32, within(2e3, 1e4) as u32];
        let signs = [within(-1.0, 1.0), within(-1.0, 1.0)].map(|it| if it < 0.0 { -1 } else { 1 });
        let load_rad = within(-1.0, 1.0);
        let twist_rad = within(-0.9, 0.9) * mechanics.dead_zone_rad;
        let start = Start::at_rest(load_rad, mechanics.ratio * load_rad + twist_rad);
        Self {
            mechanics,
            shaft,
            counts_per_rev,
            signs,
            start,
            present: None,
            errors: Errors::default(),
            encoder_error_rad: [0.0; 2],
            between_s: 0.0,
        }
    }

    /// The same plant with encoders whose edges jitter uniformly by up to this in either direction.
    pub fn with_noise(self, noise_counts: f64) -> Self {
        Self { errors: Errors { noise_counts, ..self.errors }, ..self }
    }

    /// The same plant with these errors, and with encoders that are stated to be off by this.
    pub fn with_errors(self, errors: Errors, encoder_error_rad: [f64; 2]) -> Self {
        Self { errors, encoder_error_rad, ..self }
    }

    /// What a commissioning gets of it.
    pub fn instruments(&self) -> Instruments {
        let [motor, load] = self.counts_per_rev;
        let exact = Instruments::exact(motor, load, DELAY_US).with_encoder_error_rad(self.encoder_error_rad);
        Instruments { noise_counts: self.errors.noise_counts, ..exact }
    }

    /// Whether the plant has a truth for this quantity: without errors, what is left of them is that of a power stage.
    pub fn has_truth(&self, name: &str) -> bool {
        self.errors.cogging_nm != 0.0 || !ERRORS.contains(&name)
    }

    /// The true value of a quantity by its name.
    pub fn truth(&self, name: &str) -> f64 {
        let Self { mechanics, shaft, errors, .. } = self;
        let [motor_rad, load_rad] = errors.eccentricity_rad;
        let asymmetry = shaft.load_asymmetry;
        match name {
            "reduction_ratio" => mechanics.ratio,
            "gap_width_rad" => 2.0 * mechanics.dead_zone_rad,
            "dead_zone_rad" => mechanics.dead_zone_rad,
            "stiffness_nm_rad" => mechanics.stiffness_nm_rad,
            "shaft_damping_nm_s_rad" => shaft.shaft_damping_nm_s_rad,
            "motor_inertia_kg_m2" => mechanics.motor_inertia_kg_m2,
            "motor_friction_nm_s_rad" => mechanics.motor_friction_nm_s_rad,
            "motor_coulomb_nm" => shaft.motor.coulomb_nm,
            "motor_stiction_nm" => shaft.motor.stiction_nm,
            "motor_stribeck_rad_s" => shaft.motor.velocity_rad_s,
            "load_inertia_kg_m2" => mechanics.load_inertia_kg_m2,
            "load_friction_nm_s_rad" => mechanics.load_friction_nm_s_rad,
            "load_coulomb_nm" => shaft.load.coulomb_nm,
            "load_coulomb_forward_nm" => shaft.load.coulomb_nm * (1.0 + asymmetry),
            "load_coulomb_backward_nm" => shaft.load.coulomb_nm * (1.0 - asymmetry),
            "load_stiction_nm" => shaft.load.stiction_nm,
            "load_stiction_forward_nm" => shaft.load.stiction_nm * (1.0 + asymmetry),
            "load_stiction_backward_nm" => shaft.load.stiction_nm * (1.0 - asymmetry),
            "load_stribeck_rad_s" => shaft.load.velocity_rad_s,
            "load_friction_asymmetry" => asymmetry,
            "current_lag_ms" => 1e3 * shaft.current_lag_s,
            "inertia_at_motor_kg_m2" => {
                mechanics.motor_inertia_kg_m2 + mechanics.load_inertia_kg_m2 / mechanics.ratio.powi(2)
            }
            "torque_offset_nm" => errors.offset_nm,
            "cogging_nm" => errors.cogging_nm,
            "cogging_per_turn" => f64::from(errors.per_turn),
            // A law takes away the offset alone.
            "torque_uncertainty_nm" => errors.cogging_nm / 2.0_f64.sqrt(),
            "motor_eccentricity_rad" => motor_rad,
            "load_eccentricity_rad" => load_rad,
            "cogging_phase_rad" | "motor_eccentricity_phase_rad" | "load_eccentricity_phase_rad" => 0.0,
            other => panic!("no truth for {other}"),
        }
    }

    fn release(&self) -> Present {
        let Errors { offset_nm, cogging_nm, per_turn, eccentricity_rad, turned_rad, .. } = self.errors;
        let shaft = ShaftParameters {
            torque_offset_nm: offset_nm,
            cogging: CoggingParameters { amplitude_nm: cogging_nm, per_turn: f64::from(per_turn.max(1)) },
            ..self.shaft
        };
        let plant = BacklashShaft::new(self.mechanics, shaft, SUBSTEPS).expect("a plant in its ranges");
        let encoders = [0, 1].map(|at| {
            let encoder = Encoder::new(self.counts_per_rev[at], self.errors.noise_counts, 1 + at as u64);
            let encoder = encoder.and_then(|it| it.with_eccentricity(eccentricity_rad[at]));
            encoder.expect("an encoder in its ranges")
        });
        let start = Start {
            load_position_rad: self.start.load_position_rad + turned_rad,
            motor_position_rad: self.start.motor_position_rad + self.mechanics.ratio * turned_rad,
            ..self.start
        };
        Present { plant: RunningPlant::released(plant, start), encoders }
    }
}

impl DriveTrain for HiddenPlant {
    type Error = SeriesError;

    /// The motion begins where the one before has ended.
    fn make(&mut self, motion: &PlannedMotion, mut guard: Guard) -> Result<Option<Made>, SeriesError> {
        let mut present = self.present.take().unwrap_or_else(|| self.release());
        let Present { plant, encoders } = &mut present;
        let period_s = f64::from(Self::PERIOD_US) / 1e6;
        for _ in 0..(self.between_s / period_s).round() as u32 {
            plant.step(0.0, period_s).expect("a plant that can be followed");
        }
        let mut delay = TransportDelay::new(DELAY_US, Self::PERIOD_US);
        let (mut torques_nm, mut counts) = (Vec::new(), [Vec::new(), Vec::new()]);
        let mut halt = None;
        for &planned_nm in &motion.torque_nm {
            let positions = Plant::positions(plant);
            let read = [positions.motor_position_rad, positions.load_position_rad];
            let now = [0, 1].map(|at| self.signs[at] * encoders[at].read(read[at]));
            counts.iter_mut().zip(now).for_each(|(counts, now)| counts.push(now));
            halt = guard.check(now[0], now[1]);
            let torque_nm = if halt.is_some() { 0.0 } else { planned_nm };
            torques_nm.push(torque_nm);
            for (held_nm, held_s) in delay.step(torque_nm) {
                plant.step(held_nm, held_s).expect("a plant that can be followed");
            }
            if halt.is_some() {
                break;
            }
        }
        self.present = Some(present);
        if halt == Some(Halt::NotAtRest) {
            return Ok(None);
        }
        let [motor_counts, load_counts] = counts;
        let series = Series::new(Self::PERIOD_US, torques_nm, motor_counts, load_counts)?;
        Ok(Some(Made { series, halt, peaks: guard.peaks() }))
    }
}
