"""A viewer of another make: follows a run over Foxglove's protocol, decodes every channel by the schema that the server
gave, and compares what it got with the dataset of the same run.

Usage: viewer.py RATETABLE FOLDER SUBPROTOCOL
Prints {"channels": {topic: messages}, "compared": numbers that agree, "wrong": ["where: what", ...]}.
"""

import asyncio
import json
import re
import struct
import subprocess
import sys
from pathlib import Path

import websockets
from mcap_ros2._dynamic import generate_dynamic

MESSAGE_DATA, TIME = 1, 2  # the first byte of what comes
FAST = 300  # samples a second of the scene's fastest sensor


def csv(path):
    """Rows by their time, ns."""
    header, *rows = (line.split(",") for line in path.read_text().splitlines())
    return {int(row[0]): dict(zip(header, map(float, row))) for row in rows}


class Judge:
    def __init__(self):
        self.compared, self.wrong = 0, []

    def same(self, where, got, expected, within=0.0):
        if abs(got - expected) <= within:
            self.compared += 1
        else:
            self.wrong.append(f"{where}: {got!r} for {expected!r}")


def vector(v):
    return [v.x, v.y, v.z]


def quaternion(q):
    return [q.w, q.x, q.y, q.z]


async def follow(url, subprotocol, wanted):
    """Everything that comes, by topic: the time and the decoded message."""
    got = {}
    async with websockets.connect(url, subprotocols=[subprotocol], max_size=None) as socket:
        assert socket.subprotocol == subprotocol, socket.subprotocol
        info = json.loads(await socket.recv())
        assert info["op"] == "serverInfo" and info["sessionId"] and info["capabilities"] == ["time"], info
        offered = json.loads(await socket.recv())
        assert offered["op"] == "advertise", offered
        channels = {}
        for channel in offered["channels"]:
            assert (channel["encoding"], channel["schemaEncoding"]) == ("cdr", "ros2msg"), channel
            decoders = generate_dynamic(channel["schemaName"], channel["schema"])
            channels[channel["id"]] = (channel["topic"], decoders[channel["schemaName"]])
            got[channel["topic"]] = []
        wishes = [{"id": 1000 + id, "channelId": id} for id, (topic, _) in channels.items() if wanted(topic)]
        await socket.send(json.dumps({"op": "subscribe", "subscriptions": wishes}))
        # What is not served is answered in words, and changes nothing.
        await socket.send(json.dumps({"op": "getParameters", "parameterNames": []}))
        statuses, clock = 0, -1
        try:
            async for message in socket:
                if isinstance(message, str):
                    assert json.loads(message)["op"] == "status", message
                    statuses += 1
                    continue
                if message[0] == TIME:
                    (t,) = struct.unpack("<Q", message[1:])
                    assert t > clock, (t, clock)
                    clock = t
                    continue
                opcode, subscription, t = struct.unpack_from("<BIQ", message)
                assert opcode == MESSAGE_DATA, opcode
                topic, decode = channels[subscription - 1000]
                # A viewer draws a message where its clock stands. Only a firmware's answer is about another time.
                assert t == clock or topic in ["/estimate/pose", "/tf"], (topic, t, clock)
                got[topic].append((t, decode(message[13:])))
        except websockets.ConnectionClosed:
            pass
        assert statuses == 1, statuses
    return got


def triads(judge, topic, messages, rows, names, read, scale=1.0):
    for t, message in messages:
        for name, value in zip(names, read(message)):
            judge.same(f"{topic} at {t}: {name}", value, rows[t][name] * scale, within=abs(value) * 1e-15)


def compare(got, folder):
    judge = Judge()
    gyro, accel, mag, truth = (csv(folder / f"{name}.csv") for name in ["gyro", "accel", "mag", "truth"])
    rate, force, field = ([f"{axis}_{unit}" for axis in "xyz"] for unit in ["rad_s", "m_s2", "ut"])
    both = got["/imu/data_raw"]
    triads(judge, "rate", both, gyro, rate, lambda m: vector(m.angular_velocity))
    triads(judge, "force", both, accel, force, lambda m: vector(m.linear_acceleration))
    triads(judge, "field", got["/imu/mag"], mag, field, lambda m: vector(m.magnetic_field), 1e-6)
    triads(judge, "gyro/true", got["/imu/gyro/true"], gyro, [f"true_{n}" for n in rate], lambda m: vector(m.vector))
    names = ["qw", "qx", "qy", "qz"]
    triads(judge, "truth", got["/truth/pose"], truth, names, lambda m: quaternion(m.pose.orientation))
    estimate = csv(folder / "estimate.csv")
    told = [(t, m) for t, m in got["/estimate/pose"] if t in estimate]
    triads(judge, "estimate", told, estimate, names, lambda m: quaternion(m.pose.orientation))
    for t, message in got["/tf"]:
        (transform,) = message.transforms
        assert transform.header.frame_id == "map" and transform.child_frame_id.startswith("imu_link"), transform
        stamp = transform.header.stamp
        judge.same("tf's time", stamp.sec * 10**9 + stamp.nanosec, t)
    # Every sample in turn; a viewer on a busy machine may lose some of its own, and gets the others at their times.
    steps = [(later - t) * FAST / 10**9 for (t, _), (later, _) in zip(both, both[1:])]
    for step in steps:
        judge.same("a sample's time", step, max(1, round(step)), within=1e-6)
    judge.same("samples that came", len(steps) / sum(steps), 1, within=0.2)
    for _, message in got["/diagnostics"]:
        names = [status.name for status in message.status]
        assert names[:3] == ["gyro", "accel", "mag"] and len(names) == 4, names
    return judge, len(told)


def main(ratetable, folder, subprotocol):
    rates = ["--set", f"gyro.rate={FAST} Hz", "--set", f"accel.rate={FAST} Hz"]
    command = [ratetable, "run", "table-1", *rates, "--for", "6s", "--live=0", "--out", folder]
    run = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    for line in run.stderr:
        if found := re.match(r"live: (http://\S+)", line):
            break
    got = asyncio.run(follow(found[1].replace("http", "ws", 1), subprotocol, lambda topic: True))
    told = run.communicate()[1]
    assert run.returncode == 0, told
    judge, answers = compare(got, Path(folder))
    channels = {topic: len(messages) for topic, messages in got.items()}
    print(json.dumps({"channels": channels, "answers": answers, "compared": judge.compared, "wrong": judge.wrong[:20]}))


if __name__ == "__main__":
    main(*sys.argv[1:])
