//! What a line asks a VN-100 for.

use crate::time::Rate;
use crate::wire::Controller;
use ratetable_protocols::vectornav::line::Line;

/// The answer to what is damaged or not known.
pub(super) const ERROR: &str = "VNERR,12";
/// Of the unit whose outputs are divided, Hz.
const UNIT_RATE: u64 = 800;
/// The registers that say what it is, as they are answered. ArduPilot asks one of these first letters for IMU and AHRS
/// packets alone.
pub(super) const MODEL: &str = "VNRRG,01,VN-100T-CR";
const HARDWARE: &str = "VNRRG,02,7";
const SERIAL: &str = "VNRRG,03,100000001";
const FIRMWARE: &str = "VNRRG,04,2.1.0.0";
/// The speeds that a VN-100 has, baud.
const SPEEDS: [u32; 9] = [9_600, 19_200, 38_400, 57_600, 115_200, 128_000, 230_400, 460_800, 921_600];

/// What a command wants.
#[derive(Debug, PartialEq)]
pub(super) enum Command<'a> {
    /// What is done already.
    Nothing,
    /// A register that says what the unit is: its contents.
    Read(&'static str),
    /// The settings of the unit's own filter.
    ReadFilter,
    /// Other settings of it.
    Filter(&'a str),
    /// No packets for now: the start of ArduPilot's handshake.
    Pause,
    /// To go on at this speed, baud.
    Speed(u32),
    /// The first output, as one firmware wants it, at this rate.
    First(Controller, Rate),
    /// The second output.
    Second(Controller, Rate),
    /// PX4's third output, a receiver's position, which is not there: the end of its handshake.
    Third,
    /// The stream: the end of ArduPilot's handshake.
    Stream,
    /// An error said or repeated, which is not answered.
    Error,
    /// Something that this unit does not do.
    Unknown,
}

impl Command<'_> {
    pub fn of(line: &Line) -> Command<'_> {
        let terms: Vec<_> = line.terms().collect();
        match terms[..] {
            ["VNASY", "0"] => Command::Pause,
            ["VNASY", "1"] => Command::Stream,
            // No text output on either port.
            ["VNWRG", "06", "0", _] | ["VNWRG", "6", "0"] => Command::Nothing,
            ["VNRRG", "01"] => Command::Read(MODEL),
            ["VNRRG", "02"] => Command::Read(HARDWARE),
            ["VNRRG", "03"] => Command::Read(SERIAL),
            ["VNRRG", "04"] => Command::Read(FIRMWARE),
            ["VNRRG", "35"] => Command::ReadFilter,
            ["VNWRG", "35", _, _, _, _] => Command::Filter(&line.text()["VNWRG,35,".len()..]),
            ["VNWRG", "5", baud] => speed(baud).map_or(Command::Unknown, Command::Speed),
            ["VNWRG", "75", _, divisor, "01", "0721"] => first(Controller::Ardupilot, divisor),
            ["VNWRG", "75", _, divisor, "6", "1", "600"] => first(Controller::Px4Vectornav, divisor),
            ["VNWRG", "76", _, divisor, "11", "0001", "0106"] => second(Controller::Ardupilot, divisor),
            ["VNWRG", "76", _, divisor, "36", "1", "130", "84", "613"] => {
                second(Controller::Px4Vectornav, divisor)
            }
            ["VNWRG", "77", ..] => Command::Third,
            ["VNERR", ..] => Command::Error,
            _ => Command::Unknown,
        }
    }
}

fn first(whose: Controller, divisor: &str) -> Command<'static> {
    divided(divisor).map_or(Command::Unknown, |rate| Command::First(whose, rate))
}

fn second(whose: Controller, divisor: &str) -> Command<'static> {
    divided(divisor).map_or(Command::Unknown, |rate| Command::Second(whose, rate))
}

/// The rate of an output, by what the unit's own is divided by: in decimal, as both firmwares write it.
fn divided(divisor: &str) -> Option<Rate> {
    Rate::new(UNIT_RATE, divisor.parse::<u16>().ok()?.into())
}

fn speed(baud: &str) -> Option<u32> {
    baud.parse().ok().filter(|baud| SPEEDS.contains(baud))
}
