//! One kind of link as users write it.

use super::address::Address;
use super::problem::Problem;

/// One way to spell a link.
#[derive(Clone, Copy, Debug)]
pub struct Scheme {
    /// What stands before the first colon.
    pub name: &'static str,
    /// How a whole address looks.
    pub spelling: &'static str,
    /// What it is, in one line.
    pub about: &'static str,
    /// Reads what stands after the first colon; `None` where there is no colon.
    pub(super) parse: fn(Option<&str>) -> Result<Address, Problem>,
}
