//! The samples that a sensor is given and what it makes of them, as columns.

/// One column a body axis.
pub type Columns = [Vec<f64>; 3];

/// What a term may need of the truth besides the error-free reading; filled for a sensor only where one of its terms
/// asks for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    /// The true specific force, m/s².
    Force,
    /// The error-free reading at the time of sensing, where that is not the tick.
    Late,
    /// What the sensor feels beyond the point that moves, for its lever arm.
    LeverArm,
}

/// A run of consecutive samples of one sensor, in body axes, one column an axis.
#[derive(Clone, Debug, Default)]
pub struct Block {
    /// The error-free reading.
    pub truth: Columns,
    /// The bias in effect.
    pub bias: Columns,
    /// What the part reads.
    pub reading: Columns,
    /// Whether the reading left the range.
    pub clipped: Vec<bool>,
    /// Which samples a fault withholds; empty where there is none.
    pub missing: Vec<bool>,
    /// The true specific force at the time of sensing, m/s²; empty unless a term needs [`Column::Force`].
    pub force: Columns,
    /// The error-free reading at the time of sensing; empty unless a term needs [`Column::Late`].
    pub late: Columns,
    /// Acceleration at the lever arm beyond that of the point that moves, m/s²; empty unless a term needs
    /// [`Column::LeverArm`].
    pub arm: Columns,
    /// The velocity that a GPS receiver reads, m/s in nav axes; empty of any other sensor.
    pub velocity: Columns,
    /// The true velocity; empty in the same case.
    pub true_velocity: Columns,
    /// The part's temperature, °C; empty where the scene does not give it.
    pub temperature: Vec<f64>,
}

impl Block {
    /// How many samples it holds.
    pub fn len(&self) -> usize {
        self.truth[0].len()
    }

    /// Whether it holds none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Forgets its samples and keeps its memory.
    pub fn clear(&mut self) {
        for columns in [
            &mut self.truth,
            &mut self.bias,
            &mut self.reading,
            &mut self.force,
            &mut self.late,
            &mut self.arm,
            &mut self.velocity,
            &mut self.true_velocity,
        ] {
            columns.iter_mut().for_each(Vec::clear);
        }
        self.clipped.clear();
        self.missing.clear();
        self.temperature.clear();
    }

    /// Reads what was true at the time of sensing.
    pub fn sense_late(&mut self) {
        for (reading, late) in self.reading.iter_mut().zip(&self.late) {
            reading.copy_from_slice(late);
        }
    }

    /// Adds a sample by its error-free reading.
    pub fn push(&mut self, truth: [f64; 3]) {
        push(&mut self.truth, truth);
    }
}

/// Adds one value to each of three columns.
pub fn push(columns: &mut Columns, v: [f64; 3]) {
    for (column, value) in columns.iter_mut().zip(v) {
        column.push(value);
    }
}
