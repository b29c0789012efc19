//! Charts: data in, an SVG document out.
//!
//! Every chart is a pure function of a plain struct of inputs. The same input gives the same bytes, and no input
//! panics: non-finite values are left out, a chart without data says so, and a value that a logarithmic axis cannot
//! show lies on a floor marked "≤". The colours are those of Okabe and Ito, which colour-blind readers can
//! distinguish, and colour never carries a meaning alone. Labels never overlap: pictures grow to hold them.
//!
//! | function | shows |
//! |---|---|
//! | `panels` | stacked time series with a common time axis |
//! | `histogram` | distributions: histograms, the share below or above a value |
//! | `loglog` | small multiples of cost against error, with the front of the cheapest |
//! | `points` | named points: cost across, error up, their front |
//! | `grid` | a table of verdicts |
//! | `curves` | measured curves with their bands, and theory |
//! | `bars` | what adds up, one bar for each step |
//! | `stacked` | several of these, one below the other |
//!
//! `plotters`' SVG backend draws in quarters of a pixel: it reads no system font, and leaves every coordinate to
//! us. `kuva` 0.6, tried on the same pictures, has no table of verdicts and no names at the ends of lines, and lets
//! points and tick labels leave their panel.

mod axis;
mod bars;
mod canvas;
mod curve;
mod front;
mod grid;
mod histogram;
mod labels;
mod loglog;
mod panels;
mod plot;
mod points;
mod series;
mod stack;
#[cfg(test)]
mod tests;

pub use bars::{Bar, Bars, bars};
pub use curve::{Curve, CurveKind, Curves, curves};
pub use grid::{Cell, Grid, Row, Verdict, grid};
pub use histogram::{Distribution, Histogram, Marker, Shape, histogram};
pub use loglog::{LogLog, Method, Motion, loglog};
pub use panels::{Line, LineKind, Panel, Panels, panels};
pub use points::{Level, Point, Points, points};
pub use stack::stacked;
