//! `[gps]`: a receiver's position and velocity, with its reported accuracy.

use super::{Row, Senses, Shape, Shown, Table};
use crate::keys::{Key, Name, Values};
use crate::quantity::{Kind, Sign};
use crate::random::Normals;
use crate::sensor::{Block, Kinds, SensorKind, Stage, Term, TermKind, units};
use glam::DVec3;

const EPH: Name<f64> = Name::new("eph");
const EPV: Name<f64> = Name::new("epv");
const SATELLITES: Name<u64> = Name::new("satellites");
const VELOCITY_NOISE_STD: Name<DVec3> = Name::new("velocity_noise_std");

pub(super) static ROW: Row = Row {
    name: "gps",
    shape: Shape::Position,
    senses: Senses::Course,
    components: &["north", "east", "down"],
    unit: "m",
    column_unit: "m",
    units: &units::GPS_UNITS,
    usual_rate: Some("5 Hz"),
    keys,
    may_repeat: true,
    shown: Shown::as_read("GPS position from the start", "displacement (m)", "m", "m·√s"),
    table: Table {
        convention: Some((
            "position",
            "WGS 84: geodetic latitude and longitude, deg, north and east positive; altitude above the ellipsoid, m; velocity north, east and down (whatever the nav frame), m/s",
        )),
        note: Some("position and velocity as the receiver reports them, then the true ones."),
        derived: None,
    },
};

fn keys() -> Vec<Key> {
    let length = Kind::LENGTH.signed(Sign::NonNegative);
    vec![
        EPH.scalar(length, "horizontal accuracy that it reports").or("1 m"),
        EPV.scalar(length, "vertical accuracy that it reports").or("1.5 m"),
        SATELLITES.whole(0, 254, "the number of satellites that it reports").or("12"),
    ]
}

/// What a receiver says of its own fix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Claims {
    /// Horizontal accuracy, m.
    pub eph: f64,
    /// Vertical accuracy, m.
    pub epv: f64,
    /// Satellites used.
    pub satellites: u8,
}

impl Claims {
    /// Of a plan's values.
    pub fn of(values: &Values) -> Claims {
        Claims {
            eph: values.get(EPH).unwrap_or_default(),
            epv: values.get(EPV).unwrap_or_default(),
            satellites: values.get(SATELLITES).unwrap_or_default() as u8,
        }
    }
}

/// White noise on the velocity of a fix: a fresh normal number each sample and axis.
pub(crate) static VELOCITY_NOISE: TermKind = TermKind {
    name: "velocity_noise",
    about: "a new normal random number on the receiver's velocity each sample",
    serves: Kinds::of(&[SensorKind::Gps]),
    stage: Stage::Reading,
    needs: &[],
    keys: |_| {
        vec![
            VELOCITY_NOISE_STD
                .per_axis(
                    Kind::SPEED.signed(Sign::NonNegative),
                    "standard deviation of each sample of the velocity",
                )
                .or("0"),
        ]
    },
    build: |values, context| {
        let sigma = values.get(VELOCITY_NOISE_STD).unwrap_or_default();
        Ok((sigma != DVec3::ZERO).then(|| {
            Box::new(VelocityNoise { sigma, normals: context.normals("velocity_noise", sigma) })
                as Box<dyn Term>
        }))
    },
};

struct VelocityNoise {
    sigma: DVec3,
    normals: Normals,
}

impl Term for VelocityNoise {
    #[inline(always)]
    fn apply(&mut self, block: &mut Block) {
        let (sigma, velocity) = (self.sigma.to_array(), block.velocity.each_mut().map(Vec::as_mut_slice));
        self.normals.zip(velocity, |axis, velocity, normal| *velocity += sigma[axis] * normal);
    }

    fn normals(&self) -> usize {
        self.normals.count()
    }
}
