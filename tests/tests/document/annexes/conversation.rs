//! The conversation of the annex, held by the drive, and a few requests of other versions.

use std::cell::Cell;
use std::time::Duration;

use lashloop_firmware::drive::{Clock, Drive, ManualClock};
use lashloop_protocol::enums::{ParameterValue, Version};
use lashloop_protocol::hex::Hex;
use lashloop_protocol::limits::FAULT_NAMES;
use lashloop_protocol::message::{
    Arm, DescribeChoice, DescribeLaw, DescribeParameter, DescribeSignal, EncoderSample, GetParameter, Hello,
    Identity, SetParameter, Start, Stop, Subscribe,
};
use lashloop_protocol::parameter_names::CONTROLLER;
use lashloop_protocol::{
    Decoder, DriveMessage, EncoderCounts, Frame, HostMessage, Message, Numbered, crc, frame,
};

use crate::data_sheet::numbered_sheet;
use crate::host::{index, signals};

/// The four bytes read `HSAL`.
const SESSION: u32 = 0x4c41_5348;

/// Advance of the clock at each reading.
const STEP: Duration = Duration::from_nanos(5_700);

/// The build that the annex shows.
const FIRMWARE: Version = Version { major: 0, minor: 1, patch: 0 };
const BUILD_ID: u32 = 0x00c0_ffee;

/// The signals of the subscription.
const SIGNALS: [&str; 6] = [
    "requested_torque_nm",
    "dead_zone_estimate_rad",
    "disturbing_torque_estimate_nm",
    "load_error_rad",
    "motor_error_rad",
    "elastic_error_nm",
];

struct Stepping(Cell<Duration>);

impl Clock for Stepping {
    fn now(&self) -> Duration {
        self.0.replace(self.0.get() + STEP)
    }
}

/// A request and its answers, with their numbers.
pub struct Exchange {
    pub request: Numbered<HostMessage>,
    answers: Vec<Numbered<DriveMessage>>,
}

#[cfg(test)]
impl Exchange {
    /// The frames of the request and of its answers.
    pub fn frames(&self) -> Vec<Vec<u8>> {
        let request = self.request.message.numbered_frame(self.request.number).to_vec();
        let answers = self.answers.iter().map(|it| it.message.numbered_frame(it.number).to_vec());
        [request].into_iter().chain(answers).collect()
    }
}

fn sample(sequence: u16, motor: i64, load: i64) -> HostMessage {
    let [motor_counts, load_counts] = [motor, load].map(EncoderCounts::wrapping);
    EncoderSample { sequence, motor_counts, load_counts, reference_rad: 0.0 }.into()
}

fn requests() -> [HostMessage; 12] {
    let limit = index("torque_limit_nm");
    let load_error = signals(&["load_error_rad"]).trailing_zeros() as u8;
    [
        Hello::new(SESSION).into(),
        DescribeLaw { index: 0 }.into(),
        DescribeSignal { index: load_error }.into(),
        DescribeParameter { index: limit }.into(),
        DescribeChoice { parameter: index(CONTROLLER), choice: 1 }.into(),
        SetParameter { index: limit, value: ParameterValue::F32(25.0) }.into(),
        Subscribe { signals: signals(&SIGNALS), every: 10 }.into(),
        Arm { session: SESSION }.into(),
        Start { session: SESSION }.into(),
        sample(0, 98_304, 32_768),
        sample(1, 98_104, 32_766),
        Stop {}.into(),
    ]
}

/// The message as a drive of the annex's build sends it.
fn of_the_build(answer: Numbered<DriveMessage>) -> Numbered<DriveMessage> {
    answer.map(|message| match message {
        DriveMessage::Identity(it) => {
            Identity { firmware: FIRMWARE, build_id: BUILD_ID, dirty: 0, ..it }.into()
        }
        other => other,
    })
}

/// The answers of a drive to bytes.
fn answers(drive: &mut Drive, bytes: &[u8], clock: &impl Clock) -> Vec<Numbered<DriveMessage>> {
    assert_eq!(drive.receive(bytes, clock), bytes.len());
    let (mut decoder, mut output) = (Decoder::new(), drive.output());
    let messages = std::iter::from_fn(|| decoder.next::<DriveMessage>(&mut output));
    let answers = messages.map(|it| of_the_build(it.expect("a good frame"))).collect();
    drive.clear_output();
    answers
}

/// Every request with its answers. Requests are numbered from 1.
pub fn conversation() -> Vec<Exchange> {
    let (mut drive, clock) = (Drive::new("stm32f405"), Stepping(Cell::default()));
    drive.receive(&[frame::DELIMITER], &clock);
    assert!(drive.output().is_empty(), "the drive does not answer a boundary byte");
    let mut last = 0;
    let exchange = |message: HostMessage| {
        let has_number = message.layout().has_number();
        last += u8::from(has_number);
        let number = if has_number { last } else { 0 };
        let answers = answers(&mut drive, &message.numbered_frame(number), &clock);
        Exchange { request: Numbered { number, message }, answers }
    };
    requests().into_iter().map(exchange).collect()
}

/// Name of the part with a request.
fn name_of(request: &HostMessage) -> String {
    match request {
        HostMessage::EncoderSample(it) => format!("EncoderSample {}", it.sequence),
        other => other.layout().name.to_owned(),
    }
}

fn fenced(text: &str) -> String {
    format!("```text\n{text}\n```")
}

fn sheet<M: Message>(it: &Numbered<M>) -> String {
    fenced(&numbered_sheet(it.number, &it.message))
}

/// The part of the annex with this name.
pub fn part(name: &str) -> Option<String> {
    match name {
        "first frame" => return Some(first_frame()),
        "other versions" => return Some(of_other_versions()),
        _ => {}
    }
    let exchange = conversation().into_iter().find(|it| name_of(&it.request.message) == name)?;
    let sheets = [sheet(&exchange.request)].into_iter().chain(exchange.answers.iter().map(sheet));
    Some(sheets.collect::<Vec<_>>().join("\n\n"))
}

/// Body, CRC and frame of the first request.
fn first_frame() -> String {
    let frame = HostMessage::from(Hello::new(SESSION)).numbered_frame(1);
    let mut stuffed = frame[..frame.len() - 1].to_vec();
    let body = frame::open(&mut stuffed).expect("an encoded frame is valid");
    let crc = crc::checksum(body);
    let with_crc = [body, &crc.to_le_bytes()].concat();
    fenced(&format!(
        "body      {:#}\nCRC       {crc:#010x}\nwith CRC  {:#}\nframe     {:#}",
        Hex(body),
        Hex(&with_crc),
        Hex(&frame)
    ))
}

/// Requests that a newer host may send to an idle drive, and their answers.
fn of_other_versions() -> String {
    let mut longer = vec![HostMessage::from(GetParameter { index: 0 }).layout().kind, 8, 0];
    longer.extend([0xa5; 2]);
    let name = DescribeChoice { parameter: FAULT_NAMES, choice: 1 };
    let name = HostMessage::from(name).numbered_frame(9);
    let cases = [
        ("unknown kind 0x42, number 7", Frame::around(&[0x42, 7, 1, 2, 3])),
        ("unknown kind 0x42 alone, no number", Frame::around(&[0x42])),
        ("unknown kind 0x1f", Frame::around(&[0x1f, 1, 2, 3])),
        ("`GetParameter` with two further bytes", Frame::around(&longer)),
        ("`DescribeChoice` of `FAULT_NAMES`, byte 1", name),
    ];
    let mut drive = Drive::new("stm32f405");
    // Time stands still, and the session is open.
    let clock = ManualClock::default();
    answers(&mut drive, &HostMessage::from(Hello::new(SESSION)).frame(), &clock);
    let rows = cases.map(|(what, request)| {
        let answer = match answers(&mut drive, &request, &clock)[..] {
            [] => "none".to_owned(),
            [it] => {
                let frame = it.message.numbered_frame(it.number);
                format!("`{}`: `{:#}`", it.message.layout().name, Hex(&frame))
            }
            ref other => panic!("{other:?}"),
        };
        format!("| {what} | `{:#}` | {answer} |", Hex(&request))
    });
    format!("| request | frame | answer |\n|---|---|---|\n{}", rows.join("\n"))
}
