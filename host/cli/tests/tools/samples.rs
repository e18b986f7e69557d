//! Samples of a record, changed.

use std::borrow::Cow;
use std::fs::{self, File};
use std::path::Path;
use std::sync::Arc;

use mcap::{Channel, Message, MessageStream, Schema, Writer};

/// Bytes behind the flag `answered` of a step: the flag `missed`, padding, and four times of the exchange.
const BEHIND_ANSWERED: usize = 1 + 6 + 4 * 8;

/// Writes `run.mcap` anew with the messages that `keep` accepts, which may change them.
pub fn rewrite(folder: &Path, mut keep: impl FnMut(&mut Message<'_>) -> bool) {
    let path = folder.join("run.mcap");
    let bytes = fs::read(&path).unwrap();
    let mut file = Writer::new(File::create(&path).unwrap()).unwrap();
    for message in MessageStream::new(&bytes).unwrap() {
        let mut message = message.unwrap();
        if keep(&mut message) {
            file.write(&message).unwrap();
        }
    }
    file.finish().unwrap();
}

/// The step in which a message was written, at 1 kHz.
pub fn step(message: &Message<'_>) -> u64 {
    let start_ns: u64 = message.channel.metadata["start_ns"].parse().unwrap();
    (message.publish_time - start_ns) / 1_000_000
}

/// Makes a message of `/step` one without a torque in time.
pub fn unanswer(message: &mut Message<'_>) {
    let data = message.data.to_mut();
    let at = data.len() - BEHIND_ANSWERED - 1;
    data[at] = 0;
}

/// Gives a column of the samples another name.
pub fn rename(folder: &Path, from: &str, to: &str) {
    rewrite(folder, |message| {
        let schema = message.channel.schema.as_deref().unwrap();
        let text = std::str::from_utf8(&schema.data).unwrap().replace(from, to);
        let schema = Schema { data: Cow::Owned(text.into_bytes()), ..schema.clone() };
        message.channel = Arc::new(Channel { schema: Some(Arc::new(schema)), ..(*message.channel).clone() });
        true
    });
}
