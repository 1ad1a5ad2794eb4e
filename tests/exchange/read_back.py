#!/usr/bin/env python3
"""Files of `hydrapod export`, read back by SciPy, NumPy and readers written from the formats' descriptions.

usage: read_back.py PROGRAM MODELS SDF_CHECK

Poles and responses are compared with `hydrapod modes` and `hydrapod bode`, which compute them from the
matrices of second order and never from A, B, C, D.
"""
import csv
import io
import json
import os
import random
import subprocess
import sys
import tempfile

import numpy as np
import scipy.io
import scipy.linalg

from random_machines import random_machine

program, models, sdf_check = sys.argv[1], sys.argv[2], sys.argv[3]
folder = tempfile.TemporaryDirectory()
failures = []

POLES = 1e-10      # relative to |pole|, of the issue
RESPONSES = 1e-9   # relative to the largest entry at a frequency
DISCRETE = 1e-9    # poles of the discretised system, as those lose digits in exp(A T)
DMIG = 1e-9        # frequencies from numbers of 11 digits


def run(*arguments, code=0):
    done = subprocess.run([program, *arguments], capture_output=True, text=True)
    if done.returncode != code:
        raise SystemExit(f"{arguments}: exit code {done.returncode}, expected {code}\n{done.stdout}{done.stderr}")
    return done


def export(model, to, *more):
    path = os.path.join(folder.name, "out." + to)
    run("export", model, "--to", to, "-o", path, "--force", *more)
    return path


def check(what, error, limit):
    print(f"{what}: {error:.2e} (limit {limit:.0e})")
    if not error <= limit:
        failures.append(what)


def worst_pole(found, expected):
    """Every pole has its own partner: the best pairing, not the nearest for each."""
    from scipy.optimize import linear_sum_assignment
    if len(found) != len(expected):
        failures.append(f"{len(found)} poles for {len(expected)}")
        return np.inf
    scale = np.maximum(np.abs(expected), 1e-3 * np.abs(expected).max())
    cost = np.abs(found[:, None] - expected[None, :]) / scale[None, :]
    return cost[linear_sum_assignment(cost)].max()


def system_poles(model, *more):
    poles = []
    for p in json.loads(run("modes", model, "--format", "json", *more).stdout)["poles"]:
        pole = complex(p["pole"]["re"], p["pole"]["im"])
        poles += [pole, pole.conjugate()] if pole.imag > 0 else [pole]
    return np.array(poles)


def damped_omega(model):
    """|pole| of every mode, ascending."""
    modes = json.loads(run("modes", model, "--format", "json").stdout)["modes"]
    return np.sort([m["omega_rad_s"] for m in modes])


def quadratic_omega(M, K, C):
    """|pole| of M s^2 + C s + K, one of each pair."""
    n = len(M)
    A = np.block([[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(M, K), -np.linalg.solve(M, C)]])
    return np.sort(np.abs(np.linalg.eigvals(A)))[::2]


def bode(model, omega_from, omega_to):
    text = run("bode", model, "--format", "csv", "--points", "40", "--from", f"{omega_from} rad/s",
               "--to", f"{omega_to} rad/s").stdout
    return list(csv.reader(line for line in io.StringIO(text) if not line.startswith("#")))


def response(omega, system):
    n = len(system["A"])
    return system["C"] @ np.linalg.solve(1j * omega * np.eye(n) - system["A"], system["B"]) + system["D"]


def state_space(model):
    name = os.path.basename(model)
    npz = np.load(export(model, "npz"))
    mat = scipy.io.loadmat(export(model, "mat"))
    text = json.load(open(export(model, "json")))
    for k in "ABCD":
        if not (np.array_equal(npz[k], mat[k]) and np.array_equal(npz[k], np.array(text[k]))):
            failures.append(f"{name}: {k} differs between NPZ, MAT and JSON")
    names = [str(x[0]) for x in mat["input_names"].ravel()]
    if names != list(npz["input_names"]) or names[0] != "wrench.fx":
        failures.append(f"{name}: input names {names}")
    n = len(npz["A"]) // 2
    omega, expected = np.sort(np.abs(np.linalg.eigvals(npz["A"])))[::2], damped_omega(model)
    check(f"{name}: frequencies", np.abs(omega / expected - 1).max(), POLES)
    # the wrench's six inputs, the six displacements
    rows = bode(model, 5.0, 400.0)
    worst = 0.0
    for line in np.array(rows[1:], float):
        H = response(line[1], npz)[:6, :6]
        K = (line[2:74:2] + 1j * line[3:74:2]).reshape(6, 6)
        worst = max(worst, np.abs(H - K).max() / np.abs(K).max())
    check(f"{name}: responses against bode", worst, RESPONSES)
    # one millisecond of held inputs: poles are exp(p T)
    T = 1e-3
    held = np.load(export(model, "npz", "--sample-time", "1 ms"))
    p = np.exp(T * np.linalg.eigvals(npz["A"]))
    check(f"{name}: discrete poles", worst_pole(np.linalg.eigvals(held["A"]), p), DISCRETE)
    gain = held["C"] @ np.linalg.solve(np.eye(2 * n) - held["A"], held["B"]) + held["D"]
    static = npz["D"] - npz["C"] @ np.linalg.solve(npz["A"], npz["B"])
    check(f"{name}: static gain, discrete", np.abs((gain - static)[:6]).max() / np.abs(static[:6]).max(), 1e-7)


def actuators(model, *systems, limit=POLES):
    name = os.path.basename(model)
    for system, option in systems:
        npz = np.load(export(model, "npz", "--system", system))
        found = np.linalg.eigvals(npz["A"])
        check(f"{name}: poles of the {system}", worst_pole(found, system_poles(model, option)), limit)
    x = np.load(export(model, "npz", "--system", "loop", "--inputs", "command.x,command_rate.x",
                       "--outputs", "x"))
    rows = [r for r in csv.reader(io.StringIO(run("bode", model, "--input", "command", "--format", "csv",
            "--points", "30", "--from", "1 rad/s", "--to", "300 rad/s").stdout)) if not r[0].startswith("#")]
    worst = 0.0
    for line in np.array(rows[1:], float):
        w = line[1]
        H = (response(w, x) @ np.array([1.0, 1j * w]))[0]
        worst = max(worst, abs(H - complex(line[2], line[3])) / abs(H))
    check(f"{name}: command response", worst, RESPONSES)


def electric_cylinders():
    """A loop of motors and screws; `modes --open-loop` is of motors that turn freely, not of the plant."""
    generator = random.Random(43)
    screw = ("[legs.screw]\nlead = 0.0103\ninertia = 0.0037\ntorque_limit = 400\nspeed_limit = 290\n"
             "viscous_friction = 0.0021\n")
    path = os.path.join(folder.name, "electric.toml")
    for _ in range(100):
        with open(path, "w") as file:
            file.write(random_machine(generator, gravity=True).replace("[legs.oil_spring]\n", screw))
        if subprocess.run([program, "modes", path, "--system"], capture_output=True).returncode == 0:
            return actuators(path, ("loop", "--system"), limit=1e-9)
    failures.append("no machine with electric cylinders stands under its weight")


def reduction(model):
    """The error of a balanced reduction against its stated bound, at 400 frequencies about all poles."""
    name = os.path.basename(model)
    for system, orders in (("mechanics", (4, 12, 24)), ("plant", (12, 30)), ("loop", (16, 40))):
        what = ["--system", system]
        if system != "mechanics":
            what += ["--outputs", "x,y,z,rx,ry,rz,leg1.l,leg4.p_cap,az"]
        whole = np.load(export(model, "npz", *what))
        sizes = np.abs(np.linalg.eigvals(whole["A"]))
        omegas = np.geomspace(0.05 * sizes[sizes > 0].min(), 5 * sizes.max(), 400)
        full = [response(w, whole) for w in omegas]
        bounds = []
        for order in orders:
            small = np.load(export(model, "npz", *what, "--reduce", str(order)))
            text = json.load(open(export(model, "json", *what, "--reduce", str(order))))["reduction"]
            allowed = np.outer(small["reduction_output_scales"], small["reduction_input_scales"])
            bound = float(small["reduction_bound"])
            error = max((np.abs(H - response(w, small)) / allowed).max() for w, H in zip(omegas, full))
            check(f"{name}: {system} with {order} of {len(whole['A'])} states, error against its bound",
                  error / bound, 1.0)
            unstable = [np.sort_complex(p[p.real >= 0]) for p in map(np.linalg.eigvals, (small["A"], whole["A"]))]
            if len(small["A"]) != order or len(unstable[0]) != len(unstable[1]) or \
                    np.abs(unstable[0] - unstable[1]).max(initial=0.0) > 1e-9 * sizes.max():
                failures.append(f"{name}: reduced {system} has {len(small['A'])} states, unstable {unstable}")
            if text["bound"] != bound or not np.array_equal(small["D"], whole["D"]):
                failures.append(f"{name}: reduction in JSON, or D")
            bounds.append((bound, error))
        if not (bounds[0][0] > bounds[-1][0] and bounds[0][1] > 1e-3 * bounds[0][0]):
            failures.append(f"{name}: bounds of the {system} {bounds}")
    # the Hankel singular values, by SciPy's Gramians
    small = np.load(export(model, "npz", "--reduce", "6"))
    whole = np.load(export(model, "npz"))
    B, C = whole["B"] / small["reduction_input_scales"], whole["C"] / small["reduction_output_scales"][:, None]
    P = scipy.linalg.solve_continuous_lyapunov(whole["A"], -B @ B.T)
    Q = scipy.linalg.solve_continuous_lyapunov(whole["A"].T, -C.T @ C)
    hankel = np.sqrt(np.sort(np.abs(np.linalg.eigvals(P @ Q)))[::-1])
    check(f"{name}: Hankel singular values",
          np.abs(hankel - small["reduction_hankel"]).max() / hankel[0], 1e-7)


def dmig(path):
    """GRID, SPOINT and DMIG entries of a punch file (large field), symmetric form only."""
    matrices, sizes = {}, {}
    place, column, name = {}, None, None

    def index(point, component):
        return place.setdefault((int(point), int(component)), len(place))

    def real(field):
        field = field.strip().upper().replace("D", "E")
        for i in range(len(field) - 1, 0, -1):
            if field[i] in "+-" and field[i - 1] != "E":
                return float(field[:i] + "E" + field[i:])
        return float(field)

    for line in open(path):
        line = line.rstrip("\n")
        if line.startswith("DMIG    "):
            name = line[8:16].strip()
            assert int(line[24:32]) == 6, "form"
            matrices[name] = []
        elif line.startswith("DMIG*"):
            column = index(line[24:40], line[40:56])
        elif line.startswith("*") and column is not None:
            matrices[name].append((index(line[8:24], line[24:40]), column, real(line[40:56])))
    full = {}
    for name, entries in matrices.items():
        A = np.zeros((len(place), len(place)))
        for i, j, value in entries:
            A[i, j] = A[j, i] = value
        full[name] = A
    return full


def superelement(model):
    name = os.path.basename(model)
    path = export(model, "mtx")
    stem = path[:-4]
    M, K, C = (scipy.io.mmread(f"{stem}.{k}.mtx").toarray() for k in "MKC")
    expected = damped_omega(model)
    omega = quadratic_omega(M, K, C)
    check(f"{name}: Matrix Market, all modes kept", np.abs(omega / expected - 1).max(), POLES)
    punched = dmig(export(model, "dmig"))
    omega = quadratic_omega(punched["M2HYD"], punched["K2HYD"], punched["B2HYD"])
    check(f"{name}: DMIG", np.abs(omega / expected - 1).max(), DMIG)
    # the damped response at the interface is that of bode
    worst = 0.0
    for line in np.array(bode(model, 5.0, 400.0)[1:], float):
        w = line[1]
        H = np.linalg.inv(K - w * w * M + 1j * w * C)[:6, :6]
        B = (line[2:74:2] + 1j * line[3:74:2]).reshape(6, 6)
        worst = max(worst, np.abs(H - B).max() / np.abs(B).max())
    check(f"{name}: superelement's response", worst, RESPONSES)
    # two modes kept: static stiffness stays exact, frequencies do not fall
    path = export(model, "mtx", "--leg-modes", "2")
    stem = path[:-4]
    M2, K2 = (scipy.io.mmread(f"{stem}.{k}.mtx").toarray() for k in "MK")
    static = np.linalg.inv(K)[:6, :6]
    check(f"{name}: static compliance, two modes kept",
          np.abs(np.linalg.inv(K2)[:6, :6] - static).max() / np.abs(static).max(), 1e-9)
    reduced = np.sqrt(scipy.linalg.eigh(K2, M2, eigvals_only=True))
    whole = np.sqrt(scipy.linalg.eigh(K, M, eigvals_only=True))
    if not np.all(reduced >= whole[:len(reduced)] * (1 - 1e-12)):
        failures.append(f"{name}: Rayleigh-Ritz bound")


def modal(model):
    """Dataset 55: frequencies and damping of the first two numbers of records 8."""
    name = os.path.basename(model)
    path = export(model, "uff")
    lines = open(path, encoding="utf-8").read().splitlines()
    poles = []
    for i, line in enumerate(lines):
        if line.strip() == "55" and lines[i - 1].strip() == "-1":
            numbers = [float(x) for x in lines[i + 8].split()]
            poles.append(complex(numbers[0], numbers[1]))
    expected = damped_omega(model)
    check(f"{name}: dataset 55", np.abs(np.sort(np.abs(poles)) / expected - 1).max(), 2e-5)


def analyses(model):
    """Dataset 2414, card by card: normal modes whose sum is the response of bode."""
    name = os.path.basename(model)
    datasets, lines = [], None
    for line in open(export(model, "unv"), encoding="utf-8").read().splitlines():
        if line == "    -1":
            if lines:
                datasets.append(lines)
            lines = None if lines is not None else []
        elif lines is not None:
            lines.append(line)
    numbers = [int(d[0]) for d in datasets]
    if not {164, 2411, 2412} <= set(numbers) or 55 in numbers:
        failures.append(f"{name}: datasets {sorted(set(numbers))}")
    rows = bode(model, 5.0, 400.0)
    omega = np.array([float(row[1]) for row in rows[1:]])
    H = np.zeros((len(omega), 6, 6), complex)
    found = []
    for d in (d for d in datasets if int(d[0]) == 2414):
        kind = [int(d[9][10 * k:10 * k + 10]) for k in range(6)]
        if kind != [1, 2, 3, 8, 2, 6] or int(d[3]) != 1:  # structural, normal mode, 6 values, displacement, real, at nodes
            failures.append(f"{name}: record 9 of dataset 2414 is {kind}")
        _, frequency, square, mass, damping, _ = (float(d[12][13 * k:13 * k + 13]) for k in range(6))
        w = 2 * np.pi * frequency
        check(f"{name}: eigenvalue of a mode", abs(square / w ** 2 - 1), 1e-5)
        found.append(w)
        at = next(k for k in range(14, len(d), 2) if int(d[k]) == 1)  # the mass centre
        shape = np.array([float(d[at + 1][13 * k:13 * k + 13]) for k in range(6)])
        H += np.outer(shape, shape) / (mass * (w ** 2 - omega ** 2 + 2j * damping * w * omega))[:, None, None]
    check(f"{name}: dataset 2414", np.abs(np.sort(found) / damped_omega(model) - 1).max(), 2e-5)
    table = np.array([[float(x) for x in row] for row in rows[1:]])
    B = (table[:, 2:74:2] + 1j * table[:, 3:74:2]).reshape(-1, 6, 6)
    size = np.sqrt(np.abs(np.einsum("kii->ki", B)).max(axis=0))
    check(f"{name}: sum of the modes of dataset 2414", (np.abs(H - B) / np.outer(size, size)).max(), 2e-4)


def free_base(model):
    """Nothing holds it; with the base held it is the machine."""
    name = os.path.basename(model)
    for to in ("mtx", "dmig"):
        path = export(model, to, "--free-base")
        if to == "mtx":
            M, K, C = (scipy.io.mmread(f"{path[:-4]}.{k}.mtx").toarray() for k in "MKC")
        else:
            punched = dmig(path)
            M, K, C = punched["M2HYD"], punched["K2HYD"], punched["B2HYD"]
        squares = scipy.linalg.eigh(K, M, eigvals_only=True)
        check(f"{name}: {to}, six rigid modes", np.abs(squares[:6]).max() / squares[-1], 1e-12)
        held = np.ix_(*2 * [[i for i in range(len(M)) if not 6 <= i < 12]])
        omega = quadratic_omega(M[held], K[held], C[held])
        check(f"{name}: {to}, base held", np.abs(omega / damped_omega(model) - 1).max(), 1e-11)


def refusals(model):
    for arguments, words in (
            (["--to", "npy", "-o", "x.npy"], ["--to", "npz"]),
            (["--to", "mat", "-o", "/nowhere/x.mat"], ["/nowhere"]),
            (["--to", "mat", "-o", "-"], ["give it a name"]),
            (["--to", "dmig", "--system", "loop", "-o", "x.pch"], ["--system loop", "state spaces"]),
            (["--to", "dmig", "--leg-modes", "99", "-o", os.path.join(folder.name, "x.pch")], ["--leg-modes 99", "12 modes"]),
            (["--to", "npz", "--outputs", "z,qq", "-o", "x.npz"], ["--outputs qq"]),
            (["--to", "npz", "--reduce", "999", "-o", os.path.join(folder.name, "x.npz")], ["--reduce 999", "36 states"]),
            (["--to", "npz", "--reduce", "4", "--set", "damping.modal_ratio=0", "--set", "legs.oil_spring.damping=0",
              "--set", "legs.guide_sleeve.damping=0", "-o", os.path.join(folder.name, "x.npz")],
             ["--reduce 4", "poles that are not in the left half-plane"]),
            (["--to", "npz", "--reduce", "4", "--system", "loop", "--sampled", "-o", "x.npz"], ["leave --sampled out"]),
            (["--to", "mjcf", "--reduce", "4", "-o", "x.xml"], ["--reduce", "state spaces"]),
            (["--to", "fmu2", "--inputs", "x", "-o", "x.fmu"], ["--inputs"]),
            (["--to", "unv", "--free-base", "-o", "x.unv"], ["--free-base", "superelements"]),
            (["--to", "mjcf", "--point", "0,0,1", "-o", "x.xml"], ["--point 0,0,1", "with --to mjcf", "superelements"]),
            (["--to", "npz", "--system", "plant", "--point", "0,0,1", "-o", "x.npz"], ["with --system plant"]),
            (["--to", "npz", "--pade", "3", "-o", "x.npz"], ["--pade 3", "--system loop"]),
            (["--to", "npz", "--sample-time=-1", "-o", "x.npz"], ["--sample-time"])):
        err = run("export", model, *arguments, code=2).stderr
        for word in words:
            if word not in err:
                failures.append(f"{arguments}: '{word}' is not in: {err}")
    wrong = run("export", model, "--to", "sdf", "--set", "damping.rayleigh_mass=0.3",
                "-o", os.path.join(folder.name, "x.sdf"), code=2).stderr
    if "--approximate" not in wrong:
        failures.append("absent: " + wrong)


def urdf(model):
    path = export(model, "urdf", "--approximate")
    done = subprocess.run(["check_urdf", path], capture_output=True, text=True)
    if done.returncode != 0 or done.stderr or "Successfully Parsed" not in done.stdout:
        failures.append("check_urdf: " + done.stdout + done.stderr)
    closures = json.load(open(path[:-5] + ".closures.json"))["closures"]
    if len(closures) != 6:
        failures.append("closures")


def parsed_sdf(path):
    """What sdformat, the parser of Gazebo, finds; it must say nothing."""
    done = subprocess.run([sdf_check, path], capture_output=True, text=True)
    if done.returncode != 0 or done.stderr:
        failures.append(f"sdformat: {done.stderr}")
        return {}
    words = done.stdout.split()
    return {words[i]: float(words[i + 1]) for i in range(0, len(words), 2)}


def sdf(model):
    found = parsed_sdf(export(model, "sdf", "--approximate"))
    expected = {"links": 19, "joints": 24, "axes": 30, "visuals": 13}
    if {key: found.get(key) for key in expected} != expected:
        failures.append(f"SDF of {model}: {found}")
    rigid = parsed_sdf(export(model, "sdf", "--approximate", "--model", "rigid"))
    if rigid.get("links") != 13 or abs(rigid["mass"] / found["mass"] - 1) > 1e-11:
        failures.append(f"SDF of {model}, rigid: {rigid}")


def random_machines(count):
    """Every format of machines that nobody drew by hand."""
    generator = random.Random(42)
    made = 0
    while made < count:
        path = os.path.join(folder.name, "random.toml")
        with open(path, "w") as file:
            text = random_machine(generator, gravity=made % 2 == 1)
            file.write(text.replace('"random"', r'"two\nlines"'))  # in one line of comments and headers
        if subprocess.run([program, "modes", path], capture_output=True).returncode != 0:
            continue  # it does not stand under its weight
        made += 1
        expected = damped_omega(path)
        npz = np.load(export(path, "npz"))
        check(f"random machine {made}: frequencies",
              np.abs(np.sort(np.abs(np.linalg.eigvals(npz["A"])))[::2] / expected - 1).max(), 1e-9)
        stem = export(path, "mtx")[:-4]
        M, K, C = (scipy.io.mmread(f"{stem}.{k}.mtx").toarray() for k in "MKC")
        check(f"random machine {made}: Matrix Market",
              np.abs(quadratic_omega(M, K, C) / expected - 1).max(), 1e-9)
        punched = dmig(export(path, "dmig"))
        check(f"random machine {made}: DMIG", np.abs(quadratic_omega(
            punched["M2HYD"], punched["K2HYD"], punched["B2HYD"]) / expected - 1).max(), 1e-7)
        if parsed_sdf(export(path, "sdf", "--approximate")).get("links") != 19:
            failures.append(f"random machine {made}: SDF")
        urdf(path)
        for to in ("mat", "json", "hdf5", "uff", "unv", "mjcf"):
            export(path, to, "--approximate")


heavy = os.path.join(models, "heavy-platform.toml")
published = os.path.join(models, "zhang-jiang-2021.toml")
for model in (heavy, published):
    state_space(model)
    superelement(model)
    modal(model)
    free_base(model)
    urdf(model)
    sdf(model)
analyses(published)
reduction(heavy)
random_machines(12)
actuators(heavy, ("plant", "--open-loop"), ("loop", "--system"))
electric_cylinders()
refusals(heavy)
if failures:
    raise SystemExit("\n".join(["FAILED:", *failures]))
