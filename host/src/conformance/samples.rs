//! Samples: torque answers and sequence rules.

use lashloop_protocol::EncoderCounts;
use lashloop_protocol::enums::{Outcome, ParameterValue, State, TorqueFlags};
use lashloop_protocol::message::{EncoderSample, Stop};

use super::encoders::setup::Setup;

use super::answers::{outcome, sample, torque};
use super::assertion::{Failure, RuleResult, equal, expect, names, skip};
use super::check::{Check, check};
use super::client::{CONTROLLER, Client};
use super::reactions::refused_sample;

/// Steps after which any controller state shows in the torque.
const STEPS: u16 = 50;
/// Periods between samples in checks that advance the sequence quickly.
const GAP: u16 = 100;

pub(super) fn checks() -> Vec<Check> {
    let mut checks = vec![
        check("R7", "a sample before the handshake is refused", |client| {
            let answers = client.sample(0)?;
            equal("answers", vec!["CommandResult"], names(&answers))?;
            equal("outcome", Outcome::WrongState, outcome::<EncoderSample>(&answers)?)
        }),
        check("R7", "while running a sample gets a torque with its sequence", |client| {
            client.running(&[])?;
            for sequence in 0..3 {
                let answer = client.torque(sequence)?;
                let got = (answer.sequence, answer.status.state);
                equal("sequence and state", (sequence, State::Running), got)?;
                equal("flags", TorqueFlags::empty(), answer.status.flags - TorqueFlags::SATURATED)?;
                let pushes = answer.torque_nm != 0.0 && answer.torque_nm.is_finite();
                expect(pushes, "a torque for a load 1 rad off its reference", answer.torque_nm)?;
            }
            Ok(())
        }),
        check("R7", "every law that the drive describes returns a torque", every_law),
        check("R7", "the first sample of a run must carry sequence 0", |client| {
            client.running(&[])?;
            refused_sample(client, 1)?;
            refused_sample(client, 5)?;
            equal("answers", "TorqueAnswer", names(&client.sample(0)?).first().copied().unwrap_or("nothing"))
        }),
        check("R7", "a repeated sample gets the same torque, flagged REPEATED", |client| {
            client.running(&[])?;
            for sequence in 0..2 {
                let (first, again) = (client.torque(sequence)?, client.torque(sequence)?);
                equal("sequence", sequence, again.sequence)?;
                equal("torque", first.torque_nm, again.torque_nm)?;
                equal("flags", first.status.flags | TorqueFlags::REPEATED, again.status.flags)?;
            }
            Ok(())
        }),
        check("R7", "a repeated sample makes no control step", |client| {
            let once = torques(client, |_, _| Ok(()))?;
            let twice = torques(client, |client, sample| client.request(*sample).map(drop))?;
            equal("torques", once, twice)
        }),
        check("R7", "a gap is flagged GAP, once", |client| {
            let gap = start_with_gaps(client)?;
            if gap < 2 {
                return skip("not run: no encoder setting of this drive allows a gap");
            }
            client.torque(0)?;
            let has_gap = |flags: TorqueFlags| flags.contains(TorqueFlags::GAP);
            for (sequence, wanted) in [(1, false), (1 + gap, true), (2 + gap, false), (4 + gap, true)] {
                let flags = client.torque(sequence)?.status.flags;
                equal(&format!("GAP at {sequence}:"), wanted, has_gap(flags))?;
            }
            Ok(())
        }),
        check("R7", "sequence 65535 wraps around to 0", |client| {
            let gap = start_with_gaps(client)?;
            for sequence in (0..u16::MAX).step_by(gap.into()).chain([u16::MAX]) {
                client.torque(sequence)?;
            }
            let answer = client.torque(0)?;
            let wanted = (0, State::Running, TorqueFlags::empty());
            let flags = answer.status.flags - TorqueFlags::SATURATED;
            equal("sequence, state and flags", wanted, (answer.sequence, answer.status.state, flags))?;
            refused_sample(client, u16::MAX)
        }),
        check("R7", "a sample older than the last or far ahead of it is refused", |client| {
            client.running(&[])?;
            for sequence in 0..3 {
                client.torque(sequence)?;
            }
            [0, 1, u16::MAX, 1 << 15].into_iter().try_for_each(|sequence| refused_sample(client, sequence))
        }),
        check("R7", "a refused sample makes no control step", |client| {
            let quiet = torques(client, |_, _| Ok(()))?;
            let disturbed = torques(client, |client, sample| {
                // Half the sequence range ahead, and displaced, so that a control step would change the torque.
                let sequence = sample.sequence ^ 1 << 15;
                let load_counts = sample.load_counts.wrapping_add(90);
                client.request(EncoderSample { sequence, load_counts, ..*sample }).map(drop)
            })?;
            equal("torques", quiet, disturbed)
        }),
        check("R7", "a new start resets the controller: equal samples get equal torques", |client| {
            let first = torques(client, |_, _| Ok(()))?;
            let again = torques(client, |_, _| Ok(()))?;
            equal("torques", first, again)
        }),
    ];
    for state in [State::Idle, State::Armed, State::Faulted] {
        let name = format!("a sample gets torque zero in {state:?}");
        checks.push(check("R7", name, move |client| {
            client.enter(state)?;
            let answers = client.sample(0)?;
            equal("answers", vec!["TorqueAnswer"], names(&answers))?;
            let answer = torque(&answers)?;
            equal("torque and state", (0.0, state), (answer.torque_nm, answer.status.state))
        }));
    }
    checks
}

/// Starts a run with encoders that allow gaps. Returns the gap in periods: [`GAP`], or fewer if the drive limits it.
fn start_with_gaps(client: &mut Client) -> Result<u16, Failure> {
    let setup = Setup::coarse(client)?;
    setup.start(client)?;
    Ok(setup.longest_gap().min(GAP))
}

/// The torques of a run, as bits; `after_each` follows every sample.
fn torques(
    client: &mut Client,
    after_each: impl Fn(&mut Client, &EncoderSample) -> RuleResult,
) -> Result<Vec<u32>, Failure> {
    client.running(&[])?;
    let mut torques = Vec::new();
    for sequence in 0..STEPS {
        let place = i64::from(sequence);
        let [motor_counts, load_counts] = [3 * place, place].map(EncoderCounts::wrapping);
        let sample = EncoderSample { motor_counts, load_counts, ..sample(sequence) };
        torques.push(torque(&client.request(sample)?)?.torque_nm.to_bits());
        after_each(client, &sample)?;
    }
    client.command(Stop {})?;
    Ok(torques)
}

fn every_law(client: &mut Client) -> RuleResult {
    for law in client.description.laws.clone() {
        client.reset()?;
        match client.parameter(CONTROLLER) {
            Ok(_) => client.running(&[(CONTROLLER, ParameterValue::U32(law.index.into()))])?,
            Err(_) => client.running(&[])?,
        }
        let answer = client.torque(0)?;
        equal(&format!("with {} the state", law.name), State::Running, answer.status.state)?;
        expect(answer.torque_nm.is_finite(), format!("a torque of {}", law.name), answer.torque_nm)?;
    }
    Ok(())
}
