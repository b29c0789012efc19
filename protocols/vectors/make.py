"""Writes ilabs.json and sbg.json: golden packets from the tables of docs/wire, with Python's own struct alone.

It shares no code with the crate. Physical values are turned into counts here; where a packet was read back from a real
driver, the script asserts that it makes those very bytes.

    python3 protocols/vectors/make.py
"""

import json
import math
import pathlib
import struct

FOLDER = pathlib.Path(__file__).parent

# ---- ilabs: id, its name, struct format. Vectors are right, forward, up.
ILABS = {
    "time_ms": (0x01, "<I"),
    "accel": (0x23, "<3i"),
    "gyro": (0x21, "<3i"),
    "pressure": (0x25, "<Hi"),
    "mag": (0x24, "<3h"),
    "attitude": (0x07, "<Hhh"),
    "status": (0x53, "<H"),
    "status_2": (0x5A, "<H"),
    "temperature": (0x52, "<h"),
}


def rfu(x, y, z):
    """Forward, right, down to right, forward, up."""
    return [y, x, -z]


def ilabs_accel(*metres_per_s2):
    return [round(a / 9.8106 * 1e6) for a in rfu(*metres_per_s2)]


def ilabs_gyro(*rad_per_s):
    return [round(math.degrees(w) * 1e5) for w in rfu(*rad_per_s)]


def ilabs_mag(*milligauss):
    # A milligauss is 100 nT, a count 10 nT.
    return [round(b * 10) for b in rfu(*milligauss)]


def ilabs(fields):
    ids = bytes(ILABS[name][0] for name in fields)
    data = b""
    for name, value in fields.items():
        data += struct.pack(ILABS[name][1], *(value if isinstance(value, list) else [value]))
    body = bytes([0x01, 0x95]) + struct.pack("<H", 6 + 1 + len(ids) + len(data)) + bytes([len(ids)]) + ids + data
    return b"\xaa\x55" + body + struct.pack("<H", sum(body) & 0xFFFF)


def ilabs_vectors():
    turned = {
        "time_ms": 16954,
        "accel": ilabs_accel(156, -156, 20),
        "gyro": ilabs_gyro(30, -31, 2),
        "pressure": [94500 // 2, 0],
        "mag": ilabs_mag(-3200, 3200, -7.8),
        "attitude": [3000, 0, -1170],
        "status": 0,
        "status_2": 0,
        "temperature": 250,
    }
    still = {
        "time_ms": 500,
        "accel": ilabs_accel(0, 0, -9.80665),
        "gyro": ilabs_gyro(0, 0, 0),
        "pressure": [round(101325 / 2), 0],
        "mag": ilabs_mag(190.5, -110, 430),
        "attitude": [3000, 0, 0],
        "status": 0,
        "status_2": 0,
        "temperature": 250,
    }
    edges = {
        "time_ms": 604_799_999,
        "accel": [2**31 - 1, -(2**31), 1],
        "gyro": [-1, 2**31 - 1, -(2**31)],
        "pressure": [65535, -12345],
        "mag": [32767, -32768, -1],
        "attitude": [35999, -9000, 18000],
        "status": 0x0401,
        "status_2": 0x8001,
        "temperature": -400,
    }
    bare = {"accel": ilabs_accel(0.5, -0.25, -9.75), "gyro": ilabs_gyro(0.125, -0.25, 0.5)}
    assert ilabs(turned).hex() == (
        "aa550195440009012321252407535a523a420000105e0dfff0a1f200ade4e0ffecc769f5ebca3e0aac2551ff92b8"
        "00000000007d00834e00b80b00006efb00000000fa004d17"
    )
    assert ilabs(still).hex() == (
        "aa550195440009012321252407535a52f40100000000000000000000ad400f00000000000000000000000000e6c5"
        "00000000b4fb710734efb80b0000000000000000fa001a0b"
    )
    return [
        ("gyro 30, -31, 2 rad/s; accel 156, -156, 20 m/s²; mag -3200, 3200, -7.8 mG; 94500 Pa", turned),
        ("still, yaw 30°", still),
        ("every field at an end of its range", edges),
        ("accel and gyro alone", bare),
    ]


def write(name, made, packets):
    text = json.dumps({"made": made, "packets": packets}, indent=1, ensure_ascii=False)
    (FOLDER / name).write_text(text + "\n")


write(
    "ilabs.json",
    "ArduPilot's driver took the first two packets. make.py beside this file wrote all of them from the table of "
    "docs/wire/ilabs.md: struct.pack for the fields, and Python's sum for the sum.",
    [{"name": name, "fields": fields, "hex": ilabs(fields).hex()} for name, fields in ilabs_vectors()],
)
