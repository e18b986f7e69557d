//! State transitions: every request in every state.

use lashloop_protocol::enums::{Outcome, State};
use lashloop_protocol::message::{Arm, ClearFault, EmergencyStop, Reset, Start, Stop};
use lashloop_protocol::{HostMessage, Message};

use super::assertion::equal;
use super::check::{Check, check};

/// Required reaction to a request.
#[derive(Clone, Copy)]
enum Reaction {
    To(State),
    Refused(Outcome),
}

use Reaction::{Refused, To};
use State::{Armed, Boot, Faulted, Idle, Running};

const REQUESTS: [fn(u32) -> HostMessage; 6] = [
    |session| Arm { session }.into(),
    |session| Start { session }.into(),
    |_| Stop {}.into(),
    |_| EmergencyStop {}.into(),
    |_| ClearFault {}.into(),
    |_| Reset {}.into(),
];

const WRONG: Reaction = Refused(Outcome::WrongState);
const STALE: Reaction = Refused(Outcome::WrongSession);

/// The columns are [`REQUESTS`].
const TABLE: [(State, [Reaction; REQUESTS.len()]); 5] = [
    (Boot, [STALE, STALE, WRONG, To(Faulted), WRONG, To(Boot)]),
    (Idle, [To(Armed), WRONG, To(Idle), To(Faulted), WRONG, To(Boot)]),
    (Armed, [WRONG, To(Running), To(Idle), To(Faulted), WRONG, To(Boot)]),
    (Running, [WRONG, WRONG, To(Idle), To(Faulted), WRONG, To(Boot)]),
    (Faulted, [WRONG, WRONG, WRONG, To(Faulted), To(Idle), To(Boot)]),
];

pub(super) fn checks() -> Vec<Check> {
    let table = TABLE.iter().flat_map(|(state, row)| {
        REQUESTS.iter().zip(row).map(|(request, reaction)| transition(*state, *request, *reaction))
    });
    table.chain(sessions()).collect()
}

fn transition(state: State, request: fn(u32) -> HostMessage, reaction: Reaction) -> Check {
    let name = request(0).layout().name;
    let (name, expected) = match reaction {
        To(to) => (format!("{name} leads from {state:?} to {to:?}"), (Outcome::Accepted, to)),
        Refused(outcome) => (format!("{name} is refused in {state:?} as {outcome:?}"), (outcome, state)),
    };
    check("R6", name, move |client| {
        client.enter(state)?;
        let got = client.command(request(client.session))?;
        equal("outcome and state", expected, got)?;
        equal("state afterwards", expected.1, client.state)
    })
}

fn sessions() -> Vec<Check> {
    vec![
        check("R6", "Arm of another session is refused", |client| {
            client.idle()?;
            let got = client.command(Arm { session: client.session ^ 1 })?;
            equal("Arm", (Outcome::WrongSession, Idle), got)
        }),
        check("R6", "Start of another session is refused", |client| {
            client.armed()?;
            let session = client.session ^ 1;
            equal("Start", (Outcome::WrongSession, Armed), client.command(Start { session })?)
        }),
        check("R6", "a new session makes the previous one stale", |client| {
            client.idle()?;
            client.handshake(client.session ^ 1)?;
            let session = client.session;
            equal("Arm", (Outcome::WrongSession, Idle), client.command(Arm { session })?)
        }),
        check("R6", "a fault cleared before the handshake leads back to Boot", |client| {
            client.request(EmergencyStop {})?;
            equal("ClearFault", (Outcome::Accepted, Boot), client.command(ClearFault {})?)
        }),
    ]
}
