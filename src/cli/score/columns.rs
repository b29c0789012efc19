//! Which columns of a table to read, if their names do not say.

use crate::quantity;
use crate::table::{Choice, TimeUnit};
use crate::time::Rate;

/// Columns of files by name or by number from 1, for tables whose header says nothing of them.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct Columns {
    /// The column of time of tables that name none, by name or by number from 1; ':us' behind it says its unit
    #[arg(long, value_name = "COLUMN[:UNIT]")]
    time: Option<String>,
    /// The columns of a quaternion of tables that name none, w first, by name or by number
    #[arg(long, value_name = "W,X,Y,Z", conflicts_with = "euler", value_parser = quaternion)]
    quaternion: Option<[String; 4]>,
    /// Instead: roll, pitch and yaw, with ':deg' or ':rad' behind them where their names do not say it
    #[arg(long, value_name = "ROLL,PITCH,YAW[:UNIT]", value_parser = euler)]
    euler: Option<Angles>,
    /// How often a row comes, of tables without a column of time, such as '200 Hz'
    #[arg(long, value_name = "RATE", conflicts_with = "time", value_parser = rate)]
    rate: Option<Rate>,
}

/// Columns of angles, and how many rad their unit is.
#[derive(Clone, Debug, PartialEq)]
struct Angles([String; 3], Option<f64>);

impl Columns {
    /// As the reader of tables takes them.
    pub fn choice(&self) -> Choice {
        let (time, time_unit) = match &self.time {
            Some(text) => with_unit(text, |unit| unit.parse::<TimeUnit>().ok()),
            None => (None, None),
        };
        Choice {
            time,
            time_unit,
            rate: self.rate,
            quaternion: self.quaternion.clone(),
            euler: self.euler.clone().map(|Angles(names, unit)| (names, unit)),
        }
    }
}

/// A text and the unit behind its last colon, if that is one: a name may have a colon too.
fn with_unit<T>(text: &str, unit: impl Fn(&str) -> Option<T>) -> (Option<String>, Option<T>) {
    let parted = text.rsplit_once(':').and_then(|(name, end)| Some((name, unit(end.trim())?)));
    match parted {
        Some((name, unit)) => (Some(name.to_string()), Some(unit)),
        None => (Some(text.to_string()), None),
    }
}

fn names<const N: usize>(text: &str, example: &str) -> Result<[String; N], String> {
    let names: Vec<String> = text.split(',').map(|name| name.trim().to_string()).collect();
    let whole = !names.iter().any(String::is_empty);
    let names = <[String; N]>::try_from(names).ok().filter(|_| whole);
    names.ok_or_else(|| format!("takes {N} columns by name or by number from 1, such as {example}"))
}

fn quaternion(text: &str) -> Result<[String; 4], String> {
    names(text, "qw,qx,qy,qz or 5,6,7,8")
}

fn euler(text: &str) -> Result<Angles, String> {
    let unit = |end: &str| match end {
        "deg" => Some(1f64.to_radians()),
        "rad" => Some(1.0),
        _ => None,
    };
    let (columns, unit) = with_unit(text, unit);
    Ok(Angles(names(&columns.unwrap_or_default(), "roll,pitch,yaw:deg or 2,3,4:rad")?, unit))
}

fn rate(text: &str) -> Result<Rate, String> {
    let (numerator, denominator) = quantity::rate(text).map_err(|error| error.to_string())?;
    Rate::new(numerator, denominator)
        .ok_or_else(|| format!("`{text}` is not a rate: write, for example, 200 Hz"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_taken_with_and_without_their_unit() {
        let columns = Columns { time: Some("stamp:us".into()), ..Columns::default() };
        assert_eq!(
            (columns.choice().time, columns.choice().time_unit),
            (Some("stamp".into()), Some(TimeUnit::Us))
        );
        let columns = Columns { time: Some("a:b".into()), ..Columns::default() };
        assert_eq!((columns.choice().time, columns.choice().time_unit), (Some("a:b".into()), None));
        let Angles(names, unit) = euler("r, p,y:deg").unwrap();
        assert_eq!((names, unit), (["r", "p", "y"].map(String::from), Some(1f64.to_radians())));
        assert_eq!(euler("2,3,4").unwrap().1, None);
        for bad in ["1,2,3", "1,2,3,4,5", "a,b,,d"] {
            assert!(quaternion(bad).unwrap_err().contains("takes 4 columns"), "{bad}");
        }
        assert_eq!(rate("200 Hz"), Ok(Rate::hz(200)));
        assert!(rate("0 Hz").is_err() && rate("200").is_err());
    }
}
