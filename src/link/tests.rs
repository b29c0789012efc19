//! Behaviour that every kind of link must have.
//!
//! No test measures wall time; [`soon`] only stops a broken one from hanging.

use std::fs::{File, OpenOptions};
use std::future::Future;
use std::io::{self, Read, Write};
use std::net::{IpAddr, TcpListener, TcpStream, UdpSocket};
use std::os::fd::OwnedFd;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use bytes::BytesMut;
use rustix::pty::{OpenptFlags, ioctl_tiocgptpeer, openpt, ptsname, unlockpt};

use super::*;

/// Long enough for the slowest machine.
async fn soon<T>(future: impl Future<Output = T>) -> T {
    tokio::time::timeout(Duration::from_secs(60), future).await.expect("nothing happened")
}

async fn open(spelled: &str) -> Link {
    let address: Address = spelled.parse().unwrap();
    soon(Link::open(&address)).await.unwrap()
}

/// Waits until nobody has the link open.
async fn left(link: &Link) {
    let gone = async {
        while link.peer_is_present() {
            tokio::time::sleep(Duration::from_millis(1)).await;
        }
    };
    soon(gone).await;
}

async fn refusal(spelled: &str) -> String {
    let address: Address = spelled.parse().unwrap();
    let refused = soon(Link::open(&address)).await;
    refused.err().expect("it opened").to_string()
}

/// The other side of a link, as a program at the far end holds it.
struct Far {
    read: Box<dyn Read + Send>,
    write: Box<dyn Write + Send>,
    /// Other descriptors that keep the far end alive.
    _alive: Vec<OwnedFd>,
}

impl Far {
    fn of(file: File) -> Self {
        let read = Box::new(file.try_clone().unwrap());
        Self { read, write: Box::new(file), _alive: Vec::new() }
    }

    fn tcp(stream: TcpStream) -> Self {
        let read = Box::new(stream.try_clone().unwrap());
        Self { read, write: Box::new(stream), _alive: Vec::new() }
    }

    fn slave(path: &str) -> Self {
        Self::of(slave(path))
    }
}

/// A pty's slave, opened the way a firmware opens its port.
fn slave(path: impl AsRef<Path>) -> File {
    use std::os::unix::fs::OpenOptionsExt;
    OpenOptions::new().read(true).write(true).custom_flags(libc::O_NOCTTY).open(path).unwrap()
}

/// The master and the slave's path of an independent pty, as a stand-in for a serial port.
fn port() -> (OwnedFd, String) {
    let flags = OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC;
    let master = openpt(flags).unwrap();
    unlockpt(&master).unwrap();
    let path = ptsname(&master, Vec::new()).unwrap();
    (master, path.into_string().unwrap())
}

/// Every stream, opened and connected.
async fn streams() -> Vec<(&'static str, Link, Far)> {
    let pty = open("pty").await;
    let reader = Far::slave(pty.name());

    let (master, path) = port();
    let held = ioctl_tiocgptpeer(&master, OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
    let serial = open(&format!("serial:{path},1234567")).await;
    let mut device = Far::of(master.into());
    device._alive.push(held);

    let tcpin = open("tcpin:0").await;
    let client = Far::tcp(TcpStream::connect(tcpin.name()).unwrap());

    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let tcpout = open(&format!("tcpout:{}", listener.local_addr().unwrap())).await;
    let server = Far::tcp(listener.accept().unwrap().0);

    let mut all = vec![
        ("pty", pty, reader),
        ("serial", serial, device),
        ("tcpin", tcpin, client),
        ("tcpout", tcpout, server),
    ];
    for (kind, link, _) in &mut all {
        soon(link.peer()).await.unwrap();
        assert!(link.peer_is_present(), "{kind}");
    }
    all
}

/// Bytes in which a hole or a swap is visible.
fn pattern(count: usize) -> Vec<u8> {
    (0..count).map(|i| (i ^ (i >> 8) ^ (i >> 16)) as u8).collect()
}

/// A slow reader: reads every byte, in small pieces, with pauses.
fn read_slowly(mut far: impl Read + Send + 'static, count: usize) -> thread::JoinHandle<Vec<u8>> {
    thread::spawn(move || {
        let mut all = vec![0; count];
        let mut done = 0;
        let mut reads = 0_u32;
        while done < count {
            let end = count.min(done + 4096);
            done += far.read(&mut all[done..end]).unwrap();
            reads += 1;
            if reads.is_multiple_of(16) {
                thread::sleep(Duration::from_millis(1));
            }
        }
        all
    })
}

#[tokio::test]
async fn a_megabyte_arrives_whole_and_in_order_at_a_slow_reader() {
    let sent = pattern(1 << 20);
    for (kind, mut link, far) in streams().await {
        let mut sender = link.sender();
        let reader = read_slowly(far.read, sent.len());
        let packets = sent.clone();
        let writer = thread::spawn(move || {
            let stop = AtomicBool::new(false);
            for packet in packets.chunks(77) {
                assert_eq!(sender.send_all(packet, &stop), Sent::Done);
            }
            sender.finish().unwrap();
            sender
        });
        let received = tokio::task::spawn_blocking(|| reader.join().unwrap());
        let received = soon(received).await.unwrap();
        drop(writer.join().unwrap());
        assert!(received == sent, "{kind}");
        drop(far.write);
        soon(link.close()).await;
    }
}

#[tokio::test]
async fn what_the_other_side_answers_arrives_whole_and_in_order() {
    let sent = pattern(100_000);
    for (kind, mut link, far) in streams().await {
        let mut receiver = link.receiver().unwrap();
        assert!(link.receiver().is_none(), "{kind}: a link has one receiver");
        let answers = sent.clone();
        let mut write = far.write;
        let writer = thread::spawn(move || write.write_all(&answers).map(|()| write));
        let mut received = BytesMut::new();
        while received.len() < sent.len() {
            let count = soon(receiver.recv(&mut received)).await.unwrap();
            assert!(count > 0, "{kind}");
        }
        assert!(received == sent, "{kind}");
        drop(writer.join().unwrap().unwrap());
    }
}

#[tokio::test]
async fn a_link_that_nobody_reads_is_full_and_loses_no_packet_it_took() {
    for (kind, mut link, far) in streams().await {
        let mut sender = link.sender();
        let packet = pattern(250);
        let mut taken = 0_usize;
        while sender.send(&packet) == Sent::Done {
            taken += 1;
            assert!(taken < 1_000_000, "{kind} takes anything");
        }
        // A socket's buffers may still grow a little; in the end it stays full.
        assert!(taken > 10, "{kind}");
        let reader = read_slowly(far.read, taken * packet.len());
        sender.finish().unwrap();
        let received = reader.join().unwrap();
        assert!(received.chunks(250).all(|chunk| chunk == packet), "{kind}");
    }
}

#[tokio::test]
async fn a_peer_that_leaves_is_gone_on_a_connection() {
    for (kind, mut link, far) in streams().await {
        // A reader may open a pty, and a port may be plugged in again.
        if ["pty", "serial"].contains(&kind) {
            continue;
        }
        let mut sender = link.sender();
        let mut receiver = link.receiver().unwrap();
        drop(far);
        let mut received = BytesMut::new();
        assert_eq!(soon(receiver.recv(&mut received)).await.unwrap(), 0, "{kind}");
        let stop = AtomicBool::new(false);
        let gone = loop {
            match sender.send_all(b"anybody?", &stop) {
                Sent::Done => {}
                other => break other,
            }
        };
        assert!(matches!(gone, Sent::Gone(_)), "{kind}: {gone:?}");
        assert_eq!(sender.kept(), 0, "{kind}");
    }
}

#[tokio::test]
async fn a_pty_starts_only_after_a_reader_has_opened_it() {
    let mut link = open("pty").await;
    let path = link.name().to_owned();
    let nobody = tokio::time::timeout(Duration::from_millis(150), link.peer()).await;
    assert!(nobody.is_err(), "it started with nobody there");
    assert!(!link.peer_is_present());

    // A program that only configures the port and leaves is no reader.
    drop(slave(&path));
    let nobody = tokio::time::timeout(Duration::from_millis(250), link.peer()).await;
    assert!(nobody.is_err(), "it started for one who had left");

    let reader = slave(&path);
    soon(link.peer()).await.unwrap();
    assert!(link.peer_is_present());
    drop(reader);
    left(&link).await;
}

#[tokio::test]
async fn a_pty_is_met_by_a_reader_that_came_before_anybody_asked() {
    let mut link = open("pty").await;
    let _reader = slave(link.name());
    let _another = slave(link.name());
    soon(link.peer()).await.unwrap();
}

#[tokio::test]
async fn a_pty_echoes_nothing_and_changes_no_byte() {
    let mut link = open("pty").await;
    let mut reader = slave(link.name());
    let mut sender = link.sender();
    let mut receiver = link.receiver().unwrap();
    let every: Vec<u8> = (0..=255).collect();
    assert_eq!(sender.send(&every), Sent::Done);
    let mut received = vec![0; 256];
    reader.read_exact(&mut received).unwrap();
    assert_eq!(received, every);
    reader.write_all(b"answer").unwrap();
    let mut answers = BytesMut::new();
    while answers.len() < 6 {
        soon(receiver.recv(&mut answers)).await.unwrap();
    }
    assert_eq!(&answers[..], b"answer");
}

#[tokio::test]
async fn a_pty_is_revived_by_a_reader_that_opens_its_path_again() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("imu");
    let mut link = open(&format!("pty:{}", path.display())).await;
    assert_eq!(Path::new(link.name()), path);
    let mut sender = link.sender();
    for round in 0..3_u8 {
        let mut reader = slave(&path);
        // Like a client that claims its port and dies with it.
        rustix::termios::ioctl_tiocexcl(&reader).unwrap();
        soon(link.peer()).await.unwrap();
        assert_eq!(sender.send(&[round; 50]), Sent::Done);
        let mut received = [0; 50];
        reader.read_exact(&mut received).unwrap();
        assert_eq!(received, [round; 50]);
        drop(reader);
        left(&link).await;
    }
    drop(sender);
    soon(link.close()).await;
    assert!(std::fs::symlink_metadata(&path).is_err());
}

#[tokio::test]
async fn a_pty_that_is_closed_waits_for_its_reader() {
    let mut link = open("pty").await;
    let mut reader = slave(link.name());
    soon(link.peer()).await.unwrap();
    let mut sender = link.sender();
    let sent = pattern(10_000);
    assert_eq!(sender.send(&sent), Sent::Done);
    assert_eq!(sender.kept(), 0);
    drop((sender, link.receiver()));
    let reading = thread::spawn(move || {
        let mut received = Vec::new();
        // Ends with an error when the master closes.
        let _ = reader.read_to_end(&mut received);
        received
    });
    soon(link.close()).await;
    assert!(reading.join().unwrap() == sent);
}

#[tokio::test]
async fn udp_answers_whoever_sent_first() {
    let mut link = open("udpin:0").await;
    let mut sender = link.sender();
    assert_eq!(sender.send(b"too early"), Sent::Full);
    assert!(!link.peer_is_present());
    let far = UdpSocket::bind("127.0.0.1:0").unwrap();
    far.send_to(b"hello", link.name()).unwrap();
    soon(link.peer()).await.unwrap();
    let mut receiver = link.receiver().unwrap();
    let mut received = BytesMut::new();
    soon(receiver.recv(&mut received)).await.unwrap();
    assert_eq!(&received[..], b"hello");
    exchange(&mut sender, &far);
    let too_long = sender.send(&vec![0; 65_530]);
    assert_eq!(too_long, Sent::Gone(io::ErrorKind::InvalidInput));
}

#[tokio::test]
async fn udp_sends_to_one_place_and_hears_its_answers() {
    let far = UdpSocket::bind("127.0.0.1:0").unwrap();
    let place = far.local_addr().unwrap();
    let mut link = open(&format!("udpout:{place}")).await;
    assert_eq!(link.name(), place.to_string());
    soon(link.peer()).await.unwrap();
    let mut sender = link.sender();
    let near = exchange(&mut sender, &far);
    far.send_to(b"one", near).unwrap();
    far.send_to(b"two", near).unwrap();
    let mut receiver = link.receiver().unwrap();
    let mut received = BytesMut::new();
    assert_eq!(soon(receiver.recv(&mut received)).await.unwrap(), 3);
    assert_eq!(soon(receiver.recv(&mut received)).await.unwrap(), 3);
    assert_eq!(&received[..], b"onetwo");
}

/// Sends datagrams, one for each packet and in order; returns their source.
fn exchange(sender: &mut Sender, far: &UdpSocket) -> std::net::SocketAddr {
    let stop = AtomicBool::new(false);
    let mut from = None;
    for i in 0..1000_u16 {
        let packet = pattern(50 + usize::from(i % 200));
        assert_eq!(sender.send_all(&packet, &stop), Sent::Done);
        let mut received = [0; 1000];
        let (count, near) = far.recv_from(&mut received).unwrap();
        assert_eq!(received[..count], packet);
        from = Some(near);
    }
    from.unwrap()
}

#[tokio::test]
async fn a_udp_peer_that_does_not_listen_yet_is_no_error() {
    let place = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let mut link = open(&format!("udpout:{place}")).await;
    let mut sender = link.sender();
    for _ in 0..100 {
        assert_eq!(sender.send(b"anybody?"), Sent::Done);
    }
}

#[tokio::test]
async fn a_listening_link_is_reached_from_this_machine_alone() {
    for spelled in ["tcpin:0", "udpin:0"] {
        let link = open(spelled).await;
        let address: std::net::SocketAddr = link.name().parse().unwrap();
        assert!(address.ip().is_loopback(), "{spelled}: {address}");
        assert_ne!(address.port(), 0);
    }
    let everywhere = open("tcpin:0.0.0.0:0").await;
    let address: std::net::SocketAddr = everywhere.name().parse().unwrap();
    assert_eq!(address.ip(), IpAddr::from([0, 0, 0, 0]));
}

#[tokio::test]
async fn tcp_starts_only_after_a_peer_has_connected_and_takes_no_other() {
    let mut link = open("tcpin:0").await;
    let name = link.name().to_owned();
    let mut sender = link.sender();
    let mut receiver = link.receiver().unwrap();
    let nobody = tokio::time::timeout(Duration::from_millis(50), link.peer()).await;
    assert!(nobody.is_err(), "it started with nobody there");
    assert_eq!(sender.send(b"too early"), Sent::Full);
    let stop = AtomicBool::new(true);
    assert_eq!(sender.send_all(b"too early", &stop), Sent::Full);

    let mut client = TcpStream::connect(&name).unwrap();
    client.write_all(b"hello").unwrap();
    let mut received = BytesMut::new();
    // The receiver may be the half that accepts the peer.
    assert_eq!(soon(receiver.recv(&mut received)).await.unwrap(), 5);
    soon(link.peer()).await.unwrap();
    assert!(TcpStream::connect(&name).is_err());
    assert_eq!(sender.send(b"packet"), Sent::Done);
    drop((sender, receiver));
    soon(link.close()).await;
    let mut all = Vec::new();
    client.read_to_end(&mut all).unwrap();
    assert_eq!(all, b"packet");
}

#[tokio::test]
async fn a_place_that_cannot_be_reached_or_listened_on_is_named() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let place = listener.local_addr().unwrap();
    let text = refusal(&format!("tcpin:{place}")).await;
    assert!(text.contains("another program uses that port"), "{text}");
    assert!(text.contains(&place.to_string()), "{text}");
    drop(listener);
    let text = refusal(&format!("tcpout:{place}")).await;
    assert!(text.contains("nothing listens there"), "{text}");
    assert!(text.contains(&format!("`tcpout:{place}`")), "{text}");
    let text = refusal("udpin:192.0.2.1:5000").await;
    assert!(text.contains("no such address"), "{text}");
}

#[tokio::test]
async fn a_file_holds_every_packet_in_order() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("packets.bin");
    std::fs::write(&path, vec![9; 5_000_000]).unwrap();
    let spelled = format!("file:{}", path.display());
    let sent = pattern(1 << 20);
    let mut link = open(&spelled).await;
    assert_eq!(Path::new(link.name()), path);
    assert!(link.receiver().is_none());
    soon(link.peer()).await.unwrap();
    let mut sender = link.sender();
    for packet in sent.chunks(77) {
        assert_eq!(sender.send(packet), Sent::Done);
    }
    sender.finish().unwrap();
    assert_eq!(sender.kept(), 0);
    assert!(std::fs::read(&path).unwrap() == sent);
    drop(sender);
    soon(link.close()).await;
    let text = refusal("file:/nowhere/at/all").await;
    assert!(text.contains("/nowhere/at/all"), "{text}");
}

#[tokio::test]
async fn a_disk_that_takes_nothing_is_gone() {
    let mut link = open("file:/dev/full").await;
    let mut sender = link.sender();
    let stop = AtomicBool::new(false);
    let sent = sender.send_all(&pattern(1 << 20), &stop);
    assert_eq!(sent, Sent::Gone(io::ErrorKind::StorageFull));
}

#[tokio::test]
async fn memory_keeps_the_rules_of_every_link() {
    let (mut link, mut far) = memory(1000);
    soon(link.peer()).await.unwrap();
    let mut sender = link.sender();
    let mut receiver = link.receiver().unwrap();
    let sent = pattern(100_000);
    let packets = sent.clone();
    let writer = thread::spawn(move || {
        let stop = AtomicBool::new(false);
        for packet in packets.chunks(77) {
            assert_eq!(sender.send_all(packet, &stop), Sent::Done);
        }
        sender.finish().unwrap();
        sender
    });
    let mut received = Vec::new();
    while received.len() < sent.len() {
        received.extend(far.take());
        thread::yield_now();
    }
    assert!(received == sent);
    let mut sender = writer.join().unwrap();
    far.stall(true);
    assert_eq!(sender.send(b"packet"), Sent::Full);
    far.stall(false);
    assert_eq!(sender.send(b"packet"), Sent::Done);
    far.answer(b"answer");
    far.leave();
    let mut answers = BytesMut::new();
    assert_eq!(soon(receiver.recv(&mut answers)).await.unwrap(), 6);
    assert_eq!(soon(receiver.recv(&mut answers)).await.unwrap(), 0);
    assert!(matches!(sender.send(b"packet"), Sent::Gone(_)));
    assert_eq!(far.take(), b"packet");
}

#[tokio::test]
async fn a_stopped_sender_leaves_no_packet_cut() {
    let mut link = open("pty").await;
    let mut reader = slave(link.name());
    let mut sender = link.sender();
    let stop = std::sync::Arc::new(AtomicBool::new(false));
    let told = std::sync::Arc::clone(&stop);
    let writer = thread::spawn(move || {
        let mut taken = 0_usize;
        while sender.send_all(&[1; 333], &told) == Sent::Done {
            taken += 1;
        }
        (sender, taken)
    });
    // It fills up, and waits until told to stop.
    thread::sleep(Duration::from_millis(100));
    stop.store(true, Ordering::Relaxed);
    let (mut sender, taken) = writer.join().unwrap();
    let count = taken * 333;
    let reading = thread::spawn(move || {
        let mut received = vec![0; count];
        reader.read_exact(&mut received).map(|()| (received, reader))
    });
    sender.finish().unwrap();
    let (received, reader) = reading.join().unwrap().unwrap();
    assert_eq!(received.len(), count);
    assert_eq!(crate::os::unread(&reader).unwrap(), 0);
}

#[tokio::test]
async fn a_busy_port_names_who_holds_it() {
    let (_master, path) = port();
    let spelled = format!("serial:{path}");
    let first = open(&spelled).await;
    assert_eq!(first.name(), path);
    assert!(first.notices().is_empty(), "{:?}", first.notices());
    let text = refusal(&spelled).await;
    assert!(text.contains("busy"), "{text}");
    assert!(text.contains(&format!("this program (process {})", std::process::id())), "{text}");
    drop(first);

    // A dropped receiver does not release the port.
    let mut first = open(&spelled).await;
    drop(first.receiver());
    let text = refusal(&spelled).await;
    assert!(text.contains("busy"), "{text}");
    drop(first);
    drop(open(&spelled).await);

    // `flock` holds its lock while its command runs.
    let mut holder = Command::new("flock")
        .args(["--nonblock", &path, "sh", "-c", "echo locked; exec cat"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut locked = [0; 7];
    let said = holder.stdout.as_mut().unwrap().read_exact(&mut locked);
    said.unwrap();
    let text = refusal(&spelled).await;
    let pid = holder.id();
    drop(holder.stdin.take());
    holder.wait().unwrap();
    assert!(text.contains(&format!("flock (process {pid})")), "{text}");
}

#[tokio::test]
async fn a_serial_port_runs_at_any_speed_and_passes_every_byte() {
    for baud in [50, 9600, 57_600, 921_600, 1_234_567, 20_000_000] {
        let (master, path) = port();
        let mut link = open(&format!("serial:{path},{baud}")).await;
        assert!(link.notices().is_empty(), "{:?}", link.notices());
        let modes = rustix::termios::tcgetattr(&master).unwrap();
        assert_eq!((modes.input_speed(), modes.output_speed()), (baud, baud));
        let every: Vec<u8> = (0..=255).collect();
        let mut sender = link.sender();
        assert_eq!(sender.send(&every), Sent::Done);
        let mut device = File::from(master);
        let mut received = vec![0; 256];
        device.read_exact(&mut received).unwrap();
        assert_eq!(received, every);
        device.write_all(&every).unwrap();
        let mut receiver = link.receiver().unwrap();
        let mut answers = BytesMut::new();
        while answers.len() < 256 {
            soon(receiver.recv(&mut answers)).await.unwrap();
        }
        assert_eq!(answers, every);
    }
}

#[tokio::test]
async fn a_reader_that_has_left_is_told_from_one_that_has_not_come() {
    let mut link = open("pty").await;
    assert!(!link.peer_has_left());
    let reader = slave(link.name());
    soon(link.peer()).await.unwrap();
    assert!(!link.peer_has_left());
    drop(reader);
    left(&link).await;
    assert!(link.peer_has_left());
    let _another = slave(link.name());
    soon(link.peer()).await.unwrap();
    assert!(!link.peer_has_left());
}

#[test]
#[should_panic(expected = "a link has one sender")]
fn a_second_sender_is_refused() {
    let (mut link, _far) = memory(10);
    let _first = link.sender();
    let _second = link.sender();
}

#[test]
fn a_sender_goes_to_another_thread() {
    fn is_send<T: Send>() {}
    is_send::<Sender>();
    is_send::<Receiver>();
    is_send::<Link>();
}
