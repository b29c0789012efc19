//! What a driver has set a chip to, in the scene's terms.

use crate::scene::Plan;
use crate::scene::settings::Asked;
use crate::sensor::{SensorKind, Setting};
use crate::time::{Rate, SimTime};
use ratetable_protocols::chip;

/// A sensor that a driver has set to something else.
#[derive(Clone, Debug)]
pub struct Change {
    /// Which sensor of the scene.
    pub sensor: usize,
    /// What it is.
    pub kind: SensorKind,
    /// Scene time from which it holds.
    pub setting: Setting,
    /// The setting as a scene writes it.
    pub written: toml::Table,
}

impl Change {
    /// What a chip's registers ask for from `start` on.
    ///
    /// # Errors
    /// The part's data lacks what the chip can be set to.
    pub(super) fn new(
        plan: &Plan,
        sensor: usize,
        part: &str,
        start: SimTime,
        set: chip::Setting,
    ) -> Result<Change, String> {
        let rate = set.rate.and_then(|(top, bottom)| Rate::new(top.into(), bottom.into()));
        let asked = Asked { part, rate, range: usize::from(set.range), filter: set.filter };
        let kind = plan.sensors[sensor].kind;
        let (setting, written) = plan.asked(kind, start, &asked)?;
        Ok(Change { sensor, kind, setting, written })
    }
}

impl std::fmt::Display for Change {
    /// `gyro: 200 Hz, ±500 deg/s, low-pass 41 Hz`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let text = |key: &str| self.written.get(key).and_then(|value| value.as_str());
        write!(f, "{}: {}", self.kind, text("rate").unwrap_or_default())?;
        if self.setting.rate.is_none() {
            return Ok(());
        }
        if let Some(range) = text("range") {
            write!(f, ", ±{range}")?;
        }
        let filter = self.written.get("filter").and_then(|filter| filter.as_table());
        if let Some(low_pass) = filter.and_then(|filter| filter.get("low_pass")?.as_str()) {
            write!(f, ", low-pass {low_pass}")?;
        }
        Ok(())
    }
}
