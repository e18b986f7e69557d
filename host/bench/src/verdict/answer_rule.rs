//! The rules of docs/protocol.md that every torque answer of a run must keep.

use std::fmt;

use lashloop_protocol::enums::State;
use serde::{Deserialize, Serialize};

/// A rule for torque answers, with the values that break it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AnswerRule {
    /// A torque is finite.
    Finite {
        /// The torque in N m.
        torque_nm: f32,
    },
    /// A torque lies within `torque_limit_nm`, in either direction.
    WithinLimit {
        /// The torque in N m.
        torque_nm: f32,
        /// The limit that the bench has read from the drive, in N m.
        limit_nm: f32,
    },
    /// A torque is zero in every state but `Running`.
    ZeroUnlessRunning {
        /// The torque in N m.
        torque_nm: f32,
        /// The state of the answer.
        state: State,
    },
    /// A torque with the flag `SATURATED` is the limit.
    SaturatedAtLimit {
        /// The torque in N m.
        torque_nm: f32,
        /// The limit that the bench has read from the drive, in N m.
        limit_nm: f32,
    },
    /// The answer after a gap has the flag `GAP`.
    GapFlagged,
    /// No other answer has the flag `GAP`.
    GapOnlyAfterGap,
    /// Only a sample that arrived twice has the flag `REPEATED`.
    RepeatedOnlyIfRetransmitted,
    /// Bench mode: a step has a reference that was sent.
    ReferenceSent {
        /// Number of the reference in the report.
        number: u16,
    },
    /// From the start to the stop, the state is `Running` unless a fault is latched.
    Running {
        /// The state of the answer.
        state: State,
    },
}

impl AnswerRule {
    /// The state that breaks the rule, if it is one of states.
    #[must_use]
    pub fn state(&self) -> Option<State> {
        match *self {
            Self::ZeroUnlessRunning { state, .. } | Self::Running { state } => Some(state),
            _ => None,
        }
    }

    /// Number of the rule in docs/protocol.md.
    #[must_use]
    pub fn number(&self) -> &'static str {
        match self {
            Self::Finite { .. } => "R7.12",
            Self::WithinLimit { .. } | Self::SaturatedAtLimit { .. } => "R7.11",
            Self::ZeroUnlessRunning { .. } => "R6.1",
            Self::GapFlagged => "R7.2",
            Self::GapOnlyAfterGap => "R7.4",
            Self::RepeatedOnlyIfRetransmitted => "R7.3",
            Self::ReferenceSent { .. } => "R18.7",
            Self::Running { .. } => "R6.2",
        }
    }

    /// What the rule requires.
    #[must_use]
    pub fn requirement(&self) -> &'static str {
        match self {
            Self::Finite { .. } => "a torque is finite",
            Self::WithinLimit { .. } => "a torque lies within torque_limit_nm",
            Self::ZeroUnlessRunning { .. } => "a torque is 0 in every state but Running",
            Self::SaturatedAtLimit { .. } => {
                "a torque with the flag SATURATED is torque_limit_nm, in either direction"
            }
            Self::GapFlagged => "the answer to a sample after a gap has the flag GAP",
            Self::GapOnlyAfterGap => "only the answer to a sample after a gap has the flag GAP",
            Self::RepeatedOnlyIfRetransmitted => "only the answer to a repeated sample has the flag REPEATED",
            Self::ReferenceSent { .. } => "the reference of a step is the last one that arrived before it",
            Self::Running { .. } => "a started drive is Running until a stop, a reset or a fault",
        }
    }

    /// What the answer has.
    #[must_use]
    pub fn value(&self) -> String {
        match self {
            Self::Finite { torque_nm }
            | Self::WithinLimit { torque_nm, .. }
            | Self::SaturatedAtLimit { torque_nm, .. } => format!("torque {torque_nm} N m"),
            Self::ZeroUnlessRunning { torque_nm, state } => {
                format!("torque {torque_nm} N m in state {state}")
            }
            Self::GapFlagged => "no flag GAP".to_owned(),
            Self::GapOnlyAfterGap => "flag GAP".to_owned(),
            Self::RepeatedOnlyIfRetransmitted => "flag REPEATED".to_owned(),
            Self::ReferenceSent { number } => format!("reference {number}"),
            Self::Running { state } => format!("state {state} without a fault report"),
        }
    }

    /// What it may have.
    #[must_use]
    pub fn limit(&self) -> String {
        match self {
            Self::Finite { .. } => "finite".to_owned(),
            Self::WithinLimit { limit_nm, .. } | Self::SaturatedAtLimit { limit_nm, .. } => {
                format!("{limit_nm} N m")
            }
            Self::ZeroUnlessRunning { .. } => "0 N m".to_owned(),
            Self::GapFlagged => "the sample before was not sent".to_owned(),
            Self::GapOnlyAfterGap => "the sample before was answered".to_owned(),
            Self::RepeatedOnlyIfRetransmitted => "the sample was sent once".to_owned(),
            Self::ReferenceSent { .. } => "a reference that was sent".to_owned(),
            Self::Running { .. } => "state Running".to_owned(),
        }
    }
}

/// A torque answer that breaks a rule.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BrokenRule {
    /// The rule.
    pub rule: AnswerRule,
    /// Step of the run whose sample the drive answered.
    pub step: u32,
    /// Sequence of the answer.
    pub sequence: u16,
}

impl fmt::Display for BrokenRule {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { rule, step, sequence } = self;
        write!(
            out,
            "the drive breaks rule {} of docs/protocol.md at step {step}, sequence {sequence}: {}, limit: {}; {}",
            rule.number(),
            rule.value(),
            rule.limit(),
            rule.requirement()
        )
    }
}

/// A broken rule in words, as a summary has it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct BrokenRuleReport {
    /// The side that broke it: the drive.
    pub side: String,
    /// Number of the rule in docs/protocol.md.
    pub rule: String,
    /// What the rule requires.
    pub requirement: String,
    /// Step of the run whose sample the drive answered.
    pub step: u32,
    /// Sequence of the answer.
    pub sequence: u16,
    /// What the answer has.
    pub value: String,
    /// What it may have.
    pub limit: String,
}

impl From<BrokenRule> for BrokenRuleReport {
    fn from(BrokenRule { rule, step, sequence }: BrokenRule) -> Self {
        Self {
            side: "drive".to_owned(),
            rule: rule.number().to_owned(),
            requirement: rule.requirement().to_owned(),
            step,
            sequence,
            value: rule.value(),
            limit: rule.limit(),
        }
    }
}
