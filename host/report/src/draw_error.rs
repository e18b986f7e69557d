//! Why a figure of records can't be drawn.

use lashloop_record::reader::ReadError;
use lashloop_session::names::UnknownName;

/// Why records can't be plotted.
#[derive(Debug, thiserror::Error)]
pub enum DrawError {
    /// A record can't be used.
    #[error(transparent)]
    Record(#[from] ReadError),
    /// No run has a step in the selected range.
    #[error("no step lies in the range {}; the records end at {end_s} s", range(*from_s, *until_s))]
    Nothing {
        /// Start of the range, in s.
        from_s: f64,
        /// End of the range, in s.
        until_s: f64,
        /// Time of the last step of all runs, in s.
        end_s: f64,
    },
    /// No record has the signal.
    #[error("{}: {}", .0.name, .0)]
    Signal(#[from] UnknownName),
    /// Steps and time on one axis.
    #[error("{name} has no control period, so its axis is the number of the step; plot it apart")]
    Axes {
        /// The capture.
        name: String,
    },
    /// Two records have the signal in different units.
    #[error(
        "{name} is in {} in {record} and in {} in {other_record}; plot them apart",
        named(unit),
        named(other)
    )]
    Units {
        /// The signal.
        name: String,
        /// A record.
        record: String,
        /// Its unit.
        unit: String,
        /// Another record.
        other_record: String,
        /// Its unit.
        other: String,
    },
}

fn range(from_s: f64, until_s: f64) -> String {
    let from = if from_s.is_finite() { format!("from {from_s} s ") } else { String::new() };
    from + &if until_s.is_finite() { format!("to {until_s} s") } else { "on".to_owned() }
}

fn named(unit: &str) -> &str {
    if unit.is_empty() { "no unit" } else { unit }
}
