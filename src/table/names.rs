//! What columns are, by their names: one vocabulary of time, attitude, angular rate and position.
//!
//! A name is read in lower case and in words: `TimeUS` is `time_us`, `q[0]` is `q_0`, `pose.orientation.w` is
//! `pose_orientation_w`. Its unit stands in brackets behind it or at its end. What is left ends in a component (`w`,
//! `x`, `0`, `roll`), and columns that agree in all the rest belong together.

use super::TimeUnit;
use super::units::{self, Unit};
use std::collections::BTreeMap;

/// The name of a column.
#[derive(Clone, Debug, PartialEq)]
pub struct Heading {
    /// As the file has it.
    pub text: String,
    /// In lower case, in words joined by `_`, without its unit.
    pub base: String,
    /// Its unit, where the name or a row of units says it.
    pub unit: Option<Unit>,
}

impl Heading {
    pub(super) fn new(text: &str) -> Heading {
        let text = text.trim().trim_start_matches(['#', '%']).trim_matches(['"', '\'', ' ', '\t']);
        let (name, bracketed) = bracketed(text);
        let words = words(name);
        let (base, suffix) = units::strip(&words);
        let (base, unit) = match bracketed.map(units::unit) {
            // `t_ms [ms]` says it twice.
            Some(unit) if suffix.as_ref() == Some(&unit) => (base, suffix),
            Some(unit) => (words, Some(unit)),
            None => (base, suffix),
        };
        let (base, unit) = match (unit, joined_time(&base)) {
            (None, Some((base, unit))) => (base, Some(Unit::Time(unit))),
            (unit, _) => (base, unit),
        };
        Heading { text: text.to_string(), base, unit }
    }

    fn tokens(&self) -> impl DoubleEndedIterator<Item = &str> {
        self.base.split('_').filter(|token| !token.is_empty())
    }

    /// Whether a word of it says that it is no measure of the thing itself, but of what was wanted of it, or of how
    /// good it is.
    fn is_aside(&self) -> bool {
        const ASIDE: [&str; 27] = [
            "delta",
            "reset",
            "ref",
            "reference",
            "setpoint",
            "sp",
            "des",
            "desired",
            "d",
            "target",
            "cov",
            "covariance",
            "var",
            "variance",
            "std",
            "err",
            "error",
            "bias",
            "b",
            "ba",
            "bg",
            "offset",
            "cmd",
            "command",
            "relative",
            "dt",
            "sigma",
        ];
        let is_word = |token: &str| ASIDE.contains(&token.trim_end_matches(|c: char| c.is_ascii_digit()));
        // The last word may be a component: north, east, down.
        let is_down = self.base.ends_with("_d");
        self.tokens().take(self.tokens().count() - usize::from(is_down)).any(is_word)
    }
}

/// A name and what stands in the brackets behind it, if that is no index.
fn bracketed(text: &str) -> (&str, Option<&str>) {
    for (open, close) in [('[', ']'), ('(', ')')] {
        let parted = text.strip_suffix(close).and_then(|text| text.rsplit_once(open));
        if let Some((name, inside)) = parted
            && !name.trim().is_empty()
            && (inside.is_empty() || inside.parse::<u32>().is_err())
        {
            return (name.trim_end(), Some(inside.trim()));
        }
    }
    (text, None)
}

/// A name in lower case, its words joined by `_`; one begins at a capital after a small letter too.
fn words(name: &str) -> String {
    let mut words = String::new();
    let mut before = '_';
    for c in name.chars() {
        let begins = c.is_uppercase() && before.is_lowercase();
        let is_letter = c.is_alphanumeric() || c == '°';
        if (begins || !is_letter) && !words.ends_with('_') && !words.is_empty() {
            words.push('_');
        }
        if is_letter {
            words.extend(c.to_lowercase());
        }
        before = c;
    }
    words.trim_end_matches('_').to_string()
}

/// `timeus`: a time and its unit in one word.
fn joined_time(base: &str) -> Option<(String, TimeUnit)> {
    ["timestamp", "time"].iter().find_map(|time| {
        let end = base.strip_prefix(time).filter(|end| !end.is_empty())?;
        match units::known(end)? {
            Unit::Time(unit) => Some((time.to_string(), unit)),
            _ => None,
        }
    })
}

/// Columns that belong together.
#[derive(Clone, Debug, PartialEq)]
pub struct Set<const N: usize> {
    /// Their places in a row.
    pub columns: [usize; N],
    /// How many inside units (1, rad, rad/s, m) one of theirs is, where that is known.
    pub unit: Option<f64>,
    /// Whether the unit is that of the log's kind and not said by the names.
    pub by_kind: Option<&'static str>,
    /// The first columns of others that it could have been.
    pub others: Vec<String>,
}

/// The column of time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TimeColumn {
    /// Its place in a row.
    pub column: usize,
    /// A column of ns beside it, where it counts whole seconds.
    pub fine: Option<usize>,
    /// Its unit, where that is said.
    pub unit: Option<TimeUnit>,
}

/// Words that make a name that of an attitude, an angular rate, a position.
const QUATERNION: [&str; 10] =
    ["q", "quat", "quaternion", "orientation", "orient", "ori", "rotation", "rot", "attitude", "att"];
const RATE: [&str; 9] = ["w", "omega", "gyro", "gyr", "gyroscope", "angular", "angvel", "rates", "g"];
const POSITION: [&str; 9] = ["p", "pos", "position", "t", "translation", "trans", "loc", "location", ""];

/// A quaternion, w first.
pub(super) fn quaternion(names: &[Heading]) -> Option<Set<4>> {
    let is_head =
        |family: &str| family.is_empty() || family.split('_').any(|token| QUATERNION.contains(&token));
    let by_letter = sets(names, ["w", "x", "y", "z"], &QUATERNION, is_head);
    // Without a word before them, 0 to 3 are no names of a quaternion.
    let by_number =
        sets(names, ["0", "1", "2", "3"], &QUATERNION, |family| !family.is_empty() && is_head(family));
    let mut found = by_letter;
    found.extend(by_number);
    best(names, found, |_| None).map(|set| Set { unit: Some(1.0), ..set })
}

/// Roll, pitch and yaw.
pub(super) fn euler(names: &[Heading]) -> Option<Set<3>> {
    let mut found = sets(names, ["roll", "pitch", "yaw"], &[], |_| true);
    found.extend(sets(names, ["roll", "pitch", "heading"], &[], |_| true));
    found.extend(sets(names, ["phi", "theta", "psi"], &[], |_| true));
    let set = best(names, found, |unit| match unit {
        Unit::Angle(rad) => Some(*rad),
        _ => None,
    })?;
    Some(by_kind(names, set))
}

/// An angular rate about x, y and z.
pub(super) fn angular_rate(names: &[Heading]) -> Option<Set<3>> {
    let is_rate = |family: &str, names: [usize; 3], headings: &[Heading]| {
        let has_unit = names.iter().any(|i| matches!(headings[*i].unit, Some(Unit::Rate(_))));
        let mut tokens = family.split('_');
        let first = tokens.next().unwrap_or_default();
        let is_head = RATE.contains(&first) || tokens.any(|token| RATE.contains(&token) && token != "w");
        !family.contains("accel") && (has_unit || (is_head && first != "g"))
    };
    let mut found: Vec<_> = [["x", "y", "z"], ["0", "1", "2"]]
        .into_iter()
        .flat_map(|components| sets(names, components, &RATE, |_| true))
        .filter(|(family, columns)| is_rate(family, *columns, names))
        .collect();
    for three in [["rollspeed", "pitchspeed", "yawspeed"], ["rollrate", "pitchrate", "yawrate"]] {
        found.extend(sets(names, three, &[], |_| true));
    }
    let set = best(names, found, |unit| match unit {
        // `gyro_rad[0]` is an angle a second.
        Unit::Rate(rate) | Unit::Angle(rate) => Some(*rate),
        _ => None,
    })?;
    Some(by_kind(names, set))
}

/// A position, in m where the unit is said.
pub(super) fn position(names: &[Heading]) -> Option<Set<3>> {
    let is_head = |family: &str| {
        let mut tokens = family.split('_');
        POSITION.contains(&tokens.next().unwrap_or_default()) || tokens.any(|token| token.starts_with("pos"))
    };
    let found: Vec<_> = [["x", "y", "z"], ["n", "e", "d"], ["e", "n", "u"], ["lat", "lon", "alt"]]
        .into_iter()
        .flat_map(|components| sets(names, components, &POSITION, is_head))
        .filter(|(_, columns)| {
            columns.iter().all(|i| !matches!(names[*i].unit, Some(Unit::Rate(_) | Unit::Other(_))))
        })
        .collect();
    best(names, found, |unit| match unit {
        Unit::Length(m) => Some(*m),
        _ => None,
    })
}

/// What of a name is left before a component, and the columns.
type Family<const N: usize> = (String, [usize; N]);

/// Every family of columns that has all of these components; `heads` are words that a component may be written to
/// without a break, as in `qw`.
fn sets<const N: usize>(
    names: &[Heading],
    components: [&str; N],
    heads: &[&str],
    is_meant: impl Fn(&str) -> bool,
) -> Vec<Family<N>> {
    let family = |heading: &Heading, component: &str| -> Option<String> {
        let (before, last) = heading.base.rsplit_once('_').unwrap_or(("", &heading.base));
        if last == component {
            return Some(before.to_string());
        }
        let head = last.strip_suffix(component).filter(|head| heads.contains(head) && !head.is_empty())?;
        Some(if before.is_empty() { head.to_string() } else { format!("{before}_{head}") })
    };
    let mut families: BTreeMap<String, [Option<usize>; N]> = BTreeMap::new();
    for (i, heading) in names.iter().enumerate().filter(|(_, heading)| !heading.is_aside()) {
        for (k, component) in components.into_iter().enumerate() {
            let Some(of) = family(heading, component).filter(|of| is_meant(of)) else { continue };
            families.entry(of).or_insert([None; N])[k].get_or_insert(i);
        }
    }
    let whole = |(of, columns): (String, [Option<usize>; N])| {
        let all = columns.iter().all(Option::is_some);
        all.then(|| (of, columns.map(Option::unwrap_or_default)))
    };
    families.into_iter().filter_map(whole).collect()
}

/// Of several families that of the shortest name, of these the first; its unit is what any of its columns says, if
/// none contradicts.
fn best<const N: usize>(
    names: &[Heading],
    mut found: Vec<Family<N>>,
    unit: impl Fn(&Unit) -> Option<f64>,
) -> Option<Set<N>> {
    let words = |family: &str| if family.is_empty() { usize::MAX } else { family.split('_').count() };
    let of = |columns: &[usize; N]| {
        let mut units = columns.iter().filter_map(|i| unit(names[*i].unit.as_ref()?));
        let first = units.next()?;
        units.all(|other| other == first).then_some(first)
    };
    // A family whose unit is known can be read as it stands.
    found.sort_by_key(|(family, columns)| (of(columns).is_none(), words(family), columns[0]));
    let (_, columns) = found.first()?;
    Some(Set {
        columns: *columns,
        unit: of(columns),
        by_kind: None,
        others: (found[1..].iter().filter(|(_, other)| other[0] != columns[0]))
            .map(|(_, other)| names[other[0]].text.clone())
            .collect(),
    })
}

/// The unit that angles and rates have in the logs whose columns these are, where no name says it.
fn by_kind<const N: usize>(names: &[Heading], set: Set<N>) -> Set<N> {
    let has = |base: &str| names.iter().any(|heading| heading.base == base);
    let of_ros = names[set.columns[0]].base.contains("angular_velocity");
    let kind = match () {
        () if set.unit.is_some() => return set,
        () if of_ros => Some((1.0, "ROS counts rad/s")),
        () if has("time_boot") || (has("rollspeed") && has("yawspeed")) => {
            Some((1.0, "MAVLink's ATTITUDE counts rad"))
        }
        () if names.iter().any(|heading| heading.text == "TimeUS") && has("des_roll") => {
            Some((1f64.to_radians(), "ArduPilot's ATT counts deg"))
        }
        () if names.iter().any(|heading| heading.text == "TimeUS") && has("gyr_x") => {
            Some((1.0, "ArduPilot's IMU counts rad/s"))
        }
        () => None,
    };
    Set { unit: kind.map(|(unit, _)| unit), by_kind: kind.map(|(_, what)| what), ..set }
}

/// The column of time: `t`, `time` and `timestamp` with a unit, then names that have one of these in them, then
/// either without a unit.
pub(super) fn time(names: &[Heading]) -> Option<TimeColumn> {
    let rank = |heading: &Heading| -> Option<u32> {
        let unit = match heading.unit {
            Some(Unit::Time(unit)) => Some(unit),
            Some(Unit::One) | None => None,
            Some(_) => return None,
        };
        let is_time = |token: &str| matches!(token, "t" | "time" | "timestamp" | "stamp");
        let (first, last) = (heading.tokens().next()?, heading.tokens().next_back()?);
        let is_unit = matches!(units::known(&heading.base), Some(Unit::Time(_))) && heading.base.len() > 1;
        match (heading.base.as_str(), unit) {
            _ if heading.is_aside() => None,
            ("t" | "time" | "timestamp", Some(_)) => Some(0),
            _ if unit.is_some() && (is_time(first) || is_time(last)) => Some(1),
            ("t" | "time" | "timestamp", None) => Some(2),
            _ if (is_time(first) && first != "t") || (is_time(last) && last != "t") => Some(3),
            ("seconds_elapsed" | "elapsed", _) => Some(4),
            _ if is_unit => Some(5),
            _ => None,
        }
    };
    let ranked = names.iter().enumerate().filter_map(|(i, heading)| Some((rank(heading)?, i)));
    let (_, column) = ranked.min()?;
    let heading = &names[column];
    let own = units::known(&heading.base).filter(|_| heading.unit.is_none());
    let unit = match heading.unit.clone().or(own) {
        Some(Unit::Time(unit)) => Some(unit),
        _ if heading.base == "seconds_elapsed" => Some(TimeUnit::S),
        _ => None,
    };
    // A stamp of ROS is in two columns: whole seconds, and ns beside them.
    let ends = |heading: &Heading, ends: &[&str]| {
        let text = heading.text.to_lowercase();
        ends.iter().any(|end| text.ends_with(end))
    };
    let is_fine = |other: &Heading| {
        other.base == heading.base && ends(other, &["nsec", "nsecs", "nanosec", "nanosecs"])
    };
    let is_whole =
        |other: &Heading| other.base == heading.base && ends(other, &["sec", "secs"]) && !is_fine(other);
    match (names.iter().position(is_whole), names.iter().position(is_fine)) {
        (Some(whole), Some(fine)) => {
            Some(TimeColumn { column: whole, fine: Some(fine), unit: Some(TimeUnit::S) })
        }
        _ => Some(TimeColumn { column, fine: None, unit }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(header: &str) -> Vec<Heading> {
        header.split(',').map(Heading::new).collect()
    }

    #[test]
    fn the_headers_of_known_programs_are_understood() {
        let angle = Some(1f64.to_radians());
        // Header, time with its unit, quaternion or the unit of angles.
        for (header, column, unit, attitude) in [
            ("t_ns,qw,qx,qy,qz", 0, Some(TimeUnit::Ns), [1, 2, 3, 4]),
            (
                "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1], b_w_RS_S_x [rad s^-1], b_w_RS_S_y [rad s^-1], b_w_RS_S_z [rad s^-1]",
                0,
                None,
                [4, 5, 6, 7],
            ),
            (
                "#timestamp [us],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z [],t_system [us]",
                0,
                Some(TimeUnit::Us),
                [4, 5, 6, 7],
            ),
            (
                "timestamp,timestamp_sample,q[0],q[1],q[2],q[3],delta_q_reset[0],delta_q_reset[1],delta_q_reset[2],delta_q_reset[3],quat_reset_counter",
                0,
                None,
                [2, 3, 4, 5],
            ),
            (
                "%time,field.header.seq,field.header.stamp,field.orientation.x,field.orientation.y,field.orientation.z,field.orientation.w,field.orientation_covariance0,field.orientation_covariance1",
                0,
                None,
                [6, 3, 4, 5],
            ),
            ("time,seconds_elapsed,qz,qy,qx,qw,roll,pitch,yaw", 0, None, [5, 4, 3, 2]),
            ("timestamp,TimeUS,Q1,Q2,Q3,Q4,quatW,quatX,quatY,quatZ", 1, Some(TimeUnit::Us), [6, 7, 8, 9]),
            ("t,source,p_x,q_w,q_x,q_y,q_z,p_IR_x,q_IR_w,q_IR_x,q_IR_y,q_IR_z", 0, None, [3, 4, 5, 6]),
            (
                "Time (s),pose.orientation.w,pose.orientation.x,pose.orientation.y,pose.orientation.z",
                0,
                Some(TimeUnit::S),
                [1, 2, 3, 4],
            ),
            ("sec,w,x,y,z", 0, Some(TimeUnit::S), [1, 2, 3, 4]),
            ("#timestamp [ns], p_x, p_y, p_z, q_w, q_x, q_y, q_z", 0, Some(TimeUnit::Ns), [4, 5, 6, 7]),
            (
                "timestamp,timestamp_ns,gyro_x,gyro_y,gyro_z,quat_w,quat_x,quat_y,quat_z,temperature",
                1,
                Some(TimeUnit::Ns),
                [5, 6, 7, 8],
            ),
            (
                "vertex_index,timestamp_ns,p_x_m,p_y_m,p_z_m,q_w,q_x,q_y,q_z",
                1,
                Some(TimeUnit::Ns),
                [5, 6, 7, 8],
            ),
        ] {
            let names = names(header);
            let found = time(&names).unwrap_or_else(|| panic!("{header}"));
            assert_eq!((found.column, found.unit, found.fine), (column, unit, None), "{header}");
            assert_eq!(quaternion(&names).map(|set| set.columns), Some(attitude), "{header}");
        }
        for (header, columns, unit) in [
            ("t_s,roll_deg,pitch_deg,yaw_deg", [1, 2, 3], angle),
            ("t,Roll [deg],Pitch [deg],Yaw [deg]", [1, 2, 3], angle),
            ("t,roll(deg),pitch(deg),heading(deg)", [1, 2, 3], angle),
            ("t,att.roll_rad,att.pitch_rad,att.yaw_rad", [1, 2, 3], Some(1.0)),
            ("timestamp,time_boot_ms,roll,pitch,yaw,rollspeed,pitchspeed,yawspeed", [2, 3, 4], Some(1.0)),
            ("timestamp,time_boot_ms,roll,pitch,yaw", [2, 3, 4], Some(1.0)),
            ("timestamp,TimeUS,DesRoll,Roll,DesPitch,Pitch,DesYaw,Yaw", [3, 5, 7], angle),
            ("time,lat_deg,lon_deg,height_m,vn,ve,vd,roll_deg,pitch_deg,yaw_deg", [7, 8, 9], angle),
            ("timestamp,heading_deg,roll_deg,pitch_deg,gyro_x,gyro_y,gyro_z", [2, 3, 1], angle),
            ("t,roll,pitch,yaw", [1, 2, 3], None),
            ("t,roll_deg,pitch_rad,yaw_deg", [1, 2, 3], None),
        ] {
            let set = euler(&names(header)).unwrap_or_else(|| panic!("{header}"));
            assert_eq!((set.columns, set.unit), (columns, unit), "{header}");
        }
    }

    #[test]
    fn angular_rates_are_told_from_their_bias_and_from_positions() {
        for (header, columns, unit) in [
            ("t_ns,wx_rad_s,wy_rad_s,wz_rad_s", [1, 2, 3], Some(1.0)),
            ("t_ns,x_rad_s,y_rad_s,z_rad_s", [1, 2, 3], Some(1.0)),
            ("#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y,w_RS_S_z,a_RS_S_x [m s^-2]", [1, 2, 3], Some(1.0)),
            (
                "t,b_w_RS_S_x [rad s^-1],b_w_RS_S_y [rad s^-1],b_w_RS_S_z [rad s^-1],gyro_x [rad/s],gyro_y [rad/s],gyro_z [rad/s]",
                [4, 5, 6],
                Some(1.0),
            ),
            ("timestamp,gyro_rad[0],gyro_rad[1],gyro_rad[2],gyro_integral_dt", [1, 2, 3], Some(1.0)),
            (
                "%time,field.angular_velocity.x,field.angular_velocity.y,field.angular_velocity.z",
                [1, 2, 3],
                Some(1.0),
            ),
            (
                "loopIteration,time (us),gyroADC[0] (deg/s),gyroADC[1] (deg/s),gyroADC[2] (deg/s)",
                [2, 3, 4],
                Some(1f64.to_radians()),
            ),
            ("t,wx,wy,wz", [1, 2, 3], None),
        ] {
            let set = angular_rate(&names(header)).unwrap_or_else(|| panic!("{header}"));
            assert_eq!((set.columns, set.unit), (columns, unit), "{header}");
        }
        for header in
            ["t,b_w_x [rad/s],b_w_y [rad/s],b_w_z [rad/s]", "t,px_m,py_m,pz_m", "t,vx_m_s,vy_m_s,vz_m_s"]
        {
            assert_eq!(angular_rate(&names(header)), None, "{header}");
        }
        for (header, columns) in [
            ("t,px_m,py_m,pz_m", Some([1, 2, 3])),
            ("#timestamp [ns], p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m]", Some([1, 2, 3])),
            ("t,tx,ty,tz,qx,qy,qz,qw", Some([1, 2, 3])),
            ("timestamp_us,qw,qx,qy,qz,pos_n,pos_e,pos_d,vel_n,vel_e,vel_d", Some([5, 6, 7])),
            ("t_ns,x_rad_s,y_rad_s,z_rad_s", None),
            ("t_ns,w,x_g,y_ut", None),
        ] {
            assert_eq!(position(&names(header)).map(|set| set.columns), columns, "{header}");
        }
    }

    #[test]
    fn a_stamp_in_two_columns_is_one_time() {
        for header in [
            "header.stamp.sec,header.stamp.nanosec,w,x,y,z",
            "a.stamp.secs,a.stamp.nsecs,qw",
            "stamp_sec,stamp_nanosec,pos_x,pos_y,pos_z,quat_w",
        ] {
            let expected = TimeColumn { column: 0, fine: Some(1), unit: Some(TimeUnit::S) };
            assert_eq!(time(&names(header)), Some(expected), "{header}");
        }
        // These are two times, each by itself.
        assert_eq!(time(&names("t_s,t_ns,qw")).unwrap().fine, None);
    }

    #[test]
    fn what_could_have_been_meant_as_well_is_told() {
        let set =
            quaternion(&names("t,q_est_w,q_est_x,q_est_y,q_est_z,q_ekf_w,q_ekf_x,q_ekf_y,q_ekf_z")).unwrap();
        assert_eq!((set.columns, set.others), ([1, 2, 3, 4], vec!["q_ekf_w".to_string()]));
        let alone = quaternion(&names("t,q_d[0],q_d[1],q_d[2],q_d[3]"));
        assert_eq!(alone, None, "what was wanted is no attitude");
    }
}
