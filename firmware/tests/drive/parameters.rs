//! The parameter table and its requests.

use std::fmt::Write;

use lashloop_firmware::Laws;
use lashloop_firmware::law::{LawSet, Parameter};
use lashloop_protocol::DriveMessage;
use lashloop_protocol::enums::{Outcome, ParameterFlags, ParameterType, ParameterValue, State};
use lashloop_protocol::message::{Arm, DescribeChoice, DescribeParameter, GetParameter, SetParameter};

use crate::host::{Host, SESSION};

const TABLE: &[Parameter] = Laws::PARAMETERS;

#[test]
fn the_drive_describes_its_parameters() {
    let mut host = Host::idle();
    let mut table = String::new();
    for index in 0..TABLE.len() as u8 {
        match host.send(DescribeParameter { index })[..] {
            [DriveMessage::ParameterDescription(it)] => {
                let flags = match it.flags {
                    ParameterFlags::CHOICES => "choices",
                    ParameterFlags::LIVE => "live",
                    _ => "",
                };
                let _ = writeln!(
                    table,
                    "{index:>2} {:04b} {:<27} {:<10} {:?} in {} ..= {} {flags}",
                    it.laws,
                    it.name.as_str(),
                    it.unit.as_str(),
                    it.default,
                    it.min,
                    it.max
                );
            }
            ref other => panic!("{other:?}"),
        }
    }
    insta::assert_snapshot!(table);
}

#[test]
fn names_and_units_fit_and_defaults_are_in_range() {
    let mut host = Host::idle();
    for (index, entry) in TABLE.iter().enumerate() {
        match host.send(DescribeParameter { index: index as u8 })[..] {
            [DriveMessage::ParameterDescription(it)] => {
                assert_eq!((it.name.as_str(), it.unit.as_str()), (entry.name, entry.unit));
            }
            ref other => panic!("{other:?}"),
        }
        for value in [entry.range.default(), entry.range.min(), entry.range.max()] {
            let report = host.set(entry.name, value);
            assert_eq!((report.outcome, report.value), (Outcome::Accepted, value), "{}", entry.name);
        }
    }
}

#[test]
fn a_value_outside_its_range_is_rejected_and_changes_nothing() {
    let mut host = Host::idle();
    for entry in TABLE {
        for value in outside(entry.range.min(), entry.range.max()) {
            let report = host.set(entry.name, value);
            assert_eq!(
                (report.outcome, report.value),
                (Outcome::OutOfRange, entry.range.default()),
                "{} = {value:?}",
                entry.name
            );
        }
    }
}

/// The nearest values outside a range, and those that are in no range.
fn outside(min: ParameterValue, max: ParameterValue) -> Vec<ParameterValue> {
    match (min, max) {
        (ParameterValue::U32(min), ParameterValue::U32(max)) => {
            [min.checked_sub(1), max.checked_add(1)].into_iter().flatten().map(ParameterValue::U32).collect()
        }
        (ParameterValue::F32(min), ParameterValue::F32(max)) => {
            [min.next_down(), max.next_up(), f32::NAN, f32::INFINITY, f32::NEG_INFINITY]
                .map(ParameterValue::F32)
                .to_vec()
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_value_of_the_wrong_type_is_rejected() {
    let report = Host::idle().set("torque_limit_nm", ParameterValue::U32(5));
    assert_eq!((report.outcome, report.value), (Outcome::WrongType, ParameterValue::F32(20.0)));
}

#[test]
fn a_value_of_an_unknown_type_is_of_the_wrong_type() {
    let Some(ParameterType::Unknown(ty)) = ParameterType::from_byte(77) else { panic!("no such type") };
    let report = Host::idle().set("torque_limit_nm", ParameterValue::Unknown { ty, bytes: [1, 2, 3, 4] });
    assert_eq!((report.outcome, report.value), (Outcome::WrongType, ParameterValue::F32(20.0)));
}

#[test]
fn an_unknown_index_is_rejected() {
    let mut host = Host::idle();
    let index = TABLE.len() as u8;
    let value = ParameterValue::U32(0);
    for answers in [
        host.send(DescribeParameter { index }),
        host.send(GetParameter { index: 255 }),
        host.send(SetParameter { index, value }),
    ] {
        assert!(
            matches!(answers[..], [DriveMessage::ParameterReport(r)] if r.outcome == Outcome::UnknownIndex),
            "{answers:?}"
        );
    }
}

#[test]
fn no_parameter_but_a_live_one_can_be_set_while_armed_or_running() {
    let mut armed = Host::idle();
    armed.send(Arm { session: SESSION });
    for (mut host, state) in [(armed, State::Armed), (Host::running(&[]), State::Running)] {
        for entry in TABLE.iter().filter(|entry| !entry.live) {
            let rejected = host.set(entry.name, entry.range.max());
            assert_eq!((rejected.outcome, rejected.state), (Outcome::WrongState, state), "{}", entry.name);
            assert_eq!(rejected.value, entry.range.default());
        }
    }
}

/// A parameter of choices is a `U32` of one byte, every value of which has a name.
#[test]
fn every_choice_of_a_parameter_has_a_name() {
    let mut host = Host::idle();
    let mut described = Vec::new();
    for (parameter, entry) in (0..).zip(TABLE) {
        let count = entry.range.choices().map_or(0, <[_]>::len) as u8;
        for choice in 0..count {
            match host.send(DescribeChoice { parameter, choice })[..] {
                [DriveMessage::ChoiceDescription(it)] => {
                    assert_eq!((it.parameter, it.choice), (parameter, choice));
                    described.push(format!("{} {choice} {}", entry.name, it.name));
                }
                ref other => panic!("{other:?}"),
            }
        }
        let answers = host.send(DescribeChoice { parameter, choice: count });
        assert!(
            matches!(answers[..], [DriveMessage::CommandResult(r)] if r.outcome == Outcome::UnknownIndex),
            "{}: {answers:?}",
            entry.name
        );
    }
    let want = [
        "controller 0 pd",
        "controller 1 merzouki",
        "controller 2 merzouki-as-printed",
        "controller 3 backlash-inverse",
        "controller 4 braking-curve",
        "controller 5 open-loop",
        "disturbing_torque_source 0 model",
        "disturbing_torque_source 1 observed",
    ];
    assert_eq!(described, want);
}

#[test]
fn the_source_of_the_disturbing_torque_changes_the_torque() {
    let torque_nm = |source| {
        let mut host = Host::running(&[
            ("controller", ParameterValue::U32(1)),
            ("disturbing_torque_source", ParameterValue::U32(source)),
        ]);
        host.sample(0, 20_000, 0);
        crate::host::torque(&host.sample(1, 20_000, 0)).torque_nm
    };
    assert_ne!(torque_nm(0), torque_nm(1));
}

#[test]
fn no_parameter_can_be_set_in_boot() {
    let mut host = Host::new();
    assert_eq!(host.set("k_p1", ParameterValue::F32(2.0)).outcome, Outcome::WrongState);
}

/// Each value is in its range; the last parameter set is beyond what the others allow.
#[test]
fn inconsistent_parameters_are_named_by_their_index_when_arming() {
    use ParameterValue::{F32, U32};
    let (merzouki, as_printed, inverse) = (1, 2, 3);
    let cases: [(&str, &[(&str, ParameterValue)]); 6] = [
        ("dead_zone_initial_rad", &[("controller", U32(merzouki)), ("dead_zone_max_rad", F32(0.1))]),
        ("dead_zone_initial_rad", &[("controller", U32(as_printed)), ("dead_zone_max_rad", F32(0.1))]),
        ("dead_zone_initial_rad", &[("controller", U32(inverse)), ("dead_zone_max_rad", F32(0.1))]),
        // In 20 ms a held torque damps more than the momentum of this motor.
        (
            "twist_damping_nm_s_rad",
            &[
                ("controller", U32(inverse)),
                ("period_us", U32(20_000)),
                ("twist_damping_nm_s_rad", F32(0.06)),
            ],
        ),
        (
            "load_observer_rad_s",
            &[("controller", U32(inverse)), ("period_us", U32(20_000)), ("load_observer_rad_s", F32(26.0))],
        ),
        (
            "reduction_ratio",
            &[
                ("reduction_ratio", F32(1e4)),
                ("motor_counts_per_rev", U32(1 << 24)),
                ("load_counts_per_rev", U32(4)),
            ],
        ),
    ];
    for (name, settings) in cases {
        let mut host = Host::idle();
        for (name, value) in settings {
            assert_eq!(host.set(name, *value).outcome, Outcome::Accepted, "{name}");
        }
        let index = <Host>::parameter(name).into();
        let refusal = host.refusal(Arm { session: SESSION });
        assert_eq!(refusal, (Outcome::Inconsistent, index, State::Idle), "{name}");
    }
}
