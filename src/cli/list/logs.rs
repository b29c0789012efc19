//! Kinds of files with attitudes or rates in them, and which command reads each.

use super::List;

/// What there is of them: name, how it is told, what it holds, who reads it.
const LOGS: [[&str; 4]; 6] = [
    [
        "dataset",
        "a folder with a manifest.json, in any format of `list formats`",
        "readings and exact truth, as `generate` and `run --out` write it",
        "score: the truth, and what filters run on",
    ],
    [
        "table",
        "text, first a line of column names, plain or a comment (EuRoC, TUM-VI, ulog2csv)",
        "a time and a quaternion, Euler angles or angular rates, found by name or named in the scene",
        "score; replay (its `file`)",
    ],
    [
        "tum",
        "eight numbers a line: t x y z qx qy qz qw",
        "a trajectory as evo and SLAM tools write it",
        "score; replay (its `file`)",
    ],
    ["ulog", "begins with the bytes `ULog`", "a PX4 log: the topic vehicle_attitude", "score"],
    [
        "tlog",
        "8 bytes of µs before each MAVLink packet",
        "what a ground station received, and when",
        "listen: ratetable listen mavlink@file:PATH",
    ],
    [
        "stream",
        "packets of a protocol, as recorded by file:PATH",
        "readings by their arrival or the times in them",
        "listen: ratetable listen PROTOCOL@file:PATH",
    ],
];

/// A row a kind.
pub fn list() -> List {
    let rows = LOGS.map(|row| row.map(String::from).to_vec()).to_vec();
    List::of_rows(&["log", "told by", "holds", "read by"], rows)
}
