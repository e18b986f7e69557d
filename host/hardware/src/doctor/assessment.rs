//! Assessment of the measurements. Each is a function of numbers, so that tests need no board.

use std::time::Duration;

use lashloop_protocol::enums::{Capabilities, State};
use lashloop_protocol::layout::FieldType;
use lashloop_protocol::message::Identity;

use super::finding::Finding;
use super::line_under_test::LineUnderTest;
use super::round_trip::{BYTES, Timing};
use lashloop_bench::device::DeviceError;
use lashloop_link::latency_timer::LatencyTimer;
use lashloop_session::printable;

/// Excess over the time on the wire that indicates buffering. USB at full speed costs up to 1 ms in each direction, and the
/// drive needs time for its answer.
const BUFFERING: Duration = Duration::from_millis(3);
/// Excess that indicates a latency timer of 16 ms.
const LATENCY_TIMER: Duration = Duration::from_millis(10);

pub(super) fn not_opened(error: &DeviceError, holders: &[String]) -> Finding {
    let holders =
        if holders.is_empty() { String::new() } else { format!("; it is open in {}", holders.join(", ")) };
    Finding::wrong("open", format!("{error}{holders}"))
}

pub(super) fn opened(line: LineUnderTest<'_>) -> Finding {
    Finding::fine(
        "open",
        match line {
            LineUnderTest::SerialPort { baud, .. } => {
                format!("exclusive, {baud} baud, 8 data bits, no parity, 1 stop bit, no flow control")
            }
            LineUnderTest::PseudoTerminal => "exclusive, raw; a pseudo-terminal has no baud rate".to_owned(),
            LineUnderTest::Other => "raw bytes; this line has no terminal".to_owned(),
        },
    )
}

pub(super) fn dtr(line: LineUnderTest<'_>) -> Finding {
    if line.terminal().is_none() {
        return Finding::not_applicable("DTR", format!("{} has no modem lines", line.name()));
    }
    Finding::fine(
        "DTR",
        "left as the driver sets it at open, which is on; a board that resets by DTR has just been reset",
    )
}

/// `None` stands for a line that isn't a serial port.
pub(super) fn latency_timer(line: LineUnderTest<'_>, timer: Option<&LatencyTimer>) -> Finding {
    let about = "latency timer";
    match timer {
        None => Finding::not_applicable(about, format!("{} does not buffer by time", line.name())),
        Some(LatencyTimer::None) => Finding::not_applicable(about, "this driver has none"),
        Some(LatencyTimer::Short { ms: 0 }) => {
            Finding::fine(about, "0 ms as the driver reports it; the shortest that FTDI specifies is 1 ms")
        }
        Some(LatencyTimer::Short { ms }) => Finding::fine(about, format!("{ms} ms, the shortest")),
        Some(LatencyTimer::Shortened { from_ms }) => Finding::fine(
            about,
            format!(
                "was {from_ms} ms, set to 1 ms until the adapter is unplugged; a udev rule makes it last"
            ),
        ),
        Some(long @ LatencyTimer::Long { .. }) => Finding::wrong(about, long.remedy().unwrap_or_default()),
    }
}

/// First step of every handshake.
pub(super) fn drained() -> Finding {
    Finding::fine("drain", "pending input is discarded, and a delimiter ends a partial frame at the drive")
}

pub(super) fn handshake(identity: &Identity) -> Finding {
    let board = printable(identity.board.as_str());
    let Identity { protocol_version, minor_version, firmware, build_id, state, .. } = identity;
    let bits = [identity.capabilities.bits()];
    // Any byte is a set of flags.
    let capabilities = FieldType::Flags(Capabilities::SET).value(&bits);
    let capabilities = capabilities.map_or_else(String::new, |it| it.to_string());
    let who = format!(
        "{board}, firmware {firmware}, build {build_id:08x}, protocol version {protocol_version}.{minor_version}, \
         capabilities {capabilities}, state {state}"
    );
    match state {
        State::Idle => Finding::fine("handshake", who),
        State::Faulted => Finding::wrong(
            "handshake",
            format!("{who}: a fault is latched; `lashloop run` resets the drive first"),
        ),
        _ => Finding::wrong(
            "handshake",
            format!("{who}: expected Idle after the handshake; power the drive off and on"),
        ),
    }
}

/// What contradicts itself in the drive's description.
pub(super) fn oddity(text: String) -> Finding {
    Finding::wrong("description", text)
}

pub(super) fn round_trip(timing: &Timing) -> Finding {
    let Timing { answered, left_out, p50, p99, max, .. } = *timing;
    let [p50, p99, max] = [p50, p99, max].map(in_us);
    let measured = format!("{answered} samples answered: p50 {p50}, p99 {p99}, max {max}");
    if left_out == 0 {
        return Finding::fine("round trip", measured);
    }
    Finding::wrong(
        "round trip",
        format!("{measured}; too slow for the other {left_out} samples within the time limit"),
    )
}

pub(super) fn losses(timing: &Timing, damaged: u64) -> Option<Finding> {
    let Timing { answered, lost, .. } = *timing;
    if lost == 0 && damaged == 0 {
        return None;
    }
    Some(Finding::wrong(
        "losses",
        format!(
            "{lost} of {} samples without an answer, {damaged} damaged frames: check ground and cable, or take a lower \
             baud rate on both sides",
            answered + lost
        ),
    ))
}

/// Answers without a sample, but for those of lost samples that came late.
pub(super) fn surplus(timing: &Timing) -> Option<Finding> {
    let Timing { answered, lost, surplus, .. } = *timing;
    (surplus > lost).then(|| {
        Finding::wrong(
            "answers",
            format!(
                "{surplus} answers without a sample of this bench, {answered} with one: a second host uses this drive, or drive \
                 or line send frames twice; disconnect every other program"
            ),
        )
    })
}

/// Compares the round trip with `wire`, its time on the line; `None` for a line without a baud rate.
pub(super) fn speed(timing: &Timing, wire: Option<Duration>, timer: Option<&LatencyTimer>) -> Finding {
    let about = "speed";
    let Some(wire) = wire else {
        return Finding::not_applicable(about, "this line has no baud rate to compare with");
    };
    let Some(above) = timing.p50.checked_sub(wire) else {
        return Finding::fine(
            about,
            format!(
                "faster than the {} that {BYTES} bytes take at this baud rate: the port has none, as USB CDC",
                in_us(wire)
            ),
        );
    };
    let sum = format!(
        "p50 is {} above the {} that {BYTES} bytes take on the wire at 10 bits each",
        in_us(above),
        in_us(wire)
    );
    if above < BUFFERING {
        return Finding::fine(about, sum);
    }
    let cause = match timer {
        Some(LatencyTimer::Long { ms, .. }) => format!("the adapter's latency timer of {ms} ms"),
        _ if above >= LATENCY_TIMER => "typical of a latency timer of 16 ms in the adapter or in a \
                                     virtual machine's USB; plug the adapter into the machine itself, or try another"
            .to_owned(),
        _ => "a component buffers bytes: a hub, the adapter, or firmware that answers late"
            .to_owned(),
    };
    Finding::wrong(about, format!("{sum}: {cause}"))
}

fn in_us(time: Duration) -> String {
    format!("{:.1} us", time.as_secs_f64() * 1e6)
}

#[cfg(test)]
mod tests {
    use std::io;
    use std::path::Path;

    use super::super::round_trip::wire_time;
    use super::*;

    fn timing(p50_us: u64) -> Timing {
        let p50 = Duration::from_micros(p50_us);
        Timing { answered: 1000, lost: 0, surplus: 0, left_out: 0, p50, p99: 2 * p50, max: 3 * p50 }
    }

    fn serial_port() -> LineUnderTest<'static> {
        LineUnderTest::SerialPort { terminal: Path::new("/dev/ttyUSB0"), baud: 921_600 }
    }

    fn long_timer() -> LatencyTimer {
        LatencyTimer::Long {
            ms: 16,
            file: "/sys/bus/usb-serial/devices/ttyUSB0/latency_timer".into(),
            reason: io::ErrorKind::PermissionDenied.into(),
        }
    }

    #[test]
    fn long_latency_timer_is_named_as_the_cause() {
        let timer = long_timer();
        let findings = [
            latency_timer(serial_port(), Some(&timer)),
            speed(&timing(16_400), Some(wire_time(921_600)), Some(&timer)),
        ];
        insta::assert_snapshot!(findings.map(|finding| finding.to_string()).join("\n"), @r#"
        WRONG  latency timer  16 ms and can't be shortened (permission denied): echo 1 | sudo tee /sys/bus/usb-serial/devices/ttyUSB0/latency_timer, or for every reconnect a file in /etc/udev/rules.d with the line ACTION=="add", SUBSYSTEM=="usb-serial", DRIVER=="ftdi_sio", ATTR{latency_timer}="1"
        WRONG  speed          p50 is 16020.2 us above the 379.8 us that 35 bytes take on the wire at 10 bits each: the adapter's latency timer of 16 ms
        "#);
    }

    #[test]
    fn a_timer_of_zero_is_not_called_1_ms() {
        let text = |ms| latency_timer(serial_port(), Some(&LatencyTimer::Short { ms })).text;
        assert_eq!(text(1), "1 ms, the shortest");
        assert!(text(0).starts_with("0 ms"), "{}", text(0));
    }

    #[test]
    fn each_speed_has_its_cause() {
        let none = LatencyTimer::None;
        let wire = Some(wire_time(921_600));
        let findings = [100, 900, 4_500, 16_000].map(|p50_us| speed(&timing(p50_us), wire, Some(&none)));
        let text = findings.map(|finding| finding.to_string()).join("\n");
        insta::assert_snapshot!(text, @r"
        ok     speed          faster than the 379.8 us that 35 bytes take at this baud rate: the port has none, as USB CDC
        ok     speed          p50 is 520.2 us above the 379.8 us that 35 bytes take on the wire at 10 bits each
        WRONG  speed          p50 is 4120.2 us above the 379.8 us that 35 bytes take on the wire at 10 bits each: a component buffers bytes: a hub, the adapter, or firmware that answers late
        WRONG  speed          p50 is 15620.2 us above the 379.8 us that 35 bytes take on the wire at 10 bits each: typical of a latency timer of 16 ms in the adapter or in a virtual machine's USB; plug the adapter into the machine itself, or try another
        ");
    }

    #[test]
    fn lost_samples_and_damaged_frames_are_wrong() {
        assert_eq!(losses(&timing(10), 0), None);
        let lossy = Timing { lost: 2, answered: 998, ..timing(10) };
        insta::assert_snapshot!(losses(&lossy, 3).unwrap(), @"WRONG  losses         2 of 1000 samples without an answer, 3 damaged frames: check ground and cable, or take a lower baud rate on both sides");
        assert_eq!(surplus(&Timing { surplus: 2, ..lossy }), None, "late answers");
        assert!(surplus(&Timing { surplus: 3, ..lossy }).unwrap().is_wrong(), "answers to others");
        assert!(losses(&timing(10), 1).unwrap().is_wrong(), "damage alone");
    }

    #[test]
    fn latched_fault_is_wrong_and_an_idle_drive_is_not() {
        let identity = |state| Identity {
            protocol_version: 1,
            minor_version: 0,
            session: 7,
            firmware: lashloop_protocol::enums::Version { major: 0, minor: 1, patch: 0 },
            build_id: 0xc0ffee,
            dirty: 0,
            state,
            board: lashloop_protocol::text::Text::new("stm32f405"),
            period_us: 1000,
            motor_counts_per_rev: 1,
            load_counts_per_rev: 1,
            law_count: 1,
            parameter_count: 27,
            signal_count: 0,
            capabilities: Capabilities::LOADER | Capabilities::from_bits_retain(0x80),
            device_time_us: None,
        };
        assert!(!handshake(&identity(State::Idle)).is_wrong());
        let text = handshake(&identity(State::Idle)).text;
        assert!(text.contains("protocol version 1.0, capabilities LOADER|bit 7, state Idle"), "{text}");
        assert!(handshake(&identity(State::Faulted)).is_wrong());
    }
}
