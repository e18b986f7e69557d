//! The options that annex `options.md` describes: stored parameters (`stored`), captures (`capture`), and the zero of the encoders.
//!
//! No check moves the zero of a drive, because no request restores it.

mod capture;
mod offered;
mod stored;

use super::pins::has;
use crate::prelude::checks::*;
use capture::at_once;
use offered::{UNNAMED, needs};

pub(super) fn checks() -> Vec<Check> {
    let mut checks = vec![
        check(
            "R4.17 R20.1 R21.1 R22.1",
            "requests of options that the drive lacks are answered as UnknownRequest",
            lacking,
        ),
        check("R21.2", "SetZero is refused in every state but Idle, and there with another source", zero),
    ];
    checks.extend(stored::checks());
    checks.extend(capture::checks());
    checks
}

fn lacking(client: &mut Client) -> RuleResult {
    let requests = |state| {
        [
            (Capabilities::STORE, result(StoreParameters {}, UnknownRequest, state)),
            (Capabilities::STORE, result(RecallParameters {}, UnknownRequest, state)),
            (Capabilities::STORE, result(ForgetParameters {}, UnknownRequest, state)),
            (
                Capabilities::BENCH_MODE,
                result(SetZero { source: ZeroSource::Present }, UnknownRequest, state),
            ),
            (Capabilities::CAPTURE, result(at_once(1, 1, 0), UnknownRequest, state)),
            (Capabilities::CAPTURE, result(ReadCapture { first: 0 }, UnknownRequest, state)),
        ]
    };
    if requests(Boot).iter().all(|(capability, _)| has(client, *capability)) {
        return skip("the drive has every option");
    }
    client.in_states(&[Idle, Running], |client, state| {
        let lacked = requests(state).into_iter().filter(|(capability, _)| !has(client, *capability));
        let lacked: Vec<_> = lacked.map(|(_, exchange)| exchange).collect();
        client.exchange(&format!("in {state}"), &lacked)
    })
}

fn zero(client: &mut Client) -> RuleResult {
    needs(client, Capabilities::BENCH_MODE, "the drive has no bench mode")?;
    let other = ZeroSource::from_byte(UNNAMED).unwrap_or(ZeroSource::Home);
    client.in_states(State::ALL, |client, state| {
        let sources: &[ZeroSource] =
            if state == Idle { &[other] } else { &[ZeroSource::Present, ZeroSource::Home] };
        let outcome = if state == Idle { OutOfRange } else { WrongState };
        let refused = sources.iter().map(|source| result(SetZero { source: *source }, outcome, state));
        client.exchange(&format!("in {state}"), &refused.collect::<Vec<_>>())
    })
}
