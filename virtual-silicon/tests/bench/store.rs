//! Parameters that survive a reset and power-off.
//!
//! The models of the STM32H743 program and erase its flash. Those of an STM32F4 do neither, and show only the start, the time of an
//! erasure, and what a drive says whose memory refuses to be written.

use std::time::Duration;

use lashloop_protocol::DriveMessage;
use lashloop_protocol::enums::{Capabilities, Outcome, ParameterValue, State};
use lashloop_protocol::message::{ForgetParameters, GetParameter, Hello, StoreParameters};
use lashloop_silicon::symbols::Symbols;

use crate::bench::{Bench, image, image_of};
use crate::host::{Host, SESSION};
use crate::report;

const WITH_MODEL: &str = "nucleo-h743zi";
/// First sector of the store of the board whose models program it, and of those that have others.
const SECTOR: u64 = 0x081c_0000;
const OTHERS: [(&str, u64); 3] =
    [("stm32f405", 0x080c_0000), ("nucleo-f446re", 0x0804_0000), ("nucleo-f429zi", 0x081c_0000)];
const SECTOR_BYTES: u64 = 0x2_0000;
const SLOT_BYTES: u64 = 0x800;
/// The first and the last parameter of a record that a test can change without another effect.
const FIRST: &str = "motor_counts_per_rev";
const LAST: &str = "rig_id";
/// Most of a start, without an erasure.
const START: Duration = Duration::from_millis(40);

fn set(host: &mut Host, value: u32) {
    for name in [FIRST, LAST] {
        assert_eq!(host.set(name, ParameterValue::U32(value)), Outcome::Accepted);
    }
}

/// Values of both parameters.
fn values(host: &mut Host) -> [ParameterValue; 2] {
    [FIRST, LAST].map(|name| {
        let index = host.index(name);
        host.exchange(GetParameter { index }, |message| match message {
            DriveMessage::ParameterReport(report) if report.index == index => Some(report.value),
            _ => None,
        })
    })
}

fn both(value: u32) -> [ParameterValue; 2] {
    [ParameterValue::U32(value); 2]
}

/// Resets the chip by its pin, and opens a session after this time.
fn restart(host: &mut Host, after: Duration) {
    host.bench.allow_resets();
    host.expects_cut_frame = true;
    host.bench.act(|chip, _| chip.reset());
    host.bench.advance(after);
    host.send(Hello::new(SESSION));
    host.bench.advance(Duration::from_millis(10));
    host.shake_hands(SESSION);
}

/// A host of a board whose models program its flash.
fn host() -> Host {
    Host::at(&image_of(WITH_MODEL), (0, 0))
}

/// Words of the chip's memory.
fn dump(host: &mut Host, at: u64, bytes: u64) -> Vec<u8> {
    host.bench.act(move |chip, _| {
        (at..at + bytes).step_by(4).flat_map(|at| chip.word(at).expect("memory").to_le_bytes()).collect()
    })
}

/// The slot of a store with this value of both parameters.
fn record(value: u32) -> Vec<u8> {
    let mut host = host();
    set(&mut host, value);
    assert_eq!(host.command(StoreParameters {}), (Outcome::Accepted, State::Idle));
    dump(&mut host, SECTOR, SLOT_BYTES)
}

#[test]
fn stored_parameters_are_in_force_after_a_reset_until_they_are_forgotten() {
    let mut host = host();
    assert!(host.shake_hands(SESSION).capabilities.contains(Capabilities::STORE));
    let defaults = values(&mut host);
    set(&mut host, 4_242);
    let began = host.bench.now();
    assert_eq!(host.command(StoreParameters {}), (Outcome::Accepted, State::Idle));
    let took = host.bench.now() - began;
    restart(&mut host, START);
    assert_eq!(values(&mut host), both(4_242));
    assert_eq!(host.command(ForgetParameters {}), (Outcome::Accepted, State::Idle));
    assert_eq!(values(&mut host), defaults);
    restart(&mut host, START);
    assert_eq!(values(&mut host), defaults);
    assert_eq!(host.bench.act(|chip, _| chip.resets()), 2, "none by the watchdog");
    report::write(
        "store-silicon",
        &[format!("a store on virtual silicon ({WITH_MODEL}): {took:?}, answer included")],
    );
}

#[test]
fn a_reset_at_any_instant_of_a_store_leaves_the_old_or_the_new_set() {
    const CUTS: u32 = 40;
    let mut host = host();
    set(&mut host, 1_000);
    let began = host.bench.now();
    assert_eq!(host.command(StoreParameters {}), (Outcome::Accepted, State::Idle));
    let whole = host.bench.now() - began;
    let (mut old, mut found_new) = (1_000, 0);
    for cut in 1..=CUTS {
        let new = 1_000 + cut;
        set(&mut host, new);
        host.send(StoreParameters {});
        host.bench.advance(whole * cut / CUTS);
        restart(&mut host, START);
        let found = values(&mut host);
        assert!(found == both(old) || found == both(new), "cut {cut}: {found:?}");
        if found == both(new) {
            (old, found_new) = (new, found_new + 1);
        }
    }
    assert!((1..CUTS / 2).contains(&found_new), "{found_new} of {CUTS} have the new set");
    assert_eq!(host.bench.act(|chip, _| chip.resets()), CUTS as usize, "none by the watchdog");
}

#[test]
fn a_full_sector_is_erased_at_the_next_start_before_the_watchdog_runs() {
    let mut host = host();
    for store in 0..65 {
        set(&mut host, 5_000 + store);
        assert_eq!(host.command(StoreParameters {}), (Outcome::Accepted, State::Idle));
    }
    restart(&mut host, Duration::from_millis(2_500));
    assert_eq!(values(&mut host), both(5_064));
    assert_eq!(host.bench.act(|chip, _| chip.resets()), 1, "none by the watchdog");
    assert!(dump(&mut host, SECTOR, SECTOR_BYTES).iter().all(|byte| *byte == 0xff));
    // A sector that was erased is not erased again.
    restart(&mut host, START);
    assert_eq!(values(&mut host), both(5_064));
}

#[test]
fn every_board_starts_with_what_its_last_sectors_hold() {
    let record = record(4_243);
    for (board, sector) in [(WITH_MODEL, SECTOR)].iter().chain(&OTHERS) {
        for sector in [*sector, sector + SECTOR_BYTES] {
            let mut host = Host::of(Bench::with_kept(&image_of(board), sector, record.clone()));
            assert_eq!(values(&mut host), both(4_243), "{board}, {sector:#x}");
        }
    }
}

#[test]
fn a_record_with_a_wrong_bit_is_not_in_force() {
    let mut record = record(4_244);
    record[600] ^= 0x10;
    let mut host = Host::of(Bench::with_kept(&image(), OTHERS[0].1, record));
    assert_ne!(values(&mut host)[1], ParameterValue::U32(4_244));
}

#[test]
fn a_memory_that_refuses_to_be_written_is_reported_and_the_drive_goes_on() {
    let mut host = Host::at(&image(), (0, 0));
    set(&mut host, 4_245);
    let refusal = host.exchange(StoreParameters {}, |message| match message {
        DriveMessage::CommandResult(it) => Some((it.outcome, it.detail, it.state)),
        _ => None,
    });
    assert_eq!(refusal, (Outcome::StoreFailed, 1, State::Idle));
    assert_eq!(values(&mut host), both(4_245));
    // Programming in words of 32 bits, with the memory unlocked; then locked again.
    assert_eq!(host.bench.act(|_, site| site.log.flash_control.clone()), [0x201, 0x8000_0000]);
    host.set_all(&[]);
    host.run_under_torque();
}

/// Time from power-up to the first tick.
fn start_of(image: &Symbols, kept: (u64, Vec<u8>)) -> Duration {
    let mut bench = Bench::with_kept(image, kept.0, kept.1);
    bench.advance(Duration::from_millis(2_500));
    bench.act(|_, site| site.log.ticks.first().copied()).expect("a tick")
}

#[test]
fn a_start_that_erases_takes_two_seconds_and_no_other() {
    let (board, sector) = OTHERS[0];
    let in_second = (sector + SECTOR_BYTES, vec![0; 32]);
    let [blank, erasing] = [(sector, vec![0xff; 32]), in_second].map(|kept| start_of(&image_of(board), kept));
    assert!(blank < START, "{blank:?}");
    assert!((Duration::from_millis(900)..Duration::from_millis(2_100)).contains(&erasing), "{erasing:?}");
    report::write(
        "store-start",
        &[format!("start of {board} on virtual silicon: {blank:?}, and {erasing:?} if it erases a sector")],
    );
}
