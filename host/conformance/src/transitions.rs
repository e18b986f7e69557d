//! State transitions: every request in every state. Those of parameters and descriptions have groups of their own.

use super::{constancy, repetition};
use crate::prelude::checks::*;

use Reaction::{Refused, To};

/// Required reaction to a request.
#[derive(Clone, Copy)]
enum Reaction {
    To(State),
    Refused(Outcome),
}

const WRONG: Reaction = Refused(WrongState);
const STALE: Reaction = Refused(WrongSession);
const OTHER: Reaction = Refused(VersionMismatch);

/// A row of the table of states.
struct Row {
    /// The row as a sentence.
    name: &'static str,
    request: fn(u32) -> HostMessage,
    /// Names of the answers; the report of a latched fault follows an `Identity`.
    answers: &'static [&'static str],
    /// In the order of [`State::ALL`].
    reactions: [Reaction; 5],
}

const RESULT: &[&str] = &["CommandResult"];

const ROWS: [Row; 12] = [
    Row {
        name: "Hello of another session leads to Idle, and leaves Faulted",
        request: |session| hello(session ^ 1).into(),
        answers: &["Identity"],
        reactions: [To(Idle), To(Idle), To(Idle), To(Idle), To(Faulted)],
    },
    Row {
        name: "Hello of the same session ends Boot, and leaves every other state",
        request: |session| hello(session).into(),
        answers: &["Identity"],
        reactions: [To(Idle), To(Idle), To(Armed), To(Running), To(Faulted)],
    },
    Row {
        name: "Hello of another version is refused as VersionMismatch in every state",
        request: |session| other(session ^ 1),
        answers: &["Identity", "CommandResult"],
        reactions: [OTHER; 5],
    },
    Row {
        name: "Arm leads from Idle to Armed, and is refused in every other state",
        request: |session| Arm { session }.into(),
        answers: RESULT,
        reactions: [STALE, To(Armed), WRONG, WRONG, WRONG],
    },
    Row {
        name: "Arm of another session is refused as WrongSession in every state",
        request: |session| Arm { session: session ^ 1 }.into(),
        answers: RESULT,
        reactions: [STALE; 5],
    },
    Row {
        name: "Start leads from Armed to Running, and is refused in every other state",
        request: |session| Start { session }.into(),
        answers: RESULT,
        reactions: [STALE, WRONG, To(Running), WRONG, WRONG],
    },
    Row {
        name: "Start of another session is refused as WrongSession in every state",
        request: |session| Start { session: session ^ 1 }.into(),
        answers: RESULT,
        reactions: [STALE; 5],
    },
    Row {
        name: "Stop leads from Idle, Armed and Running to Idle, and is refused in Boot and Faulted",
        request: |_| Stop {}.into(),
        answers: &["LineReport", "CommandResult"],
        reactions: [WRONG, To(Idle), To(Idle), To(Idle), WRONG],
    },
    Row {
        name: "EmergencyStop leads from every state to Faulted",
        request: |_| EmergencyStop {}.into(),
        answers: &["FaultReport", "CommandResult"],
        reactions: [To(Faulted); 5],
    },
    Row {
        name: "ClearFault leads from Faulted to Idle, and is refused in every other state",
        request: |_| ClearFault {}.into(),
        answers: RESULT,
        reactions: [WRONG, WRONG, WRONG, WRONG, To(Idle)],
    },
    Row {
        name: "Reset leads from every state to Boot",
        request: |_| Reset {}.into(),
        answers: RESULT,
        reactions: [To(Boot); 5],
    },
    Row {
        name: "Subscribe is accepted in Idle, Armed and Running, and refused in Boot and Faulted",
        request: |_| Subscribe { signals: 0, every: 0 }.into(),
        answers: RESULT,
        reactions: [WRONG, To(Idle), To(Armed), To(Running), WRONG],
    },
];

pub(super) fn checks() -> Vec<Check> {
    let rows = ROWS.into_iter().map(|row| {
        check("R4.1 R4.7 R5.3 R6.1 R6.2 R6.3 R12.5", row.name, move |client| {
            for (state, reaction) in State::ALL.iter().zip(row.reactions) {
                client.in_states(&[*state], |client, state| cell(client, &row, state, reaction))?;
            }
            Ok(())
        })
    });
    rows.chain(constancy::checks()).chain(repetition::checks()).collect()
}

fn cell(client: &mut Client, row: &Row, state: State, reaction: Reaction) -> RuleResult {
    let (wanted, after) = match reaction {
        To(to) => (Accepted, to),
        Refused(outcome) => (outcome, state),
    };
    let request = (row.request)(client.session);
    let mut kinds = row.answers.to_vec();
    if kinds[0] == "Identity" && state == Faulted {
        kinds.insert(1, "FaultReport");
    }
    let answers = of_kinds(&format!("in {state:?}, answers"), &kinds, client.request(request)?)?;
    for answer in &answers {
        let got = match answer {
            DriveMessage::Identity(it) => {
                equal(
                    &format!("in {state:?}, session of the Identity"),
                    Hello::try_from(&request).ok().map(|it| it.session),
                    Some(it.session),
                )?;
                (wanted, it.state)
            }
            DriveMessage::CommandResult(it) => {
                equal(&format!("in {state:?}, detail"), 0, it.detail)?;
                (it.outcome, it.state)
            }
            _ => continue,
        };
        equal(&format!("in {state:?}, outcome and state"), (wanted, after), got)?;
    }
    equal(&format!("after the request in {state:?}, state"), after, client.state)?;
    shown(client, &format!("after the request in {state:?}"), after)
}

/// Requires that a sample is answered as in this state: the state is not only reported.
fn shown(client: &mut Client, when: &str, state: State) -> RuleResult {
    let answers = client.sample(0)?;
    if state == Boot {
        equal(&format!("{when}, to a sample"), vec!["CommandResult"], names(&answers))?;
        return equal(&format!("{when}, to a sample"), WrongState, outcome::<EncoderSample>(&answers)?);
    }
    let answer = torque(&answers)?;
    equal(&format!("{when}, to a sample, state"), state, answer.status.state)?;
    if state == Running {
        let flags = answer.status.flags - TorqueFlags::SATURATED;
        return equal(&format!("{when}, to a first sample"), NONE, flags);
    }
    expect(answer.torque_nm == 0.0, format!("{when}, to a sample, torque 0 N m"), answer.torque_nm)
}
