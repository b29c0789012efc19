//! Files that are no tables, by their first bytes: what each is, and how a table comes out of it.

/// A kind of file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kind {
    /// What it is, with its article.
    pub name: &'static str,
    /// How it is told.
    pub by: &'static str,
    /// What would help.
    pub help: &'static str,
}

impl Kind {
    /// What it is, that it is not read here, and what would help; `reader` is who does not read it and what it reads
    /// instead.
    pub fn refusal(&self, name: &str, reader: &str) -> String {
        format!("{name} is {} (recognised by {}), which {reader}; {}", self.name, self.by, self.help)
    }
}

const BYTES: &str = "its first bytes";
const MAVLOGDUMP: &str = "pymavlink's `mavlogdump.py --format csv --types ATTITUDE` makes a table of it (of a .BIN with `--types ATT`)";

const fn kind(name: &'static str, help: &'static str) -> Kind {
    Kind { name, by: BYTES, help }
}

/// Rows of twelve numbers, which are no first bytes.
pub(super) const KITTI: Kind = Kind {
    name: "a file of KITTI poses",
    by: "its twelve numbers a row without a header",
    help: "it has no times: add them, as in a TUM trajectory `t x y z qx qy qz qw`",
};

const DATAFLASH: Kind = kind("an ArduPilot DataFlash log (.BIN)", MAVLOGDUMP);
const TLOG: Kind = kind("a MAVLink log with times (.tlog)", MAVLOGDUMP);
const MAVLINK: Kind = kind("a recording of raw MAVLink", "record a .tlog instead, which has times");
const ULOG: Kind = kind("a PX4 ULog", "pyulog's `ulog2csv -m vehicle_attitude` makes a table of it");
const UTF16: Kind = kind("text in UTF-16", "save it as UTF-8");

/// First bytes, and what begins with them.
const MAGICS: &[(&[u8], Kind)] = &[
    (b"\xa3\x95", DATAFLASH),
    (b"ULog\x01\x12\x35", ULOG),
    (b"\x89MCAP0\r\n", kind("an MCAP recording", "write the topic of the attitude as a table, time first")),
    (b"#ROSBAG V", kind("a ROS 1 bag", "`rostopic echo -b FILE -p TOPIC` makes a table of a topic")),
    (b"\x93NUMPY", kind("a NumPy array (.npy)", "`numpy.savetxt` with a `header` makes a table of it")),
    (b"PK\x03\x04", kind("a ZIP archive (.npz, .xlsx, .zip)", "unpack it, or save its sheet as CSV")),
    (b"\x1f\x8b", kind("a gzip archive", "unpack it with gunzip")),
    (b"\x28\xb5\x2f\xfd", kind("a Zstandard archive", "unpack it with unzstd")),
    (b"BZh", kind("a bzip2 archive", "unpack it with bunzip2")),
    (b"\xfd7zXZ\x00", kind("an xz archive", "unpack it with unxz")),
    (b"PAR1", kind("a Parquet file", "pandas' `read_parquet(…).to_csv(…)` makes a table of it")),
    (b"ARROW1", kind("an Arrow file", "pandas' `read_feather(…).to_csv(…)` makes a table of it")),
    (b"MATLAB 5.0 MAT-file", kind("a MATLAB file (.mat)", "`writetable` makes a table of it")),
    (
        b"\x89HDF\r\n\x1a\n",
        kind("an HDF5 file (.h5, .mat)", "pandas' `read_hdf(…).to_csv(…)` makes a table of it"),
    ),
    (
        b"SQLite format 3\x00",
        kind("an SQLite database (a ROS 2 bag is one)", "write the topic of the attitude as a table"),
    ),
    (
        b"H Product:Blackbox",
        kind("a Betaflight or INAV blackbox log", "`blackbox_decode` makes a table of it"),
    ),
    (
        b"FMT, 128,",
        kind(
            "an ArduPilot log as text (.log)",
            "its ATT lines under their FMT names, time first, are a table",
        ),
    ),
    (b"\xd0\xcf\x11\xe0", kind("an old Excel file (.xls)", "save its sheet as CSV")),
    (b"%PDF-", kind("a PDF", "it holds no numbers")),
    (b"\x89PNG\r\n\x1a\n", kind("a PNG picture", "it holds no numbers")),
    (b"\xff\xd8\xff", kind("a JPEG picture", "it holds no numbers")),
    (b"\x7fELF", kind("a program", "it holds no numbers")),
    (b"\xff\xfe", UTF16),
    (b"\xfe\xff", UTF16),
];

/// What begins with these bytes, where it is known and no text.
pub fn kind_of(bytes: &[u8]) -> Option<&'static Kind> {
    // Two zeros for which no text begins so.
    let known = MAGICS.iter().find(|(magic, _)| bytes.starts_with(magic)).map(|(_, kind)| kind);
    known.or_else(|| is_tlog(bytes).then_some(&TLOG)).or_else(|| is_mavlink(bytes).then_some(&MAVLINK))
}

/// A length byte that fits behind a start byte: MAVLink 2 has a short incompatibility field, both a system.
fn is_mavlink(bytes: &[u8]) -> bool {
    // Text has neither start byte; two frames in a row make it sure.
    let next = |bytes: &[u8]| -> Option<usize> {
        let length = usize::from(*bytes.get(1)?);
        match bytes.first()? {
            0xfe => Some(8 + length),
            0xfd => Some(12 + length + 13 * usize::from(*bytes.get(2)? & 1)),
            _ => None,
        }
    };
    let Some(second) = next(bytes) else { return false };
    bytes.get(second).is_none_or(|byte| matches!(byte, 0xfe | 0xfd))
}

/// Eight bytes of big-endian µs since 1970 before each frame.
fn is_tlog(bytes: &[u8]) -> bool {
    let Some((stamp, frame)) = bytes.split_first_chunk::<8>() else { return false };
    // The years 2000 to 2100.
    let is_date = (946_684_800_000_000..4_102_444_800_000_000).contains(&u64::from_be_bytes(*stamp));
    is_date && matches!(frame.first(), Some(0xfe | 0xfd))
}

/// Whether bytes are a text, in whatever code: no control characters in their beginning, and few letters that are
/// none of ASCII.
pub fn is_text(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(4096)];
    let is_control = |byte: &u8| *byte < 32 && !matches!(*byte, b'\n' | b'\r' | b'\t' | 12);
    let other = head.iter().filter(|byte| **byte >= 128).count();
    let is_utf8 = match std::str::from_utf8(head) {
        Ok(_) => true,
        Err(error) => error.error_len().is_none(),
    };
    !head.iter().any(is_control) && (is_utf8 || 8 * other < head.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_named_as_what_it_is() {
        let stamp = 1_700_000_000_000_000u64.to_be_bytes();
        let frame = [&[0xfe, 9, 0, 1, 1, 0][..], &[0; 9], &[1, 2]].concat();
        let tlog = [&stamp[..], &frame].concat();
        let raw = [&frame[..], &frame].concat();
        for (bytes, name) in [
            (&b"\xa3\x95\x80"[..], "DataFlash"),
            (&tlog, ".tlog"),
            (&raw, "raw MAVLink"),
            (b"ULog\x01\x12\x35\x01", "ULog"),
            (b"\x93NUMPY\x01", "NumPy"),
            (b"PK\x03\x04", "ZIP"),
            (b"\x1f\x8b\x08", "gzip"),
            (b"PAR1", "Parquet"),
            (b"MATLAB 5.0 MAT-file, Platform", "MATLAB"),
            (b"\x89HDF\r\n\x1a\n", "HDF5"),
            (b"SQLite format 3\x00", "SQLite"),
            (b"%PDF-1.4", "PDF"),
            (b"#ROSBAG V2.0", "ROS 1 bag"),
            (b"\xff\xfet\x00", "UTF-16"),
        ] {
            let kind = kind_of(bytes).unwrap_or_else(|| panic!("{name}"));
            assert!(kind.name.contains(name), "{name}: {kind:?}");
        }
        for text in ["t_s,qw,qx,qy,qz\n", "#timestamp [ns],q\n", "0 0 0 0 0 0 0 1\n", "%time,field\n", ""] {
            assert_eq!(kind_of(text.as_bytes()), None, "{text}");
        }
    }

    #[test]
    fn bytes_of_a_text_are_told_from_others() {
        for text in [&b"t_s,roll [\xb0]\n0,1\n1,2\n"[..], "t,µ\r\n".as_bytes(), b"", b"a\tb"] {
            assert!(is_text(text), "{text:?}");
        }
        for bytes in [&[0xff; 99][..], b"abc\x00def", &[1, 2, 3]] {
            assert!(!is_text(bytes), "{bytes:?}");
        }
    }
}
