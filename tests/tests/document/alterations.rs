//! What arrives at a host instead of an answer of the drive, and at the drive instead of a request.

use lashloop_firmware::Laws;
use lashloop_firmware::law::LawSet;
use lashloop_protocol::enums::{LogLevel, Outcome, ParameterValue, State};
use lashloop_protocol::layout::FieldType;
use lashloop_protocol::message::{
    ChoiceDescription, CommandResult, DescribeChoice, DescribeParameter, GetParameter, Identity, Log,
    ParameterDescription, ParameterReport, SetParameter,
};
use lashloop_protocol::text::Text;
use lashloop_protocol::{DriveMessage, HostMessage, MAX_BODY, Message, Numbered, crc, frame};

pub type Request = Numbered<HostMessage>;
pub type Answer = Numbered<DriveMessage>;

/// A change to each answer of the drive: the bytes that arrive instead.
pub type Alteration = fn(Answer) -> Vec<u8>;

/// The frame of a message with its number.
pub fn frame_of<M: Message>(it: Numbered<M>) -> Vec<u8> {
    it.message.numbered_frame(it.number).to_vec()
}

pub fn unaltered(answer: Answer) -> Vec<u8> {
    frame_of(answer)
}

/// A frame around a body, by the three steps of the page.
pub fn frame_around(body: &[u8]) -> Vec<u8> {
    let with_crc = [body, &crc::checksum(body).to_le_bytes()].concat();
    let pieces: Vec<_> = with_crc.split(|byte| *byte == 0).collect();
    let stuffed = pieces.iter().flat_map(|piece| [&[piece.len() as u8 + 1], *piece].concat());
    stuffed.chain([0]).collect()
}

/// Messages that no request of these tests has asked for, then the answer.
pub fn with_others(answer: Answer) -> Vec<u8> {
    let (outcome, state, index) = (Outcome::WrongState, State::Faulted, 200);
    let value = ParameterValue::U32(7);
    let (detail, device_time_us) = (0, None);
    let others: [DriveMessage; 3] = [
        Log { level: LogLevel::Error, text: Text::new("stop the run now"), device_time_us }.into(),
        ParameterReport { index, outcome, value, state, detail, device_time_us }.into(),
        CommandResult { request: 0x70, outcome, state, detail, device_time_us }.into(),
    ];
    let others = others.into_iter().flat_map(|message| frame_of(answer.map(|_| message)));
    // Of a kind that this version lacks, and refused because its state is 0.
    let further = [&[0xfe, 1, 2, 3][..], &[0x85, answer.number, 0x06, 1, 0, 0, 0, 0, 0]];
    others.chain(further.into_iter().flat_map(frame_around)).chain(frame_of(answer)).collect()
}

/// A refusal of the same request under another number, then the answer.
pub fn with_a_late_refusal(answer: Answer) -> Vec<u8> {
    let (outcome, number) = (Outcome::WrongSession, answer.number.wrapping_sub(1));
    let late: DriveMessage = match answer.message {
        DriveMessage::CommandResult(it) => CommandResult { outcome, ..it }.into(),
        DriveMessage::ParameterReport(it) => {
            ParameterReport { outcome, value: ParameterValue::F32(0.125), ..it }.into()
        }
        _ => return frame_of(answer),
    };
    [frame_of(Numbered { number, message: late }), frame_of(answer)].concat()
}

/// The body of an answer.
fn body_of(answer: Answer) -> Vec<u8> {
    let mut stuffed = frame_of(answer);
    stuffed.pop();
    frame::open(&mut stuffed).expect("an encoded frame is valid").to_vec()
}

/// The answer with as many further fields as its frame holds.
pub fn longer(answer: Answer) -> Vec<u8> {
    let mut body = body_of(answer);
    if answer.message.layout().element_len.is_none() {
        body.resize(MAX_BODY, 0xa5);
    }
    frame_around(&body)
}

/// The answer, its body ending inside the optional field.
pub fn cut(answer: Answer) -> Vec<u8> {
    let mut body = body_of(answer);
    if let Some(last) = answer.message.layout().fields.last().filter(|field| field.optional) {
        body.truncate(last.offset + 2);
    }
    frame_around(&body)
}

/// The answer with a flag without a name.
pub fn flagged(answer: Answer) -> Vec<u8> {
    let mut body = body_of(answer);
    let flags = answer.message.layout().fields.iter();
    for field in flags.filter(|it| matches!(it.ty, FieldType::Flags(_) | FieldType::Status { .. })) {
        body[field.offset] |= 0x80;
    }
    frame_around(&body)
}

/// An identity of another session, in another state, before each identity.
pub fn with_a_stale_identity(answer: Answer) -> Vec<u8> {
    let stale = match answer.message {
        DriveMessage::Identity(it) => {
            let stale = Identity { session: it.session ^ 1, law_count: 9, ..it };
            frame_of(answer.map(|_| DriveMessage::from(stale)))
        }
        _ => Vec::new(),
    };
    [stale, frame_of(answer)].concat()
}

/// The index of another parameter: all of them in reverse order.
pub fn reversed(index: u8) -> u8 {
    (Laws::PARAMETERS.len() as u8).wrapping_sub(1 + index)
}

pub fn answers_reversed(answer: Answer) -> Vec<u8> {
    frame_of(answer.map(|answer| match answer {
        DriveMessage::ParameterDescription(it) => {
            ParameterDescription { index: reversed(it.index), ..it }.into()
        }
        DriveMessage::ParameterReport(it) => ParameterReport { index: reversed(it.index), ..it }.into(),
        DriveMessage::ChoiceDescription(it) => {
            ChoiceDescription { parameter: reversed(it.parameter), ..it }.into()
        }
        other => other,
    }))
}

pub fn requests_reversed(request: Request) -> Request {
    request.map(|request| match request {
        HostMessage::DescribeParameter(it) => DescribeParameter { index: reversed(it.index) }.into(),
        HostMessage::GetParameter(it) => GetParameter { index: reversed(it.index) }.into(),
        HostMessage::SetParameter(it) => SetParameter { index: reversed(it.index), ..it }.into(),
        HostMessage::DescribeChoice(it) => DescribeChoice { parameter: reversed(it.parameter), ..it }.into(),
        other => other,
    })
}

/// A drive that refuses every value.
pub fn refusing(answer: Answer) -> Vec<u8> {
    frame_of(answer.map(|answer| match answer {
        DriveMessage::ParameterReport(it) => ParameterReport { outcome: Outcome::OutOfRange, ..it }.into(),
        other => other,
    }))
}
