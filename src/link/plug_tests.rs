//! A serial port that is unplugged and reconnected: here the slave of a pty whose master closes, published at a
//! path that then leads to another. The system calls answer as they do for an adapter.

use std::os::fd::OwnedFd;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::time::Duration;

use bytes::BytesMut;
use rustix::pty::{OpenptFlags, openpt, ptsname, unlockpt};

use super::*;

/// A new pty published at `path`, in place of the previous one.
fn plug_in(path: &Path) -> OwnedFd {
    let flags = OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC;
    let master = openpt(flags).unwrap();
    unlockpt(&master).unwrap();
    let device = ptsname(&master, Vec::new()).unwrap().into_string().unwrap();
    let _ = std::fs::remove_file(path);
    symlink(device, path).unwrap();
    master
}

/// Polls until `done`, long enough for the slowest machine.
async fn until(what: &str, mut done: impl FnMut() -> bool) {
    for _ in 0..60_000 {
        if done() {
            return;
        }
        tokio::time::sleep(Duration::from_millis(1)).await;
    }
    panic!("{what} never happened");
}

fn read(master: &OwnedFd, count: usize) -> Vec<u8> {
    let mut bytes = vec![0; count];
    let mut done = 0;
    while done < count {
        done += rustix::io::read(master, &mut bytes[done..]).unwrap();
    }
    bytes
}

#[tokio::test]
async fn a_port_that_is_pulled_out_is_found_again_by_its_path() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("adapter");
    let mut master = plug_in(&path);
    let address = format!("serial:{},115200", path.display()).parse().unwrap();
    let mut link = Link::open(&address).await.unwrap();
    let mut sender = link.sender();
    let mut receiver = link.receiver().unwrap();
    let (tell, mut heard) = tokio::sync::mpsc::unbounded_channel();
    let ear = tokio::spawn(async move {
        loop {
            let mut buffer = BytesMut::new();
            let count = receiver.recv(&mut buffer).await.unwrap();
            assert!(count > 0, "a port that may come back never ends");
            let _ = tell.send(buffer);
        }
    });
    for round in 0..3_u8 {
        assert_eq!(sender.send(&[round; 100]), Sent::Done);
        assert_eq!(read(&master, 100), [round; 100], "what is sent goes to the port that is there");
        rustix::io::write(&master, &[round; 10]).unwrap();
        assert_eq!(heard.recv().await.unwrap()[..], [round; 10], "and what it answers is heard");
        assert!(link.peer_is_present() && !link.is_unplugged());
        std::fs::remove_file(&path).unwrap();
        drop(master);
        // The receiver and the sender take turns in finding it gone.
        if round != 1 {
            until("the unplugging", || link.is_unplugged()).await;
        }
        until("a refusal", || sender.send(&[200; 100]) == Sent::Away).await;
        assert!(link.is_unplugged() && link.peer_has_left() && sender.kept() == 0);
        master = plug_in(&path);
        until("the return", || !link.is_unplugged()).await;
    }
    ear.abort();
}

#[tokio::test]
async fn a_packet_that_was_cut_by_the_plug_does_not_go_on_after_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("adapter");
    let master = plug_in(&path);
    let mut link = Link::open(&format!("serial:{}", path.display()).parse().unwrap()).await.unwrap();
    let (mut sender, mut receiver) = (link.sender(), link.receiver().unwrap());
    let ear = tokio::spawn(async move { while receiver.recv(&mut BytesMut::new()).await.is_ok() {} });
    // Nobody reads: in the end the port takes a packet in part.
    until("a full port", || sender.send(&[1; 1000]) == Sent::Full).await;
    assert!(sender.kept() > 0);
    drop(master);
    until("a refusal", || sender.send(&[1; 1000]) == Sent::Away).await;
    let master = plug_in(&path);
    until("the return", || sender.send(&[2; 50]) == Sent::Done).await;
    assert_eq!(read(&master, 50), [2; 50]);
    ear.abort();
}

fn speed(master: &OwnedFd) -> u32 {
    rustix::termios::tcgetattr(master).unwrap().output_speed()
}

#[tokio::test]
async fn a_port_changes_its_speed_while_it_is_used_and_keeps_it_when_it_is_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("adapter");
    let mut master = plug_in(&path);
    let address = format!("serial:{},115200", path.display()).parse().unwrap();
    let mut link = Link::open(&address).await.unwrap();
    let baud = link.baud().expect("a port has a speed");
    let mut sender = link.sender();
    let mut receiver = link.receiver().unwrap();
    let ear = tokio::spawn(async move {
        let mut buffer = BytesMut::new();
        while receiver.recv(&mut buffer).await.is_ok() {}
    });
    assert_eq!((speed(&master), baud.now()), (115_200, 115_200));
    assert_eq!(sender.send(&[1; 100]), Sent::Done);
    baud.set(921_600).unwrap();
    assert_eq!((speed(&master), baud.now()), (921_600, 921_600));
    assert_eq!(read(&master, 100), [1; 100], "what was sent before is not lost");
    std::fs::remove_file(&path).unwrap();
    drop(master);
    until("the unplugging", || link.is_unplugged()).await;
    baud.set(460_800).unwrap();
    master = plug_in(&path);
    until("the return", || !link.is_unplugged()).await;
    assert_eq!((speed(&master), baud.now()), (460_800, 460_800));
    ear.abort();
    let none: Vec<Address> = ["pty", "tcpin:0", "udpin:0"].map(|it| it.parse().unwrap()).into();
    for address in none {
        assert!(Link::open(&address).await.unwrap().baud().is_none(), "{address}");
    }
}
