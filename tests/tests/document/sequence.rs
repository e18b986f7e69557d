//! The rules of sequence, at their edges.

use lashloop_protocol::DriveMessage;
use lashloop_protocol::enums::{Outcome, ParameterValue, TorqueFlags};

use crate::annexes::longest_gap;
use crate::host::{Host, refusal};
use crate::markdown::{section, table};

/// A speed limit at which the encoders allow the longest gap of the protocol.
const SLOW: (&str, ParameterValue) = ("motor_speed_limit_rad_s", ParameterValue::F32(100.0));

/// Sequences of a row of the document, with 5 as the last one accepted.
fn sequences(row: &[String]) -> Vec<u16> {
    const LAST: u16 = 5;
    match row[1].as_str() {
        "first" => vec![0],
        "next" => vec![LAST + 1],
        "after a gap" => {
            let largest = row[0].rsplit(' ').next().and_then(|number| number.parse::<u16>().ok());
            vec![LAST + 2, LAST + largest.expect("the row ends with the largest gap")]
        }
        "repeated" => vec![LAST],
        "stray" => {
            let gap = table(section("## 7. Samples and torques"), "sequence")
                .iter()
                .find(|row| row[1] == "after a gap")
                .and_then(|row| row[0].rsplit(' ').next()?.parse::<u16>().ok())
                .expect("the largest gap");
            vec![LAST - 1, 0, LAST + gap + 1, u16::MAX]
        }
        other => panic!("this test has no sequence for {other:?} of the document"),
    }
}

fn kind_of(answers: &[DriveMessage]) -> String {
    match answers[0] {
        DriveMessage::TorqueAnswer(answer) if answer.status.flags.contains(TorqueFlags::REPEATED) => {
            "the last TorqueAnswer with REPEATED".to_owned()
        }
        DriveMessage::TorqueAnswer(answer) if answer.status.flags.contains(TorqueFlags::GAP) => {
            "TorqueAnswer with GAP".to_owned()
        }
        DriveMessage::TorqueAnswer(_) => "TorqueAnswer".to_owned(),
        DriveMessage::CommandResult(_) => {
            format!("CommandResult with {:?}", refusal(answers).expect("a refusal"))
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn every_sequence_case_matches_the_table() {
    for row in table(section("## 7. Samples and torques"), "sequence") {
        for sequence in sequences(&row) {
            let mut host = Host::running(&[SLOW]);
            if row[1] != "first" {
                (0..=5).for_each(|sequence| drop(host.sample(sequence)));
            }
            assert_eq!(kind_of(&host.sample(sequence)), row[2], "sequence {sequence}, {}", row[1]);
        }
    }
}

#[test]
fn only_sequence_0_starts_a_run() {
    for sequence in [1, 2, 1000, u16::MAX] {
        assert_eq!(refusal(&Host::running(&[]).sample(sequence)), Some(Outcome::OutOfSequence));
    }
}

#[test]
fn the_drive_bridges_the_documented_longest_gap_and_no_longer_one() {
    let (_, longest) = longest_gap();
    let taken = |sequence| {
        let mut host = Host::running(&[]);
        host.sample(0);
        refusal(&host.sample(sequence)).is_none()
    };
    assert_eq!([longest, longest + 1].map(taken), [true, false]);
}
