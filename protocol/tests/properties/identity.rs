//! Messages and bytes correspond one to one.

use std::fmt::Debug;

use lashloop_protocol::{Decoder, DriveMessage, HostMessage, MAX_FRAME, Message, Numbered, cobs};
use proptest::prelude::*;

use crate::bodies::{body_of, frame_around, wild_body_of};
use crate::cases;

/// Body to message to frame to message to frame. Bytes are compared, so that all bits of NaN count.
fn passes_unchanged<M: Message + Debug>(body: &[u8]) -> Result<(), TestCaseError> {
    let message = M::decode_body(body);
    prop_assert!(message.is_ok(), "{message:?} of {body:02x?}");
    let Numbered { number, message } = message.unwrap();
    let frame = message.numbered_frame(number);
    prop_assert_eq!(&frame[..], &frame_around(body)[..]);
    prop_assert!(frame.len() <= MAX_FRAME);
    prop_assert_eq!(
        frame.iter().position(|&byte| byte == 0),
        Some(frame.len() - 1),
        "one delimiter, at the end"
    );

    let mut stuffed = frame[..frame.len() - 1].to_vec();
    let unstuffed = cobs::unstuff(&mut stuffed).map(<[u8]>::to_vec);
    prop_assert_eq!(unstuffed.as_deref().and_then(|bytes| bytes.strip_suffix(&crc_of(body))), Some(body));

    let mut stream = &frame[..];
    let again = Decoder::new().next::<M>(&mut stream);
    prop_assert!(
        matches!(&again, Some(Ok(again)) if again.message.numbered_frame(again.number)[..] == frame[..]),
        "{again:?}"
    );
    Ok(())
}

fn crc_of(body: &[u8]) -> [u8; 4] {
    lashloop_protocol::crc::checksum(body).to_le_bytes()
}

/// The bytes are rejected, or they are the only encoding of their message but for bytes that this version ignores.
fn has_one_encoding<M: Message>(body: &[u8]) -> Result<(), TestCaseError> {
    if let Ok(Numbered { number, message }) = M::decode_body(body) {
        let mut stuffed = message.numbered_frame(number).to_vec();
        stuffed.pop();
        let written = lashloop_protocol::frame::open(&mut stuffed).expect("an encoded frame is valid");
        prop_assert!(body.starts_with(written), "{body:02x?} is written as {written:02x?}");
    }
    Ok(())
}

proptest! {
    #![proptest_config(cases(4096))]

    #[test]
    fn every_message_of_the_host_passes_unchanged(body in body_of::<HostMessage>()) {
        passes_unchanged::<HostMessage>(&body)?;
    }

    #[test]
    fn every_message_of_the_drive_passes_unchanged(body in body_of::<DriveMessage>()) {
        passes_unchanged::<DriveMessage>(&body)?;
    }

    #[test]
    fn every_message_has_one_encoding(
        from_host in wild_body_of::<HostMessage>(),
        from_drive in wild_body_of::<DriveMessage>(),
    ) {
        has_one_encoding::<HostMessage>(&from_host)?;
        has_one_encoding::<DriveMessage>(&from_drive)?;
    }
}
