//! The tokio-util codec agrees with the decoder.

use bytes::BytesMut;
use lashloop_protocol::codec::Codec;
use lashloop_protocol::frame::FrameError;
use lashloop_protocol::{DriveMessage, HostMessage, Message, Numbered};
use tokio_util::codec::{Decoder, Encoder};

use crate::examples;

/// A message with its number, 0 if its kind has none.
fn numbered((number, message): (u8, HostMessage)) -> Numbered<HostMessage> {
    Numbered { number: if message.layout().has_number() { number } else { 0 }, message }
}

#[test]
fn messages_are_decoded_from_single_bytes() {
    let mut host: Codec<DriveMessage, HostMessage> = Codec::default();
    let mut drive: Codec<HostMessage, DriveMessage> = Codec::default();
    let mut line = BytesMut::new();
    let sent: Vec<_> = (1..).zip(examples::from_host()).map(numbered).collect();
    for message in &sent {
        host.encode(*message, &mut line).unwrap();
    }
    let mut arrived = Vec::new();
    let mut buffer = BytesMut::new();
    for byte in line {
        buffer.extend_from_slice(&[byte]);
        arrived.extend(drive.decode(&mut buffer).unwrap());
    }
    assert_eq!(arrived, sent.into_iter().map(Ok).collect::<Vec<_>>());
    assert_eq!(drive.counters().messages as usize, HostMessage::LAYOUTS.len());
}

#[test]
fn a_bad_frame_is_an_item_and_the_stream_continues() {
    let mut codec: Codec<HostMessage, DriveMessage> = Codec::default();
    let mut line = BytesMut::from(&b"noise\0"[..]);
    line.extend_from_slice(&HostMessage::from(examples::SAMPLE).frame());
    assert!(matches!(codec.decode(&mut line), Ok(Some(Err(_)))));
    assert_eq!(codec.decode(&mut line).unwrap(), Some(Ok(numbered((0, examples::SAMPLE.into())))));
    assert_eq!(codec.decode(&mut line).unwrap(), None);
}

#[test]
fn the_end_of_the_stream_inside_a_frame_is_an_error() {
    let mut codec: Codec<HostMessage, DriveMessage> = Codec::default();
    let mut line = BytesMut::from(&HostMessage::from(examples::SAMPLE).frame()[..9]);
    assert_eq!(codec.decode_eof(&mut line).unwrap(), Some(Err(FrameError::Truncated { bytes: 9 })));
    assert_eq!(codec.decode_eof(&mut line).unwrap(), None);
}
