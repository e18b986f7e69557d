//! Samples outside `Running`.

use lashloop_protocol::EncoderCounts;
use lashloop_protocol::enums::{Outcome, State, TorqueFlags};
use lashloop_protocol::message::{ClearFault, EmergencyStop, EncoderSample, Stop};

use super::super::answers::{fault, outcome, sample, torque};
use super::super::assertion::{RuleResult, equal, expect, names};
use super::super::check::{Check, check};
use super::super::client::Client;
use super::super::encoders::setup::Setup;
use super::super::reactions::{accepted, first_sample, no_torque};

pub(super) fn checks() -> Vec<Check> {
    let mut checks = vec![
        check("R7.19", "a sample before the handshake is refused", |client| {
            for sequence in [0, 1] {
                let answers = client.sample(sequence)?;
                equal("answers", vec!["CommandResult"], names(&answers))?;
                let got = (outcome::<EncoderSample>(&answers)?, client.state);
                equal("outcome and state", (Outcome::WrongState, State::Boot), got)?;
            }
            Ok(())
        }),
        check("R7.19 R7.7 R8.4", "a sample before the start has no effect on the run", |client| {
            let setup = Setup::coarse(client)?;
            setup.start(client)?;
            let fresh = first_sample(client)?;
            for sequence in [1, 2] {
                accepted(client, sample(sequence), TorqueFlags::empty())?;
            }
            client.command(Stop {})?;
            odd_samples(client, State::Idle)?;
            // The second time after a Stop that Faulted refuses, and a sample.
            for _ in 0..2 {
                let report = fault(&client.request(EmergencyStop {})?)?;
                equal("last sample accepted, in the report of an EmergencyStop", 2, report.sequence)?;
                client.request(Stop {})?;
                no_torque(client, 777, State::Faulted)?;
            }
            client.command(ClearFault {})?;
            client.arm()?;
            odd_samples(client, State::Armed)?;
            let report = fault(&client.request(EmergencyStop {})?)?;
            equal("last sample accepted, in the report of an EmergencyStop in Armed", 2, report.sequence)?;
            client.command(ClearFault {})?;
            client.arm()?;
            odd_samples(client, State::Armed)?;
            client.start()?;
            let first = accepted(client, sample(0), TorqueFlags::empty())?;
            let same = fresh.torque_nm.to_bits() == first.torque_nm.to_bits();
            let expected = format!("the torque of the run before, {} N m", fresh.torque_nm);
            expect(same, expected, first.torque_nm)?;
            accepted(client, sample(1), TorqueFlags::empty()).map(drop)
        }),
    ];
    for state in [State::Idle, State::Armed, State::Faulted] {
        let name = format!("a sample gets torque zero in {state:?}");
        checks.push(check("R7.19 R6.1", name, move |client| {
            client.enter(state)?;
            odd_samples(client, state)
        }));
    }
    checks
}

/// Samples that would be a first one, a repetition, a next one with two jumps, a stray one and a fault in `Running`.
fn odd_samples(client: &mut Client, state: State) -> RuleResult {
    let far = EncoderCounts::wrapping(-(1 << 22));
    for (sequence, counts, reference_rad) in [
        (0, EncoderCounts::default(), 1.0),
        (0, EncoderCounts::default(), 1.0),
        (1, far, 1.0),
        (40_000, far, -1.0),
        (40_001, EncoderCounts::default(), f32::NAN),
        (u16::MAX, far, 0.0),
    ] {
        let odd = EncoderSample { sequence, motor_counts: counts, load_counts: counts, reference_rad };
        let answers = client.request(odd)?;
        equal(&format!("to sample {sequence} in {state:?}"), vec!["TorqueAnswer"], names(&answers))?;
        let it = torque(&answers)?;
        let wanted = (sequence, 0.0, state, TorqueFlags::empty());
        let got = (it.sequence, it.torque_nm, it.status.state, it.status.flags);
        equal("sequence, torque in N m, state and flags", wanted, got)?;
        equal("state afterwards", state, client.state)?;
    }
    Ok(())
}
