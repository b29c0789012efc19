//! What to tell a user whose driver does something that a bus cannot answer, once each.

use crate::bus::Fitted;
use std::collections::BTreeSet;

#[derive(Default)]
pub(super) struct Hints(BTreeSet<String>);

impl Hints {
    fn once(&mut self, hint: String) -> Option<String> {
        self.0.insert(hint.clone()).then_some(hint)
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
        self.once(format!("nobody answers at {address:#04x}; on the bus: {}", all.join(", ")))
    }

    /// A driver has turned on something that a chip does not do.
    pub(super) fn lacks(&mut self, chip: &str, what: &str) -> Option<String> {
        self.once(format!("the driver has turned on what this {chip} does not do: {what}"))
    }
}
