//! Mutants of the law `pd`.

use lashloop_protocol::enums::State;
use lashloop_protocol::message::EncoderSample;
use lashloop_protocol::{EncoderCounts, HostMessage};

use super::{alters_answers, alters_requests, torques};
use crate::mutants::Variant;

const COARSE: &str = "the law pd requests the torques of the golden trace, run coarse";
const FINE: &str = "the law pd requests the torques of the golden trace, run fine";

pub const VARIANTS: &[Variant] = &[
    alters_answers("requests two thousandths of its torque too much", COARSE, |_, answers| {
        torques(answers, |it| {
            if it.status.state == State::Running && it.torque_nm.abs() < 19.0 {
                it.torque_nm *= 1.002;
            }
        })
    }),
    alters_requests("loses the lowest bits of the load's readings", FINE, |_, request| match request {
        HostMessage::EncoderSample(sample) => {
            let load_counts = EncoderCounts::wrapping(i64::from(sample.load_counts.get()) & !0xff);
            vec![EncoderSample { load_counts, ..sample }.into()]
        }
        other => vec![other],
    }),
];
