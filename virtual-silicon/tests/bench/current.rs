//! The current loop of the image, with a motor at the bridge.

use std::time::Duration;

use lashloop_plant::electrical::{ElectricalParameters, ReverseCurrent};
use lashloop_protocol::enums::{FaultCode, Outcome, ParameterValue};
use lashloop_silicon::motor_at_bridge::{BridgeInputs, MotorAtBridge};
use lashloop_silicon::symbols::Symbols;

use crate::bench::{Bench, image, image_of};
use crate::host::Host;
use crate::turntable::{self, Speeds};

/// Largest torque of the tests, N m.
const LIMIT_NM: f32 = 5.0;
/// Voltage of the bus at the end of its converter.
const BUS_RANGE_V: f32 = 60.0;
/// Names by their places in the lists of the drive.
const BY_CURRENT: u32 = 2;
const COMPLEMENTARY: u32 = 5;

/// The motor of the tests, with the dead time of the board.
fn motor() -> ElectricalParameters {
    ElectricalParameters { dead_time_s: 5e-7, ..ElectricalParameters::example() }
}

/// What a drive has to know of its motor, and a limit of the torque.
fn settings(motor: &ElectricalParameters) -> Vec<(&'static str, ParameterValue)> {
    let numbers = [
        ("motor_resistance_ohm", motor.resistance_ohm as f32),
        ("motor_inductance_h", motor.inductance_h as f32),
        ("torque_constant_nm_a", motor.torque_constant_nm_a as f32),
        ("current_range_a", motor.sense_range_a as f32),
        ("current_limit_a", 50.0),
        ("supply_range_v", BUS_RANGE_V),
        ("duty_min", 0.0),
        ("duty_max", 1.0),
        ("torque_limit_nm", LIMIT_NM),
    ];
    let mut settings = vec![
        ("torque_source", ParameterValue::U32(BY_CURRENT)),
        ("stage_mode", ParameterValue::U32(COMPLEMENTARY)),
        ("pwm_frequency_hz", ParameterValue::U32(motor.pwm_hz as u32)),
    ];
    settings.extend(numbers.map(|(name, value)| (name, ParameterValue::F32(value))));
    settings
}

/// A drive with this motor at its bridge and a shaft that stands still.
fn idle(image: &Symbols, motor: ElectricalParameters) -> Host {
    let at_bridge = MotorAtBridge::new(motor, BridgeInputs::Halves, BUS_RANGE_V.into(), 1);
    let speeds = Speeds::default();
    let train = turntable::drive_train(&speeds, (0, 0)).behind_motor(at_bridge);
    let mut host = Host::of(Bench::with_turntable(image, train, speeds));
    host.set_all(&settings(&motor));
    // The offset of the sensor.
    host.bench.advance(Duration::from_millis(80));
    host
}

/// Current of the motor, A.
fn current_a(host: &mut Host) -> f64 {
    host.bench.act(|_, site| site.train.motor_at_bridge().expect("a motor").circuit().current_a())
}

/// Torques in N m, every 25 us for this time, from a tick on.
fn torques(host: &mut Host, motor: &ElectricalParameters, time: Duration) -> Vec<f64> {
    let step = Duration::from_micros(25);
    let count = time.as_micros() / step.as_micros();
    (0..count)
        .map(|_| {
            host.bench.advance(step);
            motor.torque_constant_nm_a * current_a(host)
        })
        .collect()
}

#[test]
fn a_step_of_torque_is_63_percent_done_in_300_us_and_overshoots_by_at_most_10_percent() {
    for board in ["stm32f405", "nucleo-f446re", "nucleo-f429zi"] {
        let motor = motor();
        let mut host = idle(&image_of(board), motor);
        host.run();
        host.steps(3, 0.0);
        assert!(current_a(&mut host).abs() < 0.2, "{board}: a current at no torque");
        // The law asks for more than the limit.
        host.refer(1.0);
        let torques = torques(&mut host, &motor, Duration::from_millis(4));
        let begin = torques.iter().position(|nm| *nm > 0.05 * f64::from(LIMIT_NM)).expect("a torque");
        let rise = torques.iter().position(|nm| *nm > 0.63 * f64::from(LIMIT_NM)).expect("a rise");
        let most = torques.iter().fold(0.0_f64, |most, nm| most.max(*nm));
        let last = torques.last().expect("torques");
        println!(
            "{board}: 63 % after {} us, overshoot {:.1} %, {last:.3} N m in the end",
            25 * (rise - begin + 1),
            20.0 * (most - 5.0)
        );
        // A pulse and a sample may pass before the first 5 %.
        assert!(rise - begin <= 8, "{board}: {torques:?}");
        assert!(most <= 1.1 * f64::from(LIMIT_NM), "{board}: {most} N m");
        assert!((last - f64::from(LIMIT_NM)).abs() < 0.05, "{board}: {last} N m");
        assert_eq!(host.faults(), []);
    }
}

#[test]
fn an_offset_of_the_sensor_leaves_a_thousandth_of_the_limit() {
    for offset_a in [-2.0, 2.0] {
        let motor = ElectricalParameters { sense_offset_a: offset_a, sense_noise_a: 0.05, ..motor() };
        let mut host = idle(&image(), motor);
        host.run();
        for reference_rad in [1.0, -1.0] {
            host.steps(5, reference_rad);
            let mut torques = Vec::new();
            for _ in 0..10 {
                host.refer(reference_rad);
                torques.extend(self::torques(&mut host, &motor, Duration::from_millis(1)));
            }
            let mean_nm = torques.iter().sum::<f64>() / torques.len() as f64;
            let error_nm = (mean_nm.abs() - f64::from(LIMIT_NM)).abs();
            println!("offset {offset_a} A: {error_nm:.4} N m off at {mean_nm:.3} N m");
            // The resolution of the converter is 0.012 N m, a thousandth of 20 N m is 0.02.
            assert!(error_nm <= 0.02, "{mean_nm} N m");
        }
    }
}

/// The drive sees a motor that barely moves: its encoder has a count for each radian. So the loop alone meets the back-EMF.
#[test]
fn a_turning_motor_has_its_torque() {
    let motor = motor();
    for speed_rad_s in [-60.0, 60.0, 120.0] {
        let mut host = idle(&image(), motor);
        host.run();
        host.bench.turn(speed_rad_s, 0.0);
        host.steps(20, 1.0);
        let torques = torques(&mut host, &motor, Duration::from_millis(2));
        let mean_nm = torques.iter().sum::<f64>() / torques.len() as f64;
        println!("{speed_rad_s} rad/s: {mean_nm:.4} N m");
        assert!((mean_nm - f64::from(LIMIT_NM)).abs() < 0.02, "{mean_nm} N m at {speed_rad_s} rad/s");
    }
}

#[test]
fn a_sensor_that_is_off_by_a_quarter_of_its_range_arms_nothing() {
    let motor = ElectricalParameters { sense_offset_a: 25.0, ..motor() };
    let mut host = idle(&image(), motor);
    assert_eq!(host.refusal_to_arm(), (Outcome::PowerStageFault, 6));
}

/// A sensor that is wired the wrong way round: the loop drives the current up.
#[test]
fn an_overcurrent_turns_the_bridge_off_within_a_period_of_the_modulation() {
    let motor = motor();
    let mut host = idle(&image(), motor);
    assert_eq!(host.set("current_direction", ParameterValue::U32(1)), Outcome::Accepted);
    host.run();
    host.refer(1.0);
    let instant = (0..6_000).find_map(|_| {
        host.bench.advance(Duration::from_micros(1));
        // The motor is followed twice in a period.
        (current_a(&mut host).abs() > 75.0).then(|| host.bench.now() - Duration::from_micros(26))
    });
    let instant = instant.expect("1.5 times the largest current");
    host.steps(2, 1.0);
    let off = host.bench.time_to_off(instant).expect("the bridge off");
    println!("off {off:?} after 1.5 times the largest current");
    // A sample comes once in a period, and its interrupt takes 3 us to judge it.
    assert!(off <= Duration::from_micros(54), "{off:?}");
    let [fault] = host.faults()[..] else { panic!("one fault") };
    assert_eq!((fault.code, fault.detail), (FaultCode::PowerStage, 4));
    host.bench.advance(Duration::from_millis(5));
    assert_eq!(current_a(&mut host), 0.0);
}

/// Without samples the bridge would keep its last duty, and no current would be too large.
#[test]
fn converters_that_stop_end_the_run() {
    let motor = motor();
    let mut host = idle(&image(), motor);
    host.run();
    host.steps(5, 1.0);
    let instant = host.bench.act(|chip, _| {
        chip.stop_converters();
        chip.now()
    });
    host.steps(5, 1.0);
    let off = host.bench.time_to_off(instant).expect("the bridge off");
    println!("off {off:?} after the last sample");
    assert!(off <= Duration::from_millis(3), "{off:?}");
    let [fault] = host.faults()[..] else { panic!("one fault") };
    assert_eq!((fault.code, fault.detail), (FaultCode::PowerStage, 6));
}

/// A winding of which a fifth is left: the loop, made for the whole, holds the current below the fault's limit or switches off.
#[test]
fn a_shorted_winding_is_held_below_the_limit_or_ends_the_run() {
    let motor = motor();
    let mut host = idle(&image(), motor);
    host.run();
    host.steps(5, 1.0);
    host.bench.act(|_, site| {
        let circuit = site.train.motor_at_bridge().expect("a motor").circuit();
        circuit.parameters_mut().inductance_h *= 0.2;
        circuit.parameters_mut().resistance_ohm *= 0.2;
    });
    let torques = torques(&mut host, &motor, Duration::from_millis(5));
    let most_a = torques.iter().fold(0.0_f64, |most, nm| most.max(nm.abs() / motor.torque_constant_nm_a));
    println!("at most {most_a:.0} A");
    // 75 A and what a period adds: 48 V at 0.1 mH.
    assert!(most_a <= 75.0 + 24.0, "{most_a} A");
    // Nothing but the overcurrent may have ended the run.
    let others = host.faults().into_iter().filter(|it| (it.code, it.detail) != (FaultCode::PowerStage, 4));
    assert_eq!(others.collect::<Vec<_>>(), []);
}

#[test]
fn a_sagging_supply_winds_nothing_up() {
    let motor = ElectricalParameters { reverse_current: ReverseCurrent::Blocked, ..motor() };
    let mut host = idle(&image(), motor);
    host.run();
    host.steps(5, 1.0);
    let set_supply = |host: &mut Host, supply_v: f64| {
        host.bench.act(move |_, site| {
            let circuit = site.train.motor_at_bridge().expect("a motor").circuit();
            circuit.parameters_mut().supply_v = supply_v;
        });
    };
    // 5 N m need 10.4 V.
    set_supply(&mut host, 6.0);
    host.steps(50, 1.0);
    let weak_nm = motor.torque_constant_nm_a * current_a(&mut host);
    assert!((2.0..3.2).contains(&weak_nm), "{weak_nm} N m");
    set_supply(&mut host, 48.0);
    host.refer(1.0);
    let back = torques(&mut host, &motor, Duration::from_millis(1));
    let most = back.iter().fold(0.0_f64, |most, nm| most.max(*nm));
    // Until the next sample the whole voltage is there at once: 48 V for 50 us at 0.5 mH are 4.8 A.
    assert!(most <= f64::from(LIMIT_NM) + 1.2, "{most} N m");
    // What the limit left in the integral decays with L/R, 1 ms.
    assert!((back[39] - f64::from(LIMIT_NM)).abs() < 0.2, "{back:.3?}");
    host.steps(4, 1.0);
    let late_nm = motor.torque_constant_nm_a * current_a(&mut host);
    assert!((late_nm - f64::from(LIMIT_NM)).abs() < 0.02, "{late_nm} N m");
    assert_eq!(host.faults(), []);
}
