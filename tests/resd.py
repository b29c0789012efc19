"""Reads a dataset's RESD file by the format's page and compares it with the CSV beside it.

Usage: resd.py FOLDER NAME=AXES...
NAME is a table, AXES says which of its axes the chip's x, y and z are, with their signs: gyro=+x-y-z; baro=pressure.
Prints {NAME: {"samples": of the file, "blocks": count, "wrong": ["where: what", ...]}}, "temperature:CHANNEL" too.

Source of the format: Renode's documentation, "Renode Sensor Data Format (RESD)". Nothing but Python itself is needed.
"""

import json
import struct
import sys
from fractions import Fraction
from pathlib import Path

# ID: name, layout of a sample, units of it in one of the table's.
TYPES = {
    0x0001: ("temperature", "<i", 1000),
    0x0002: ("accel", "<iii", Fraction(10**6) / Fraction("9.80665")),
    0x0003: ("gyro", "<iii", 10**5),
    0x0007: ("baro", "<Q", 1000),
    0x0008: ("mag", "<iii", 1000),
}
COLUMNS = {"accel": "m_s2", "gyro": "rad_s", "mag": "ut"}


class Bytes:
    def __init__(self, data):
        self.data, self.at = data, 0

    def take(self, layout):
        values = struct.unpack_from(layout, self.data, self.at)
        self.at += struct.calcsize(layout)
        return values if len(values) > 1 else values[0]


def read(path):
    """{(name, channel): [(start, end, [(t, values), ...]) of each block]}"""
    file = Bytes(path.read_bytes())
    assert file.take("<4s") == b"RESD" and file.take("<B") == 1 and file.take("<3s") == b"\0\0\0"
    streams = {}
    while file.at < len(file.data):
        block_type, sample_type, channel, size = file.take("<B"), file.take("<H"), file.take("<H"), file.take("<Q")
        end = file.at + size
        assert end <= len(file.data), "a block ends behind the file"
        name, layout, _ = TYPES[sample_type]
        start = file.take("<Q")
        period = file.take("<Q") if block_type == 2 else None
        assert block_type in (1, 2)
        metadata = file.take("<Q")
        file.at += metadata
        samples = []
        while file.at < end:
            t = start + file.take("<Q") if block_type == 1 else start + len(samples) * period
            samples.append((t, file.take(layout)))
        assert file.at == end and samples and (period or len(samples) == 1)
        over = samples[-1][0] + (period or 0)
        streams.setdefault((name, channel), []).append((start, over, samples))
    return streams


def table(path):
    header, *rows = (line.split(",") for line in path.read_text().splitlines())
    return {name: [row[i] for row in rows] for i, name in enumerate(header)}


def expected(folder, name, axes):
    """(t, values in the table's unit) of each row, on the chip's axes."""
    columns = table(folder / f"{name}.csv")
    times = map(int, columns["t_ns"])
    if axes == "pressure":
        return list(zip(times, ([Fraction(x)] for x in columns["pressure_pa"])))
    chip = [axes[i : i + 2] for i in (0, 2, 4)]
    along = [columns[f"{axis}_{COLUMNS[name]}"] for _, axis in chip]
    signs = [int(sign + "1") for sign, _ in chip]
    rows = zip(*along)
    return [(t, [sign * Fraction(x) for sign, x in zip(signs, row)]) for t, row in zip(times, rows)]


def compare(blocks, rows, per_unit):
    wrong = []
    samples = [sample for _, _, samples in blocks for sample in samples]
    if [t for t, _ in samples] != [t for t, _ in rows]:
        differ = [f"{a} for {b}" for (a, _), (b, _) in zip(samples, rows) if a != b][:3]
        wrong.append(f"times: {len(samples)} for {len(rows)}, {differ}")
    for (t, got), (_, want) in zip(samples, rows):
        got = got if isinstance(got, tuple) else (got,)
        off = max(abs(g - w * per_unit) for g, w in zip(got, want))
        if off > Fraction(500_001, 1_000_000):
            wrong.append(f"{t}: {got} is {float(off)} units off")
    # Renode holds a sample for its block's period: where none is held its models read their defaults.
    for (_, over, _), (start, _, _) in zip(blocks, blocks[1:]):
        if over != start:
            wrong.append(f"no sample from {over} to {start}")
    return wrong


def main(folder, *asked):
    folder, report = Path(folder), {}
    streams = read(folder / "dataset.resd")
    per_unit = {name: unit for name, _, unit in TYPES.values()}
    for name, axes in (it.split("=") for it in asked):
        blocks = streams.pop((name, 0))
        wrong = compare(blocks, expected(folder, name, axes), per_unit[name])
        report[name] = {"samples": sum(len(it) for _, _, it in blocks), "blocks": len(blocks), "wrong": wrong}
    for (name, channel), blocks in streams.items():
        assert name == "temperature", name
        of = ["gyro", "accel", "mag", "baro"][channel]
        columns = table(folder / f"{of}.csv")
        times, wrong = [t for _, _, samples in blocks for t, _ in samples], []
        if times != list(map(int, columns["t_ns"])):
            wrong.append("times")
        if of == "baro":
            rows = [(t, [Fraction(x)]) for t, x in zip(times, columns["temperature_degc"])]
            wrong += compare(blocks, rows, per_unit[name])
        report[f"{name}:{channel}"] = {"samples": len(times), "blocks": len(blocks), "wrong": wrong}
    print(json.dumps(report, sort_keys=True))


if __name__ == "__main__":
    main(*sys.argv[1:])
