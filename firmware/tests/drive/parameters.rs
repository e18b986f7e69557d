//! Parameters over the wire.

use std::fmt::Write;

use lashloop_firmware::drive::parameters::TABLE;
use lashloop_protocol::DriveMessage;
use lashloop_protocol::enums::{Outcome, ParameterValue, State};
use lashloop_protocol::message::{Arm, DescribeParameter, GetParameter, SetParameter};

use crate::host::{Host, SESSION};

#[test]
fn the_drive_describes_its_parameters() {
    let mut host = Host::idle();
    let mut table = String::new();
    for index in 0..TABLE.len() as u8 {
        match host.say(DescribeParameter { index })[..] {
            [DriveMessage::ParameterDescription(it)] => {
                let live = if it.live == 1 { "live" } else { "" };
                let _ = writeln!(
                    table,
                    "{index:>2} {:<26} {:<10} {:?} in {} ..= {} {live}",
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
fn names_and_units_reach_the_host_uncut_and_defaults_are_in_range() {
    let mut host = Host::idle();
    for (index, entry) in TABLE.iter().enumerate() {
        match host.say(DescribeParameter { index: index as u8 })[..] {
            [DriveMessage::ParameterDescription(it)] => {
                assert_eq!((it.name.as_str(), it.unit.as_str()), (entry.name, entry.unit));
            }
            ref other => panic!("{other:?}"),
        }
        for value in [entry.default, entry.min, entry.max] {
            let report = host.set(entry.name, value);
            assert_eq!((report.outcome, report.value), (Outcome::Accepted, value), "{}", entry.name);
        }
    }
}

#[test]
fn a_value_outside_its_range_is_rejected_and_changes_nothing() {
    let mut host = Host::idle();
    for entry in TABLE {
        for value in outside(entry.min, entry.max) {
            let report = host.set(entry.name, value);
            assert_eq!(
                (report.outcome, report.value),
                (Outcome::OutOfRange, entry.default),
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
fn a_value_of_the_wrong_type_is_refused() {
    let report = Host::idle().set("torque_limit_nm", ParameterValue::U32(5));
    assert_eq!((report.outcome, report.value), (Outcome::WrongType, ParameterValue::F32(20.0)));
}

#[test]
fn an_unknown_index_is_refused() {
    let mut host = Host::idle();
    let index = TABLE.len() as u8;
    let value = ParameterValue::U32(0);
    for answers in [
        host.say(DescribeParameter { index }),
        host.say(GetParameter { index: 255 }),
        host.say(SetParameter { index, value }),
    ] {
        assert!(
            matches!(answers[..], [DriveMessage::ParameterReport(r)] if r.outcome == Outcome::UnknownParameter),
            "{answers:?}"
        );
    }
}

#[test]
fn while_running_only_live_parameters_can_be_set() {
    let mut host = Host::running(&[]);
    let refused = host.set("k_p1", ParameterValue::F32(2.0));
    assert_eq!((refused.outcome, refused.state), (Outcome::WrongState, State::Running));
    assert_eq!(refused.value, ParameterValue::F32(1.0));
    assert_eq!(host.set("telemetry_every", ParameterValue::U32(1)).outcome, Outcome::Accepted);
}

#[test]
fn before_the_greeting_nothing_can_be_set() {
    let mut host = Host::new();
    assert_eq!(host.set("k_p1", ParameterValue::F32(2.0)).outcome, Outcome::WrongState);
}

#[test]
fn parameters_of_the_compensating_law_that_do_not_go_together_are_named_when_arming() {
    let mut host = Host::idle();
    host.set("controller", ParameterValue::U32(4));
    // Each in its range; but what a held torque damps in 20 ms is more than this motor's momentum.
    host.set("period_us", ParameterValue::U32(20_000));
    host.set("twist_damping_nm_s_rad", ParameterValue::F32(0.06));
    let answers = host.say(Arm { session: SESSION });
    let texts: Vec<_> = answers
        .iter()
        .filter_map(|answer| match answer {
            DriveMessage::Log(log) => Some(log.text.as_str()),
            _ => None,
        })
        .collect();
    assert_eq!(texts, ["twist_damping_nm_s_rad does not go with the others"]);
    assert_eq!(host.command(Arm { session: SESSION }), (Outcome::Inconsistent, State::Idle));
    host.set("twist_damping_nm_s_rad", ParameterValue::F32(0.04));
    assert_eq!(host.command(Arm { session: SESSION }), (Outcome::Accepted, State::Armed));
}
