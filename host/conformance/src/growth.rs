//! Growth: requests, bodies and values of a newer host, numbers, and the drive's own names.

use lashloop_protocol::layout::has_number;

use super::answers::of_version;
use super::damage;
use super::exchanges::BURST;
use super::receiver::framed;
use super::states::LONG_WATCHDOG_US;
use crate::prelude::checks::*;

/// Kinds of the host that no message has, and the lengths of their bodies.
const UNKNOWN: [(u8, usize); 8] =
    [(0x7f, 1), (0x6b, 2), (0x5d, 3), (0x41, 6), (0x3e, 7), (0x2a, 20), (0x7c, 57), (0x77, MAX_BODY)];
/// As above, without number and answer.
const SILENT: [(u8, usize); 4] = [(0x1f, 1), (0x1c, 5), (0x1d, 13), (0x1e, MAX_BODY)];
/// Bytes beyond the end of a body; of the last as many as fit.
const BEYOND: [usize; 4] = [1, 4, 9, MAX_BODY];

pub(super) fn checks() -> Vec<Check> {
    vec![
        check("R4.16", "an answer has the number of its request, whichever and however often", every_number),
        check("R4.17", "an unknown request is answered as UnknownRequest in every state", |client| {
            client.in_states(State::ALL, unknown_in)
        }),
        check("R4.15 R4.17", "an unknown request counts as a good message", unknown_counted),
        check("R3.4", "a longer body is taken like one of the usual length", longer),
        check("R14.3", "a Hello of another minor version is one of the same version", minor),
        check("R10.12", "every value that the drive has sent has its name", has_names),
        check("R10.10 R10.12", "values that the drive does not have are answered as UnknownIndex", no_names),
    ]
}

fn every_number(client: &mut Client) -> RuleResult {
    // Several requests with one number are several requests.
    let numbers: Vec<u8> = (0..=u8::MAX).chain([0, 0, 7, 7, 7, u8::MAX, u8::MAX]).collect();
    for (place, part) in numbers.chunks(BURST).enumerate() {
        let index = (place % 2) as u8;
        let read = HostMessage::from(GetParameter { index });
        let bytes: Vec<u8> = part.iter().flat_map(|number| read.numbered_frame(*number).to_vec()).collect();
        of_kinds("answers", &vec!["ParameterReport"; part.len()], client.request_bytes(&bytes)?)?;
    }
    Ok(())
}

/// Frames of kinds without a message.
pub(super) struct Unknown {
    pub(super) bytes: Vec<u8>,
    /// The kinds that are answered, in order.
    pub(super) answered: Vec<u8>,
    /// Frames.
    pub(super) count: u32,
}

impl Unknown {
    /// Those of which the drive has no message either.
    pub(super) fn of(client: &mut Client) -> Result<Self, Failure> {
        let all = [&UNKNOWN[..], &SILENT].concat();
        let parameter = KIND_NAMES;
        let requests = all.iter().map(|(choice, _)| DescribeChoice { parameter, choice: *choice }.into());
        let named = client.answers(&requests.collect::<Vec<_>>())?;
        let mut unknown = Self { bytes: Vec::new(), answered: Vec::new(), count: 0 };
        for ((kind, length), _) in all.into_iter().zip(named).filter(|(_, it)| !is::<ChoiceDescription>(it)) {
            let mut body = vec![1; length];
            body[0] = kind;
            if has_number(kind) {
                unknown.answered.push(kind);
                if let Some(number) = body.get_mut(1) {
                    *number = client.arrivals.next_number();
                }
            }
            unknown.bytes.extend(framed(&body));
            unknown.count += 1;
        }
        Ok(unknown)
    }

    /// Sends them and requires their answers.
    pub(super) fn exchange(&self, client: &mut Client, state: State) -> RuleResult {
        let answers = client.request_bytes(&self.bytes)?;
        let wanted = self.answered.iter().map(|request| {
            let (request, outcome) = (*request, UnknownRequest);
            CommandResult { request, outcome, state, detail: 0, device_time_us: None }.into()
        });
        same(&format!("in {state}, to unknown requests"), &wanted.collect::<Vec<_>>(), &answers)
    }
}

fn unknown_in(client: &mut Client, state: State) -> RuleResult {
    Unknown::of(client)?.exchange(client, state)?;
    equal("state afterwards", state, client.state)?;
    if state == Running {
        first_sample(client)?;
    }
    Ok(())
}

fn unknown_counted(client: &mut Client) -> RuleResult {
    let unknown = Unknown::of(client)?;
    client.running(&[])?;
    unknown.exchange(client, Running)?;
    // The markers after Start and after the requests, and Stop.
    let counts = line_report(&client.request(Stop {})?)?;
    equal("line report", counted(unknown.count + 3, 0, 0), counts)
}

/// Requires equal answers.
fn same(what: &str, wanted: &[DriveMessage], got: &[DriveMessage]) -> RuleResult {
    let place = (0..wanted.len().max(got.len())).find(|place| wanted.get(*place) != got.get(*place));
    let Some(place) = place else { return Ok(()) };
    let [wanted, got] = [wanted, got].map(|answers| answers.get(place).words());
    Err(broken(format!("{what}, answer {}: {wanted}", place + 1), got))
}

/// A request of each kind that every drive has, in an order in which it has an effect.
fn conversation(client: &Client) -> Result<Vec<HostMessage>, Failure> {
    let session = client.session;
    let watchdog = client.parameter(WATCHDOG_US)?;
    let value = in_type_of(watchdog, U32(LONG_WATCHDOG_US));
    Ok(vec![
        other(session),
        hello(session).into(),
        DescribeParameter { index: 0 }.into(),
        DescribeLaw { index: 0 }.into(),
        SetParameter { index: watchdog.index, value }.into(),
        GetParameter { index: watchdog.index }.into(),
        Subscribe { signals: 0, every: 0 }.into(),
        Arm { session }.into(),
        Start { session }.into(),
        sample(0).into(),
        sample(1).into(),
        Stop {}.into(),
        EmergencyStop {}.into(),
        ClearFault {}.into(),
        Reset {}.into(),
    ])
}

/// The answers to a conversation whose bodies have this many bytes beyond their end.
fn answers_to_longer(client: &mut Client, beyond: usize) -> Result<Vec<DriveMessage>, Failure> {
    client.reset()?;
    let mut all = Vec::new();
    for request in conversation(client)? {
        let mut body = damage::body(&client.frame(request));
        let length = (body.len() + beyond).min(MAX_BODY);
        body.resize(length, 0xa5);
        let mut answers = client.request_bytes(&framed(&body))?;
        answers.iter_mut().for_each(forget_time);
        all.extend(answers);
    }
    Ok(all)
}

fn longer(client: &mut Client) -> RuleResult {
    let usual = answers_to_longer(client, 0)?;
    for beyond in BEYOND {
        let answers = answers_to_longer(client, beyond)?;
        same(&format!("with up to {beyond} bytes beyond the end of each body"), &usual, &answers)?;
    }
    Ok(())
}

fn minor(client: &mut Client) -> RuleResult {
    for minor_version in [0, MINOR_VERSION.wrapping_add(1), 1 << 7, u8::MAX] {
        client.reset()?;
        let request = Hello { minor_version, ..hello(client.session) };
        let what = format!("to Hello of minor version {minor_version}");
        let it = identity(&of_kinds(&what, &["Identity"], client.request(request)?)?)?;
        let wanted = (client.session, client.identity.minor_version, Idle);
        let got = (it.session, it.minor_version, it.state);
        equal(&format!("{what}: session, minor version, state"), wanted, got)?;
        let mut body = damage::body(&client.frame(request));
        body.push(0x5a);
        let what = format!("{what} with a further byte");
        of_kinds(&what, &["Identity"], client.request_bytes(&framed(&body))?)?;
        let answers = client.request(Hello { minor_version, ..of_version(0, client.session) })?;
        equal("to Hello of version 0", vec!["Identity", "CommandResult"], names(&answers))?;
    }
    Ok(())
}

/// A list whose values the drive names: its parameter, what it lists, and the names of the page.
type List = (u8, &'static str, Vec<(u8, &'static str)>);

fn lists() -> [List; 5] {
    let of_host = HostMessage::LAYOUTS.iter().map(|it| (it.kind, it.name));
    let kinds = of_host.chain(DriveMessage::LAYOUTS.iter().map(|it| (it.kind, it.name)));
    [
        (STATE_NAMES, "state", State::LIST.values.to_vec()),
        (OUTCOME_NAMES, "outcome", Outcome::LIST.values.to_vec()),
        (FAULT_NAMES, "fault code", FaultCode::LIST.values.to_vec()),
        (FLAG_NAMES, "torque flag", TorqueFlags::SET.flags.to_vec()),
        (KIND_NAMES, "kind", kinds.collect()),
    ]
}

pub(super) fn has_names(client: &mut Client) -> RuleResult {
    use FaultCode::{LoadEncoderLost, MotorEncoderLost, PowerStage, TickOverrun};

    let has = |capability| client.identity.capabilities.contains(capability);
    let taken = HostMessage::LAYOUTS.iter().map(|it| it.kind).filter(|kind| match *kind {
        kind if kind == Reference::LAYOUT.kind => has(Capabilities::BENCH_MODE),
        kind if kind == EnterLoader::LAYOUT.kind => has(Capabilities::LOADER),
        kind if kind == SetZero::LAYOUT.kind => has(Capabilities::BENCH_MODE),
        kind if [
            StoreParameters::LAYOUT.kind,
            RecallParameters::LAYOUT.kind,
            ForgetParameters::LAYOUT.kind,
        ]
        .contains(&kind) =>
        {
            has(Capabilities::STORE)
        }
        kind if [Capture::LAYOUT.kind, ReadCapture::LAYOUT.kind].contains(&kind) => {
            has(Capabilities::CAPTURE)
        }
        _ => true,
    });
    let mut taken: Vec<_> = taken.map(|kind| (KIND_NAMES, kind)).collect();
    if has(Capabilities::BENCH_MODE) {
        let faults = [PowerStage, MotorEncoderLost, LoadEncoderLost, TickOverrun];
        taken.extend(faults.map(|code| (FAULT_NAMES, code.byte())));
        let refusals = [PowerStageFault, EncoderImplausible];
        taken.extend(refusals.map(|outcome| (OUTCOME_NAMES, outcome.byte())));
    }
    for (capability, outcome) in
        [(Capabilities::STORE, Outcome::StoreFailed), (Capabilities::CAPTURE, Outcome::NotCaptured)]
    {
        taken.extend(has(capability).then_some((OUTCOME_NAMES, outcome.byte())));
    }
    if has(Capabilities::CAPTURE) {
        taken.push((KIND_NAMES, CaptureRows::LAYOUT.kind));
    }
    client.arrivals.seen.extend(taken);
    for (parameter, what, of_page) in lists() {
        let seen: Vec<u8> =
            client.arrivals.seen.iter().filter(|(list, _)| *list == parameter).map(|it| it.1).collect();
        let all: Vec<u8> = seen.iter().copied().chain(of_page.iter().map(|it| it.0)).collect();
        let requests: Vec<HostMessage> =
            all.iter().map(|choice| DescribeChoice { parameter, choice: *choice }.into()).collect();
        let answers = client.answers(&requests)?;
        for (value, answer) in all.into_iter().zip(&answers) {
            let wanted = of_page.iter().find(|it| it.0 == value).map(|it| it.1);
            let fits = match answer {
                DriveMessage::ChoiceDescription(it) => {
                    let name = it.name.as_str();
                    let is_named = wanted.map_or(!name.is_empty(), |wanted| wanted == name);
                    is_named && (it.parameter, it.choice) == (parameter, value)
                }
                // A value of the page that this drive does not have.
                DriveMessage::CommandResult(it) => !seen.contains(&value) && it.outcome == UnknownIndex,
                _ => false,
            };
            let name = wanted.unwrap_or("a name");
            expect(fits, format!("{what} {value:#04x}: {name}, choice {value} of {parameter}"), answer)?;
        }
    }
    Ok(())
}

/// 0 is in no list, and no side has the kinds 0 and 0x80. Of two bytes without a name a drive may have one.
fn no_names(client: &mut Client) -> RuleResult {
    client.in_states(State::ALL, |client, state| {
        let lists = [STATE_NAMES, OUTCOME_NAMES, FAULT_NAMES, FLAG_NAMES, KIND_NAMES];
        let none = lists.map(|list| (list, 0)).into_iter().chain([(KIND_NAMES, 0x80)]);
        let unknown =
            none.map(|(parameter, choice)| result(DescribeChoice { parameter, choice }, UnknownIndex, state));
        client.exchange(&format!("in {state}"), &unknown.collect::<Vec<_>>())?;
        let pairs = lists.iter().flat_map(|list| [0x5b, 0xb6].map(|choice| (*list, choice)));
        let requests: Vec<_> =
            pairs.map(|(parameter, choice)| DescribeChoice { parameter, choice }.into()).collect();
        let answers = client.answers(&requests)?;
        let has_one = names(&answers).chunks(2).all(|pair| pair.contains(&"CommandResult"));
        expect(has_one, "UnknownIndex for one of two values without a name", answers.as_slice())
    })
}
