"""Reads every format of a dataset with that format's own readers and compares each number with the CSV, bit for bit.

Usage: formats.py FOLDER FORMAT...
Prints {FORMAT: {"same": numbers that agree, "wrong": ["where: what", ...]}}. CSV is read by Python itself.
"""

import json
import struct
import sys
from pathlib import Path

MICRO = 1e-6


def bits(number):
    return struct.pack("<d", number)


def csv(path):
    """Columns by name; `t_ns` as whole numbers, `t_s` as Python divides it."""
    header, *rows = (line.split(",") for line in path.read_text().splitlines())
    columns = {name: [float(row[i]) for row in rows] for i, name in enumerate(header)}
    columns["t_ns"] = [int(row[0]) for row in rows]
    columns["t_s"] = [t / 10**9 for t in columns["t_ns"]]
    return columns


class Tally:
    def __init__(self):
        self.same, self.wrong = 0, []

    def column(self, where, got, expected):
        got, expected = list(got), list(expected)
        if len(got) != len(expected):
            self.wrong.append(f"{where}: {len(got)} rows for {len(expected)}")
        for i, (g, e) in enumerate(zip(got, expected)):
            if bits(g) == bits(e) and (not isinstance(e, int) or int(g) == e):
                self.same += 1
            else:
                self.wrong.append(f"{where}[{i}]: {g!r} for {e!r}")

    def table(self, where, got, expected):
        """`got` by name, of names in the CSV's order with `t_s` behind `t_ns`."""
        names = list(expected)[:-1]
        names.insert(1, "t_s")
        if list(got) != names:
            self.wrong.append(f"{where}: columns {list(got)} for {names}")
        for name in names:
            self.column(f"{where}.{name}", got.get(name, []), expected[name])


def npy(folder, tables, tally):
    import numpy as np

    for name, expected in tables.items():
        array = np.load(folder / f"{name}.npy")
        assert array.dtype["t_ns"] == np.int64 and array.ndim == 1
        tally.table(name, {column: array[column].tolist() for column in array.dtype.names}, expected)


def mat(folder, tables, tally):
    import scipy.io

    for name, expected in tables.items():
        read = {k: v for k, v in scipy.io.loadmat(folder / f"{name}.mat").items() if not k.startswith("__")}
        assert all(vector.shape == (len(expected["t_ns"]), 1) for vector in read.values()), name
        tally.table(name, {column: vector[:, 0].tolist() for column, vector in read.items()}, expected)


def parquet(folder, tables, tally):
    import pyarrow as pa
    import pyarrow.parquet as pq

    for name, expected in tables.items():
        table = pq.read_table(folder / f"{name}.parquet")
        assert table.schema.field("t_ns").type == pa.int64()
        tally.table(name, table.to_pydict(), expected)


def tum(folder, tables, tally):
    from evo.tools import file_interface

    attitudes = {name: table for name, table in tables.items() if "qw" in table}
    assert sorted(path.stem for path in folder.glob("*.tum")) == sorted(attitudes)
    for name, expected in attitudes.items():
        trajectory = file_interface.read_tum_trajectory_file(folder / f"{name}.tum")
        valid, why = trajectory.check()
        if not valid:
            tally.wrong.append(f"{name}: {why}")
        tally.column(f"{name}.t_s", trajectory.timestamps.tolist(), expected["t_s"])
        tally.column(f"{name}.position", trajectory.positions_xyz.ravel().tolist(), [0.0] * 3 * len(expected["t_ns"]))
        for i, column in enumerate(("qw", "qx", "qy", "qz")):
            tally.column(f"{name}.{column}", trajectory.orientations_quat_wxyz[:, i].tolist(), expected[column])


def mcap(folder, tables, tally):
    from mcap_ros2.reader import read_ros2_messages

    topics = {}
    for message in read_ros2_messages(folder / "dataset.mcap"):
        topics.setdefault(message.channel.topic, []).append(message)

    def vector(where, got, table, columns, factor=None):
        for axis, column in zip("xyzw", columns):
            expected = table[column] if factor is None else [value * factor for value in table[column]]
            tally.column(f"{where}.{column}", [getattr(it, axis) for it in got], expected)

    def messages(topic, table):
        found = topics.pop(topic, [])
        stamps = [(m.ros_msg.header.stamp.sec, m.ros_msg.header.stamp.nanosec) for m in found]
        tally.column(f"{topic}.stamp", [s * 10**9 + ns for s, ns in stamps], table["t_ns"])
        tally.column(f"{topic}.log_time", [m.log_time_ns for m in found], table["t_ns"])
        return [m.ros_msg for m in found]

    def holds(topic, got, field, expected):
        for message in got:
            covariance = list(getattr(message, field + "_covariance"))
            if covariance != [0.0 if expected else -1.0] + [0.0] * 8:
                tally.wrong.append(f"{topic}.{field}: covariance {covariance}")

    gyro, accel = tables["gyro"], tables["accel"]
    topic = "/imu/data_raw"
    together = topics.pop(topic, [])
    if together:
        # Where a sample is missing the message says so, and holds the other one.
        times = [m.log_time_ns for m in together]
        tally.column(f"{topic}.log_time", sorted(times), sorted({*gyro["t_ns"], *accel["t_ns"]}))
        got = [m.ros_msg for m in together]
        holds(topic, got, "orientation", False)
        for field, table, unit in (("angular_velocity", gyro, "rad_s"), ("linear_acceleration", accel, "m_s2")):
            there = [m for m in got if getattr(m, field + "_covariance")[0] == 0.0]
            stamps = [m.header.stamp.sec * 10**9 + m.header.stamp.nanosec for m in there]
            tally.column(f"{topic}.{field}.stamp", stamps, table["t_ns"])
            vector(topic, [getattr(m, field) for m in there], table, [f"{axis}_{unit}" for axis in "xyz"])

    imus = {} if together else {"/imu/gyro": (gyro, None), "/imu/accel": (None, accel)}
    for topic, (rate, force) in imus.items():
        got = messages(topic, rate or force)
        holds(topic, got, "orientation", False)
        holds(topic, got, "angular_velocity", rate)
        holds(topic, got, "linear_acceleration", force)
        if rate:
            vector(topic, [m.angular_velocity for m in got], rate, [f"{axis}_rad_s" for axis in "xyz"])
        if force:
            vector(topic, [m.linear_acceleration for m in got], force, [f"{axis}_m_s2" for axis in "xyz"])

    got = messages("/imu/mag", tables["mag"])
    vector("/imu/mag", [m.magnetic_field for m in got], tables["mag"], ["x_ut", "y_ut", "z_ut"], MICRO)

    for name, unit, factor in (("gyro", "rad_s", None), ("accel", "m_s2", None), ("mag", "ut", MICRO)):
        for what in ("true", "bias"):
            got = messages(f"/imu/{name}/{what}", tables[name])
            columns = [f"{what}_{axis}_{unit}" for axis in "xyz"]
            vector(f"{name}.{what}", [m.vector for m in got], tables[name], columns, factor)

    if "baro" in tables:
        got = messages("/baro", tables["baro"])
        tally.column("/baro", [m.fluid_pressure for m in got], tables["baro"]["pressure_pa"])
    if "gps" in tables:
        table = tables["gps"]
        got = messages("/gps/fix", table)
        for field, column in zip(("latitude", "longitude", "altitude"), ("lat_deg", "lon_deg", "alt_m")):
            tally.column(f"/gps/fix.{column}", [getattr(m, field) for m in got], table[column])
        if any((m.status.status, m.status.service, m.position_covariance_type) != (0, 1, 0) for m in got):
            tally.wrong.append("/gps/fix: status")
        got = messages("/gps/velocity", table)
        # The scene is written East-North-Up.
        vector("/gps/velocity", [m.vector for m in got], table, ["ve_m_s", "vn_m_s"])
        down = [0.0 if v == 0.0 else -v for v in table["vd_m_s"]]
        tally.column("/gps/velocity.up", [m.vector.z for m in got], down)

    truth = tables["truth"]
    got = messages("/truth", truth)
    for field in ("orientation", "angular_velocity", "linear_acceleration"):
        holds("/truth", got, field, True)
    vector("/truth", [m.orientation for m in got], truth, ["qx", "qy", "qz", "qw"])
    vector("/truth", [m.angular_velocity for m in got], truth, [f"w{axis}_rad_s" for axis in "xyz"])
    vector("/truth", [m.linear_acceleration for m in got], truth, [f"f{axis}_m_s2" for axis in "xyz"])
    got = messages("/truth/mag", truth)
    vector("/truth/mag", [m.magnetic_field for m in got], truth, ["mx_ut", "my_ut", "mz_ut"], MICRO)

    for name in ("reference", "estimate"):
        if name in tables:
            got = messages(f"/{name}", tables[name])
            vector(name, [m.quaternion for m in got], tables[name], ["qx", "qy", "qz", "qw"])
    if topics:
        tally.wrong.append(f"topics nobody asked for: {list(topics)}")


def main(folder, *formats):
    folder = Path(folder)
    tables = {path.stem: csv(path) for path in folder.glob("*.csv")}
    report = {}
    for name in formats:
        tally = Tally()
        globals()[name](folder, tables, tally)
        report[name] = {"same": tally.same, "wrong": tally.wrong}
    print(json.dumps(report))


if __name__ == "__main__":
    main(*sys.argv[1:])
