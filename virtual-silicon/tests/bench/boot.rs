//! Boot and handshake.

use std::time::Duration;

use lashloop_protocol::enums::State;
use lashloop_protocol::message::{DescribeLaw, EncoderSample, Hello};
use lashloop_protocol::{DriveMessage, EncoderCounts};
use lashloop_silicon::thumb::{Code, FOREVER, MASK_INTERRUPTS};

use crate::bench::{Bench, OF_EACH_FAMILY, image, image_of};
use crate::failures::{failing, place};
use crate::host::{Host, SESSION};

/// Mean period of the tick in 0.2 s after power-up, and the number of periods.
fn period(bench: &mut Bench) -> (Duration, usize) {
    bench.advance(Duration::from_millis(200));
    let ticks = bench.act(|_, site| site.log.ticks.clone());
    let periods: Vec<_> = ticks.windows(2).map(|pair| pair[1] - pair[0]).skip(1).collect();
    (periods.iter().sum::<Duration>() / u32::try_from(periods.len().max(1)).expect("few"), periods.len())
}

#[test]
fn the_image_boots_from_every_known_crystal_at_one_speed_with_every_pin_connected() {
    // The models of the STM32H743 show which input the image measures. Those of an STM32F4 don't: it has to select it once.
    let images = [(image(), 1), (image_of("nucleo-h743zi"), 0)];
    let crystals = [8_000_000, 12_000_000, 16_000_000, 25_000_000];
    let cases = images.iter().flat_map(|(image, want)| crystals.map(|crystal_hz| (image, *want, crystal_hz)));
    for (image, selections_wanted, crystal_hz) in cases {
        let mut bench = Bench::with_crystal(image, crystal_hz);
        // 1 ms of the crystal, exact; the oscillator inside the chip is not.
        let (mean, count) = period(&mut bench);
        assert!(count > 150, "{crystal_hz} Hz: {count} periods");
        assert!(
            mean.abs_diff(Duration::from_millis(1)) < Duration::from_nanos(50),
            "{crystal_hz} Hz: {mean:?}"
        );
        assert_eq!(bench.act(|chip, _| chip.misconfigured()), [""; 0]);
        let (is_internal, selections) =
            bench.act(|chip, site| (chip.clocks_are_internal(), site.log.lsi_selections));
        assert!(!is_internal, "{crystal_hz} Hz");
        assert_eq!(selections, selections_wanted, "{crystal_hz} Hz");
    }
}

#[test]
fn a_crystal_of_another_frequency_is_not_used() {
    for crystal_hz in [4_000_000, 7_500_000, 8_600_000, 10_000_000, 14_000_000, 20_000_000] {
        let mut host = Host::of(Bench::with_crystal(&image(), crystal_hz));
        assert_eq!(logs(&mut host), ["no known crystal: clock 1% RC, no bench mode"], "{crystal_hz} Hz");
        assert!(host.bench.act(|chip, _| chip.clocks_are_internal()), "{crystal_hz} Hz");
        assert!(!host.names().iter().any(|name| name == "sample_source"), "{crystal_hz} Hz");
    }
}

#[test]
fn a_core_halted_by_a_debugger_stops_the_pwm_and_not_the_watchdog() {
    for board in OF_EACH_FAMILY {
        let mut bench = Bench::power_up(&image_of(board), (0, 0));
        bench.advance(Duration::from_millis(200));
        assert_eq!(bench.act(|chip, _| chip.halted_by_debugger()), (true, true), "{board}");
    }
}

#[test]
fn a_booted_drive_is_off_and_describes_its_bench_mode() {
    let mut host = Host::of(Bench::power_up(&image(), (0, 0)));
    let identity = host.shake_hands(SESSION);
    assert_eq!((identity.state, identity.board.as_str()), (State::Idle, "stm32f405"));
    assert_eq!(logs(&mut host), [""; 0]);
    let changes = host.bench.act(|_, site| site.log.bridge.clone());
    assert!(changes.iter().all(|(_, bridge)| !bridge.is_enabled && !bridge.has_main_output), "{changes:?}");
}

#[test]
fn a_reset_by_its_pin_turns_the_bridge_off_and_boots_an_idle_drive() {
    let mut host = Host::under_torque(&image(), Duration::from_millis(1));
    host.bench.allow_resets();
    let reset_at = host.bench.act(|chip, _| {
        chip.reset();
        chip.now()
    });
    // A frame may have been on the line. What is left of it takes the drive's next frame with it, so that a host repeats its
    // first request.
    host.expects_cut_frame = true;
    host.bench.advance(Duration::from_millis(20));
    let off = host.bench.time_to_off(reset_at);
    assert!(off.is_some_and(|off| off < Duration::from_micros(1)), "{off:?}");
    host.send(Hello::new(SESSION));
    host.bench.advance(Duration::from_millis(10));
    assert_eq!(host.shake_hands(SESSION).state, State::Idle);
    assert_eq!(host.bench.act(|chip, _| (chip.misconfigured(), chip.resets())), (Vec::new(), 1));
}

#[test]
fn the_first_timeout_of_the_watchdog_is_as_short_as_the_later_ones() {
    for board in OF_EACH_FAMILY {
        let stuck = Code::default().halfword(FOREVER);
        let stuck = image_of(board).with_code("SysTick", |_| stuck.clone()).expect("the task");
        let mut bench = Bench::power_up(&stuck, (0, 0));
        bench.allow_resets();
        bench.advance(Duration::from_millis(25));
        let resets = bench.act(|chip, _| chip.resets());
        assert!((2..=4).contains(&resets), "{board}: {resets} resets");
    }
}

#[test]
fn a_drive_that_its_watchdog_reset_reports_it_once() {
    for board in OF_EACH_FAMILY {
        let mut host = Host::at(&failing(&image_of(board)), (0, 0));
        host.bench.allow_resets();
        host.expects_cut_frame = true;
        assert_eq!(logs(&mut host), [""; 0], "{board}");
        place(&mut host, &Code::default().halfwords(&[MASK_INTERRUPTS, FOREVER]));
        host.send(DescribeLaw { index: 0 });
        // The watchdog's timeout, and the start.
        host.bench.advance(Duration::from_millis(40));
        host.shake_hands(SESSION);
        assert_eq!(logs(&mut host), ["the watchdog reset the drive"], "{board}");
        host.bench.act(|chip, _| chip.reset());
        host.bench.advance(Duration::from_millis(20));
        host.shake_hands(SESSION);
        assert_eq!(logs(&mut host), [""; 0], "{board}");
        assert_eq!(host.bench.act(|chip, _| chip.resets()), 2, "{board}");
    }
}

/// Texts that the drive has logged.
fn logs(host: &mut Host) -> Vec<String> {
    host.take(|message| match message {
        DriveMessage::Log(log) => Some(log.text.as_str().to_owned()),
        _ => None,
    })
}

/// The drive as after power-up, but no motor turns.
#[test]
fn without_a_crystal_the_drive_reports_it_and_has_no_bench_mode() {
    let mut bench = Bench::without_crystal(&image());
    // 0.1 s of waiting for the crystal.
    bench.advance(Duration::from_millis(180));
    let mut host = Host::of(bench);
    assert_eq!(logs(&mut host), ["no crystal: clock 1% RC, no bench mode"]);
    let identity = host.shake_hands(SESSION);
    assert_eq!((identity.state, identity.board.as_str()), (State::Idle, "stm32f405"));
    let names = host.names();
    assert!(!names.iter().any(|name| name == "sample_source"), "{names:?}");
    // Samples come from the host, and the power stage stays off under their torque.
    host.run();
    let mut torques_nm = Vec::new();
    for sequence in 0..5 {
        let at_rest = EncoderCounts::wrapping(0);
        let sample =
            EncoderSample { sequence, motor_counts: at_rest, load_counts: at_rest, reference_rad: 0.3 };
        torques_nm.push(host.exchange(sample, |message| match message {
            DriveMessage::TorqueAnswer(answer) => Some(answer.torque_nm),
            _ => None,
        }));
    }
    assert!(torques_nm.iter().all(|it| *it > 0.0), "{torques_nm:?}");
    let (changes, is_internal) =
        host.bench.act(|chip, site| (site.log.bridge.clone(), chip.clocks_are_internal()));
    assert!(changes.iter().all(|(_, bridge)| !bridge.is_enabled && !bridge.has_main_output), "{changes:?}");
    assert!(is_internal, "the clock is not that of the crystal");
}
