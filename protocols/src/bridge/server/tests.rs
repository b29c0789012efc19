use super::*;
use crate::bridge::{Client, Message, Port, Trouble, encode};
use crate::chip::mpu::Mpu;
use crate::chip::{Chip, Samples};
use proptest::prelude::*;

fn hex(text: &str) -> ([u8; 64], usize) {
    let (mut bytes, mut len) = ([0; 64], 0);
    for digits in text.split_whitespace() {
        bytes[len] = u8::from_str_radix(digits, 16).expect("hexadecimal");
        len += 1;
    }
    (bytes, len)
}

/// What a bridge answers to these bytes with this chip on its bus.
fn answer(bridge: &mut Bridge, chip: &mut dyn Chip, sent: &str, step: usize) -> ([u8; 64], usize) {
    let ((bytes, len), mut replies) = (hex(sent), ([0; 64], 0));
    let mut bus = Wired { t_ns: 0, chips: &mut [chip] };
    for piece in bytes[..len].chunks(step) {
        bridge.feed(piece, &mut bus, &mut |reply| {
            replies.0[replies.1..replies.1 + reply.len()].copy_from_slice(reply);
            replies.1 += reply.len();
        });
    }
    replies
}

/// What Zephyr's driver of an MPU-9250 says through its own driver of the bridge: a status question after each transfer.
const ZEPHYR: [(&str, &str); 10] = [
    ("53 d0 01 75 53 d1 01 50", "71"),
    ("53 d0 02 6b 40 50", ""),
    ("53 d0 01 6b 53 d1 01 50", "40"),
    ("53 d0 02 6b 00 50", ""),
    ("53 d0 02 1c 00 50", ""),
    ("53 d0 02 1b 00 50", ""),
    ("53 d0 02 1a 06 50", ""),
    ("53 d0 02 1d 06 50", ""),
    ("53 d0 02 19 0a 50", ""),
    ("53 d0 01 3b 53 d1 0e 50", "20 00 c0 00 40 00 0d 0c 05 1e fa e2 7f ff"),
];

#[test]
fn zephyrs_driver_hears_what_it_expects_however_its_bytes_arrive() {
    for step in [1, 2, 3, 64] {
        let (mut bridge, mut chip) = (Bridge::new(), Mpu::mpu9250(0x68, [128; 3]));
        for (sent, expected) in ZEPHYR {
            if expected.len() > 5 {
                chip.sample(
                    0,
                    &Samples {
                        gyro: Some([1310, -1310, 32767]),
                        accel: Some([8192, -16384, 16384]),
                        temperature_c: Some(21.0 + 3340.0 / 333.87),
                        ..Samples::default()
                    },
                );
            }
            assert_eq!(answer(&mut bridge, &mut chip, sent, step), hex(expected), "{sent}");
            assert_eq!(answer(&mut bridge, &mut chip, "52 0a 50", step), hex("f0"), "{sent}");
        }
        assert_eq!(bridge.counts(), Counts { transfers: 10, refused: 0, strange: 0 });
    }
}

#[test]
fn nobody_at_an_address_is_told_and_reads_as_ones() {
    let (mut bridge, mut chip) = (Bridge::new(), Mpu::mpu6050(0x68));
    assert_eq!(answer(&mut bridge, &mut chip, "53 d2 01 75 53 d3 02 50 52 0a 50", 64), hex("ff ff f1"));
    assert_eq!((bridge.take_refused(), bridge.take_refused()), (Some(0x69), None));
    assert_eq!(answer(&mut bridge, &mut chip, "53 d0 00 50 52 0a 50", 64), hex("f0"), "a probe");
    assert_eq!(bridge.counts(), Counts { transfers: 2, refused: 1, strange: 0 });
}

#[test]
fn two_writes_of_one_transfer_are_one_write() {
    let (mut bridge, mut chip) = (Bridge::new(), Mpu::mpu6050(0x68));
    answer(&mut bridge, &mut chip, "53 d0 01 1b 53 d0 01 18 50", 64);
    assert_eq!(answer(&mut bridge, &mut chip, "53 d0 01 1b 53 d1 01 50", 64), hex("18"));
}

#[test]
fn data_may_look_like_commands() {
    let (mut bridge, mut chip) = (Bridge::new(), Mpu::mpu6050(0x68));
    answer(&mut bridge, &mut chip, "53 d0 04 05 50 53 52 50", 1);
    assert_eq!(answer(&mut bridge, &mut chip, "53 d0 01 05 53 d1 03 50", 1), hex("50 53 52"));
}

#[test]
fn the_bridges_own_registers_and_pins_answer() {
    let (mut bridge, mut chip) = (Bridge::new(), Mpu::mpu6050(0x68));
    assert_eq!(answer(&mut bridge, &mut chip, "52 00 01 50", 64), hex("f0 02"), "9600 baud");
    assert_eq!(baud(0x02f0), 9600);
    answer(&mut bridge, &mut chip, "57 00 30 01 00 50", 64);
    assert_eq!((bridge.take_speed(), bridge.take_speed()), (Some(115_200), None));
    assert_eq!(answer(&mut bridge, &mut chip, "49 50 57 02 56 50 4f 01 50", 64), hex("00"));
    // The chip's interrupt line is pin 0.
    answer(&mut bridge, &mut chip, "53 d0 02 6b 00 50 53 d0 02 38 01 50", 64);
    chip.sample(0, &Samples { gyro: Some([0; 3]), ..Samples::default() });
    assert_eq!(answer(&mut bridge, &mut chip, "49 50", 64), hex("01"));
    assert_eq!(bridge.counts().strange, 0);
}

#[test]
fn a_command_that_was_cut_short_is_forgotten_on_request() {
    let (mut bridge, mut chip) = (Bridge::new(), Mpu::mpu6050(0x68));
    answer(&mut bridge, &mut chip, "53 d0 05 01", 64);
    assert!(bridge.forget() && !bridge.forget());
    assert_eq!(answer(&mut bridge, &mut chip, "53 d0 01 75 53 d1 01 50", 64), hex("68"));
    answer(&mut bridge, &mut chip, "fd 00 ff 53 d0 00 51", 64);
    assert_eq!(bridge.counts().strange, 5, "one cut short, three that begin nothing, one without its end");
}

/// A client whose bytes go straight into a bridge.
struct Wire<'a> {
    bridge: Bridge,
    chip: &'a mut Mpu,
    back: [u8; 300],
    len: usize,
}

impl Port for Wire<'_> {
    type Error = ();

    fn send(&mut self, bytes: &[u8]) -> Result<(), ()> {
        let Wire { bridge, chip, back, len } = self;
        let mut bus = Wired { t_ns: 0, chips: &mut [*chip] };
        bridge.feed(bytes, &mut bus, &mut |reply| {
            back[*len..*len + reply.len()].copy_from_slice(reply);
            *len += reply.len();
        });
        Ok(())
    }

    fn receive(&mut self, bytes: &mut [u8]) -> Result<(), ()> {
        if self.len < bytes.len() {
            return Err(());
        }
        bytes.copy_from_slice(&self.back[..bytes.len()]);
        self.back.copy_within(bytes.len().., 0);
        self.len -= bytes.len();
        Ok(())
    }
}

#[test]
fn a_client_reads_writes_and_hears_of_an_absent_chip() {
    let mut chip = Mpu::mpu6050(0x68);
    let mut client = Client::new(Wire { bridge: Bridge::new(), chip: &mut chip, back: [0; 300], len: 0 });
    let mut byte = [0];
    assert_eq!(client.write_read(0x68, &[0x75], &mut byte), Ok(()));
    assert_eq!(byte, [0x68]);
    assert_eq!(client.write(0x68, &[0x1b, 0x08]), Ok(()));
    assert_eq!((client.write(0x68, &[0x1b]), client.read(0x68, &mut byte)), (Ok(()), Ok(())));
    assert_eq!(byte, [0x08]);
    assert_eq!(client.write(0x10, &[0]), Err(Trouble::Refused(Status::NoAddress)));
    let mut memory = [0; 700];
    memory[0] = 0x6f;
    assert_eq!(client.write(0x68, &memory), Ok(()), "in three messages");
    assert_eq!(client.read(0x68, &mut memory), Err(Trouble::TooLong));
}

proptest! {
    /// No bytes panic or fill anything, and a bridge that is told to forget works on.
    #[test]
    fn hostile_bytes_cost_only_themselves(bytes in prop::collection::vec(any::<u8>(), 0..2000)) {
        let (mut bridge, mut chip) = (Bridge::new(), Mpu::mpu6050(0x68));
        bridge.feed(&bytes, &mut Wired { t_ns: 0, chips: &mut [&mut chip] }, &mut |_| {});
        bridge.forget();
        prop_assert_eq!(answer(&mut bridge, &mut chip, "53 d0 01 75 53 d1 01 50 52 0a 50", 64), hex("68 f0"));
    }

    /// What is encoded is what the bus sees.
    #[test]
    fn a_transfer_reaches_the_bus_as_it_was_meant(len in 0usize..600, count in any::<u8>()) {
        struct Seen { written: usize, joined: bool, count: usize }
        impl Bus for Seen {
            fn write(&mut self, address: u8, bytes: &[u8], joined: bool) -> bool {
                self.written += bytes.len();
                self.joined = joined;
                address == 0x29
            }
            fn read(&mut self, address: u8, out: &mut [u8]) -> bool {
                self.count = out.len();
                address == 0x29
            }
        }
        let (data, mut bytes, mut bridge) = ([0x53; 600], [0; 700], Bridge::new());
        let messages = [Message::Write(&data[..len]), Message::Read(count)];
        let size = encode(0x29, &messages, &mut bytes).expect("room");
        let (mut seen, mut replied) = (Seen { written: 0, joined: false, count: 0 }, 0);
        bridge.feed(&bytes[..size], &mut seen, &mut |reply| replied += reply.len());
        prop_assert_eq!((seen.written, seen.joined), (len, len > MAX_MESSAGE));
        prop_assert_eq!((seen.count, replied), (usize::from(count), usize::from(count)));
        prop_assert_eq!(bridge.counts(), Counts { transfers: 1, refused: 0, strange: 0 });
        prop_assert!(encode(0x29, &messages, &mut bytes[..size - 1]).is_err());
    }
}
