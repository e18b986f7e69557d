//! The decoder on realistic streams: in pieces, with noise, truncated.

use lashloop_protocol::enums::FaultCode;
use lashloop_protocol::frame::FrameError;
use lashloop_protocol::message::{EncoderSample, Start, Stop};
use lashloop_protocol::wire::BodyError;
use lashloop_protocol::{
    Counters, Decoder, DriveMessage, Frame, HostMessage, MAX_BODY, MAX_FRAME, Message, Numbered,
};

use crate::examples;

type Item = Result<HostMessage, FrameError>;

/// The messages of a stream, without their numbers.
fn decode_all(decoder: &mut Decoder, mut input: &[u8]) -> Vec<Item> {
    std::iter::from_fn(|| decoder.next(&mut input)).map(|item| Ok(item?.message)).collect()
}

fn message_of<M: Message>(body: &[u8]) -> Result<M, FrameError> {
    let item = Decoder::new().next::<M>(&mut &Frame::around(body)[..]).expect("a whole frame");
    item.map(|numbered| numbered.message)
}

fn sample_frame() -> Vec<u8> {
    HostMessage::from(examples::SAMPLE).frame().to_vec()
}

#[test]
fn a_stream_in_any_three_pieces_gives_the_same_messages() {
    let messages = examples::from_host();
    let stream: Vec<u8> = messages.iter().flat_map(|message| message.frame().to_vec()).collect();
    let expected: Vec<Item> = messages.into_iter().map(Ok).collect();
    for first in 0..=stream.len() {
        for second in first..=stream.len() {
            let mut decoder = Decoder::new();
            let mut got = decode_all(&mut decoder, &stream[..first]);
            got.extend(decode_all(&mut decoder, &stream[first..second]));
            got.extend(decode_all(&mut decoder, &stream[second..]));
            assert_eq!(got, expected, "cut at {first} and {second}");
            assert_eq!(decoder.finish(), Ok(()));
        }
    }
}

#[test]
fn garbage_corrupts_only_the_frame_that_follows_it() {
    // Garbage of every length beyond a frame, without a delimiter.
    for len in 1..3 * MAX_FRAME {
        let garbage: Vec<u8> = (0..len).map(|i| (i * 37 % 255 + 1) as u8).collect();
        let stream = [garbage.clone(), sample_frame(), sample_frame()].concat();
        let mut decoder = Decoder::new();
        let items = decode_all(&mut decoder, &stream);
        assert_eq!(items.len(), 2);
        assert!(items[0].is_err(), "garbage of {len} bytes");
        assert_eq!(items[1], Ok(examples::SAMPLE.into()), "garbage of {len} bytes");
        let discarded = decoder.counters().discarded_bytes as usize;
        assert_eq!(discarded, len + sample_frame().len(), "every discarded byte is counted");
    }
}

#[test]
fn a_delimiter_after_garbage_preserves_the_next_frame() {
    let stream = [b"garbage\0".to_vec(), sample_frame()].concat();
    let items = decode_all(&mut Decoder::new(), &stream);
    assert_eq!(items.last(), Some(&Ok(examples::SAMPLE.into())));
}

#[test]
fn delimiters_alone_are_no_frames() {
    let mut decoder = Decoder::new();
    assert_eq!(decode_all(&mut decoder, &[0; 100]), []);
    assert_eq!(*decoder.counters(), Counters::default());
}

#[test]
fn every_flipped_bit_is_detected() {
    let good = sample_frame();
    for bit in 0..good.len() * 8 {
        let mut bad = good.clone();
        bad[bit / 8] ^= 1 << (bit % 8);
        let mut decoder = Decoder::new();
        // A flip in the last byte removes the delimiter; the next delimiter closes the frame.
        bad.push(0);
        let items = decode_all(&mut decoder, &bad);
        assert!(!items.is_empty() && items.iter().all(Result::is_err), "bit {bit}: {items:?}");
    }
}

#[test]
fn a_crc_error_names_both_values() {
    let mut body = Frame::around(&[0x07]).to_vec();
    body[2] ^= 0x01;
    let items = decode_all(&mut Decoder::new(), &body);
    assert!(
        matches!(items[..], [Err(FrameError::Crc { expected, found })] if expected ^ found == 0x01),
        "{items:?}"
    );
}

#[test]
fn a_frame_shorter_than_kind_and_crc_is_rejected() {
    assert_eq!(decode_all(&mut Decoder::new(), &[3, 7, 7, 0]), [Err(FrameError::TooShort { bytes: 3 })]);
    // Four bytes would all be CRC, without a kind.
    assert_eq!(
        decode_all(&mut Decoder::new(), &[5, 7, 7, 7, 7, 0]),
        [Err(FrameError::TooShort { bytes: 5 })]
    );
}

#[test]
fn an_oversized_frame_is_discarded_whole() {
    let stream = [vec![1; MAX_FRAME], vec![0], sample_frame()].concat();
    let mut decoder = Decoder::new();
    let items = decode_all(&mut decoder, &stream);
    assert_eq!(items, [Err(FrameError::Oversized { bytes: MAX_FRAME + 1 }), Ok(examples::SAMPLE.into())]);
    assert_eq!(decoder.counters().oversized, 1);
}

#[test]
fn a_frame_of_the_other_direction_is_rejected() {
    let frame = DriveMessage::from(examples::TORQUE).frame();
    let items = decode_all(&mut Decoder::new(), &frame);
    assert_eq!(items, [Err(FrameError::Body(BodyError::OtherDirection { kind: 0x90 }))]);
}

#[test]
fn a_body_that_is_too_short_names_both_lengths() {
    let items = decode_all(&mut Decoder::new(), &Frame::around(&[0x10, 1, 2, 3]));
    let expected = BodyError::Length { name: "EncoderSample", shortest: 13, found: 4 };
    assert_eq!(items, [Err(FrameError::Body(expected))]);
}

#[test]
fn telemetry_takes_1_to_13_values_and_no_other_length() {
    for len in 1..=MAX_BODY {
        let body = [&[0x91], &[0x3f; MAX_BODY][..len - 1]].concat();
        let item = message_of::<DriveMessage>(&body);
        if [7, 11, 15, 19, 23, 27, 31, 35, 39, 43, 47, 51, 55].contains(&len) {
            let Ok(DriveMessage::Telemetry(telemetry)) = item else { panic!("{len} bytes: {item:?}") };
            assert_eq!(telemetry.values.as_slice().len(), (len - 3) / 4);
            assert_eq!(DriveMessage::from(telemetry).frame()[..], Frame::around(&body)[..]);
        } else {
            let expected = BodyError::Elements { name: "Telemetry", longest: 55, step: 4, found: len };
            assert_eq!(item, Err(FrameError::Body(expected)));
        }
    }
}

#[test]
fn a_zero_is_in_no_list_and_rejected_by_field_name() {
    let mut decoder = Decoder::new();
    let mut input = &Frame::around(&[0x85, 7, 6, 0, 4, 0, 0, 0, 0])[..];
    let expected = BodyError::Value { name: "CommandResult", field: "outcome" };
    assert_eq!(decoder.next::<DriveMessage>(&mut input), Some(Err(FrameError::Body(expected))));
    assert_eq!(decoder.counters().refused, 1);
}

#[test]
fn a_value_that_a_newer_peer_added_is_kept_as_received() {
    for byte in 1..=u8::MAX {
        let body = [0x85, 7, 6, byte, 4, 0, 0, 0, 0];
        let Ok(DriveMessage::CommandResult(result)) = message_of(&body) else { panic!("{byte} is rejected") };
        assert_eq!(result.outcome.byte(), byte);
        assert_eq!(result.outcome.is_named(), byte <= 15);
        assert_eq!(DriveMessage::from(result).numbered_frame(7)[..], Frame::around(&body)[..]);
    }
    assert_eq!(FaultCode::from_byte(77).map(|code| code.to_string()).as_deref(), Some("unknown 77"));
}

#[test]
fn a_value_of_a_newer_type_is_kept_as_received() {
    let body = [0x83, 7, 3, 1, 9, 1, 2, 3, 4, 2, 0, 0, 0, 0];
    let Ok(DriveMessage::ParameterReport(report)) = message_of(&body) else { panic!("it is rejected") };
    assert_eq!(format!("{} ({})", report.value, report.value.ty()), "0x04030201 (unknown 9)");
    assert_eq!(DriveMessage::from(report).numbered_frame(7)[..], Frame::around(&body)[..]);
}

#[test]
fn every_status_but_that_of_state_0_is_kept_as_received() {
    for byte in 0..=u8::MAX {
        let body = [0x90, 1, 0, 0, 0, 0, 0, byte, 0, 0];
        let item = message_of::<DriveMessage>(&body);
        if byte & 0x0f == 0 {
            let rejected = BodyError::Value { name: "TorqueAnswer", field: "status" };
            assert_eq!(item, Err(FrameError::Body(rejected)), "{byte:#04x}");
        } else {
            let Ok(DriveMessage::TorqueAnswer(answer)) = item else { panic!("{byte:#04x} is rejected") };
            assert_eq!((answer.status.state.byte(), answer.status.flags.bits()), (byte & 0x0f, byte & 0xf0));
            assert_eq!(answer.status.byte(), byte);
        }
    }
}

#[test]
fn fields_that_a_newer_peer_added_are_ignored() {
    let known = HostMessage::from(Start { session: 0x0102_0304 });
    let mut body = vec![0x06, 9, 4, 3, 2, 1];
    while body.len() <= MAX_BODY {
        let item = Decoder::new().next::<HostMessage>(&mut &Frame::around(&body)[..]);
        assert_eq!(item, Some(Ok(Numbered { number: 9, message: known })), "{} bytes", body.len());
        body.push(0xa5);
    }
}

#[test]
fn a_device_time_is_there_whole_or_not_at_all() {
    let with_time = [0x85, 7, 6, 1, 4, 0, 0, 0, 0, 0x10, 0x20, 0x30, 0x40];
    for len in 9..=with_time.len() {
        let item = message_of::<DriveMessage>(&with_time[..len]);
        let Ok(DriveMessage::CommandResult(result)) = item else { panic!("{len} bytes are rejected") };
        let whole = len == with_time.len();
        assert_eq!(result.device_time_us, whole.then_some(0x4030_2010), "{len} bytes");
        let written_len = if whole { with_time.len() } else { 9 };
        assert_eq!(
            DriveMessage::from(result).numbered_frame(7)[..],
            Frame::around(&with_time[..written_len])[..]
        );
    }
    let cut = BodyError::Length { name: "CommandResult", shortest: 9, found: 8 };
    assert_eq!(message_of::<DriveMessage>(&with_time[..8]), Err(FrameError::Body(cut)));
}

#[test]
fn every_kind_is_known_or_unknown_in_its_direction_and_refused_in_the_other() {
    for kind in 0..=u8::MAX {
        let body = [&[kind, 7][..], &[0x11; MAX_BODY - 2]].concat();
        let number = if kind & 0x70 == 0x10 { 0 } else { 7 };
        let (host, drive) = (HostMessage::decode_body(&body), DriveMessage::decode_body(&body));
        for (found, known, sent) in [
            (host.map(|n| n.number), HostMessage::LAYOUTS, (0x01..=0x7f).contains(&kind)),
            (drive.map(|n| n.number), DriveMessage::LAYOUTS, kind > 0x80),
        ] {
            if !sent {
                assert_eq!(found, Err(BodyError::OtherDirection { kind }));
            } else if known.iter().all(|layout| layout.kind != kind) {
                assert_eq!(found, Err(BodyError::UnknownKind { kind, number }));
            } else if let Ok(found) = found {
                assert_eq!(found, number, "{kind:#04x}");
            } else {
                let value = matches!(found, Err(BodyError::Value { .. } | BodyError::Elements { .. }));
                assert!(value, "{kind:#04x}: {found:?}");
            }
        }
    }
}

#[test]
fn a_stream_may_end_between_frames_but_not_inside_one() {
    let frame = sample_frame();
    for end in 1..frame.len() {
        let mut decoder = Decoder::new();
        assert_eq!(decode_all(&mut decoder, &frame[..end]), []);
        assert_eq!(decoder.finish(), Err(FrameError::Truncated { bytes: end }));
        assert_eq!(decode_all(&mut decoder, &frame), [Ok(examples::SAMPLE.into())], "usable after the end");
    }
}

#[test]
fn counters_add_up_over_a_noisy_stream() {
    let good = sample_frame();
    let mut wrong_crc = good.clone();
    wrong_crc[5] ^= 0x10;
    let stream = [
        good.clone(),
        wrong_crc,
        vec![9, 9, 0],
        vec![5; 70],
        vec![0],
        Frame::around(&[0x81]).to_vec(),
        good.clone(),
    ]
    .concat();
    let mut decoder = Decoder::new();
    let _ = decode_all(&mut decoder, &stream);
    let _ = decode_all(&mut decoder, &Frame::around(&[0x7f, 1, 2, 3]));
    let expected = Counters {
        messages: 2,
        discarded_bytes: (stream.len() - 2 * good.len()) as u32,
        oversized: 1,
        malformed: 1,
        crc_errors: 1,
        refused: 1,
        unknown: 1,
    };
    assert_eq!(*decoder.counters(), expected);
    assert_eq!(decoder.counters().damaged(), 3);
}

#[test]
fn nan_passes_unchanged_because_the_drive_rejects_it() {
    let sample = EncoderSample { reference_rad: f32::NAN, ..examples::SAMPLE };
    let items = decode_all(&mut Decoder::new(), &HostMessage::from(sample).frame());
    assert!(matches!(items[..], [Ok(HostMessage::EncoderSample(s))] if s.reference_rad.is_nan()));
}

#[test]
fn errors_are_sentences_with_both_sides() {
    let messages = [
        FrameError::Oversized { bytes: 70 }.to_string(),
        FrameError::Crc { expected: 0x1234, found: 0xffff_0000 }.to_string(),
        FrameError::Body(BodyError::UnknownKind { kind: 0x7f, number: 3 }).to_string(),
        FrameError::Body(BodyError::OtherDirection { kind: 0x81 }).to_string(),
        FrameError::Body(BodyError::Length { name: "Stop", shortest: 2, found: 1 }).to_string(),
        FrameError::Body(BodyError::Elements { name: "Telemetry", longest: 55, step: 4, found: 56 })
            .to_string(),
        FrameError::Truncated { bytes: 12 }.to_string(),
    ];
    insta::assert_snapshot!(messages.join("\n"));
    let stop = HostMessage::from(Stop {});
    assert_eq!(stop.frame().len(), 8);
}

#[test]
fn a_discarded_partial_frame_is_not_counted() {
    let mut decoder = Decoder::new();
    let frame = sample_frame();
    assert_eq!(decode_all(&mut decoder, &frame[..10]), []);
    decoder.forget_partial();
    assert_eq!(decode_all(&mut decoder, &frame), [Ok(examples::SAMPLE.into())]);
    assert_eq!(*decoder.counters(), Counters { messages: 1, ..Counters::default() });
}
