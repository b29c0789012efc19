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


# ---- sbg: class, id, struct format. Vectors are forward, right, down.
SBG = {
    "imu_short": (0, 44, "<IH3i3ih"),
    "mag": (0, 4, "<IH3f3f"),
    "air_data": (0, 36, "<IH5f"),
    "quat": (0, 7, "<I4f3fI"),
    "info": (16, 4, "<32sIIHBBII"),
    "info_request": (16, 4, "<"),
}


def kermit(data):
    """CRC-16/KERMIT, bit by bit."""
    crc = 0
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ 0x8408 if crc & 1 else crc >> 1
    return crc


def flat(value):
    if isinstance(value, str):
        return [value.encode()]
    return value if isinstance(value, list) else [value]


def sbg(kind, fields):
    clas, ident, layout = SBG[kind]
    payload = struct.pack(layout, *[part for value in fields.values() for part in flat(value)])
    inside = bytes([ident, clas]) + struct.pack("<H", len(payload)) + payload
    return b"\xff\x5a" + inside + struct.pack("<H", kermit(inside)) + b"\x33"


def sbg_vectors():
    assert kermit(b"123456789") == 0x2189
    imu = {
        "time_us": 42119999,
        "status": 0x03FF,
        "accel": [round(a * 1048576) for a in (0, -0.0430155, -9.806556)],
        # 0.219307, 0.000284, 0.064725 rad/s to their sixth digit.
        "gyro": [14717459, 19053, 4343641],
        "temperature": 25 * 256,
    }
    for count, rate in zip(imu["gyro"], (0.219307, 0.000284, 0.064725)):
        assert abs(count / 67108864 - rate) < 5e-7
    field = {
        "time_us": 42119999,
        "status": 0x01FF,
        "field": [175.64352, -130.58655, 430.57693],
        "accel": [0.0, -0.04301551, -9.806556],
    }
    fast = {
        "time_us": 4294967295,
        "status": 0x07FF,
        "accel": [round(a * 1048576) for a in (156, -156, 20)],
        "gyro": [round(w * 12304174) for w in (40, -34.9, 0.001)],
        "temperature": -40 * 256,
    }
    air = {
        "time_us": 1000000,
        "status": 0x22,
        "pressure": 94500.0,
        "altitude": 0.0,
        "differential_pressure": 0.0,
        "airspeed": 0.0,
        "temperature": 25.0,
    }
    quat = {
        "time_us": 1000000,
        "wxyz": [0.5, -0.5, 0.5, 0.5],
        "uncertainty": [0.125, 0.25, 0.5],
        "status": 0x32,
    }
    info = {
        "product": "RATETABLE",
        "serial": 0,
        "calibration": 0,
        "year": 0,
        "month": 0,
        "day": 0,
        "hardware": 1 << 24,
        "firmware": 1 << 22,
    }
    assert sbg("imu_short", imu).hex() == (
        "ff5a2c0020003fb38202ff0300000000cf4fffff591863ff1392e0006d4a0000594742000019e9b233"
    )
    assert sbg("mag", field).hex() == (
        "ff5a04001e003fb38202ff01bea42f43289602c3d949d74300000000083130bda7e71cc10b3133"
    )
    assert sbg("info_request", {}).hex() == "ff5a0410000079f733"
    return [
        ("gyro 0.219307, 0.000284, 0.064725 rad/s; accel 0, -0.0430155, -9.806556 m/s²", "imu_short", imu),
        ("a field of 483 mG, and the same accel", "mag", field),
        ("faster than 32 rad/s, at the end of the clock", "imu_short", fast),
        ("94500 Pa", "air_data", air),
        ("an attitude", "quat", quat),
        ("which device are you?", "info_request", {}),
        ("the answer", "info", info),
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
write(
    "sbg.json",
    "ArduPilot's driver took the first two packets and sends the request. make.py beside this file wrote all of them "
    "from the table of docs/wire/sbg.md: struct.pack for the fields, and a bit-by-bit CRC-16/KERMIT.",
    [
        {"name": name, "type": kind, "fields": fields, "hex": sbg(kind, fields).hex()}
        for name, kind, fields in sbg_vectors()
    ],
)
