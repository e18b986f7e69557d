//! Answers of right and wrong drives to samples that a line may lose, delay, reorder or duplicate.

use lashloop_protocol::enums::TorqueStatus;

use super::*;

const LIMIT_NM: f32 = 20.0;
const NONE: TorqueFlags = TorqueFlags::empty();
const GAP: TorqueFlags = TorqueFlags::GAP;
const REPEATED: TorqueFlags = TorqueFlags::REPEATED;
const SATURATED: TorqueFlags = TorqueFlags::SATURATED;

/// A host that has sent these samples, and nothing else, of a drive that was started in step 100.
struct Host(AnswerCheck);

impl Host {
    fn new() -> Self {
        Self(AnswerCheck::new(LIMIT_NM, false))
    }

    fn sends(mut self, numbers: impl IntoIterator<Item = u32>) -> Self {
        for number in numbers {
            self.0.note_sent(number, 100 + number);
        }
        self
    }

    /// A right answer has arrived.
    fn has(mut self, number: u32, flags: TorqueFlags) -> Self {
        assert_eq!(self.broken(number, 1.0, State::Running, flags), None, "{number}, {flags:?}");
        self
    }

    fn broken(
        &mut self,
        number: u32,
        torque_nm: f32,
        state: State,
        flags: TorqueFlags,
    ) -> Option<AnswerRule> {
        let status = TorqueStatus { state, flags };
        let answer = TorqueAnswer { sequence: number as u16, torque_nm, status, compute_tenths_us: 57 };
        let passes = self.0.passes(&answer);
        assert_eq!(passes, self.0.broken.is_none());
        self.0.broken.map(|broken| broken.rule)
    }

    fn flagged(mut self, number: u32, flags: TorqueFlags) -> Option<AnswerRule> {
        self.broken(number, 1.0, State::Running, flags)
    }
}

fn first(torque_nm: f32, state: State, flags: TorqueFlags) -> Option<AnswerRule> {
    Host::new().sends([0]).broken(0, torque_nm, state, flags)
}

#[test]
fn a_torque_passes_at_its_limit_and_breaks_a_rule_one_ulp_beyond() {
    for sign in [1.0, -1.0] {
        assert_eq!(first(sign * LIMIT_NM, State::Running, NONE), None);
        assert_eq!(first(sign * LIMIT_NM, State::Running, SATURATED), None);
        let torque_nm = sign * LIMIT_NM.next_up();
        let want = Some(AnswerRule::WithinLimit { torque_nm, limit_nm: LIMIT_NM });
        assert_eq!(first(torque_nm, State::Running, SATURATED), want);
    }
}

#[test]
fn a_torque_that_is_not_finite_breaks_a_rule_in_every_state() {
    for state in [State::Running, State::Faulted] {
        for torque_nm in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            assert!(matches!(first(torque_nm, state, NONE), Some(AnswerRule::Finite { .. })), "{torque_nm}");
        }
    }
}

#[test]
fn saturated_is_the_limit_of_either_sign_and_no_smaller_torque() {
    for torque_nm in [LIMIT_NM.next_down(), -LIMIT_NM.next_down(), 0.0] {
        let want = Some(AnswerRule::SaturatedAtLimit { torque_nm, limit_nm: LIMIT_NM });
        assert_eq!(first(torque_nm, State::Running, SATURATED), want);
    }
    let mut weak = Host(AnswerCheck::new(0.0, false)).sends([0]);
    assert_eq!(weak.broken(0, -0.0, State::Running, SATURATED), None, "a limit of 0 saturates at 0");
}

#[test]
fn any_torque_but_zero_of_either_sign_needs_a_running_drive() {
    for state in [State::Idle, State::Armed, State::Faulted, State::Boot] {
        let torque_nm = f32::from_bits(1);
        assert_eq!(first(torque_nm, state, NONE), Some(AnswerRule::ZeroUnlessRunning { torque_nm, state }));
        for zero in [0.0, -0.0] {
            assert_eq!(first(zero, state, NONE), Some(AnswerRule::Running { state }));
        }
    }
}

#[test]
fn a_sample_left_out_is_a_gap_and_no_other_is() {
    let skipped = || Host::new().sends([0, 1]).has(0, NONE).has(1, NONE).sends([4]);
    assert_eq!(skipped().flagged(4, NONE), Some(AnswerRule::GapFlagged));
    assert_eq!(skipped().flagged(4, GAP), None);
    assert_eq!(skipped().has(4, GAP).sends([5]).flagged(5, GAP), Some(AnswerRule::GapOnlyAfterGap));
    assert_eq!(Host::new().sends([0]).flagged(0, GAP), Some(AnswerRule::GapOnlyAfterGap));
    // An unanswered sample in the gap doesn't fill it.
    assert_eq!(skipped().sends([6]).flagged(6, NONE), Some(AnswerRule::GapFlagged));
}

#[test]
fn an_unanswered_sample_is_a_gap_or_not() {
    let lost = || Host::new().sends([0, 1]).has(0, NONE).sends([2]);
    assert_eq!(lost().flagged(2, GAP), None, "the line has lost sample 1");
    assert_eq!(lost().flagged(2, NONE), None, "the line has lost the answer to sample 1");
}

#[test]
fn a_late_answer_shows_that_there_was_no_gap() {
    let late = || Host::new().sends([0, 1]).has(0, NONE).sends([2]).has(1, NONE);
    assert_eq!(late().flagged(2, NONE), None);
    assert_eq!(late().flagged(2, GAP), Some(AnswerRule::GapOnlyAfterGap));
}

#[test]
fn answers_in_another_order_pass() {
    let _ =
        Host::new().sends([0, 1]).has(0, NONE).sends([2]).has(2, NONE).has(1, NONE).sends([3]).has(3, NONE);
    // The same of samples: the drive takes sample 2 first and rejects sample 1, then 3.
    let _ = Host::new().sends([0, 1]).has(0, NONE).sends([2]).has(2, GAP).sends([3]).has(3, NONE);
}

#[test]
fn a_duplicated_answer_passes() {
    let _ = Host::new().sends([0, 3]).has(0, NONE).has(0, NONE).has(3, GAP).has(3, GAP);
}

#[test]
fn repeated_is_the_answer_to_a_retransmitted_sample_only() {
    assert_eq!(Host::new().sends([0]).flagged(0, REPEATED), Some(AnswerRule::RepeatedOnlyIfRetransmitted));
    assert_eq!(Host::new().sends([0, 0]).flagged(0, REPEATED), None);
    assert_eq!(Host::new().sends([0, 0, 1]).has(0, NONE).has(0, REPEATED).flagged(1, NONE), None);
    let mut duplicating = Host(AnswerCheck::new(LIMIT_NM, true)).sends([0]);
    assert_eq!(duplicating.broken(0, 1.0, State::Running, REPEATED), None, "the line has duplicated it");
}

#[test]
fn a_repeat_after_a_gap_keeps_the_flag() {
    // The answer with the flag is lost; the line has duplicated the sample.
    let repeated = || Host(AnswerCheck::new(LIMIT_NM, true)).sends([0]).has(0, NONE).sends([5]);
    assert_eq!(repeated().flagged(5, REPEATED | GAP), None);
    assert_eq!(repeated().flagged(5, REPEATED), Some(AnswerRule::GapFlagged));
}

#[test]
fn after_a_retransmitted_first_sample_the_next_one_follows_a_gap() {
    let retransmitted = || Host::new().sends([0, 0, 0]).has(0, REPEATED).sends([3]);
    assert_eq!(retransmitted().flagged(3, GAP), None);
    assert_eq!(retransmitted().flagged(3, NONE), Some(AnswerRule::GapFlagged));
}

#[test]
fn the_oldest_late_answer_is_no_false_gap() {
    let host = (0..=1023).fold(Host::new().sends([0]), |host, number| host.sends([number]));
    assert_eq!(host.flagged(0, NONE), None);
    let host = (0..=1030).fold(Host::new(), |host, number| host.sends([number]));
    assert_eq!(host.flagged(7, NONE), None, "sample 6 is forgotten, not left out");
}

#[test]
fn numbers_count_on_where_sequences_wrap() {
    let mut host = Host::new().sends(65_530..65_536).has(65_535, NONE).sends([65_536]).has(65_536, NONE);
    host = host.sends([65_538]);
    assert_eq!(host.flagged(65_538, NONE), Some(AnswerRule::GapFlagged));
}

#[test]
fn a_broken_rule_has_the_step_of_its_sample() {
    let mut host = Host::new().sends([0, 1, 2]);
    let _ = host.broken(1, 21.0, State::Running, NONE);
    let broken = host.0.broken.expect("a torque beyond the limit");
    assert_eq!((broken.step, broken.sequence), (101, 1));
}
