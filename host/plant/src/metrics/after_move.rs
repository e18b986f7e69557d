//! Settling after a move of the reference.

use super::channel::Channel;
use super::measured::Measured;
use super::meter::Meter;
use super::sample::Sample;

/// The band around the reference as a fraction of the move, the usual 2 % criterion.
const BAND: f64 = 0.02;

/// The reference's last move so far: samples in a row, each with another reference than the one before.
#[derive(Debug, Clone, Copy)]
struct Move {
    low_rad: f64,
    high_rad: f64,
    /// Time of the last change.
    end_s: f64,
    /// Whether the last sample changed the reference.
    moving: bool,
    inside_since_s: Option<f64>,
}

impl Move {
    /// Time from the end of the move to the first sample after the last one outside the band.
    fn settled(&self) -> Measured {
        match self {
            Self { moving: true, .. } => Measured::NoEndOfMotion,
            Self { inside_since_s: None, .. } => Measured::Never,
            Self { inside_since_s: Some(since_s), end_s, .. } => Measured::finite(since_s - end_s),
        }
    }
}

/// Settling after the reference's last move, or the longest after any of its moves.
#[derive(Debug, Default)]
pub(super) struct SettlingAfterMove {
    previous_rad: Option<f64>,
    last: Option<Move>,
    /// Of the moves before the last one, if they count: the longest settling, or [`Measured::Never`].
    longest: Option<Measured>,
}

impl SettlingAfterMove {
    /// Of every move.
    pub(super) const fn of_every_move() -> Self {
        Self { previous_rad: None, last: None, longest: Some(Measured::Value(0.0)) }
    }
}

fn longer(one: Measured, other: Measured) -> Measured {
    match (one, other) {
        (Measured::Value(one), Measured::Value(other)) => Measured::Value(one.max(other)),
        (Measured::Value(_), reason) | (reason, _) => reason,
    }
}

impl Meter for SettlingAfterMove {
    fn push(&mut self, sample: &Sample<'_>) {
        let &Sample { time_s, reference_rad, .. } = sample;
        let changed_from = self.previous_rad.replace(reference_rad).filter(|rad| *rad != reference_rad);
        if let Some(before_rad) = changed_from {
            let (low_rad, high_rad) = match self.last {
                Some(Move { low_rad, high_rad, moving: true, .. }) => (low_rad, high_rad),
                ended => {
                    if let (Some(ended), Some(longest)) = (ended, &mut self.longest) {
                        *longest = longer(*longest, ended.settled());
                    }
                    (before_rad, before_rad)
                }
            };
            self.last = Some(Move {
                low_rad: low_rad.min(reference_rad),
                high_rad: high_rad.max(reference_rad),
                end_s: time_s,
                moving: true,
                inside_since_s: None,
            });
        }
        if let (Some(last), Some(error_rad)) = (&mut self.last, Channel::Error.of(sample)) {
            last.moving = changed_from.is_some();
            if error_rad.abs() <= BAND * (last.high_rad - last.low_rad) {
                last.inside_since_s.get_or_insert(time_s);
            } else {
                last.inside_since_s = None;
            }
        }
    }

    fn measured(&self) -> Measured {
        match (&self.last, self.longest) {
            (None, _) => Measured::NoMove,
            (Some(last), None) => last.settled(),
            (Some(last), Some(longest)) => longer(longest, last.settled()),
        }
    }
}
