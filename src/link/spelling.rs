//! The spelling of one kind of link.

use super::address::Address;
use super::problem::Problem;

/// One way to spell a link.
#[derive(Clone, Copy, Debug)]
pub struct Scheme {
    /// The text before the first colon.
    pub name: &'static str,
    /// The pattern of a whole address.
    pub spelling: &'static str,
    /// Its description in one line.
    pub about: &'static str,
    /// Parses the text after the first colon; `None` where there is no colon.
    pub(super) parse: fn(Option<&str>) -> Result<Address, Problem>,
}
