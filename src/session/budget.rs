//! The link budget: the bytes a second that an output needs against what its baud rate carries.

use super::ways_out::WaysOut;
use crate::link::{STANDARD_BAUDS, bytes_per_second};
use crate::report::number;
use crate::scene::{Destination, Output, Overload, Plan};
use crate::sensor::SensorPlan;
use crate::time::Rate;
use crate::wire::dialogue::Peer;
use crate::wire::{self, Protocol, Setup};
use std::fmt;

/// What an output needs of its link, and what the link carries.
///
/// Eight data bits, no parity, one start and one stop bit make ten bits a byte, so a baud rate carries a tenth of
/// it in bytes a second. The need is measured by encoding ten seconds of the scene's own ticks.
#[derive(Clone, Debug)]
pub struct Budget {
    /// The output as requested.
    pub to: Destination,
    /// Packets a second.
    pub packets_per_s: f64,
    /// Bytes a second in those packets.
    pub bytes_per_s: f64,
    /// Bytes a second that the baud rate carries; `None` without a baud rate.
    pub capacity: Option<f64>,
    /// Changes that would make it fit, one sentence each with its number; empty where everything fits.
    pub ways_out: Vec<String>,
}

impl Budget {
    /// The budget of one output of a plan that plays at `speed` scene seconds a second.
    pub fn of(plan: &Plan, output: &Output, speed: f64) -> Budget {
        Budget::asked(plan, output, speed, Peer::default())
    }

    /// The same, where the other side may have asked for a number of packets.
    pub(super) fn asked(plan: &Plan, output: &Output, speed: f64, peer: Peer) -> Budget {
        let load = |sensors: &[SensorPlan], protocol: Protocol, options: wire::Options| {
            let (bytes, packets) =
                wire::load(protocol, &Setup { sensors, axes: plan.axes, day: plan.day, options, peer });
            (bytes * speed, packets * speed)
        };
        let (bytes_per_s, packets_per_s) = load(&plan.sensors, output.to.protocol, output.wire);
        let capacity = output.to.baud().map(bytes_per_second);
        let mut budget =
            Budget { to: output.to.clone(), packets_per_s, bytes_per_s, capacity, ways_out: Vec::new() };
        if let Some(capacity) = capacity.filter(|_| !budget.fits()) {
            let ways = WaysOut { plan, output, capacity, needed: bytes_per_s, load: &load };
            budget.ways_out = ways.all();
        }
        budget
    }

    /// The budget of every output.
    pub fn all(plan: &Plan, outputs: &[Output], speed: f64) -> Vec<Budget> {
        outputs.iter().map(|output| Budget::of(plan, output, speed)).collect()
    }

    /// The needed share of the link's capacity.
    pub fn share(&self) -> Option<f64> {
        self.capacity.map(|capacity| self.bytes_per_s / capacity)
    }

    /// Whether the link carries the output.
    pub fn fits(&self) -> bool {
        self.share().is_none_or(|share| share <= 1.0)
    }

    /// The need and the capacity, in one line.
    pub fn arithmetic(&self) -> String {
        let (packets, bytes) = (number(self.packets_per_s), number(self.bytes_per_s));
        let needs = format!("{} needs {bytes} bytes/s ({packets} packets/s)", self.to);
        match (self.to.baud(), self.capacity, self.share()) {
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
    /// The arithmetic, then each way out on its own line.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.arithmetic())?;
        self.ways_out.iter().try_for_each(|way| write!(f, "\n  - {way}"))
    }
}

/// Rejects an output whose link is too slow for it. It does not reject where `force` is set for all outputs or for
/// this one, or where the overload policy stretches scene time; it then calls `warn` with the arithmetic and the
/// consequence.
///
/// # Errors
/// Each rejected output with what would fit, one line each.
pub fn afford(
    plan: &Plan,
    outputs: &[Output],
    speed: f64,
    force: bool,
    warn: &mut dyn FnMut(String),
) -> Result<(), String> {
    let mut refused = Vec::new();
    for output in outputs.iter().filter(|it| it.to.baud().is_some() && it.sends() && asks_rate(it).is_none())
    {
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

/// The controller asks for this number of packets a second, divided by a whole number (VN-100).
const UNIT_RATE: u64 = 800;

/// The parameter of the number of packets that the controller of an output asks for: until it has, its budget is not
/// known.
fn asks_rate(output: &Output) -> Option<&'static str> {
    output.to.target.and_then(|target| target.asks_rate)
}

/// Checks the budget of an output whose controller has asked for its number of packets. Returns what is wrong, with the
/// greatest number that fits and the baud rate that carries what it asks for.
pub(super) fn afford_asked(plan: &Plan, output: &Output, speed: f64, peer: Peer) -> Option<String> {
    let (parameter, rate) = (asks_rate(output)?, peer.rate?);
    let budget = Budget::asked(plan, output, speed, peer);
    let fits = |rate: Rate| Budget::asked(plan, output, speed, Peer { rate: Some(rate), ..peer }).fits();
    let lower = (1..=UNIT_RATE).filter_map(|divisor| Rate::new(UNIT_RATE, divisor));
    let lower = lower.filter(|lower| lower.as_hz() < rate.as_hz()).find(|lower| fits(*lower));
    let lower = lower.map_or(String::new(), |lower| format!("ask for {lower} ({parameter}), "));
    let baud = STANDARD_BAUDS.iter().find(|baud| bytes_per_second(**baud) >= budget.bytes_per_s);
    let baud = baud.map_or("a faster link".into(), |baud| format!("a baud rate of {baud} at both ends"));
    let what = || format!("the controller asks for {rate}: {}; {lower}or use {baud}", budget.arithmetic());
    (!budget.fits()).then(what)
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
        // 24 bytes an imu packet, 18 a mag packet, and one config packet of 20 bytes a second.
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
            let usual = budget(scene, &format!("to = \"{name}@/dev/ttyUSB0\"\n"), 1.0);
            assert_eq!((usual.capacity, usual.fits()), (Some(23_040.0), true), "{name}");
        }
    }

    #[test]
    fn each_way_out_has_its_number_and_only_those_that_are_ways_are_named() {
        let ways = |scene: &str, output: &str| budget(scene, output, 1.0).ways_out.join("\n");
        // A slow accelerometer gets separate packets, which are shorter.
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
        // Even at 1 Hz no rate is low enough for a link of ten bytes a second, so no rate is offered.
        let hopeless = ways("[gyro]\nrate = \"1 Hz\"\n", "to = \"mpu@pty,100\"\n");
        assert!(!hopeless.contains("lower rate"), "{hopeless}");
    }
}
