//! The rules of sequence, at their edges.

use lashloop_protocol::DriveMessage;
use lashloop_protocol::vocabulary::{Outcome, TorqueFlags};

use crate::markdown::{section, table};
use crate::talk::{Talk, refusal};

/// The sequences that a row of the document means, where 5 is the last one taken.
fn sequences(row: &[String]) -> Vec<u32> {
    const LAST: u32 = 5;
    match row[1].as_str() {
        "first" => vec![0],
        "next" => vec![LAST + 1],
        "after a gap" => {
            let largest = row[0].rsplit(' ').next().and_then(|number| number.parse::<u32>().ok());
            vec![LAST + 2, LAST + largest.expect("the row ends with the largest gap")]
        }
        "repeated" => vec![LAST],
        "stray" => {
            let gap = table(section("## 7. Samples and torques"), "sequence")
                .iter()
                .find(|row| row[1] == "after a gap")
                .and_then(|row| row[0].rsplit(' ').next()?.parse::<u32>().ok())
                .expect("the largest gap");
            vec![LAST - 1, 0, LAST + gap + 1, u32::MAX]
        }
        other => panic!("the document has a place {other:?} that this test can't make"),
    }
}

fn kind_of(answers: &[DriveMessage]) -> String {
    match answers[0] {
        DriveMessage::TorqueAnswer(answer) if answer.flags.contains(TorqueFlags::REPEATED) => {
            "the last TorqueAnswer with REPEATED".to_owned()
        }
        DriveMessage::TorqueAnswer(answer) if answer.flags.contains(TorqueFlags::GAP) => {
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
fn a_sample_is_taken_or_not_as_the_table_says() {
    for row in table(section("## 7. Samples and torques"), "sequence") {
        for sequence in sequences(&row) {
            let mut talk = Talk::running(&[]);
            if row[1] != "first" {
                (0..=5).for_each(|sequence| drop(talk.sample(sequence)));
            }
            assert_eq!(kind_of(&talk.sample(sequence)), row[2], "sequence {sequence}, {}", row[1]);
        }
    }
}

#[test]
fn the_first_sample_of_a_run_is_0_and_no_other() {
    for sequence in [1, 2, 1000, u32::MAX] {
        assert_eq!(refusal(&Talk::running(&[]).sample(sequence)), Some(Outcome::OutOfSequence));
    }
}
