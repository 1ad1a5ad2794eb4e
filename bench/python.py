#!/usr/bin/python3
"""Compares the Python package with C++, with the command line, and with NumPy and SciPy; prints Markdown tables.

Usage: bench/python.py [BUILD] [--designs N]     (default build/test, 200000 designs; needs python3-scipy)

Overheads are differences of the fastest blocks of calls, from Python and in C++ in turn, in processor time of one
thread: other programs make blocks slower only. The other rows are wall time, medians of five. SciPy has one thread, as
hydrapod has in the row of 18 modes and in the last one; other responses take all processors.
"""

import argparse
import os
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile
import time

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[variable] = "1"
root = pathlib.Path(__file__).resolve().parent.parent
parser = argparse.ArgumentParser()
parser.add_argument("build", nargs="?", default=str(root / "build" / "test"))
parser.add_argument("--designs", type=int, default=200000)
asked = parser.parse_args()
sys.path.insert(0, str(pathlib.Path(asked.build) / "python"))

import numpy as np  # noqa: E402
import scipy  # noqa: E402
import scipy.linalg  # noqa: E402
import scipy.signal  # noqa: E402

import hydrapod  # noqa: E402

sleeve = "legs.guide_sleeve.stiffness"


def seconds(call, repetitions=5, clock=time.perf_counter):
    times = []
    for _ in range(repetitions):
        begun = clock()
        call()
        times.append(clock() - begun)
    return statistics.median(times)


def overhead(machine, task, call, count=400, rounds=41):
    """Processor time [s] of one call from Python and in C++."""
    outside, inside = [], []
    for _ in range(rounds):
        begun = time.thread_time()
        for _ in range(count):
            call()
        outside.append((time.thread_time() - begun) / count)
        inside.append(hydrapod._core.seconds_of_calls(machine._core_machine, task, sleeve, count))
    return min(outside), min(inside)


def row(what, ours, other, against, factor):
    print(f"| {what} | {ours} | {other} | {against} | {factor} |")


def unit(value):
    for scale, name in ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs")):
        if value >= scale:
            return f"{value / scale:.3g} {name}"
    return f"{value * 1e9:.3g} ns"


def rows_of_overhead(machine):
    stiffness = machine[sleeve]
    for task, call in (("modes", lambda: hydrapod.modes(machine)),
                       ("frequencies", lambda: hydrapod.frequencies(machine, {sleeve: stiffness}))):
        outside, inside = overhead(machine, task, call)
        row(f"`{task}` of one design", unit(outside), unit(inside), "the same in C++",
            f"{(outside - inside) * 1e6:+.2f} µs")


def rows_of_designs(machine):
    values = machine[sleeve] * np.random.default_rng(1).uniform(0.9, 1.1, asked.designs)
    ours = seconds(lambda: hydrapod.frequencies(machine, {sleeve: values}), 3)
    program = pathlib.Path(asked.build) / "apps" / "hydrapod" / "hydrapod"
    with tempfile.TemporaryDirectory() as folder:
        said = subprocess.run(
            [program, "montecarlo", machine.path, "--vary", f"{sleeve}=uniform ± 10 %", "--samples",
             str(asked.designs), "--results", folder + "/rows.h5"], check=True, capture_output=True, text=True).stderr
    theirs = float(re.search(r"rows in ([0-9.e+-]+) s", said).group(1))
    row(f"{asked.designs} designs, `frequencies`", unit(ours), unit(theirs), "`hydrapod montecarlo`, its rows alone",
        f"{theirs / ours:.2f}")
    study = seconds(lambda: hydrapod.montecarlo(machine, {sleeve: "uniform ± 10 %"}, samples=asked.designs), 1)
    row(f"{asked.designs} designs, `montecarlo` with file and summary", unit(study), unit(theirs),
        "`hydrapod montecarlo`, its rows alone", f"{theirs / study:.2f}")


def rows_of_scipy(machine):
    values = machine[sleeve] * np.linspace(0.9, 1.1, 2000)
    ours = seconds(lambda: hydrapod.frequencies(machine, {sleeve: values}, threads=1)) / len(values)
    found = hydrapod.modes(machine)
    M, K = np.array(found.M), np.array(found.K)
    theirs = seconds(lambda: [scipy.linalg.eigh(K, M) for _ in range(200)]) / 200
    row("18 modes of a design, assembly included", unit(ours), unit(theirs),
        "`scipy.linalg.eigh(K, M)`, solver alone", f"{theirs / ours:.1f}")
    samples = np.random.default_rng(5).standard_normal((2**17, 12))
    names = [f"u{k}" for k in range(6)] + [f"a{k}" for k in range(6)]
    record = hydrapod.Record(samples, 1000.0, names, units=["N"] * 6 + ["m/s^2"] * 6,
                             roles=["excitation"] * 6 + ["response"] * 6)
    ours = seconds(lambda: hydrapod.frf(record, estimator="h1", block=4096))

    def spectra():
        for i in range(12):
            for j in range(i + 1):
                scipy.signal.csd(samples[:, i], samples[:, j], nperseg=4096)

    theirs = seconds(spectra)
    row("6×6 responses with coherence and variance, 131072 samples", unit(ours), unit(theirs),
        "`scipy.signal.csd` over all 78 pairs, spectra alone", f"{theirs / ours:.1f}")
    processors = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(processors)})
    alone = seconds(lambda: hydrapod.frf(record, estimator="h1", block=4096))
    os.sched_setaffinity(0, processors)
    row("the same on one processor", unit(alone), unit(theirs), "the same", f"{theirs / alone:.1f}")


def table_of_plants():
    """Steps of 1 ms, valves moved by sines of 2 Hz to 7 Hz: one by one, per second of processor time, and of 16 plants at
    once on all processors, by the clock."""
    t = np.arange(1000) * 1e-3
    commands = 0.05 * np.stack([np.sin(2 * np.pi * (2 + k) * t + k) for k in range(6)], axis=1)
    print("\n| plant | integrator | largest error | `Plant.step`, per second of a processor | `Plant.run_many` of 16, per second |\n"
          "| --- | --- | ---: | ---: | ---: |")
    for name in ("heavy-platform", "zhang-jiang-2021"):
        machine = hydrapod.read_machine(root / "models" / f"{name}.toml")
        exact = hydrapod.Plant(machine, integrator="adaptive", tolerance=1e-11).run(commands, 1e-3)
        for what, options in (("default", {}), ("`tolerance=1e-5`", {"tolerance": 1e-5}),
                              ("`fixed_step=\"0.1 ms\"`", {"fixed_step": "0.1 ms"}),
                              ("`fixed_step=\"0.5 ms\"`", {"fixed_step": "0.5 ms"})):
            plants = [hydrapod.Plant(machine, **options) for _ in range(16)]
            error = np.abs(plants[0].run(commands, 1e-3) - exact).max() / np.abs(exact).max()

            def one_by_one():
                plants[0].reset()
                for row in commands:
                    plants[0].step(row, 1e-3)

            def together():
                for plant in plants:
                    plant.reset()
                hydrapod.Plant.run_many(plants, commands, 1e-3)

            print(f"| `{name}` | {what} | {error:.0e} | {len(t) / seconds(one_by_one, clock=time.thread_time):.0f} | "
                  f"{len(plants) * len(t) / seconds(together):.0f} |")


def main():
    machine = hydrapod.read_machine(root / "models" / "zhang-jiang-2021.toml")
    print(f"SciPy {scipy.__version__}, NumPy {np.__version__}, {os.cpu_count()} processors\n")
    print("| what | Python package | alternative | | times faster, or difference |\n| --- | ---: | ---: | --- | ---: |")
    rows_of_overhead(machine)
    rows_of_designs(machine)
    rows_of_scipy(machine)
    table_of_plants()


main()
