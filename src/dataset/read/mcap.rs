//! MCAP back: attitudes and readings out of the ROS 2 messages that hold them.

use super::super::DatasetError;
use super::rows::{Rows, What, open, refuse};
use crate::sensor::SensorKind;
use ::mcap::records::Record;
use ::mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader};
use ::mcap::{McapError, parse_record};
use std::collections::BTreeMap;
use std::io::Read;
use std::path::Path;

/// Numbers of `sensor_msgs/msg/Imu`: orientation (x, y, z, w), rate and force, each with its nine covariances.
const IMU: usize = 37;
/// Of `sensor_msgs/msg/MagneticField`: the field, and its covariances.
const FIELD: usize = 12;
/// Microtesla in a tesla.
const MICROTESLA: f64 = 1e6;

pub(super) fn read(file: &Path, what: What, names: &[&str]) -> Result<Rows, DatasetError> {
    let (mut input, _) = open(file)?;
    let failed = |error: McapError| refuse(file, format!("cannot be read: {error}"));
    let mut reader = LinearReader::new();
    let mut topics: BTreeMap<u16, bool> = BTreeMap::new();
    let mut read = Rows { times: Vec::new(), columns: vec![Vec::new(); names.len()] };
    while let Some(event) = reader.next_event() {
        match event.map_err(failed)? {
            LinearReadEvent::ReadRequest(most) => {
                let count = input.read(reader.insert(most)).map_err(DatasetError::io("read", file))?;
                reader.notify_read(count);
            }
            LinearReadEvent::Record { data, opcode } => match parse_record(opcode, data).map_err(failed)? {
                Record::Channel(channel) => {
                    topics.insert(channel.id, is_of(what, &channel.topic));
                }
                Record::Message { header, data } if topics.get(&header.channel_id) == Some(&true) => {
                    let short =
                        || refuse(file, format!("the message at {} ns is cut short", header.log_time));
                    let Some(values) = values(what, &data).ok_or_else(short)? else { continue };
                    read.times.push(i64::try_from(header.log_time).unwrap_or(i64::MAX));
                    read.columns.iter_mut().zip(values).for_each(|(column, value)| column.push(value));
                }
                _ => {}
            },
        }
    }
    Ok(read)
}

/// Whether a topic brings the table.
fn is_of(what: What, topic: &str) -> bool {
    let topics: &[&str] = match what {
        What::Truth => &["/truth"],
        What::Sensor(SensorKind::Gyro) => &["/imu/data_raw", "/imu/gyro"],
        What::Sensor(SensorKind::Accel) => &["/imu/data_raw", "/imu/accel"],
        What::Sensor(_) => &["/imu/mag"],
    };
    topics.contains(&topic)
}

/// What a message says of the table: nothing, if its covariance says that it does not hold it. `None` if it is cut short.
fn values(what: What, message: &[u8]) -> Option<Option<Vec<f64>>> {
    let (at, covariance, of) = match what {
        What::Truth => (0..4, 4, IMU),
        What::Sensor(SensorKind::Gyro) => (13..16, 16, IMU),
        What::Sensor(SensorKind::Accel) => (25..28, 28, IMU),
        What::Sensor(_) => (0..3, 3, FIELD),
    };
    let numbers = numbers(message, of)?;
    let mut values = numbers[at].to_vec();
    match what {
        // x, y, z, w.
        What::Truth => values.rotate_right(1),
        What::Sensor(SensorKind::Mag) => values.iter_mut().for_each(|value| *value *= MICROTESLA),
        What::Sensor(_) => {}
    }
    Some((numbers[covariance] != -1.0).then_some(values))
}

/// The numbers behind the header of a message in little-endian CDR.
fn numbers(message: &[u8], count: usize) -> Option<Vec<f64>> {
    // Behind four bytes of encapsulation: the time, then the name of the frame with its length.
    let body = message.get(4..)?;
    let length = u32::from_le_bytes(body.get(8..12)?.try_into().ok()?) as usize;
    let start = length.checked_add(12)?.checked_next_multiple_of(8)?;
    let cells = body.get(start..start.checked_add(8 * count)?)?.chunks_exact(8);
    Some(cells.map(|cell| f64::from_le_bytes(std::array::from_fn(|i| cell[i]))).collect())
}
