//! Renode's sample files for its sensor models: the readings alone, in chip axes, rounded to the format's units.
//!
//! ```text
//! file   "RESD", version 1, three zeros, then blocks
//! block  u8 type, u16 sample type, u16 channel, u64 size of what follows, then as type 2 (constant frequency) has it:
//!        u64 time of its first sample in ns, u64 period in ns, u64 size of the metadata (0), the samples
//! ```
//!
//! Little-endian. A sample counts until the next one: within a block for the period. So a block ends wherever the spacing
//! of the samples changes, and the block of one sample before a gap has the gap for its period. Every time is exact,
//! whatever the rate, and no moment is left without a sample, for which Renode's models put their defaults. Blocks with
//! a timestamp a sample (type 1) would be exact too, but Renode never gives the last sample of one as current and warns
//! of each that it passes.
//!
//! Format: Renode's documentation, "Renode Sensor Data Format (RESD)", version 1; the size is of 8 bytes, as its example
//! and its parser have it.

use super::error::DatasetError;
use super::folder::{Folder, Sink};
use super::format::{Format, Writer, Written};
use super::table::{TRUTH, Table};
use crate::scene::Plan;
use crate::sensor::{Measurement, Mount, Reading, SensorKind, SensorPlan, TEMPERATURE};
use crate::time::SimTime;
use glam::DVec3;

pub(super) static FORMAT: Format = Format {
    name: "resd",
    about: "the readings for Renode's sensor models, in chip axes: `FeedAngularRateSamplesFromRESD @dataset.resd`",
    open,
};

const NAME: &str = "dataset.resd";
const HEADER: &[u8] = b"RESD\x01\0\0\0";
const CONSTANT_FREQUENCY: u8 = 2;
const CELSIUS: u16 = 1;
/// Bytes behind a block's size that are no samples: first time, period, size of the metadata.
const BEFORE_SAMPLES: usize = 24;
/// The format's g, m/s²: the 3rd General Conference on Weights and Measures, 1901.
const STANDARD_GRAVITY: f64 = 9.80665;
/// A block ends when its samples have so many bytes.
const LIMIT: usize = 1 << 18;

fn open(plan: &Plan, _: &[Table], folder: &Folder) -> Result<Box<dyn Writer>, DatasetError> {
    let mut sink = folder.file(NAME)?;
    sink.put(HEADER)?;
    let sensors = plan.sensors.iter().map(Sensor::of).collect();
    Ok(Box::new(Resd { sink, sensors, samples: 0 }))
}

struct Resd {
    sink: Sink,
    /// In the plan's order.
    sensors: Vec<Sensor>,
    samples: u64,
}

impl Writer for Resd {
    fn row(&mut self, _: usize, _: SimTime, _: &[f64]) -> Result<(), DatasetError> {
        Ok(())
    }

    fn reading(
        &mut self,
        table: usize,
        t: SimTime,
        reading: &Reading,
        _: &[f64],
    ) -> Result<(), DatasetError> {
        let sensor = &mut self.sensors[table - TRUTH - 1];
        if let (Some(stream), Some(sample)) = (&mut sensor.readings, sensor.axes.sample(reading)) {
            stream.add(t, sample, &mut self.sink)?;
            self.samples += 1;
        }
        if let Some(stream) = &mut sensor.temperatures {
            stream.add(t, Sample::celsius(reading.temperature), &mut self.sink)?;
            self.samples += 1;
        }
        Ok(())
    }

    fn finish(mut self: Box<Self>, _: &[u64]) -> Result<Vec<Written>, DatasetError> {
        let streams = self.sensors.into_iter().flat_map(|sensor| [sensor.readings, sensor.temperatures]);
        streams.flatten().try_for_each(|stream| stream.finish(&mut self.sink))?;
        self.sink.close()?;
        Ok(vec![Written { name: NAME.into(), rows: self.samples, columns: Vec::new() }])
    }
}

/// What a sensor of the plan writes.
struct Sensor {
    axes: ChipAxes,
    /// None where the format has no sample for it.
    readings: Option<Stream>,
    /// Of the part, where the scene gives it.
    temperatures: Option<Stream>,
}

impl Sensor {
    fn of(sensor: &SensorPlan) -> Sensor {
        let stream = |sample_type, channel| Stream::new(sample_type, channel, sensor.rate.tick(1));
        let has_temperature = sensor.values.get(TEMPERATURE).is_some();
        Sensor {
            axes: ChipAxes::of(sensor),
            readings: sample_type(sensor.kind).map(|sample_type| stream(sample_type, 0)),
            temperatures: has_temperature.then(|| stream(CELSIUS, sensor.kind as u16)),
        }
    }
}

/// None for positions, and for the pressure of a pitot tube, which may be negative: the format's may not.
fn sample_type(kind: SensorKind) -> Option<u16> {
    match kind {
        SensorKind::Accel => Some(2),
        SensorKind::Gyro => Some(3),
        SensorKind::Baro => Some(7),
        SensorKind::Mag => Some(8),
        SensorKind::Gps | SensorKind::Airspeed => None,
    }
}

/// From the body's axes to those of the chip that has the registers.
struct ChipAxes {
    mount: Mount,
    /// From a package's axes to those of the magnetometer's own chip within it.
    inside: [DVec3; 3],
}

impl ChipAxes {
    /// A sensor without a mount is taken for a chip that lies flat, x forward and z up, as `mpu` does.
    fn of(sensor: &SensorPlan) -> ChipAxes {
        let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z];
        let inside = match (sensor.kind, sensor.part) {
            // PS-MPU-9250A section 9.1 and DS-000189, orientation of axes.
            (SensorKind::Mag, Some("MPU-9250")) => [y, x, -z],
            (SensorKind::Mag, Some("ICM-20948")) => [x, -y, -z],
            _ => [x, y, z],
        };
        ChipAxes { mount: sensor.mount.unwrap_or_else(Mount::flu), inside }
    }

    fn sample(&self, reading: &Reading) -> Option<Sample> {
        let per_unit = match reading.kind {
            SensorKind::Accel => 1e6 / STANDARD_GRAVITY,
            SensorKind::Gyro => 1e5,
            _ => 1e3,
        };
        match &reading.measurement {
            Measurement::Triad(measured) => {
                let package = self.mount.to_chip(measured.value).v;
                Some(Sample::triad(self.inside.map(|axis| axis.dot(package) * per_unit)))
            }
            Measurement::Pressure(measured) => Some(Sample::pascals(measured.value)),
            Measurement::Position(_) => None,
        }
    }
}

/// A sample's bytes.
#[derive(Clone, Copy)]
struct Sample {
    bytes: [u8; 12],
    len: usize,
}

impl Sample {
    /// The nearest whole numbers, at the ends of 32 bits what is beyond them.
    fn triad(values: [f64; 3]) -> Sample {
        let mut bytes = [0; 12];
        for (bytes, value) in bytes.chunks_exact_mut(4).zip(values) {
            bytes.copy_from_slice(&(libm::round(value) as i32).to_le_bytes());
        }
        Sample { bytes, len: 12 }
    }

    fn celsius(value: f64) -> Sample {
        Sample { len: 4, ..Sample::triad([value * 1e3, 0.0, 0.0]) }
    }

    fn pascals(value: f64) -> Sample {
        let mut bytes = [0; 12];
        bytes[..8].copy_from_slice(&(libm::round(value * 1e3) as u64).to_le_bytes());
        Sample { bytes, len: 8 }
    }
}

/// The samples of one type and channel, gathered into a block for as long as their spacing is the same.
struct Stream {
    sample_type: u16,
    channel: u16,
    /// The block being gathered: its first time and period, ns, and its samples.
    start: i64,
    period: i64,
    block: Vec<u8>,
    /// The newest sample, whose block the time of the next one decides.
    held: Option<(i64, Sample)>,
}

impl Stream {
    /// `period` is that of a stream of one sample.
    fn new(sample_type: u16, channel: u16, period: SimTime) -> Stream {
        Stream { sample_type, channel, start: 0, period: period.0.max(1), block: Vec::new(), held: None }
    }

    fn add(&mut self, t: SimTime, sample: Sample, sink: &mut Sink) -> Result<(), DatasetError> {
        let held = self.held.replace((t.0, sample));
        match held {
            // Of two samples at one time the format has room for one.
            Some((before, held)) if before < t.0 => self.gather(before, t.0 - before, held, sink),
            _ => Ok(()),
        }
    }

    /// Adds a sample that counts for so long, behind the others if it is as long for them.
    fn gather(&mut self, t: i64, period: i64, sample: Sample, sink: &mut Sink) -> Result<(), DatasetError> {
        if period != self.period || self.block.len() >= LIMIT {
            self.put_block(sink)?;
        }
        if self.block.is_empty() {
            (self.start, self.period) = (t, period);
        }
        self.block.extend_from_slice(&sample.bytes[..sample.len]);
        Ok(())
    }

    fn put_block(&mut self, sink: &mut Sink) -> Result<(), DatasetError> {
        if self.block.is_empty() {
            return Ok(());
        }
        let mut header = [0; 13 + BEFORE_SAMPLES];
        header[0] = CONSTANT_FREQUENCY;
        header[1..3].copy_from_slice(&self.sample_type.to_le_bytes());
        header[3..5].copy_from_slice(&self.channel.to_le_bytes());
        header[5..13].copy_from_slice(&((BEFORE_SAMPLES + self.block.len()) as u64).to_le_bytes());
        header[13..21].copy_from_slice(&self.start.to_le_bytes());
        header[21..29].copy_from_slice(&self.period.to_le_bytes());
        sink.put(&header)?;
        sink.put(&self.block)?;
        self.block.clear();
        Ok(())
    }

    /// The last sample counts for as long as the one before it.
    fn finish(mut self, sink: &mut Sink) -> Result<(), DatasetError> {
        if let Some((t, sample)) = self.held.take() {
            self.gather(t, self.period, sample, sink)?;
        }
        self.put_block(sink)
    }
}

#[cfg(test)]
mod tests {
    use super::super::listed::Holds;
    use super::*;
    use crate::geometry::Vector;
    use proptest::prelude::*;

    /// A block of a file: type, sample type, channel, first time, period, the samples' bytes.
    type Block = (u8, u16, u16, u64, u64, Vec<u8>);

    /// Blocks by the format's page.
    fn blocks(mut bytes: &[u8]) -> Vec<Block> {
        let mut take = |n: usize| {
            let (taken, rest) = bytes.split_at(n);
            bytes = rest;
            (taken.to_vec(), rest.is_empty())
        };
        let number =
            |bytes: Vec<u8>| bytes.iter().rev().fold(0, |sum: u64, byte| sum << 8 | u64::from(*byte));
        let mut blocks = Vec::new();
        loop {
            let kind = take(1).0[0];
            let [sample_type, channel] = [(); 2].map(|()| number(take(2).0) as u16);
            let size = number(take(8).0);
            let [start, period, metadata] = [(); 3].map(|()| number(take(8).0));
            assert_eq!(metadata, 0);
            let (samples, over) = take(size as usize - 24);
            blocks.push((kind, sample_type, channel, start, period, samples));
            if over {
                return blocks;
            }
        }
    }

    /// What a stream of type 1 writes of these times, each sample its own number.
    fn written(times: &[i64]) -> Vec<Block> {
        let home = tempfile::tempdir().unwrap();
        let folder = Folder::open(&home.path().join("out"), false, Holds::Dataset).unwrap();
        let mut sink = folder.file(NAME).unwrap();
        let mut stream = Stream::new(CELSIUS, 3, SimTime(7));
        for (i, t) in times.iter().enumerate() {
            stream.add(SimTime(*t), Sample::celsius(i as f64 * 1e-3), &mut sink).unwrap();
        }
        stream.finish(&mut sink).unwrap();
        sink.close().unwrap();
        blocks(&std::fs::read(folder.path(NAME)).unwrap())
    }

    /// Time and number of each sample.
    fn samples(blocks: &[Block]) -> Vec<(i64, usize)> {
        let of = |(_, _, _, start, period, bytes): &Block| {
            let at = |(k, bytes): (usize, &[u8])| {
                ((start + k as u64 * period) as i64, i32::from_le_bytes(bytes.try_into().unwrap()) as usize)
            };
            bytes.chunks(4).enumerate().map(at).collect::<Vec<_>>()
        };
        blocks.iter().flat_map(of).collect()
    }

    #[test]
    fn a_rate_that_changes_begins_a_block_and_a_gap_is_the_period_of_the_sample_before_it() {
        let shape = |times: &[i64]| -> Vec<(u64, u64, usize)> {
            written(times)
                .iter()
                .map(|(_, _, _, start, period, it)| (*start, *period, it.len() / 4))
                .collect()
        };
        assert_eq!(shape(&[5]), [(5, 7, 1)], "one sample alone has the sensor's period");
        assert_eq!(shape(&[0, 10, 20, 30]), [(0, 10, 4)]);
        assert_eq!(
            shape(&[0, 10, 20, 22, 24, 26]),
            [(0, 10, 2), (20, 2, 4)],
            "five times as fast from 20 on"
        );
        assert_eq!(shape(&[0, 10, 20, 50, 60, 70]), [(0, 10, 2), (20, 30, 1), (50, 10, 3)], "30 and 40 lack");
        assert_eq!(shape(&[0, 333, 667, 1000, 1333]), [(0, 333, 1), (333, 334, 1), (667, 333, 3)]);
    }

    #[test]
    fn a_long_stream_is_in_blocks_of_a_bounded_size() {
        let times: Vec<i64> = (0..200_000).map(|k| 1000 * k).collect();
        let blocks = written(&times);
        assert_eq!(
            blocks.iter().map(|block| block.5.len()).collect::<Vec<_>>(),
            [LIMIT, LIMIT, LIMIT, 13_568]
        );
        assert_eq!(samples(&blocks), (0..200_000).map(|k| (1000 * k as i64, k)).collect::<Vec<_>>());
    }

    proptest! {
        #[test]
        fn any_times_read_back_exactly_and_no_moment_between_them_is_without_a_sample(
            start in 0..1i64 << 60,
            steps in prop::collection::vec((1..5i64, 1..20usize), 1..30),
        ) {
            let mut times = vec![start];
            for (step, n) in steps {
                times.extend((1..=n as i64).scan(times[times.len() - 1], |last, _| { *last += step; Some(*last) }));
            }
            let blocks = written(&times);
            let expected: Vec<_> = times.iter().enumerate().map(|(i, t)| (*t, i)).collect();
            prop_assert_eq!(samples(&blocks), expected);
            prop_assert!(blocks.iter().all(|(kind, sample, channel, ..)| (*kind, *sample, *channel) == (2, 1, 3)));
            for pair in blocks.windows(2) {
                let (_, _, _, start, period, samples) = &pair[0];
                prop_assert_eq!(start + period * (samples.len() / 4) as u64, pair[1].3);
            }
        }
    }

    #[test]
    fn a_sample_is_the_nearest_whole_number_of_its_unit_and_ends_where_32_bits_do() {
        let sample = |values| {
            let Sample { bytes, len } = Sample::triad(values);
            let of = |i: usize| i32::from_le_bytes(bytes[4 * i..4 * i + 4].try_into().unwrap());
            (len, [of(0), of(1), of(2)])
        };
        assert_eq!(sample([1.4, -1.6, 0.0]), (12, [1, -2, 0]));
        assert_eq!(sample([1e30, -1e30, f64::NAN]), (12, [i32::MAX, i32::MIN, 0]));
        assert_eq!(Sample::pascals(101_325.000_4).bytes[..8], 101_325_000u64.to_le_bytes());
        assert_eq!(Sample::pascals(-3.0).bytes[..8], [0; 8]);
        assert_eq!(Sample::celsius(-40.0).bytes[..4], (-40_000i32).to_le_bytes());
    }

    /// At rest and level a chip that lies flat reads +1 g on z; of the field, 20 µT north, 5 east and 40 down, the
    /// magnetometer inside a package reads on axes of its own.
    #[test]
    fn a_reading_is_on_the_axes_of_the_chip_that_has_the_registers() {
        let read = |kind: SensorKind, more: &str, value: [f64; 3]| {
            let text = format!("duration = \"1 s\"\n[{kind}]\nrate = \"100 Hz\"\n{more}\n");
            let plan = Plan::parse(&text, "test", "test", &[]).unwrap();
            let [x, y, z] = value;
            let reading = Reading::zero(0, kind).with_body(Vector::new(x, y, z));
            let bytes = ChipAxes::of(&plan.sensors[0]).sample(&reading).unwrap().bytes;
            [0, 4, 8].map(|i| i32::from_le_bytes(bytes[i..i + 4].try_into().unwrap()))
        };
        let rest = [0.0, 0.0, -STANDARD_GRAVITY];
        assert_eq!(read(SensorKind::Accel, "", rest), [0, 0, 1_000_000]);
        assert_eq!(read(SensorKind::Accel, "mount = \"frd\"", rest), [0, 0, -1_000_000]);
        assert_eq!(read(SensorKind::Gyro, "part = \"BMI270\"", [0.1, 0.2, 0.3]), [10_000, -20_000, -30_000]);
        let field = [20.0, 5.0, 40.0];
        for (more, axes) in [
            ("", [20_000, -5_000, -40_000]),
            ("part = \"AK09916\"", [20_000, -5_000, -40_000]),
            ("part = \"ICM-20948\"", [20_000, 5_000, 40_000]),
            ("part = \"MPU-9250\"", [-5_000, 20_000, 40_000]),
        ] {
            assert_eq!(read(SensorKind::Mag, more, field), axes, "{more}");
        }
    }
}
