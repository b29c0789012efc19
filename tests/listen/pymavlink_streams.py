"""Writes every message of pymavlink's dialects `ardupilotmega` and `common`, and prints what is in each file.

usage: pymavlink_streams.py FOLDER

v1.mav, v2.mav: each message, twice over; signed.mav: with signatures; log.tlog: v2.mav as pymavlink's own log writer
logs it. Beside them the table of ids, checksum bytes and names as JSON.
"""

import json
import os
import sys

os.environ["MAVLINK20"] = "1"
from pymavlink import mavutil  # noqa: E402
from pymavlink.dialects.v20 import ardupilotmega, common  # noqa: E402

folder = sys.argv[1]


def message(kind, n):
    """One of a kind, with numbers that are not zero in every field."""
    values = []
    lengths = dict(zip(kind.ordered_fieldnames, kind.array_lengths))
    for name, of in zip(kind.fieldnames, kind.fieldtypes):
        count = lengths[name]
        if of == "char":
            values.append(b"a" if count else b"a")
        elif count:
            values.append([n % 100 + 1] * count)
        else:
            values.append(n % 100 + 1)
    return kind(*values)


def write(name, wire, signed=False, longest_id=0xFFFFFF):
    mav = ardupilotmega.MAVLink(None, srcSystem=1, srcComponent=1)
    if signed:
        mav.signing.secret_key = bytes(range(32))
        mav.signing.sign_outgoing = True
        mav.signing.link_id = 1
        mav.signing.timestamp = 1
    counts = {}
    with open(os.path.join(folder, name), "wb") as out:
        for n in range(2):
            for kind in sorted(ardupilotmega.mavlink_map.values(), key=lambda kind: kind.id):
                if kind.id > longest_id:
                    continue
                out.write(message(kind, n).pack(mav, force_mavlink1=wire == 1))
                mav.seq = (mav.seq + 1) % 256
                key = kind.msgname.lower()
                counts[key] = counts.get(key, 0) + 1
    return counts


def log(name, source):
    link = mavutil.mavlink_connection(os.path.join(folder, source), notimestamps=True, dialect="ardupilotmega")
    link.setup_logfile(os.path.join(folder, name))
    while link.recv_msg() is not None:
        pass
    link.logfile.close()


tables = {**common.mavlink_map, **ardupilotmega.mavlink_map}
print(
    json.dumps(
        {
            "v1.mav": write("v1.mav", 1, longest_id=255),
            "v2.mav": write("v2.mav", 2),
            "signed.mav": write("signed.mav", 2, signed=True),
            "table": [[kind.id, kind.crc_extra, kind.msgname.lower()] for _, kind in sorted(tables.items())],
        }
    )
)
log("log.tlog", "v2.mav")
