//! Live parameters: values that the law takes while the drive is armed or running.

use lashloop_firmware::Laws;
use lashloop_firmware::law::LawSet;
use lashloop_protocol::DriveMessage;
use lashloop_protocol::enums::{Outcome, ParameterFlags, ParameterValue, State};
use lashloop_protocol::message::{Arm, DescribeParameter, Reset, Start, Stop};

use crate::host::{HELLO, Host, SESSION, torque};
use crate::pin_host::PinHost;

const GAINS: [&str; 5] = ["k_p1", "k_d1", "k_p2", "k_d2", "k_1"];

/// Quarter of a turn on the load with the reducer in line, in counts of the default encoders.
const MOTOR: i64 = 3 * 32_768;
const LOAD: i64 = 32_768;

fn law(index: u32) -> (&'static str, ParameterValue) {
    ("controller", ParameterValue::U32(index))
}

/// Twist, velocities and a load error, so that every gain has a part in the torque.
fn moving<L: LawSet>(host: &mut Host<L>, sequence: u16) -> f32 {
    let step = i64::from(sequence);
    torque(&host.sample(sequence, MOTOR + 9_000 + 60 * step, LOAD + 40 * step)).torque_nm
}

#[test]
fn the_gains_of_the_cascade_are_live_and_nothing_else() {
    let mut host = Host::idle();
    for (entry, index) in Laws::PARAMETERS.iter().zip(0..) {
        let [DriveMessage::ParameterDescription(it)] = host.send(DescribeParameter { index })[..] else {
            panic!("a description")
        };
        let is_live = GAINS.contains(&entry.name);
        assert_eq!(it.flags.contains(ParameterFlags::LIVE), is_live, "{}", entry.name);
    }
}

#[test]
fn a_live_gain_acts_from_the_next_step_on() {
    let limit = ("torque_limit_nm", ParameterValue::F32(1000.0));
    for (index, name) in GAINS.iter().flat_map(|name| [0, 1, 2].map(|index| (index, *name))) {
        let settings = [law(index), limit];
        let [mut changed, mut same] = [&settings, &settings].map(|settings| Host::running(settings));
        // With the value from the start, but for the state.
        let value = ParameterValue::F32(0.75);
        let mut from_start = Host::running(&[law(index), limit, (name, value)]);
        for sequence in 0..3 {
            assert_eq!(moving(&mut changed, sequence), moving(&mut same, sequence));
            moving(&mut from_start, sequence);
        }
        let report = changed.set(name, value);
        assert_eq!((report.outcome, report.value, report.state), (Outcome::Accepted, value, State::Running));
        assert_eq!(changed.drive.torque_nm(), same.drive.torque_nm(), "the held torque stays");
        let [after, before, wanted] = [&mut changed, &mut same, &mut from_start].map(|it| moving(it, 3));
        assert_ne!(after, before, "law {index}, {name}");
        if index == 0 {
            assert_eq!(after.to_bits(), wanted.to_bits(), "the law has no state: {name}");
        }
    }
}

#[test]
fn a_gain_set_while_armed_is_that_of_the_run() {
    let value = ParameterValue::F32(0.5);
    let mut host = Host::idle();
    host.send(Arm { session: SESSION });
    assert_eq!(host.set("k_p1", value).outcome, Outcome::Accepted);
    host.send(Start { session: SESSION });
    let mut want = Host::running(&[("k_p1", value)]);
    assert_eq!(moving(&mut host, 0).to_bits(), moving(&mut want, 0).to_bits());
}

#[test]
fn a_gain_stays_for_the_next_run_and_a_reset_restores_its_default() {
    let mut host = Host::running(&[]);
    host.set("k_p1", ParameterValue::F32(0.5));
    host.send(Stop {});
    let session = SESSION;
    host.send(Arm { session });
    host.send(Start { session });
    let kept = moving(&mut host, 0);
    host.send(Reset {});
    host.send(HELLO);
    host.send(Arm { session });
    host.send(Start { session });
    assert_ne!(moving(&mut host, 0), kept);
}

#[test]
fn type_and_range_of_a_live_value_are_checked_while_running() {
    let mut host = Host::running(&[]);
    let in_force = ParameterValue::F32(1.0);
    for (value, outcome) in [
        (ParameterValue::U32(1), Outcome::WrongType),
        (ParameterValue::F32(-1.0), Outcome::OutOfRange),
        (ParameterValue::F32(f32::NAN), Outcome::OutOfRange),
    ] {
        let report = host.set("k_p1", value);
        assert_eq!((report.outcome, report.value, report.detail), (outcome, in_force, 0));
    }
}

#[test]
fn no_live_value_is_taken_in_boot_and_faulted() {
    let mut faulted = Host::running(&[]);
    faulted.send(lashloop_protocol::message::EmergencyStop {});
    for mut host in [Host::new(), faulted] {
        assert_eq!(host.set("k_p1", ParameterValue::F32(2.0)).outcome, Outcome::WrongState);
    }
}

#[test]
fn a_live_gain_acts_in_bench_mode_too() {
    let mut host = PinHost::under_torque();
    let before = host.step().torque_nm;
    let report = host.set("k_p1", ParameterValue::F32(0.5));
    assert_eq!((report.outcome, report.state), (Outcome::Accepted, State::Running));
    assert_ne!(host.step().torque_nm, before);
    assert_eq!(host.set("duty_max", ParameterValue::F32(0.8)).outcome, Outcome::WrongState);
}

/// Laws with a live parameter that has to go with another one.
mod other_laws {
    use lashloop_firmware::law::{ControlLaw, ControlOutput, DriveParameters, Measurement, ParameterError};

    lashloop_firmware::parameters! {
        pub struct Ends {
            lower_nm: F32 = 1.0 in 0.0..=9.0, "N m";
            upper_nm: F32 = 2.0 in 0.0..=9.0, "N m";
        }
    }

    lashloop_firmware::parameters! {
        pub struct Shared { shared_nm: F32 = 1.0 in 0.0..=9.0, "N m"; }
    }

    impl Ends {
        fn check(&self) -> Result<(), ParameterError> {
            ParameterError::at_most("lower_nm", self.lower_nm, self.upper_nm, "upper_nm")
        }
    }

    /// The sum of its parameters as a torque.
    pub struct Between(Ends, Shared);

    impl ControlLaw for Between {
        const NAME: &'static str = "between";
        type Parameters = (Ends, Shared);
        type Signals = ();
        const LIVE: &'static [&'static str] = &["lower_nm", "upper_nm", "shared_nm"];

        fn new((ends, shared): Self::Parameters, _: &DriveParameters) -> Result<Self, ParameterError> {
            ends.check()?;
            Ok(Self(ends, shared))
        }

        fn update(&mut self, (ends, shared): &Self::Parameters) -> Result<(), ParameterError> {
            ends.check()?;
            *self = Self(*ends, *shared);
            Ok(())
        }

        fn step(&mut self, _: &Measurement<f32>) -> ControlOutput<()> {
            let Self(ends, shared) = self;
            ControlOutput { torque_nm: ends.lower_nm + ends.upper_nm + shared.shared_nm, signals: () }
        }
    }

    /// A law that takes nothing live.
    pub struct Fixed(Shared);

    impl ControlLaw for Fixed {
        const NAME: &'static str = "fixed";
        type Parameters = Shared;
        type Signals = ();

        fn new(shared: Shared, _: &DriveParameters) -> Result<Self, ParameterError> {
            Ok(Self(shared))
        }

        fn step(&mut self, _: &Measurement<f32>) -> ControlOutput<()> {
            ControlOutput { torque_nm: self.0.shared_nm, signals: () }
        }
    }

    lashloop_firmware::laws! {
        pub enum OtherLaws { Between(Between), Fixed(Fixed) }
    }
}

use other_laws::OtherLaws;

#[test]
fn an_inconsistent_live_value_keeps_the_one_before() {
    let mut armed = Host::<OtherLaws>::in_session();
    armed.send(Arm { session: SESSION });
    for (mut host, state) in [(armed, State::Armed), (Host::<OtherLaws>::running_with(&[]), State::Running)] {
        let report = host.set("upper_nm", ParameterValue::F32(0.5));
        let index = Host::<OtherLaws>::parameter("lower_nm").into();
        assert_eq!((report.outcome, report.detail, report.state), (Outcome::Inconsistent, index, state));
        assert_eq!(report.value, ParameterValue::F32(2.0));
        host.send(Start { session: SESSION });
        assert_eq!(torque(&host.sample(0, 0, 0)).torque_nm, 4.0);
        assert_eq!(host.set("upper_nm", ParameterValue::F32(3.0)).outcome, Outcome::Accepted);
        assert_eq!(torque(&host.sample(1, 0, 0)).torque_nm, 5.0);
    }
}

#[test]
fn in_idle_a_live_value_is_checked_by_arm_as_any_other() {
    let mut host = Host::<OtherLaws>::in_session();
    assert_eq!(host.set("upper_nm", ParameterValue::F32(0.5)).outcome, Outcome::Accepted);
    let index = Host::<OtherLaws>::parameter("lower_nm").into();
    assert_eq!(host.refusal(Arm { session: SESSION }), (Outcome::Inconsistent, index, State::Idle));
}

#[test]
fn a_parameter_that_one_of_its_laws_does_not_take_live_is_not_live() {
    let live = OtherLaws::PARAMETERS.iter().filter(|it| it.live).map(|it| it.name);
    assert!(live.eq(["lower_nm", "upper_nm"]));
    let mut host = Host::<OtherLaws>::running_with(&[]);
    assert_eq!(host.set("shared_nm", ParameterValue::F32(2.0)).outcome, Outcome::WrongState);
}
