"""Nine-axis samples a second of gnss-ins-sim on a motion like that of full-mpu9250, to set `ratetable study cost` against.

    git clone https://github.com/Aceinna/gnss-ins-sim       # MIT; on no package index
    python3 benches/gnss_ins_sim.py gnss-ins-sim            # needs numpy

Times what makes its samples and nothing else: the path (constant Euler rates at 1 kHz in its cheaper, inertial frame)
and its errors of gyroscope, accelerometer and magnetometer: bias, Gauss-Markov drift, white noise, iron. It has no
scale error, misalignment, non-linearity, temperature, range or counts. No files, no algorithms; processor time, the quickest of several.
"""

import math
import sys
import time

SECONDS, RATE, ROUNDS = 1, 1000, 100


def main(checkout: str) -> None:
    sys.path.insert(0, checkout)
    import numpy as np
    from gnss_ins_sim.pathgen import pathgen

    three = np.ones(3)
    drift = {"b": 0.01 * three, "b_corr": 100.0 * three, "b_drift": 1e-4 * three}
    gyro = {**drift, "arw": 1e-4 * three}
    accel = {**drift, "vrw": 2e-3 * three}
    mag = {"si": np.eye(3) + 0.01, "hi": 10.0 * three, "std": 0.2 * three}

    def samples() -> int:
        start = np.array([math.radians(60), math.radians(30), 0, 0, 0, 0, 0, 0, 0])
        # Command type 1: rates of yaw, pitch, roll and accelerations along the body's axes, for so many seconds, without
        # GPS.
        motion = np.array([[1, *np.radians([50, -35, 20]), 0, 0, 0, SECONDS, 0]])
        # The IMU's rate without oversampling; neither GPS nor odometer.
        output = np.array([[1.0, RATE], [-1.0, RATE], [-1.0, RATE]])
        path = pathgen.path_gen(start, motion, output, np.array([10.0, 0.5, 10.0]), ref_frame=1, magnet=True)
        imu, field = path["imu"], path["mag"]
        readings = (
            pathgen.gyro_gen(RATE, imu[:, 4:7], gyro),
            pathgen.acc_gen(RATE, imu[:, 1:4], accel),
            pathgen.mag_gen(field[:, 1:4], mag),
        )
        assert all(np.isfinite(reading).all() for reading in readings)
        return len(imu)

    best = math.inf
    for _ in range(ROUNDS):
        begin = time.process_time()
        made = samples()
        best = min(best, (time.process_time() - begin) / made)
    print(f"{1 / best:.0f} nine-axis samples a CPU second, {best * 1e6:.1f} µs each: the quickest of {ROUNDS} runs of {made}")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
