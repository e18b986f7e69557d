//! Descriptions of laws and signals, the subscription, and telemetry.

use lashloop_firmware::Laws;
use lashloop_firmware::law::LawSet;
use lashloop_protocol::enums::{Outcome, ParameterValue, State};
use lashloop_protocol::limits::MAX_TELEMETRY_VALUES;
use lashloop_protocol::message::{
    Arm, CommandResult, DescribeLaw, DescribeSignal, EmergencyStop, Hello, Identity, Reset, Start, Stop,
    Subscribe, Telemetry,
};
use lashloop_protocol::wire::Payload;
use lashloop_protocol::{DriveMessage, Message};

use crate::host::{HELLO, Host, SESSION, torque};

/// Quarter of a turn on the load with the reducer in line, in counts of the default encoders.
const MOTOR: i64 = 3 * 32_768;
const LOAD: i64 = 32_768;

fn telemetry(answers: &[DriveMessage]) -> Option<Telemetry> {
    answers.iter().find_map(|answer| match answer {
        DriveMessage::Telemetry(telemetry) => Some(*telemetry),
        _ => None,
    })
}

/// The signals that every law with a loop has.
fn common_signals() -> u32 {
    let loops = 0b1_1111;
    let common = (0..).zip(Laws::SIGNALS).filter(|(_, signal)| signal.laws & loops == loops);
    common.map(|(index, _)| 1 << index).sum()
}

#[test]
fn the_drive_describes_its_laws() {
    let mut host = Host::new();
    let Identity { law_count, .. } = host.identity(HELLO);
    let names: Vec<String> = (0..law_count)
        .map(|index| match host.send(DescribeLaw { index })[..] {
            [DriveMessage::LawDescription(it)] if it.index == index => it.name.to_string(),
            ref other => panic!("{other:?}"),
        })
        .collect();
    assert_eq!(
        names,
        ["pd", "merzouki", "merzouki-as-printed", "backlash-inverse", "braking-curve", "open-loop"]
    );
    assert_eq!(host.command(DescribeLaw { index: law_count }), (Outcome::UnknownIndex, State::Idle));
}

#[test]
fn the_drive_describes_its_signals() {
    let mut host = Host::new();
    let Identity { signal_count, .. } = host.identity(HELLO);
    let signals: Vec<String> = (0..signal_count)
        .map(|index| match host.send(DescribeSignal { index })[..] {
            [DriveMessage::SignalDescription(it)] if it.index == index => {
                format!("{:06b} {} in {}", it.laws, it.name, it.unit)
            }
            ref other => panic!("{other:?}"),
        })
        .collect();
    let want = [
        "111111 requested_torque_nm in N m",
        "111111 measured_motor_velocity_rad_s in rad/s",
        "111111 measured_load_velocity_rad_s in rad/s",
        "111111 measured_twist_rad in rad",
        "111111 measured_torque_nm in N m",
        "111111 bridge_voltage_v in V",
        "011111 dead_zone_estimate_rad in rad",
        "011111 disturbing_torque_estimate_nm in N m",
        "011111 load_error_rad in rad",
        "011111 motor_error_rad in rad",
        "011111 elastic_error_nm in N m",
        "010000 dead_zone_deviation_rad in rad",
    ];
    assert_eq!(signals, want);
    assert_eq!(host.command(DescribeSignal { index: signal_count }), (Outcome::UnknownIndex, State::Idle));
}

#[test]
fn a_drive_sends_no_telemetry_after_power_up() {
    let mut host = Host::running(&[]);
    for sequence in 0..20 {
        assert_eq!(telemetry(&host.sample(sequence, MOTOR, LOAD)), None);
    }
}

#[test]
fn telemetry_comes_every_n_th_step_after_its_torque() {
    let mut host = Host::running(&[]);
    host.send(Subscribe { signals: 1, every: 3 });
    for sequence in 0..7 {
        let answers = host.sample(sequence, MOTOR, LOAD);
        torque(&answers);
        let want = (sequence % 3 == 0).then_some(sequence);
        assert_eq!(telemetry(&answers).map(|telemetry| telemetry.sequence), want);
    }
}

#[test]
fn values_are_in_the_order_of_the_indices() {
    let mut host = Host::running(&[("torque_limit_nm", ParameterValue::F32(1.0))]);
    host.send(Subscribe { signals: common_signals(), every: 1 });
    host.sample(0, MOTOR, LOAD);
    // The motor turns by 100 counts a millisecond, 4.794 rad/s, of which the filter of 400 rad/s passes 1 - e^-0.4.
    let answers = host.sample(1, MOTOR + 100, LOAD);
    let values = telemetry(&answers).expect("telemetry of every step").values;
    let velocity_rad_s = 100.0 * std::f32::consts::TAU / 131_072.0 / 1e-3 * (1.0 - (-0.4_f32).exp());
    let twist_rad = 100.0 * std::f32::consts::TAU / 131_072.0;
    let quarter_turn = std::f32::consts::FRAC_PI_2;
    // theta_e - theta_e_d, with theta_e_d = -10 e_s.
    let motor_error_rad = 13.0 * quarter_turn + twist_rad;
    let requested_nm = -twist_rad - 0.01 * velocity_rad_s - motor_error_rad;
    // Between the steps the limit was the torque, and no bridge made it.
    let of_drive = [requested_nm, velocity_rad_s, 0.0, twist_rad, -1.0, 0.0];
    let of_law = [0.16, 0.0, quarter_turn, motor_error_rad, twist_rad];
    let want = [&of_drive[..], &of_law].concat();
    assert_eq!(values.as_slice().len(), want.len());
    for ((value, want), signal) in values.as_slice().iter().zip(want).zip(Laws::SIGNALS) {
        assert!((value - want).abs() < 1e-3, "{}: have {value}, want {want}", signal.name);
    }
    assert_eq!(torque(&answers).torque_nm, -1.0, "the requested torque is that before the limit");
}

#[test]
fn a_subscription_of_some_signals_carries_these_only() {
    let mut host = Host::running(&[]);
    let signals = <Host>::signal("load_error_rad") | <Host>::signal("dead_zone_estimate_rad");
    host.send(Subscribe { signals, every: 1 });
    let values = telemetry(&host.sample(0, MOTOR, LOAD)).expect("telemetry").values;
    let [estimate, error] = *values.as_slice() else { panic!("{values:?}") };
    assert_eq!(estimate, 0.16);
    assert!((error - std::f32::consts::FRAC_PI_2).abs() < 1e-4, "{error} rad");
}

#[test]
fn six_signals_take_a_frame_of_33_bytes() {
    let mut host = Host::running(&[]);
    host.send(Subscribe { signals: 0b11_1111, every: 1 });
    let message = DriveMessage::from(telemetry(&host.sample(0, MOTOR, LOAD)).expect("telemetry"));
    assert_eq!(message.frame().len(), 33);
}

#[test]
fn a_subscription_without_signals_or_rate_ends_telemetry() {
    for ending in [Subscribe { signals: 0, every: 1 }, Subscribe { signals: 1, every: 0 }] {
        let mut host = Host::running(&[]);
        host.send(Subscribe { signals: 1, every: 1 });
        assert!(telemetry(&host.sample(0, MOTOR, LOAD)).is_some());
        assert_eq!(host.command(ending), (Outcome::Accepted, State::Running));
        assert_eq!(telemetry(&host.sample(1, MOTOR, LOAD)), None, "{ending:?}");
    }
}

#[test]
fn a_subscription_lasts_until_reset() {
    let start = |host: &mut Host| {
        host.send(Arm { session: SESSION });
        host.send(Start { session: SESSION });
    };
    let mut host = Host::idle();
    host.send(Subscribe { signals: 1, every: 1 });
    for _ in 0..2 {
        start(&mut host);
        assert!(telemetry(&host.sample(0, 0, 0)).is_some(), "of every run");
        host.send(Stop {});
    }
    host.send(Hello { session: SESSION + 1, ..HELLO });
    host.send(HELLO);
    start(&mut host);
    assert!(telemetry(&host.sample(0, 0, 0)).is_some(), "of every session");
    host.send(Reset {});
    host.send(HELLO);
    start(&mut host);
    assert_eq!(telemetry(&host.sample(0, 0, 0)), None);
}

#[test]
fn a_drive_takes_a_subscription_in_idle_armed_and_running_only() {
    let mut armed = Host::idle();
    armed.send(Arm { session: SESSION });
    let mut faulted = Host::idle();
    faulted.send(EmergencyStop {});
    for (mut host, want) in [
        (Host::new(), (Outcome::WrongState, State::Boot)),
        (Host::idle(), (Outcome::Accepted, State::Idle)),
        (armed, (Outcome::Accepted, State::Armed)),
        (Host::running(&[]), (Outcome::Accepted, State::Running)),
        (faulted, (Outcome::WrongState, State::Faulted)),
    ] {
        let [DriveMessage::CommandResult(result)] = host.send(Subscribe { signals: 1, every: 1 })[..] else {
            panic!("the answer is one result")
        };
        let (outcome, state) = want;
        let request = Subscribe::LAYOUT.kind;
        let want = CommandResult { request, outcome, state, detail: 0, device_time_us: Some(0) };
        assert_eq!(result, want);
    }
}

#[test]
fn a_bit_without_a_signal_is_rejected_and_changes_nothing() {
    let mut host = Host::running(&[]);
    host.send(Subscribe { signals: 1, every: 1 });
    for signals in [1 << Laws::SIGNALS.len(), 1 << 31, u32::MAX] {
        let outcome = host.command(Subscribe { signals, every: 5 });
        assert_eq!(outcome, (Outcome::UnknownIndex, State::Running), "{signals:#x}");
    }
    let values = telemetry(&host.sample(0, MOTOR, LOAD)).expect("the subscription before it").values;
    assert_eq!(values.as_slice().len(), 1);
}

/// Laws with more signals than a frame holds, and with signals that not every law has.
mod other_laws {
    use lashloop_firmware::law::{ControlLaw, ControlOutput, DriveParameters, Measurement, ParameterError};

    lashloop_firmware::signals! {
        pub struct Many {
            a: "", b: "", c: "", d: "", e: "", f: "", g: "", h: "", i: "", j: "", k: "", l: "", m: "",
        }
    }

    lashloop_firmware::signals! {
        pub struct Few { n: "rad", a: "" }
    }

    pub struct ManySignals;

    impl ControlLaw for ManySignals {
        const NAME: &'static str = "many";
        type Parameters = ();
        type Signals = Many;

        fn new((): (), _drive: &DriveParameters) -> Result<Self, ParameterError> {
            Ok(Self)
        }

        fn step(&mut self, _: &Measurement<f32>) -> ControlOutput<Many> {
            let [a, b, c, d, e, f, g] = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];
            let [h, i, j, k, l, m] = [8.0, 9.0, 10.0, 11.0, 12.0, 13.0];
            ControlOutput { torque_nm: 0.5, signals: Many { a, b, c, d, e, f, g, h, i, j, k, l, m } }
        }
    }

    pub struct FewSignals;

    impl ControlLaw for FewSignals {
        const NAME: &'static str = "few";
        type Parameters = ();
        type Signals = Few;

        fn new((): (), _drive: &DriveParameters) -> Result<Self, ParameterError> {
            Ok(Self)
        }

        fn step(&mut self, _: &Measurement<f32>) -> ControlOutput<Few> {
            ControlOutput { torque_nm: 0.25, signals: Few { n: -1.0, a: -2.0 } }
        }
    }

    lashloop_firmware::laws! {
        pub enum OtherLaws { Many(ManySignals), Few(FewSignals) }
    }
}

use other_laws::OtherLaws;

#[test]
fn thirteen_signals_fit_a_frame_and_fourteen_are_rejected() {
    let mut host = Host::<OtherLaws>::running_with(&[]);
    // Those of the law, without the six of the drive.
    let of_law = 0b1_1111_1111_1111 << 6;
    assert_eq!(host.command(Subscribe { signals: of_law, every: 1 }), (Outcome::Accepted, State::Running));
    let values = telemetry(&host.sample(0, 0, 0)).expect("telemetry").values;
    assert_eq!(values.as_slice().len(), MAX_TELEMETRY_VALUES);
    assert_eq!((values.as_slice()[0], values.as_slice()[12]), (1.0, 13.0));
    let outcome = host.command(Subscribe { signals: of_law | 1, every: 1 });
    assert_eq!(outcome, (Outcome::OutOfRange, State::Running));
}

#[test]
fn laws_may_have_signals_of_one_name_at_different_places() {
    let few = [("controller", ParameterValue::U32(1))];
    let mut host = Host::<OtherLaws>::running_with(&few);
    let signals = Host::<OtherLaws>::signal("a") | Host::<OtherLaws>::signal("n");
    assert_eq!(host.command(Subscribe { signals, every: 1 }), (Outcome::Accepted, State::Running));
    let values = telemetry(&host.sample(0, 0, 0)).expect("telemetry").values;
    // `a` was declared first, by the other law.
    assert_eq!(values.as_slice(), [-2.0, -1.0]);
}

#[test]
fn a_signal_of_another_law_is_rejected_in_armed_and_running() {
    let n = Subscribe { signals: Host::<OtherLaws>::signal("n"), every: 1 };
    let mut armed = Host::<OtherLaws>::in_session();
    armed.send(Arm { session: SESSION });
    let running = Host::<OtherLaws>::running_with(&[]);
    for (mut host, state) in [(armed, State::Armed), (running, State::Running)] {
        assert_eq!(host.refusal(n), (Outcome::SignalOfOtherLaw, n.signals.trailing_zeros(), state));
        let without_rate = Subscribe { every: 0, ..n };
        assert_eq!(host.refusal(without_rate).0, Outcome::SignalOfOtherLaw);
    }
}

#[test]
fn a_signal_of_another_law_is_accepted_in_idle_and_checked_by_arm() {
    let mut host = Host::<OtherLaws>::in_session();
    let n = Subscribe { signals: Host::<OtherLaws>::signal("n"), every: 1 };
    assert_eq!(host.command(n), (Outcome::Accepted, State::Idle));
    let refusal = host.refusal(Arm { session: SESSION });
    assert_eq!(refusal, (Outcome::SignalOfOtherLaw, n.signals.trailing_zeros(), State::Idle));
    host.set("controller", ParameterValue::U32(1));
    assert_eq!(host.command(Arm { session: SESSION }), (Outcome::Accepted, State::Armed));
}

#[test]
fn a_subscription_without_a_rate_does_not_keep_a_drive_from_arming() {
    let mut host = Host::<OtherLaws>::in_session();
    host.command(Subscribe { signals: Host::<OtherLaws>::signal("n"), every: 0 });
    assert_eq!(host.command(Arm { session: SESSION }), (Outcome::Accepted, State::Armed));
    assert_eq!(host.command(Start { session: SESSION }), (Outcome::Accepted, State::Running));
    assert_eq!(telemetry(&host.sample(0, 0, 0)), None);
}
