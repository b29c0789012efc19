//! Which process has a device open (as `fuser` does), for error messages.

use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};

/// A process that has a device open.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Holder {
    /// Its process id.
    pub pid: u32,
    /// Its name in the system.
    pub name: String,
}

impl Holder {
    /// How to make the usual programs release a device.
    pub(super) fn advice(&self) -> Option<&'static str> {
        let name = self.name.to_ascii_lowercase();
        if name.starts_with("qgroundcontrol") || name.starts_with("qgc") {
            Some("close QGroundControl, or turn off its AutoConnect for serial devices")
        } else if name.starts_with("modemmanager") {
            Some("ModemManager probes every new port: `sudo systemctl stop ModemManager`")
        } else {
            None
        }
    }
}

impl fmt::Display for Holder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { pid, name } = self;
        match *pid == std::process::id() {
            true => write!(f, "this program (process {pid})"),
            false => write!(f, "{name} (process {pid})"),
        }
    }
}

/// The processes that have `device` open, as far as this user can see: only root sees all of them.
pub(super) fn holders(device: &Path) -> Vec<Holder> {
    let device = fs::canonicalize(device).unwrap_or_else(|_| device.to_owned());
    processes()
        .filter(|(_, process)| descriptors(process, &device).next().is_some())
        .map(|(pid, process)| {
            let name = fs::read_to_string(process.join("comm")).unwrap_or_default();
            let name = name.trim_end().to_owned();
            Holder { pid, name }
        })
        .collect()
}

/// How many descriptors of all processes refer to `device`.
pub(super) fn times_open(device: &Path) -> usize {
    processes().map(|(_, process)| descriptors(&process, device).count()).sum()
}

/// Every process: its id and its folder.
fn processes() -> impl Iterator<Item = (u32, PathBuf)> {
    let entries = fs::read_dir("/proc").into_iter().flatten().flatten();
    entries.filter_map(|entry| {
        let pid = entry.file_name().to_str()?.parse().ok()?;
        Some((pid, entry.path()))
    })
}

/// The descriptors of a process (its folder in `/proc`) that refer to `device`.
fn descriptors(process: &Path, device: &Path) -> impl Iterator<Item = fs::DirEntry> {
    let all = fs::read_dir(process.join("fd")).into_iter().flatten();
    all.flatten().filter(move |entry| fs::read_link(entry.path()).is_ok_and(|target| target == device))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_process_that_has_a_file_open_is_found() {
        let file = tempfile::NamedTempFile::new().unwrap();
        let found = holders(file.path());
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].pid, std::process::id());
        assert!(found[0].to_string().contains("this program"));
        assert_eq!(times_open(file.path()), 1);
        let closed = file.into_temp_path();
        assert_eq!(holders(&closed), []);
    }

    #[test]
    fn the_usual_suspects_come_with_a_remedy() {
        let holder = |name: &str| Holder { pid: 1, name: name.to_owned() };
        assert!(holder("QGroundControl").advice().unwrap().contains("AutoConnect"));
        assert!(holder("ModemManager").advice().unwrap().contains("systemctl"));
        assert_eq!(holder("minicom").advice(), None);
        assert_eq!(holder("minicom").to_string(), "minicom (process 1)");
    }
}
