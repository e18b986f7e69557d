//! The plant: keys, state, step and signals.

use lashloop_plant::limits::are_in_range;
use lashloop_plant::{Changes, Environment, Key, Plant, PlantError, PlantModel, Positions, Release, Signal};

use crate::stage::Stage;

/// The model, to be registered with a bench: `Plants::standard().with(model())`.
#[must_use]
pub fn model() -> PlantModel {
    let stiffness = |name, default, meaning| Key::number(name, "N m/rad", default, 1e-3..=1e4, meaning);
    let gap = |name, default, meaning| Key::number(name, "rad", default, 0.0..=1.0, meaning);
    let inertia = |name, default, meaning| Key::number(name, "kg m^2", default, 1e-6..=1e3, meaning);
    let friction = |name, default, meaning| Key::number(name, "N m s/rad", default, 0.0..=1e3, meaning);
    let keys = vec![
        Key::integer("substeps", "", 32, 1..=1024, "Integration steps per control period."),
        inertia("motor_inertia_kg_m2", 9.72e-4, "Inertia of the motor."),
        inertia("wheel_inertia_kg_m2", 2e-3, "Inertia of the gear wheel."),
        inertia("load_inertia_kg_m2", 7.5, "Inertia of the load."),
        friction("motor_friction_nm_s_rad", 4.3e-4, "Viscous friction of the motor."),
        friction("load_friction_nm_s_rad", 16.0, "Viscous friction of the load."),
        Key::number("reduction_ratio", "", 3.0, 0.1..=1e3, "Wheel revolutions per load revolution."),
        stiffness("motor_stage_stiffness_nm_rad", 20.0, "Stiffness between motor and wheel."),
        gap("motor_stage_dead_zone_rad", 0.02, "Half gap between motor and wheel."),
        stiffness("load_stage_stiffness_nm_rad", 1.0, "Stiffness between wheel and load, at the wheel."),
        gap("load_stage_dead_zone_rad", 0.14, "Half gap between wheel and load, at the wheel."),
        friction("stage_damping_nm_s_rad", 3e-3, "Damping of each stage in contact."),
    ];
    let summary = "Motor, gear wheel and load, with a gap in each of the two stages.";
    let changes = Changes { environment: true, ..Changes::default() };
    PlantModel::new("three-masses", summary, keys, |release| Ok(Box::new(ThreeMasses::new(release)?)))
        .with_changes(changes)
}

// Places in the state vector.
const MOTOR: usize = 0;
const WHEEL: usize = 2;
const LOAD: usize = 4;
const SUPPLIED: usize = 6;
const DISSIPATED: usize = 7;

/// Position and velocity of motor, wheel and load; energy supplied and dissipated.
type State = [f64; 8];

/// The plant in motion.
pub struct ThreeMasses {
    motor_inertia_kg_m2: f64,
    wheel_inertia_kg_m2: f64,
    load_inertia_kg_m2: f64,
    motor_friction_nm_s_rad: f64,
    load_friction_nm_s_rad: f64,
    ratio: f64,
    motor_stage: Stage,
    load_stage: Stage,
    /// Half gap of the load stage without wear.
    new_dead_zone_rad: f64,
    load_torque_nm: f64,
    substeps: u32,
    x: State,
}

static SIGNALS: [Signal; 8] = [
    Signal::new("wheel_position_rad", "rad"),
    Signal::new("motor_stage_twist_rad", "rad"),
    Signal::new("load_stage_twist_rad", "rad"),
    Signal::new("motor_stage_torque_nm", "N m"),
    Signal::new("load_stage_torque_nm", "N m"),
    Signal::new("stored_energy_j", "J"),
    Signal::new("supplied_energy_j", "J"),
    Signal::new("dissipated_energy_j", "J"),
];

impl ThreeMasses {
    fn new(release: &Release<'_>) -> Result<Self, PlantError> {
        let number = |key| release.values.number(key);
        let damping_nm_s_rad = number("stage_damping_nm_s_rad")?;
        let stage = |stiffness, gap| -> Result<_, PlantError> {
            let (stiffness_nm_rad, dead_zone_rad) = (number(stiffness)?, number(gap)?);
            Ok(Stage { stiffness_nm_rad, damping_nm_s_rad, dead_zone_rad })
        };
        let motor_stage = stage("motor_stage_stiffness_nm_rad", "motor_stage_dead_zone_rad")?;
        let load_stage = stage("load_stage_stiffness_nm_rad", "load_stage_dead_zone_rad")?;
        let start = release.start;
        // The wheel starts with the motor: the first stage stands in the middle of its gap.
        let [motor_rad, motor_rad_s] = [start.motor_position_rad, start.motor_velocity_rad_s];
        let [load_rad, load_rad_s] = [start.load_position_rad, start.load_velocity_rad_s];
        Ok(Self {
            motor_inertia_kg_m2: number("motor_inertia_kg_m2")?,
            wheel_inertia_kg_m2: number("wheel_inertia_kg_m2")?,
            load_inertia_kg_m2: number("load_inertia_kg_m2")?,
            motor_friction_nm_s_rad: number("motor_friction_nm_s_rad")?,
            load_friction_nm_s_rad: number("load_friction_nm_s_rad")?,
            ratio: number("reduction_ratio")?,
            motor_stage,
            load_stage,
            new_dead_zone_rad: load_stage.dead_zone_rad,
            load_torque_nm: 0.0,
            substeps: release.values.integer("substeps")?,
            x: [motor_rad, motor_rad_s, motor_rad, motor_rad_s, load_rad, load_rad_s, 0.0, 0.0],
        })
    }

    /// Twist of both stages at these positions; of velocities their rates.
    fn twists(&self, [motor, wheel, load]: [f64; 3]) -> [f64; 2] {
        [motor - wheel, wheel - self.ratio * load]
    }

    /// Torque of both stages, and the power that their dampers dissipate.
    fn stages(&self, x: &State) -> ([f64; 2], f64) {
        let twists = self.twists([x[MOTOR], x[WHEEL], x[LOAD]]);
        let rates = self.twists([x[MOTOR + 1], x[WHEEL + 1], x[LOAD + 1]]);
        let (first_nm, first_w) = self.motor_stage.torque(twists[0], rates[0]);
        let (second_nm, second_w) = self.load_stage.torque(twists[1], rates[1]);
        ([first_nm, second_nm], first_w + second_w)
    }

    fn rates(&self, x: &State, torque_nm: f64) -> State {
        let ([first_nm, second_nm], dampers_w) = self.stages(x);
        let [motor, wheel, load] = [x[MOTOR + 1], x[WHEEL + 1], x[LOAD + 1]];
        let motor_friction_nm = self.motor_friction_nm_s_rad * motor;
        let load_friction_nm = self.load_friction_nm_s_rad * load;
        let load_nm = self.ratio * second_nm + self.load_torque_nm - load_friction_nm;
        [
            motor,
            (torque_nm - first_nm - motor_friction_nm) / self.motor_inertia_kg_m2,
            wheel,
            (first_nm - second_nm) / self.wheel_inertia_kg_m2,
            load,
            load_nm / self.load_inertia_kg_m2,
            torque_nm * motor + self.load_torque_nm * load,
            dampers_w + motor_friction_nm * motor + load_friction_nm * load,
        ]
    }

    /// One step of the Runge-Kutta method of fourth order.
    fn advance(&mut self, torque_nm: f64, h_s: f64) {
        let along =
            |x: &State, rates: &State, h_s: f64| -> State { std::array::from_fn(|i| x[i] + h_s * rates[i]) };
        let k1 = self.rates(&self.x, torque_nm);
        let k2 = self.rates(&along(&self.x, &k1, 0.5 * h_s), torque_nm);
        let k3 = self.rates(&along(&self.x, &k2, 0.5 * h_s), torque_nm);
        let k4 = self.rates(&along(&self.x, &k3, h_s), torque_nm);
        let mean: State = std::array::from_fn(|i| (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]) / 6.0);
        self.x = along(&self.x, &mean, h_s);
    }

    fn elastic_energy_j(&self) -> f64 {
        let twists = self.twists([self.x[MOTOR], self.x[WHEEL], self.x[LOAD]]);
        self.motor_stage.energy_j(twists[0]) + self.load_stage.energy_j(twists[1])
    }

    fn stored_energy_j(&self) -> f64 {
        let kinetic = |inertia_kg_m2: f64, mass: usize| 0.5 * inertia_kg_m2 * self.x[mass + 1].powi(2);
        kinetic(self.motor_inertia_kg_m2, MOTOR)
            + kinetic(self.wheel_inertia_kg_m2, WHEEL)
            + kinetic(self.load_inertia_kg_m2, LOAD)
            + self.elastic_energy_j()
    }
}

impl Plant for ThreeMasses {
    fn signals(&self) -> &[Signal] {
        &SIGNALS
    }

    fn truth(&self, values: &mut [f64]) {
        let twists = self.twists([self.x[MOTOR], self.x[WHEEL], self.x[LOAD]]);
        let (torques, _) = self.stages(&self.x);
        values.copy_from_slice(&[
            self.x[WHEEL],
            twists[0],
            twists[1],
            torques[0],
            torques[1],
            self.stored_energy_j(),
            self.x[SUPPLIED],
            self.x[DISSIPATED],
        ]);
    }

    fn positions(&self) -> Positions {
        Positions { motor_position_rad: self.x[MOTOR], load_position_rad: self.x[LOAD] }
    }

    fn step(&mut self, torque_nm: f64, dt_s: f64) -> Result<(), PlantError> {
        for _ in 0..self.substeps {
            self.advance(torque_nm, dt_s / f64::from(self.substeps));
        }
        if are_in_range(&self.x) { Ok(()) } else { Err(PlantError::NotFinite { torque_nm }) }
    }

    /// The load stage wears. A gap that widens lets its spring unwind; the energy set free counts as dissipated.
    fn set_environment(&mut self, environment: Environment) -> Result<(), PlantError> {
        let before_j = self.elastic_energy_j();
        self.load_stage.dead_zone_rad = self.new_dead_zone_rad + environment.gap_growth_rad;
        self.load_torque_nm = environment.load_torque_nm;
        self.x[DISSIPATED] += before_j - self.elastic_energy_j();
        Ok(())
    }
}
