#!/usr/bin/env python3
"""What a record identifies: the best linear approximation of the machine at the level of the record.

For each level of white noise, records with several seeds are made and identified. Prints Markdown: per
direction the mean difference to the exact poles of small motions with its standard error, and how many
95 % intervals contain the exact pole, and the mean of the other seeds at the same level.

    examples/zhang-jiang-2021/best-linear-approximation.py [SEEDS] [SECONDS]
"""
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile

here = pathlib.Path(__file__).resolve().parent
program = os.environ.get("HYDRAPOD", str(here.parent.parent / "hydrapod"))
machine = here.parent.parent / "models" / "zhang-jiang-2021.toml"
seeds = int(sys.argv[1]) if len(sys.argv) > 1 else 6
seconds = int(sys.argv[2]) if len(sys.argv) > 2 else 600
levels = [0.05, 0.1, 0.2, 0.4]  # mm, and mrad
directions = ["x", "y", "z", "rx", "ry", "rz"]


def run(*arguments):
    return json.loads(subprocess.run([program, *map(str, arguments), "--format", "json"], check=True,
                                     capture_output=True, text=True).stdout)


def main_direction(mode):
    gyration = 0.23  # m, of the platform: angles beside lengths
    size = [abs(value) * (1.0 if k < 3 else gyration) for k, value in enumerate(mode["displacement_shape"]["re"])]
    return directions[size.index(max(size))]


def strong_modes(modes):
    """The mode of each direction with the largest significance."""
    best = {}
    for mode in modes:
        direction = main_direction(mode)
        if direction not in best or mode["significance"] > best[direction]["significance"]:
            best[direction] = mode
    return best


def exact_poles():
    """Per direction the lightly damped pole in which the platform takes part most."""
    best = {}
    for pole in run("modes", machine, "--open-loop")["poles"]:
        if not 1.0 < pole["frequency_hz"] < 100.0 or pole["damping_ratio"] > 0.3:
            continue
        for direction in directions:
            share = pole["participation"]["platform " + direction]
            if share > best.get(direction, (0.0, None))[0]:
                best[direction] = (share, pole)
    return {direction: pole for direction, (_, pole) in best.items()}


def identified(level, seed, folder):
    record = pathlib.Path(folder) / "run.h5"
    subprocess.run([program, "rig", machine, "--duration", str(seconds), "--seed", str(seed), "--excite",
                    f"white all={level} mm", "-o", record, "--force"], check=True, capture_output=True)
    return strong_modes(run("identify", record)["modes"])


def row(level, direction, key, interval, exact, found):
    values = [one[direction][key] for one in found if direction in one]
    half = [one[direction][interval] for one in found if direction in one]
    n = len(values)
    mean = sum(values) / n
    spread = math.sqrt(sum((v - mean) ** 2 for v in values) / (n - 1))
    of_pole = sum(abs(v - exact) <= h for v, h in zip(values, half))
    # the mean of the others scatters too
    others = [(n * mean - v) / (n - 1) for v in values]
    of_mean = sum(abs(v - o) <= h * math.sqrt(1 + 1 / (n - 1)) for v, o, h in zip(values, others, half))
    return (mean / exact - 1, spread / math.sqrt(n) / exact, of_pole, of_mean, n)


def main():
    exact = exact_poles()
    print("| level | quantity | " + " | ".join(directions) + " | intervals with the exact pole | "
          "with the mean of the other seeds |")
    print("| ---: | --- |" + " ---: |" * len(directions) + " --- | --- |")
    with tempfile.TemporaryDirectory() as folder:
        for level in levels:
            found = [identified(level, seed, folder) for seed in range(1, seeds + 1)]
            for key, interval, name in (("frequency_hz", "frequency_95_hz", "frequency"),
                                        ("damping_ratio", "damping_95", "damping ratio")):
                cells, pole, mean, count = [], 0, 0, 0
                for direction in directions:
                    off, error, of_pole, of_mean, n = row(level, direction, key, interval,
                                                          exact[direction][key], found)
                    cells.append(f"{100 * off:+.3f} ± {100 * error:.3f} %")
                    pole, mean, count = pole + of_pole, mean + of_mean, count + n
                print(f"| {level} mm | {name} | " + " | ".join(cells) +
                      f" | {pole} of {count} | {mean} of {count} |", flush=True)


if __name__ == "__main__":
    main()
