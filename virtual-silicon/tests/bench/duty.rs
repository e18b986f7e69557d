//! Torque against the duty at the pins.

use std::time::Duration;

use lashloop_protocol::enums::{Outcome, ParameterValue, State, TorqueFlags};
use lashloop_protocol::message::{BenchSample, Stop};
use lashloop_silicon::pins::Bridge;

use crate::bench::{OF_EACH_FAMILY, image, image_of, odrive_image};
use crate::host::{BENCH, Host};

const OFF: Bridge = Bridge {
    duty: None,
    channels: [Some(0.0), None],
    is_enabled: false,
    has_main_output: false,
    has_active_gate: false,
};
/// Half a count of the modulation, and the nanosecond of the pulse's reading.
const RESOLUTION: f64 = 0.5 / 8_400.0 + 1.0 / 50_000.0;

/// The gains of the law `pd` make a torque for each reference while the encoders stand, two steps after a change.
fn step(host: &mut Host, reference_rad: f32) -> (BenchSample, Bridge) {
    let samples = host.steps(5, reference_rad);
    (*samples.last().expect("samples"), host.bench.bridge())
}

/// The scale of a drive with these parameters.
struct Scale {
    nm_per_full_duty: f64,
    offset: f64,
    min: f64,
    max: f64,
    sign: f64,
}

impl Scale {
    fn duty(&self, torque_nm: f32) -> f64 {
        (self.offset + self.sign * f64::from(torque_nm) / self.nm_per_full_duty).clamp(self.min, self.max)
    }
}

#[test]
fn the_duty_is_the_offset_plus_the_torque_over_its_scale() {
    let scales = [
        Scale { nm_per_full_duty: 100.0, offset: 0.5, min: 0.1, max: 0.9, sign: 1.0 },
        Scale { nm_per_full_duty: 100.0, offset: 0.5, min: 0.1, max: 0.9, sign: -1.0 },
        // Its torque limit of 20 N m just has a duty.
        Scale { nm_per_full_duty: 80.0, offset: 0.55, min: 0.3, max: 0.95, sign: 1.0 },
    ];
    let mut host = Host::idle(&image(), &[]);
    for scale in scales {
        for (name, value) in [
            ("torque_per_duty_nm", ParameterValue::F32(scale.nm_per_full_duty as f32)),
            ("duty_offset", ParameterValue::F32(scale.offset as f32)),
            ("duty_min", ParameterValue::F32(scale.min as f32)),
            ("duty_max", ParameterValue::F32(scale.max as f32)),
            ("torque_direction", ParameterValue::U32(u32::from(scale.sign < 0.0))),
        ] {
            assert_eq!(host.set(name, value), Outcome::Accepted, "{name}");
        }
        host.run();
        let mut torques = Vec::new();
        for reference_rad in [0.0, 0.01, -0.01, 0.3, -0.7, 0.05] {
            let (sample, bridge) = step(&mut host, reference_rad);
            let duty = bridge.driving().expect("the bridge is on");
            let want = scale.duty(sample.torque_nm);
            assert!((duty - want).abs() <= RESOLUTION, "{} N m: {duty}, {want}", sample.torque_nm);
            torques.push(sample.torque_nm);
        }
        assert!(torques.iter().any(|it| *it > 0.0) && torques.iter().any(|it| *it < 0.0), "{torques:?}");
        assert_eq!(host.command(Stop {}), (Outcome::Accepted, State::Idle));
    }
}

/// Outputs of a mode for a torque as a fraction of full duty: channels 1 and 2.
type Levels = fn(f64) -> [f64; 2];

/// The modes of a stage whose duty is the size of the torque, by the values of the parameter, with the levels of its inputs.
const BRIDGES: [(u32, Levels); 3] = [
    (2, |torque| [torque.abs(), if torque < 0.0 { 0.0 } else { 1.0 }]),
    (3, |torque| [torque.max(0.0), (-torque).max(0.0)]),
    (4, |torque| [1.0 - (-torque).max(0.0), 1.0 - torque.max(0.0)]),
];

#[test]
fn every_mode_of_a_bridge_drives_its_inputs_at_every_tick_and_pulls_them_low_when_off() {
    let mut host = Host::idle(&image(), &[]);
    for (mode, levels) in BRIDGES {
        for frequency_hz in [20_000, 1_000] {
            for (name, value) in [
                ("stage_mode", ParameterValue::U32(mode)),
                ("pwm_frequency_hz", ParameterValue::U32(frequency_hz)),
                ("duty_offset", ParameterValue::F32(0.0)),
                ("duty_min", ParameterValue::F32(0.0)),
                ("duty_max", ParameterValue::F32(0.95)),
            ] {
                assert_eq!(host.set(name, value), Outcome::Accepted, "{name}");
            }
            let case = format!("mode {mode} at {frequency_hz} Hz");
            host.run();
            host.bench.advance(Duration::from_micros(10));
            assert_driven(&host.bench.bridge(), levels(0.0), &case);
            let mut torques = Vec::new();
            // The last one is beyond the limit: a run that follows must not begin with its duty.
            for reference_rad in [0.0, 0.02, -0.02, 0.3, 0.05, -1_000.0] {
                // The outputs follow in the next period of the modulation, which may be as long as the tick.
                let sample = *host.steps(5, reference_rad).last().expect("samples");
                torques.push(sample.torque_nm);
                let want = levels(f64::from(sample.torque_nm) / 100.0);
                assert_driven(&host.bench.bridge(), want, &format!("{case}, {} N m", sample.torque_nm));
            }
            assert!(torques.iter().any(|it| *it > 0.0) && torques.iter().any(|it| *it < 0.0), "{torques:?}");
            let period = host.bench.act(|chip, _| chip.modulation_period()).expect("a pulse");
            let error = period.as_secs_f64() * f64::from(frequency_hz) - 1.0;
            assert!(error.abs() < 1e-4, "{case}: a period of {period:?}");
            assert_eq!(host.command(Stop {}), (Outcome::Accepted, State::Idle));
            let off = host.bench.bridge();
            assert_eq!((off.channels, off.is_on()), ([Some(0.0); 2], false), "{case}: coasts while off");
        }
    }
}

fn assert_driven(bridge: &Bridge, want: [f64; 2], case: &str) {
    assert!(bridge.is_enabled && bridge.has_main_output, "{case}: off");
    for (have, want) in bridge.channels.into_iter().zip(want) {
        let have = have.unwrap_or_else(|| panic!("{case}: an output that isn't driven"));
        assert!((have - want).abs() <= RESOLUTION, "{case}: {:?} instead of {want}", bridge.channels);
    }
}

#[test]
fn a_run_after_a_saturated_one_begins_without_torque() {
    for (mode, offset, none) in [(0, 0.5, [Some(0.5), None]), (2, 0.0, [Some(0.0), Some(1.0)])] {
        let parameters = [
            ("stage_mode", ParameterValue::U32(mode)),
            ("duty_offset", ParameterValue::F32(offset)),
            ("duty_min", ParameterValue::F32(0.0)),
        ];
        let mut host = Host::running(&image(), &parameters);
        assert_eq!(step(&mut host, 1_000.0).0.status.flags, TorqueFlags::SATURATED);
        assert_eq!(host.command(Stop {}), (Outcome::Accepted, State::Idle));
        let stopped = host.bench.now();
        host.run();
        host.bench.advance(Duration::from_millis(3));
        let bridge = host.bench.act(|_, site| site.log.bridge.clone());
        let on: Vec<_> = bridge.iter().filter(|(at, it)| *at > stopped && it.has_main_output).collect();
        assert!(!on.is_empty());
        assert!(on.iter().all(|(_, it)| it.channels == none), "mode {mode}: {on:?}");
    }
}

#[test]
fn two_half_bridges_never_conduct_at_once() {
    for board in OF_EACH_FAMILY {
        let mut host = Host::running(&image_of(board), &[("stage_mode", ParameterValue::U32(5))]);
        // 84 cycles of 168 MHz.
        let dead_time = 84.0 / 8_400.0;
        for reference_rad in [0.0, 0.2, -0.4] {
            let sample = *host.steps(3, reference_rad).last().expect("samples");
            let duty = 0.5 + f64::from(sample.torque_nm) / 100.0;
            let halves = host.bench.act(|chip, _| chip.half_bridges());
            for ([high, low], duty) in halves.into_iter().zip([duty, 1.0 - duty]) {
                let (high, low) = (high.expect("a pulse"), low.expect("a pulse"));
                assert!((high - (duty - dead_time)).abs() < 3.0 * RESOLUTION, "{high}, {duty}");
                assert!((low - (1.0 - duty - dead_time)).abs() < 3.0 * RESOLUTION, "{low}, {duty}");
            }
        }
        assert_eq!(host.command(Stop {}), (Outcome::Accepted, State::Idle));
        assert_eq!(host.bench.act(|chip, _| chip.half_bridges()), [[None; 2]; 2]);
    }
}

#[test]
fn a_mode_that_the_board_cannot_do_is_not_armed() {
    let mut host = Host::at(&odrive_image(), (0, 0));
    host.set_all(&[("stage_mode", ParameterValue::U32(2))]);
    let index = host.names().iter().position(|name| name == "stage_mode").expect("the parameter");
    assert_eq!(host.refusal_to_arm(), (Outcome::Inconsistent, index as u32));
    assert!(!host.bench.bridge().has_main_output);
    // That of the board's own.
    assert_eq!(host.set("stage_mode", ParameterValue::U32(5)), Outcome::Accepted);
    assert_eq!(host.arm(), (Outcome::Accepted, State::Armed));
}

#[test]
fn a_saturated_torque_has_the_duty_of_its_limit() {
    let mut host = Host::running(&image(), &[("torque_limit_nm", ParameterValue::F32(40.0))]);
    for (reference_rad, duty) in [(1_000.0, 0.9), (-1_000.0, 0.1)] {
        let (sample, bridge) = step(&mut host, reference_rad);
        assert_eq!((sample.torque_nm.abs(), sample.status.flags), (40.0, TorqueFlags::SATURATED));
        let have = bridge.driving().expect("the bridge is on");
        assert!((have - duty).abs() <= RESOLUTION, "{have}");
    }
}

#[test]
fn the_duty_follows_a_torque_within_two_cycles_of_the_modulation() {
    let mut host = Host::running(&image(), &[]);
    host.steps(5, 0.0);
    let before = host.bench.now();
    host.steps(2, 0.5);
    let (ticks, bridge) = host.bench.act(|_, site| (site.log.ticks.clone(), site.log.bridge.clone()));
    // The first tick after the reference of 0.14 ms.
    let tick = ticks.iter().find(|at| **at > before + Duration::from_micros(150)).expect("a tick");
    let change = bridge.iter().find(|(at, _)| at > tick).expect("another duty");
    let delay = change.0 - *tick;
    assert!(delay <= Duration::from_micros(100), "{delay:?}");
}

/// In the middle of a cycle it would make one pulse of neither torque.
#[test]
fn a_duty_changes_at_the_start_of_a_cycle() {
    const CYCLE_NS: u128 = 50_000;
    // The steps meet many phases of the cycle.
    let mut host = Host::running(&image(), &[("period_us", ParameterValue::U32(997))]);
    let begun = host.bench.now();
    for reference_rad in [0.3, -0.3].repeat(30) {
        host.steps(1, reference_rad);
    }
    let bridge = host.bench.act(|_, site| site.log.bridge.clone());
    let changes = bridge.windows(2).filter(|pair| pair[0].0 > begun && pair[0].1.duty != pair[1].1.duty);
    let phases: Vec<_> = changes.map(|pair| pair[1].0.as_nanos() % CYCLE_NS).collect();
    assert!(phases.len() >= 50, "{phases:?}");
    assert!(phases.iter().all(|phase| phase.abs_diff(phases[0]) < 100), "{phases:?}");
}

#[test]
fn the_outputs_are_low_unless_running() {
    let mut host = Host::at(&image(), (0, 0));
    assert_eq!(host.bench.bridge(), OFF, "a booted drive");
    for (name, value) in BENCH {
        host.set(name, value);
    }
    assert_eq!(host.arm(), (Outcome::Accepted, State::Armed));
    host.bench.advance(Duration::from_millis(3));
    assert_eq!(host.bench.bridge(), OFF, "an armed drive");
    host.start();
    let on = host.bench.bridge();
    let want = Bridge {
        duty: Some(0.5),
        channels: [Some(0.5), None],
        is_enabled: true,
        has_main_output: true,
        has_active_gate: true,
    };
    assert_eq!(on, want, "no torque yet");
    host.command(Stop {});
    assert_eq!(host.bench.bridge(), OFF, "a stopped drive");
    let levels = host.bench.act(|chip, _| chip.output_levels());
    assert_eq!(levels, (Some(false), false), "driven low, not open");
}
