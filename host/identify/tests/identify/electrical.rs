//! The electrical side of motors that the estimator doesn't know, behind the model of bridge and sensor.

use std::f64::consts::TAU;

use lashloop_identify::Instruments;
use lashloop_identify::electrical::{
    Checked, ElectricalError, ElectricalTrain, HeldCurrents, MadeSteps, Motor, Stated, Steps,
    commission_motor,
};
use lashloop_identify::excitation::{Guard, Halt, Limits};
use lashloop_plant::electrical::{Bridge, Circuit, CurrentSensor, ElectricalParameters};
use lashloop_plant::random::{Pcg64Mcg, SeedableRng, uniform};

const PERIOD_US: u32 = 1000;
/// Periods of the modulation in a control period.
const PULSES: usize = 20;
/// Steps of the integration in half a period of the modulation.
const PARTS: u32 = 4;
const COUNTS_PER_REV: u32 = 4000;
const LIMITS: Limits =
    Limits { torque_nm: 20.0, motor_speed_rad_s: 400.0, load_speed_rad_s: 1e3, load_travel_rad: 1e3 };

/// A motor with a flywheel on a bridge, and a drive with stated values and the loop of the firmware.
struct Bench {
    circuit: Circuit,
    sensor: CurrentSensor,
    stated: Stated,
    inertia_kg_m2: f64,
    friction_nm: f64,
    /// What the sensor shows per A.
    sense: f64,
    made: Vec<String>,
    moved: Vec<f64>,
}

impl Bench {
    fn new(parameters: ElectricalParameters, stated: Stated) -> Self {
        Self {
            circuit: Circuit::new(parameters),
            sensor: CurrentSensor::new(1),
            stated,
            inertia_kg_m2: 1e-3,
            friction_nm: 0.05,
            sense: 1.0,
            made: Vec::new(),
            moved: Vec::new(),
        }
    }

    fn commission(&mut self) -> Result<Motor, ElectricalError<()>> {
        let instruments = Instruments::exact(COUNTS_PER_REV, COUNTS_PER_REV, 0);
        let stated = self.stated;
        commission_motor(self, &instruments, &LIMITS, PERIOD_US, &stated)
    }
}

impl ElectricalTrain for Bench {
    type Error = ();

    fn hold(&mut self, motion: &HeldCurrents, mut guard: Guard) -> Result<Option<MadeSteps>, ()> {
        self.made.push(motion.name.clone());
        let Stated { resistance_ohm, inductance_h, torque_constant_nm_a, .. } = self.stated;
        let it = *self.circuit.parameters();
        let pulse_s = 1e-6 * f64::from(PERIOD_US) / PULSES as f64;
        let range_a = it.sense_range_a;
        let offset_a: f64 = (0..1024).map(|_| self.sensor.read(&it, 0.0) * range_a).sum::<f64>() / 1024.0;
        // A quarter of the stated inductance, as the commissioning sets it.
        let reset = 1.0 - (-resistance_ohm * pulse_s / (0.25 * inductance_h)).exp();
        let gain = 0.48 * resistance_ohm / reset;
        let (mut integral_v, mut duty, mut speed, mut angle) = (0.0, 0.0, 0.0_f64, 0.3);
        let (mut sums, mut steps, mut halt) = ([0.0; 2], Steps { period_s: 1e-3, ..Steps::default() }, None);
        let mut largest_a = 0.0_f64;
        for &wanted_a in &motion.current_a {
            let counts = (angle / TAU * f64::from(COUNTS_PER_REV)).floor();
            steps.commanded_a.push(wanted_a);
            steps.current_a.push(sums[0] / PULSES as f64);
            steps.voltage_v.push(sums[1] / PULSES as f64);
            steps.motor_rad.push(counts * TAU / f64::from(COUNTS_PER_REV));
            sums = [0.0; 2];
            halt = guard.check(counts as i64, 0);
            if halt.is_some() {
                break;
            }
            for _ in 0..PULSES {
                let shown_a =
                    self.sense * (self.sensor.read(&it, self.circuit.current_a()) * range_a - offset_a);
                let bus_v = self.circuit.bus_v();
                let limit_v = motion.largest_v.unwrap_or(0.95 * bus_v).min(0.95 * bus_v);
                sums[0] += shown_a;
                sums[1] += duty * bus_v;
                let proportional_v = gain * (wanted_a - shown_a);
                let wanted_v = proportional_v + integral_v + torque_constant_nm_a * speed;
                let voltage_v = wanted_v.clamp(-limit_v, limit_v);
                integral_v += reset * (proportional_v + voltage_v - wanted_v);
                let part_s = pulse_s / f64::from(2 * PARTS);
                for part in 0..2 * PARTS {
                    let duty = if part < PARTS { duty } else { voltage_v / bus_v };
                    let mean_a = self.circuit.step(Bridge::Driving(duty), speed, part_s);
                    largest_a = largest_a.max(mean_a.abs());
                    let torque_nm = it.torque_constant_nm_a * mean_a;
                    let friction_nm = self.friction_nm * (speed / 0.1).clamp(-1.0, 1.0);
                    speed += (torque_nm - friction_nm) / self.inertia_kg_m2 * part_s;
                    angle += speed * part_s;
                }
                duty = voltage_v / bus_v;
            }
        }
        self.moved.push(largest_a);
        // Between motions the bridge is off and the motor comes to rest.
        self.circuit = Circuit::new(it);
        if halt == Some(Halt::NotAtRest) {
            return Ok(None);
        }
        Ok(Some(MadeSteps { steps, load_counts: [0, 0], halt, trip: None }))
    }
}

fn parameters() -> ElectricalParameters {
    ElectricalParameters {
        resistance_ohm: 0.384,
        inductance_h: 4e-4,
        sense_range_a: 125.0,
        sense_noise_a: 0.1,
        ..ElectricalParameters::example()
    }
}

fn stated(of: &ElectricalParameters, factors: [f64; 3]) -> Stated {
    Stated {
        resistance_ohm: of.resistance_ohm * factors[0],
        inductance_h: of.inductance_h * factors[1],
        torque_constant_nm_a: of.torque_constant_nm_a * factors[2],
        largest_a: 60.0,
        pulse_s: 5e-5,
    }
}

fn truths(of: &ElectricalParameters) -> [f64; 3] {
    [of.resistance_ohm, of.inductance_h, of.torque_constant_nm_a]
}

#[test]
fn truth_of_hidden_motors_is_within_the_intervals() {
    let mut random = Pcg64Mcg::seed_from_u64(7);
    let (mut within, mut total) = ([0; 3], 0);
    let mut widths = [0.0; 3];
    for seed in 0..40 {
        let mut factor = |spread: f64| (spread * (2.0 * uniform(&mut random) - 1.0)).exp();
        let example = parameters();
        let hidden = ElectricalParameters {
            resistance_ohm: example.resistance_ohm * factor(0.7),
            inductance_h: example.inductance_h * factor(0.7),
            torque_constant_nm_a: example.torque_constant_nm_a * factor(0.5),
            sense_offset_a: 2.5,
            dead_time_s: 5e-7 * factor(0.7),
            ..example
        };
        let stated = stated(&hidden, [factor(0.26), factor(0.26), factor(0.26)]);
        let mut bench = Bench { inertia_kg_m2: 1e-3 * factor(1.5), ..Bench::new(hidden, stated) };
        let motor = bench.commission().unwrap_or_else(|error| panic!("motor {seed}: {error:?}"));
        let all = [motor.resistance_ohm, motor.inductance_h, motor.torque_constant_nm_a];
        for (at, (estimate, truth)) in all.into_iter().zip(truths(&hidden)).enumerate() {
            let it = estimate.expect("an estimate");
            let error = it.value / truth - 1.0;
            assert!(error.abs() < [0.05, 0.15, 0.05][at], "motor {seed}: {it:?}, {truth}");
            within[at] += i32::from((it.low..=it.high).contains(&truth));
            widths[at] += 50.0 * (it.high - it.low) / it.value / 40.0;
        }
        total += 1;
    }
    println!("R, L, k_e: {within:?} of {total} within, mean half width {widths:.2?} %");
    assert!(within.iter().all(|it| 10 * it >= 9 * total), "{within:?} of {total}");
}

#[test]
fn a_reversed_sensor_is_found_by_a_small_voltage_alone() {
    let it = parameters();
    let mut bench = Bench { sense: -1.0, ..Bench::new(it, stated(&it, [1.0; 3])) };
    let found = bench.commission();
    assert!(matches!(found, Err(ElectricalError::SensorReversed { .. })), "{found:?}");
    assert_eq!(bench.made, ["electrical-polarity-1"]);
    assert!(bench.moved[0] < 0.1 * 60.0, "{} A", bench.moved[0]);
}

#[test]
fn a_wrong_scale_of_the_sensor_is_found_with_its_factor() {
    let it = parameters();
    for sense in [0.5, 2.0] {
        let mut bench = Bench { sense, ..Bench::new(it, stated(&it, [1.0; 3])) };
        let Err(ElectricalError::Wrong { checked, factor, .. }) = bench.commission() else {
            panic!("{sense} of the current is shown");
        };
        assert_eq!(checked, Checked::Resistance, "{sense}");
        assert!((factor / f64::max(sense, 1.0 / sense) - 1.0).abs() < 0.15, "{sense}: {factor}");
        assert_eq!(bench.made.last().map(String::as_str), Some("electrical-steps-1"), "{sense}");
    }
    let mut bench = Bench { sense: 0.1, ..Bench::new(it, stated(&it, [1.0; 3])) };
    let found = bench.commission();
    assert!(matches!(found, Err(ElectricalError::NoCurrent { .. })), "{found:?}");
}

#[test]
fn a_wrong_scale_of_the_voltage_shows_in_the_torque_constant() {
    let it = parameters();
    let mut bench = Bench::new(it, stated(&it, [1.0, 1.0, 0.6]));
    let found = bench.commission();
    assert!(
        matches!(found, Err(ElectricalError::Wrong { checked: Checked::TorqueConstant, .. })),
        "{found:?}"
    );
}

#[test]
fn an_offset_that_comes_with_the_bridge_is_estimated() {
    let it = parameters();
    let mut bench = Bench::new(it, stated(&it, [1.0; 3]));
    let _ = bench.commission().expect("a motor");
    // 2 % of the range.
    struct Shifted(Bench);
    impl ElectricalTrain for Shifted {
        type Error = ();

        fn hold(&mut self, motion: &HeldCurrents, guard: Guard) -> Result<Option<MadeSteps>, ()> {
            let made = self.0.hold(motion, guard)?;
            Ok(made.map(|mut made| {
                made.steps.current_a.iter_mut().for_each(|it| *it += 2.5);
                made
            }))
        }
    }
    let instruments = Instruments::exact(COUNTS_PER_REV, COUNTS_PER_REV, 0);
    let stated = bench.stated;
    let motor =
        commission_motor(&mut Shifted(bench), &instruments, &LIMITS, PERIOD_US, &stated).expect("a motor");
    let offset = motor.current_offset_a.expect("an offset");
    assert!((offset.value - 2.5).abs() < 0.5 && offset.high - offset.low < 1.0, "{offset:?}");
}

#[test]
fn a_motor_that_can_not_turn_has_no_torque_constant() {
    let it = parameters();
    let mut bench = Bench { inertia_kg_m2: 1e3, ..Bench::new(it, stated(&it, [1.0; 3])) };
    let found = bench.commission();
    assert!(
        matches!(found, Err(ElectricalError::NotShown { name: "torque_constant_nm_a", .. })),
        "{found:?}"
    );
    assert_eq!(bench.made.last().map(String::as_str), Some("electrical-spin-3"));
}

#[test]
fn a_dead_sensor_is_named_after_the_largest_open_voltage() {
    let it = parameters();
    // A part of the current is that of another sensor, or of a neighbour.
    for sense in [0.0, 0.1] {
        let mut bench = Bench { sense, ..Bench::new(it, stated(&it, [1.0; 3])) };
        let found = bench.commission();
        assert!(matches!(found, Err(ElectricalError::NoCurrent { .. })), "{found:?}");
        assert_eq!(bench.made.len(), 4, "{:?}", bench.made);
    }
}
