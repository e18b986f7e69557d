//! The protocol of Foxglove, Lichtblick and PlotJuggler: `foxglove.sdk.v1`, and `foxglove.websocket.v1`, which has the same
//! messages as far as they go here (<https://github.com/foxglove/ws-protocol/blob/main/docs/spec.md>).
//!
//! | message | is |
//! |---|---|
//! | `serverInfo`, `advertise` | the run, and its topics with their schemas; first |
//! | binary 1 | u32 subscription, u64 log time in ns, both little-endian, then a message in CDR |
//! | `status` | the answer to a request that isn't served; the verdict; last |
//! | `subscribe`, `unsubscribe`, from the client | the only requests: such a client can't stop the run |

use serde::Deserialize;
use serde_json::{Value, json};

use lashloop_record::samples::{MESSAGE_ENCODING, SCHEMA_ENCODING, Topic};

use super::messages::Message;

/// Names of the protocol, the preferred one first.
pub(super) const SUBPROTOCOLS: [&str; 2] = ["foxglove.sdk.v1", "foxglove.websocket.v1"];
const MESSAGE_DATA: u8 = 1;

/// Level of a status.
#[derive(Clone, Copy)]
enum Level {
    Info = 0,
    Warning = 1,
    Error = 2,
}

fn status(level: Level, message: &str) -> String {
    json!({"op": "status", "level": level as u8, "message": message}).to_string()
}

/// What a run is to a client.
#[derive(Debug)]
pub(super) struct Introduction {
    /// The first two messages.
    pub(super) texts: [String; 2],
    /// The number of channels, which have the numbers from 1.
    pub(super) channels: usize,
}

/// The first two messages. `metadata` says what is run; `session` is a text that no other run has.
pub(super) fn introduction(
    name: &str,
    metadata: &[(&str, &str)],
    session: &str,
    topics: &[Topic],
) -> Introduction {
    let metadata: serde_json::Map<_, _> =
        metadata.iter().map(|(name, value)| ((*name).to_owned(), Value::from(*value))).collect();
    let channel = |(id, topic): (usize, &Topic)| {
        json!({
            "id": id,
            "topic": topic.name,
            "encoding": MESSAGE_ENCODING,
            "schemaName": topic.schema_name,
            "schema": topic.schema,
            "schemaEncoding": SCHEMA_ENCODING,
        })
    };
    let channels: Vec<_> = (1..).zip(topics).map(channel).collect();
    let texts = [
        json!({"op": "serverInfo", "name": name, "capabilities": [], "metadata": metadata, "sessionId": session}),
        json!({"op": "advertise", "channels": channels}),
    ]
    .map(|it| it.to_string());
    Introduction { texts, channels: channels.len() }
}

/// The last message: the verdict with its reasons, from the end of the run as the page takes it.
pub(super) fn farewell(end: &str) -> String {
    let end: Value = serde_json::from_str(end).unwrap_or_default();
    let Some(verdict) = end["verdict"].as_str() else {
        return status(Level::Error, "the run has failed; the bench says why on its terminal");
    };
    let reasons: Vec<_> = end["reasons"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
    let text =
        if reasons.is_empty() { verdict.to_owned() } else { format!("{verdict}: {}", reasons.join("; ")) };
    status(if verdict == "PASS" { Level::Info } else { Level::Error }, &text)
}

#[derive(Deserialize)]
#[serde(tag = "op", rename_all = "camelCase", rename_all_fields = "camelCase")]
enum Request {
    Subscribe {
        subscriptions: Vec<Subscription>,
    },
    Unsubscribe {
        subscription_ids: Vec<u32>,
    },
    #[serde(other)]
    Other,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "camelCase")]
struct Subscription {
    id: u32,
    channel_id: u64,
}

/// What a client has asked for: at most one subscription to each channel, so that a message goes to it once.
#[derive(Debug)]
pub(super) struct Client {
    /// Number of the last channel.
    channels: u64,
    subscriptions: Vec<Subscription>,
    /// The answer to its latest request; one at a time, however many it sends.
    pub(super) answer: Option<String>,
}

impl Client {
    /// Without a channel, before the run is known.
    pub(super) fn new(channels: usize) -> Self {
        Self { channels: channels as u64, subscriptions: Vec::new(), answer: None }
    }

    /// The run has this many channels.
    pub(super) fn advertise(&mut self, channels: usize) {
        self.channels = channels as u64;
    }

    /// Takes a text of the client.
    pub(super) fn request(&mut self, text: &str) {
        let refusal = match serde_json::from_str(text) {
            Ok(Request::Subscribe { subscriptions }) => {
                // Each by itself: a client asks for all that it shows in one request.
                let mut refusals: Vec<_> =
                    subscriptions.into_iter().filter_map(|it| self.subscribe(it).err()).collect();
                refusals.truncate(2);
                (!refusals.is_empty()).then(|| refusals.join("; "))
            }
            Ok(Request::Unsubscribe { subscription_ids }) => {
                self.subscriptions.retain(|it| !subscription_ids.contains(&it.id));
                None
            }
            Ok(Request::Other) => {
                Some("the bench takes subscribe and unsubscribe only: a client watches".to_owned())
            }
            Err(error) => Some(format!("the request isn't understood: {error}")),
        };
        self.answer = refusal.map(|message| status(Level::Warning, &message)).or(self.answer.take());
    }

    fn subscribe(&mut self, new: Subscription) -> Result<(), String> {
        let Subscription { id, channel_id } = new;
        if !(1..=self.channels).contains(&channel_id) {
            return Err(format!(
                "channel {channel_id} isn't advertised; the channels are 1 to {}",
                self.channels
            ));
        }
        if self.subscriptions.iter().any(|it| it.id == id) {
            return Err(format!("subscription {id} already exists"));
        }
        if self.subscriptions.iter().any(|it| it.channel_id == channel_id) {
            return Err(format!("channel {channel_id} already has a subscription"));
        }
        self.subscriptions.push(new);
        Ok(())
    }

    pub(super) fn is_subscribed(&self) -> bool {
        !self.subscriptions.is_empty()
    }

    /// A message as its subscription takes it; `None` without one.
    pub(super) fn frame(&self, message: &Message) -> Option<Vec<u8>> {
        let channel = message.topic as u64 + 1;
        let Subscription { id, .. } = self.subscriptions.iter().find(|it| it.channel_id == channel)?;
        let mut frame = Vec::with_capacity(13 + message.data.len());
        frame.push(MESSAGE_DATA);
        frame.extend_from_slice(&id.to_le_bytes());
        frame.extend_from_slice(&message.log_time_ns.to_le_bytes());
        frame.extend_from_slice(&message.data);
        Some(frame)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_client_gets_the_topics_that_it_asks_for_under_its_own_numbers() {
        let mut client = Client::new(4);
        client
            .request(r#"{"op":"subscribe","subscriptions":[{"id":7,"channelId":2},{"id":8,"channelId":1}]}"#);
        let message = Message { topic: 1, log_time_ns: 0x0102, data: [0, 1, 0, 0, 9].as_slice().into() };
        let frame = client.frame(&message).expect("a frame");
        assert_eq!(frame, [1, 7, 0, 0, 0, 2, 1, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 9]);
        client.request(r#"{"op":"unsubscribe","subscriptionIds":[7]}"#);
        assert_eq!(client.frame(&message), None);
        assert!(client.is_subscribed() && client.answer.is_none());
    }

    #[test]
    fn what_is_not_served_is_answered_and_bounded() {
        let mut client = Client::new(4);
        for text in ["{", "[]", r#"{"op":"setParameters","parameters":[]}"#, r#"{"op":"subscribe"}"#] {
            client.request(text);
            let answer = client.answer.take().expect("an answer");
            assert!(answer.contains(r#""op":"status""#), "{text}: {answer}");
        }
        for id in 0..1_000 {
            client.request(&format!(
                r#"{{"op":"subscribe","subscriptions":[{{"id":{id},"channelId":{}}}]}}"#,
                id % 9
            ));
        }
        assert_eq!(client.subscriptions.len(), 4, "one for each channel");
    }

    #[test]
    fn a_refused_subscription_takes_none_of_the_others() {
        let mut client = Client::new(2);
        let text = r#"{"op":"subscribe","subscriptions":[
            {"id":1,"channelId":99},{"id":1,"channelId":1},{"id":2,"channelId":1},{"id":3,"channelId":2}]}"#;
        client.request(text);
        let ids: Vec<_> = client.subscriptions.iter().map(|it| (it.id, it.channel_id)).collect();
        assert_eq!(ids, [(1, 1), (3, 2)]);
        let answer = client.answer.expect("an answer");
        assert!(answer.contains("channel 99 isn't advertised; the channels are 1 to 2"), "{answer}");
        assert!(answer.contains("channel 1 already has a subscription"), "{answer}");
    }

    #[test]
    fn the_last_status_is_the_verdict() {
        let level = |text: &str| serde_json::from_str::<Value>(text).expect("JSON")["level"].as_u64();
        let passed = farewell(r#"{"kind":"end","verdict":"PASS","reasons":[]}"#);
        let failed = farewell(r#"{"kind":"end","verdict":"FAIL","reasons":["a","b"]}"#);
        assert!(passed.contains("PASS") && failed.contains("FAIL: a; b"), "{passed} {failed}");
        let levels = [level(&passed), level(&failed), level(&farewell(r#"{"kind":"failed"}"#))];
        assert_eq!(levels, [Some(0), Some(2), Some(2)]);
    }
}
