//! The torques and the telemetry of bench mode are those of HIL mode.

use super::super::answers::report as find_report;
use super::super::parameters::another;
use super::super::telemetry::subscription::law_signals;
use super::run::{Run, Timing, allowed, in_turn, limit_torque};
use crate::prelude::checks::*;

/// Directions of encoders and power stage.
const MIRRORED: [&str; 3] = ["motor_direction", "load_direction", "torque_direction"];
/// Steps that are compared, and those of them before something happens.
const STEPS: usize = 60;
const BEFORE: usize = 20;
/// Steps between two messages of telemetry, so that the line has room for them.
const EVERY: u16 = 10;
/// A reference that is far from all others, in rad.
const FAR_RAD: f32 = -3.0;
/// A reference that no other one is equal to, near enough for no fault.
const OTHER_RAD: f32 = -0.3;
/// Steps by which a live value may be in force later than from the one after the last report: one step may be on its way, and the
/// report of another one.
const LATEST_CHANGE: u16 = 2;
/// Live parameters that are tried at most.
const MOST_LIVE: usize = 8;

pub(super) fn checks() -> Vec<Check> {
    vec![
        allowed(
            "R18.1 R18.2 R18.9",
            "equal counts and references give the torques and telemetry of HIL mode, limited and reversed too",
            same_torques,
        ),
        allowed("R18.1", "every law gives the torques and telemetry of HIL mode", every_law),
        allowed(
            "R18.1 R18.7",
            "a Reference with the number of the one before counts, as its value does in HIL mode",
            same_number,
        ),
        allowed("R9.5 R18.1", "a live value counts from the next step, as in HIL mode", live_value),
    ]
}

fn same_torques(client: &mut Client) -> RuleResult {
    let law = client.default_law();
    let largest_nm = Conditions { law, settings: &[], change: None }.compare(client)?;
    if largest_nm != 0.0 {
        client.reset()?;
        let limit_nm = nearest_real(client.parameter(TORQUE_LIMIT_NM)?, largest_nm / 2.0)?;
        let settings = &[(TORQUE_LIMIT_NM, F32(limit_nm))];
        Conditions { law, settings, change: None }.compare(client)?;
    }
    client.reset()?;
    // Both encoders and the power stage: the same machine, seen from the other end.
    let settings = &MIRRORED.map(|name| (name, U32(1)));
    Conditions { law, settings, change: None }.compare(client).map(drop)
}

fn every_law(client: &mut Client) -> RuleResult {
    if client.parameter(CONTROLLER).is_err() {
        return skip("the drive has one law");
    }
    for law in client.description.laws.clone() {
        client.reset()?;
        let settings = &[(CONTROLLER, U32(law.index.into()))];
        Conditions { law: law.index, settings, change: None }.compare(client)?;
    }
    Ok(())
}

/// The first live parameter that changes the torques in HIL mode.
fn live_value(client: &mut Client) -> RuleResult {
    let law = client.default_law();
    let live = client.description.parameters.iter().filter(|it| it.live && it.laws.contains(law));
    let live: Vec<_> = live.map(|it| SetParameter { index: it.index, value: another(it) }).collect();
    for live in live.into_iter().take(MOST_LIVE) {
        client.reset()?;
        let it = Conditions { law, settings: &[], change: Some(Change::Live(live)) };
        if it.compare_change(client)? {
            return Ok(());
        }
    }
    skip("the law in force has no live parameter that changes its torques")
}

fn same_number(client: &mut Client) -> RuleResult {
    let change = Some(Change::Reference(OTHER_RAD));
    if (Conditions { law: client.default_law(), settings: &[], change }).compare_change(client)? {
        return Ok(());
    }
    skip("the law in force has the same torques at another reference")
}

/// What a run in bench mode and its repetition in HIL mode have in common.
struct Conditions<'a> {
    law: u8,
    settings: &'a [Setting],
    /// What changes after some steps.
    change: Option<Change>,
}

/// A change during a run.
#[derive(Clone, Copy)]
enum Change {
    /// A value that is set.
    Live(SetParameter),
    /// Another reference under the number of the one before.
    Reference(f32),
}

/// The steps of a run.
struct Steps {
    samples: Vec<EncoderSample>,
    torques: Vec<(Bits, TorqueFlags)>,
    telemetry: Vec<Telemetry>,
}

/// Requires the torques and flags of HIL mode.
fn same(pins: &Steps, link: &Steps) -> RuleResult {
    for ((sample, link), pins) in pins.samples.iter().zip(&link.torques).zip(&pins.torques) {
        let what = format!("torque in N m and flags of step {}, as in HIL mode,", sample.sequence);
        equal(&what, link, pins)?;
    }
    Ok(())
}

impl Conditions<'_> {
    /// The drive itself in HIL mode is the reference: its own counts and references as samples. Returns the largest torque in N m.
    fn compare(&self, client: &mut Client) -> Result<f32, Failure> {
        let (pins, _) = self.run_on_pins(client)?;
        let link = self.run_on_link(client, &pins.samples, None)?;
        same(&pins, &link)?;
        if link.telemetry != pins.telemetry {
            let again = self.run_on_link(client, &pins.samples, None)?;
            self.compare_telemetry(client, &pins.telemetry, [&link.telemetry, &again.telemetry])?;
        }
        let sizes = pins.torques.iter().map(|(Bits(bits), _)| f32::from_bits(*bits).abs());
        Ok(sizes.fold(0.0, f32::max))
    }

    /// Requires the torques of HIL mode with this change. Returns whether it changes them there.
    fn compare_change(&self, client: &mut Client) -> Result<bool, Failure> {
        let (pins, changed) = self.run_on_pins(client)?;
        let without = self.run_on_link(client, &pins.samples, None)?;
        let mut with = self.run_on_link(client, &pins.samples, changed)?;
        if with.torques == without.torques {
            return Ok(false);
        }
        for later in 1..=LATEST_CHANGE {
            if with.torques == pins.torques {
                break;
            }
            with = self.run_on_link(client, &pins.samples, changed.map(|it| it.wrapping_add(later)))?;
        }
        same(&pins, &with)?;
        Ok(true)
    }

    /// Counts, references, torques and telemetry of steps, and the step from which the live value may be in force.
    fn run_on_pins(&self, client: &mut Client) -> Result<(Steps, Option<u16>), Failure> {
        let timing = Timing::of_each(client, self.settings)?;
        let subscription = self.subscription(client);
        let mut run = Run::start_with(client, timing, self.settings, subscription)?;
        // With all bits of its fraction.
        let reference_rad = |turn: u16| 0.251_234_57 * f32::from(turn % 5);
        let (mut messages, mut sent) = run.until(BEFORE, is::<BenchSample>, reference_rad)?;
        let zero = Default::default();
        let refused =
            EncoderSample { sequence: 0, motor_counts: zero, load_counts: zero, reference_rad: FAR_RAD };
        messages.extend(run.client.request(refused)?);
        // What isn't live is as fixed as in HIL mode.
        let fixed = run.client.parameter(PERIOD_US)?;
        let fixed = SetParameter { index: fixed.index, value: fixed.default };
        let answers = run.client.request(fixed)?;
        let it = find_report(fixed.index, &answers)?;
        equal("SetParameter period_us in Running", WrongState, it.outcome)?;
        messages.extend(answers);
        for name in MIRRORED.iter().filter(|_| self.settings.is_empty() && self.change.is_none()) {
            let it = run.client.parameter(name)?;
            let (index, get) = (it.index, GetParameter { index: it.index });
            let request = SetParameter { index, value: another(it) };
            let described = run.client.request(DescribeParameter { index })?;
            let is_described = described.iter().any(is::<ParameterDescription>);
            expect(is_described, "a ParameterDescription in Running", described.words())?;
            messages.extend(described);
            for answers in [run.client.request(request)?, run.client.request(get)?] {
                let it = find_report(index, &answers)?;
                let what = format!("{name} in force, refused in Running");
                equal(&what, U32(0), it.value)?;
                messages.extend(answers);
            }
        }
        messages.extend(run.turn()?);
        if let Some(Change::Live(live)) = self.change {
            let answers = run.client.request_until(live, is::<ParameterReport>)?;
            let it = find_report(live.index, &answers)?;
            let wanted = (Accepted, live.value);
            equal("SetParameter of a live value in Running", wanted, (it.outcome, it.value))?;
            messages.extend(answers);
        }
        let latest = |messages: &[DriveMessage]| messages.iter().filter_map(of::<BenchSample>).next_back();
        let mut last = latest(&messages);
        if let Some(Change::Reference(reference_rad)) = self.change {
            messages.extend(run.refer_again(reference_rad)?);
            last = latest(&messages);
            messages.extend(run.listen(run.pause())?);
        }
        let changed = last.map(|it| it.sequence.wrapping_add(1));
        // None of the references before.
        let (later, sent_later) =
            run.until(STEPS - BEFORE, is::<BenchSample>, |turn| 0.1 + reference_rad(turn))?;
        messages.extend(later);
        sent.extend(sent_later);
        let reports: Vec<_> = messages.iter().filter_map(of::<BenchSample>).collect();
        in_turn(&reports, 1)?;
        let sample = |it: &BenchSample| {
            let of_step = sent.iter().find(|(number, _)| *number == it.reference_number);
            let Some((_, reference_rad)) = of_step else {
                return Err(broken("the number of a Reference that was sent", it.reference_number.words()));
            };
            let BenchSample { sequence, motor_counts, load_counts, .. } = *it;
            Ok(EncoderSample { sequence, motor_counts, load_counts, reference_rad: *reference_rad })
        };
        let samples = reports.iter().map(sample).collect::<Result<_, _>>()?;
        let torques = reports.iter().map(|it| (Bits(it.torque_nm.to_bits()), it.status.flags)).collect();
        let telemetry = messages.iter().filter_map(of::<Telemetry>).collect();
        Ok((Steps { samples, torques, telemetry }, changed))
    }

    /// These samples in HIL mode, with the live value from one of them on.
    fn run_on_link(
        &self,
        client: &mut Client,
        samples: &[EncoderSample],
        changed: Option<u16>,
    ) -> Result<Steps, Failure> {
        client.reset()?;
        client.idle()?;
        if let Some(subscription) = self.subscription(client) {
            let state = client.state;
            client.exchange("in Idle", &[result(subscription, Accepted, state)])?;
        }
        limit_torque(client)?;
        client.running(self.settings)?;
        let mut steps = Steps { samples: samples.to_vec(), torques: Vec::new(), telemetry: Vec::new() };
        // The reference whose number the change has.
        let before = changed.and_then(|changed| samples.iter().find(|it| it.sequence == changed));
        let before = before.map(|it| it.reference_rad);
        for sample in samples {
            let mut sample = *sample;
            match self.change {
                Some(Change::Live(live)) if changed == Some(sample.sequence) => {
                    client.set(live.index, live.value)?;
                }
                Some(Change::Reference(reference_rad))
                    if changed.is_some_and(|changed| sample.sequence >= changed)
                        && before == Some(sample.reference_rad) =>
                {
                    sample.reference_rad = reference_rad;
                }
                _ => {}
            }
            let answers = client.request(sample)?;
            let answer = torque(&answers)?;
            steps.torques.push((Bits(answer.torque_nm.to_bits()), answer.status.flags));
            steps.telemetry.extend(answers.iter().filter_map(of::<Telemetry>));
        }
        Ok(steps)
    }

    /// To signals of the law, if it has any.
    fn subscription(&self, client: &Client) -> Option<Subscribe> {
        let signals = self.signals(client).into_iter().fold(0, |all, index| all | 1 << index);
        (signals != 0).then_some(Subscribe { signals, every: EVERY })
    }

    fn signals(&self, client: &Client) -> Vec<u8> {
        law_signals(client, self.law).into_iter().take(MAX_TELEMETRY_VALUES).collect()
    }

    /// Compares the signals that depend on the samples alone: each run on the link has the same values, none of which is equal to
    /// the next. A measured time is not among them.
    fn compare_telemetry(
        &self,
        client: &Client,
        pins: &[Telemetry],
        [link, again]: [&[Telemetry]; 2],
    ) -> RuleResult {
        let bits = |of: &[Telemetry], place: usize| -> Vec<Option<u32>> {
            let of_step = |pins: &Telemetry| of.iter().find(|it| it.sequence == pins.sequence);
            let value = |it: &Telemetry| it.values.as_slice().get(place).map(|it| it.to_bits());
            pins.iter().map(|it| of_step(it).and_then(value)).collect()
        };
        for (place, index) in self.signals(client).into_iter().enumerate() {
            let (link, again) = (bits(link, place), bits(again, place));
            if link != again || link.windows(2).any(|pair| pair[0] == pair[1]) {
                continue;
            }
            for ((telemetry, link), pins) in pins.iter().zip(link).zip(bits(pins, place)) {
                let what = format!("signal {index} after step {}, as in HIL mode,", telemetry.sequence);
                equal(&what, link.map(Bits), pins.map(Bits))?;
            }
        }
        Ok(())
    }
}
