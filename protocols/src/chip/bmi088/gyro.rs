//! The gyro of a BMI088 (BST-BMI088-DS001, sections 5.4 and 5.5).

use crate::chip::bosch::{Frames, gyro_range, setting};
use crate::chip::fifo::add;
use crate::chip::{Channel, Latest, Registers, Samples, Setting, Tally};

const GYRO_CHIP_ID: u8 = 0x00;
const RATE_X_LSB: u8 = 0x02;
const RATE_Z_MSB: u8 = 0x07;
const GYRO_INT_STAT_1: u8 = 0x0a;
const FIFO_STATUS: u8 = 0x0e;
const GYRO_RANGE: u8 = 0x0f;
const GYRO_BANDWIDTH: u8 = 0x10;
const GYRO_LPM1: u8 = 0x11;
const GYRO_SOFTRESET: u8 = 0x14;
const GYRO_INT_CTRL: u8 = 0x15;
const INT3_INT4_IO_CONF: u8 = 0x16;
const INT3_INT4_IO_MAP: u8 = 0x18;
const FIFO_WM_EN: u8 = 0x1e;
const FIFO_EXT_INT_S: u8 = 0x34;
const GYRO_SELF_TEST: u8 = 0x3c;
const FIFO_CONFIG_0: u8 = 0x3d;
const FIFO_CONFIG_1: u8 = 0x3e;
const FIFO_DATA: u8 = 0x3f;

/// Bytes of a frame.
const FRAME: usize = 6;
/// Frames that stop a FIFO, and that a stream keeps (section 4.9.4.4).
const STOPS_AT: usize = 100;
const STREAM_OF: usize = 99;
/// Modes in FIFO_CONFIG_1.
const FIFO_MODE: u8 = 0x40;
const STREAM_MODE: u8 = 0x80;

const DATA_INT: u8 = 0x80;
const FIFO_INT: u8 = 0x10;
/// How long the data ready interrupt lasts at least, ns: 280 to 400 µs (section 5.5.3).
const PULSE_NS: u64 = 280_000;

/// Rate and filter by GYRO_BANDWIDTH (section 5.5.6).
const BANDWIDTHS: [(u32, &str); 8] = [
    (2000, "BW 532"),
    (2000, "BW 230"),
    (1000, "BW 116"),
    (400, "BW 47"),
    (200, "BW 23"),
    (100, "BW 12"),
    (200, "BW 64"),
    (100, "BW 32"),
];

#[derive(Clone, Debug)]
pub(super) struct Gyro {
    pointer: u8,
    registers: [u8; 64],
    latest: Latest,
    frames: Frames<{ FRAME * STOPS_AT }>,
    has_overrun: bool,
    /// When its newest sample came, and the latest time that it has heard of, ns.
    made_ns: Option<u64>,
    now_ns: u64,
}

impl Gyro {
    pub fn new() -> Gyro {
        let mut gyro = Gyro {
            pointer: 0,
            registers: [0; 64],
            latest: Latest::default(),
            frames: Frames::new(FRAME * STOPS_AT),
            has_overrun: false,
            made_ns: None,
            now_ns: 0,
        };
        gyro.reset();
        gyro
    }

    fn reset(&mut self) {
        self.configure();
        self.latest.clear();
        self.made_ns = None;
    }

    /// Every configuration as after a reset (section 5.4).
    fn configure(&mut self) {
        self.registers = [0; 64];
        for (register, value) in [(GYRO_BANDWIDTH, 0x80), (INT3_INT4_IO_CONF, 0x0f), (FIFO_WM_EN, 0x08)] {
            self.set(register, value);
        }
        self.clear_fifo();
    }

    const fn of(&self, register: u8) -> u8 {
        self.registers[register as usize & 0x3f]
    }

    fn set(&mut self, register: u8, value: u8) {
        self.registers[usize::from(register & 0x3f)] = value;
    }

    /// Normal mode, or suspend (0x80); deep suspend (0x20) loses every configuration too (section 4.1.2).
    fn set_power(&mut self, mode: u8) {
        match mode {
            0x00 | 0x80 => self.set(GYRO_LPM1, mode),
            0x20 => {
                self.configure();
                self.set(GYRO_LPM1, mode);
            }
            _ => {}
        }
    }

    /// Empties the FIFO, as writing its configuration does; its samples are missed.
    fn clear_fifo(&mut self) {
        self.latest.tally.missed += self.frames.clear()[Channel::Gyro as usize];
        self.has_overrun = false;
        let frames = if self.fifo_mode() == STREAM_MODE { STREAM_OF } else { STOPS_AT };
        self.frames.resize(FRAME * frames);
    }

    const fn fifo_mode(&self) -> u8 {
        self.of(FIFO_CONFIG_1) & 0xc0
    }

    const fn capacity(&self) -> usize {
        if self.fifo_mode() == STREAM_MODE { STREAM_OF } else { STOPS_AT }
    }

    fn queued(&self) -> usize {
        self.frames.len() / FRAME
    }

    pub fn setting(&self) -> Setting {
        let (hz, filter) = BANDWIDTHS[usize::from(self.of(GYRO_BANDWIDTH) & 7)];
        let range = gyro_range(self.of(GYRO_RANGE));
        setting(self.of(GYRO_LPM1) == 0, Some((hz, 1)), range, Some(filter))
    }

    pub fn sample(&mut self, t_ns: u64, samples: &Samples) {
        self.now_ns = self.now_ns.max(t_ns);
        let Some(counts) = samples.gyro.filter(|_| self.setting().rate.is_some()) else {
            return;
        };
        let enters = matches!(self.fifo_mode(), FIFO_MODE | STREAM_MODE);
        self.latest.put(counts, enters);
        self.made_ns = Some(t_ns);
        if enters {
            let mut frame = [0; FRAME];
            for (to, count) in frame.chunks_exact_mut(2).zip(counts) {
                to.copy_from_slice(&count.to_le_bytes());
            }
            let channel = 1 << Channel::Gyro as u8;
            let lost = self.frames.push(&frame, channel, self.fifo_mode() == FIFO_MODE);
            let lost = lost[Channel::Gyro as usize];
            self.latest.tally.overflowed += lost;
            self.has_overrun |= lost > 0;
        }
    }

    pub fn tally(&self) -> Tally {
        self.latest.tally
    }

    /// GYRO_INT_STAT_1 of what GYRO_INT_CTRL enables: data ready for a while, the FIFO's as long as its cause.
    fn interrupts(&self) -> u8 {
        let control = self.of(GYRO_INT_CTRL);
        let is_fresh = self.made_ns.is_some_and(|made_ns| self.now_ns.saturating_sub(made_ns) < PULSE_NS);
        let mark = usize::from(self.of(FIFO_CONFIG_0) & 0x7f).max(1);
        let is_past = self.of(FIFO_WM_EN) & 0x80 != 0 && self.queued() >= mark;
        let data = if control & 0x80 != 0 && is_fresh { DATA_INT } else { 0 };
        let fifo = control & 0x40 != 0 && (is_past || self.queued() >= self.capacity());
        data | if fifo { FIFO_INT } else { 0 }
    }

    /// INT3.
    pub fn interrupt(&self) -> bool {
        let map = self.of(INT3_INT4_IO_MAP);
        let mapped = if map & 0x01 != 0 { DATA_INT } else { 0 } | if map & 0x04 != 0 { FIFO_INT } else { 0 };
        self.interrupts() & mapped != 0
    }

    /// The oldest byte of the FIFO; 0 where it is empty (assumed).
    fn pop(&mut self) -> u8 {
        if self.frames.len() == 0 {
            return 0;
        }
        let (byte, whole) = self.frames.next_byte(false, None);
        let mut read = [0; 3];
        add(&mut read, whole);
        self.latest.tally.read += read[Channel::Gyro as usize];
        byte
    }

    pub fn lacks(&self) -> Option<&'static str> {
        (self.of(FIFO_EXT_INT_S) & 0x20 != 0).then_some(
            "tags in the gyro's FIFO (FIFO_EXT_INT_S bit 5): the lowest bit of z is the reading's own",
        )
    }
}

impl Registers for Gyro {
    fn pointer(&mut self) -> &mut u8 {
        &mut self.pointer
    }

    fn write(&mut self, _t_ns: u64, register: u8, value: u8) {
        match register {
            GYRO_SOFTRESET if value == 0xb6 => self.reset(),
            GYRO_LPM1 => self.set_power(value),
            GYRO_BANDWIDTH => self.set(register, value | 0x80),
            // The test ends at once and finds the sensor in order (section 5.5.14).
            GYRO_SELF_TEST => self.set(register, if value & 1 == 1 { 0x02 } else { 0x00 }),
            FIFO_CONFIG_0 | FIFO_CONFIG_1 => {
                self.set(register, value);
                self.clear_fifo();
            }
            GYRO_RANGE | GYRO_INT_CTRL | INT3_INT4_IO_CONF | INT3_INT4_IO_MAP | FIFO_WM_EN
            | FIFO_EXT_INT_S => self.set(register, value),
            _ => {}
        }
    }

    fn read(&mut self, t_ns: u64, register: u8) -> u8 {
        self.now_ns = self.now_ns.max(t_ns);
        match register {
            GYRO_CHIP_ID => 0x0f,
            RATE_X_LSB..=RATE_Z_MSB => self.latest.low_first(register - RATE_X_LSB),
            GYRO_INT_STAT_1 => self.interrupts(),
            FIFO_STATUS => u8::from(self.has_overrun) << 7 | self.queued() as u8,
            GYRO_SELF_TEST => self.of(register) | 0x10,
            FIFO_DATA => self.pop(),
            _ if register < 0x40 => self.of(register),
            _ => 0,
        }
    }

    /// What the read before left of a frame is lost (section 4.9.4.2).
    fn begin_read(&mut self) {
        let mut lost = [0; 3];
        add(&mut lost, self.frames.drop_partial());
        self.latest.tally.missed += lost[Channel::Gyro as usize];
        self.frames.begin();
    }

    fn after(&self, register: u8) -> u8 {
        if register == FIFO_DATA { register } else { register.wrapping_add(1) & 0x7f }
    }
}
