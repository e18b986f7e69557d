//! Encoders at the pins against the counts of the drive.

use std::time::Duration;

use lashloop_protocol::EncoderCounts;
use lashloop_protocol::enums::{FaultCode, ParameterValue, TorqueFlags};
use lashloop_protocol::message::BenchSample;
use lashloop_silicon::quadrature::{Channel, Edge, Quadrature};
use lashloop_silicon::wiring::Encoder;

use crate::bench::image;
use crate::host::Host;
use crate::report;

const MS: Duration = Duration::from_millis(1);

/// Speeds that no speed limit and no twist limit stops.
const UNLIMITED: [(&str, ParameterValue); 4] = [
    ("motor_speed_limit_rad_s", ParameterValue::F32(1_500.0)),
    ("load_speed_limit_rad_s", ParameterValue::F32(1_500.0)),
    ("twist_limit_rad", ParameterValue::F32(1e5)),
    ("bench_sample_every", ParameterValue::U32(1)),
];

/// A drive that runs with a reference of 0 on encoders at these counts.
fn running_at(counts: (i64, i64), parameters: &[(&str, ParameterValue)]) -> Host {
    let mut host = Host::at(&image(), counts);
    host.set_all(&UNLIMITED);
    host.set_all(parameters);
    host.run();
    host
}

/// Counts of the wires at the drive's last reading of the motor encoder.
fn wires(host: &mut Host) -> (i64, i64) {
    // A reading takes the counter twice.
    host.bench.act(|_, site| {
        let [.., (_, motor, load), _] = site.log.readings[..] else { panic!("no reading") };
        (motor, load)
    })
}

fn counts(sample: &BenchSample) -> (EncoderCounts, EncoderCounts) {
    (sample.motor_counts, sample.load_counts)
}

fn wrapping((motor, load): (i64, i64)) -> (EncoderCounts, EncoderCounts) {
    (EncoderCounts::wrapping(motor), EncoderCounts::wrapping(load))
}

#[test]
fn counts_follow_both_ways_through_every_wrap_of_the_timers() {
    let mut host = running_at((0, 0), &[]);
    // 200,000 counts each way: three times the range of a 16-bit timer. The load turns the other way.
    for (motor, load) in [(4e6, -2e6), (-8e6, 4e6), (4e6, -2e6)] {
        host.bench.turn(motor, load);
        for sample in host.steps(50, 0.0) {
            assert_eq!(sample.status.state, lashloop_protocol::enums::State::Running);
        }
        host.bench.turn(0.0, 0.0);
        let samples = host.steps(3, 0.0);
        assert_eq!(counts(samples.last().expect("samples")), wrapping(wires(&mut host)));
    }
    assert_eq!(host.faults(), []);
    let travelled = host.bench.act(|_, site| {
        let motor = site.log.readings.iter().map(|reading| reading.1);
        (motor.clone().min().expect("readings"), motor.max().expect("readings"))
    });
    assert!(travelled.0 < -150_000 && travelled.1 > 150_000, "{travelled:?}");
}

#[test]
fn every_reading_of_a_moving_encoder_is_that_of_its_wires() {
    let mut host = running_at((0, 0), &[]);
    host.bench.turn(777_000.0, -333_000.0);
    host.steps(2, 0.0);
    // From the middle between two ticks every step is reported before its end.
    let tick = host.bench.act(|_, site| *site.log.ticks.last().expect("a tick"));
    host.bench.advance_to(tick + MS + MS / 2);
    host.samples();
    for _ in 0..100 {
        let samples = host.steps(1, 0.0);
        let (motor, load) = wires(&mut host);
        let [sample] = samples[..] else { panic!("one sample in a period: {samples:?}") };
        // The filter delays the counter by 4 samples of 84 MHz, and the load is read after the motor: less than one count.
        let (of_motor, of_load) = wrapping((motor, load));
        let ahead = [sample.motor_counts.wrapping_sub(of_motor), sample.load_counts.wrapping_sub(of_load)];
        assert!(ahead.iter().all(|counts| counts.abs() <= 1), "{ahead:?} counts off");
    }
}

/// Counts that the timers lost at this speed in 20 ms.
fn lost_at(counts_per_s: f64) -> (i32, i32) {
    let mut host = running_at((0, 0), &[]);
    host.bench.turn(counts_per_s, -counts_per_s);
    host.steps(20, 0.0);
    host.bench.turn(0.0, 0.0);
    let sample = *host.steps(3, 0.0).last().expect("samples");
    assert_eq!(host.faults(), [], "at {counts_per_s} counts/s");
    let want = wrapping(wires(&mut host));
    (sample.motor_counts.wrapping_sub(want.0), sample.load_counts.wrapping_sub(want.1))
}

#[test]
fn no_count_is_lost_up_to_the_default_speed_limit() {
    // 1000 rad/s of 131,072 counts per revolution are 20.9 million counts per second.
    let speeds = [1e6, 5e6, 12e6, 20.8e6];
    let lost = speeds.map(lost_at);
    let lines: Vec<String> = speeds
        .iter()
        .zip(&lost)
        .map(|(speed, lost)| format!("encoders, {:.1} million counts/s: {lost:?} counts lost", speed / 1e6))
        .collect();
    report::write("bench-encoders", &lines);
    assert!(lost.iter().all(|lost| *lost == (0, 0)), "{lost:?}");
}

/// Faults, and counts off, under pulses of this length: on one channel, on both of an encoder, and on all at once.
fn faults_and_counts_under_pulses(length_ns: u32, (stops_ns, passes_ns): (u32, u32)) -> (usize, [i32; 2]) {
    let length = Duration::from_nanos(length_ns.into());
    // 1.5 counts of 131,072 while a level passes, and a little less.
    let limit = ParameterValue::F32(70_000.0 / passes_ns as f32);
    let limits = [("motor_speed_limit_rad_s", limit), ("load_speed_limit_rad_s", limit)];
    let mut host =
        // Both channels of the motor encoder are high: on a chip, though not in the models, a new filter starts low.
        running_at((2, 1), &[&limits[..], &[("encoder_filter_ns", ParameterValue::U32(stops_ns))]].concat());
    host.steps(5, 0.0);
    let mut apart = [0, 0];
    for channels in [&CHANNELS[..1], &CHANNELS[1..2], &CHANNELS[..2], &CHANNELS[2..], &CHANNELS[..]] {
        // Each pulse begins 37 ns later in the step than the one before; the first ends at the reading of the motor encoder.
        for at in 0..20 {
            let reading = host.bench.act(|_, site| {
                let [.., (at, ..), _] = site.log.readings[..] else { panic!("no reading") };
                at
            });
            host.bench.advance_to(reading + MS - length + Duration::from_nanos(37 * at));
            for level in [true, false] {
                host.bench.act(move |chip, site| {
                    for (encoder, channel) in channels {
                        let is_high = Quadrature::at(site.train.count(*encoder)).is_high(*channel) ^ level;
                        chip.drive_encoder(*encoder, Edge { channel: *channel, is_high });
                    }
                });
                host.bench.advance(length);
            }
            let sample = *host.steps(1, 0.0).last().expect("a sample");
            let want = wrapping(wires(&mut host));
            for (apart, off) in apart
                .iter_mut()
                .zip([sample.motor_counts.wrapping_sub(want.0), sample.load_counts.wrapping_sub(want.1)])
            {
                *apart = off.abs().max(*apart);
            }
        }
    }
    (host.faults().len(), apart)
}

#[test]
fn a_pulse_that_the_filter_stops_costs_no_count_and_no_run() {
    for (stops_ns, passes_ns) in
        [(35, 48), (83, 95), (119, 143), (166, 190), (333, 381), (666, 762), (1_333, 1_524), (2_666, 3_048)]
    {
        // The board acts between two instructions: a pulse may be longer or shorter by 6 ns.
        for (length_ns, is_stopped) in [(stops_ns - 7, true), (passes_ns + 7, false)] {
            let seen = faults_and_counts_under_pulses(length_ns, (stops_ns, passes_ns));
            assert_eq!(seen == (0, [0, 0]), is_stopped, "{length_ns} ns, filter of {passes_ns} ns: {seen:?}");
        }
    }
}

#[test]
fn a_reversed_encoder_counts_the_other_way() {
    let reversed = [("motor_direction", ParameterValue::U32(1)), ("load_direction", ParameterValue::U32(1))];
    let mut host = running_at((0, 0), &reversed);
    host.bench.turn(1e6, -5e5);
    host.steps(5, 0.0);
    host.bench.turn(0.0, 0.0);
    let sample = *host.steps(3, 0.0).last().expect("samples");
    let (motor, load) = wires(&mut host);
    assert!(motor > 4_000 && load < -2_000, "{motor} {load}");
    assert_eq!(counts(&sample), wrapping((-motor, -load)));
}

const CHANNELS: [(Encoder, Channel); 4] = [
    (Encoder::Motor, Channel::A),
    (Encoder::Motor, Channel::B),
    (Encoder::Load, Channel::A),
    (Encoder::Load, Channel::B),
];

/// Cuts a channel while both encoders turn as at a gear of 3:1. Returns the fault, and the periods until the bridge was off.
fn cut(encoder: Encoder, channel: Channel) -> (FaultCode, Duration) {
    let mut host = Host::at(&image(), (0, 0));
    host.set_all(&[("twist_limit_rad", ParameterValue::F32(0.5))]);
    host.run();
    // 30 rad/s of the motor.
    let motor = 30.0 * 131_072.0 / std::f64::consts::TAU;
    host.bench.turn(motor, motor / 3.0);
    host.steps(10, 0.0);
    let instant = host.bench.now();
    host.bench.act(move |chip, site| site.train.cut(chip, encoder, channel));
    host.steps(40, 0.0);
    let off = host.bench.time_to_off(instant).expect("the bridge off");
    let [fault] = host.faults()[..] else { panic!("one fault") };
    (fault.code, off)
}

#[test]
fn a_lost_channel_is_noticed_within_the_twist_limit() {
    let mut lines = Vec::new();
    for (encoder, channel) in CHANNELS {
        let (fault, off) = cut(encoder, channel);
        let want = match encoder {
            Encoder::Motor => FaultCode::MotorEncoderLost,
            Encoder::Load => FaultCode::LoadEncoderLost,
        };
        assert_eq!(fault, want, "{encoder:?} {channel:?}");
        // 0.5 rad at 30 rad/s, a count, and a period.
        assert!(off <= Duration::from_micros(16_700) + MS + MS / 10, "{encoder:?} {channel:?}: {off:?}");
        let name = if encoder == Encoder::Motor { "motor" } else { "load" };
        lines.push(format!(
            "bridge off, channel {channel:?} of the {name} encoder cut at 30 rad/s, twist limit 0.5 rad: {:.1} ms",
            off.as_secs_f64() * 1e3
        ));
    }
    report::write("bridge-off-encoder", &lines);
}

/// Nothing distinguishes encoders without supply from a drive train that friction holds.
#[test]
fn encoders_lost_at_once_leave_the_torque_limit_and_the_break_wire() {
    let mut host = Host::at(&image(), (0, 0));
    host.set_all(&[
        ("twist_limit_rad", ParameterValue::F32(0.5)),
        ("torque_limit_nm", ParameterValue::F32(30.0)),
    ]);
    host.run();
    host.bench.turn(3e5, 1e5);
    host.steps(10, 0.0);
    host.bench.act(|chip, site| {
        for (encoder, channel) in CHANNELS {
            site.train.cut(chip, encoder, channel);
        }
    });
    let samples = host.steps(60, 1_000.0);
    let (_, still) = samples.split_at(10);
    assert!(still.windows(2).all(|pair| counts(&pair[0]) == counts(&pair[1])), "{still:?}");
    for sample in still {
        assert_eq!((sample.torque_nm, sample.status.flags), (30.0, TorqueFlags::SATURATED));
    }
    assert_eq!(host.faults(), []);
    assert!(host.bench.bridge().is_on());
    // The supply of the encoders opens the break wire, as the page advises.
    host.bench.act(|chip, _| chip.drive_break(None));
    assert!(!host.bench.bridge().is_on());
}
