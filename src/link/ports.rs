//! The serial ports of this machine.

use std::fmt;
use std::path::PathBuf;

use serialport::SerialPortType;

/// A serial port, and how to use it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Port {
    /// The device.
    pub path: PathBuf,
    /// The product name of a USB device.
    pub product: Option<String>,
    /// The manufacturer of a USB device.
    pub manufacturer: Option<String>,
    /// A command line that uses it.
    pub command: String,
}

impl fmt::Display for Port {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.path.display())?;
        match self.product.as_deref().or(self.manufacturer.as_deref()) {
            Some(what) => write!(f, " ({what})"),
            None => Ok(()),
        }
    }
}

/// Words in the product names of flight controllers that speak MAVLink.
const MAVLINK: &[&str] = &["px4", "3d robotics", "ardupilot", "hex/proficnc", "cubepilot"];

/// The serial ports of this machine, by path.
pub fn ports() -> Vec<Port> {
    let mut found: Vec<_> = serialport::available_ports()
        .unwrap_or_default()
        .into_iter()
        .map(|port| described(port.port_name, port.port_type))
        .collect();
    found.sort_by(|a, b| a.path.cmp(&b.path));
    found.dedup_by(|a, b| a.path == b.path);
    found
}

fn described(path: String, kind: SerialPortType) -> Port {
    let (product, manufacturer) = match kind {
        SerialPortType::UsbPort(usb) => (usb.product, usb.manufacturer),
        _ => (None, None),
    };
    let said = [&manufacturer, &product].map(|text| text.clone().unwrap_or_default());
    let said = said.join(" ").to_lowercase();
    let protocol = if MAVLINK.iter().any(|word| said.contains(word)) { "mavlink" } else { "mpu" };
    Port {
        command: format!("ratetable run still --to {protocol}@{path}"),
        path: path.into(),
        product,
        manufacturer,
    }
}

#[cfg(test)]
mod tests {
    use serialport::UsbPortInfo;

    use super::*;

    fn usb(manufacturer: &str, product: &str) -> SerialPortType {
        SerialPortType::UsbPort(UsbPortInfo {
            vid: 1,
            pid: 2,
            serial_number: None,
            manufacturer: Some(manufacturer.to_owned()),
            product: Some(product.to_owned()),
        })
    }

    #[test]
    fn a_flight_controller_comes_with_its_own_command() {
        let cases = [
            (usb("3D Robotics", "PX4 FMU v5.x"), "mavlink@/dev/ttyACM0"),
            (usb("ArduPilot", "Pixhawk1"), "mavlink@/dev/ttyACM0"),
            (usb("INAV", "MATEKF722"), "mpu@/dev/ttyACM0"),
            (usb("FTDI", "FT232R USB UART"), "mpu@/dev/ttyACM0"),
            (SerialPortType::Unknown, "mpu@/dev/ttyACM0"),
        ];
        for (kind, to) in cases {
            let port = described("/dev/ttyACM0".to_owned(), kind);
            assert_eq!(port.command, format!("ratetable run still --to {to}"));
        }
    }

    #[test]
    fn ports_are_in_order_and_each_is_there_once() {
        let ports = ports();
        assert!(ports.windows(2).all(|pair| pair[0].path < pair[1].path));
    }
}
