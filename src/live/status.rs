//! How sensors and links are, in the words of diagnostics.

use super::lateness::Point;
use super::message::Link;
use super::story::Story;
use crate::report::number;
use crate::ros::Status;

const OK: u8 = 0;
const WARN: u8 = 1;

/// How sensors and links are now.
pub(super) fn of(story: &Story) -> Vec<Status> {
    let sensors = story.about.sensors.iter().enumerate();
    let sensors = sensors.map(|(i, sensor)| self::sensor(&sensor.name, sensor.rate_hz, story.latest(i)));
    let links = story.about.links.iter().zip(story.links());
    sensors.chain(links.map(|(name, link)| self::link(name, link))).collect()
}

fn sensor(name: &str, asked_hz: Option<f64>, latest: Option<Point>) -> Status {
    let mut values = Vec::new();
    let mut value = |key: &str, value: Option<f64>, unit: &str| {
        values.extend(value.map(|value| (key.to_string(), format!("{} {unit}", number(value)))));
    };
    value("asked", asked_hz, "Hz");
    value("delivered", latest.and_then(|point| point.hz), "Hz");
    value("late p99", latest.map(|point| point.p99_us), "µs");
    value("late at most", latest.map(|point| point.max_us), "µs");
    Status { name: name.into(), level: OK, message: "sampled".into(), values }
}

fn link(name: &str, link: &Link) -> Status {
    let mut values = vec![
        ("packets".to_string(), link.packets.to_string()),
        ("bytes".to_string(), link.bytes.to_string()),
        ("dropped".to_string(), link.dropped.to_string()),
    ];
    let more = [("queued", link.queued), ("received bytes", link.received_bytes), ("damaged", link.damaged)];
    let more = more.into_iter().filter_map(|(key, count)| Some((key.to_string(), count?.to_string())));
    values.extend(more);
    let lost = link.dropped + link.damaged.unwrap_or_default();
    let (level, message) = match lost {
        0 => (OK, "nothing lost".into()),
        lost => (WARN, format!("{lost} packets lost or damaged")),
    };
    Status { name: name.into(), level, message, values }
}
