//! The time from every cause to the bridge off.

use std::time::Duration;

use lashloop_protocol::enums::{Outcome, State};

use crate::bench::{OF_EACH_FAMILY, image, image_of};
use crate::causes::{CAUSES, Cause, cause};
use crate::failures::{PANIC_LINE, PLACE};
use crate::host::Host;
use crate::time_to_off::{of_each, report_of};
use crate::{docs, report};

/// Number of the interrupt of TIM7.
const TIM7: u32 = 55;
/// Control periods.
const PERIODS: [Duration; 2] = [Duration::from_micros(1_000), Duration::from_micros(250)];
/// Instants after a tick at which a cause comes, as fractions of the period. The first is in the step; the worst counts.
const PHASES: [f64; 5] = [0.01, 0.17, 0.39, 0.61, 0.93];

/// An interrupt of the line takes 48 instructions.
const INTERRUPT_US: f64 = 0.3;

/// The longest times of a cause, at each of [`PERIODS`].
fn worst(cause: &Cause) -> Vec<Duration> {
    let instants =
        |phases: &[f64]| PERIODS.map(|period| phases.iter().map(|phase| (period, *phase)).collect());
    let times: Vec<Vec<_>> = if cause.halts {
        // A drive that halts comes back with a reset only.
        let instants: [Vec<_>; 2] = instants(&PHASES[1..2]);
        instants.iter().map(|instants| cause.times_to_off(&image(), instants)).collect()
    } else {
        let times = cause.times_to_off(&image(), &instants(&PHASES).concat());
        times.chunks(PHASES.len()).map(<[_]>::to_vec).collect()
    };
    let off = |off: Option<Duration>| off.unwrap_or_else(|| panic!("{}: the bridge stays on", cause.name));
    times.into_iter().map(|times| times.into_iter().map(off).max().expect("phases")).collect()
}

#[test]
fn every_cause_turns_the_bridge_off_within_its_time() {
    let causes: Vec<_> = CAUSES.iter().collect();
    let measured = of_each(&causes, worst);
    let all = || {
        CAUSES
            .iter()
            .zip(&measured)
            .flat_map(|(cause, times)| PERIODS.iter().zip(times).map(move |it| (cause, it)))
    };
    let lines: Vec<String> = all()
        .map(|(cause, (period, off))| {
            let micros = |time: Duration| time.as_secs_f64() * 1e6;
            format!(
                "bridge off, period {:.0} us, {}: {:.1} us = {:.3} periods after {}, by {}; limit {:.0} us",
                micros(*period),
                cause.name,
                micros(*off),
                off.as_secs_f64() / period.as_secs_f64(),
                cause.from,
                cause.by,
                micros((cause.limit)(*period)),
            )
        })
        .collect();
    report::write("bridge-off", &lines);
    for (cause, (period, off)) in all() {
        let limit = (cause.limit)(*period);
        assert!(*off <= limit, "{} at {period:?}: off after {off:?}, limit {limit:?}", cause.name);
    }
    let wrong: Vec<_> =
        CAUSES.iter().zip(&measured).flat_map(|(it, times)| compare_with_docs(it, times)).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// What is wrong with the row of a cause. Another build of the image shifts its steps, so a tenth of the limit is tolerated, and an
/// interrupt of the line, which may come between cause and handler or not.
fn compare_with_docs(cause: &Cause, measured: &[Duration]) -> Vec<String> {
    let cells = docs::row(cause.name);
    let [from, by, within, figures @ ..] = &cells[..] else { return vec![format!("{cells:?}")] };
    assert_eq!((from.as_str(), by.as_str()), (cause.from, cause.by), "{}", cause.name);
    assert_eq!(figures.len(), PERIODS.len(), "{}", cause.name);
    let micros = |time: Duration| time.as_secs_f64() * 1e6;
    let mut wrong = Vec::new();
    for ((period, figure), measured) in PERIODS.iter().zip(figures).zip(measured) {
        let limit = (cause.limit)(*period);
        assert_eq!(docs::time(within, *period), limit, "{}: within {within}", cause.name);
        let what = format!("{} at {} us, in us", cause.name, micros(*period));
        let documented = docs::time(figure, *period);
        wrong.extend(docs::off(
            &what,
            micros(documented),
            micros(*measured),
            0.1 * micros(limit) + INTERRUPT_US,
        ));
    }
    wrong
}

#[test]
fn a_crystal_that_stops_turns_the_bridge_off_without_software() {
    for board in OF_EACH_FAMILY {
        let mut host = Host::under_torque(&image_of(board), PERIODS[0]);
        let at = host.bench.act(|chip, _| {
            chip.stop_crystal();
            chip.now()
        });
        host.bench.advance(Duration::from_micros(1));
        let off = host.bench.time_to_off(at);
        assert!(off.is_some_and(|off| off < Duration::from_micros(1)), "{board}: {off:?}");
    }
}

#[test]
fn a_tick_that_is_missing_from_the_start_on_turns_the_bridge_off() {
    for period in PERIODS {
        let missing = cause("tick missing");
        let mut host = Host::at(&missing.image(&image()), (0, 0));
        missing.place(&mut host, &image());
        host.period = period;
        host.set_all(&[]);
        assert_eq!(host.arm(), (Outcome::Accepted, State::Armed));
        (missing.happen)(&mut host);
        let at = host.bench.now();
        assert_eq!(host.start(), (Outcome::Accepted, State::Running));
        host.bench.advance(period.mul_f64(1.5));
        let changes = host.bench.act(|_, site| site.log.bridge.clone());
        assert!(changes.iter().any(|(on, bridge)| *on > at && bridge.is_on()), "never on");
        assert!(!host.bench.bridge().is_on(), "{period:?}");
    }
}

#[test]
fn the_report_of_a_fatal_failure_has_its_place() {
    for (name, detail) in [
        ("panic", PANIC_LINE),
        ("HardFault", PLACE),
        // Its place would be on the stack.
        ("stack overflow", 0),
        ("unexpected interrupt", TIM7),
    ] {
        assert_eq!(report_of(cause(name)).detail, detail, "{name}");
    }
}
