//! The link budget: bytes a second that an output needs against what its baud rate carries.

use super::ways_out::WaysOut;
use crate::link::bytes_per_second;
use crate::report::number;
use crate::scene::{Destination, Output, Overload, Plan};
use crate::sensor::SensorPlan;
use crate::wire::{self, Protocol, Setup};
use std::fmt;

/// What an output asks of its link, and what the link has.
///
/// Eight data bits, no parity and one stop bit take ten bits a byte with their start bit, so a baud rate carries a
/// tenth of it in bytes a second. What is needed is found by encoding ten seconds of the scene's own ticks.
#[derive(Clone, Debug)]
pub struct Budget {
    /// The output as it was asked for.
    pub to: Destination,
    /// Packets a second.
    pub packets_per_s: f64,
    /// Their bytes.
    pub bytes_per_s: f64,
    /// Bytes a second that the baud rate carries, where there is one.
    pub capacity: Option<f64>,
    /// What would fit, a sentence each with its number; empty where all fits.
    pub ways_out: Vec<String>,
}

impl Budget {
    /// Of one output of a plan that is played at `speed` scene seconds a second.
    pub fn of(plan: &Plan, output: &Output, speed: f64) -> Budget {
        let load = |sensors: &[SensorPlan], protocol: Protocol, options: wire::Options| {
            let (bytes, packets) = wire::load(
                protocol,
                &Setup {
                    sensors,
                    axes: plan.axes,
                    day: plan.day,
                    options,
                    peer: wire::dialogue::Peer::default(),
                },
            );
            (bytes * speed, packets * speed)
        };
        let (bytes_per_s, packets_per_s) = load(&plan.sensors, output.to.protocol, output.wire);
        let capacity = output.to.address.baud().map(bytes_per_second);
        let mut budget =
            Budget { to: output.to.clone(), packets_per_s, bytes_per_s, capacity, ways_out: Vec::new() };
        if let Some(capacity) = capacity.filter(|_| !budget.fits()) {
            let ways = WaysOut { plan, output, capacity, needed: bytes_per_s, load: &load };
            budget.ways_out = ways.all();
        }
        budget
    }

    /// Of every output.
    pub fn all(plan: &Plan, outputs: &[Output], speed: f64) -> Vec<Budget> {
        outputs.iter().map(|output| Budget::of(plan, output, speed)).collect()
    }

    /// The needed part of what the link carries.
    pub fn share(&self) -> Option<f64> {
        self.capacity.map(|capacity| self.bytes_per_s / capacity)
    }

    /// Whether the link carries it.
    pub fn fits(&self) -> bool {
        self.share().is_none_or(|share| share <= 1.0)
    }

    /// What it needs and what the link carries, in a line.
    pub fn arithmetic(&self) -> String {
        let (packets, bytes) = (number(self.packets_per_s), number(self.bytes_per_s));
        let needs = format!("{} needs {bytes} bytes/s ({packets} packets/s)", self.to);
        match (self.to.address.baud(), self.capacity, self.share()) {
            (Some(baud), Some(capacity), Some(share)) => format!(
                "{needs}, and {baud} baud carries {} (8N1: {baud}/10), so that is {:.0} % of it",
                number(capacity),
                100.0 * share
            ),
            _ => needs,
        }
    }
}

impl fmt::Display for Budget {
    /// The arithmetic, then each way out in a line of its own.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.arithmetic())?;
        self.ways_out.iter().try_for_each(|way| write!(f, "\n  - {way}"))
    }
}

/// Refuses an output whose link is too slow for it, unless `force` is set, for all or for this output, or its overload
/// policy stretches scene time. It then calls `warn` with the arithmetic and the consequence.
///
/// # Errors
/// What is refused, with what would fit, a line each.
pub fn afford(
    plan: &Plan,
    outputs: &[Output],
    speed: f64,
    force: bool,
    warn: &mut dyn FnMut(String),
) -> Result<(), String> {
    let mut refused = Vec::new();
    for output in outputs.iter().filter(|output| output.to.address.baud().is_some()) {
        let budget = Budget::of(plan, output, speed);
        let stretched = output.overload == Overload::Stretch;
        match budget.fits() {
            true => {}
            false if force || output.force || stretched => {
                let but = if stretched { "scene time is stretched" } else { "the rest is lost" };
                warn(format!("{}; {but}", budget.arithmetic()));
            }
            false => refused.push(budget.to_string()),
        }
    }
    if refused.is_empty() { Ok(()) } else { Err(refused.join("\n")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn budget(scene: &str, output: &str, speed: f64) -> Budget {
        let text = format!("duration = \"1 s\"\n{scene}[[output]]\n{output}");
        let plan = Plan::parse(&text, "test", "test", &[]).unwrap_or_else(|error| panic!("{error}"));
        Budget::of(&plan, &plan.outputs[0], speed)
    }

    const BOTH: &str = "[gyro]\nrate = \"1 kHz\"\n[accel]\nrate = \"1 kHz\"\n[mag]\nrate = \"100 Hz\"\n";

    #[test]
    fn what_is_needed_is_what_packet_lengths_give_by_hand() {
        // 24 bytes an imu packet, 18 a mag, 20 a config a second.
        let by_hand = 1000.0 * 24.0 + 100.0 * 18.0 + 20.0;
        for (to, speed, capacity) in [
            ("to = \"mpu@/dev/ttyUSB0,460800\"\n", 1.0, Some(46_080.0)),
            ("to = \"mpu@pty,258200\"\n", 1.0, Some(by_hand)),
            ("to = \"mpu@/dev/ttyUSB0\"\n", 3.0, Some(92_160.0)),
            ("to = \"mpu@pty\"\n", 100.0, None),
            ("to = \"mpu@pty,9600\"\npace = false\n", 1.0, None),
        ] {
            let budget = budget(BOTH, to, speed);
            assert!((budget.bytes_per_s - speed * by_hand).abs() < 1e-6, "{to}: {}", budget.bytes_per_s);
            assert_eq!((budget.capacity, budget.fits(), budget.ways_out.len()), (capacity, true, 0), "{to}");
        }
        assert!(!budget(BOTH, "to = \"mpu@pty,258190\"\n", 1.0).fits(), "a byte a second too few");
    }

    #[test]
    fn units_on_a_uart_need_230400_baud_for_200_hz() {
        let scene = "[gyro]\nrate = \"200 Hz\"\n[accel]\nrate = \"200 Hz\"\n[mag]\nrate = \"100 Hz\"\n";
        // 70 bytes a frame; 41 an IMU_SHORT, 39 a MAG, 45 a QUAT, 35 an AIR_DATA.
        let sbg = 200.0 * 41.0 + 100.0 * 39.0 + 50.0 * 45.0 + 10.0 * 35.0;
        for (name, needed) in [("ilabs", 200.0 * 70.0), ("sbg", sbg)] {
            let slow = budget(scene, &format!("to = \"{name}@/dev/ttyUSB0,115200\"\n"), 1.0);
            assert!((slow.bytes_per_s - needed).abs() < 1e-6, "{name}: {}", slow.bytes_per_s);
            let ways = slow.ways_out.join("\n");
            let faster = format!("{name}@/dev/ttyUSB0,230400 carries 23040 bytes/s");
            assert!(!slow.fits() && ways.contains(&faster), "{ways}");
            let usual = budget(scene, &format!("to = \"ardupilot-{name}@/dev/ttyUSB0\"\n"), 1.0);
            assert_eq!((usual.capacity, usual.fits()), (Some(23_040.0), true), "{name}");
        }
    }

    #[test]
    fn each_way_out_has_its_number_and_only_those_that_are_ways_are_named() {
        let ways = |scene: &str, output: &str| budget(scene, output, 1.0).ways_out.join("\n");
        // Packets of their own are shorter when the accelerometer is slow.
        let slow = "[gyro]\nrate = \"1 kHz\"\n[accel]\nrate = \"10 Hz\"\n";
        let burst = ways(slow, "to = \"mpu@pty,200000\"\nlayout = \"burst\"\n");
        assert!(burst.contains("other packets: layout = \"separate\" needs 16180 bytes/s"), "{burst}");
        assert!(burst.contains("--set gyro.rate='832 Hz' needs 19988 bytes/s"), "{burst}");
        assert!(!burst.contains("accel.rate"), "what is slow enough stays: {burst}");
        assert!(burst.contains("mpu@pty,460800"), "{burst}");
        let usb = ways(BOTH, "to = \"mpu@/dev/ttyACM0,57600\"\n");
        assert!(usb.contains("runs at the speed of USB"), "{usb}");
        let fast = "[gyro]\nrate = \"100 kHz\"\n";
        let none = ways(fast, "to = \"csv@/dev/ttyUSB0\"\noverload = \"stretch\"\n");
        assert!(
            none.contains("no standard baud rate carries it: it takes 8") && !none.contains("stretch"),
            "{none}"
        );
        // Once a second: no rate is low enough for a line of ten bytes a second, and none is offered.
        let hopeless = ways("[gyro]\nrate = \"1 Hz\"\n", "to = \"mpu@pty,100\"\n");
        assert!(!hopeless.contains("lower rate"), "{hopeless}");
    }
}
