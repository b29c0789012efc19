"""Overlapping Allan deviation, by allantools, of a gyro's counts, beside what its datasheet makes it.

Usage: allan.py FILE RATE_HZ LSB_DPS DENSITY BIAS_STABILITY
FILE holds 16-bit counts x, y, z, x …; DENSITY is one-sided, deg/s/√Hz; BIAS_STABILITY the least Allan deviation, deg/s.
Prints [{"tau_s", "deviation", "theory", "error", "bound"}, …], the deviations in deg/s and of the three axes together.
"""

import json
import sys

import allantools
import numpy as np

TAUS = [0.1, 1.0, 10.0]
# An error of more than these standard errors happens to one point in 16 000.
SIGMAS = 4.0
AT_MOST = 0.10


def theory(tau, rate, lsb, density, stability):
    """White noise of half the one-sided density, rounding to counts, and a 1/f spectrum: IEEE Std 952-1997, annex C."""
    return np.sqrt((density**2 / 2 + lsb**2 / 12 / rate) / tau + stability**2)


def freedom(tau, rate, samples, stability):
    """Equivalent degrees of freedom of one axis (Greenhall & Riley 2003), of flicker where there is some: the fewer."""
    alpha = -1 if stability else 0
    return allantools.edf_greenhall(alpha=alpha, d=2, m=round(tau * rate), N=samples, overlapping=True)


def main(file, rate, lsb, density, stability):
    counts = np.fromfile(file, dtype="<i2").reshape(-1, 3)
    squares = np.zeros(len(TAUS))
    for axis in range(3):
        taus, deviations, _, _ = allantools.oadev(counts[:, axis] * lsb, rate=rate, data_type="freq", taus=TAUS)
        assert np.allclose(taus, TAUS), taus
        squares += deviations**2 / 3
    points = []
    for tau, square in zip(TAUS, squares):
        expected = theory(tau, rate, lsb, density, stability)
        sigma = 1 / np.sqrt(2 * 3 * freedom(tau, rate, len(counts) + 1, stability))
        points.append({
            "tau_s": tau,
            "deviation": np.sqrt(square),
            "theory": expected,
            "error": np.sqrt(square) / expected - 1,
            "bound": min(SIGMAS * sigma, AT_MOST),
        })
    json.dump(points, sys.stdout)


main(sys.argv[1], *map(float, sys.argv[2:]))
