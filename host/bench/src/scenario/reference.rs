//! `[reference]`: the commanded load position. Each profile has keys of its own; the error for a key of another profile
//! names that profile.

use serde::Serialize;

use super::declare::{choice, integer, number, tagged, text};
use super::key_error::KeyError;
use super::range::positive;
use super::reader::Section;
use super::tables::Tables;
use crate::settings;
use lashloop_plant::reference::{Chirp, Interpolation, MultisineKeys, Reference, Trapezoid};

settings! {
    /// `[reference]` as it is written.
    #[derive(Debug)]
    pub(super) struct ReferenceKeys {
        /// Shape of the reference over time.
        profile: Option<Profile> = tagged(true),
    }
}

settings! {
    /// The keys of a profile. A position is within 1600 revolutions, which every encoder counts.
    #[derive(Debug, Serialize)]
    enum Profile {
        /// One position for the whole run; regulation from the start to this position.
        "constant" => Constant {
            /// Position of the load.
            position_rad: f64 = number(-1e4..=1e4),
        },
        /// A jump from one position to another.
        "step" => Step {
            /// Position before the jump.
            before_rad: f64 = number(-1e4..=1e4),
            /// Position from the jump on.
            after_rad: f64 = number(-1e4..=1e4),
            /// First time at which `after_rad` holds.
            at_s: f64 = number(0.0..=1e6),
        },
        /// offset + amplitude sin(2 pi frequency t + phase).
        "sine" => Sine {
            /// Half of peak to peak.
            amplitude_rad: f64 = number(0.0..=1e4),
            /// Frequency.
            frequency_hz: f64 = number(positive(1e4)),
            /// Middle of the sine.
            offset_rad: f64 = number(-1e4..=1e4).or(0.0),
            /// Phase at time 0.
            phase_rad: f64 = number(-1e4..=1e4).or(0.0),
        },
        /// A move with limited velocity and acceleration.
        "trapezoid" => Trapezoid {
            /// Position before the move.
            from_rad: f64 = number(-1e4..=1e4),
            /// Position after the move.
            to_rad: f64 = number(-1e4..=1e4),
            /// Begin of the move.
            start_s: f64 = number(0.0..=1e6).or(0.0),
            /// Largest velocity.
            velocity_rad_s: f64 = number(positive(1e4)),
            /// Acceleration and deceleration.
            acceleration_rad_s2: f64 = number(positive(1e6)),
        },
        /// A sine whose frequency moves from one value to another, by equal ratios in equal times, and then stays.
        "chirp" => Chirp {
            /// Half of peak to peak.
            amplitude_rad: f64 = number(0.0..=1e4),
            /// Frequency at time 0.
            from_hz: f64 = number(positive(1e4)),
            /// Frequency at the end of the sweep and from there on.
            to_hz: f64 = number(positive(1e4)),
            /// Time from the first frequency to the last.
            sweep_s: f64 = number(positive(1e5)),
            /// Middle of the sine, where it begins.
            offset_rad: f64 = number(-1e4..=1e4).or(0.0),
        },
        /// offset + amplitude times a sum of sines within +-1: tones of one amplitude with random phases, at odd multiples of
        /// 1 / period.
        "multisine" => Multisine {
            /// Largest distance from the middle.
            amplitude_rad: f64 = number(0.0..=1e4),
            /// Time after which it repeats.
            period_s: f64 = number(positive(1e3)),
            /// Frequency of the lowest tone, rounded to an odd multiple of 1 / period.
            lowest_hz: f64 = number(positive(1e3)),
            /// Frequency that no tone exceeds.
            highest_hz: f64 = number(positive(1e3)),
            /// Tones at most, at about equal ratios.
            lines: u32 = integer(1..=1000).or(40),
            /// Seed of the phases.
            phase_seed: u32 = integer(0..=u32::MAX).or(1),
            /// Middle, where it begins.
            offset_rad: f64 = number(-1e4..=1e4).or(0.0),
        },
        /// Points of a file.
        "table" => Table {
            /// Positions between two points: on a line, or that of the point before.
            interpolation: Interpolation = choice().or(Interpolation::Linear),
            /// CSV file with the columns `time_s,position_rad`, relative to the folder of the scenario.
            file: String = text("the path of a CSV file with the columns time_s,position_rad"),
        },
    }
}

impl ReferenceKeys {
    /// The reference; one that stands in for a faulty one until the scenario is rejected.
    pub(super) fn reference(self, section: &mut Section<'_>, tables: Tables<'_>) -> Reference {
        section.attribute_to_option("profile");
        match self.profile {
            None => Reference::Constant { position_rad: 0.0 },
            Some(Profile::Constant { position_rad }) => Reference::Constant { position_rad },
            Some(Profile::Step { before_rad, after_rad, at_s }) => {
                Reference::Step { before_rad, after_rad, at_s }
            }
            Some(Profile::Sine { amplitude_rad, frequency_hz, offset_rad, phase_rad }) => {
                Reference::Sine { amplitude_rad, frequency_hz, offset_rad, phase_rad }
            }
            Some(Profile::Trapezoid { from_rad, to_rad, start_s, velocity_rad_s, acceleration_rad_s2 }) => {
                Reference::Trapezoid(Trapezoid {
                    from_rad,
                    to_rad,
                    start_s,
                    velocity_rad_s,
                    acceleration_rad_s2,
                })
            }
            Some(Profile::Chirp { amplitude_rad, from_hz, to_hz, sweep_s, offset_rad }) => {
                Reference::Chirp(Chirp { amplitude_rad, from_hz, to_hz, sweep_s, offset_rad })
            }
            Some(Profile::Multisine {
                amplitude_rad,
                period_s,
                lowest_hz,
                highest_hz,
                lines,
                phase_seed,
                offset_rad,
            }) => {
                if highest_hz < lowest_hz {
                    section.reject("highest_hz", format!("is below lowest_hz; it must be >= {lowest_hz} Hz"));
                    return Reference::Constant { position_rad: offset_rad };
                }
                let keys = MultisineKeys {
                    amplitude_rad,
                    period_s,
                    lowest_hz,
                    highest_hz,
                    lines,
                    phase_seed,
                    offset_rad,
                };
                Reference::Multisine(keys.into())
            }
            Some(Profile::Table { interpolation, file }) => {
                let Some(node) = section.node("file").filter(|node| node.text().is_some()) else {
                    return Reference::Constant { position_rad: 0.0 };
                };
                tables.read(&file, interpolation).map_or_else(
                    |error| {
                        section.error("file", node, KeyError::Table(error));
                        Reference::Constant { position_rad: 0.0 }
                    },
                    Reference::Table,
                )
            }
        }
    }
}
