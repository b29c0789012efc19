"""A MAVLink client as people write them: connects with pymavlink, receives until the other side leaves, prints JSON.

    pymavlink_client.py CONNECTION [QUIET_SECONDS]

CONNECTION is pymavlink's: the path of a serial port or pty, tcp:HOST:PORT, udpout:HOST:PORT. It ends when the link
does, or after QUIET_SECONDS (default 3) without a message once the first has come.
"""

import json
import os
import sys
import time
from collections import Counter

os.environ["MAVLINK20"] = "1"

from pymavlink import mavutil  # noqa: E402  (the version of the protocol is chosen before)

FIRST_S = 30.0


def receive(link, quiet_s):
    """Yields messages until the link ends or falls quiet."""
    deadline = time.monotonic() + FIRST_S
    while time.monotonic() < deadline:
        try:
            message = link.recv_match(blocking=True, timeout=0.2)
        except OSError:  # what a pty, and pyserial over it, say when the other side has gone
            return
        if message is not None:
            deadline = time.monotonic() + quiet_s
            yield message


def rate_hz(times, unit_s):
    """Messages a second by their own times: (n - 1) / (last - first)."""
    return (len(times) - 1) / ((times[-1] - times[0]) * unit_s) if len(times) > 1 else None


def fields(message):
    """The fields of a message with its sequence number."""
    return {**message.to_dict(), "seq": message.get_seq()}


def main():
    connection = sys.argv[1]
    quiet_s = float(sys.argv[2]) if len(sys.argv) > 2 else 3.0
    link = mavutil.mavlink_connection(connection, baud=921600, dialect="common")
    if connection.startswith("udpout:"):
        link.mav.heartbeat_send(6, 8, 0, 0, 0)  # a datagram says where to answer
    types, masks, ends, gaps, bad, last, times = Counter(), Counter(), {}, 0, 0, None, []
    fresh = {"gyro": 0, "accel": 0, "mag": 0}
    for message in receive(link, quiet_s):
        kind = message.get_type()
        if kind == "BAD_DATA":
            bad += 1
            continue
        types[kind] += 1
        seq = message.get_seq()
        if last is not None:
            gaps += (seq - last - 1) % 256
        last = seq
        ends.setdefault(kind, [fields(message), None])[1] = fields(message)
        if kind == "HIL_SENSOR":
            masks[f"{message.fields_updated:#x}"] += 1
            times.append(message.time_usec)
            for sensor, mask in (("gyro", 0x38), ("accel", 0x7), ("mag", 0x1C0)):
                fresh[sensor] += message.fields_updated & mask == mask
    report = {
        "types": types,
        "bad_data": bad,
        "errors": link.mav.total_receive_errors,
        "lost": gaps,
        "version": link.WIRE_PROTOCOL_VERSION,
        "masks": masks,
        "fresh": fresh,
        "rate_hz": rate_hz(times, 1e-6),
        "in_order": times == sorted(times),
        "first": {kind: first for kind, (first, _) in ends.items()},
        "last": {kind: newest for kind, (_, newest) in ends.items()},
    }
    print(json.dumps(report))


if __name__ == "__main__":
    main()
