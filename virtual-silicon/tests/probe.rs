//! The probe on virtual silicon: pins in both directions, and the bridge after every failure.

use std::ops::ControlFlow;
use std::path::Path;
use std::time::{Duration, Instant};

use lashloop_plant::{Plant, Plants, Release, Start};
use lashloop_silicon::boards;
use lashloop_silicon::drive_train::{DriveTrain, Scales};
use lashloop_silicon::machine::{self, Ended};
use lashloop_silicon::pins::{Bridge, Pins};
use lashloop_silicon::quadrature::{Channel, Edge, Quadrature};
use lashloop_silicon::surroundings::{End, Surroundings};
use lashloop_silicon::symbols::Symbols;
use lashloop_silicon::wiring::{Encoder, Wiring};

const MS: Duration = Duration::from_millis(1);

fn probe() -> Symbols {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/silicon-probe.elf");
    Symbols::read(&path).expect("`cargo xtask test chip` builds the probe")
}

fn wiring() -> Wiring {
    boards::open(boards::DEFAULT).expect("the board")
}

fn variable(name: &str) -> u64 {
    probe().variable(name).expect("a variable of the probe")
}

/// Surroundings made of a closure. It returns the time to the next turn; `None` ends the run.
struct Script<F> {
    turn: F,
    bridge: Vec<(Duration, Bridge)>,
}

impl<F: FnMut(&mut Pins<'_>) -> Option<Duration> + Send> Surroundings for Script<F> {
    fn turn(&mut self, chip: &mut Pins<'_>) -> ControlFlow<End, Duration> {
        match (self.turn)(chip) {
            Some(wait) => ControlFlow::Continue(chip.now() + wait),
            None => ControlFlow::Break(End::Done),
        }
    }

    fn watches_bridge(&self) -> bool {
        true
    }

    fn bridge_changed(&mut self, at: Duration, bridge: Bridge) {
        self.bridge.push((at, bridge));
    }
}

fn run<F>(image: &Symbols, turn: F) -> Ended<Script<F>>
where
    F: FnMut(&mut Pins<'_>) -> Option<Duration> + Send + 'static,
{
    let script = Script { turn, bridge: Vec::new() };
    machine::run(image.image().expect("an image"), wiring(), script).expect("a run")
}

fn signed(chip: &mut Pins<'_>, address: u64) -> i32 {
    chip.word(address).expect("memory").cast_signed()
}

#[test]
fn the_crystal_starts_the_clock_and_every_pin_is_connected() {
    let ticks = variable("TICKS");
    let ended = run(&probe(), move |chip| {
        if chip.now() < 100 * MS {
            return Some(100 * MS - chip.now());
        }
        // The probe drives one output, and captures no index.
        let others =
            ["PA9", "PB13", "PB14"].map(|pin| format!("{pin} as alternate function 1 with a pull-down"));
        let indices = ["PC8", "PB8"].map(|pin| format!("{pin} as alternate function 2 with a pull-up"));
        assert_eq!(chip.unconnected(), [&indices[..], &others].concat());
        // 1 ms is that of the crystal: the oscillator inside the chip is not exact, and the tick would come late.
        let ticks = chip.word(ticks).expect("memory");
        assert!((95..=100).contains(&ticks), "{ticks} ticks of 1 ms in 100 ms");
        None
    });
    assert_eq!((ended.end, ended.violations.to_string(), ended.resets), (Some(End::Done), String::new(), 0));
    let (_, started) = ended.surroundings.bridge.last().expect("a bridge");
    assert_eq!(
        *started,
        Bridge {
            duty: Some(0.5),
            channels: [Some(0.5), None],
            is_enabled: true,
            has_main_output: true,
            has_active_gate: true
        }
    );
}

#[test]
fn counts_follow_in_both_directions_through_every_wrap() {
    // Beyond both ends of a 16-bit timer, and back.
    const TURNS: [i64; 4] = [70_000, -70_000, 140_000, 0];
    let (motor_at, load_at) = (variable("MOTOR"), variable("LOAD"));
    let (mut motor, mut load) = (Quadrature::default(), Quadrature::default());
    let mut turns = TURNS.into_iter();
    let mut target = 0;
    let mut settle = 0;
    let ended = run(&probe(), move |chip| {
        if chip.now() < 20 * MS {
            chip.set_encoder(Encoder::Motor, motor);
            chip.set_encoder(Encoder::Load, load);
            return Some(MS);
        }
        if let Some(edge) = motor.step_towards(target) {
            chip.drive_encoder(Encoder::Motor, edge);
            // The load turns the other way.
            let edge = load.step_towards(-motor.count()).expect("a count of the load");
            chip.drive_encoder(Encoder::Load, edge);
            settle = 3;
            return Some(Duration::from_nanos(1_000));
        }
        if settle > 0 {
            settle -= 1;
            return Some(MS);
        }
        assert_eq!(i64::from(signed(chip, motor_at)), target, "motor");
        assert_eq!(i64::from(signed(chip, load_at)), -target, "load");
        target = turns.next()?;
        Some(Duration::from_nanos(1))
    });
    assert_eq!((ended.end, ended.violations.to_string()), (Some(End::Done), String::new()));
}

#[test]
fn a_cut_channel_counts_to_and_fro() {
    let motor_at = variable("MOTOR");
    let mut motor = Quadrature::default();
    let ended = run(&probe(), move |chip| {
        if chip.now() < 20 * MS {
            return Some(MS);
        }
        match motor.step_towards(4_000) {
            Some(Edge { channel: Channel::B, .. }) => Some(Duration::from_nanos(500)),
            Some(edge) => {
                chip.drive_encoder(Encoder::Motor, edge);
                Some(Duration::from_nanos(500))
            }
            None if chip.now() < 40 * MS => Some(MS),
            None => {
                let counted = signed(chip, motor_at);
                assert!(counted.abs() <= 1, "{counted} counts with channel B cut");
                None
            }
        }
    });
    assert_eq!(ended.end, Some(End::Done));
}

#[test]
fn the_duty_follows_the_effort_and_stays_within_its_limits() {
    let reference = variable("REFERENCE");
    let mut cases = [(0, 0.5), (840, 0.55), (-1680, 0.4), (100_000, 0.5 + 4_000.0 / 8_400.0)].into_iter();
    let mut want: Option<f64> = None;
    let ended = run(&probe(), move |chip| {
        if chip.now() < 20 * MS {
            return Some(MS);
        }
        if let Some(want) = want {
            let duty = chip.bridge().duty.expect("a pulse");
            assert!((duty - want).abs() < 1e-4, "duty {duty}, want {want}");
        }
        let (position, duty) = cases.next()?;
        chip.set_word(reference, i32::cast_unsigned(position)).expect("memory");
        want = Some(duty);
        Some(3 * MS)
    });
    assert_eq!(ended.end, Some(End::Done));
}

/// Device time of a failure: within a period of the tick.
const FAILURE_AT: Duration = Duration::from_micros(50_300);

/// Device time from the failure to the bridge off; `None` if it is still on 20 ms later.
fn time_to_off(image: &Symbols, mut fail: impl FnMut(&mut Pins<'_>) + Send + 'static) -> Option<Duration> {
    let mut has_failed = false;
    let ended = run(image, move |chip| {
        if chip.now() < FAILURE_AT {
            return Some(FAILURE_AT - chip.now());
        }
        if has_failed {
            return None;
        }
        has_failed = true;
        fail(chip);
        Some(20 * MS)
    });
    assert_eq!(ended.violations.to_string(), "");
    let changes = ended.surroundings.bridge;
    let is_on = Bridge::is_on;
    let before = changes.iter().rfind(|(at, _)| *at < FAILURE_AT).expect("a bridge");
    assert!(is_on(&before.1), "on before the failure");
    let off = changes.iter().find(|(at, bridge)| *at >= FAILURE_AT && !is_on(bridge))?;
    assert!(
        changes.iter().skip_while(|change| *change != off).all(|(_, bridge)| !is_on(bridge)),
        "off for good"
    );
    Some(off.0 - FAILURE_AT)
}

fn request(code: u32) -> impl FnMut(&mut Pins<'_>) + Send + 'static {
    let address = variable("REQUEST");
    move |chip| chip.set_word(address, code).expect("memory")
}

#[test]
fn every_failure_turns_the_bridge_off_within_a_period() {
    for (name, code) in [("panic", 1), ("undefined instruction", 2), ("unexpected interrupt", 3)] {
        let off =
            time_to_off(&probe(), request(code)).unwrap_or_else(|| panic!("{name}: the bridge stays on"));
        println!("{name}: bridge off after {:.1} us", off.as_secs_f64() * 1e6);
        // The request waits for a tick, and the bridge goes off in it.
        assert!(off <= MS, "{name}: {off:?}");
    }
}

#[test]
fn the_break_input_turns_the_output_off_without_software() {
    let off = time_to_off(&probe(), |chip| chip.drive_break(Some(true))).expect("the bridge off");
    assert_eq!(off, Duration::ZERO, "by hardware");
}

#[test]
fn handlers_that_leave_the_bridge_on_are_noticed() {
    let careless = probe().without("turn_bridge_off").expect("the function");
    for code in [1, 2, 3] {
        assert_eq!(time_to_off(&careless, request(code)), None, "request {code}");
    }
    // The break is hardware and works all the same.
    assert_eq!(time_to_off(&careless, |chip| chip.drive_break(Some(true))), Some(Duration::ZERO));
}

#[test]
fn an_access_that_the_chip_does_not_serve_ends_the_run() {
    for (code, want) in [(4, "unmapped at=0x40030000"), (5, "TIM6")] {
        let mut ask = request(code);
        let ended = run(&probe(), move |chip| {
            if chip.now() > 20 * MS {
                ask(chip);
            }
            (chip.now() < 100 * MS).then_some(5 * MS)
        });
        assert_eq!(ended.end, None, "request {code}");
        let violations = ended.violations.to_string();
        assert!(violations.contains(want), "{violations}");
    }
}

/// A plant of the project behind the pins, and what the probe has counted of it.
struct Positioning {
    train: DriveTrain,
    reference: u64,
    motor: u64,
    load: u64,
    /// Counts of motor and load: those of the encoders, then those of the probe.
    counts: [(i64, i64); 2],
}

impl Surroundings for Positioning {
    fn turn(&mut self, chip: &mut Pins<'_>) -> ControlFlow<End, Duration> {
        if chip.now() > 20 * MS {
            chip.set_word(self.reference, 2_000).expect("memory");
        }
        if chip.now() > 2_000 * MS {
            let counted = (signed(chip, self.motor).into(), signed(chip, self.load).into());
            self.counts = [(self.train.count(Encoder::Motor), self.train.count(Encoder::Load)), counted];
            return ControlFlow::Break(End::Done);
        }
        ControlFlow::Continue(self.train.turn(chip).expect("the plant"))
    }
}

#[test]
fn a_plant_between_bridge_and_encoders_is_positioned() {
    let plants = Plants::standard();
    let model = plants.get("smooth").expect("the plant model");
    let release = Release {
        values: &model.defaults(),
        start: Start::at_rest(0.0, 0.0),
        period_s: 1e-3,
        folder: Path::new(""),
    };
    let plant: Box<dyn Plant> = model.release(&release).expect("a plant");
    let scales =
        Scales { nm_per_full_duty: 100.0, motor_counts_per_rev: 4_096.0, load_counts_per_rev: 4_096.0 };
    let surroundings = Positioning {
        train: DriveTrain::new(plant, scales),
        reference: variable("REFERENCE"),
        motor: variable("MOTOR"),
        load: variable("LOAD"),
        counts: [(0, 0); 2],
    };
    let started = Instant::now();
    let ended = machine::run(probe().image().expect("an image"), wiring(), surroundings).expect("a run");
    println!("{:?} of device time in {:?}", ended.device_time, started.elapsed());
    assert_eq!((ended.end, ended.violations.to_string()), (Some(End::Done), String::new()));
    let [of_encoders, of_probe] = ended.surroundings.counts;
    println!("motor and load at {of_encoders:?} counts, the probe has counted {of_probe:?}");
    assert!((of_encoders.0 - 2_000).abs() < 300, "motor at {} of 2000 counts", of_encoders.0);
    assert!(of_encoders.1 > 100, "the load follows: {}", of_encoders.1);
    // The probe's counts are those of its last tick.
    assert!((of_encoders.0 - of_probe.0).abs() <= 5 && (of_encoders.1 - of_probe.1).abs() <= 5);
}
