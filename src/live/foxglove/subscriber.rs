//! What one viewer wants.

use super::Channels;
use crate::time::SimTime;
use serde_json::{Value, json};

/// Channels that one viewer may want.
const MOST: usize = 1000;
/// The first byte of a message with data.
const MESSAGE_DATA: u8 = 1;
/// The first byte of a message that tells the time.
const TIME: u8 = 2;
/// A status that is a warning.
const WARNING: u8 = 1;

/// What one viewer wants.
#[derive(Debug, Default)]
pub(in crate::live) struct Subscriber {
    /// Its number for each, and the channel's.
    wants: Vec<(u32, u32)>,
    /// The time that it was told last.
    told: Option<SimTime>,
}

impl Subscriber {
    /// One that wants nothing yet.
    pub(in crate::live) fn new() -> Subscriber {
        Subscriber::default()
    }

    /// Hears a text; answers what is wrong with it, if anything.
    pub(in crate::live) fn hear(&mut self, channels: &Channels, text: &str) -> Vec<String> {
        let Ok(message) = serde_json::from_str::<Value>(text) else {
            return vec![status("this is no JSON: a message is an object with an `op`")];
        };
        match message.get("op").and_then(Value::as_str) {
            Some("subscribe") => self.subscribe(channels, &message),
            Some("unsubscribe") => {
                let ids = list(&message, "subscriptionIds");
                self.wants.retain(|(id, _)| !ids.iter().any(|it| it.as_u64() == Some(u64::from(*id))));
                Vec::new()
            }
            // It says who it is, and which numbers it would like to see.
            Some("clientInfo" | "subscribeConnectionGraph" | "unsubscribeConnectionGraph") => Vec::new(),
            Some(op) => {
                vec![status(&format!("`{}` is not served: this server sends and takes nothing", short(op)))]
            }
            None => vec![status("a message has an `op`")],
        }
    }

    /// Hears bytes: nothing that comes so is served.
    pub(in crate::live) fn hear_binary(&mut self, _bytes: &[u8]) -> Vec<String> {
        vec![status("data from a viewer are not served: this server sends and takes nothing")]
    }

    fn subscribe(&mut self, channels: &Channels, message: &Value) -> Vec<String> {
        let mut answers = Vec::new();
        for wish in list(message, "subscriptions") {
            let number = |key: &str| wish.get(key)?.as_u64().and_then(|id| u32::try_from(id).ok());
            let (Some(id), Some(channel)) = (number("id"), number("channelId")) else {
                answers.push("a subscription has an `id` and a `channelId`".to_string());
                continue;
            };
            if !channels.has(channel) {
                answers.push(format!("there is no channel {channel}"));
            } else if self.wants.iter().any(|(known, _)| *known == id) {
                answers.push(format!("the subscription {id} is in use"));
            } else if self.wants.len() >= MOST {
                answers.push(format!("a viewer has at most {MOST} subscriptions"));
            } else {
                self.wants.push((id, channel));
            }
        }
        // One is enough to see what is wrong.
        answers.truncate(1);
        answers.iter().map(|answer| status(answer)).collect()
    }

    /// Whether it wants a channel.
    pub(in crate::live) fn wants(&self, channel: u32) -> bool {
        self.wants.iter().any(|(_, wanted)| *wanted == channel)
    }

    /// Forgets what it wants: the channels are gone. Its time goes on.
    pub(in crate::live) fn forget(&mut self) {
        self.wants.clear();
    }

    /// The frame that tells it the time; `None` where it knows a time as late, for a time that goes back begins anew.
    pub(in crate::live) fn time(&mut self, t: SimTime) -> Option<Vec<u8>> {
        if self.told >= Some(t) {
            return None;
        }
        self.told = Some(t);
        Some([&[TIME][..], &nanos(t)].concat())
    }

    /// A message's frames, one for each time that it wants the channel.
    pub(in crate::live) fn frames(
        &self,
        channel: u32,
        t: SimTime,
        payload: &[u8],
        out: &mut dyn FnMut(Vec<u8>),
    ) {
        for (id, _) in self.wants.iter().filter(|(_, wanted)| *wanted == channel) {
            let mut frame = Vec::with_capacity(13 + payload.len());
            frame.push(MESSAGE_DATA);
            frame.extend_from_slice(&id.to_le_bytes());
            frame.extend_from_slice(&nanos(t));
            frame.extend_from_slice(payload);
            out(frame);
        }
    }
}

/// A time as frames have it: nanoseconds since the scene began, little-endian; none is before that.
fn nanos(t: SimTime) -> [u8; 8] {
    t.0.max(0).unsigned_abs().to_le_bytes()
}

fn list<'v>(message: &'v Value, key: &str) -> &'v [Value] {
    message.get(key).and_then(Value::as_array).map_or(&[], Vec::as_slice)
}

fn status(message: &str) -> String {
    json!({ "op": "status", "level": WARNING, "message": message }).to_string()
}

/// The beginning of what somebody else wrote.
fn short(text: &str) -> String {
    text.chars().take(40).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::live::About;
    use proptest::prelude::*;

    fn channels() -> Channels {
        Channels::new(&About::of_data("run", "test".into()), None)
    }

    #[test]
    fn a_frame_is_its_number_the_time_and_the_message() {
        let mut subscriber = Subscriber::new();
        let wish = r#"{"op":"subscribe","subscriptions":[{"id":258,"channelId":1}]}"#;
        assert_eq!(subscriber.hear(&channels(), wish), Vec::<String>::new());
        assert!(subscriber.wants(1) && !subscriber.wants(2));
        let mut frames = Vec::new();
        subscriber.frames(1, SimTime(0x0102_0304), b"\x00\x01", &mut |frame| frames.push(frame));
        subscriber.frames(2, SimTime(0), b"x", &mut |frame| frames.push(frame));
        assert_eq!(frames, [b"\x01\x02\x01\x00\x00\x04\x03\x02\x01\x00\x00\x00\x00\x00\x01".to_vec()]);
        subscriber.hear(&channels(), r#"{"op":"unsubscribe","subscriptionIds":[258]}"#);
        assert!(!subscriber.wants(1));
    }

    #[test]
    fn a_viewer_is_told_a_time_once_and_never_an_earlier_one() {
        let mut subscriber = Subscriber::new();
        assert_eq!(subscriber.time(SimTime(0)), Some(vec![2, 0, 0, 0, 0, 0, 0, 0, 0]));
        assert_eq!(subscriber.time(SimTime(0)), None);
        assert_eq!(subscriber.time(SimTime(0x0102_0304)), Some(vec![2, 4, 3, 2, 1, 0, 0, 0, 0]));
        subscriber.forget();
        assert_eq!(subscriber.time(SimTime(0x0102_0303)), None);
    }

    #[test]
    fn what_cannot_be_served_is_answered_once_and_in_words() {
        let mut subscriber = Subscriber::new();
        let many: Vec<_> = (5000..8000).map(|id| json!({ "id": id, "channelId": 1 })).collect();
        let many = json!({ "op": "subscribe", "subscriptions": many }).to_string();
        for (text, word) in [
            ("{", "no JSON"),
            ("[]", "`op`"),
            (r#"{"op":"publish"}"#, "`publish` is not served"),
            (r#"{"op":"subscribe","subscriptions":[{"id":1,"channelId":99}]}"#, "no channel 99"),
            (r#"{"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]}"#, "has an `id`"),
            (
                r#"{"op":"subscribe","subscriptions":[{"id":1,"channelId":1},{"id":1,"channelId":2}]}"#,
                "in use",
            ),
            (&many, "at most 1000"),
        ] {
            let answers = subscriber.hear(&channels(), text);
            assert!(answers.len() == 1 && answers[0].contains(word), "{word}: {answers:?}");
            assert!(answers[0].contains(r#""op":"status","level":1"#), "{answers:?}");
        }
        assert_eq!(subscriber.wants.len(), 1000);
    }

    proptest! {
        #[test]
        fn nothing_that_is_said_panics(text in "\\PC{0,200}", bytes in proptest::collection::vec(any::<u8>(), 0..100),
                                       id in any::<i64>(), op in "[a-zA-Z]{0,20}") {
            let mut subscriber = Subscriber::new();
            let channels = channels();
            subscriber.hear(&channels, &text);
            subscriber.hear_binary(&bytes);
            let wish = json!({ "op": op, "subscriptions": [{ "id": id, "channelId": id }], "subscriptionIds": [id] });
            subscriber.hear(&channels, &wish.to_string());
            let wish = json!({ "op": "subscribe", "subscriptions": id });
            subscriber.hear(&channels, &wish.to_string());
        }
    }
}
