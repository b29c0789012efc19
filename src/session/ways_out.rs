//! Changes that would fit, where a link does not carry its output.

use crate::link::{Address, STANDARD_BAUDS, bytes_per_second};
use crate::report::number;
use crate::scene::output_rate::at_most;
use crate::scene::{Output, Overload, Plan};
use crate::sensor::SensorPlan;
use crate::time::Rate;
use crate::wire::{self, Layout, Protocol};

/// Looks for changes that would fit.
pub(super) struct WaysOut<'a, L> {
    pub plan: &'a Plan,
    pub output: &'a Output,
    pub capacity: f64,
    pub needed: f64,
    /// Bytes and packets a second of these sensors with a given layout.
    pub load: &'a L,
}

impl<L: Fn(&[SensorPlan], Protocol, wire::Options) -> (f64, f64)> WaysOut<'_, L> {
    /// All of them, one sentence each with its number.
    pub(super) fn all(&self) -> Vec<String> {
        let mut ways: Vec<_> = self.lower_rate().into_iter().collect();
        ways.extend(self.other_packets());
        ways.push(self.higher_baud());
        if self.output.overload != Overload::Stretch {
            let times = self.needed / self.capacity;
            ways.push(format!(
                "lose nothing and take {} times as long: overload = \"stretch\" in [[output]]",
                number(times)
            ));
        }
        ways.push(
            "start in spite of it, and lose what does not fit: --force, or force = true in [[output]]".into(),
        );
        ways
    }

    /// The highest whole rate in Hz that fits when the faster sensors slow down to it; of a part the fastest that it has up
    /// to there.
    fn lower_rate(&self) -> Option<String> {
        let at = |hz: u32| {
            let mut sensors = self.plan.sensors.clone();
            for sensor in sensors.iter_mut().filter(|sensor| sensor.rate.as_hz() > f64::from(hz)) {
                sensor.rate = Rate::hz(hz);
            }
            (self.load)(&sensors, self.output.to.protocol, self.output.wire).0
        };
        let fastest = self.plan.sensors.iter().map(|sensor| sensor.rate.as_hz()).fold(0.0, f64::max);
        let (mut fits, mut not) = (0, fastest.ceil() as u32);
        while not - fits > 1 {
            let hz = fits + (not - fits) / 2;
            *(if at(hz) <= self.capacity { &mut fits } else { &mut not }) = hz;
        }
        let mut sensors = self.plan.sensors.clone();
        let mut sets = Vec::new();
        for sensor in sensors.iter_mut().filter(|sensor| sensor.rate.as_hz() > f64::from(fits)) {
            let most = Rate::hz(fits.max(1));
            sensor.rate = sensor.part.and_then(|part| at_most(part, sensor.kind, most)).unwrap_or(most);
            sets.push(format!("--set {}.rate='{}'", sensor.kind, sensor.rate));
        }
        let needed = (self.load)(&sensors, self.output.to.protocol, self.output.wire).0;
        (fits > 0).then(|| format!("a lower rate: {} needs {} bytes/s", sets.join(" "), number(needed)))
    }

    /// Each other layout and protocol that fits, or a sentence that none does.
    fn other_packets(&self) -> Vec<String> {
        let here = self.output.to.protocol;
        let mut others = Vec::new();
        let layouts = [(Layout::Separate, "separate"), (Layout::Burst, "burst")];
        for (layout, name) in layouts.into_iter().filter(|_| here == Protocol::Mpu) {
            let options = wire::Options { layout: Some(layout), ..self.output.wire };
            if wire::check(here, &options, &self.plan.sensors).is_ok() {
                others.push((format!("layout = \"{name}\""), self.bytes(here, options)));
            }
        }
        // Packets that leave samples out are no way out.
        let carries_all = |protocol: &Protocol| {
            wire::warnings(*protocol, &wire::Options::default(), &self.plan.sensors).is_empty()
        };
        for protocol in Protocol::STREAMS.into_iter().filter(|it| *it != here && carries_all(it)) {
            others.push((protocol.name().into(), self.bytes(protocol, wire::Options::default())));
        }
        // What the output already sends is no alternative.
        others.retain(|(_, bytes)| *bytes != self.needed);
        others.sort_by(|a, b| a.1.total_cmp(&b.1));
        let say = |(what, bytes): &(String, f64)| format!("{what} needs {} bytes/s", number(*bytes));
        let fitting: Vec<_> = others.iter().filter(|(_, bytes)| *bytes <= self.capacity).map(say).collect();
        if !fitting.is_empty() {
            return fitting.iter().map(|what| format!("other packets: {what}")).collect();
        }
        let none: Vec<_> = others.iter().map(say).collect();
        vec![format!("no other packets: {}", none.join(", "))]
    }

    fn bytes(&self, protocol: Protocol, options: wire::Options) -> f64 {
        (self.load)(&self.plan.sensors, protocol, options).0
    }

    /// What a baud rate means to a device that is USB all the way.
    fn usb(&self) -> &'static str {
        match &self.output.to.address {
            Address::Serial { path, .. } if path.to_string_lossy().contains("ttyACM") => {
                " (a USB device of this kind usually takes any, and runs at the speed of USB)"
            }
            _ => "",
        }
    }

    /// The next standard speed that carries it.
    fn higher_baud(&self) -> String {
        let next = STANDARD_BAUDS.iter().find(|baud| bytes_per_second(**baud) >= self.needed);
        match next {
            Some(&baud) => {
                let to = self.output.to.at(self.output.to.address.clone().at_baud(baud));
                let (carried, usb) = (bytes_per_second(baud), self.usb());
                format!(
                    "a higher baud rate: {to} carries {} bytes/s, {:.0} % of it needed{usb}",
                    number(carried),
                    100.0 * self.needed / carried
                )
            }
            None => format!(
                "no standard baud rate carries it: it takes {} baud",
                number((self.needed * 10.0).ceil())
            ),
        }
    }
}
