//! The causes for which the bridge turns off, and how a test brings them about in an image that is otherwise unmodified.
//!
//! A failure of the firmware itself is code in place of `Drive::send_description`, the answer to a request that no run needs.

use std::f64::consts::TAU;
use std::time::Duration;

use lashloop_protocol::enums::{FaultCode, Outcome, ParameterValue};
use lashloop_protocol::message::{ClearFault, DescribeLaw, EmergencyStop, FaultReport, Hello, Reset, Stop};
use lashloop_protocol::{HostMessage, PROTOCOL_VERSION};
use lashloop_silicon::symbols::Symbols;
use lashloop_silicon::thumb::{Code, FOREVER, MASK_INTERRUPTS, UNDEFINED};

use crate::failures::{
    FLAG, interrupting, never_ending, panicking, returning_the_flag, serving_no_more, stopping_the_tick,
    taking_time,
};
use crate::host::{Host, SESSION};

const MS: Duration = Duration::from_millis(1);
/// The default of `watchdog_us`.
const WATCHDOG: Duration = Duration::from_millis(20);
const DRIVE_TRAIN_STEP: Duration = Duration::from_micros(50);
/// Speed of an encoder that exceeds its limit.
const COUNTS_PER_S: f64 = 16e6;
/// The function that gets the code of a failure.
pub const SITE: &str = "send_description";
/// A function that one law calls in every step, and the index of the law. In place of it, the argument is the value.
const FUNCTION: &str = "tanhf";
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
    /// Puts the failure into the image.
    pub prepare: fn(Symbols) -> Symbols,
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
    prepare: |image| image,
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

pub const CAUSES: [Cause; 18] = [
    Cause {
        name: "panic",
        prepare: |image| with(&image, panicking(&image)),
        fault: Some(FaultCode::Panic),
        ..IN_HANDLER
    },
    Cause {
        name: "HardFault",
        prepare: |image| with(&image, |_| Code::default().halfword(UNDEFINED)),
        fault: Some(FaultCode::ProcessorFault),
        ..IN_HANDLER
    },
    Cause {
        name: "unexpected interrupt",
        prepare: |image| with(&image, |_| interrupting()),
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
        prepare: |image| with(&image, |_| serving_no_more()),
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
        happen: |host| {
            host.command(Stop {});
            let limit = ParameterValue::F32(10.0);
            assert_eq!(host.set("motor_speed_limit_rad_s", limit), Outcome::Accepted);
            host.run_under_torque();
            let counts_in_period = 10.0 / TAU * 131_072.0 * host.period.as_secs_f64();
            host.bench.turn(COUNTS_PER_S, 0.0);
            // The drive train takes the speed at its next step; one count may be that of a border.
            let takes = Duration::from_secs_f64((counts_in_period + 1.0) / COUNTS_PER_S);
            host.bench.now() + DRIVE_TRAIN_STEP + takes
        },
        fault: Some(FaultCode::MotorEncoderJump),
        ..ON_REQUEST
    },
    Cause {
        name: "torque not finite",
        from: "the value",
        by: "the next tick",
        prepare: |image| image.with_code(FUNCTION, |_| returning_the_flag()).expect("a function of the law"),
        happen: |host| {
            set_flag(host, 0);
            run_law_of_function(host);
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
        prepare: |image| image.with_code(FUNCTION, |_| taking_time()).expect("a function of the law"),
        happen: |host| {
            set_flag(host, 0);
            run_law_of_function(host);
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
        prepare: |image| image.with_code(FUNCTION, |_| never_ending()).expect("a function of the law"),
        happen: |host| {
            set_flag(host, 0);
            run_law_of_function(host);
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
        prepare: |image| with(&image, |_| stopping_the_tick()),
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
        from: "the instruction",
        by: "the independent watchdog, at 32 kHz",
        // 5 ms, and a count of the watchdog.
        limit: |_| Duration::from_micros(5_200),
        prepare: |image| with(&image, |_| Code::default().halfwords(&[MASK_INTERRUPTS, FOREVER])),
        happen: |host| {
            host.bench.allow_resets();
            fail(host)
        },
        is_referred: false,
        ..IN_HANDLER
    },
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

const ANOTHER_SESSION: Hello = Hello { protocol_version: PROTOCOL_VERSION, session: SESSION + 1 };

/// The cause of this name.
pub fn cause(name: &str) -> &'static Cause {
    CAUSES.iter().find(|cause| cause.name == name).unwrap_or_else(|| panic!("no cause {name}"))
}

impl Cause {
    /// Device time from the cause to the bridge off in this image, at each of these control periods and fractions of it at which
    /// the cause comes; `None` if the bridge is on for 5 ms more than it may.
    pub fn times_to_off(&self, image: &Symbols, instants: &[(Duration, f64)]) -> Vec<Option<Duration>> {
        let mut host = Host::under_torque(&(self.prepare)(image.clone()), instants[0].0);
        let mut times = Vec::new();
        for (k, (period, phase)) in instants.iter().enumerate() {
            if k > 0 {
                host.period = *period;
                recover(&mut host);
            }
            host.bench.advance(period.mul_f64(*phase));
            let instant = (self.happen)(&mut host);
            let limit = (self.limit)(*period);
            let end = instant + limit + 5 * MS;
            while host.bench.now() < end {
                if self.is_referred {
                    host.refer(1.0);
                }
                host.bench.advance(MS);
            }
            let off = host.bench.time_to_off(instant);
            if off.is_some_and(|off| off <= limit) {
                let faults: Vec<_> = host.faults().iter().map(|report| report.code).collect();
                assert_eq!(faults, Vec::from_iter(self.fault), "{}", self.name);
            } else {
                // The test fails, or the image is a mutant whose watchdog resets it.
                host.bench.allow_resets();
            }
            assert!(off.is_some() || k == 0, "{}: off and on again", self.name);
            times.push(off);
            if off.is_none() {
                break;
            }
        }
        times
    }
}

/// From any state of a drive that is not halted to a run under torque.
fn recover(host: &mut Host) {
    host.bench.turn(0.0, 0.0);
    host.bench.act(|chip, _| chip.drive_break(Some(false)));
    host.bench.advance(2 * MS);
    host.shake_hands(SESSION);
    host.command(ClearFault {});
    // The identity repeats a latched fault.
    host.faults();
    host.command(Reset {});
    host.shake_hands(SESSION);
    host.set_all(&[]);
    host.run_under_torque();
    // Ticks of the former period are no measure of lateness.
    host.bench.act(|_, site| site.log.ticks.clear());
    host.steps(3, 1.0);
}

/// The fault report of a failure of the firmware, which comes while the report of a step is on the line.
pub fn report_of(cause: &Cause) -> FaultReport {
    let mut host = Host::under_torque(&(cause.prepare)(crate::bench::image()), MS);
    host.expects_cut_frame = true;
    fail(&mut host);
    let [report] = host.faults()[..] else { panic!("{}: one report", cause.name) };
    report
}

/// Requests the failure that was put into the image. Returns its instant.
fn fail(host: &mut Host) -> Duration {
    let site = crate::bench::image().function(SITE).expect("the site of the failures");
    host.bench.act(move |chip, _| chip.watch(site)).expect("a watch");
    host.send(HostMessage::from(DescribeLaw { index: 0 }));
    host.bench.advance(2 * MS);
    host.bench.act(|_, site| site.log.arrivals.last().map(|it| it.at)).expect("the failure happened")
}

/// Drives the break input, or cuts its wire. Returns the instant.
fn switch_break(host: &mut Host, level: Option<bool>) -> Duration {
    host.bench.act(move |chip, _| {
        chip.drive_break(level);
        chip.now()
    })
}

/// Changes to the law that calls [`FUNCTION`].
fn run_law_of_function(host: &mut Host) {
    host.command(Stop {});
    assert_eq!(host.set("controller", ParameterValue::U32(LAW_OF_FUNCTION)), Outcome::Accepted);
    host.run_under_torque();
}

fn set_flag(host: &mut Host, value: u32) {
    host.bench.act(move |chip, _| chip.set_word(FLAG.into(), value)).expect("memory");
}

/// Due time of the latest tick: the earliest start of a task among the ticks so far has no delay.
fn last_tick(host: &mut Host) -> Duration {
    let ticks = host.bench.act(|_, site| site.log.ticks.clone());
    let last = *ticks.last().expect("a tick");
    let (period, half) = (host.period.as_nanos() as i64, host.period.as_nanos() as i64 / 2);
    let later_than = |tick: &Duration| ((last - *tick).as_nanos() as i64 + half) % period - half;
    let late = ticks.iter().rev().take(8).map(later_than).max().expect("ticks");
    last - Duration::from_nanos(late as u64)
}

fn with(image: &Symbols, code: impl FnOnce(u64) -> Code) -> Symbols {
    image.with_code(SITE, code).expect("the site of the failures")
}
