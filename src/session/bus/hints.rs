//! What to tell a user whose driver does something that a bus cannot answer, once each.

use crate::bus::Fitted;
use std::collections::BTreeSet;

/// Addresses without a chip that are told: whoever looks for chips tries them all.
const ADDRESSES: usize = 3;

#[derive(Default)]
pub(super) struct Hints {
    told: BTreeSet<String>,
    addresses: BTreeSet<u8>,
}

impl Hints {
    fn once(&mut self, hint: String) -> Option<String> {
        self.told.insert(hint.clone()).then_some(hint)
    }

    /// A driver speaks to an address at which nobody is.
    pub(super) fn refused(&mut self, address: u8, chips: &[Fitted]) -> Option<String> {
        let all: Vec<_> = chips.iter().map(ToString::to_string).collect();
        let is_there = |address: u8| chips.iter().any(|chip| chip.addresses.contains(&address));
        let sent = address << 1;
        if is_there(sent) || is_there(sent | 1) {
            return self.once(format!(
                "the driver sends the address {sent:#04x} as it is, and a bridge takes it shifted left by one, with bit 0 for a read: nobody answers at {address:#04x}"
            ));
        }
        if self.addresses.len() > ADDRESSES || !self.addresses.insert(address) {
            return None;
        }
        match self.addresses.len() {
            1..=ADDRESSES => {
                Some(format!("nobody answers at {address:#04x}; on the bus: {}", all.join(", ")))
            }
            _ => {
                Some("nobody answers at other addresses either: from now on this is counted, not told".into())
            }
        }
    }

    /// A driver has turned on something that a chip does not do.
    pub(super) fn lacks(&mut self, chip: &str, what: &str) -> Option<String> {
        self.once(format!("the driver has turned on what this {chip} does not do: {what}"))
    }
}
