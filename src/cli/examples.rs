//! Examples below each command's `--help`: each line works as written.

/// `ratetable`.
pub const PROGRAM: &str = "\
Examples:
  # the demonstration: no hardware needed
  ratetable run
  # what a scene amounts to
  ratetable check table-1
  # its readings and exact truth as files
  ratetable generate table-1 --out flight
  # its packets to a serial port
  ratetable run still --to mpu@/dev/ttyUSB0
  # what there is
  ratetable list scenes

Exit code: 0 done and within limits; 1 ran, but a limit failed or something was lost; 2 could not run.";

/// `run`.
pub const RUN: &str = "\
Examples:
  # the demonstration: no hardware needed
  ratetable run
  # to a program that opens /tmp/imu
  ratetable run still --to mpu@pty:/tmp/imu --for 60s
  # every reading as text, unpaced
  ratetable run table-1 --to csv@file:readings.csv --speed max
  # to a board on a serial port
  ratetable run mpu-9250 --to mpu@/dev/ttyUSB0,921600
  # to PX4, QGroundControl and a page in a browser beside it
  ratetable run --to px4@/dev/ttyACM0 --qgc --live";

/// `timing`.
pub const TIMING: &str = "\
Examples:
  # over a pty, at 1 kHz
  ratetable timing --for 5s
  # at 8 kHz, every sample's times kept
  ratetable timing --set gyro.rate='8 kHz' --for 5s --out timing
  # exit 1 if a sample is missed
  ratetable timing --for 5s --limit 'sensors.gyro.missed<1'
  # a port with TX connected to RX
  ratetable timing --to mpu@/dev/ttyUSB0,921600";

/// `generate`.
pub const GENERATE: &str = "\
Examples:
  # CSV, exact truth, pictures
  ratetable generate table-1 --out flight --figures
  # another specimen of the noise, for ten seconds
  ratetable generate still --set seed=7 --set 'duration=10 s' --out seven
  # for NumPy and MATLAB
  ratetable generate table-1 --out arrays --format npy,mat
  # ten specimens of the noise
  ratetable generate coning --runs 10 --out runs
  # half of them, as one of two machines
  ratetable generate coning --runs 10 --shard 1/2 --out share";

/// `check`.
pub const CHECK: &str = "\
Examples:
  # sensors, noise, effects
  ratetable check table-1
  # with one key changed
  ratetable check manoeuvre --set gyro.rate='8 kHz'
  # for a program
  ratetable check mpu-9250 --json";

/// `listen`.
pub const LISTEN: &str = "\
Examples:
  # a simulator that sends to this port
  ratetable listen mavlink@udpin:14550
  # a board, or the other end of a cable
  ratetable listen mpu@/dev/ttyUSB1,921600
  # a recording
  ratetable listen csv@file:readings.csv
  # ten seconds of what `run --to mpu@pty:/tmp/imu` sends; exit 1 if a sample is missing
  ratetable listen mpu@/tmp/imu --for 10s --limit 'sensors.gyro.missed<1'";

/// `score`.
pub const SCORE: &str = "\
Examples, after `ratetable generate table-1 --out flight`:
  # filters on the dataset's readings
  ratetable score flight vqf fusion madgwick mahony --settle 5s
  # exit 1 if it is worse
  ratetable score flight vqf --limit 'rms_deg<1'
  # without a magnetometer; charts
  ratetable score flight vqf-6d --align heading --out compared
  # your estimates
  ratetable score flight mine.csv log.ulg";

/// `study`.
pub const STUDY: &str = "\
Examples:
  # error against cost, some seconds
  ratetable study accuracy --quick
  # everything, with charts
  ratetable study all --out study
  # attitude filters, on a scene of yours as well
  ratetable study filters table-1 --quick
  # what a sample of a scene costs
  ratetable study cost table-1
  # the Allan deviation of its sensors
  ratetable study allan still";

/// `list`.
pub const LIST: &str = "\
Examples:
  # built-in scenes
  ratetable list scenes
  # its file, to copy
  ratetable list scenes still
  # every value with its source
  ratetable list parts MPU-9250
  # what one key takes
  ratetable list keys gyro.bias_instability
  # what --limit may name
  ratetable list fields run";

/// `completions`.
pub const COMPLETIONS: &str = "\
Examples:
  # then: source ratetable.bash
  ratetable completions bash > ratetable.bash
  # into a folder of $fpath
  ratetable completions zsh > _ratetable
  # into ~/.config/fish/completions
  ratetable completions fish > ratetable.fish";

/// `man`.
pub const MAN: &str = "\
Examples:
  # then: man -l ratetable.1
  ratetable man > ratetable.1
  # a page for each command, too
  ratetable man --out man1";
