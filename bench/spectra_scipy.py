#!/usr/bin/python3
"""Compares hydrapod's cross spectra with SciPy's csd in one run and prints the ratio.

Twelve channels of 2^19 samples, blocks of 8192 with half overlap: hydrapod's responses_of_record
(all spectra, responses, coherences and variances) beside scipy.signal.csd over all 78 pairs, both on
one core, processor time, the median of five.

Usage: bench/spectra_scipy.py [BUILD]     (default build/test; needs python3-scipy)
"""

import json
import os
import pathlib
import subprocess
import sys
import time

os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"
try:
    import numpy
    import scipy
    import scipy.signal
except ImportError:
    sys.exit("bench/spectra_scipy.py: needs SciPy (apt install python3-scipy)")

REPETITIONS = 5
CHANNELS, SAMPLES, BLOCK = 12, 2**19, 8192


def scipy_seconds():
    x = numpy.random.default_rng(5).standard_normal((CHANNELS, SAMPLES))
    begin = time.process_time()
    for i in range(CHANNELS):
        for j in range(i + 1):
            scipy.signal.csd(x[i], x[j], nperseg=BLOCK)
    return time.process_time() - begin


def hydrapod_seconds(program):
    arguments = [
        program,
        "--benchmark_filter=^responses_of_record$",
        f"--benchmark_repetitions={REPETITIONS}",
        "--benchmark_format=json",
    ]
    out = subprocess.run(arguments, check=True, capture_output=True, text=True).stdout
    runs = json.loads(out)["benchmarks"]
    return next(r["cpu_time"] for r in runs if r["name"].endswith("_median")) / 1e3


def main():
    root = pathlib.Path(__file__).resolve().parent.parent
    build = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else root / "build" / "test"
    program = build / "bench" / "identification_bench"
    if not program.exists():
        sys.exit(f"bench/spectra_scipy.py: no {program}; build with -DHYDRAPOD_BUILD_BENCH=ON")
    ours = hydrapod_seconds(program)
    theirs = sorted(scipy_seconds() for _ in range(REPETITIONS))[REPETITIONS // 2]
    print(f"SciPy {scipy.__version__} csd over {CHANNELS * (CHANNELS + 1) // 2} pairs: {theirs:.3f} s")
    print(f"hydrapod, spectra, responses, coherences and variances: {ours:.4f} s")
    print(f"ratio: {theirs / ours:.1f}")


main()
