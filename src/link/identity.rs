//! Whether two paths or two links are the same: compares what a path leads to, not its spelling.

use super::address::Address;
use super::endpoint::Endpoint;
use std::ffi::OsString;
use std::fs;
use std::os::unix::fs::{FileTypeExt, MetadataExt};
use std::path::{Path, PathBuf};

/// The most symbolic links to follow; a longer chain is a cycle and counts as an absent file.
const LINKS: usize = 40;

/// What a path leads to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Identity {
    /// Device and inode, if it exists.
    there: Option<(u64, u64)>,
    /// Where it is, or would be created: its folder without symbolic links, and its name there.
    at: PathBuf,
}

impl Identity {
    /// The identity of what the path leads to through symbolic links, whether or not it exists yet.
    pub fn of(path: &Path) -> Identity {
        let mut path = path.to_path_buf();
        for _ in 0..LINKS {
            match fs::read_link(&path) {
                Ok(to) => path = path.parent().map_or(to.clone(), |folder| folder.join(&to)),
                Err(_) => break,
            }
        }
        let found = fs::metadata(&path).ok();
        Identity { there: found.map(|found| (found.dev(), found.ino())), at: place(&path) }
    }

    /// The identity of the name itself, without following a symbolic link.
    pub fn of_name(path: &Path) -> Identity {
        Identity { there: None, at: place(path) }
    }

    /// Whether both are the same.
    pub fn is(&self, other: &Identity) -> bool {
        self.at == other.at || (self.there.is_some() && self.there == other.there)
    }

    /// Whether it is that folder or lies in it, at any depth.
    pub fn is_within(&self, folder: &Identity) -> bool {
        self.at.starts_with(&folder.at) || self.is(folder)
    }
}

/// The path with its folder made canonical, as far as the folder exists.
fn place(path: &Path) -> PathBuf {
    if let Ok(canonical) = fs::symlink_metadata(path).and_then(|found| match found.is_symlink() {
        true => Err(std::io::ErrorKind::Other.into()),
        false => fs::canonicalize(path),
    }) {
        return canonical;
    }
    let mut rest: Vec<OsString> = Vec::new();
    let mut folder = std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
    while let (Some(name), Some(parent)) = (folder.file_name().map(OsString::from), folder.parent()) {
        rest.push(name);
        folder = parent.to_path_buf();
        if let Ok(canonical) = fs::canonicalize(&folder) {
            folder = canonical;
            break;
        }
    }
    rest.iter().rev().for_each(|name| folder.push(name));
    folder
}

/// Whether a path accepts data and keeps nothing, like `/dev/null`: two links may share it.
fn keeps_nothing(path: &Path) -> bool {
    let device = |path: &Path| fs::metadata(path).ok().filter(|it| it.file_type().is_char_device());
    device(path).is_some_and(|it| device(Path::new("/dev/null")).is_some_and(|null| null.rdev() == it.rdev()))
}

impl Address {
    /// What its path leads to, for a link that writes to one; `None` for a pty without a name.
    pub fn identity(&self) -> Option<Identity> {
        match self {
            Self::Pty { path, .. } => path.as_deref().map(Identity::of_name),
            Self::File { path } if keeps_nothing(path) => None,
            Self::Serial { path, .. } | Self::File { path } => Some(Identity::of(path)),
            // What it is redirected to, if that is a file: nobody else shares a pipe or a terminal.
            Self::Stdout => {
                let path = Path::new("/proc/self/fd/1");
                fs::metadata(path).is_ok_and(|found| found.is_file()).then(|| Identity::of(path))
            }
            _ => None,
        }
    }

    /// Whether both would mix their packets, or only one of them can open.
    pub fn is_same(&self, other: &Address) -> bool {
        match (self, other) {
            (Self::TcpIn(one), Self::TcpIn(two)) | (Self::UdpIn(one), Self::UdpIn(two)) => meets(one, two),
            (Self::TcpOut(one), Self::TcpOut(two)) | (Self::UdpOut(one), Self::UdpOut(two)) => {
                host(one) == host(two) && one.port == two.port
            }
            (Self::Stdout, Self::Stdout) => true,
            _ => self.identity().zip(other.identity()).is_some_and(|(one, two)| one.is(&two)),
        }
    }
}

/// Whether two listening links want the same port.
fn meets(one: &Endpoint, two: &Endpoint) -> bool {
    let any = |place: &Endpoint| ["0.0.0.0", "::", "*"].contains(&place.host.as_str());
    one.port != 0 && one.port == two.port && (host(one) == host(two) || any(one) || any(two))
}

fn host(place: &Endpoint) -> &str {
    match place.host.as_str() {
        "localhost" | "::1" => "127.0.0.1",
        host => host,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::fs::symlink;

    #[test]
    fn a_file_is_itself_by_any_name_and_no_other() {
        let home = tempfile::tempdir().unwrap();
        let at = |name: &str| home.path().join(name);
        fs::create_dir(at("sub")).unwrap();
        for name in ["scene.toml", "other.toml"] {
            fs::write(at(name), name).unwrap();
        }
        symlink(at("scene.toml"), at("soft")).unwrap();
        symlink("soft", at("softer")).unwrap();
        symlink(home.path(), at("sub/up")).unwrap();
        symlink(at("absent"), at("dangling")).unwrap();
        fs::hard_link(at("scene.toml"), at("hard")).unwrap();
        let scene = Identity::of(&at("scene.toml"));
        for name in ["soft", "softer", "hard", "sub/../scene.toml", "sub/up/scene.toml", "./scene.toml"] {
            assert!(Identity::of(&at(name)).is(&scene), "{name}");
        }
        for name in ["other.toml", "absent", "sub/scene.toml", "dangling"] {
            assert!(!Identity::of(&at(name)).is(&scene), "{name}");
        }
        assert!(!Identity::of_name(&at("soft")).is(&scene), "the link itself");
        // It does not exist yet.
        let absent = Identity::of(&at("absent"));
        for name in ["dangling", "sub/up/absent", "sub/../absent"] {
            assert!(Identity::of(&at(name)).is(&absent), "{name}");
        }
        assert!(!Identity::of(&at("absent2")).is(&absent));
    }

    #[test]
    fn what_lies_in_a_folder_is_within_it_and_its_neighbours_are_not() {
        let home = tempfile::tempdir().unwrap();
        let at = |name: &str| Identity::of(&home.path().join(name));
        fs::create_dir(home.path().join("out")).unwrap();
        symlink("out", home.path().join("also")).unwrap();
        for name in ["out/x", "also/x", "out/deep/x", "out", "also"] {
            assert!(at(name).is_within(&at("out")), "{name}");
        }
        for name in ["out2", "out2/x", "x", "."] {
            assert!(!at(name).is_within(&at("out")), "{name}");
        }
        assert!(at("new/x").is_within(&at("new")), "neither is there yet");
    }

    #[test]
    fn two_links_that_would_mix_their_packets_are_the_same() {
        let same =
            |one: &str, two: &str| one.parse::<Address>().unwrap().is_same(&two.parse::<Address>().unwrap());
        for (one, two) in [
            ("-", "-"),
            ("udpout:127.0.0.1:14550", "udpout:localhost:14550"),
            ("udpin:14550", "udpin:0.0.0.0:14550"),
            ("tcpin:4560", "tcpin:127.0.0.1:4560"),
            ("file:/tmp/x", "file:/tmp/./x"),
            ("pty:/tmp/imu", "file:/tmp/imu"),
            ("pty:/tmp/imu", "pty:/tmp/imu,9600"),
            ("/dev/ttyX0", "/dev/ttyX0,9600"),
        ] {
            assert!(same(one, two) && same(two, one), "{one} {two}");
        }
        for (one, two) in [
            ("pty", "pty"),
            ("udpout:127.0.0.1:14550", "udpout:127.0.0.1:14551"),
            ("udpin:14550", "tcpin:14550"),
            ("tcpin:0", "tcpin:0"),
            ("file:/dev/null", "file:/dev/null"),
            ("file:/tmp/x", "file:/tmp/y"),
        ] {
            assert!(!same(one, two), "{one} {two}");
        }
    }
}
