//! What one run of the battery scores. A run without a figure ranks behind every run with one.

use std::cmp::Ordering;
use std::fmt;

use serde::{Deserialize, Serialize};

use crate::metrics::{Measured, Metric, Metrics};
use crate::run::{End, Outcome};
use crate::verdict::Verdict;

/// A figure that the battery looks at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Figure {
    /// Time into 0.05 rad, for good.
    SettleTime,
    /// Error of the last second.
    StaticError,
    /// Peak to peak of the last 10 s.
    Hunting,
    /// The drive's last estimate of j0 less the true one.
    DeadZoneError,
    /// Integral of the torque squared.
    Effort,
    /// Sum of the torque's changes.
    TorqueVariation,
}

impl Figure {
    /// Every figure, in the order of the tables.
    pub const ALL: [Self; 6] = [
        Self::SettleTime,
        Self::StaticError,
        Self::Hunting,
        Self::DeadZoneError,
        Self::Effort,
        Self::TorqueVariation,
    ];

    /// The metric it is taken from.
    #[must_use]
    pub const fn metric(self) -> Metric {
        match self {
            Self::SettleTime => Metric::SettleTime,
            Self::StaticError => Metric::StaticError,
            Self::Hunting => Metric::Hunting,
            Self::DeadZoneError => Metric::DeadZoneError,
            Self::Effort => Metric::Effort,
            Self::TorqueVariation => Metric::TorqueTotalVariation,
        }
    }

    /// Name in a table; sizes of figures are compared there, without their signs.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::SettleTime => "settle time",
            Self::StaticError => "static error",
            Self::Hunting => "hunting",
            Self::DeadZoneError => "|j_hat - j0|",
            Self::Effort => "effort",
            Self::TorqueVariation => "variation",
        }
    }

    /// Unit in a table.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::SettleTime => "s",
            Self::StaticError | Self::Hunting | Self::DeadZoneError => "mrad",
            Self::Effort => "N^2 m^2 s",
            Self::TorqueVariation => "N m",
        }
    }

    /// A value in SI units as a table shows it.
    #[must_use]
    pub fn show(self, si: f64) -> String {
        match self {
            Self::SettleTime => format!("{si:.2}"),
            Self::StaticError | Self::Hunting | Self::DeadZoneError => format!("{:.2}", si * 1e3),
            Self::Effort | Self::TorqueVariation => format!("{si:.0}"),
        }
    }
}

/// A figure of one run, or why there is none.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Score {
    /// A finite number in the unit of the metric.
    Value(f64),
    /// Why there is no number.
    Without(Lack),
}

/// Why a run has no figure; the worse the later.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Lack {
    /// The metric does not apply to this run.
    #[serde(rename = "none")]
    Unmeasured,
    /// The load never stayed in the band.
    #[serde(rename = "never")]
    Never,
    /// The run did not reach its end: the drive latched a fault, above all.
    #[serde(rename = "cut short")]
    CutShort,
    /// Something was not finite, or the plant could not be followed.
    #[serde(rename = "not finite")]
    NotFinite,
}

impl Score {
    /// The number, if there is one.
    #[must_use]
    pub const fn value(self) -> Option<f64> {
        match self {
            Self::Value(value) => Some(value),
            Self::Without(_) => None,
        }
    }

    /// The score without its sign.
    #[must_use]
    pub fn size(self) -> Self {
        match self {
            Self::Value(value) => Self::Value(value.abs()),
            lack @ Self::Without(_) => lack,
        }
    }

    /// The better first. What has no number, or none that is finite, is behind all that has.
    #[must_use]
    pub fn order(&self, other: &Self) -> Ordering {
        let rank = |score: &Self| match score {
            Self::Value(value) if value.is_finite() => (*value, None),
            Self::Value(_) => (f64::INFINITY, Some(Lack::NotFinite)),
            Self::Without(lack) => (f64::INFINITY, Some(*lack)),
        };
        let ((one, one_lack), (two, two_lack)) = (rank(self), rank(other));
        one.total_cmp(&two).then(one_lack.cmp(&two_lack))
    }
}

impl fmt::Display for Lack {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.pad(match self {
            Self::Unmeasured => "none",
            Self::Never => "never",
            Self::CutShort => "cut short",
            Self::NotFinite => "not finite",
        })
    }
}

/// The figures of one run, with their signs, by the names of their metrics.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scores {
    settle_time_s: Score,
    static_error_rad: Score,
    hunting_rad: Score,
    dead_zone_error_rad: Score,
    effort_nm2s: Score,
    torque_total_variation_nm: Score,
}

impl Scores {
    /// What a run scores.
    #[must_use]
    pub fn of(outcome: &Outcome) -> Self {
        Self::judged(&outcome.end, outcome.judgement.verdict, &outcome.metrics)
    }

    fn judged(end: &End, verdict: Verdict, metrics: &Metrics) -> Self {
        let score = |figure: Figure| match (end, metrics.get(figure.metric())) {
            (End::Diverged(_), _) | (_, Measured::NotFinite) => Score::Without(Lack::NotFinite),
            // What was measured up to the fault is no figure of the whole run.
            (End::DriveFault(_) | End::DriveRestarted | End::Interrupted, _) => {
                Score::Without(Lack::CutShort)
            }
            _ if verdict == Verdict::Invalid => Score::Without(Lack::CutShort),
            (End::Complete, Measured::Value(value)) => Score::Value(value),
            (End::Complete, Measured::Never) => Score::Without(Lack::Never),
            (End::Complete, _) => Score::Without(Lack::Unmeasured),
        };
        Self {
            settle_time_s: score(Figure::SettleTime),
            static_error_rad: score(Figure::StaticError),
            hunting_rad: score(Figure::Hunting),
            dead_zone_error_rad: score(Figure::DeadZoneError),
            effort_nm2s: score(Figure::Effort),
            torque_total_variation_nm: score(Figure::TorqueVariation),
        }
    }

    /// One of them.
    #[must_use]
    pub const fn get(&self, figure: Figure) -> Score {
        match figure {
            Figure::SettleTime => self.settle_time_s,
            Figure::StaticError => self.static_error_rad,
            Figure::Hunting => self.hunting_rad,
            Figure::DeadZoneError => self.dead_zone_error_rad,
            Figure::Effort => self.effort_nm2s,
            Figure::TorqueVariation => self.torque_total_variation_nm,
        }
    }
}

#[cfg(test)]
mod tests {
    use lashloop_protocol::message::FaultReport;
    use lashloop_protocol::vocabulary::FaultCode;
    use rand_pcg::Pcg64;
    use rand_pcg::rand_core::{Rng, SeedableRng};

    use super::*;
    use crate::metrics::{Estimates, Measurement, Sample};
    use crate::plant::PlantError;

    /// Metrics of a run that lies on its reference from beginning to end.
    fn perfect() -> Metrics {
        let mut measurement = Measurement::new(0.5);
        for step in 0..40 {
            measurement.push(&Sample {
                time_s: f64::from(step) * 0.5,
                reference_rad: 0.0,
                load_position_rad: 0.0,
                torque_nm: 0.0,
                estimates: Some(Estimates { dead_zone_rad: 0.16, disturbing_torque_nm: 0.0 }),
                dead_zone_rad: 0.16,
                disturbing_torque_nm: 0.0,
            });
        }
        measurement.metrics()
    }

    #[test]
    fn a_run_that_did_not_reach_its_end_never_scores_well() {
        let metrics = perfect();
        let of = |end: &End, verdict| {
            let scores = Scores::judged(end, verdict, &metrics);
            Figure::ALL.map(|figure| scores.get(figure))
        };
        assert_eq!(of(&End::Complete, Verdict::Fail), [Score::Value(0.0); 6]);
        let fault = FaultReport {
            code: FaultCode::MotorEncoderJump,
            sequence: 40,
            value: 1.0,
            limit: 1.0,
            detail: 0,
        };
        let chattering = End::Diverged(PlantError::Chattering { substep_s: 1e-3 });
        let away = End::Diverged(PlantError::NotFinite { torque_nm: 1e300 });
        for (end, verdict, lack) in [
            (chattering, Verdict::Invalid, Lack::NotFinite),
            (away, Verdict::Fail, Lack::NotFinite),
            (End::DriveFault(fault), Verdict::Fail, Lack::CutShort),
            (End::DriveRestarted, Verdict::Invalid, Lack::CutShort),
            (End::Complete, Verdict::Invalid, Lack::CutShort),
        ] {
            assert_eq!(of(&end, verdict), [Score::Without(lack); 6], "{end:?}");
        }
    }

    #[test]
    fn nothing_without_a_finite_number_ranks_before_a_number() {
        let huge = Score::Value(f64::MAX);
        for worse in [
            Score::Value(f64::NAN),
            Score::Value(-f64::NAN),
            Score::Value(f64::INFINITY),
            Score::Value(f64::NEG_INFINITY),
            Score::Without(Lack::Unmeasured),
            Score::Without(Lack::Never),
            Score::Without(Lack::CutShort),
            Score::Without(Lack::NotFinite),
        ] {
            assert_eq!(huge.order(&worse), Ordering::Less, "{worse:?}");
            assert_eq!(worse.order(&huge), Ordering::Greater, "{worse:?}");
        }
    }

    #[test]
    fn a_score_reads_back_to_the_same_bits() {
        // A reader that is merely fast is one bit off for some percent of all numbers.
        let mut random = Pcg64::seed_from_u64(1);
        let values = (0..10_000).map(|_| f64::from_bits(random.next_u64())).filter(|value| value.is_finite());
        let lacks = [Lack::Unmeasured, Lack::Never, Lack::CutShort, Lack::NotFinite].map(Score::Without);
        for score in values.chain([-0.0, 5e-324]).map(Score::Value).chain(lacks) {
            let text = serde_json::to_string(&score).expect("a score is JSON");
            let read: Score = serde_json::from_str(&text).expect("what was written is read");
            assert_eq!(read, score, "{text}");
            assert_eq!(read.value().map(f64::to_bits), score.value().map(f64::to_bits), "{text}");
        }
    }
}
