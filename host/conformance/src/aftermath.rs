//! What an earlier message or run must leave behind, and what it must not: stored answers, watchdogs, laws, sessions.

use super::safety::in_time;
use crate::prelude::checks::*;

/// A watchdog that trips soon.
const SHORT_US: u32 = 20_000;
/// Time in which a watchdog of [`SHORT_US`] would trip.
const QUIET: Duration = Duration::from_millis(80);
/// Signal with the torque of the law before its limit.
const REQUESTED: &str = "requested_torque_nm";

pub(super) fn checks() -> Vec<Check> {
    vec![
        check("R7.2 R7.17", "a sample after a gap makes a control step", step_after_gap),
        check("R7.3 R7.6", "a stray sample keeps the answer for a repetition", repetition_after_stray),
        check("R7.12", "a request that is infinite is a fault", infinite_request),
        check(
            "R8.4",
            "a report carries the last sample of a run that a new session has ended",
            last_sequence,
        ),
        in_time(check("R6.9 R8.5", "a run that has ended leaves no watchdog behind", no_watchdog)),
        check("R10.2 R11.8", "the law in force is that of the last Arm", law_in_force),
    ]
}

fn with_reference(sequence: u16, reference_rad: f32) -> EncoderSample {
    EncoderSample { reference_rad, ..sample(sequence) }
}

/// References of two runs, without and with gaps. Each changes the torque of most laws.
const REFERENCES_RAD: [f32; 4] = [1.0, -1.0, 1.0, -1.0];

/// A reference that changes the torque from one sample to the next must change it after a gap too.
fn step_after_gap(client: &mut Client) -> RuleResult {
    let setup = Setup::coarse(client)?;
    let mut runs_nm = [[0.0_f32; REFERENCES_RAD.len()]; 2];
    for (torques_nm, gap) in runs_nm.iter_mut().zip([1, 2]) {
        client.reset()?;
        setup.start(client)?;
        if setup.longest_gap() < 2 {
            return skip("not run: no encoder setting of this drive allows a gap");
        }
        let mut sequence = 0;
        for (torque_nm, reference_rad) in torques_nm.iter_mut().zip(REFERENCES_RAD) {
            let flags = if gap == 1 || sequence == 0 { NONE } else { TorqueFlags::GAP };
            *torque_nm = accepted(client, with_reference(sequence, reference_rad), flags)?.torque_nm;
            sequence += gap;
        }
    }
    let [steps_nm, gaps_nm] = runs_nm;
    for (step_nm, gap_nm) in steps_nm.windows(2).zip(gaps_nm.windows(2)) {
        let holds = step_nm[0] == step_nm[1] || gap_nm[0] != gap_nm[1];
        expect(holds, format!("after a gap another torque than {} N m", gap_nm[0]), gap_nm[1])?;
    }
    Ok(())
}

/// The last answer follows a gap where the encoders allow one, so that it has a flag of its own.
fn repetition_after_stray(client: &mut Client) -> RuleResult {
    let setup = Setup::coarse(client)?;
    setup.start(client)?;
    first_sample(client)?;
    let last = if setup.longest_gap() < 2 { 2 } else { 3 };
    for sequence in [1, last] {
        let flags = if sequence == 3 { TorqueFlags::GAP } else { NONE };
        let first = accepted(client, sample(sequence), flags)?;
        for stray in [sequence - 1, sequence ^ 1 << 15] {
            refused_sample(client, stray)?;
            let again = torque(&client.sample(sequence)?)?;
            let mut wanted = first;
            wanted.status.flags |= TorqueFlags::REPEATED;
            equal(&format!("to sample {sequence} again, after the stray {stray}"), wanted, again)?;
        }
    }
    Ok(())
}

/// The largest parameters and references that the drive takes.
fn infinite_request(client: &mut Client) -> RuleResult {
    let signal = client.description.signals.iter().find(|it| &*it.signal.name == REQUESTED);
    let signals = signal.map_or(0, |it| 1 << it.index);
    for reference_rad in [f32::MAX, f32::MIN] {
        client.reset()?;
        client.long_watchdog()?;
        for parameter in client.description.parameters.clone() {
            let is_of_the_law = !REQUIRED.iter().any(|name| *name == &*parameter.name);
            if is_of_the_law && matches!(parameter.max, F32(_)) {
                client.set(parameter.index, parameter.max)?;
            }
        }
        if client.command(Arm { session: client.session })? != (Accepted, Armed) {
            return skip("not run: the drive refuses its largest parameters");
        }
        client.start()?;
        client.request(Subscribe { signals, every: 1 })?;
        let answers = client.request(with_reference(0, reference_rad))?;
        if names(&answers).contains(&"FaultReport") {
            fault_answer(&answers, FaultCode::TorqueNotFinite)?;
            continue;
        }
        equal("state and torque", (Running, true), {
            let it = torque(&answers)?;
            (it.status.state, it.torque_nm.is_finite())
        })?;
        if answers.iter().any(is::<Telemetry>) {
            let requested_nm = telemetry(&answers)?.values.as_slice().first().copied().unwrap_or(0.0);
            let expected = format!("a fault, or a finite {REQUESTED}");
            expect(requested_nm.is_finite(), expected, format!("{requested_nm} N m in Running"))?;
        }
    }
    Ok(())
}

/// Sessions begin in `Running`, in `Idle` and in `Faulted`.
fn last_sequence(client: &mut Client) -> RuleResult {
    client.running(&[])?;
    for sequence in 0..4 {
        accepted(client, sample(sequence), NONE)?;
    }
    for session in [client.session ^ 1, client.session] {
        client.handshake(session)?;
        for _ in 0..2 {
            let it = fault(&client.request(EmergencyStop {})?)?;
            equal("sequence of the report in a new session", 3, it.sequence)?;
            client.handshake(session ^ 1 << 9)?;
            client.command(ClearFault {})?;
        }
    }
    client.idle()?;
    client.arm()?;
    let it = fault(&client.request(EmergencyStop {})?)?;
    equal("sequence of the report in Armed", 3, it.sequence)
}

/// The run and its end are one write where the drive takes it, so that a busy bench trips no watchdog in between.
fn no_watchdog(client: &mut Client) -> RuleResult {
    let session = client.session;
    let run = [Arm { session }.into(), Start { session }.into(), sample(0).into()];
    let ends = [
        (vec![Stop {}.into(), Arm { session }.into()], Armed),
        (vec![hello(session ^ 1).into(), Arm { session: session ^ 1 }.into()], Armed),
        (vec![EmergencyStop {}.into(), ClearFault {}.into(), Arm { session }.into()], Armed),
        (vec![Reset {}.into()], Boot),
    ];
    for (end, state) in ends {
        client.reset()?;
        client.idle()?;
        client.put("watchdog_us", U32(SHORT_US))?;
        let answers = client.burst(&[&run[..], &end].concat())?;
        if answers.iter().filter_map(of::<FaultReport>).any(|it| it.code == FaultCode::Watchdog) {
            // The drive itself was late, within the run.
            client.slowest = client.slowest.max(QUIET);
        }
        let news = client.wait_for(QUIET, of::<FaultReport>)?;
        expect(news.is_none(), format!("no FaultReport in {state:?} after a run"), news)?;
        client.request_bytes(&[])?;
        equal("state after a run that has ended", state, client.state)?;
    }
    Ok(())
}

/// A signal that one law has and another lacks shows the law that a drive goes by.
fn law_in_force(client: &mut Client) -> RuleResult {
    let laws = client.identity.law_count;
    let differing = client.description.signals.iter().find_map(|it| {
        let has = (0..laws).find(|law| it.laws.contains(*law))?;
        let lacks = (0..laws).find(|law| !it.laws.contains(*law))?;
        Some((1 << it.index, has, lacks))
    });
    let Some((signals, has, lacks)) = differing else {
        return skip("every law has every signal");
    };
    client.long_watchdog()?;
    for law in [has, lacks, has] {
        let expected = if law == has { Accepted } else { SignalOfOtherLaw };
        client.put(CONTROLLER, U32(law.into()))?;
        client.arm()?;
        for state in [Armed, Running] {
            if state == Running {
                client.start()?;
                first_sample(client)?;
            }
            let answers = client.request(Subscribe { signals, every: 0 })?;
            let what = format!("in {state:?} with law {law}, to Subscribe to {signals:#x}");
            equal(&what, expected, outcome::<Subscribe>(&answers)?)?;
        }
        client.request(Subscribe { signals: 0, every: 0 })?;
        client.command(Stop {})?;
    }
    Ok(())
}
