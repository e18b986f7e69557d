//! The causes for which the bridge turns off, and how a test brings them about in an image that is otherwise unmodified.
//!
//! A failure of the firmware itself is code in RAM, to which an answer to a request that no run needs jumps, or a function of a law.

use std::f64::consts::TAU;
use std::time::Duration;

use lashloop_protocol::HostMessage;
use lashloop_protocol::enums::{FaultCode, Outcome, ParameterValue, ZeroSource};
use lashloop_protocol::message::{DescribeLaw, EmergencyStop, Hello, Reset, SetZero, Stop};
use lashloop_silicon::symbols::Symbols;
use lashloop_silicon::thumb::{Code, FOREVER, MASK_INTERRUPTS, UNDEFINED};
use lashloop_silicon::wiring::{ContactPins, Encoder, Pin};

use crate::failures::{
    FLAG, PLACE, interrupting, locking_up, never_ending, overflowing, panicking, returning_the_flag,
    serving_no_more, stopping_the_tick, taking_time,
};
use crate::host::{Host, SESSION};

const MS: Duration = Duration::from_millis(1);
const US: Duration = Duration::from_micros(1);
/// The default of `watchdog_us`.
const WATCHDOG: Duration = Duration::from_millis(20);
/// Travel of the load in the test.
const TRAVEL_RAD: f32 = 0.05;
/// Time of a stall in the test.
const STALL: Duration = Duration::from_micros(9_900);
/// Longer than a step.
const LONGEST_STEP: Duration = Duration::from_micros(20);
/// Speed of an encoder that exceeds its limit.
const COUNTS_PER_S: f64 = 16e6;
/// Index of the law that calls the function of the failures.
const LAW_OF_FUNCTION: u32 = 1;

/// A cause of turning the bridge off.
pub struct Cause {
    pub name: &'static str,
    /// The instant from which the time counts.
    pub from: &'static str,
    /// What turns the bridge off.
    pub by: &'static str,
    /// Longest time from the instant to the bridge off, at this period.
    pub limit: fn(Duration) -> Duration,
    /// Code of the failure; `None` for a cause outside the firmware.
    pub code: Option<fn(&Symbols) -> Code>,
    /// What the drive needs before, as long as it takes.
    pub prepare: fn(&mut Host),
    /// Brings the cause about in a running drive. Returns the instant.
    pub happen: fn(&mut Host) -> Duration,
    /// The fault that the drive reports; `None` if it reports none.
    pub fault: Option<FaultCode>,
    /// Whether references go on arriving afterwards.
    pub is_referred: bool,
    /// Whether only a reset restarts the drive.
    pub halts: bool,
}

const ON_REQUEST: Cause = Cause {
    name: "",
    from: "last byte received",
    by: "the task that receives it",
    limit: |period| period,
    code: None,
    prepare: |_| {},
    happen: |_| unreachable!("every cause has its own"),
    fault: None,
    is_referred: true,
    halts: false,
};
const IN_HANDLER: Cause = Cause {
    from: "the instruction",
    by: "its handler",
    limit: |_| Duration::from_micros(1),
    happen: fail,
    halts: true,
    ..ON_REQUEST
};
/// No task feeds the independent watchdog any more.
const STOPPED: Cause = Cause {
    by: "the independent watchdog, at 32 kHz",
    // 5 ms, and a count of the watchdog.
    limit: |_| Duration::from_micros(5_200),
    happen: |host| {
        host.bench.allow_resets();
        fail(host)
    },
    is_referred: false,
    ..IN_HANDLER
};

pub const CAUSES: [Cause; 24] = [
    Cause { name: "panic", code: Some(panicking), fault: Some(FaultCode::Panic), ..IN_HANDLER },
    Cause {
        name: "HardFault",
        code: Some(|_| Code::default().halfword(UNDEFINED)),
        fault: Some(FaultCode::ProcessorFault),
        ..IN_HANDLER
    },
    Cause {
        name: "stack overflow",
        code: Some(overflowing),
        fault: Some(FaultCode::ProcessorFault),
        ..IN_HANDLER
    },
    Cause {
        name: "unexpected interrupt",
        code: Some(|_| interrupting()),
        fault: Some(FaultCode::ProcessorFault),
        ..IN_HANDLER
    },
    Cause { name: "Stop", happen: |host| host.send(Stop {}), ..ON_REQUEST },
    Cause {
        name: "EmergencyStop",
        happen: |host| host.send(EmergencyStop {}),
        fault: Some(FaultCode::EmergencyStop),
        ..ON_REQUEST
    },
    Cause { name: "Reset", happen: |host| host.send(Reset {}), ..ON_REQUEST },
    Cause { name: "another session", happen: |host| host.send(ANOTHER_SESSION), ..ON_REQUEST },
    Cause {
        name: "host silent",
        from: "end of watchdog_us",
        by: "the next tick",
        happen: |host| host.refer(1.0) + WATCHDOG,
        is_referred: false,
        fault: Some(FaultCode::Watchdog),
        ..ON_REQUEST
    },
    Cause {
        name: "requests no longer served",
        from: "end of watchdog_us",
        by: "the next tick",
        code: Some(|_| serving_no_more()),
        happen: |host| {
            let last = host.refer(1.0);
            host.bench.advance(host.period / 2);
            fail(host);
            last + WATCHDOG
        },
        halts: true,
        ..ON_REQUEST
    },
    Cause {
        name: "reference not finite",
        by: "the next tick",
        happen: |host| host.refer(f32::NAN),
        is_referred: false,
        fault: Some(FaultCode::ReferenceNotFinite),
        ..ON_REQUEST
    },
    Cause {
        name: "encoder faster than its limit",
        from: "the count that exceeds it",
        by: "the next tick",
        prepare: |host| {
            host.command(Stop {});
            let limit = ParameterValue::F32(10.0);
            assert_eq!(host.set("motor_speed_limit_rad_s", limit), Outcome::Accepted);
            host.run_under_torque();
        },
        happen: |host| {
            let counts_in_period = 10.0 / TAU * 131_072.0 * host.period.as_secs_f64();
            host.bench.turn(COUNTS_PER_S, 0.0);
            loop {
                host.bench.advance(US);
                let (read_at, moved) = host.bench.act(|_, site| {
                    let (at, count, _) = *site.log.readings.last().expect("a reading");
                    (at, site.train.count(Encoder::Motor) - count)
                });
                // One count may be that of a border.
                if moved >= counts_in_period as i64 + 2 {
                    // What comes during a step, after its reading, counts from the end of the step.
                    return (host.bench.now() - US).max(read_at + LONGEST_STEP);
                }
            }
        },
        fault: Some(FaultCode::MotorEncoderJump),
        ..ON_REQUEST
    },
    Cause {
        name: "load leaves its travel, host silent",
        from: "the count beyond it",
        by: "the next tick",
        prepare: |host| {
            let travel = ("load_travel_max_rad", ParameterValue::F32(TRAVEL_RAD));
            host.command(Stop {});
            host.command(SetZero { source: ZeroSource::Present });
            // A host that is silent for longer than the load takes.
            restart(host, &[travel, ("watchdog_us", ParameterValue::U32(1_000_000))]);
        },
        happen: |host| {
            let travel = (f64::from(TRAVEL_RAD) / TAU * 131_072.0) as i64;
            let last = travel + host.bench.act(|_, site| site.train.count(Encoder::Load));
            host.bench.turn(3e5, 1e5);
            loop {
                host.bench.advance(US);
                let ((read_at, _, read), load) = host.bench.act(|_, site| {
                    let reading = *site.log.readings.last().expect("a reading");
                    (reading, site.train.count(Encoder::Load))
                });
                if load > last {
                    host.bench.turn(0.0, 0.0);
                    let counted_at = host.bench.now() - US;
                    // A step that has read the count answers it; for one that has read before, it comes after the step.
                    let has_read = read > last;
                    return if has_read { counted_at } else { counted_at.max(read_at + LONGEST_STEP) };
                }
            }
        },
        fault: Some(FaultCode::LoadTravel),
        is_referred: false,
        ..ON_REQUEST
    },
    Cause {
        name: "limit switch in the direction of the torque",
        from: "the edge",
        by: "the next tick",
        prepare: |host| {
            switch_contact(host, |contacts| contacts.positive_limit, false);
            restart(host, &[("positive_limit_input", ParameterValue::U32(1))]);
        },
        happen: |host| switch_contact(host, |contacts| contacts.positive_limit, true),
        fault: Some(FaultCode::LimitSwitch),
        ..ON_REQUEST
    },
    Cause {
        name: "enable contact opens",
        from: "the edge",
        by: "the next tick",
        prepare: |host| {
            switch_contact(host, |contacts| contacts.enable, true);
            restart(host, &[("enable_input", ParameterValue::U32(1))]);
        },
        happen: |host| switch_contact(host, |contacts| contacts.enable, false),
        fault: Some(FaultCode::PowerStage),
        ..ON_REQUEST
    },
    Cause {
        name: "both encoders lost, or a stall",
        from: "end of stall_time_s",
        by: "the next tick",
        prepare: |host| {
            let stall = ("stall_time_s", ParameterValue::F32(STALL.as_secs_f32()));
            restart(host, &[stall, ("torque_limit_nm", ParameterValue::F32(1.0))]);
            host.bench.turn(3e5, 0.0);
            host.steps(2, 1.0);
        },
        happen: |host| {
            host.bench.turn(0.0, 0.0);
            // The turntable ends the motion that it has begun.
            host.bench.advance(3 * host.period);
            let readings = host.bench.act(|_, site| site.log.readings.clone());
            let has_moved = |pair: &&[(Duration, i64, i64)]| (pair[1].1 - pair[0].1).abs() > 4;
            let last = readings.windows(2).rfind(has_moved).expect("a motion");
            last[1].0 + STALL
        },
        fault: Some(FaultCode::Stall),
        ..ON_REQUEST
    },
    Cause {
        name: "torque not finite",
        from: "the value",
        by: "the next tick",
        code: Some(|_| returning_the_flag()),
        prepare: run_law_of_function,
        happen: |host| {
            // A value that comes after its use in a step is one of the next step.
            end_step(host);
            set_flag(host, f32::NAN.to_bits());
            host.bench.now()
        },
        fault: Some(FaultCode::TorqueNotFinite),
        ..ON_REQUEST
    },
    Cause {
        name: "step of 1.4 periods",
        from: "end of its period",
        by: "the step",
        code: Some(|_| taking_time()),
        prepare: run_law_of_function,
        happen: |host| {
            end_step(host);
            let due = last_tick(host) + host.period;
            // Two instructions of 168 MHz each.
            set_flag(host, (1.4 * host.period.as_secs_f64() * 84e6) as u32);
            due + host.period
        },
        fault: Some(FaultCode::TickOverrun),
        ..ON_REQUEST
    },
    Cause {
        name: "step that never ends",
        from: "end of its period",
        by: "the monitor of the tick",
        code: Some(|_| never_ending()),
        prepare: run_law_of_function,
        happen: |host| {
            end_step(host);
            // The independent watchdog follows.
            host.bench.allow_resets();
            let due = last_tick(host) + host.period;
            set_flag(host, 1);
            due + host.period
        },
        is_referred: false,
        halts: true,
        ..ON_REQUEST
    },
    Cause {
        name: "tick missing",
        from: "its due time",
        by: "the monitor of the tick",
        code: Some(|_| stopping_the_tick()),
        happen: |host| {
            fail(host);
            last_tick(host) + host.period
        },
        halts: true,
        fault: Some(FaultCode::TickOverrun),
        ..ON_REQUEST
    },
    Cause {
        name: "all tasks stopped",
        code: Some(|_| Code::default().halfwords(&[MASK_INTERRUPTS, FOREVER])),
        ..STOPPED
    },
    Cause { name: "lock-up: a fault at the priority of HardFault", code: Some(|_| locking_up()), ..STOPPED },
    Cause {
        name: "break input",
        from: "the edge",
        by: "the timer, without software",
        limit: |_| Duration::ZERO,
        happen: |host| switch_break(host, Some(true)),
        fault: Some(FaultCode::PowerStage),
        ..ON_REQUEST
    },
    Cause {
        name: "break wire open",
        from: "the cut",
        by: "the timer, without software",
        limit: |_| Duration::ZERO,
        happen: |host| switch_break(host, None),
        fault: Some(FaultCode::PowerStage),
        ..ON_REQUEST
    },
];

const ANOTHER_SESSION: Hello = Hello::new(SESSION + 1);

/// The cause of this name.
pub fn cause(name: &str) -> &'static Cause {
    CAUSES.iter().find(|cause| cause.name == name).unwrap_or_else(|| panic!("no cause {name}"))
}

/// Requests the failure that was put into its place. Returns its instant.
pub fn fail(host: &mut Host) -> Duration {
    host.bench.watch(PLACE.into());
    host.send(HostMessage::from(DescribeLaw { index: 0 }));
    host.bench.advance(2 * MS);
    host.bench.act(|_, site| site.log.arrivals.last().map(|it| it.at)).expect("the failure happened")
}

/// Stops, and runs under torque with these parameters.
fn restart(host: &mut Host, parameters: &[(&str, ParameterValue)]) {
    host.command(Stop {});
    for (name, value) in parameters {
        assert_eq!(host.set(name, *value), Outcome::Accepted, "{name}");
    }
    host.run_under_torque();
}

/// Closes a contact, or opens it, outside a step. Returns the instant.
fn switch_contact(host: &mut Host, contact: fn(&ContactPins) -> Pin, does: bool) -> Duration {
    end_step(host);
    host.bench.act(move |chip, _| {
        let pin = contact(chip.contacts());
        chip.close_contact(pin, does);
        chip.now()
    })
}

/// Drives the break input, or cuts its wire. Returns the instant.
fn switch_break(host: &mut Host, level: Option<bool>) -> Duration {
    host.bench.act(move |chip, _| {
        chip.drive_break(level);
        chip.now()
    })
}

/// Ends the step that a tick has begun.
fn end_step(host: &mut Host) {
    let tick = last_tick(host);
    host.bench.advance_to(tick + LONGEST_STEP);
}

/// Changes to the law that calls the function of the failures.
fn run_law_of_function(host: &mut Host) {
    set_flag(host, 0);
    host.command(Stop {});
    assert_eq!(host.set("controller", ParameterValue::U32(LAW_OF_FUNCTION)), Outcome::Accepted);
    host.run_under_torque();
}

fn set_flag(host: &mut Host, value: u32) {
    host.bench.act(move |chip, _| chip.set_word(FLAG.into(), value)).expect("memory");
}

/// Due time of the latest tick: the earliest start of a task among the ticks so far has no delay.
pub fn last_tick(host: &mut Host) -> Duration {
    let ticks = host.bench.act(|_, site| site.log.ticks.clone());
    let last = *ticks.last().expect("a tick");
    let (period, half) = (host.period.as_nanos() as i64, host.period.as_nanos() as i64 / 2);
    let later_than = |tick: &Duration| ((last - *tick).as_nanos() as i64 + half) % period - half;
    let late = ticks.iter().rev().take(8).map(later_than).max().expect("ticks");
    last - Duration::from_nanos(late as u64)
}
