//! The reference position of the load, as a pure function of time.
//!
//! | profile | purpose |
//! |---|---|
//! | `constant` | regulation; the paper's test, to zero from pi/2 |
//! | `step` | step response |
//! | `sine` | tracking, and lost motion under slow reversal |
//! | `trapezoid` | a positioning move with limited velocity and acceleration |
//! | `chirp` | one frequency after the other |
//! | `multisine` | many frequencies at once, which repeat after a period |
//! | `table` | points of a file, recorded or computed elsewhere |

mod chirp;
mod multisine;
mod table;
mod tones;
mod trapezoid;

use std::f64::consts::TAU;

use serde::Serialize;

pub use self::chirp::Chirp;
pub use self::multisine::{Multisine, MultisineKeys};
pub use self::table::{Interpolation, Table, TableError, TableErrorKind};
pub use self::tones::Tones;
pub use self::trapezoid::Trapezoid;

/// A reference for the load position.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "profile", rename_all = "lowercase")]
pub enum Reference {
    /// One position for the whole run.
    Constant {
        /// Reference position.
        position_rad: f64,
    },
    /// A jump.
    Step {
        /// Position before the jump.
        before_rad: f64,
        /// Position from the jump on.
        after_rad: f64,
        /// First time at which `after_rad` holds.
        at_s: f64,
    },
    /// offset + amplitude sin(2 pi f t + phase).
    Sine {
        /// Half of peak to peak, in rad.
        amplitude_rad: f64,
        /// Frequency f.
        frequency_hz: f64,
        /// Middle of the sine.
        offset_rad: f64,
        /// Phase at time 0.
        phase_rad: f64,
    },
    /// A move with limited velocity and acceleration.
    Trapezoid(Trapezoid),
    /// A sine of rising frequency.
    Chirp(Chirp),
    /// Many sines at once.
    Multisine(Multisine),
    /// Points of a file.
    Table(Table),
}

impl Reference {
    /// Reference position in rad at a time of the run.
    #[must_use]
    pub fn position_rad(&self, t_s: f64) -> f64 {
        match self {
            Self::Constant { position_rad } => *position_rad,
            Self::Step { before_rad, after_rad, at_s } => {
                if t_s < *at_s {
                    *before_rad
                } else {
                    *after_rad
                }
            }
            // We take libm, not std, for the same bits on every platform.
            Self::Sine { amplitude_rad, frequency_hz, offset_rad, phase_rad } => {
                offset_rad + amplitude_rad * libm::sin(TAU * frequency_hz * t_s + phase_rad)
            }
            Self::Trapezoid(trapezoid) => trapezoid.position_rad(t_s),
            Self::Chirp(chirp) => chirp.position_rad(t_s),
            Self::Multisine(multisine) => multisine.position_rad(t_s),
            Self::Table(table) => table.position_rad(t_s),
        }
    }

    /// The middle of a reference that reverses: the offset of a sine, a chirp or a multisine, or half way between the extremes of a table.
    #[must_use]
    pub fn middle_rad(&self) -> Option<f64> {
        match self {
            Self::Sine { offset_rad, .. } => Some(*offset_rad),
            Self::Chirp(chirp) => Some(chirp.offset_rad),
            Self::Multisine(multisine) => Some(multisine.keys().offset_rad),
            Self::Table(table) => Some(table.middle_rad()),
            Self::Constant { .. } | Self::Step { .. } | Self::Trapezoid(_) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Reference;

    #[test]
    fn step_has_its_new_value_at_the_instant_of_the_step() {
        let step = Reference::Step { before_rad: 1.0, after_rad: -2.0, at_s: 0.5 };
        assert_eq!(step.position_rad(0.499_999), 1.0);
        assert_eq!(step.position_rad(0.5), -2.0);
    }

    #[test]
    fn sine_has_its_extremes_a_quarter_period_from_its_middle() {
        let sine =
            Reference::Sine { amplitude_rad: 0.5, frequency_hz: 0.05, offset_rad: 0.1, phase_rad: 0.0 };
        assert_eq!(sine.position_rad(0.0), 0.1);
        assert!((sine.position_rad(5.0) - 0.6).abs() < 1e-15);
        assert!((sine.position_rad(15.0) + 0.4).abs() < 1e-15);
    }

    #[test]
    fn phase_of_pi_mirrors_a_sine() {
        let at = |phase_rad, t_s| {
            Reference::Sine { amplitude_rad: 2.0, frequency_hz: 1.0, offset_rad: 0.0, phase_rad }
                .position_rad(t_s)
        };
        assert!((at(std::f64::consts::PI, 0.1) + at(0.0, 0.1)).abs() < 1e-12);
    }
}
