//! A long session: every request in every state, many times, without a reset in between.
//!
//! A drive may lose its settings, its session, its subscription or a fault after a certain request, in a certain state or only
//! after a while. The other checks start from a drive that was just reset, and each sends few requests.

use lashloop_protocol::enums::{Outcome, ParameterValue, State, TorqueFlags};
use lashloop_protocol::frame::DELIMITER;
use lashloop_protocol::message::{
    Arm, ClearFault, DescribeChoice, DescribeLaw, DescribeParameter, DescribeSignal, EmergencyStop,
    EncoderSample, FaultReport, Hello, Identity, Start, Stop, Subscribe,
};
use lashloop_protocol::{DriveMessage, EncoderCounts, HostMessage, Message, PROTOCOL_VERSION};

use super::answers::{fault, hello, identity, outcome, sample, telemetry, torque};
use super::assertion::{Failure, RuleResult, equal, expect, names};
use super::burst::{Exchange, reads, result, sets};
use super::check::{Check, check};
use super::client::Client;
use super::encoders::setup::Setup;
use super::reactions::{no_torque, refused_sample, same_report};

/// Rounds in each state, with two runs each. Counters of a firmware that wrap or saturate earlier show here.
const LAPS: u16 = 3;
/// Signals of the subscription, at most.
const SIGNALS: usize = 2;

pub(super) fn checks() -> Vec<Check> {
    let rules = "R4.1 R6.2 R6.3 R6.7 R6.8 R9.7 R10.9 R11.5 R12.1 R12.3 R12.4 R12.5";
    vec![check(rules, "a long session keeps settings, session, subscription and faults", long_session)]
}

/// What the drive must keep from lap to lap.
struct Kept {
    /// Parameters with other values than their defaults, by index.
    settings: Vec<(u8, ParameterValue)>,
    subscription: Subscribe,
    /// Answers to the description requests, which depend on nothing.
    described: Vec<Exchange>,
    identity: Identity,
    /// Torque of the first sample, as bits.
    first_torque: Option<u32>,
}

fn long_session(client: &mut Client) -> RuleResult {
    let mut kept = Kept {
        settings: Vec::new(),
        subscription: Subscribe { signals: 0, every: 0 },
        described: descriptions(client)?,
        identity: client.identity,
        first_torque: None,
    };
    let laps = client.repetitions(LAPS.into()) as u16;
    for lap in 0..laps {
        kept.round(client, State::Boot, lap, None)?;
    }
    kept.prepare(client)?;
    for lap in 0..laps {
        kept.round(client, State::Idle, lap, None)?;
        client.arm()?;
        kept.round(client, State::Armed, lap, None)?;
        client.start()?;
        kept.samples(client)?;
        kept.round(client, State::Running, lap, None)?;
        // The run continues: the next sample, and the last one again.
        kept.stepped(client, 2, TorqueFlags::empty())?;
        equal("Stop", (Outcome::Accepted, State::Idle), client.command(Stop {})?)?;
        client.arm()?;
        client.start()?;
        // No position of the run before is left.
        let far = EncoderCounts::wrapping(if lap.is_multiple_of(2) { 1 << 22 } else { -(1 << 22) });
        let first = EncoderSample { motor_counts: far, load_counts: far, ..sample(0) };
        equal(
            "a first sample far away: state",
            State::Running,
            torque(&client.request(first)?)?.status.state,
        )?;
        let latched = fault(&client.request(EmergencyStop {})?)?;
        kept.round(client, State::Faulted, lap, Some(latched))?;
        equal("ClearFault", (Outcome::Accepted, State::Idle), client.command(ClearFault {})?)?;
        client.handshake(client.session ^ 1)?;
        client.idle()?;
    }
    Ok(())
}

/// One description of each kind, and an index of each kind that the drive does not have.
fn descriptions(client: &mut Client) -> Result<Vec<Exchange>, Failure> {
    let mut requests: Vec<HostMessage> =
        vec![DescribeParameter { index: 0 }.into(), DescribeLaw { index: 0 }.into()];
    if !client.description.signals.is_empty() {
        requests.push(DescribeSignal { index: 0 }.into());
    }
    let with_choices = client.description.parameters.iter().find(|it| !it.choices.is_empty());
    requests.extend(with_choices.map(|it| {
        let choice = it.choices[0].value as u8;
        HostMessage::from(DescribeChoice { parameter: it.index, choice })
    }));
    let answers = client.answers(&requests)?;
    Ok(requests.into_iter().zip(answers).collect())
}

impl Kept {
    /// Opens the session and changes settings and subscription.
    fn prepare(&mut self, client: &mut Client) -> RuleResult {
        client.long_watchdog()?;
        let setup = Setup::coarse(client)?;
        setup.allowed(client)?;
        client.put_all(&setup.settings())?;
        for it in client.description.parameters.clone() {
            let value = client.get(it.index)?.value;
            if value != it.default {
                self.settings.push((it.index, value));
            }
        }
        let law = client.default_law();
        let of_law = client.description.signals.iter().filter(|it| it.laws.contains(law));
        let signals = of_law.take(SIGNALS).fold(0, |mask, it| mask | 1 << it.index);
        self.subscription = Subscribe { signals, every: u16::from(signals != 0) };
        let answers = client.request(self.subscription)?;
        equal("Subscribe", Outcome::Accepted, outcome::<Subscribe>(&answers)?)?;
        self.identity = client.handshake(client.session)?;
        Ok(())
    }

    /// The requests that change nothing in this state, each with its answer.
    fn exchanges(&self, client: &Client, state: State, lap: u16) -> Vec<Exchange> {
        let session = client.session;
        let other = session ^ 1;
        let wrong = |boot| if state == State::Boot { boot } else { Outcome::WrongState };
        let mut list = self.described.clone();
        list.push(result(DescribeLaw { index: u8::MAX }, Outcome::UnknownIndex, state));
        list.push(result(DescribeSignal { index: u8::MAX }, Outcome::UnknownIndex, state));
        list.push(result(DescribeChoice { parameter: u8::MAX, choice: 0 }, Outcome::UnknownIndex, state));
        list.push(result(Arm { session: other }, Outcome::WrongSession, state));
        list.push(result(Start { session: other }, Outcome::WrongSession, state));
        if state != State::Idle {
            list.push(result(Arm { session }, wrong(Outcome::WrongSession), state));
        }
        if state != State::Armed {
            list.push(result(Start { session }, wrong(Outcome::WrongSession), state));
        }
        if state != State::Faulted {
            list.push(result(ClearFault {}, Outcome::WrongState, state));
        }
        let is_open = !matches!(state, State::Boot | State::Faulted);
        let subscribed = if is_open { Outcome::Accepted } else { Outcome::WrongState };
        list.push(result(self.subscription, subscribed, state));
        let all = Subscribe { signals: u32::MAX, every: 0 };
        let refused =
            if client.description.signals.len() < 32 { Outcome::UnknownIndex } else { Outcome::OutOfRange };
        list.push(result(all, if is_open { refused } else { Outcome::WrongState }, state));
        let accepted = if state == State::Idle { Outcome::Accepted } else { Outcome::WrongState };
        // Two of the settings in each round, and the default of one refused.
        let count = self.settings.len();
        for place in (0..count).filter(|place| (place + usize::from(lap)) % count.max(1) < 2) {
            let (index, value) = self.settings[place];
            list.push(sets(index, value, accepted, value, state));
            list.push(reads(index, value, state));
            let nan = ParameterValue::F32(f32::NAN);
            let is_real = matches!(value, ParameterValue::F32(_));
            let refusal = match (state, is_real) {
                (State::Idle, true) => Outcome::OutOfRange,
                (State::Idle, false) => Outcome::WrongType,
                _ => Outcome::WrongState,
            };
            list.push(sets(index, nan, refusal, value, state));
        }
        for it in client.description.parameters.iter().filter(|it| it.live).take(1) {
            let value = it.default;
            let live = if is_open { Outcome::Accepted } else { Outcome::WrongState };
            list.push(sets(it.index, value, live, value, state));
        }
        list
    }

    /// Sends everything that changes nothing in this state.
    fn round(&self, client: &mut Client, state: State, lap: u16, latched: Option<FaultReport>) -> RuleResult {
        let when = format!("in {state:?}, round {}", lap + 1);
        client.send_bytes(&bad_frames(lap))?;
        client.exchange(&when, &self.exchanges(client, state, lap))?;
        self.hellos(client, &when, state, latched)?;
        match state {
            State::Boot => {
                let answers = client.sample(lap)?;
                let got = (outcome::<EncoderSample>(&answers)?, client.state);
                equal(&format!("{when}: a sample"), (Outcome::WrongState, State::Boot), got)?;
            }
            State::Running => {
                refused_sample(client, 0)?;
                refused_sample(client, 2000)?;
                self.stepped(client, 1, TorqueFlags::REPEATED)?;
            }
            State::Idle | State::Armed | State::Faulted => no_torque(client, lap, state)?,
        }
        if matches!(state, State::Boot | State::Idle | State::Faulted) {
            let outcome = if state == State::Idle { Outcome::Accepted } else { Outcome::WrongState };
            equal(&format!("{when}: Stop"), (outcome, state), client.command(Stop {})?)?;
        }
        if state == State::Faulted {
            let got = client.command(EmergencyStop {})?;
            equal(&format!("{when}: EmergencyStop"), (Outcome::Accepted, State::Faulted), got)?;
        }
        equal(&format!("{when}: state"), state, client.state)
    }

    /// `Hello` of another version, and in a session the same again.
    fn hellos(
        &self,
        client: &mut Client,
        when: &str,
        state: State,
        latched: Option<FaultReport>,
    ) -> RuleResult {
        let session = client.session;
        let protocol_version = PROTOCOL_VERSION.wrapping_add(1);
        let mut requests = vec![(Hello { protocol_version, session: session ^ 2 }, vec!["CommandResult"])];
        if state != State::Boot {
            requests.push((hello(session), vec![]));
        }
        for (request, last) in requests {
            let answers = client.request(request)?;
            let reported = latched.map(|_| "FaultReport");
            let wanted: Vec<_> = ["Identity"].into_iter().chain(reported).chain(last).collect();
            equal(
                &format!("{when}, to Hello of version {}", request.protocol_version),
                wanted,
                names(&answers),
            )?;
            let wanted = Identity { session: request.session, state, ..self.identity };
            let got = identity(&answers)?;
            let same = DriveMessage::from(got) == DriveMessage::from(wanted);
            expect(
                same,
                format!("{when}: the Identity of {state:?}, otherwise as before"),
                DriveMessage::from(got),
            )?;
            if let Some(latched) = latched {
                same_report(&format!("{when}: after the Identity"), latched, fault(&answers)?)?;
            }
        }
        Ok(())
    }

    /// The first two samples of a run.
    fn samples(&mut self, client: &mut Client) -> RuleResult {
        let first_nm = self.stepped(client, 0, TorqueFlags::empty())?;
        let wanted = *self.first_torque.get_or_insert(first_nm.to_bits());
        let expected = format!("the first torque of each run, {} N m", f32::from_bits(wanted));
        expect(first_nm.to_bits() == wanted, expected, first_nm)?;
        self.stepped(client, 1, TorqueFlags::empty()).map(drop)
    }

    /// A sample that is accepted or repeated, with the telemetry of the subscription unless it is repeated.
    fn stepped(&self, client: &mut Client, sequence: u16, flags: TorqueFlags) -> Result<f32, Failure> {
        let values = self.subscription.signals.count_ones() as usize;
        let is_due = values > 0 && flags.is_empty();
        let wanted = if is_due { vec!["TorqueAnswer", "Telemetry"] } else { vec!["TorqueAnswer"] };
        let answers = client.request_to(sample(sequence), wanted[wanted.len() - 1])?;
        equal(&format!("to sample {sequence}"), wanted, names(&answers))?;
        let it = torque(&answers)?;
        let got = (it.sequence, it.status.state, it.status.flags - TorqueFlags::SATURATED);
        equal("sequence, state and flags but SATURATED", (sequence, State::Running, flags), got)?;
        if is_due {
            let it = telemetry(&answers)?;
            let got = (it.sequence, it.values.as_slice().len());
            equal("sequence and number of values of the Telemetry", (sequence, values), got)?;
        }
        Ok(it.torque_nm)
    }
}

/// A damaged frame and a good one that isn't a request, which have no effect.
fn bad_frames(lap: u16) -> Vec<u8> {
    let mut damaged = HostMessage::from(Stop {}).frame().to_vec();
    damaged[2] ^= if damaged[2] == 1 { 2 } else { 1 };
    let no_request = DriveMessage::from(FaultReport {
        code: lashloop_protocol::enums::FaultCode::EmergencyStop,
        sequence: lap,
        value: 0.0,
        limit: 0.0,
        detail: 0,
    });
    [&damaged[..], &[DELIMITER], &*no_request.frame()].concat()
}
