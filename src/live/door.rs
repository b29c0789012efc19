//! Who is let in: a request's head, and what it gets. No sockets here.

use super::foxglove;
use std::net::SocketAddr;
use tokio_tungstenite::tungstenite::handshake::derive_accept_key;

/// What the page's own socket speaks.
pub(super) const PAGE: &str = "ratetable.v1";
/// The bytes of a head, at most.
pub(super) const HEAD: usize = 8192;
/// The lines of a head, at most.
const LINES: usize = 64;
/// Pages elsewhere that may connect: viewers that are themselves served from there, and those that are installed.
const VIEWERS: [&str; 2] = ["https://app.foxglove.dev", "file://"];
/// What a page may do here: draw what stands in it, and talk with where it came from.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; \
                      connect-src 'self' ws: wss:; img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// The head of a request, as far as it matters.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Request {
    method: String,
    path: String,
    token: Option<String>,
    host: Option<String>,
    origin: Option<String>,
    /// The key of a handshake.
    key: Option<String>,
    is_upgrade: bool,
    version: Option<String>,
    protocols: Vec<String>,
}

/// What a request gets.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Answer {
    /// The page.
    Page,
    /// The page's head alone.
    Head,
    /// A socket that speaks this protocol; the accepted key.
    Socket(&'static str, String),
    /// A refusal: status, and why.
    Refusal(Status, String),
}

/// The status of a refusal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Status(pub u16, pub &'static str);

pub(super) const BAD: Status = Status(400, "Bad Request");
const FORBIDDEN: Status = Status(403, "Forbidden");
const NOT_FOUND: Status = Status(404, "Not Found");
const METHOD: Status = Status(405, "Method Not Allowed");
const UPGRADE: Status = Status(426, "Upgrade Required");
pub(super) const FULL: Status = Status(503, "Service Unavailable");

impl Request {
    /// Reads a head: `None` where it is not whole yet; with it how many bytes it takes.
    ///
    /// # Errors
    /// What is wrong with it.
    pub(super) fn read(bytes: &[u8]) -> Result<Option<(Request, usize)>, String> {
        let mut lines = [httparse::EMPTY_HEADER; LINES];
        let mut parsed = httparse::Request::new(&mut lines);
        let length = match parsed.parse(bytes) {
            Ok(httparse::Status::Complete(length)) => length,
            Ok(httparse::Status::Partial) if bytes.len() >= HEAD => {
                return Err(format!("a request's head has at most {HEAD} bytes"));
            }
            Ok(httparse::Status::Partial) => return Ok(None),
            Err(error) => return Err(format!("this is no HTTP request: {error}")),
        };
        let target = parsed.path.unwrap_or_default();
        let (path, query) = target.split_once('?').unwrap_or((target, ""));
        let token = query.split('&').find_map(|pair| pair.strip_prefix("token="));
        let mut request = Request {
            method: parsed.method.unwrap_or_default().into(),
            path: path.into(),
            token: token.map(str::to_string),
            ..Request::default()
        };
        for line in parsed.headers.iter() {
            let value = String::from_utf8_lossy(line.value).trim().to_string();
            match line.name.to_ascii_lowercase().as_str() {
                "host" => request.host = Some(value),
                "origin" => request.origin = Some(value),
                "upgrade" => request.is_upgrade = value.eq_ignore_ascii_case("websocket"),
                "sec-websocket-key" => request.key = Some(value),
                "sec-websocket-version" => request.version = Some(value),
                "sec-websocket-protocol" => {
                    request.protocols.extend(value.split(',').map(|it| it.trim().to_string()));
                }
                _ => {}
            }
        }
        Ok(Some((request, length)))
    }
}

/// Who is let in.
#[derive(Clone, Debug)]
pub(super) struct Door {
    /// Where it is.
    pub at: SocketAddr,
    /// What a request must have, unless only this machine reaches it.
    pub token: Option<String>,
}

impl Door {
    /// What a request gets.
    pub(super) fn answer(&self, request: &Request) -> Answer {
        let refusal = |status, why: &str| Answer::Refusal(status, why.into());
        // A page elsewhere may have its own name point here: it is known by that name.
        if !self.is_mine(request.host.as_deref()) {
            return refusal(FORBIDDEN, "the Host is not this server's: open the address that it prints");
        }
        if !self.has_token(request.token.as_deref()) {
            return refusal(
                FORBIDDEN,
                "the token is missing or wrong: open the whole address that it prints",
            );
        }
        if !matches!(request.method.as_str(), "GET" | "HEAD") {
            return refusal(METHOD, "only GET is answered here");
        }
        if !matches!(request.path.as_str(), "/" | "/live") {
            return refusal(NOT_FOUND, "there is only the page `/`");
        }
        if request.is_upgrade {
            return self.socket(request);
        }
        match (request.path.as_str(), request.method.as_str()) {
            ("/live", _) => refusal(UPGRADE, "a WebSocket is served here"),
            (_, "HEAD") => Answer::Head,
            _ => Answer::Page,
        }
    }

    fn socket(&self, request: &Request) -> Answer {
        let refusal = |status, why: String| Answer::Refusal(status, why);
        if let Some(origin) = request.origin.as_deref().filter(|origin| !is_welcome(origin, request)) {
            return refusal(FORBIDDEN, format!("pages of {origin:?} may not connect"));
        }
        let Some(key) = request.key.as_ref().filter(|_| request.version.as_deref() == Some("13")) else {
            return refusal(BAD, "a WebSocket of version 13 is served here, and its key is needed".into());
        };
        let spoken = std::iter::once(PAGE).chain(foxglove::SUBPROTOCOLS);
        let mut spoken = spoken.filter(|protocol| request.protocols.iter().any(|it| it == protocol));
        match spoken.next() {
            Some(protocol) => Answer::Socket(protocol, derive_accept_key(key.as_bytes())),
            None => refusal(
                BAD,
                format!("the subprotocols spoken here are {}, {PAGE}", foxglove::SUBPROTOCOLS.join(", ")),
            ),
        }
    }

    /// Whether a request for this host is meant for this server. Behind a token any name will do.
    fn is_mine(&self, host: Option<&str>) -> bool {
        let Some(host) = host.filter(|host| !host.is_empty()) else { return false };
        let (name, port) = split(host);
        let is_here = matches!(name, "localhost" | "127.0.0.1" | "[::1]") || name == ip(self.at);
        self.token.is_some() || (is_here && port.unwrap_or("80") == self.at.port().to_string())
    }

    fn has_token(&self, token: Option<&str>) -> bool {
        let Some(own) = &self.token else { return true };
        let token = token.unwrap_or_default();
        // As long for a wrong one as for a right one.
        let differ = own.bytes().zip(token.bytes()).fold(0, |differ, (a, b)| differ | (a ^ b));
        own.len() == token.len() && differ == 0
    }
}

fn ip(at: SocketAddr) -> String {
    if at.is_ipv6() { format!("[{}]", at.ip()) } else { at.ip().to_string() }
}

/// A host's name and its port.
fn split(host: &str) -> (&str, Option<&str>) {
    match host.rsplit_once(':') {
        Some((name, port)) if !port.contains(']') => (name, Some(port)),
        _ => (host, None),
    }
}

/// Whether a page of this origin may connect: our own, one on this machine, a viewer.
fn is_welcome(origin: &str, request: &Request) -> bool {
    if VIEWERS.contains(&origin) {
        return true;
    }
    let Some((_, host)) = origin.split_once("://").filter(|(scheme, _)| matches!(*scheme, "http" | "https"))
    else {
        return false;
    };
    let is_own = request.host.as_deref() == Some(host);
    is_own || matches!(split(host).0, "localhost" | "127.0.0.1" | "[::1]")
}

/// The bytes of an answer's head, and of its body: `page` where that is asked for.
pub(super) fn reply(answer: &Answer, page: &str) -> String {
    let head = |status: Status, kind: &str, length: usize| {
        format!(
            "HTTP/1.1 {} {}\r\nContent-Type: {kind}; charset=utf-8\r\nContent-Length: {length}\r\n\
             Content-Security-Policy: {POLICY}\r\nX-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\n\
             Cross-Origin-Resource-Policy: same-origin\r\nCache-Control: no-store\r\nConnection: close\r\n\r\n",
            status.0, status.1
        )
    };
    let found = Status(200, "OK");
    match answer {
        Answer::Page => head(found, "text/html", page.len()) + page,
        Answer::Head => head(found, "text/html", page.len()),
        Answer::Refusal(status, why) => head(*status, "text/plain", why.len() + 1) + why + "\n",
        Answer::Socket(protocol, key) => format!(
            "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
             Sec-WebSocket-Accept: {key}\r\nSec-WebSocket-Protocol: {protocol}\r\n\r\n"
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn door(token: Option<&str>) -> Door {
        Door { at: "127.0.0.1:8420".parse().unwrap(), token: token.map(str::to_string) }
    }

    /// What a request of these lines gets.
    fn asked(door: &Door, first: &str, lines: &[&str]) -> Answer {
        let text = [&[first], lines, &["", ""]].concat().join("\r\n");
        let (request, length) = Request::read(text.as_bytes()).unwrap().unwrap();
        assert_eq!(length, text.len());
        door.answer(&request)
    }

    fn refused(answer: &Answer, by: u16) -> bool {
        matches!(answer, Answer::Refusal(status, why) if status.0 == by && !why.is_empty())
    }

    const GET: &str = "GET / HTTP/1.1";
    const SOCKET: [&str; 5] = [
        "Host: localhost:8420",
        "Upgrade: websocket",
        "Connection: Upgrade",
        // RFC 6455, 1.3.
        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==",
        "Sec-WebSocket-Version: 13",
    ];

    #[test]
    fn the_page_is_for_whoever_comes_by_its_own_address() {
        let door = door(None);
        for host in ["127.0.0.1:8420", "localhost:8420", "[::1]:8420"] {
            assert_eq!(asked(&door, GET, &[&format!("Host: {host}")]), Answer::Page);
        }
        for host in
            ["evil.example:8420", "127.0.0.1", "127.0.0.1:8421", "localhost.evil.example:8420", "", "[::1"]
        {
            assert!(refused(&asked(&door, GET, &[&format!("Host: {host}")]), 403), "{host}");
        }
        assert!(refused(&asked(&door, GET, &[]), 403), "a host is needed");
        let here = ["Host: localhost:8420"];
        assert_eq!(asked(&door, "HEAD / HTTP/1.1", &here), Answer::Head);
        assert!(refused(&asked(&door, "POST / HTTP/1.1", &here), 405));
        assert!(refused(&asked(&door, "GET /live HTTP/1.1", &here), 426));
        for path in ["/../../etc/passwd", "/etc/passwd", "//", "/live/", "/%2e%2e/", "http://elsewhere/"] {
            assert!(refused(&asked(&door, &format!("GET {path} HTTP/1.1"), &here), 404), "{path}");
        }
    }

    #[test]
    fn elsewhere_a_token_is_the_key() {
        let door = door(Some("abc123"));
        assert_eq!(asked(&door, "GET /?token=abc123 HTTP/1.1", &["Host: bench.lan:8420"]), Answer::Page);
        for path in ["/", "/?token=", "/?token=abc124", "/?token=abc1234", "/?nottoken=abc123"] {
            let answer = asked(&door, &format!("GET {path} HTTP/1.1"), &["Host: bench.lan:8420"]);
            assert!(refused(&answer, 403), "{path}");
        }
    }

    #[test]
    fn a_socket_is_for_pages_and_viewers_that_may_connect() {
        let door = door(None);
        let asked = |lines: &[&str]| asked(&door, "GET /live HTTP/1.1", &[&SOCKET, lines].concat());
        let page = "Sec-WebSocket-Protocol: ratetable.v1";
        let Answer::Socket(protocol, key) = asked(&[page]) else { panic!("a viewer without an origin") };
        assert_eq!((protocol, key.as_str()), (PAGE, "s3pPLMBiTxaQ9kYGzzhZRbK+xOo="));
        for origin in
            ["http://localhost:8420", "http://localhost:8080", "https://app.foxglove.dev", "file://"]
        {
            assert!(matches!(asked(&[page, &format!("Origin: {origin}")]), Answer::Socket(..)), "{origin}");
        }
        for origin in
            ["http://evil.example", "null", "http://localhost.evil.example", "ftp://localhost:8420", ""]
        {
            assert!(refused(&asked(&[page, &format!("Origin: {origin}")]), 403), "{origin}");
        }
        let viewer = asked(&["Sec-WebSocket-Protocol: other, foxglove.websocket.v1"]);
        assert!(matches!(viewer, Answer::Socket("foxglove.websocket.v1", _)), "{viewer:?}");
        assert!(refused(&asked(&["Sec-WebSocket-Protocol: chat"]), 400));
        assert!(refused(&asked(&[]), 400), "what it speaks has to be said");
        let old = SOCKET.map(|line| line.replace("Version: 13", "Version: 8"));
        let old: Vec<_> = old.iter().map(String::as_str).chain([page]).collect();
        assert!(refused(&self::asked(&door, "GET /live HTTP/1.1", &old), 400));
    }

    #[test]
    fn a_head_that_does_not_end_is_refused_at_its_bound() {
        assert_eq!(Request::read(b"GET / HTTP/1.1\r\nHost: x\r\n"), Ok(None));
        let long = format!("GET / HTTP/1.1\r\nX: {}", "y".repeat(HEAD));
        assert!(Request::read(long.as_bytes()).unwrap_err().contains("8192"));
        assert!(Request::read(b"\x16\x03\x01\x02\x00\x01").unwrap_err().contains("no HTTP request"));
    }

    #[test]
    fn a_reply_says_its_length_and_gives_nothing_to_others() {
        let reply = reply(&Answer::Page, "<p>é");
        let (head, body) = reply.split_once("\r\n\r\n").unwrap();
        assert!(head.starts_with("HTTP/1.1 200 OK") && head.contains("Content-Length: 5"), "{head}");
        assert_eq!(body, "<p>é");
        assert!(head.contains("default-src 'none'") && !head.contains("Access-Control-Allow-Origin"));
    }

    proptest! {
        #[test]
        fn no_bytes_panic(bytes in proptest::collection::vec(any::<u8>(), 0..300), text in "[ -~\r\n]{0,300}") {
            for bytes in [bytes.as_slice(), text.as_bytes()] {
                if let Ok(Some((request, length))) = Request::read(bytes) {
                    prop_assert!(length <= bytes.len());
                    let _ = reply(&door(None).answer(&request), "");
                }
            }
        }
    }
}
