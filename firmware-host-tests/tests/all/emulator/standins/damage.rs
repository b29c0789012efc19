//! Loss, corruption and stalls of the stream: each stand-in takes them as its firmware does, and counts them.

use ratetable::scene::Plan;
use ratetable_firmware_host_tests::standin::{Make, Settings};

use super::doctor::has_samples;
use super::memory::{CASES, Case, Told, converse, exact_deg, settings};

type Stream = Vec<(u64, Vec<u8>)>;

fn plan(case: &Case, duration: &str) -> Plan {
    let sets: Vec<String> = case.sets.iter().copied().chain([duration]).map(str::to_owned).collect();
    Plan::load("level-then-turn", &sets).unwrap_or_else(|error| panic!("{error}"))
}

fn play(case: &Case, duration: &str, alter: impl FnOnce(Stream, u64) -> Stream) -> (Plan, Told) {
    let plan = plan(case, duration);
    let told = converse(case, &plan, &settings(case, &plan), alter);
    (plan, told)
}

#[test]
fn lost_packets_are_counted_where_they_are_numbered_and_cost_little() {
    for case in &CASES {
        let mut dropped = 0;
        let (plan, told) = play(case, "duration=16 s", |stream, rest_us| {
            let mut k = 0;
            let keep = |(at, packet): &(u64, Vec<u8>)| {
                // One that is followed by none is not missed.
                let may = (rest_us..rest_us + 15_900_000).contains(at) && has_samples(case.make, packet);
                k += u64::from(may);
                let lost = may && k % 10 == 3;
                dropped += u64::from(lost);
                !lost
            };
            let mut stream = stream;
            stream.retain(keep);
            stream
        });
        let counts = told.record.counts;
        assert!(dropped > 100, "{}: {dropped}", case.make);
        if matches!(case.make, Make::Px4 | Make::Px4Sitl) {
            assert_eq!(counts.lost, dropped, "{}", case.make);
        }
        assert_eq!(counts.damaged, 0, "{}", case.make);
        let (rms, _) = exact_deg(&plan, &told.record, told.scene_us);
        eprintln!("{} with a tenth lost: {rms:.3} deg RMS", case.make);
        assert!(rms < 0.5, "{}: {rms}", case.make);
    }
}

#[test]
fn a_flipped_bit_costs_its_packet_and_is_counted() {
    for case in &CASES {
        let mut hurt = 0;
        let (_, clean) = play(case, "duration=4 s", |stream, _| stream);
        let (_, told) = play(case, "duration=4 s", |stream, rest_us| {
            let damage = |(k, (at, mut packet)): (usize, (u64, Vec<u8>))| {
                // In the payload, so that no start or length is hidden.
                if at > rest_us && k % 20 == 7 && has_samples(case.make, &packet) {
                    let room = packet.len() - 23;
                    packet[20 + k % room.min(30)] ^= 1 << (k % 8);
                    hurt += 1;
                }
                (at, packet)
            };
            stream.into_iter().enumerate().map(damage).collect()
        });
        let counts = told.record.counts;
        assert!(hurt > 10);
        assert_eq!(counts.damaged, hurt, "{}: {counts}", case.make);
        assert_eq!(counts.samples + hurt, clean.record.counts.samples, "{}: {counts}", case.make);
    }
}

/// The stream without what is due in 3 s from `from_us` after the scene's start.
fn stalled(stream: Stream, rest_us: u64, from_us: u64) -> Stream {
    let gap = rest_us + from_us..rest_us + from_us + 3_000_000;
    stream.into_iter().filter(|(at, _)| !gap.contains(at)).collect()
}

#[test]
fn px4_notices_a_silence_and_the_others_do_not() {
    for case in &CASES {
        let (_, told) = play(case, "duration=9 s", |stream, rest_us| stalled(stream, rest_us, 4_000_000));
        let expected = u64::from(matches!(case.make, Make::Px4 | Make::Px4Ilabs));
        assert_eq!(told.record.counts.timeouts, expected, "{}", case.make);
        let history = &told.record.history;
        let longest = history.windows(2).map(|pair| pair[1].t_us - pair[0].t_us).max();
        assert!(longest.is_some_and(|us| us >= 3_000_000), "{}: {longest:?}", case.make);
    }
}

#[test]
fn a_silence_in_a_turn_costs_what_was_missed_of_it() {
    // The first roll, of 30 deg/s, is from 10 s to 11 s: a silence of 3 s from its middle on misses half of it, and who
    // integrates the rate after the silence over it makes nothing of that; who holds the one before it, 75 deg more.
    for case in &CASES {
        let at_rest = play(case, "duration=14 s", |stream, rest_us| stalled(stream, rest_us, 2_000_000));
        let turning = play(case, "duration=14 s", |stream, rest_us| stalled(stream, rest_us, 10_500_000));
        let [(_, calm), (_, lost)] =
            [&at_rest, &turning].map(|(plan, told)| exact_deg(plan, &told.record, told.scene_us));
        eprintln!("{}: a silence of 3 s costs {calm:.2} deg at rest and {lost:.1} deg in a turn", case.make);
        assert!(calm < 1.0, "{}: {calm}", case.make);
        let expected = if case.make == Make::Inav { 30.0..90.0 } else { 9.0..20.0 };
        assert!(expected.contains(&lost), "{}: {lost}", case.make);
    }
}

#[test]
fn px4_takes_a_sensor_that_says_the_same_a_hundred_times_for_dead() {
    let case = Case::of(Make::Px4);
    let (_, told) = play(case, "duration=3 s", |stream, rest_us| {
        let mut frozen: Option<Vec<u8>> = None;
        let freeze = |(at, packet): (u64, Vec<u8>)| {
            // The same packet for a second: its number too, but for that it says the same.
            if (rest_us..rest_us + 1_000_000).contains(&at) && has_samples(case.make, &packet) {
                (at, frozen.get_or_insert(packet).clone())
            } else {
                (at, packet)
            }
        };
        stream.into_iter().map(freeze).collect()
    });
    // Of 250 equal ones the first hundred are believed; gyro and accelerometer.
    assert_eq!(told.record.counts.stale, 2 * 150, "{}", told.record.counts);
}

#[test]
fn ardupilot_asks_again_until_a_damaged_or_lost_answer_has_come() {
    let mut bytes = Vec::new();
    let mut firmware = Make::Ardupilot.firmware(&Settings::default());
    let line = |text: &str| {
        use ratetable_protocols::vectornav::{Packet, line::Line};
        super::doctor::encoded(&Packet::Line(Line::new(text).unwrap()))
    };
    let mut times = Vec::new();
    for now_us in (0..2_000_000).step_by(1_000) {
        let before = bytes.len();
        firmware.turn(now_us, &mut bytes);
        if bytes.len() > before {
            times.push(now_us);
        }
    }
    assert_eq!(times, [0, 500_000, 1_000_000, 1_500_000], "every half second");
    assert_eq!(bytes, line("VNASY,0").repeat(4));
    bytes.clear();
    for answer in ["VNERR,12", "VNWRG,06,0,1", "VNRRG,01,VN-100T-CR"] {
        firmware.receive(&line(answer), 2_000_000, &mut bytes);
    }
    let mut hurt = line("VNASY,0");
    hurt[3] ^= 1;
    firmware.receive(&hurt, 2_000_000, &mut bytes);
    assert_eq!((bytes.len(), firmware.record().counts.answers), (0, 0), "none of these is the answer");
    firmware.receive(&line("VNASY,0"), 2_001_000, &mut bytes);
    assert_eq!(bytes, line("VNWRG,06,0,1"), "the next one at once");
}

#[test]
fn inav_keeps_four_packets_and_takes_one_every_ten_milliseconds() {
    let case = Case::of(Make::Inav);
    let plan = plan(case, "duration=1 s");
    let packet = super::memory::packets(&plan, case, None)[0].bytes().to_vec();
    assert_eq!(packet.len(), 63);
    let mut firmware = Make::Inav.firmware(&Settings::default());
    let mut out = Vec::new();
    firmware.turn(5_000, &mut out);
    firmware.receive(&packet.repeat(10), 5_000, &mut out);
    assert_eq!(firmware.record().counts.overflowed, 630 - 256);
    let mut taken = Vec::new();
    for now_us in (5_000..105_000).step_by(1_000) {
        firmware.turn(now_us, &mut out);
        taken.push(firmware.record().counts.samples);
    }
    taken.dedup();
    assert_eq!(taken, [0, 1, 2, 3, 4], "one at a time");
    assert_eq!(out.len(), 4 * (8 + 21 + 1), "each is answered");
    // 200 a second for a second: a hundred are taken, at most four wait.
    let mut firmware = Make::Inav.firmware(&Settings::default());
    for k in 0..200 {
        firmware.receive(&packet, k * 5_000, &mut out);
    }
    let counts = firmware.record().counts;
    assert!((96..=101).contains(&counts.samples) && counts.overflowed > 5000, "{counts}");
}
