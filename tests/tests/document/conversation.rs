//! The conversation of the annex covers what every host sends.

use lashloop_protocol::Message;

use crate::annexes::{Exchange, conversation};
use crate::script::script;

#[test]
fn the_conversation_covers_handshake_to_stop() {
    let names: Vec<_> = conversation().iter().map(|it| it.request.message.layout().name).collect();
    let want = [
        "Hello",
        "DescribeLaw",
        "DescribeSignal",
        "DescribeParameter",
        "DescribeChoice",
        "SetParameter",
        "Subscribe",
        "Arm",
        "Start",
        "EncoderSample",
        "EncoderSample",
        "Stop",
    ];
    assert_eq!(names, want);
}

#[test]
fn the_annex_has_every_frame_of_the_conversation_in_order() {
    let have: Vec<_> = script().into_iter().map(|(_, frame)| frame).collect();
    let want: Vec<_> = conversation().iter().flat_map(Exchange::frames).collect();
    assert_eq!(have, want);
}
