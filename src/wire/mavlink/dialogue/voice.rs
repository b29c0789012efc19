//! Messages that the conversation sends beside the stream of samples.

use super::Said;
use crate::wire::mavlink::SYSTEM;
use ratetable_protocols::mavlink::{self, Header, Message, Version};

/// A different component from that of the samples, so that each has its own sequence without gaps.
pub(super) const COMPONENT: u8 = 52;

/// Packs messages as a component of the vehicle's system.
#[derive(Debug)]
pub(super) struct Voice {
    version: Version,
    system: u8,
    seq: u8,
}

impl Default for Voice {
    fn default() -> Voice {
        Voice { version: Version::V2, system: SYSTEM, seq: 0 }
    }
}

impl Voice {
    /// Sends from now on as part of that system, in the version in which it was heard.
    pub(super) fn adopt(&mut self, version: Version, system: u8) {
        (self.version, self.system) = (version, system);
    }

    pub(super) fn say(&mut self, message: &Message, say: &mut dyn FnMut(Said<'_>)) {
        let Voice { version, system, seq } = *self;
        let mut buffer = [0; mavlink::MAX_LEN];
        // MAX_LEN holds every message, and MAVLink 1 has all messages sent here.
        if let Ok(len) =
            mavlink::encode(&Header { version, seq, system, component: COMPONENT }, message, &mut buffer)
        {
            self.seq = seq.wrapping_add(1);
            say(Said::Reply(&buffer[..len]));
        }
    }
}
