//! The current loop of the image, with a motor at the bridge.

pub mod faults;

use std::time::Duration;

use lashloop_plant::electrical::{ElectricalParameters, ReverseCurrent};
use lashloop_protocol::enums::{Outcome, ParameterValue};
use lashloop_protocol::message::Stop;
use lashloop_silicon::boards;
use lashloop_silicon::motor_at_bridge::{BridgeInputs, MotorAtBridge};
use lashloop_silicon::symbols::Symbols;
use lashloop_silicon::thumb::WAIT_FOR_INTERRUPT;
use lashloop_silicon::wiring::Encoder;

use crate::bench::{Bench, image, image_of};
use crate::host::Host;
use crate::turntable::{self, Speeds};

/// Largest torque of the tests, N m.
const LIMIT_NM: f32 = 5.0;
/// Voltage of the bus at the end of its converter.
pub const BUS_RANGE_V: f32 = 60.0;
/// Names by their places in the lists of the drive.
const BY_CURRENT: u32 = 2;
const COMPLEMENTARY: u32 = 5;

/// The motor of the tests, with the dead time of the board.
pub fn motor() -> ElectricalParameters {
    ElectricalParameters { dead_time_s: 5e-7, ..ElectricalParameters::example() }
}

/// What a drive has to know of its motor, and a limit of the torque.
pub fn settings(motor: &ElectricalParameters) -> Vec<(&'static str, ParameterValue)> {
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

/// A drive with this motor at its bridge and a shaft that stands still, 20 ms after power-up.
fn powered_up(image: &Symbols, motor: ElectricalParameters) -> Host {
    let at_bridge = MotorAtBridge::new(motor, BridgeInputs::Halves, BUS_RANGE_V.into(), 1);
    let speeds = Speeds::default();
    let train = turntable::drive_train(&speeds, (0, 0)).behind_motor(at_bridge);
    Host::of(Bench::with_turntable(image, train, speeds))
}

/// The same drive, which knows its motor and its sensor.
fn idle(image: &Symbols, motor: ElectricalParameters) -> Host {
    let mut host = powered_up(image, motor);
    host.set_all(&settings(&motor));
    // The offset of the sensor.
    host.bench.advance(Duration::from_millis(80));
    host
}

/// Current of the motor, A.
fn current_a(host: &mut Host) -> f64 {
    host.bench.act(|_, site| site.train.motor_at_bridge().expect("a motor").circuit().current_a())
}

/// Changes motor and supply.
fn change(host: &mut Host, change: impl FnOnce(&mut ElectricalParameters) + Send + 'static) {
    host.bench.act(|_, site| {
        change(site.train.motor_at_bridge().expect("a motor").circuit().parameters_mut());
    });
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
        println!("{speed_rad_s} rad/s: {mean_nm:.4} N m, {:?}", host.faults());
        assert!((mean_nm - f64::from(LIMIT_NM)).abs() < 0.02, "{mean_nm} N m at {speed_rad_s} rad/s");
    }
}

#[test]
fn a_supply_that_sags_by_a_fifth_is_held() {
    let motor = motor();
    let mut host = idle(&image(), motor);
    host.run();
    host.steps(5, 1.0);
    change(&mut host, |motor| motor.supply_v *= 0.8);
    host.refer(1.0);
    let torques = torques(&mut host, &motor, Duration::from_millis(4));
    let most = torques.iter().fold(0.0_f64, |most, nm| most.max((nm - f64::from(LIMIT_NM)).abs()));
    println!("{most:.3} N m off while the supply sags by a fifth");
    assert!(most < 0.1, "{most} N m");
    assert_eq!(host.faults(), []);
}

#[test]
fn a_step_of_the_loop_takes_at_most_10_us() {
    for board in ["stm32f405", "nucleo-f446re", "nucleo-f429zi"] {
        let image = image_of(board);
        let mut host = idle(&image, motor());
        let [sample, tick, link, serve, clock] = ["ADC", "TIM5", "USART2", "OTG_FS", "SysTick"]
            .map(|task| image.function(task).or_else(|_| image.function("USART3")).expect("a task"));
        let idle = image.first_in("main", WAIT_FOR_INTERRUPT).expect("the idle task") + 2;
        [sample, tick, link, serve, clock, idle].into_iter().for_each(|it| host.bench.watch(it));
        host.run();
        host.bench.act(|_, site| site.log.arrivals.clear());
        host.steps(20, 1.0);
        let arrivals = host.bench.act(|_, site| std::mem::take(&mut site.log.arrivals));
        // From sleep to sleep, without another task.
        let mut counts: Vec<_> = arrivals
            .windows(3)
            .filter(|it| [it[0].address, it[1].address, it[2].address] == [idle, sample, idle])
            .map(|it| it[2].instructions - it[1].instructions)
            .collect();
        counts.sort_unstable();
        assert!(counts.len() > 100, "{board}: {} samples", counts.len());
        let most = counts[counts.len() - 1];
        println!("{board}: {} to {most} instructions, {:.1} us", counts[0], most as f64 / 168.0);
        assert!(most <= 1_680, "{board}: {most}");
    }
}

/// The shaft turns faster than the modulation: two channels must not overtake each other between two halves of its period.
#[test]
fn an_encoder_beside_a_bridge_loses_no_count_at_speed() {
    // The back-EMF of 4 million counts per second at a count for each radian drives 0.4 A.
    let motor = ElectricalParameters {
        torque_constant_nm_a: 1e-4,
        resistance_ohm: 1e3,
        inductance_h: 1.0,
        ..motor()
    };
    let mut host = idle(&image(), motor);
    let unlimited = [("motor_speed_limit_rad_s", 1_500.0), ("load_speed_limit_rad_s", 1_500.0)];
    let unlimited = unlimited.into_iter().chain([("twist_limit_rad", 1e5), ("torque_limit_nm", 1e-3)]);
    for (name, value) in unlimited {
        assert_eq!(host.set(name, ParameterValue::F32(value)), Outcome::Accepted, "{name}");
    }
    // A motor that has rested may not run away from its torque.
    host.bench.turn(1e4, 1e4);
    host.bench.advance(Duration::from_millis(2));
    host.run();
    for speed in [4e6, -3e6] {
        host.bench.turn(speed, -0.5 * speed);
        host.steps(20, 0.0);
    }
    host.bench.turn(0.0, 0.0);
    let samples = host.steps(3, 0.0);
    let shown = host.bench.act(|_, site| [Encoder::Motor, Encoder::Load].map(|it| site.train.count(it)));
    let last = samples.last().unwrap_or_else(|| panic!("{:?}", host.faults()));
    assert_eq!([last.motor_counts, last.load_counts], shown.map(lashloop_protocol::EncoderCounts::wrapping));
    assert_eq!(host.faults(), []);
}

#[test]
fn a_sagging_supply_winds_nothing_up() {
    let motor = ElectricalParameters { reverse_current: ReverseCurrent::Blocked, ..motor() };
    let mut host = idle(&image(), motor);
    host.run();
    host.steps(5, 1.0);
    // 5 N m need 10.4 V.
    change(&mut host, |motor| motor.supply_v = 6.0);
    host.steps(50, 1.0);
    let weak_nm = motor.torque_constant_nm_a * current_a(&mut host);
    assert!((2.0..3.2).contains(&weak_nm), "{weak_nm} N m");
    change(&mut host, |motor| motor.supply_v = 48.0);
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

/// Every corner of what the drive may believe wrongly.
#[test]
fn resistance_and_inductance_off_by_30_percent_leave_the_loop_stable() {
    let motor = motor();
    for (resistance, inductance) in [(0.7, 0.7), (0.7, 1.3), (1.3, 0.7), (1.3, 1.3)] {
        let mut host = idle(&image(), motor);
        let believed = [
            ("motor_resistance_ohm", resistance * motor.resistance_ohm),
            ("motor_inductance_h", inductance * motor.inductance_h),
        ];
        for (name, value) in believed {
            assert_eq!(host.set(name, ParameterValue::F32(value as f32)), Outcome::Accepted, "{name}");
        }
        host.run();
        host.steps(3, 0.0);
        host.refer(1.0);
        let torques = torques(&mut host, &motor, Duration::from_millis(6));
        let most = torques.iter().fold(0.0_f64, |most, nm| most.max(*nm));
        let late = torques[200..].iter().fold(0.0_f64, |most, nm| most.max((nm - 5.0).abs()));
        println!("R x {resistance}, L x {inductance}: at most {most:.2} N m, then {late:.3} N m off");
        assert!(most <= 1.25 * f64::from(LIMIT_NM) && late <= 0.06, "{torques:?}");
        assert_eq!(host.faults(), []);
    }
}

#[test]
fn a_brake_resistor_is_on_above_its_voltage_until_3_percent_less() {
    assert!(brake(&image()) <= Duration::from_millis(2));
}

/// A brake resistor is on above its voltage until 3 % less. Returns the time from the last sample to its switch off.
pub fn brake(image: &Symbols) -> Duration {
    let board = image.board().expect("an image").expect("a board");
    let pin = boards::open(&board).expect("a board").bridge.brake.expect("a brake");
    let is_on = |host: &mut Host| host.bench.act(move |chip, _| chip.is_high(pin));
    let mut host = idle(image, motor());
    assert_eq!(host.set("brake_on_v", ParameterValue::F32(50.0)), Outcome::Accepted);
    host.run();
    for (supply_v, want) in [(49.8, false), (50.2, true), (48.7, true), (48.2, false), (49.8, false)] {
        change(&mut host, move |motor| motor.supply_v = supply_v);
        host.steps(2, 0.0);
        assert_eq!(is_on(&mut host), want, "{board}: {supply_v} V");
    }
    // The motor is turned on after the end of the run.
    change(&mut host, |motor| motor.supply_v = 55.0);
    host.steps(2, 0.0);
    host.command(Stop {});
    let instants = (0..50).filter(|_| {
        host.bench.advance(Duration::from_micros(230));
        is_on(&mut host)
    });
    let on = instants.count();
    println!("{board}: on at {on} of 50 instants after the run");
    assert!(on >= 45, "{board}: {on}");
    host.bench.act(|chip, _| chip.stop_converters());
    // Nothing else would switch it off.
    let off = (0..200).find(|_| {
        host.bench.advance(Duration::from_micros(10));
        !is_on(&mut host)
    });
    Duration::from_micros(10 * (1 + off.expect("the switch off within 2 ms")))
}
