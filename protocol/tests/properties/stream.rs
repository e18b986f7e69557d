//! Streams with every kind of damage on a line, in pieces of every size.

use lashloop_protocol::frame::FrameError;
use lashloop_protocol::{DriveMessage, HostMessage, MAX_FRAME, Message, Numbered};
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::Index;

use crate::bodies::{body_of, frame_around, wild_body_of};
use crate::{cases, reference};

/// A section of a stream.
#[derive(Clone, Debug)]
enum Stretch {
    Whole(Vec<u8>),
    /// A frame with these bits flipped.
    Flipped(Vec<u8>, Vec<Index>),
    /// A frame without its end or its beginning.
    Cut(Vec<u8>, Index, bool),
    Twice(Vec<u8>),
    Noise(Vec<u8>),
    Idle(usize),
}

impl Stretch {
    fn bytes(&self) -> Vec<u8> {
        match self {
            Self::Whole(body) => frame_around(body),
            Self::Flipped(body, bits) => flipped(frame_around(body), bits),
            Self::Cut(body, at, keep_end) => {
                let frame = frame_around(body);
                let (beginning, end) = frame.split_at(at.index(frame.len()));
                if *keep_end { end } else { beginning }.to_vec()
            }
            Self::Twice(body) => [frame_around(body), frame_around(body)].concat(),
            Self::Noise(bytes) => bytes.clone(),
            Self::Idle(len) => vec![0; *len],
        }
    }
}

fn flipped(mut frame: Vec<u8>, bits: &[Index]) -> Vec<u8> {
    for bit in bits {
        let bit = bit.index(frame.len() * 8);
        frame[bit / 8] ^= 1 << (bit % 8);
    }
    frame
}

fn any_body() -> impl Strategy<Value = Vec<u8>> {
    prop_oneof![
        4 => body_of::<HostMessage>(),
        2 => body_of::<DriveMessage>(),
        1 => wild_body_of::<DriveMessage>(),
        1 => vec(any::<u8>(), 0..80),
    ]
}

fn stretch() -> impl Strategy<Value = Stretch> {
    prop_oneof![
        4 => any_body().prop_map(Stretch::Whole),
        2 => (any_body(), vec(any::<Index>(), 1..9)).prop_map(|(body, bits)| Stretch::Flipped(body, bits)),
        2 => (any_body(), any::<Index>(), any::<bool>()).prop_map(|(body, at, end)| Stretch::Cut(body, at, end)),
        1 => any_body().prop_map(Stretch::Twice),
        1 => vec(any::<u8>(), 0..3 * MAX_FRAME).prop_map(Stretch::Noise),
        1 => vec(1_u8.., 0..3 * MAX_FRAME).prop_map(Stretch::Noise),
        1 => (0..9_usize).prop_map(Stretch::Idle),
    ]
}

fn line() -> impl Strategy<Value = Vec<u8>> {
    vec(stretch(), 0..24).prop_map(|stretches| stretches.iter().flat_map(Stretch::bytes).collect())
}

fn good_messages(items: &[Result<Numbered<HostMessage>, FrameError>]) -> Vec<Vec<u8>> {
    items.iter().flatten().map(|item| item.message.numbered_frame(item.number).to_vec()).collect()
}

proptest! {
    #![proptest_config(cases(2048))]

    #[test]
    fn any_stream_in_any_pieces_decodes_as_specified(
        line in line(),
        pieces in vec(1..90_usize, 0..40),
    ) {
        reference::check::<HostMessage>(&line, &pieces);
        reference::check::<DriveMessage>(&line, &pieces);
    }

    #[test]
    fn every_frame_after_garbage_and_a_delimiter_is_decoded(
        garbage in vec(any::<u8>(), 0..200),
        bodies in vec(body_of::<HostMessage>(), 1..9),
        pieces in vec(1..90_usize, 0..9),
    ) {
        let frames: Vec<Vec<u8>> = bodies.iter().map(|body| frame_around(body)).collect();
        let line = [garbage, vec![0], frames.concat()].concat();
        let read = good_messages(&reference::check::<HostMessage>(&line, &pieces));
        prop_assert!(read.ends_with(&frames));
    }

    /// CRC-32C passes one of 2^32 random errors, none of them among these cases. `undetected_errors` measures the rate.
    #[test]
    fn flipped_bits_make_no_other_message(body in body_of::<HostMessage>(), bits in vec(any::<Index>(), 1..40)) {
        let good = frame_around(&body);
        let line = [flipped(good.clone(), &bits), vec![0]].concat();
        for message in good_messages(&reference::check::<HostMessage>(&line, &[])) {
            prop_assert_eq!(&message, &good);
        }
    }

    #[test]
    fn a_frame_that_lost_bytes_is_no_message(body in body_of::<HostMessage>(), from in any::<Index>(), to in any::<Index>()) {
        let frame = frame_around(&body);
        let (from, to) = (from.index(frame.len() - 1), to.index(frame.len() - 1));
        let lost = from.min(to)..from.max(to) + 1;
        let line = [&frame[..lost.start], &frame[lost.end..]].concat();
        prop_assert_eq!(good_messages(&reference::check::<HostMessage>(&line, &[])), Vec::<Vec<u8>>::new());
    }
}
