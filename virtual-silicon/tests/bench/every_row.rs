//! Every row of the tables of what switches the bridge off, fired on every board.

use std::f64::consts::TAU;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Duration;

use lashloop_protocol::enums::{FaultCode, Outcome, ParameterValue, State};
use lashloop_silicon::boards::{self, BUILT_IN};
use lashloop_silicon::quadrature::Channel;
use lashloop_silicon::symbols::Symbols;
use lashloop_silicon::wiring::{Encoder, Wiring};

use crate::bench::image_of;
use crate::causes::{CAUSES, Cause, cause};
use crate::current::{brake, faults};
use crate::host::Host;
use crate::time_to_off::of_each;
use crate::{docs, report};

const MS: Duration = Duration::from_millis(1);
/// Control period, and the fraction of it at which a cause comes.
const INSTANT: (Duration, f64) = (MS, 0.61);
/// Counts of a revolution of an encoder.
const COUNTS: f64 = 131_072.0;
/// End of the line of a row that doesn't do what it has to.
const FAILED: &str = "FAILED";

/// Whether the board has what a row needs.
type Has = fn(&Wiring) -> bool;

/// The boards of the page; a user may have added one.
const BOARDS: [&str; 5] = ["nucleo-f429zi", "nucleo-f446re", "nucleo-h743zi", "odrive-v3", "stm32f405"];

/// How a row is fired.
enum Fire {
    Cause(&'static Cause),
    /// Asserts what has to happen, and returns the time to the bridge off.
    Own(fn(&Symbols) -> Duration),
    /// On no board.
    Never,
}

/// A row of the tables.
struct Row {
    name: &'static str,
    /// What the board needs for it, and why it isn't fired without; `None` for a row of every board.
    needs: Option<(Has, &'static str)>,
    fire: Fire,
}

const SENSOR: Option<(Has, &str)> =
    Some((|wiring| wiring.bridge.current.is_some(), "no current sensor is read"));
const BREAK: Option<(Has, &str)> = Some((|wiring| wiring.bridge.break_input.is_some(), "no break input"));
const BRAKE: Option<(Has, &str)> =
    Some((|wiring| wiring.bridge.brake.is_some(), "no output for a brake resistor"));
const DRIVER: Option<(Has, &str)> = Some((|wiring| wiring.gate_driver.is_some(), "no gate driver"));
const UNMODELLED: Option<(Has, &str)> = Some((|_| false, "no model of a debugger"));

const OWN: [Row; 16] = [
    Row { name: "current beyond its limit", needs: SENSOR, fire: Fire::Own(faults::overcurrent) },
    Row { name: "bus above its limit", needs: SENSOR, fire: Fire::Own(faults::overvoltage) },
    Row { name: "bus below its limit", needs: SENSOR, fire: Fire::Own(faults::undervoltage) },
    Row { name: "wrong current sensor", needs: SENSOR, fire: Fire::Own(faults::wrong_sensor) },
    Row { name: "no samples", needs: SENSOR, fire: Fire::Own(faults::stopped_converters) },
    Row { name: "missing torque", needs: SENSOR, fire: Fire::Own(faults::missing_torque) },
    Row { name: "brake resistor", needs: BRAKE, fire: Fire::Own(brake) },
    Row { name: "crystal stops", needs: BREAK, fire: Fire::Own(crystal_stops) },
    Row { name: "no tick from `Start` on", needs: None, fire: Fire::Own(no_tick) },
    Row { name: "nFAULT", needs: DRIVER, fire: Fire::Own(fault_line) },
    Row { name: "core halted by a debugger", needs: UNMODELLED, fire: Fire::Never },
    Row { name: "wrong direction", needs: None, fire: Fire::Own(wrong_direction) },
    Row { name: "one channel of an encoder lost", needs: None, fire: Fire::Own(lost_channel) },
    Row { name: "motor leaves its travel", needs: None, fire: Fire::Own(motor_travel) },
    Row { name: "overload of the motor", needs: None, fire: Fire::Own(hot_motor) },
    Row { name: "overload of the stage", needs: None, fire: Fire::Own(hot_stage) },
];

fn rows() -> Vec<Row> {
    let needs = |cause: &Cause| if cause.name.starts_with("break ") { BREAK } else { None };
    let causes =
        CAUSES.iter().map(|it| Row { name: it.name, needs: needs(it), fire: Fire::Cause(cause(it.name)) });
    causes.chain(OWN).collect()
}

/// Runs under torque with these parameters.
fn under_torque(image: &Symbols, parameters: &[(&str, ParameterValue)]) -> Host {
    let mut host = Host::idle(image, parameters);
    host.run_under_torque();
    host
}

/// The time to the bridge off, at most this, by this fault alone.
fn off_by(host: &mut Host, instant: Duration, limit: Duration, fault: FaultCode, detail: u32) -> Duration {
    let off = host.bench.time_to_off(instant).expect("the bridge off");
    assert!(off <= limit, "{off:?}");
    let faults: Vec<_> = host.faults().iter().map(|it| (it.code, it.detail)).collect();
    assert_eq!(faults, [(fault, detail)]);
    off
}

fn crystal_stops(image: &Symbols) -> Duration {
    let mut host = under_torque(image, &[]);
    let instant = host.bench.act(|chip, _| {
        chip.stop_crystal();
        chip.now()
    });
    host.bench.advance(Duration::from_micros(1));
    host.bench.time_to_off(instant).expect("the bridge off")
}

fn no_tick(image: &Symbols) -> Duration {
    let missing = cause("tick missing");
    let mut host = Host::at(&missing.image(image), (0, 0));
    missing.place(&mut host, image);
    host.set_all(&[]);
    assert_eq!(host.arm(), (Outcome::Accepted, State::Armed));
    (missing.happen)(&mut host);
    let instant = host.bench.now();
    assert_eq!(host.start(), (Outcome::Accepted, State::Running));
    host.bench.advance(2 * MS);
    let changes = host.bench.act(|_, site| site.log.bridge.clone());
    let on = changes.iter().position(|(at, bridge)| *at > instant && bridge.is_on()).expect("it was on");
    let (off, _) = changes[on..].iter().find(|(_, bridge)| !bridge.is_on()).expect("the bridge off");
    let off = *off - changes[on].0;
    assert!(off <= MS.mul_f64(1.5), "{off:?}");
    off
}

fn fault_line(image: &Symbols) -> Duration {
    let mut host = under_torque(image, &[]);
    let instant = host.bench.act(|chip, _| {
        chip.drive_fault_line(false);
        chip.now()
    });
    host.steps(3, 1.0);
    off_by(&mut host, instant, MS, FaultCode::PowerStage, 2)
}

/// The motor runs away from its torque, ever faster, and takes the load with it: a rad in 20 ms.
fn wrong_direction(image: &Symbols) -> Duration {
    let mut host = Host::idle(image, &[]);
    host.run();
    let instant = host.refer(1.0);
    for step in 1..=30 {
        let speed = -5.0 * f64::from(step) * COUNTS / TAU;
        host.bench.turn(speed, speed / 3.0);
        host.steps(1, 1.0);
    }
    // The power stage has the wrong direction, or the load would turn the other way.
    off_by(&mut host, instant, 23 * MS, FaultCode::MotorAgainstTorque, 1)
}

/// A channel is cut at 30 rad/s of the motor.
fn lost_channel(image: &Symbols) -> Duration {
    let mut host = Host::idle(image, &[("twist_limit_rad", ParameterValue::F32(0.5))]);
    host.run();
    let speed = 30.0 * COUNTS / TAU;
    host.bench.turn(speed, speed / 3.0);
    host.steps(10, 0.0);
    let instant = host.bench.act(|chip, site| {
        site.train.cut(chip, Encoder::Motor, Channel::A);
        chip.now()
    });
    host.steps(40, 0.0);
    off_by(&mut host, instant, Duration::from_micros(17_800), FaultCode::MotorEncoderLost, 0)
}

fn motor_travel(image: &Symbols) -> Duration {
    let mut host = under_torque(image, &[("motor_travel_max_rad", ParameterValue::F32(0.05))]);
    let instant = host.bench.now();
    let speed = 10.0 * COUNTS / TAU;
    host.bench.turn(speed, speed / 3.0);
    host.steps(20, 1.0);
    // 5 ms, and the step of the turntable.
    off_by(&mut host, instant, 7 * MS, FaultCode::MotorTravel, 0)
}

fn hot_motor(image: &Symbols) -> Duration {
    let limits = [("torque_continuous_nm", 1e-3), ("motor_thermal_s", 0.05)];
    hot(image, &limits.map(|(name, value)| (name, ParameterValue::F32(value))), 1)
}

fn hot_stage(image: &Symbols) -> Duration {
    let numbers = [
        ("torque_limit_nm", 1.0),
        ("torque_constant_nm_a", 0.24),
        ("duty_min", 0.0),
        ("duty_max", 1.0),
        ("current_continuous_a", 0.1),
        ("stage_thermal_s", 0.5),
    ];
    // By the voltage, with two half-bridges: every board can do that.
    let mut parameters =
        vec![("torque_source", ParameterValue::U32(1)), ("stage_mode", ParameterValue::U32(5))];
    parameters.extend(numbers.map(|(name, value)| (name, ParameterValue::F32(value))));
    hot(image, &parameters, 2)
}

fn hot(image: &Symbols, parameters: &[(&str, ParameterValue)], detail: u32) -> Duration {
    let mut host = Host::idle(image, parameters);
    host.run();
    host.steps(2, 0.0);
    let instant = host.refer(1.0);
    host.steps(100, 1.0);
    off_by(&mut host, instant, 100 * MS, FaultCode::Overload, detail)
}

/// Fires a row on a board. Returns the line of the report.
fn fired(row: &Row, board: &str) -> String {
    let wiring = boards::open(board).unwrap_or_else(|error| panic!("{error}"));
    if let Some((_, reason)) = row.needs.filter(|(has, _)| !has(&wiring)) {
        return format!("{board}: {}: NOT FIRED, {reason}", row.name);
    }
    let image = image_of(board);
    let off = match &row.fire {
        Fire::Cause(cause) => {
            let off = cause.times_to_off(&image, &[INSTANT])[0];
            let limit = (cause.limit)(INSTANT.0);
            off.filter(|off| *off <= limit)
                .unwrap_or_else(|| panic!("{board}: {}: off after {off:?}, limit {limit:?}", row.name))
        }
        Fire::Own(fire) => fire(&image),
        Fire::Never => unreachable!("no board has what it needs"),
    };
    format!("{board}: {}: off after {:.1} us", row.name, off.as_secs_f64() * 1e6)
}

/// Fires every row on a board that can have it, and writes the report.
fn fire_all(board: &str) {
    let rows = rows();
    let all: Vec<_> = rows.iter().collect();
    let lines = of_each(&all, |row| {
        // The other rows are measured all the same.
        let line = catch_unwind(AssertUnwindSafe(|| fired(row, board)));
        line.unwrap_or_else(|_| format!("{board}: {}: {FAILED}", row.name))
    });
    report::write(&format!("bridge-off-on-{board}"), &lines);
    let failed: Vec<_> = lines.iter().filter(|line| line.ends_with(FAILED)).collect();
    assert!(failed.is_empty(), "{failed:#?}");
}

#[test]
fn every_row_of_the_fault_tables_fires_on_a_bare_stm32f405() {
    fire_all("stm32f405");
}

#[test]
fn every_row_of_the_fault_tables_fires_on_a_nucleo_f446re() {
    fire_all("nucleo-f446re");
}

#[test]
fn every_row_of_the_fault_tables_fires_on_a_nucleo_f429zi() {
    fire_all("nucleo-f429zi");
}

#[test]
fn every_row_of_the_fault_tables_fires_on_a_nucleo_h743zi() {
    fire_all("nucleo-h743zi");
}

#[test]
fn every_row_of_the_fault_tables_fires_on_an_odrive() {
    fire_all("odrive-v3");
}

#[test]
fn every_row_of_the_fault_tables_fires_on_the_boards_of_a_user() {
    let names = BUILT_IN.iter().map(|(name, _)| *name).filter(|name| !BOARDS.contains(name));
    names.for_each(fire_all);
}

/// The page names every row that a board can't have, under its reason.
#[test]
fn the_page_says_which_rows_a_board_lacks() {
    for (has, reason) in [SENSOR, BREAK, BRAKE, DRIVER, UNMODELLED].into_iter().flatten() {
        let all = rows();
        let names: Vec<_> = all
            .iter()
            .filter(|row| row.needs.is_some_and(|(_, of_row)| of_row == reason))
            .map(|row| row.name)
            .collect();
        let lacks = |name: &str| boards::open(name).is_ok_and(|wiring| !has(&wiring));
        let boards: Vec<_> = BOARDS.into_iter().filter(|name| lacks(name)).collect();
        assert_eq!(docs::row(reason), [names.join(", "), boards.join(", ")]);
    }
}
