//! Headed tables of numbers, as people have them.
//!
//! One place where a table is read: what parts its cells, where its header is ([`Table::open`]), what its columns are by
//! their names, or by what a user says ([`Choice`]), times with every digit and what unit they can be in ([`Times`]),
//! rows that are left out ([`LeftOut`]), and where a mistake stands ([`TableError`]). A file that is no table is named as
//! what it is ([`kind_of`]).
//!
//! ```
//! use ratetable::table::{Attitudes, Choice, Table, Wanted};
//!
//! let text = "#timestamp [ns], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []\n1000,1,0,0,0\n2000,nan,0,0,0\n3000,1,0,0,0\n";
//! let table = Table::open("data.csv", text.as_bytes())?;
//! let clock = table.clock(&Choice::default())?.expect("a column of time");
//! let Some(Attitudes::Quaternion(set)) = table.attitude(&Choice::default())? else { panic!() };
//! let series = table.read(&Wanted::new(clock, set.columns), |[w, ..]| Ok(*w))?;
//! assert_eq!(series.times.in_ns(series.times.unit.unwrap()), Some(vec![1000, 3000]));
//! assert_eq!((series.rows.read, series.rows.left_out.not_finite), (3, 1));
//! # Ok::<(), ratetable::table::TableError>(())
//! ```

mod cells;
mod choice;
mod error;
mod head;
mod kinds;
mod left_out;
mod lines;
mod names;
mod order;
mod read;
mod series;
mod times;
mod units;

pub use choice::{Attitudes, Choice, Clock};
pub use error::{Mistake, TableError};
pub use kinds::{Kind, is_text, kind_of};
pub use left_out::{LeftOut, Rows};
pub use names::{Heading, Set, TimeColumn};
pub use read::{Next, Row, Table, Wanted};
pub use series::{Flaw, Series};
pub use times::{TICKS, TimeUnit, Times, decimal};
pub use units::Unit;

#[cfg(test)]
mod tests;
