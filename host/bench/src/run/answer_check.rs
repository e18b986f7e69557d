//! Holds every torque answer of a run to the rules of the protocol: in time, late or repeated.
//!
//! A line loses, damages, delays, reorders and duplicates frames, so the bench knows of a sample only that it was sent and,
//! once an answer has arrived, that the drive has accepted it. A rule is broken only if no such line explains the answer.
//! After a sample that was sent and not answered, for example, the flag `GAP` may be there or not.

use lashloop_protocol::enums::{State, TorqueFlags, TorqueStatus};
use lashloop_protocol::message::TorqueAnswer;
use lashloop_protocol::sequence::nearest_step;

use crate::verdict::{AnswerRule, BrokenRule};

/// Samples kept: more than the longest gap, over which an answer can be late.
const KEPT: usize = 1024;

/// A sample of the present start.
#[derive(Debug, Clone, Copy)]
struct Sent {
    /// Its number since the start of the drive.
    number: u32,
    /// The step of the run that sent it first.
    step: u32,
    /// Whether the drive may have received it more than once.
    is_retransmitted: bool,
    /// Whether a running drive has answered it.
    is_answered: bool,
}

/// The rules with what the bench has sent since the start of the drive.
#[derive(Debug)]
pub(super) struct AnswerCheck {
    torque_limit_nm: f32,
    /// Whether the line to the drive may duplicate samples.
    may_duplicate: bool,
    /// The latest samples, each at its number modulo [`KEPT`].
    sent: Box<[Option<Sent>; KEPT]>,
    /// Number and step of the last sample.
    present: (u32, u32),
    /// The first rule that was broken.
    pub(super) broken: Option<BrokenRule>,
}

impl AnswerCheck {
    /// For a drive that is about to be started, with this largest torque.
    pub(super) fn new(torque_limit_nm: f32, may_duplicate: bool) -> Self {
        Self { torque_limit_nm, may_duplicate, sent: Box::new([None; KEPT]), present: (0, 0), broken: None }
    }

    /// The sample of this number is about to be sent, perhaps again.
    pub(super) fn note_sent(&mut self, number: u32, step: u32) {
        self.present = (number, step);
        match &mut self.sent[number as usize % KEPT] {
            Some(sent) if sent.number == number => sent.is_retransmitted = true,
            slot => {
                let is_retransmitted = self.may_duplicate;
                *slot = Some(Sent { number, step, is_retransmitted, is_answered: false });
            }
        }
    }

    /// Whether an answer keeps all rules.
    pub(super) fn passes(&mut self, answer: &TorqueAnswer) -> bool {
        let number = nearest_step(answer.sequence, self.present.0);
        let sample = number.and_then(|number| self.sample(number));
        if let Some(rule) = self.broken_rule(answer, sample) {
            let step = sample.map_or(self.present.1, |sample| sample.step);
            self.broken.get_or_insert(BrokenRule { rule, step, sequence: answer.sequence });
            return false;
        }
        if let Some(number) = number
            && let Some(sent) = &mut self.sent[number as usize % KEPT]
            && sent.number == number
        {
            sent.is_answered = true;
        }
        true
    }

    fn sample(&self, number: u32) -> Option<Sent> {
        self.sent[number as usize % KEPT].filter(|sent| sent.number == number)
    }

    /// The rule that the answer to a sample breaks; a sample that is not known has been sent before the present start.
    fn broken_rule(&self, answer: &TorqueAnswer, sample: Option<Sent>) -> Option<AnswerRule> {
        let &TorqueAnswer { torque_nm, status, .. } = answer;
        let state = status.state;
        let has = |flag| status.flags.contains(flag);
        if let Some(rule) = broken_torque_rule(torque_nm, status, self.torque_limit_nm) {
            return Some(rule);
        }
        if let Some(sample) = sample {
            // Behind an answer, it is the line that has duplicated the sample.
            if has(TorqueFlags::REPEATED) && !sample.is_retransmitted && !sample.is_answered {
                return Some(AnswerRule::RepeatedOnlyIfRetransmitted);
            }
            match self.before(sample) {
                Before::NotSent if state == State::Running && !has(TorqueFlags::GAP) => {
                    return Some(AnswerRule::GapFlagged);
                }
                Before::Accepted if has(TorqueFlags::GAP) => return Some(AnswerRule::GapOnlyAfterGap),
                Before::NotSent | Before::Accepted | Before::Unknown => {}
            }
        }
        (state != State::Running).then_some(AnswerRule::Running { state })
    }

    fn before(&self, sample: Sent) -> Before {
        // The first sample follows no other, so it follows no gap either.
        let Some(number) = sample.number.checked_sub(1) else { return Before::Accepted };
        match self.sample(number) {
            Some(Sent { is_answered: true, .. }) => Before::Accepted,
            Some(Sent { is_answered: false, .. }) => Before::Unknown,
            None if (self.present.0 - number) as usize >= KEPT => Before::Unknown,
            None => Before::NotSent,
        }
    }
}

/// The rule that a torque breaks, in either mode.
pub(super) fn broken_torque_rule(torque_nm: f32, status: TorqueStatus, limit_nm: f32) -> Option<AnswerRule> {
    let TorqueStatus { state, flags } = status;
    if !torque_nm.is_finite() {
        return Some(AnswerRule::Finite { torque_nm });
    }
    if state != State::Running && torque_nm != 0.0 {
        return Some(AnswerRule::ZeroUnlessRunning { torque_nm, state });
    }
    if torque_nm.abs() > limit_nm {
        return Some(AnswerRule::WithinLimit { torque_nm, limit_nm });
    }
    (flags.contains(TorqueFlags::SATURATED) && torque_nm.abs() != limit_nm)
        .then_some(AnswerRule::SaturatedAtLimit { torque_nm, limit_nm })
}

/// What the bench knows of the sample before another one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Before {
    /// It was left out, so the drive finds a gap.
    NotSent,
    /// The drive has accepted it, so there is no gap.
    Accepted,
    /// It was sent, and the line may have lost it or its answer.
    Unknown,
}

#[cfg(test)]
mod tests;
