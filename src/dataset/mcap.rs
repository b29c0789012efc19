//! MCAP as ROS 2 records it: readings and truth as `sensor_msgs` messages in CDR, in one file `dataset.mcap`.
//!
//! | topic | message | holds |
//! |---|---|---|
//! | `/imu/data_raw` | `sensor_msgs/msg/Imu` | gyroscope and accelerometer, where both have the same ticks |
//! | `/imu/gyro`, `/imu/accel` | the same | each by itself, where they have not |
//! | `/imu/mag` | `sensor_msgs/msg/MagneticField` | magnetometer, in tesla |
//! | `/imu/gyro/true`, `/imu/gyro/bias` … | `geometry_msgs/msg/Vector3Stamped` | error-free reading and bias in effect: rad/s, m/s², tesla |
//! | `/baro` | `sensor_msgs/msg/FluidPressure` | barometer, in pascal |
//! | `/airspeed` | `sensor_msgs/msg/FluidPressure` | differential pressure of a pitot tube, in pascal |
//! | `/gps/fix` | `sensor_msgs/msg/NavSatFix` | GPS position, in degrees and metres above the ellipsoid |
//! | `/gps/velocity` | `geometry_msgs/msg/Vector3Stamped` | GPS velocity, in the scene's nav axes |
//! | `/truth`, `/truth/mag` | `Imu`, `MagneticField` | the exact attitude, angular rate, specific force and field |
//! | `/reference`, `/estimate` | `geometry_msgs/msg/QuaternionStamped` | attitudes, where the dataset has them |
//!
//! What a message does not hold has −1 as the first element of its covariance, as the message's own definition wants
//! it; the other covariances are 0, unknown. Format: MCAP specification, with its ROS 2 profile.

use super::error::DatasetError;
use super::folder::{Folder, Sink};
use super::format::{Format, Writer, Written};
use super::table::{TRUTH, Table};
use crate::geometry::{Axes, Vector};
use crate::ros::{
    Imu, Kind, Stamped, fluid_pressure, frames, imu, magnetic_field, nav_sat_fix, quaternion, vector,
};
use crate::scene::Plan;
use crate::sensor::{SensorKind, SensorPlan};
use crate::time::SimTime;
use ::mcap::records::MessageHeader;
use ::mcap::{McapError, WriteOptions};
use glam::DVec3;
use std::collections::BTreeMap;

pub(super) static FORMAT: Format = Format {
    name: "mcap",
    about: "one file of ROS 2 messages (`sensor_msgs/msg/Imu`, `MagneticField` in tesla, `FluidPressure`, `NavSatFix`), as rosbag2 records them",
    open,
};

const FILE: &str = "dataset.mcap";

fn open(plan: &Plan, tables: &[Table], folder: &Folder) -> Result<Box<dyn Writer>, DatasetError> {
    let options = WriteOptions::new()
        .profile("ros2")
        .library(concat!(env!("CARGO_PKG_NAME"), " ", env!("CARGO_PKG_VERSION")))
        .compression(None);
    let writer = options.create(folder.file(FILE)?).map_err(failed)?;
    let mut mcap = Mcap {
        writer,
        axes: plan.axes,
        frames: frames(plan.axes),
        shapes: shapes(plan, tables),
        channels: Vec::new(),
        held: None,
        bytes: Vec::with_capacity(512),
    };
    mcap.announce()?;
    Ok(Box::new(mcap))
}

/// What a table's rows become.
#[derive(Clone, Copy, PartialEq)]
enum Shape {
    /// Exact attitude, rate and force; the field on a topic of its own.
    Truth,
    /// A gyroscope that waits for the accelerometer's row of the same time.
    Held,
    /// An accelerometer together with the gyroscope that waits.
    Both,
    Gyro,
    Accel,
    Mag,
    /// Of the topic with this name.
    Pressure(&'static str),
    Gps,
    Attitude(&'static str),
}

impl Shape {
    /// The topics, each with its message.
    fn topics(self) -> Vec<(&'static str, Kind)> {
        match self {
            Shape::Truth => vec![("/truth", Kind::Imu), ("/truth/mag", Kind::MagneticField)],
            Shape::Held => with_errors(None, ["/imu/gyro/true", "/imu/gyro/bias"]),
            Shape::Both => {
                with_errors(Some(("/imu/data_raw", Kind::Imu)), ["/imu/accel/true", "/imu/accel/bias"])
            }
            Shape::Gyro => with_errors(Some(("/imu/gyro", Kind::Imu)), ["/imu/gyro/true", "/imu/gyro/bias"]),
            Shape::Accel => {
                with_errors(Some(("/imu/accel", Kind::Imu)), ["/imu/accel/true", "/imu/accel/bias"])
            }
            Shape::Mag => {
                with_errors(Some(("/imu/mag", Kind::MagneticField)), ["/imu/mag/true", "/imu/mag/bias"])
            }
            Shape::Pressure(topic) => vec![(topic, Kind::FluidPressure)],
            Shape::Gps => vec![("/gps/fix", Kind::NavSatFix), ("/gps/velocity", Kind::Vector)],
            Shape::Attitude("estimate") => vec![("/estimate", Kind::Quaternion)],
            Shape::Attitude(_) => vec![("/reference", Kind::Quaternion)],
        }
    }
}

/// A reading's topic, where it has one to itself, before those of what it would be and of its bias.
fn with_errors(
    reading: Option<(&'static str, Kind)>,
    errors: [&'static str; 2],
) -> Vec<(&'static str, Kind)> {
    reading.into_iter().chain(errors.map(|topic| (topic, Kind::Vector))).collect()
}

/// The shape of each table's rows.
fn shapes(plan: &Plan, tables: &[Table]) -> Vec<Shape> {
    let find = |kind| plan.sensors.iter().find(|sensor| sensor.kind == kind);
    let pair = find(SensorKind::Gyro).zip(find(SensorKind::Accel));
    let together = pair.is_some_and(|(gyro, accel)| gyro.ticks_with(accel));
    let sensor = |sensor: &SensorPlan| match (sensor.kind, together) {
        (SensorKind::Gyro, true) => Shape::Held,
        (SensorKind::Gyro, false) => Shape::Gyro,
        (SensorKind::Accel, true) => Shape::Both,
        (SensorKind::Accel, false) => Shape::Accel,
        (SensorKind::Mag, _) => Shape::Mag,
        (SensorKind::Baro, _) => Shape::Pressure("/baro"),
        (SensorKind::Airspeed, _) => Shape::Pressure("/airspeed"),
        (SensorKind::Gps, _) => Shape::Gps,
    };
    let readings = plan.sensors.iter().map(sensor);
    let others = tables[TRUTH + 1 + plan.sensors.len()..].iter().map(|table| Shape::Attitude(table.name));
    [Shape::Truth].into_iter().chain(readings).chain(others).collect()
}

struct Mcap {
    writer: ::mcap::Writer<Sink>,
    axes: Axes,
    /// Nav and body.
    frames: [&'static str; 2],
    shapes: Vec<Shape>,
    /// Channels of each table, each with the number of its next message.
    channels: Vec<Vec<(u16, u32)>>,
    /// The gyroscope's reading that waits, and when it was.
    held: Option<(SimTime, [f64; 3])>,
    bytes: Vec<u8>,
}

impl Mcap {
    /// Every topic, before its first message.
    fn announce(&mut self) -> Result<(), DatasetError> {
        for shape in &self.shapes {
            let mut channels = Vec::new();
            for (topic, kind) in shape.topics() {
                let (name, definition) = kind.schema();
                let schema =
                    self.writer.add_schema(name, "ros2msg", definition.as_bytes()).map_err(failed)?;
                let channel = self.writer.add_channel(schema, topic, "cdr", &BTreeMap::new());
                channels.push((channel.map_err(failed)?, 0));
            }
            self.channels.push(channels);
        }
        Ok(())
    }

    /// An `Imu` without attitude.
    fn send_imu(
        &mut self,
        table: usize,
        t: SimTime,
        rate: Option<[f64; 3]>,
        force: Option<[f64; 3]>,
    ) -> Result<(), DatasetError> {
        imu(Stamped { t, frame: self.frames[1] }, &Imu { attitude: None, rate, force }, &mut self.bytes);
        self.send(table, 0, t)
    }

    /// Gives up waiting for the accelerometer, whose sample a fault withholds.
    fn send_held(&mut self) -> Result<(), DatasetError> {
        let both = self.shapes.iter().position(|shape| *shape == Shape::Both);
        match both.zip(self.held.take()) {
            Some((table, (t, rate))) => self.send_imu(table, t, Some(rate), None),
            None => Ok(()),
        }
    }

    /// What a sensor's reading would be without errors, and its bias: the last two topics of its table.
    fn send_errors(&mut self, table: usize, t: SimTime, values: &[f64]) -> Result<(), DatasetError> {
        let microtesla = self.shapes[table] == Shape::Mag;
        let topics = self.channels[table].len();
        for (topic, values) in [(topics - 2, &values[3..6]), (topics - 1, &values[6..9])] {
            let unit = |i: usize| if microtesla { values[i] * 1e-6 } else { values[i] };
            vector(Stamped { t, frame: self.frames[1] }, [0, 1, 2].map(unit), &mut self.bytes);
            self.send(table, topic, t)?;
        }
        Ok(())
    }

    /// Sends what stands in `bytes`.
    fn send(&mut self, table: usize, topic: usize, t: SimTime) -> Result<(), DatasetError> {
        let (channel_id, sequence) = self.channels[table][topic];
        self.channels[table][topic].1 = sequence.wrapping_add(1);
        // A scene begins at 0.
        let time = t.0.unsigned_abs();
        let header = MessageHeader { channel_id, sequence, log_time: time, publish_time: time };
        self.writer.write_to_known_channel(&header, &self.bytes).map_err(failed)
    }
}

impl Writer for Mcap {
    fn row(&mut self, table: usize, t: SimTime, values: &[f64]) -> Result<(), DatasetError> {
        let [nav, body] = self.frames;
        let in_body = Stamped { t, frame: body };
        let triple = |at: usize| -> [f64; 3] { std::array::from_fn(|axis| values[at + axis]) };
        let first: [f64; 3] = triple(0);
        let bytes = &mut self.bytes;
        match self.shapes[table] {
            Shape::Held => {
                self.send_held()?;
                self.held = Some((t, first));
                return self.send_errors(table, t, values);
            }
            Shape::Truth => {
                let attitude = std::array::from_fn(|i| values[i]);
                let all = Imu { attitude: Some(attitude), rate: Some(triple(7)), force: Some(triple(10)) };
                imu(in_body, &all, bytes);
                self.send(table, 0, t)?;
                magnetic_field(in_body, triple(13), &mut self.bytes);
                return self.send(table, 1, t);
            }
            Shape::Both => {
                let rate = self.held.take_if(|(held, _)| *held == t).map(|(_, rate)| rate);
                self.send_held()?;
                self.send_imu(table, t, rate, Some(first))?;
            }
            Shape::Gyro => self.send_imu(table, t, Some(first), None)?,
            Shape::Accel => self.send_imu(table, t, None, Some(first))?,
            Shape::Mag => {
                magnetic_field(in_body, first, bytes);
                self.send(table, 0, t)?;
            }
            Shape::Pressure(_) => {
                fluid_pressure(in_body, values[0], bytes);
                return self.send(table, 0, t);
            }
            Shape::Gps => {
                nav_sat_fix(in_body, first, bytes);
                self.send(table, 0, t)?;
                let velocity = self.axes.nav_out(Vector::from_vec(DVec3::from_array(triple(3))));
                vector(Stamped { t, frame: nav }, velocity.to_array(), &mut self.bytes);
                return self.send(table, 1, t);
            }
            Shape::Attitude(_) => {
                quaternion(Stamped { t, frame: nav }, std::array::from_fn(|i| values[i]), bytes);
                return self.send(table, 0, t);
            }
        }
        self.send_errors(table, t, values)
    }

    fn finish(mut self: Box<Self>, _: &[u64]) -> Result<Vec<Written>, DatasetError> {
        self.send_held()?;
        self.writer.finish().map_err(failed)?;
        let rows = self.channels.iter().flatten().map(|(_, sent)| u64::from(*sent)).sum();
        self.writer.into_inner().close()?;
        Ok(vec![Written { name: FILE.into(), rows, columns: Vec::new() }])
    }
}

fn failed(error: McapError) -> DatasetError {
    DatasetError::Content { place: FILE.into(), problem: format!("cannot be written: {error}") }
}
