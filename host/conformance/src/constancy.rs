//! What a drive keeps: requests and frames that change nothing, many times in every state.

use super::exchanges::{BURST, reported};
use super::growth::Unknown;
use super::parameters::values::{defaults, in_force};
use super::range::of_other_type;
use super::receiver;
use super::telemetry::subscription::signals;
use crate::prelude::checks::*;

/// Copies of each request. A drive that errs only later errs within them.
pub(super) const COPIES: usize = 9;
/// A pause in a frame, in each state.
const PAUSE: Duration = Duration::from_millis(5);

pub(super) fn checks() -> Vec<Check> {
    let of_state = |state: State| {
        let name =
            format!("requests and frames that change nothing change nothing in {state:?}, however often");
        check("R2.6 R2.7 R4.2 R4.15 R6.2 R6.3 R6.8", name, move |client| Constancy::check(client, state))
    };
    State::ALL.iter().map(|state| of_state(*state)).collect()
}

/// A drive in one state, with everything in it that a request could change by mistake.
struct Constancy {
    state: State,
    session: u32,
    signals: u32,
    values: Vec<ParameterValue>,
    fault: Option<FaultReport>,
    /// What the drive's receiver has counted since the last `Start`.
    counts: LineReport,
    unknown: Unknown,
}

impl Constancy {
    fn check(client: &mut Client, state: State) -> RuleResult {
        let mut it = Self::prepared(client, state)?;
        for request in it.requests(client) {
            it.repeat(client, request)?;
        }
        for (request, answer) in unknown_indices(client, state) {
            equal(&format!("to {}", request.words()), vec![answer], it.repeat(client, request)?)?;
        }
        if state == Running {
            it.run_on(client)?;
        }
        it.damage(client)?;
        it.pause(client)?;
        it.unchanged(client)
    }

    /// Leads the drive into the state by a run, so that there are counts, and a subscription and values of its own.
    fn prepared(client: &mut Client, state: State) -> Result<Self, Failure> {
        let unknown = Unknown::of(client)?;
        client.idle()?;
        let limit = client.parameter("torque_limit_nm")?.clone();
        client.long_watchdog()?;
        client.put(&limit.name, neighbour(&limit))?;
        let signals = signals(client).unwrap_or(0);
        let session = client.session;
        let mut values = defaults(client);
        for name in [WATCHDOG_US, TORQUE_LIMIT_NM] {
            let index = client.parameter(name)?.index;
            values[usize::from(index)] = client.get(index)?.value;
        }
        client.exchange("in Idle", &[result(Subscribe { signals, every: 2 }, Accepted, Idle)])?;
        client.arm_and_start()?;
        let counts = counted(1, 0, 0);
        let mut it = Self { state, session, signals, values, fault: None, counts, unknown };
        let end: Vec<HostMessage> = match state {
            Boot | State::Unknown(_) => vec![Reset {}.into()],
            Idle => vec![Stop {}.into()],
            Armed => vec![Stop {}.into(), Arm { session }.into()],
            Running => vec![sample(0).into()],
            Faulted => vec![EncoderSample { reference_rad: f32::INFINITY, ..sample(0) }.into()],
        };
        let answers = it.send(client, &end)?;
        if state == Faulted {
            it.fault = Some(fault(&answers)?);
        }
        if state == Boot {
            it.values = defaults(client);
        }
        Ok(it)
    }

    /// Sends requests in one write, counted with their marker, and requires the state afterwards.
    fn send(&mut self, client: &mut Client, requests: &[HostMessage]) -> Result<Vec<DriveMessage>, Failure> {
        let answers = client.burst(requests)?;
        self.counts.messages += requests.len() as u32 + 1;
        equal(&format!("state after {}", requests[0].words()), self.state, client.state)?;
        Ok(answers)
    }

    /// The requests that change nothing in this state.
    fn requests(&self, client: &Client) -> Vec<HostMessage> {
        let Self { state, session, signals, .. } = *self;
        let mut requests: Vec<HostMessage> = Vec::new();
        // First, because these would repair what another request breaks: the subscription, and in Idle the session.
        if matches!(state, Armed | Running) {
            requests.push(Subscribe { signals, every: 2 }.into());
        }
        if state != Boot {
            requests.push(hello(session).into());
        }
        let stranger = session ^ 1;
        requests.extend::<[HostMessage; 9]>([
            other(stranger),
            DescribeLaw { index: 0 }.into(),
            DescribeSignal { index: 0 }.into(),
            DescribeParameter { index: 0 }.into(),
            DescribeChoice { parameter: 0, choice: 0 }.into(),
            GetParameter { index: 0 }.into(),
            Arm { session: stranger }.into(),
            Start { session: stranger }.into(),
            Subscribe { signals: u32::MAX, every: 2 }.into(),
        ]);
        if let Some(choices) = client.description.parameters.iter().find(|it| !it.choices.is_empty()) {
            let choice = choices.choices[0].value as u8;
            requests.push(DescribeChoice { parameter: choices.index, choice }.into());
        }
        requests.extend(self.settings(client));
        if state != Idle && state != Boot {
            requests.push(Arm { session }.into());
        }
        if state != Armed && state != Boot {
            requests.push(Start { session }.into());
        }
        match state {
            Faulted => requests.push(EmergencyStop {}.into()),
            _ => requests.push(ClearFault {}.into()),
        }
        match state {
            // The last sample, and a stray one.
            Running => requests.extend::<[HostMessage; 2]>([sample(0).into(), sample(1 << 15).into()]),
            _ => requests.push(sample(3).into()),
        }
        if matches!(state, Boot | Idle | Faulted) {
            requests.push(Stop {}.into());
        }
        requests
    }

    /// Settings that are refused, or of the value in force.
    fn settings(&self, client: &Client) -> Vec<HostMessage> {
        let index = client.identity.parameter_count;
        let unknown = SetParameter { index, value: U32(0) };
        // The last index of all ends every exchange.
        let mut settings = if index < u8::MAX { vec![unknown] } else { Vec::new() };
        let parameters = &client.description.parameters;
        for it in
            parameters.iter().find(|it| it.live).into_iter().chain(parameters.iter().find(|it| !it.live))
        {
            let index = it.index;
            settings.push(SetParameter { index, value: self.values[usize::from(index)] });
            settings.push(SetParameter { index, value: of_other_type(it)[0] });
            if matches!(self.state, Boot | Faulted) || !it.live && self.state != Idle {
                settings.push(SetParameter { index, value: neighbour(it) });
            }
        }
        settings.into_iter().map(HostMessage::from).collect()
    }

    /// Sends a request many times in one write, and requires equal answers every time. Returns those of one time.
    fn repeat(&mut self, client: &mut Client, request: HostMessage) -> Result<Vec<DriveMessage>, Failure> {
        let copies = client.repetitions(COPIES);
        let mut answers = self.send(client, &vec![request; copies])?;
        answers.iter_mut().for_each(forget_time);
        let count = answers.len() / copies;
        let name = request.words();
        if count == 0 || !answers.len().is_multiple_of(copies) {
            return Err(broken(format!("equal answers to {copies} times {name}"), answers.words()));
        }
        let (first, rest) = answers.split_at(count);
        for (copy, later) in (2..).zip(rest.chunks(count)) {
            if later != first {
                let what = format!("to {name} for the {copy}. time in {:?}, {}", self.state, first.words());
                return Err(broken(what, later.words()));
            }
        }
        Ok(first.to_vec())
    }

    /// Accepted samples, as many as copies of the other requests.
    fn run_on(&mut self, client: &mut Client) -> RuleResult {
        for sequence in 1..=client.repetitions(COPIES) as u16 {
            let answers = self.send(client, &[sample(sequence).into()])?;
            let kinds = if sequence % 2 == 0 && self.signals != 0 { 2 } else { 1 };
            equal(&format!("answers to sample {sequence}"), kinds, answers.len())?;
        }
        Ok(())
    }

    fn damage(&mut self, client: &mut Client) -> RuleResult {
        let (damaged, refused) = (receiver::damaged(), receiver::refused(self.session));
        for (frames, count) in [(&damaged, &mut self.counts.damaged), (&refused, &mut self.counts.refused)] {
            *count += frames.len() as u32;
            client.send_bytes(&frames.concat())?;
        }
        for _ in 0..client.repetitions(2) {
            self.unknown.exchange(client, self.state)?;
            self.counts.messages += self.unknown.count + 1;
        }
        let answers = self.send(client, &[GetParameter { index: 0 }.into()])?;
        equal("answers after damaged and refused frames", vec!["ParameterReport"], names(&answers))
    }

    fn pause(&mut self, client: &mut Client) -> RuleResult {
        let frame = HostMessage::from(GetParameter { index: 0 }).frame();
        let (start, rest) = frame.split_at(3);
        client.send_bytes(start)?;
        let unasked = client.wait_for(PAUSE, |message| (!is::<Log>(message)).then_some(*message))?;
        equal("without a request, message other than a Log", None, unasked)?;
        let answers = client.request_bytes(rest)?;
        self.counts.messages += 2;
        equal("answers to a frame with a pause", vec!["ParameterReport"], names(&answers))
    }

    fn unchanged(&mut self, client: &mut Client) -> RuleResult {
        let Self { state, session, signals, .. } = *self;
        let when = format!("after all of it in {state:?}");
        in_force(client, &when, &self.values.clone(), state)?;
        // One marker for each write of reads.
        let reads = self.values.len();
        self.counts.messages += (reads + reads.div_ceil(BURST)) as u32;
        if let Some(wanted) = self.fault {
            // A `Hello` of this version would open again a session that was lost.
            let answers = self.send(client, &[other(session)])?;
            equal(&format!("{when}, after the Identity"), wanted, fault(&answers)?)?;
        }
        let counts = line_report(&client.request(Stop {})?)?;
        self.counts.messages += 1;
        equal(&format!("{when}, line report"), self.counts, counts)?;
        if state == Faulted {
            client.exchange(&when, &[result(ClearFault {}, Accepted, Idle)])?;
        }
        if state == Boot {
            client.exchange(&when, &[result(Arm { session }, WrongSession, Boot)])?;
            client.long_watchdog()?;
        }
        client.exchange(&when, &[result(Arm { session }, Accepted, Armed)])?;
        client.exchange(&when, &[result(Start { session }, Accepted, Running)])?;
        let subscribed = state != Boot && signals != 0;
        for sequence in 0..3 {
            let with_telemetry = subscribed && sequence % 2 == 0;
            let kinds = if with_telemetry { vec!["TorqueAnswer", "Telemetry"] } else { vec!["TorqueAnswer"] };
            let answers = client.sample(sequence)?;
            equal(&format!("{when}, in a new run, answers to sample {sequence}"), kinds, names(&answers))?;
        }
        Ok(())
    }
}

/// Requests of an index that the drive does not have.
pub(super) fn unknown_indices(client: &Client, state: State) -> Vec<Exchange> {
    let identity = &client.identity;
    let index = identity.parameter_count;
    let outcome = UnknownIndex;
    let mut unknown = vec![
        result(DescribeLaw { index: identity.law_count }, outcome, state),
        result(DescribeSignal { index: identity.signal_count }, outcome, state),
        result(DescribeChoice { parameter: index, choice: 0 }, outcome, state),
    ];
    // The last index of all ends every exchange.
    if index < u8::MAX {
        let report = reported(index, outcome, U32(0), state);
        unknown.push((GetParameter { index }.into(), report.into()));
        unknown.push((DescribeParameter { index }.into(), report.into()));
    }
    unknown
}
