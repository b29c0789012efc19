//! A published driver, unmodified, on a bus of the emulator: `ratetable run … --to bus@pty -- driver {}`.

#![allow(clippy::print_stdout, reason = "an example's readings")]

use std::env;
use std::error::Error;
use std::fs::File;
use std::io::{Read, Write};
use std::thread::sleep;
use std::time::Duration;

use bmi160::{AccelerometerPowerMode, Bmi160, GyroscopePowerMode, SensorSelector, SlaveAddr};
use embedded_hal::i2c::{ErrorKind, ErrorType, I2c, NoAcknowledgeSource, Operation};
use ratetable_protocols::bridge::{Client, Port, Status, Trouble};

/// The UART to the bridge. A pty is raw already; set a serial port to raw and to the bridge's speed first.
struct Uart(File);

impl Port for Uart {
    type Error = std::io::Error;

    fn send(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        self.0.write_all(bytes)
    }

    fn receive(&mut self, bytes: &mut [u8]) -> std::io::Result<()> {
        self.0.read_exact(bytes)
    }
}

/// The I2C bus behind the bridge, as embedded-hal 1.0 wants it.
struct Bus(Client<Uart>);

#[derive(Debug)]
struct Failed(Trouble<std::io::Error>);

impl embedded_hal::i2c::Error for Failed {
    fn kind(&self) -> ErrorKind {
        match self.0 {
            Trouble::Refused(Status::NoAddress) => ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address),
            _ => ErrorKind::Other,
        }
    }
}

impl ErrorType for Bus {
    type Error = Failed;
}

impl I2c for Bus {
    /// Drivers write, read, or write a register's address and read: these a bridge can do. Writes in a row are one.
    fn transaction(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), Failed> {
        let mut written = Vec::new();
        let mut is_open = false;
        for operation in operations {
            match operation {
                Operation::Write(bytes) => {
                    written.extend_from_slice(bytes);
                    is_open = true;
                }
                Operation::Read(out) if is_open => {
                    self.0.write_read(address, &written, out).map_err(Failed)?;
                    written.clear();
                    is_open = false;
                }
                Operation::Read(out) => self.0.read(address, out).map_err(Failed)?,
            }
        }
        if is_open { self.0.write(address, &written).map_err(Failed) } else { Ok(()) }
    }
}

/// Reads every sample until the bus is gone: how many.
pub fn read(path: &str) -> Result<u64, Box<dyn Error>> {
    let bus = Bus(Client::new(Uart(File::options().read(true).write(true).open(path)?)));
    let mut imu = Bmi160::new_with_i2c(bus, SlaveAddr::Default);
    println!("chip {:#04x}", imu.chip_id().map_err(said)?);
    imu.set_gyro_power_mode(GyroscopePowerMode::Normal).map_err(said)?;
    imu.set_accel_power_mode(AccelerometerPowerMode::Normal).map_err(said)?;
    let mut samples = 0;
    // The bus ends with the run.
    while let Ok(status) = imu.status() {
        if !status.gyro_data_ready {
            sleep(Duration::from_millis(1));
            continue;
        }
        let Ok(data) = imu.data_scaled(SensorSelector::new().gyro().accel()) else { break };
        if let (Some(gyro), Some(accel), 0) = (data.gyro, data.accel, samples % 100) {
            println!("gyro z {:.1} deg/s, accel z {:.2} g", gyro.z, accel.z);
        }
        samples += 1;
    }
    Ok(samples)
}

fn said(error: bmi160::Error<Failed>) -> String {
    format!("{error:?}")
}

fn main() -> Result<(), Box<dyn Error>> {
    let path = env::args().nth(1).ok_or("give the path of the bus")?;
    println!("{} samples", read(&path)?);
    Ok(())
}
