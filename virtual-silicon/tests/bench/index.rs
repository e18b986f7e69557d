//! The index pulse of an encoder as its zero.

use std::time::Duration;

use lashloop_protocol::EncoderCounts;
use lashloop_protocol::enums::{Outcome, ParameterValue, State, ZeroSource};
use lashloop_protocol::message::{SetZero, Stop};
use lashloop_silicon::boards::{self, BUILT_IN};
use lashloop_silicon::wiring::Encoder;

use crate::bench::{Bench, image_of};
use crate::host::Host;
use crate::time_to_off::of_each;
use crate::turntable::{self, Speeds};

const MS: Duration = Duration::from_millis(1);
/// Counts of a revolution.
const REV: i64 = 131_072;
/// Where the index of the motor and that of the load are.
const PLACES: [(Encoder, i64); 2] = [(Encoder::Motor, 5_000), (Encoder::Load, -3_000)];

/// A drive at these counts whose encoders have an index, and whose zero is at that of this one.
fn idle(board: &str, counts: (i64, i64), encoder: Encoder, others: &[(&str, ParameterValue)]) -> Host {
    let speeds = Speeds::default();
    let train = PLACES.iter().fold(turntable::drive_train(&speeds, counts), |train, (encoder, place)| {
        train.with_index(*encoder, *place, REV)
    });
    let mut host = Host::of(Bench::with_turntable(&image_of(board), train, speeds));
    let input = if encoder == Encoder::Motor { 1 } else { 2 };
    host.set_all(&[
        ("index_input", ParameterValue::U32(input)),
        ("motor_speed_limit_rad_s", ParameterValue::F32(1_500.0)),
        ("load_speed_limit_rad_s", ParameterValue::F32(1_500.0)),
        ("twist_limit_rad", ParameterValue::F32(1e5)),
    ]);
    host.set_all(others);
    host
}

/// Turns an encoder at a speed in counts per second for a time, and stops it.
fn turn(host: &mut Host, encoder: Encoder, speed: f64, time: Duration) {
    let speeds = if encoder == Encoder::Motor { (speed, 0.0) } else { (0.0, speed) };
    host.bench.turn(speeds.0, speeds.1);
    host.bench.advance(time);
    host.bench.turn(0.0, 0.0);
    host.bench.advance(3 * MS);
}

/// Counts that the drive reports, and those of the wires.
fn counts(host: &mut Host, encoder: Encoder) -> (EncoderCounts, i64) {
    host.run();
    let sample = *host.steps(3, 0.0).last().expect("a sample");
    assert_eq!(host.command(Stop {}), (Outcome::Accepted, State::Idle));
    let wires = host.bench.act(move |_, site| site.train.count(encoder));
    (if encoder == Encoder::Motor { sample.motor_counts } else { sample.load_counts }, wires)
}

fn await_zero(host: &mut Host) {
    let request = host.command(SetZero { source: ZeroSource::Home });
    assert_eq!(request, (Outcome::Accepted, State::Idle));
    // A pulse of the same period as the request may be older than it.
    host.bench.advance(2 * MS);
}

#[test]
fn all_encoders_of_all_boards_have_an_index_but_the_load_of_an_odrive() {
    for board in ["stm32f405", "nucleo-f446re", "nucleo-f429zi", "nucleo-h743zi", "odrive-v3"] {
        let wiring = boards::open(board).expect("a board");
        let has_index = PLACES.map(|(encoder, _)| wiring.encoder(encoder).index.is_some());
        assert_eq!(has_index, [true, board != "odrive-v3"], "{board}");
    }
}

#[test]
fn every_index_input_of_every_board_sets_the_zero_of_its_encoder() {
    let of_board = |(board, _): &(&'static str, &str)| PLACES.map(|place| (*board, place));
    let cases: Vec<_> = BUILT_IN.iter().flat_map(of_board).collect();
    of_each(&cases.iter().collect::<Vec<_>>(), |(board, (encoder, place))| {
        let has_index = boards::open(board).is_ok_and(|wiring| wiring.encoder(*encoder).index.is_some());
        let mut host = idle(board, (0, 0), *encoder, &[]);
        if !has_index {
            let refused = host.command(SetZero { source: ZeroSource::Home });
            assert_eq!(refused, (Outcome::Inconsistent, State::Idle), "{board}: {encoder:?}");
            return;
        }
        await_zero(&mut host);
        let towards = if *place < 0 { -1e6 } else { 1e6 };
        turn(&mut host, *encoder, towards, 8 * MS);
        let (reported, wires) = counts(&mut host, *encoder);
        assert_eq!(reported, EncoderCounts::wrapping(wires - place), "{board}: {encoder:?}, {wires}");
    });
}

/// A pulse of one count at 20 million counts per second is 50 ns long; the filter passes 48.
#[test]
fn a_pulse_one_count_wide_at_full_speed_is_latched_exactly() {
    for (start, speed) in [(0, 20e6), (0, 7.3e6), (10_000, -20e6), (10_000, -1.1e6), (4_990, 3e3)] {
        let mut host = idle("stm32f405", (start, 0), Encoder::Motor, &[]);
        await_zero(&mut host);
        turn(
            &mut host,
            Encoder::Motor,
            speed,
            Duration::from_secs_f64(5_500.0 / f64::abs(speed)).max(MS).min(9 * MS),
        );
        let (reported, wires) = counts(&mut host, Encoder::Motor);
        assert!((wires - 5_000).signum() == speed.signum() as i64, "{start}, {speed}: not passed, {wires}");
        assert_eq!(reported, EncoderCounts::wrapping(wires - 5_000), "from {start} at {speed}, {wires}");
        // Later pulses move nothing.
        turn(&mut host, Encoder::Motor, -speed.signum() * 4e6, 4 * MS);
        let (reported, wires) = counts(&mut host, Encoder::Motor);
        assert_eq!(reported, EncoderCounts::wrapping(wires - 5_000), "from {start} at {speed}, later");
    }
}

#[test]
fn positions_after_an_index_are_equal_after_a_power_cycle() {
    // The shaft stands elsewhere at each power-up.
    let positions = [-77, 1_234, 4_000].map(|start| {
        let mut host = idle("stm32f405", (start, 900), Encoder::Motor, &[]);
        await_zero(&mut host);
        turn(&mut host, Encoder::Motor, 1e6, 6 * MS);
        // Back to one place.
        let wires = host.bench.act(|_, site| site.train.count(Encoder::Motor));
        let way = 4_500 - wires;
        turn(&mut host, Encoder::Motor, way as f64 * 100.0, 10 * MS);
        let (reported, wires) = counts(&mut host, Encoder::Motor);
        wires - i64::from(reported.get())
    });
    assert_eq!(positions, [5_000; 3]);
}

#[test]
fn with_a_home_switch_the_pulse_counts_while_the_switch_is_closed() {
    let home = [("home_input", ParameterValue::U32(1))];
    let mut host = idle("stm32f405", (0, 0), Encoder::Motor, &home);
    await_zero(&mut host);
    // A revolution without the switch, and then one with it.
    turn(&mut host, Encoder::Motor, 1e6, 20 * MS);
    let (reported, wires) = counts(&mut host, Encoder::Motor);
    assert_eq!(reported, EncoderCounts::wrapping(wires), "the zero of the power-up");
    host.bench.act(|chip, _| {
        let pin = chip.contacts().home;
        chip.close_contact(pin, true);
    });
    turn(&mut host, Encoder::Motor, 4e6, 30 * MS);
    let (reported, wires) = counts(&mut host, Encoder::Motor);
    assert_eq!(reported, EncoderCounts::wrapping(wires - 5_000 - REV), "{wires}");
}
