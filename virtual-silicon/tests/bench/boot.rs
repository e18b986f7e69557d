//! Boot and handshake.

use std::time::Duration;

use lashloop_protocol::enums::State;

use crate::bench::{Bench, image};
use crate::host::{Host, SESSION};

#[test]
fn the_image_boots_from_the_crystal_with_every_pin_connected() {
    let mut bench = Bench::boot(&image(), (0, 0));
    bench.advance(Duration::from_millis(200));
    assert_eq!(bench.act(|chip, _| chip.unconnected()), [""; 0]);
    // 1 ms of the crystal, exact; the oscillator inside the chip is not.
    let ticks = bench.act(|_, site| site.log.ticks.clone());
    let periods: Vec<_> = ticks.windows(2).map(|pair| pair[1] - pair[0]).skip(1).collect();
    assert!(periods.len() > 150, "{} ticks", periods.len());
    let mean = periods.iter().sum::<Duration>() / u32::try_from(periods.len()).expect("few");
    assert!(mean.abs_diff(Duration::from_millis(1)) < Duration::from_nanos(50), "{mean:?}");
}

#[test]
fn a_core_halted_by_a_debugger_stops_the_pwm_and_not_the_watchdog() {
    let mut bench = Bench::boot(&image(), (0, 0));
    bench.advance(Duration::from_millis(200));
    assert_eq!(bench.act(|chip, _| chip.halted_by_debugger()), (true, true));
}

#[test]
fn a_booted_drive_is_off_and_describes_its_bench_mode() {
    let mut host = Host::at(&image(), (0, 0));
    let identity = host.shake_hands(SESSION);
    assert_eq!((identity.state, identity.board.as_str()), (State::Idle, "stm32f405"));
    assert_eq!(
        host.take(|message| matches!(message, lashloop_protocol::DriveMessage::Log(_)).then_some(())),
        []
    );
    let changes = host.bench.act(|_, site| site.log.bridge.clone());
    assert!(changes.iter().all(|(_, bridge)| !bridge.is_enabled && !bridge.has_main_output), "{changes:?}");
}
