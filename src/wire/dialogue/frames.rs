//! Unparsed MAVLink frames, for forwarding.

use ratetable_protocols::mavlink::Version;

/// Whole MAVLink frames (1 or 2) in a datagram, one after another as a ground station sends them. Stops at bytes
/// that are no frame. The receiver checks the checksums.
pub fn frames(mut datagram: &[u8]) -> impl Iterator<Item = &[u8]> {
    std::iter::from_fn(move || {
        let (frame, rest) = datagram.split_at_checked(length(datagram)?)?;
        datagram = rest;
        Some(frame)
    })
}

/// The length of the frame at the start of these bytes: header, payload, checksum and signature.
fn length(bytes: &[u8]) -> Option<usize> {
    let (&magic, &payload) = (bytes.first()?, bytes.get(1)?);
    let version = [Version::V1, Version::V2].into_iter().find(|version| version.magic() == magic)?;
    let signed = version == Version::V2 && bytes.get(2)? & 1 == 1;
    Some(version.header_len() + usize::from(payload) + 2 + if signed { 13 } else { 0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::MAX_PACKET;
    use proptest::prelude::*;
    use ratetable_protocols::mavlink::{self, Header, Message, heartbeat};

    fn heartbeat(version: Version) -> Vec<u8> {
        let mut bytes = [0; mavlink::MAX_LEN];
        let header = Header { version, seq: 1, system: 255, component: 190 };
        let message = Message::Heartbeat(heartbeat::Repr { mavlink_version: 3, ..Default::default() });
        let len = mavlink::encode(&header, &message, &mut bytes).unwrap();
        bytes[..len].to_vec()
    }

    #[test]
    fn a_datagram_is_its_frames_and_a_damaged_end_is_left_out() {
        let (one, two) = (heartbeat(Version::V1), heartbeat(Version::V2));
        let mut signed = two.clone();
        signed[2] |= 1;
        signed.extend([7; 13]);
        let whole = [&one[..], &signed, &two].concat();
        assert_eq!(frames(&whole).collect::<Vec<_>>(), [&one[..], &signed, &two]);
        assert_eq!(frames(&whole[..whole.len() - 1]).count(), 2, "the last is not whole");
        assert_eq!(frames(&[&b"no"[..], &one].concat()).count(), 0);
        assert_eq!(frames(&[]).count(), 0);
    }

    proptest! {
        #[test]
        fn any_bytes_give_frames_that_fit_a_packet(bytes in prop::collection::vec(any::<u8>(), 0..2000), v2: bool) {
            let bytes = [&[if v2 { 0xfd } else { 0xfe }][..], &bytes].concat();
            prop_assert!(frames(&bytes).all(|frame| frame.len() <= MAX_PACKET));
            prop_assert!(frames(&bytes).map(<[u8]>::len).sum::<usize>() <= bytes.len());
        }
    }
}
