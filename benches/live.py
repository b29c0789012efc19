"""What looking on costs: timing with the page shut and open in turns, and memory over minutes with three viewers.

Usage: python3 benches/live.py [RATETABLE] [PAIRS] [MINUTES]
Needs Python alone. Two viewers read, one does not; one of those who read speaks Foxglove's protocol. Run it on a quiet
machine, with the program built for release.
"""

import json
import re
import statistics
import subprocess
import sys
import threading
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests/live"))
from hostile import handshake, masked, memory  # noqa: E402

SECONDS = 10


def start(command):
    run = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    at = None
    for line in run.stderr:
        if found := re.match(r"live: http://([^/]+)/", line):
            at = found[1]
        # Without a page this is the first line.
        if at or line.startswith("ready"):
            break
    threading.Thread(target=run.stderr.read, daemon=True).start()
    return run, at


def reads(viewer, counts):
    """Reads until the other end closes, as a viewer that keeps up."""
    try:
        while piece := viewer.recv(1 << 16):
            counts.append(len(piece))
    except OSError:
        pass


def look_on(at):
    """Two that read and one that does not; what the first two got."""
    counts = []
    page, viewer = handshake(at), handshake(at, protocol="foxglove.sdk.v1")
    wish = {"op": "subscribe", "subscriptions": [{"id": id, "channelId": id} for id in range(1, 11)]}
    viewer.sendall(masked(1, json.dumps(wish).encode()))
    for it in (page, viewer):
        threading.Thread(target=reads, args=(it, counts), daemon=True).start()
    return counts, [page, viewer, handshake(at)]


def timed(ratetable, is_open):
    run, at = start([ratetable, "timing", "--for", f"{SECONDS}s", "--json", *(["--live=0"] if is_open else [])])
    counts, viewers = look_on(at) if is_open else ([], [])
    report = json.loads(run.stdout.read())
    run.wait()
    assert not is_open or sum(counts) > 100_000, sum(counts)
    return report["ratio_p99"], report["sensors"][0]["late_us"]["p99"], sum(counts)


def compare(ratetable, pairs):
    print("| page | p99 of the gyro (µs) | over a bare timer's |\n|---|---|---|")
    ratios = {False: [], True: []}
    for _ in range(pairs):
        for is_open in (False, True):
            ratio, late, _ = timed(ratetable, is_open)
            ratios[is_open].append(ratio)
            print(f"| {'open' if is_open else 'shut'} | {late:.1f} | {ratio:.2f} |", flush=True)
    shut, opened = (statistics.median(ratios[it]) for it in (False, True))
    print(f"median over a bare timer's: shut {shut:.2f}, open {opened:.2f}\n")


def main(ratetable="target/release/ratetable", pairs="5", minutes="10"):
    if int(pairs) > 0:
        compare(ratetable, int(pairs))
    seconds = int(float(minutes) * 60)
    run, at = start([ratetable, "run", "full-mpu9250", "--to", "mpu@file:/dev/null", "--for", f"{seconds}s", "--live=0"])
    _, viewers = look_on(at)
    print("| s | memory (MB) |\n|---|---|")
    begun = time.monotonic()
    while run.poll() is None:
        print(f"| {time.monotonic() - begun:.0f} | {memory(run)} |", flush=True)
        try:
            run.wait(seconds / 10)
        except subprocess.TimeoutExpired:
            pass


if __name__ == "__main__":
    main(*sys.argv[1:])
