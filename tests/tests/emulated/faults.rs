//! The table of `docs/faults.md` on the emulated board.
//!
//! Every row runs on the native twin and in process. The emulator takes about thirty times as long for a step, so of rows
//! that show the same of the board one runs here:
//!
//! - A fault of line or device, or one that the drive detects: a row for each kind, detection and reaction.
//! - A fault that the drive doesn't detect and that reaches it in the numbers of its samples alone, so that its answers are
//!   those of any other run: a row for each part of the bench that the fault strikes. The torques of whole runs are compared
//!   bit for bit in [`runs`](crate::runs).

use std::collections::HashSet;

use tests::fault_table::{self, Row};

/// What a row shows of the board.
#[derive(PartialEq, Eq, Hash)]
enum Shown {
    Reaction { kind: String, detected_by: Vec<String>, reaction: String },
    OtherSamples { struck: String },
}

/// The rows that run here, each with its number in the table.
pub(crate) fn rows() -> Vec<(usize, Row)> {
    let mut shown = HashSet::new();
    let numbered = (1..).zip(fault_table::rows());
    numbered.filter(|(_, row)| shown.insert(shown_by(row))).collect()
}

fn shown_by(row: &Row) -> Shown {
    let struck = match row.kind().split_once('-') {
        Some((part @ ("link" | "device" | "encoder" | "torque"), _)) => part,
        _ => "plant",
    };
    let by_the_result = row.detected_by.iter().all(|by| by == "undetected" || by.starts_with("verdict "));
    if by_the_result && !matches!(struck, "link" | "device") {
        return Shown::OtherSamples { struck: struck.to_owned() };
    }
    Shown::Reaction {
        kind: row.kind().to_owned(),
        detected_by: row.detected_by.clone(),
        reaction: row.reaction.clone(),
    }
}
