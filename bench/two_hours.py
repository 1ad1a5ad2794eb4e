#!/usr/bin/python3
"""Writes a record of two hours x 1 kHz x 30 channels (6 forces, 24 accelerations, 12 modes, noise;
1.7 GB) and prints time and memory of `hydrapod frf` and `hydrapod identify` on it.

Usage: bench/two_hours.py [BUILD [SECONDS]]     (default build/test, 7200; needs python3-h5py, -scipy)
"""

import multiprocessing
import os
import pathlib
import subprocess
import sys
import tempfile
import time

try:
    import h5py
    import numpy as np
    from scipy.signal import cont2discrete, lfilter, ss2tf
except ImportError:
    sys.exit("two_hours.py needs python3-h5py and python3-scipy")

rate = 1000.0
frequency = [6.1, 9.4, 12.9, 17.3, 23.1, 31.7, 38.2, 52.9, 66.4, 81.3, 103.7, 131.1]  # [Hz]
damping = [.021, .013, .034, .017, .025, .012, .03, .015, .022, .011, .019, .014]
inputs, outputs = 6, 24


def acceleration_filter(f, zeta):
    """Of one mode, held inputs: coefficients and state."""
    w = 2 * np.pi * f
    system = [np.array(m, float) for m in ([[0, 1], [-w * w, -2 * zeta * w]], [[0], [1]],
                                           [[-w * w, -2 * zeta * w]], [[1]])]
    b, a = ss2tf(*cont2discrete(system, 1 / rate, method="zoh")[:4])
    return b[0], a, np.zeros(2)


def write(path, seconds):
    random = np.random.default_rng(5)
    shapes = random.standard_normal((outputs, len(frequency)))
    participations = random.standard_normal((len(frequency), inputs))
    filters = [acceleration_filter(f, z) for f, z in zip(frequency, damping)]
    samples, piece = int(seconds * rate), 200_000
    with h5py.File(path, "w") as file:
        file.attrs["sample_rate"] = rate
        channels = []
        for count, name, unit in ((inputs, "u", "N"), (outputs, "a", "m/s^2")):
            for k in range(count):
                channels.append(file.create_dataset(f"{name}{k + 1}", (samples,), "f8"))
                channels[-1].attrs["unit"] = unit
        for first in range(0, samples, piece):
            count = min(piece, samples - first)
            forces = random.standard_normal((inputs, count))
            modal = participations @ forces
            for k, (b, a, state) in enumerate(filters):
                modal[k], state = lfilter(b, a, modal[k], zi=state)
                filters[k] = (b, a, state)
            measured = shapes @ modal
            noise = random.standard_normal(measured.shape)
            measured += 0.3 * measured.std(axis=1, keepdims=True) * noise
            for channel, values in zip(channels, np.vstack((forces, measured))):
                channel[first:first + count] = values


def measure(command):
    """Wall time [s], processor time [s] and peak memory [MB] of a program."""
    begin = time.monotonic()
    child = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(child.pid, 0)
    if status != 0:
        sys.exit(f"{command} ended with {status}")
    return time.monotonic() - begin, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def main():
    build = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "build/test")
    seconds = float(sys.argv[2]) if len(sys.argv) > 2 else 7200.0
    program = build / "apps/hydrapod/hydrapod"
    with tempfile.TemporaryDirectory(dir=os.environ.get("TMPDIR", "/var/tmp")) as folder:
        record = os.path.join(folder, "two_hours.h5")
        # in another process: the peak of a program that is started includes that of who starts it
        writer = multiprocessing.Process(target=write, args=(record, seconds))
        writer.start()
        writer.join()
        if writer.exitcode != 0:
            sys.exit("the record could not be written")
        for command in ("frf", "identify"):
            wall, processor, memory = measure([program, command, record])
            print(f"{command}: {wall:.1f} s, {processor:.1f} s of processor time, {memory:.0f} MB")


if __name__ == "__main__":
    main()
