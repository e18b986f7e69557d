//! Everything that can be found out about a rig without moving it: lock, port, line, drive, board, pins, limits, loader.

use lashloop_bench::device::{Build, Device};
use lashloop_bench::scenario::RunMode;
use lashloop_bench::scenario::controller::ParameterValue;
use lashloop_bench::supervisor::Supervisor;
use lashloop_protocol::parameter_names::{LOAD_COUNTS_PER_REV, MOTOR_COUNTS_PER_REV, SAMPLE_SOURCE};
use lashloop_session::{Parameter, Session, WrittenValue};

use crate::doctor;
use crate::doctor::finding::Finding;
use crate::flash::way;
use lashloop::rig::file::{Loader, Rig};

/// Samples of the round-trip measurement.
const ROUNDS: u32 = 200;

/// What a check found.
#[derive(Debug)]
pub struct RigCheck {
    /// In the order of the check.
    pub findings: Vec<Finding>,
    pub reached: Reached,
}

/// How far a check got.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reached {
    /// There is no port of this name: nothing is plugged in.
    NoHardware,
    /// The port is there and no drive completed the handshake.
    Port,
    Drive,
}

/// Checks a rig that this process has locked. The drive stays disarmed and gives no torque.
#[must_use]
pub fn check(rig: &Rig, supervisor: &Supervisor) -> RigCheck {
    let mut findings = vec![Finding::fine("rig", format!("{}; contact {}", rig.title, rig.contact))];
    if let Some(absent) = rig.absent() {
        findings.push(Finding::wrong("port", absent));
        findings.push(loader(rig));
        return RigCheck { findings, reached: Reached::NoHardware };
    }
    let line = doctor::examine(rig.port.without_limits(), rig.port.baud, ROUNDS, supervisor, |_| {});
    findings.extend(line.findings);
    let mut reached = Reached::Port;
    if line.reached {
        match Device::open(rig.port.without_limits(), rig.port.baud, supervisor) {
            Ok(device) => {
                reached = Reached::Drive;
                findings.extend(drive(rig, &device));
            }
            Err(error) => findings.push(Finding::wrong("drive", error.to_string())),
        }
    }
    findings.push(loader(rig));
    RigCheck { findings, reached }
}

fn drive(rig: &Rig, device: &Device) -> Vec<Finding> {
    let session = &device.session;
    let identity = &session.identity;
    let board = match rig.check_board(device) {
        Ok(()) => Finding::fine("board", rig.board.clone()),
        Err(error) => Finding::wrong("board", error.to_string()),
    };
    let [drive, bench] = [Build::of(identity), Build::OF_BENCH];
    let build = if drive == bench {
        Finding::fine("build", format!("{drive}, that of the bench"))
    } else {
        Finding::wrong(
            "build",
            format!("{drive}, this bench {bench}: `lashloop flash` writes the image of this bench"),
        )
    };
    let mut findings = vec![board, build, pins(rig, session)];
    let has_pins = session.parameter(SAMPLE_SOURCE).is_some();
    let mode = if has_pins { RunMode::Bench } else { RunMode::Hil };
    findings.extend(rig.limits.of_drive(mode).into_iter().map(|limit| {
        let subject = "limit";
        match session.parameter(limit.parameter) {
            Some(parameter) => value(subject, limit.key, parameter, WrittenValue::Number(limit.largest)),
            None => Finding::wrong(subject, format!("{}: the drive has no {}", limit.key, limit.parameter)),
        }
    }));
    findings
}

/// The settings of pins against the drive's description.
fn pins(rig: &Rig, session: &Session) -> Finding {
    let subject = "pins";
    if session.parameter(SAMPLE_SOURCE).is_none() {
        return Finding::not_applicable(subject, "the drive offers none: it runs hardware in the loop only");
    }
    let counts = [
        (MOTOR_COUNTS_PER_REV, rig.encoders.motor_counts_per_rev),
        (LOAD_COUNTS_PER_REV, rig.encoders.load_counts_per_rev),
    ];
    let counts =
        counts.into_iter().filter_map(|(name, counts)| Some((name, ParameterValue::Number(counts?.into()))));
    let pins = rig.pins().into_iter().map(|pin| (pin.parameter, pin.value));
    let settings: Vec<_> = pins.chain(counts).collect();
    let findings = settings.iter().map(|(name, setting)| match (session.parameter(name), setting) {
        (None, _) => Finding::wrong(
            subject,
            format!("the drive has no {name}: remove the key, or flash firmware that has the parameter"),
        ),
        (Some(parameter), ParameterValue::Number(number)) => {
            value(subject, name, parameter, WrittenValue::Number(*number))
        }
        (Some(parameter), ParameterValue::Boolean(on)) => {
            value(subject, name, parameter, WrittenValue::Number(f64::from(u8::from(*on))))
        }
        (Some(parameter), ParameterValue::Text(text)) => {
            value(subject, name, parameter, WrittenValue::Name(text))
        }
    });
    let mut findings = findings.filter(Finding::is_wrong);
    findings.next().unwrap_or_else(|| {
        Finding::fine(subject, format!("{} settings within the ranges of the drive", settings.len()))
    })
}

/// Whether a parameter of the drive takes a value.
fn value(subject: &'static str, key: &str, parameter: &Parameter, written: WrittenValue<'_>) -> Finding {
    match parameter.value(written) {
        Ok(value) => {
            Finding::fine(subject, format!("{key} = {value} {}", parameter.unit).trim_end().to_owned())
        }
        Err(error) => Finding::wrong(subject, format!("{key}: {error}")),
    }
}

/// Whether the program of a loader is installed. Nothing is sent to the chip.
fn loader(rig: &Rig) -> Finding {
    if rig.loader == Loader::default() {
        return Finding::not_applicable("loader", "the rig file has no [loader]");
    }
    let installed = way::installed(rig.loader.via);
    match (&installed[..], rig.loader.via) {
        ([], Some(chosen)) => Finding::wrong(
            "loader",
            format!("{} is not installed: install {}", chosen.program(), chosen.package()),
        ),
        ([], None) => Finding::wrong("loader", format!("none of {} is installed", way::programs())),
        (ways, _) => {
            let ways: Vec<_> = ways.iter().map(|installed| installed.program()).collect();
            Finding::fine("loader", format!("{} is installed", ways.join(", ")))
        }
    }
}
