//! A scene played into a link, and somebody on its other end.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::thread;
use std::time::Duration;

use ratetable::player::Player;
use ratetable::scene::{Destination, Output, Plan};
use ratetable::sensor::Reading;
use ratetable::session::{self, Event, Job, Outcome, Speed};
use ratetable::time::SimTime;
use ratetable_firmware_host_tests::board::{Arrival, Device, Port};
use ratetable_firmware_host_tests::{Board, Options, Protocol};

/// A built-in scene with some of its keys set.
pub fn scene(name: &str, sets: &[&str]) -> Arc<Plan> {
    let sets: Vec<String> = sets.iter().map(|&set| set.to_owned()).collect();
    Arc::new(Plan::load(name, &sets).unwrap_or_else(|error| panic!("{error}")))
}

/// Plays the whole scene into `to`; `other_side` runs in a thread of its own with what one connects to, as soon as
/// that is there. `on` hears of what happens meanwhile.
pub fn play_and_tell<T: Send + 'static>(
    plan: &Arc<Plan>,
    to: &str,
    speed: Speed,
    other_side: impl FnOnce(&str) -> T + Send + 'static,
    on: impl FnMut(&Event<'_>),
) -> (Outcome, T) {
    play_after(None, plan, to, speed, other_side, on)
}

/// [`play_and_tell`] after a rest, for who has to settle first.
pub fn play_after<T: Send + 'static>(
    rest: Option<SimTime>,
    plan: &Arc<Plan>,
    to: &str,
    speed: Speed,
    other_side: impl FnOnce(&str) -> T + Send + 'static,
    mut on: impl FnMut(&Event<'_>),
) -> (Outcome, T) {
    let mut to: Destination = to.parse().expect("a destination");
    if to.overheard().is_some() {
        // No stand-in tells its attitude beside its link.
        to.answers = None;
    }
    let outputs = vec![Output::to(to)];
    let job = Job { rest, speed, wait: Duration::from_secs(30), ..Job::new(plan.clone(), outputs) };
    let (mut waiting, mut running) = (Some(other_side), None);
    let outcome = session::run(job, &mut |event| {
        if let Event::Ready(name) = &event
            && let Some(other_side) = waiting.take()
        {
            let place = name.split_once('@').expect("PROTOCOL@LINK").1.to_owned();
            running = Some(thread::spawn(move || other_side(&place)));
        }
        on(&event);
    });
    let other_side = running.expect("the link was ready").join();
    (outcome.expect("a run"), other_side.expect("the other side ends well"))
}

/// [`play_and_tell`] with nobody to tell.
pub fn play<T: Send + 'static>(
    plan: &Arc<Plan>,
    to: &str,
    speed: Speed,
    other_side: impl FnOnce(&str) -> T + Send + 'static,
) -> (Outcome, T) {
    play_and_tell(plan, to, speed, other_side, |_| {})
}

/// Plays the whole scene into a pty, as fast as a board reads that opens it by its path.
pub fn play_to_board(plan: &Arc<Plan>, protocol: Protocol, options: Options) -> (Outcome, Board) {
    play(plan, &format!("{protocol}@pty"), Speed::Max, move |path| {
        let mut board = Board::open(path, protocol, Options { quiet: None, ..options }).expect("a board");
        board.run(&AtomicBool::new(false)).expect("a link");
        board
    })
}

/// Every byte that the whole scene puts on a pty, and what the emulator says of them.
pub fn stream(plan: &Arc<Plan>, protocol: Protocol) -> (Outcome, Vec<u8>) {
    play(plan, &format!("{protocol}@pty"), Speed::Max, read_to_end)
}

/// Reads a port until the other side closes it.
fn read_to_end(path: &str) -> Vec<u8> {
    let mut port = Device::open(Path::new(path), None).expect("a port");
    let (mut all, mut part) = (Vec::new(), [0; 4096]);
    loop {
        match port.read(&mut part, Duration::from_secs(1)).expect("a link") {
            Arrival::Bytes(count) => all.extend_from_slice(&part[..count]),
            Arrival::Idle => {}
            Arrival::Closed => return all,
        }
    }
}

/// What a dataset of the scene holds: its readings in order of time.
pub fn readings(plan: &Plan) -> Vec<(SimTime, Vec<Reading>)> {
    let mut all = Vec::new();
    let mut player = Player::new(plan, plan.duration, 1000);
    let played = player.play(|moment| {
        all.push((moment.t, moment.readings.to_vec()));
        Ok::<(), std::convert::Infallible>(())
    });
    played.expect("nothing stops it");
    all
}
