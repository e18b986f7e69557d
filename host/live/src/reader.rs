//! One reader: the feed as messages of a websocket.
//!
//! | message | is |
//! |---|---|
//! | text | an object of JSON by `kind`: `description`, `status`, `end`, `failed` |
//! | binary | u32 number of the history, u32 number of the first bucket, then f32 numbers, bucket by bucket, all little-endian |
//! | text `stop`, from the reader | ends the run |

use std::time::Duration;

use axum::extract::ws::{Message, Utf8Bytes, WebSocket, WebSocketUpgrade};
use futures_util::{SinkExt, StreamExt};

use super::envelope::Chunk;
use super::feed::{Cursor, Item, Reader};

/// Time for a reader to take one message. A longer one is dead.
pub(super) const SEND_LIMIT: Duration = Duration::from_secs(10);
/// Time for a reader to confirm the end of the connection.
pub(super) const CLOSE_LIMIT: Duration = Duration::from_millis(500);
/// Most bytes that wait for a reader, besides those in the system's buffer. A reader that pings and takes no answer is
/// dropped there. The longest message, a chunk of 256 buckets, has 500 kB with 250 columns.
pub(super) const WAITING_BYTES: usize = 2 << 20;
/// Longest message of a reader, in bytes.
const LONGEST: usize = 125;
const STOP: &str = "stop";

/// Limits what a reader may send, and how much waits for it.
pub(super) fn limited(upgrade: WebSocketUpgrade) -> WebSocketUpgrade {
    let upgrade = upgrade.max_message_size(LONGEST).max_frame_size(LONGEST);
    upgrade.write_buffer_size(0).max_write_buffer_size(WAITING_BYTES)
}

/// Serves a reader until it leaves or the run ends.
pub(super) async fn serve(socket: WebSocket, reader: Reader) {
    let feed = reader.feed();
    let (mut sink, mut source) = socket.split();
    let requests = async {
        while let Some(Ok(message)) = source.next().await {
            if matches!(&message, Message::Text(text) if text.as_str() == STOP) {
                feed.request_stop();
            }
        }
    };
    let items = async {
        let mut changes = feed.changes();
        let mut cursor = Cursor::default();
        loop {
            changes.borrow_and_update();
            while let Some(item) = feed.next(&mut cursor) {
                let (message, is_end) = match item {
                    Item::Text(text) => (Message::Text(Utf8Bytes::from(&*text)), false),
                    Item::Samples(history, chunk) => (Message::Binary(bytes(history, &chunk).into()), false),
                    Item::End(text) => (Message::Text(Utf8Bytes::from(&*text)), true),
                };
                if !matches!(tokio::time::timeout(SEND_LIMIT, sink.send(message)).await, Ok(Ok(()))) {
                    return;
                }
                feed.note_taken();
                if is_end {
                    let _ = sink.close().await;
                    return;
                }
            }
            if changes.changed().await.is_err() {
                return;
            }
        }
    };
    tokio::pin!(requests);
    tokio::select! {
        () = &mut requests => {}
        // A socket that is closed with unread bytes would take the last message from the reader.
        () = items => { let _ = tokio::time::timeout(CLOSE_LIMIT, requests).await; }
    }
}

fn bytes(history: u32, chunk: &Chunk) -> Vec<u8> {
    let head = [history, chunk.first as u32].into_iter().flat_map(u32::to_le_bytes);
    head.chain(chunk.values.iter().flat_map(|value| value.to_le_bytes())).collect()
}
