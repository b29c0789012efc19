#!/bin/sh
# Runs all tests, from any directory, on a machine with Rust and Python 3. Arguments go to `cargo test`.
#
# The tests with clients and readers of other makes (a MAVLink client, numpy, scipy, allantools, pyarrow, mcap, evo, Ray)
# need Python packages: they are put into .venv here once, and nowhere else. Every optional format is built, so that it
# is tested.
set -eu

root=$(CDPATH='' cd -- "$(dirname -- "$0")/.." && pwd)
venv=$root/.venv
python=$venv/bin/python
requirements=$root/firmware-host-tests/tests/requirements.txt
installed=$venv/requirements.installed

# A requirement may have changed, or the Python that the environment was made of may be gone.
if ! cmp -s "$requirements" "$installed" || ! "$python" -c 'import pymavlink.mavutil, serial, scipy, pyarrow, mcap_ros2, evo, allantools, ray, pyulog, ahrs, websockets' 2>/dev/null; then
    if ! command -v python3 >/dev/null; then
        echo "tests/run.sh: python3 is missing: install it (Debian and Ubuntu: apt install python3 python3-venv)" >&2
        exit 2
    fi
    if ! python3 -c 'import ensurepip, venv' 2>/dev/null; then
        echo "tests/run.sh: python3 cannot make a virtual environment: install its venv module (Debian and Ubuntu: apt install python3-venv)" >&2
        exit 2
    fi
    "$python" -m pip --version >/dev/null 2>&1 || python3 -m venv --clear "$venv"
    "$python" -m pip install --quiet --disable-pip-version-check --requirement "$requirements"
    cp "$requirements" "$installed"
fi

export RATETABLE_PYTHON="$python" RATETABLE_REQUIRE_PYTHON=1
cd "$root"
exec cargo test --workspace --all-features "$@"
