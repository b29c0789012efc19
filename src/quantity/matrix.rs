//! Reading a linear map: three rows of numbers with one unit.

use super::QuantityError;
use super::kind::Kind;

impl Kind {
    /// Reads the rows of a matrix, in inside units: `[[a, b, c], [d, e, f], [g, h, i]] unit`; a vector is the diagonal
    /// of one, a single number all three of it.
    ///
    /// # Errors
    /// No quantity of this kind, or not three rows of three.
    pub fn matrix(&self, text: &str) -> Result<[[f64; 3]; 3], QuantityError> {
        let numbers = |text: &str| self.vector(text).map(|row| row.map(|x| x.to_f64()));
        let inside = text.trim().strip_prefix('[').filter(|rest| rest.trim_start().starts_with('['));
        let Some((rows, unit)) = inside.and_then(|rest| rest.rsplit_once(']')) else {
            let [x, y, z] = numbers(text)?;
            return Ok([[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]]);
        };
        let rows: Vec<_> = rows.split_inclusive(']').filter(|row| !row.trim().is_empty()).collect();
        let [x, y, z] = rows[..] else {
            let message = format!("a matrix has 3 rows of 3 values, not {}", rows.len());
            return Err(QuantityError::new(message, 0..text.len()));
        };
        // Whatever is wrong is somewhere in the text: the rows are read as texts of their own.
        let row = |row: &str| numbers(&format!("{} {unit}", row.trim_start_matches([',', ' '])));
        let at = |error: QuantityError| QuantityError::new(error.to_string(), 0..text.len());
        Ok([row(x).map_err(at)?, row(y).map_err(at)?, row(z).map_err(at)?])
    }
}
