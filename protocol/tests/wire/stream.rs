//! The decoder on realistic streams: in pieces, with noise, truncated.

use lashloop_protocol::frame::FrameError;
use lashloop_protocol::message::{EncoderSample, Stop};
use lashloop_protocol::wire::BodyError;
use lashloop_protocol::{
    Counters, Decoder, DriveMessage, HostMessage, MAX_BODY, MAX_FRAME, Message, cobs, crc,
};

use crate::examples;

type Item = Result<HostMessage, FrameError>;

fn decode_all(decoder: &mut Decoder, mut input: &[u8]) -> Vec<Item> {
    std::iter::from_fn(|| decoder.next(&mut input)).collect()
}

fn sample_frame() -> Vec<u8> {
    HostMessage::from(examples::SAMPLE).frame().to_vec()
}

/// A frame around any body, with a correct CRC.
fn frame_around(body: &[u8]) -> Vec<u8> {
    let mut frame = vec![0];
    frame.extend_from_slice(body);
    frame.extend_from_slice(&crc::checksum(body).to_le_bytes());
    cobs::stuff(&mut frame);
    frame.push(0);
    frame
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
    let mut body = frame_around(&[0x07]);
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
    assert_eq!(items, [Err(FrameError::Body(BodyError::UnknownKind { kind: 0x90 }))]);
}

#[test]
fn a_body_of_the_wrong_length_names_both_lengths() {
    let items = decode_all(&mut Decoder::new(), &frame_around(&[0x10, 1, 2, 3]));
    let expected = BodyError::Length { name: "EncoderSample", expected: 13, found: 4 };
    assert_eq!(items, [Err(FrameError::Body(expected))]);
}

#[test]
fn telemetry_takes_1_to_13_values_and_no_other_length() {
    for len in 1..=MAX_BODY {
        let body = [&[0x91], &[0x3f; MAX_BODY][..len - 1]].concat();
        let item = Decoder::new().next::<DriveMessage>(&mut &frame_around(&body)[..]).expect("a whole frame");
        if [7, 11, 15, 19, 23, 27, 31, 35, 39, 43, 47, 51, 55].contains(&len) {
            let Ok(DriveMessage::Telemetry(telemetry)) = item else { panic!("{len} bytes: {item:?}") };
            assert_eq!(telemetry.values.as_slice().len(), (len - 3) / 4);
            assert_eq!(DriveMessage::from(telemetry).frame()[..], frame_around(&body)[..]);
        } else {
            let expected = BodyError::Elements { name: "Telemetry", longest: 55, step: 4, found: len };
            assert_eq!(item, Err(FrameError::Body(expected)));
        }
    }
}

#[test]
fn a_byte_outside_its_list_is_rejected_by_field_name() {
    let mut decoder = Decoder::new();
    let mut input = &frame_around(&[0x85, 6, 99, 4])[..];
    let expected = BodyError::Value { name: "CommandResult", field: "outcome" };
    assert_eq!(decoder.next::<DriveMessage>(&mut input), Some(Err(FrameError::Body(expected))));
    assert_eq!(decoder.counters().refused, 1);
}

#[test]
fn a_status_outside_its_lists_is_rejected() {
    let status = |status: u8| {
        let body = [0x90, 1, 0, 0, 0, 0, 0, status, 0, 0];
        Decoder::new().next::<DriveMessage>(&mut &frame_around(&body)[..]).expect("a whole frame")
    };
    let rejected = BodyError::Value { name: "TorqueAnswer", field: "status" };
    for byte in 0..=u8::MAX {
        // Five states, and three flags above them.
        if (1..=5).contains(&(byte & 0x0f)) && byte & 0x80 == 0 {
            let Ok(DriveMessage::TorqueAnswer(answer)) = status(byte) else {
                panic!("{byte:#04x} is rejected")
            };
            assert_eq!((answer.status.state as u8, answer.status.flags.bits()), (byte & 0x0f, byte & 0xf0));
        } else {
            assert_eq!(status(byte), Err(FrameError::Body(rejected)), "{byte:#04x}");
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
    let stream =
        [good.clone(), wrong_crc, vec![9, 9, 0], vec![5; 70], vec![0], frame_around(&[0x7f]), good.clone()]
            .concat();
    let mut decoder = Decoder::new();
    let _ = decode_all(&mut decoder, &stream);
    let expected = Counters {
        messages: 2,
        discarded_bytes: (stream.len() - 2 * good.len()) as u32,
        oversized: 1,
        malformed: 1,
        crc_errors: 1,
        refused: 1,
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
        FrameError::Body(BodyError::UnknownKind { kind: 0x7f }).to_string(),
        FrameError::Body(BodyError::Length { name: "Stop", expected: 1, found: 9 }).to_string(),
        FrameError::Body(BodyError::Elements { name: "Telemetry", longest: 55, step: 4, found: 56 })
            .to_string(),
        FrameError::Truncated { bytes: 12 }.to_string(),
    ];
    insta::assert_snapshot!(messages.join("\n"));
    let stop = HostMessage::from(Stop {});
    assert_eq!(stop.frame().len(), 7);
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
