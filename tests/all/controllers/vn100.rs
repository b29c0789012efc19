//! Controllers that take the program for their VN-100: PX4 without HITL, and one that restarts with another rate.

use super::*;

/// A command, or the answer to one.
fn line(text: &str) -> String {
    let sum = text.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${text}*{sum:02X}\r\n")
}

/// The other end of a serial port, as a flight controller has it that takes us for its VN-100.
struct Driver {
    port: File,
    decoder: vectornav::Decoder,
    /// Each packet that came, in order.
    packets: Vec<vectornav::Packet>,
}

impl Driver {
    fn new(port: File) -> Driver {
        Driver { port, decoder: vectornav::Decoder::new(), packets: Vec::new() }
    }

    /// Takes in what comes within a fifth of a second: false once the other side has left.
    fn listen(&mut self) -> bool {
        let patience = rustix::event::Timespec { tv_sec: 0, tv_nsec: 200_000_000 };
        let mut asked = [rustix::event::PollFd::new(&self.port, rustix::event::PollFlags::IN)];
        if rustix::event::poll(&mut asked, Some(&patience)).unwrap() == 0 {
            return true;
        }
        let Some(bytes) = next(&mut self.port) else { return false };
        let packets = &mut self.packets;
        self.decoder.feed(&bytes, |received| packets.extend(received.ok()));
        true
    }

    /// Says a command, again and again until it is answered, and gives the answer back.
    fn ask(&mut self, command: &str) -> String {
        for _ in 0..300 {
            self.port.write_all(line(command).as_bytes()).unwrap();
            let from = self.packets.len();
            // A stream that plays meanwhile ends this as the silence does.
            for _ in 0..5 {
                self.listen();
                let answer = self.packets[from..].iter().find_map(|packet| match packet {
                    vectornav::Packet::Line(line) => Some(line.text().to_owned()),
                    _ => None,
                });
                if let Some(answer) = answer {
                    return answer;
                }
            }
        }
        panic!("nobody answers {command}");
    }

    /// Stream times of the packets of samples, ns.
    fn times(&self) -> Vec<u64> {
        let time = |packet: &vectornav::Packet| match packet {
            vectornav::Packet::Imu(seen) => Some(seen.time_ns),
            vectornav::Packet::Inertial(seen) => Some(seen.time_ns),
            _ => None,
        };
        self.packets.iter().filter_map(time).collect()
    }
}

/// ArduPilot's commands, and PX4's, for samples at 800 Hz divided by so much.
fn commands(px4: bool, divisor: u32) -> Vec<String> {
    let all = match px4 {
        false => {
            "VNASY,0 VNWRG,06,0,1 VNWRG,06,0,2 VNRRG,01 VNWRG,75,3,D,01,0721 VNWRG,76,3,16,11,0001,0106 VNASY,1"
        }
        true => {
            "VNRRG,01 VNRRG,01 VNWRG,5,921600 VNRRG,01 VNRRG,02 VNRRG,03 VNRRG,04 VNWRG,6,0 VNRRG,35 \
             VNWRG,35,1,0,1,1 VNRRG,35 VNWRG,75,2,D,6,1,600 VNWRG,76,2,8,36,1,130,84,613 VNWRG,77,2,80,A,1,26B9"
        }
    };
    all.split_whitespace().map(|command| command.replace(",D,", &format!(",{divisor},"))).collect()
}

#[test]
fn px4_with_a_vectornav_unit_sets_the_ports_speed_and_gets_its_outputs() {
    use rustix::pty::{OpenptFlags, openpt, ptsname, unlockpt};
    // Before the stream the control side answers, and beside it the pacing thread.
    for to in ["px4-vectornav@serial:SLAVE", "vectornav@serial:SLAVE,115200"] {
        let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC).unwrap();
        unlockpt(&master).unwrap();
        let slave = ptsname(&master, Vec::new()).unwrap().into_string().unwrap();
        let held = open(Path::new(&slave));
        let more: &[&str] = if to.starts_with("px4") { &["--rest", "1s"] } else { &["--for", "6s"] };
        let run = Run::start(&to.replace("SLAVE", &slave), more);
        let speed = |port: &File| rustix::termios::tcgetattr(port).unwrap().output_speed();
        let mut driver = Driver::new(File::from(master));
        let mut held = Some(held);
        for command in commands(true, 4) {
            let answer = driver.ask(&command);
            let expected = match command.as_str() {
                "VNWRG,77,2,80,A,1,26B9" => "VNERR,12".to_string(),
                write if write.starts_with("VNWRG") => command.clone(),
                read => format!("{read},"),
            };
            assert!(answer.starts_with(&expected), "{to}: {command} is answered {answer}");
            if command.starts_with("VNRRG,01") && held.take().is_some() {
                assert_eq!(speed(&driver.port), 115_200, "{to}");
            }
            // Our own end changes as soon as it has the echo, and the other one goes on at that speed.
            for _ in 0..6000 {
                if !command.starts_with("VNWRG,5,") || speed(&driver.port) == 921_600 {
                    break;
                }
                driver.listen();
            }
        }
        assert_eq!(speed(&driver.port), 921_600, "{to}");
        while driver.listen() {}
        let output = run.end();
        let report: Value = serde_json::from_slice(&output.stdout).expect("a report");
        assert_eq!(report["ok"], true, "{report}");
        assert!(said(&output).contains("921600 baud: the port goes on at that"), "{}", said(&output));
        let (mut inertial, mut navigation, mut others) = (0, Vec::new(), 0);
        for packet in &driver.packets {
            match packet {
                vectornav::Packet::Inertial(_) => inertial += 1,
                vectornav::Packet::Navigation(seen) => navigation.push(*seen),
                vectornav::Packet::Imu(_) | vectornav::Packet::Ahrs(_) => others += 1,
                vectornav::Packet::Line(_) => {}
            }
        }
        let asked = report["links"][0]["asked"].as_array().map_or(0, Vec::len);
        if to.starts_with("px4") {
            // A second of rest and one and a half of the scene, and the packet of a vehicle that has stopped.
            assert_eq!((inertial, others, asked), (500 - 1 + 1, 0, 0), "{to}");
            assert!((248..=250).contains(&navigation.len()), "{}", navigation.len());
        } else {
            assert!(inertial > 100 && others > 0 && asked == 1, "{inertial} {others} {report}");
        }
        let last = navigation.last().unwrap();
        assert!((last.xyzw[2] - 0.5f32.sqrt()).abs() < 0.02, "it has turned by 90 degrees: {last:?}");
        assert!(navigation.iter().all(|seen| seen.status == 0 && seen.position == [0.0; 3]));
    }
}

#[test]
fn a_controller_that_restarts_and_asks_for_another_rate_gets_it() {
    for px4 in [false, true] {
        let to = if px4 { "px4-vectornav@PTY" } else { "ardupilot@PTY" };
        let run = Run::start(to, &["--rest", "1s", "--for", "8s"]);
        let mut driver = Driver::new(open(&run.port()));
        commands(px4, 8).iter().for_each(|command| drop(driver.ask(command)));
        while driver.times().len() < 150 {
            assert!(driver.listen());
        }
        commands(px4, 2).iter().for_each(|command| drop(driver.ask(command)));
        while driver.listen() {}
        let output = run.end();
        let report: Value = serde_json::from_slice(&output.stdout).expect("a report");
        let told = said(&output);
        assert!(
            told.contains("has restarted") && told.contains("at 400 Hz") && told.contains("from 100 Hz"),
            "{told}"
        );
        let asked = &report["links"][0]["asked"];
        assert_eq!((asked.as_array().unwrap().len(), &asked[0]["hz"]), (1, &400.0.into()), "{asked}");
        let at = asked[0]["at_s"].as_f64().unwrap();
        let mut times = driver.times();
        times.pop();
        let seam = times.iter().position(|&t| t as f64 >= at * 1e9).unwrap();
        assert!(seam >= 150 && times.len() - seam > 800, "{seam} of {}", times.len());
        // A busy machine loses packets; none comes at another time than one of the rate's.
        let on_beat = |pair: &[u64], period: u64| (pair[1] - pair[0]).is_multiple_of(period);
        assert!(times[..seam].windows(2).all(|pair| on_beat(pair, 10_000_000)), "{to}");
        assert!(times[seam - 1..].windows(2).all(|pair| on_beat(pair, 2_500_000)), "{to}");
        assert!(times[seam..].windows(2).filter(|pair| pair[1] - pair[0] == 2_500_000).count() > 600);
    }
}
