//! The channels that are offered, and the messages on them.
//!
//! | topic | message |
//! |---|---|
//! | `/imu/data_raw`, or `/imu/gyro` and `/imu/accel` where their ticks differ | `sensor_msgs/msg/Imu` |
//! | `/imu/mag` | `sensor_msgs/msg/MagneticField` |
//! | `/baro`, `/airspeed` | `sensor_msgs/msg/FluidPressure` |
//! | `/gps/fix`, `/gps/velocity` | `sensor_msgs/msg/NavSatFix`, `geometry_msgs/msg/Vector3Stamped` |
//! | `/imu/gyro/true` and the like | `geometry_msgs/msg/Vector3Stamped` |
//! | `/truth`, `/truth/pose` | `sensor_msgs/msg/Imu`, `geometry_msgs/msg/PoseStamped` |
//! | `/estimate/pose` | `geometry_msgs/msg/PoseStamped` |
//! | `/tf` | `tf2_msgs/msg/TFMessage`: truth and estimates; `map_ned` in `map`, where nav axes point down |
//! | `/diagnostics` | `diagnostic_msgs/msg/DiagnosticArray` |

use crate::geometry::{Axes, Vector};
use crate::live::about::{About, Shown};
use crate::live::batch::{Batch, Readings};
use crate::ros::{self, Imu, Kind, Stamped, Status, Turned};
use crate::sensor::{SensorKind, Shape};
use crate::time::SimTime;
use glam::DVec3;
use serde_json::json;
use std::f64::consts::FRAC_1_SQRT_2;

/// What a channel carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum What {
    /// A gyroscope and an accelerometer with the same ticks.
    Both(usize, usize),
    Reading(usize),
    True(usize),
    Velocity(usize),
    Truth,
    TruthPose,
    EstimatePose(usize),
    Transform,
    Diagnostics,
}

#[derive(Clone, Debug)]
struct Channel {
    id: u32,
    topic: String,
    kind: Kind,
    what: What,
}

/// The channels that are offered.
pub(in crate::live) struct Channels {
    axes: Axes,
    sensors: Vec<Shown>,
    channels: Vec<Channel>,
    /// What the frames of the estimates are called.
    estimates: Vec<String>,
}

/// Where a message goes: the channel, when it holds, its bytes.
type Out<'a> = &'a mut dyn FnMut(u32, SimTime, &[u8]);

impl Channels {
    /// Those of what is shown; their numbers follow those of channels that were offered before.
    pub(in crate::live) fn new(about: &About, before: Option<&Channels>) -> Channels {
        let first = before.and_then(|before| before.channels.last()).map_or(1, |last| last.id + 1);
        let offered = offered(about).into_iter().zip(first..);
        let channels = offered.map(|((topic, kind, what), id)| Channel { id, topic, kind, what });
        let several = about.estimators.len() > 1;
        let body = ros::frames(about.axes)[1];
        let frame = |i: usize| {
            if several { format!("{body}_estimate_{}", i + 1) } else { format!("{body}_estimate") }
        };
        Channels {
            axes: about.axes,
            sensors: about.sensors.clone(),
            channels: channels.collect(),
            estimates: (0..about.estimators.len()).map(frame).collect(),
        }
    }

    /// The message that greets a viewer; `session` tells this run from others. Its time is told: viewers that go by the
    /// time of arrival otherwise would draw every sample where its batch came.
    pub(in crate::live) fn server_info(&self, session: &str) -> String {
        let name = concat!(env!("CARGO_PKG_NAME"), " ", env!("CARGO_PKG_VERSION"));
        json!({ "op": "serverInfo", "name": name, "capabilities": ["time"], "sessionId": session })
            .to_string()
    }

    /// The message that offers the channels.
    pub(in crate::live) fn advertise(&self) -> String {
        let channel = |it: &Channel| {
            let (name, definition) = it.kind.schema();
            json!({ "id": it.id, "topic": it.topic, "encoding": "cdr", "schemaName": name,
                    "schemaEncoding": "ros2msg", "schema": definition })
        };
        json!({ "op": "advertise", "channels": self.channels.iter().map(channel).collect::<Vec<_>>() })
            .to_string()
    }

    /// The message that takes them back.
    pub(in crate::live) fn unadvertise(&self) -> String {
        let ids: Vec<_> = self.channels.iter().map(|it| it.id).collect();
        json!({ "op": "unadvertise", "channelIds": ids }).to_string()
    }

    /// Whether a channel is offered.
    pub(super) fn has(&self, id: u32) -> bool {
        self.channels.iter().any(|channel| channel.id == id)
    }

    /// The messages of a batch on the channels that somebody wants, in order of time over all of them: a viewer's time
    /// follows them, and does not go back.
    pub(in crate::live) fn messages(&self, batch: &Batch, wanted: &dyn Fn(u32) -> bool, out: Out<'_>) {
        let (mut bytes, mut all, mut made) = (Vec::with_capacity(512), Vec::new(), Vec::new());
        for channel in self.channels.iter().filter(|channel| wanted(channel.id)) {
            let mut put = |t: SimTime, bytes: &[u8]| {
                let start = all.len();
                all.extend_from_slice(bytes);
                made.push((t, channel.id, start..all.len()));
            };
            self.encode(channel.what, batch, &mut bytes, &mut put);
        }
        made.sort_by_key(|(t, ..)| *t);
        for (t, id, place) in made {
            out(id, t, &all[place]);
        }
    }

    /// How things are at a time, if somebody wants to know.
    pub(in crate::live) fn diagnostics(
        &self,
        t: SimTime,
        status: &[Status],
        wanted: &dyn Fn(u32) -> bool,
        out: Out<'_>,
    ) {
        let channel = self.channels.iter().find(|it| it.what == What::Diagnostics && wanted(it.id));
        if let Some(channel) = channel {
            let mut bytes = Vec::new();
            ros::diagnostics(self.in_nav(t), status, &mut bytes);
            out(channel.id, t, &bytes);
        }
    }

    fn in_nav(&self, t: SimTime) -> Stamped {
        Stamped { t, frame: ros::frames(self.axes)[0] }
    }

    fn in_body(&self, t: SimTime) -> Stamped {
        Stamped { t, frame: ros::frames(self.axes)[1] }
    }

    fn encode(&self, what: What, batch: &Batch, bytes: &mut Vec<u8>, put: &mut dyn FnMut(SimTime, &[u8])) {
        let of = |sensor: usize| batch.readings.iter().find(|readings| readings.of == sensor);
        match what {
            What::Both(gyro, accel) => self.both(of(gyro), of(accel), bytes, put),
            What::Reading(sensor) | What::True(sensor) | What::Velocity(sensor) => {
                for (i, t) in of(sensor).into_iter().flat_map(|it| it.t.iter().enumerate()) {
                    if of(sensor).is_some_and(|it| self.reading(what, it, i, bytes)) {
                        put(*t, bytes);
                    }
                }
            }
            What::Truth | What::TruthPose => {
                for truth in &batch.truth {
                    let q = self.axes.attitude_out(truth.attitude);
                    let attitude = [q.w, q.x, q.y, q.z];
                    if what == What::TruthPose {
                        ros::pose(self.in_nav(truth.t), attitude, bytes);
                    } else {
                        let out = |v: Vector<_>| Some(self.axes.body_out(v).to_array());
                        let imu =
                            Imu { attitude: Some(attitude), rate: out(truth.rate), force: out(truth.force) };
                        ros::imu(self.in_body(truth.t), &imu, bytes);
                    }
                    put(truth.t, bytes);
                }
            }
            What::EstimatePose(of) => {
                for told in batch.estimates.iter().filter(|told| told.of == of) {
                    let q = self.axes.attitude_out(told.attitude);
                    ros::pose(self.in_nav(told.t), [q.w, q.x, q.y, q.z], bytes);
                    put(told.t, bytes);
                }
            }
            What::Transform => self.transforms(batch, bytes, put),
            What::Diagnostics => {}
        }
    }

    /// Truth and estimates as frames, in order of time.
    fn transforms(&self, batch: &Batch, bytes: &mut Vec<u8>, put: &mut dyn FnMut(SimTime, &[u8])) {
        let body = ros::frames(self.axes)[1];
        let truth = batch.truth.iter().map(|truth| (truth.t, truth.attitude, body));
        let told = batch
            .estimates
            .iter()
            .filter_map(|told| Some((told.t, told.attitude, self.estimates.get(told.of)?.as_str())));
        let mut all: Vec<_> = truth.chain(told).collect();
        all.sort_by_key(|(t, ..)| *t);
        for (t, attitude, child) in all {
            let q = self.axes.attitude_out(attitude);
            let body = Turned { stamped: self.in_nav(t), child, attitude: [q.w, q.x, q.y, q.z] };
            match upright(self.axes, t) {
                Some(nav) => ros::transforms(&[nav, body], bytes),
                None => ros::transforms(&[body], bytes),
            }
            put(t, bytes);
        }
    }

    /// A gyroscope's and an accelerometer's readings, those of the same time in one message.
    fn both(
        &self,
        gyro: Option<&Readings>,
        accel: Option<&Readings>,
        bytes: &mut Vec<u8>,
        put: &mut dyn FnMut(SimTime, &[u8]),
    ) {
        let none = Readings::default();
        let (gyro, accel) = (gyro.unwrap_or(&none), accel.unwrap_or(&none));
        let (mut i, mut j) = (0, 0);
        while let Some(t) = gyro.t.get(i).into_iter().chain(accel.t.get(j)).min() {
            let mut imu = Imu::default();
            if gyro.t.get(i) == Some(t) {
                imu.rate = triad(&gyro.values, i);
                i += 1;
            }
            if accel.t.get(j) == Some(t) {
                imu.force = triad(&accel.values, j);
                j += 1;
            }
            ros::imu(self.in_body(*t), &imu, bytes);
            put(*t, bytes);
        }
    }

    /// One reading; whether it makes a message.
    fn reading(&self, what: What, readings: &Readings, i: usize, bytes: &mut Vec<u8>) -> bool {
        let (Some(sensor), t) = (self.sensors.get(readings.of), readings.t[i]) else { return false };
        let values = if matches!(what, What::True(_)) { &readings.truth } else { &readings.values };
        if values.is_empty() {
            return false;
        }
        match (what, sensor.kind.shape()) {
            (What::True(_), Shape::Triad) => {
                let scale = if sensor.kind == SensorKind::Mag { 1e-6 } else { 1.0 };
                let vector = triad(values, i).unwrap_or_default().map(|value| value * scale);
                ros::vector(self.in_body(t), vector, bytes);
            }
            (What::Velocity(_), Shape::Position) => {
                let north_east_down = DVec3::new(values[3][i], values[4][i], values[5][i]);
                let velocity = self.axes.nav_out(Vector::from_vec(north_east_down)).to_array();
                ros::vector(self.in_nav(t), velocity, bytes);
            }
            (What::Reading(_), Shape::Position) => {
                ros::nav_sat_fix(self.in_body(t), [values[0][i], values[1][i], values[2][i]], bytes);
            }
            (What::Reading(_), Shape::Pressure) => ros::fluid_pressure(self.in_body(t), values[0][i], bytes),
            (What::Reading(_), Shape::Triad) => {
                let vector = triad(values, i);
                match sensor.kind {
                    SensorKind::Mag => {
                        ros::magnetic_field(self.in_body(t), vector.unwrap_or_default(), bytes)
                    }
                    SensorKind::Accel => {
                        ros::imu(self.in_body(t), &Imu { force: vector, ..Imu::default() }, bytes);
                    }
                    _ => ros::imu(self.in_body(t), &Imu { rate: vector, ..Imu::default() }, bytes),
                }
            }
            _ => return false,
        }
        true
    }
}

/// Nav axes that point down as a viewer's that point up have them: it would show everything upside down.
fn upright(axes: Axes, t: SimTime) -> Option<Turned<'static>> {
    let [up, nav] = [Axes::EnuFlu, axes].map(|axes| ros::frames(axes)[0]);
    // Half a turn about north-east: x and y change places, z changes its sign.
    let attitude = [0.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2, 0.0];
    (nav != up).then_some(Turned { stamped: Stamped { t, frame: up }, child: nav, attitude })
}

fn triad(values: &[Vec<f64>], i: usize) -> Option<[f64; 3]> {
    let [x, y, z] = values else { return None };
    Some([x[i], y[i], z[i]])
}

/// Topics, their messages and what they carry.
fn offered(about: &About) -> Vec<(String, Kind, What)> {
    let mut all = Vec::new();
    if let Some((gyro, accel)) = about.together {
        all.push(("/imu/data_raw".to_string(), Kind::Imu, What::Both(gyro, accel)));
    }
    let is_together = |i: usize| about.together.is_some_and(|(gyro, accel)| i == gyro || i == accel);
    for (i, sensor) in about.sensors.iter().enumerate() {
        let name = &sensor.name;
        let topic = if sensor.kind.is_triad() { format!("/imu/{name}") } else { format!("/{name}") };
        let kind = match sensor.kind.shape() {
            Shape::Position => {
                all.push((format!("{topic}/fix"), Kind::NavSatFix, What::Reading(i)));
                all.push((format!("{topic}/velocity"), Kind::Vector, What::Velocity(i)));
                continue;
            }
            Shape::Pressure => Kind::FluidPressure,
            Shape::Triad if sensor.kind == SensorKind::Mag => Kind::MagneticField,
            Shape::Triad => Kind::Imu,
        };
        if !is_together(i) {
            all.push((topic.clone(), kind, What::Reading(i)));
        }
        if sensor.has_truth && sensor.kind.is_triad() {
            all.push((format!("{topic}/true"), Kind::Vector, What::True(i)));
        }
    }
    if about.reference.is_some() {
        all.push(("/truth".into(), Kind::Imu, What::Truth));
        all.push(("/truth/pose".into(), Kind::Pose, What::TruthPose));
    }
    let several = about.estimators.len() > 1;
    for i in 0..about.estimators.len() {
        let topic = if several { format!("/estimate/{}/pose", i + 1) } else { "/estimate/pose".into() };
        all.push((topic, Kind::Pose, What::EstimatePose(i)));
    }
    all.push(("/tf".into(), Kind::Transform, What::Transform));
    all.push(("/diagnostics".into(), Kind::Diagnostics, What::Diagnostics));
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Attitude, rotate};
    use crate::live::batch::Told;
    use crate::live::thread::gathered;
    use crate::scene::Plan;
    use std::collections::BTreeMap;

    /// Each topic's messages.
    type Messages = BTreeMap<String, Vec<(SimTime, Vec<u8>)>>;

    /// A second of a scene.
    fn played(scene: &str, sets: &[&str]) -> (Channels, Messages) {
        let sets: Vec<_> = ["duration=1 s"].iter().chain(sets).map(ToString::to_string).collect();
        let plan = Plan::load(scene, &sets).unwrap();
        let about = About::scene("run", &plan, plan.duration, vec!["mpu@pty".into()]);
        let channels = Channels::new(&about, None);
        let mut all: BTreeMap<String, Vec<_>> = BTreeMap::new();
        channels.messages(&gathered(&plan), &|_| true, &mut |id, t, bytes| {
            let channel = channels.channels.iter().find(|it| it.id == id).unwrap();
            all.entry(channel.topic.clone()).or_default().push((t, bytes.to_vec()));
        });
        (channels, all)
    }

    fn double(bytes: &[u8], at: usize) -> f64 {
        f64::from_le_bytes(bytes[at..at + 8].try_into().unwrap())
    }

    #[test]
    fn an_accelerometer_at_rest_says_so_in_the_scenes_axes() {
        for (axes, down) in [("ned-frd", -9.80665), ("enu-flu", 9.80665)] {
            let free = ["accel.rate=100 Hz", "gyro.rate=50 Hz"];
            let axes_are = format!("axes={axes}");
            let (_, all) = played("still", &[&axes_are, free[0], free[1]]);
            let (t, bytes) = &all["/imu/accel"][7];
            assert_eq!((*t, all["/imu/accel"].len()), (SimTime(70_000_000), 100));
            // The encapsulation, the time, the frame's name with its length.
            assert_eq!(bytes[..12], [0, 1, 0, 0, 0, 0, 0, 0, 0x80, 0x1d, 0x2c, 4]);
            let name = if axes == "ned-frd" { "imu_link_frd" } else { "imu_link" };
            assert_eq!(&bytes[16..16 + name.len()], name.as_bytes());
            let start = 4 + (8 + 4 + name.len() + 1).next_multiple_of(8);
            // Nine numbers of each covariance follow the attitude and the rate: unknown, as −1 says.
            let [rate, force] = [start + 8 * 13, start + 8 * 25];
            assert_eq!((double(bytes, start + 32), double(bytes, rate + 24)), (-1.0, -1.0));
            assert!((double(bytes, force + 16) - down).abs() < 0.3, "{axes}: {}", double(bytes, force + 16));
            assert_eq!(double(bytes, force + 24), 0.0);
        }
    }

    #[test]
    fn sensors_that_tick_together_share_a_message() {
        let (channels, all) = played("table-1", &[]);
        assert_eq!((all["/imu/data_raw"].len(), all["/imu/mag"].len()), (1000, 100));
        assert!(!all.contains_key("/imu/gyro") && all["/imu/gyro/true"].len() == 1000);
        assert_eq!((all["/truth/pose"].len(), all["/tf"].len()), (100, 100));
        let advertised: serde_json::Value = serde_json::from_str(&channels.advertise()).unwrap();
        let first = &advertised["channels"][0];
        assert_eq!(first["topic"], "/imu/data_raw");
        assert_eq!((&first["encoding"], &first["schemaEncoding"]), (&json!("cdr"), &json!("ros2msg")));
        assert_eq!(first["schemaName"], "sensor_msgs/msg/Imu");
        let info: serde_json::Value = serde_json::from_str(&channels.server_info("x")).unwrap();
        assert_eq!((&info["op"], &info["sessionId"]), (&json!("serverInfo"), &json!("x")));
        assert_eq!(info["capabilities"], json!(["time"]));
    }

    #[test]
    fn messages_come_in_order_of_time_whatever_their_channel() {
        let plan = Plan::load("table-1", &["duration=100 ms".into()]).unwrap();
        let about = About::scene("run", &plan, plan.duration, vec!["mpu@pty".into()]);
        let channels = Channels::new(&about, None);
        let mut batch = gathered(&plan);
        // The answer of a firmware comes later than what it was about.
        let late = Told { of: 0, t: SimTime(25_000_000), attitude: Attitude::IDENTITY };
        batch.estimates.push(late);
        let mut all = Vec::new();
        channels.messages(&batch, &|_| true, &mut |id, t, _| all.push((t, id)));
        assert!(all.is_sorted(), "then in that of the channels");
        let estimate = channels.channels.iter().find(|it| it.topic == "/estimate/pose").unwrap();
        assert!(all.contains(&(late.t, estimate.id)));
    }

    #[test]
    fn nav_axes_that_point_down_lie_upright_in_those_that_point_up() {
        let [w, x, y, z] = upright(Axes::NedFrd, SimTime(0)).unwrap().attitude;
        let turn = glam::DQuat::from_xyzw(x, y, z, w);
        for ned in [DVec3::X, DVec3::Y, DVec3::Z] {
            let enu = Axes::EnuFlu.nav_out(Vector::from_vec(ned));
            assert!((rotate(turn, ned) - enu).length() < 1e-15, "{ned}");
        }
        assert!(upright(Axes::EnuFlu, SimTime(0)).is_none());
    }

    #[test]
    fn what_nobody_wants_is_not_made() {
        let plan = Plan::load("still", &["duration=100 ms".into()]).unwrap();
        let about = About::scene("run", &plan, plan.duration, vec!["mpu@pty".into()]);
        let channels = Channels::new(&about, None);
        let tf = channels.channels.iter().find(|it| it.topic == "/tf").unwrap().id;
        let mut made = Vec::new();
        channels.messages(&gathered(&plan), &|id| id == tf, &mut |id, _, _| made.push(id));
        assert!(!made.is_empty() && made.iter().all(|id| *id == tf));
        let later = Channels::new(&about, Some(&channels));
        assert!(later.channels.iter().all(|it| !channels.has(it.id)), "a number means one channel for ever");
    }
}
