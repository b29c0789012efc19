//! Foxglove's WebSocket protocol: what is offered, who wants what, and each message's bytes. No sockets here.
//!
//! Source: Foxglove WebSocket protocol v1 (`foxglove.websocket.v1`), whose JSON and frames `foxglove.sdk.v1` shares as
//! far as they are used here. Messages are those of ROS 2 in CDR, as in the MCAP files of a dataset.

mod channel;
mod subscriber;

pub(super) use channel::Channels;
pub(super) use subscriber::Subscriber;

/// The names under which a viewer may ask for it, the one that is taken first.
pub(super) const SUBPROTOCOLS: [&str; 2] = ["foxglove.sdk.v1", "foxglove.websocket.v1"];
