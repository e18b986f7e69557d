//! One client of the protocol of Foxglove: the messages of the run and its requests, on a websocket.

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use axum::extract::ws::{Message as Frame, WebSocket, WebSocketUpgrade};
use futures_util::{SinkExt, StreamExt};
use tokio::sync::Notify;
use tokio::time::Instant;

use super::feed::{Feed, Reader};
use super::foxglove::{Client, farewell};
use super::reader::{CLOSE_LIMIT, SEND_LIMIT, WAITING_BYTES};

/// From the first subscription to the first message: a client asks for one topic after the other, and gets all from the
/// start of the history.
const GRACE: Duration = Duration::from_millis(100);
/// Messages of one batch.
const BATCH: usize = 256;
/// Longest request, in bytes.
const LONGEST: usize = 16 << 10;
/// Bytes that are written at once.
const AT_ONCE: usize = 64 << 10;

/// Limits what a client may send, and how much waits for it.
pub(super) fn limited(upgrade: WebSocketUpgrade) -> WebSocketUpgrade {
    let upgrade = upgrade.max_message_size(LONGEST).max_frame_size(LONGEST);
    upgrade.write_buffer_size(AT_ONCE).max_write_buffer_size(WAITING_BYTES)
}

/// Serves a client until it leaves or the run ends.
pub(super) async fn serve(socket: WebSocket, reader: Reader) {
    let (sink, mut source) = socket.split();
    let (client, asked) = (Mutex::new(Client::new(0)), Notify::new());
    let requests = async {
        while let Some(Ok(frame)) = source.next().await {
            if let Frame::Text(text) = frame {
                lock(&client).request(&text);
                asked.notify_one();
            }
        }
    };
    let items = Sending { sink, feed: reader.feed(), client: &client }.send_all(&asked);
    tokio::pin!(requests);
    tokio::select! {
        () = &mut requests => {}
        // As for a reader of the page.
        _ = items => { let _ = tokio::time::timeout(CLOSE_LIMIT, requests).await; }
    }
}

fn lock(client: &Mutex<Client>) -> MutexGuard<'_, Client> {
    client.lock().unwrap_or_else(PoisonError::into_inner)
}

struct Sending<'a, S> {
    sink: S,
    feed: &'a Feed,
    client: &'a Mutex<Client>,
}

/// The client has left, or takes nothing.
struct Left;

impl<S: futures_util::Sink<Frame> + Unpin> Sending<'_, S> {
    async fn send_all(mut self, asked: &Notify) -> Result<(), Left> {
        let mut changes = self.feed.changes();
        let (mut is_introduced, mut place, mut begins) = (false, 0, None);
        loop {
            changes.borrow_and_update();
            if !is_introduced && let Some(run) = self.feed.introduction() {
                is_introduced = true;
                lock(self.client).advertise(run.channels);
                self.send(run.texts.iter().map(|text| Frame::text(&**text)).collect()).await?;
            }
            if is_introduced && let Some(answer) = { lock(self.client).answer.take() } {
                self.send(vec![Frame::text(answer)]).await?;
            }
            let now = Instant::now();
            if begins.is_none() && lock(self.client).is_subscribed() {
                begins = Some(now + GRACE);
            }
            let is_waiting = begins.is_some_and(|begins| now < begins);
            if begins.is_some() && !is_waiting {
                let (messages, next) = self.feed.messages(place, BATCH);
                place = next;
                if !messages.is_empty() {
                    let frames = {
                        let client = lock(self.client);
                        messages.iter().filter_map(|it| client.frame(it)).map(Frame::binary).collect()
                    };
                    self.send(frames).await?;
                    continue;
                }
            }
            if !is_waiting && let Some(end) = self.feed.ended() {
                self.send(vec![Frame::text(farewell(&end))]).await?;
                let _ = self.sink.close().await;
                return Ok(());
            }
            let grace = async {
                match begins.filter(|_| is_waiting) {
                    Some(begins) => tokio::time::sleep_until(begins).await,
                    None => std::future::pending().await,
                }
            };
            tokio::select! {
                changed = changes.changed() => changed.map_err(|_| Left)?,
                () = asked.notified() => {}
                () = grace => {}
            }
        }
    }

    /// Sends frames, all of them before the limit.
    async fn send(&mut self, frames: Vec<Frame>) -> Result<(), Left> {
        let all = async {
            for frame in frames {
                self.sink.feed(frame).await?;
            }
            self.sink.flush().await
        };
        tokio::time::timeout(SEND_LIMIT, all).await.map_err(|_| Left)?.map_err(|_: S::Error| Left)?;
        self.feed.note_taken();
        Ok(())
    }
}
