//! The lines of measurements as a table of text, for files.

use std::fmt::Write as _;

use crate::response::{Excited, Line, Measured};

impl Excited {
    /// The unit of the excitation.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Torque => "N m",
            Self::Reference => "rad",
        }
    }

    const fn column(self) -> &'static str {
        match self {
            Self::Torque => "amplitude_nm",
            Self::Reference => "amplitude_rad",
        }
    }
}

impl Measured {
    /// Each response that was measured, with its name and its unit.
    pub fn responses(&self) -> impl Iterator<Item = (&'static str, &'static str, &[Line])> {
        let all: [(_, _, &[Line]); 5] = [
            ("motor", "rad/N m", &self.motor),
            ("load", "rad/N m", &self.load),
            ("sensitivity", "", &self.sensitivity),
            ("open_loop", "", &self.open_loop),
            ("closed_loop", "", &self.closed_loop),
        ];
        all.into_iter().filter(|(_, _, lines)| !lines.is_empty())
    }
}

/// CSV of measurements at several amplitudes: a row for each line of each response. Numbers have ten digits, so a repeated
/// measurement has the same bytes.
#[must_use]
pub fn csv<'a>(excited: Excited, measurements: impl IntoIterator<Item = (f64, &'a Measured)>) -> String {
    let mut text = format!(
        "{},response,frequency_hz,real,imaginary,magnitude_db,phase_deg,within_db,within_deg,coherence\n",
        excited.column()
    );
    for (amplitude, measured) in measurements {
        for (name, _, lines) in measured.responses() {
            for line in lines {
                let numbers = [
                    line.frequency_hz,
                    line.value.re,
                    line.value.im,
                    line.decibels(),
                    line.phase_deg(),
                    line.within_db(),
                    line.within_deg(),
                    line.coherence,
                ];
                let _ = write!(text, "{amplitude:?},{name}");
                for number in numbers {
                    let _ = write!(text, ",{number:.9e}");
                }
                text.push('\n');
            }
        }
    }
    text
}
