"""Whoever should not be there: junk, half a request, a thousand sockets, wrong hosts, origins, paths and tokens, and
viewers that do not read. Each is refused or bounded, and the run that they look at loses nothing.

Usage: hostile.py RATETABLE
Prints {"refused": [...], "lost": messages that a slow viewer was told it lost, ...}; a check that fails is an error.
"""

import json
import os
import re
import socket
import struct
import subprocess
import sys
import threading
import time

SECONDS = 14


def start(ratetable, at):
    """A run that is shown, with its report on standard output: the process, where, and all that it says."""
    # Nobody has to read: nothing but the page can make it lose a sample.
    to = ["--to", "mpu@file:/dev/null"]
    command = [ratetable, "run", "table-1", *to, "--for", f"{SECONDS}s", f"--live={at}", "--json"]
    run = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    for line in run.stderr:
        if found := re.match(r"live: http://([^/]+)/(\S*)", line):
            threading.Thread(target=run.stderr.read, daemon=True).start()
            return run, found[1], found[2]
    raise AssertionError(f"no address: {run.wait()}")


def connect(at):
    host, port = at.rsplit(":", 1)
    return socket.create_connection((host, int(port)), timeout=10)


def said(sent, at):
    """What a server says to some bytes before it closes."""
    with connect(at) as it:
        it.sendall(sent)
        answer = b""
        try:
            while piece := it.recv(65536):
                answer += piece
        except (ConnectionResetError, TimeoutError):
            pass
        return answer


def request(at, path="/", method="GET", **headers):
    lines = [f"{method} {path} HTTP/1.1", *(f"{name.replace('_', '-')}: {value}" for name, value in headers.items())]
    answer = said("\r\n".join([*lines, "", ""]).encode(), at)
    return int(answer.split(b" ", 2)[1]) if answer else None


def handshake(at, origin=None, protocol="ratetable.v1", path="/live"):
    """An open WebSocket, or the status of its refusal."""
    it = connect(at)
    origin = f"Origin: {origin}\r\n" if origin else ""
    it.sendall(f"GET {path} HTTP/1.1\r\nHost: {at}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n{origin}"
               f"Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n"
               f"Sec-WebSocket-Protocol: {protocol}\r\n\r\n".encode())
    head = b""
    while b"\r\n\r\n" not in head and (piece := it.recv(1)):
        head += piece
    status = int(head.split(b" ", 2)[1])
    return it if status == 101 else status


def masked(opcode, payload):
    mask = os.urandom(4)
    length = len(payload)
    size = bytes([0x80 | length]) if length < 126 else bytes([0x80 | 126]) + struct.pack("!H", length)
    return bytes([0x80 | opcode]) + size + mask + bytes(b ^ mask[i % 4] for i, b in enumerate(payload))


def memory(run):
    with open(f"/proc/{run.pid}/status") as status:
        return int(re.search(r"VmRSS:\s+(\d+)", status.read())[1]) // 1024


def refusals(at):
    refused = {}
    refused["host"] = [request(at, Host=host) for host in ("evil.example", "evil.example:8420", "127.0.0.1:1", "")]
    refused["no host"] = [request(at)]
    refused["origin"] = [handshake(at, origin=origin) for origin in ("http://evil.example", "null", "https://127.0.0.1.evil.example")]
    assert all(status == 403 for statuses in refused.values() for status in statuses), refused
    paths = ["/../../etc/passwd", "/..%2f..%2fetc/passwd", "/etc/passwd", "//etc/passwd", "/live/../../x", "/report.html"]
    refused["path"] = [request(at, path, Host=at) for path in paths]
    assert set(refused["path"]) == {404}, refused
    refused["method"] = [request(at, method=method, Host=at) for method in ("POST", "PUT", "DELETE", "OPTIONS")]
    assert set(refused["method"]) == {405}, refused
    refused["protocol"] = [handshake(at, protocol="chat")]
    assert refused["protocol"] == [400], refused
    junk = [os.urandom(3000), b"\x16\x03\x01\x02\x00\x01\x00", b"GET\r\n\r\n", b"GET / HTTP/9.9\r\n\r\n", b"\0" * 9000]
    refused["junk"] = [answer[9:12].decode() for answer in (said(bytes, at) for bytes in junk) if answer]
    assert set(refused["junk"]) <= {"400"}, refused
    refused["long"] = [request(at, "/" + "x" * 9000, Host=at)]
    assert refused["long"] == [400], refused
    assert request(at, Host=at) == 200, "and the page is there for whoever may have it"
    return sorted(refused)


def floods(at, run):
    """A thousand sockets, most of them refused at once, none of them asking; then room again."""
    before, open_ones, turned_away = memory(run), [], 0
    for _ in range(1000):
        try:
            it = connect(at)
            it.settimeout(0.01)
            open_ones.append(it)
        except OSError:
            turned_away += 1
    for it in open_ones:
        try:
            turned_away += it.recv(100).startswith(b"HTTP/1.1 503")
        except (TimeoutError, ConnectionResetError):
            pass
    assert turned_away > 800, turned_away
    for it in open_ones:
        it.close()
    deadline = time.monotonic() + 8
    while request(at, Host=at) != 200:
        assert time.monotonic() < deadline, "no room after a flood"
        time.sleep(0.1)
    assert memory(run) - before < 50, (before, memory(run))
    return turned_away


def noises(at):
    """Sockets that are let in and then talk nonsense: each loses itself alone."""
    for payload in (os.urandom(500), masked(2, b"\x01" * 100), masked(1, b"{"), masked(1, b'{"op":"subscribe"}'),
                    masked(9, b"ping"), masked(8, b""), masked(3, b"?"), b"\x81\xff" + b"\xff" * 8):
        for protocol in ("ratetable.v1", "foxglove.websocket.v1"):
            with handshake(at, protocol=protocol) as it:
                it.sendall(payload)
                it.settimeout(0.05)
                try:
                    it.recv(1000)
                except (TimeoutError, ConnectionResetError):
                    pass


def main(ratetable):
    run, at, _ = start(ratetable, "127.0.0.1:0")
    # Two that never read, with as little room in the system as there can be.
    slow = [handshake(at, protocol=protocol) for protocol in ("ratetable.v1", "foxglove.sdk.v1")]
    wish = {"op": "subscribe", "subscriptions": [{"id": id, "channelId": id} for id in range(1, 11)]}
    slow[1].sendall(masked(1, json.dumps(wish).encode()))
    refused = refusals(at)
    turned_away = floods(at, run)
    noises(at)
    report = json.loads(run.stdout.read())
    assert run.wait() == 0, report
    made = [(sensor["made"], sensor["sent"], sensor["dropped"]) for sensor in report["sensors"]]
    assert made == [(SECONDS * 1000, SECONDS * 1000, 0)] * 2 + [(SECONDS * 100, SECONDS * 100, 0)], made
    for it in slow:
        it.close()
    # Elsewhere than on loopback a token is the key.
    run, at, query = start(ratetable, "0.0.0.0:0")
    at = at.replace("0.0.0.0", "127.0.0.1")
    token = re.match(r"\?token=([0-9a-f]{32})$", query)[1]
    wrong = ["/", "/?token=", "/?token=" + token[:-1], "/?token=" + "0" * 32]
    assert [request(at, path, Host="bench.lan") for path in wrong] == [403] * 4
    assert handshake(at) == 403
    assert request(at, f"/?token={token}", Host="bench.lan") == 200
    with handshake(at, path=f"/live?token={token}"):
        pass
    run.terminate()
    run.wait()
    print(json.dumps({"refused": refused, "turned away": turned_away}))


if __name__ == "__main__":
    main(*sys.argv[1:])
