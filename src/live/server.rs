//! Lets viewers in and talks with each, on the one thread that shows things.

use super::door::{Answer, BAD, Door, FULL, HEAD, Request, reply};
use super::hub::Hub;
use super::page::PAGE;
use super::viewer::Viewer;
use futures_util::{SinkExt, StreamExt};
use std::rc::Rc;
use std::time::Duration;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::task::spawn_local;
use tokio::time::{sleep, timeout};
use tokio_tungstenite::WebSocketStream;
use tokio_tungstenite::tungstenite::protocol::{Role, WebSocketConfig};

/// Connections at once.
const VIEWERS: usize = 64;
/// Whoever takes longer to say what it wants is let go.
const PATIENCE: Duration = Duration::from_secs(5);
/// A message of a viewer has at most so many bytes.
const MESSAGE: usize = 64 << 10;
/// After a connection that could not be taken.
const PAUSE: Duration = Duration::from_millis(100);

/// Lets viewers in for ever.
pub(super) async fn serve(listener: TcpListener, door: Rc<Door>, hub: Rc<Hub>) {
    let places = std::sync::Arc::new(Semaphore::new(VIEWERS));
    loop {
        match (listener.accept().await, places.clone().try_acquire_owned()) {
            (Ok((stream, _)), Ok(place)) => {
                spawn_local(attend(stream, door.clone(), hub.clone(), place));
            }
            (Ok((stream, _)), Err(_)) => {
                let full =
                    Answer::Refusal(FULL, format!("{VIEWERS} connections are open, which is all there are"));
                // As much as the system takes at once: nobody waits for whoever is not let in.
                let _ = stream.try_write(reply(&full, "").as_bytes());
            }
            // Out of descriptors, say: the run goes on.
            (Err(_), _) => sleep(PAUSE).await,
        }
    }
}

/// One connection to its end.
async fn attend(mut stream: TcpStream, door: Rc<Door>, hub: Rc<Hub>, _place: OwnedSemaphorePermit) {
    let Ok(Some((answer, rest))) = timeout(PATIENCE, hear(&mut stream, &door)).await else { return };
    let Answer::Socket(protocol, _) = answer else {
        let sent = async {
            let _ = stream.write_all(reply(&answer, &PAGE).as_bytes()).await;
            let _ = stream.shutdown().await;
            // What is still unread would end the connection before the answer arrives.
            let mut unread = [0; 1024];
            while stream.read(&mut unread).await.is_ok_and(|count| count > 0) {}
        };
        let _ = timeout(PATIENCE, sent).await;
        return;
    };
    if stream.write_all(reply(&answer, "").as_bytes()).await.is_err() {
        return;
    }
    let config = WebSocketConfig::default()
        .max_message_size(Some(MESSAGE))
        .max_frame_size(Some(MESSAGE))
        .write_buffer_size(0);
    let socket = WebSocketStream::from_partially_read(stream, rest, Role::Server, Some(config)).await;
    let viewer = if protocol == super::door::PAGE { hub.page() } else { hub.foxglove() };
    talk(socket, &hub, &viewer).await;
    hub.remove(&viewer);
}

/// The head of a request: what it gets, and the bytes after it.
async fn hear(stream: &mut TcpStream, door: &Door) -> Option<(Answer, Vec<u8>)> {
    let mut bytes = Vec::with_capacity(HEAD);
    let mut buffer = [0; 1024];
    loop {
        let count = stream.read(&mut buffer).await.ok().filter(|count| *count > 0)?;
        bytes.extend_from_slice(&buffer[..count]);
        match Request::read(&bytes) {
            Ok(Some((request, length))) => return Some((door.answer(&request), bytes.split_off(length))),
            Ok(None) => {}
            Err(why) => return Some((Answer::Refusal(BAD, why), Vec::new())),
        }
    }
}

/// Sends what waits for a viewer and hears what it says, until it leaves or nothing more comes.
async fn talk(mut socket: WebSocketStream<TcpStream>, hub: &Hub, viewer: &Viewer) {
    loop {
        tokio::select! {
            biased;
            said = socket.next() => match said {
                Some(Ok(message)) => hub.hear(viewer, &message),
                // It has left, or said what cannot be read.
                Some(Err(_)) | None => return,
            },
            next = viewer.next() => {
                let sent = match next {
                    Some(message) => socket.send(message).await,
                    None => {
                        let _ = timeout(PATIENCE, socket.close(None)).await;
                        return;
                    }
                };
                if sent.is_err() {
                    return;
                }
            }
        }
    }
}
