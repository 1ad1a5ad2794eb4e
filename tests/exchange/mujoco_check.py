#!/usr/bin/env python3
"""MJCF files of `hydrapod export` in MuJoCo (Debian's library, by ctypes): rest, frequencies, free motion.

usage: mujoco_check.py PROGRAM MODELS

MuJoCo's state is set by key frames of the file and read from its printed data, so nothing here depends on
the layout of its structs. Stiffness: differences of fourth order of its generalised force along the
constraint manifold. What is compared with: M and K of `export --to mtx`, A of `export --to npz`.
"""
import ctypes
import os
import random
import re
import subprocess
import sys
import tempfile

import numpy as np
import scipy.io
import scipy.linalg

from random_machines import random_machine

program, models = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
folder = tempfile.TemporaryDirectory()
os.chdir(folder.name)  # MuJoCo writes a log where it runs
failures = []
WITHOUT_GRAVITY, WITH_GRAVITY = 1e-6, 1e-4  # of frequencies; of their squares twice that
MOTION = 1e-4  # of the largest displacement, over 1 s

library = ctypes.CDLL("libmujoco.so")
pointer = ctypes.c_void_p
for function in (library.mj_fwdPosition, library.mj_fwdVelocity, library.mj_step):
    function.argtypes = [pointer, pointer]
library.mj_loadXML.restype = library.mj_makeData.restype = pointer
library.mj_makeData.argtypes = library.mj_deleteData.argtypes = library.mj_deleteModel.argtypes = [pointer]
library.mj_resetDataKeyframe.argtypes = [pointer, pointer, ctypes.c_int]
library.mj_printFormattedData.argtypes = [pointer, pointer, ctypes.c_char_p, ctypes.c_char_p]


class Loaded:
    def __init__(self, xml):
        path = os.path.join(folder.name, "m.xml")
        with open(path, "w") as file:
            file.write(xml)
        error = ctypes.create_string_buffer(1000)
        self.model = library.mj_loadXML(path.encode(), None, error, len(error))
        if not self.model or error.value:
            raise SystemExit("MuJoCo: " + error.value.decode())
        self.data = library.mj_makeData(self.model)

    def __del__(self):
        library.mj_deleteData(self.data)
        library.mj_deleteModel(self.model)

    def arrays(self):
        """Everything in mjData by its name."""
        library.mj_fwdPosition(self.model, self.data)
        library.mj_fwdVelocity(self.model, self.data)
        path = os.path.join(folder.name, "data.txt")
        library.mj_printFormattedData(self.model, self.data, path.encode(), b"% -26.17g")
        found, name = {}, None
        for line in open(path):
            words = line.split()
            if words and re.match("[A-Za-z_]", words[0]) and words[0] not in ("nan", "inf"):
                name, words = words[0], words[1:]
                found[name] = []
            if name and words:
                found[name].append(words)
        return found


def numbers(arrays, name):
    return np.array([[float(x) for x in row] for row in arrays[name] if re.match("[-0-9.]|nan", row[0])])


def moved(q, v):
    """q after the small motion v, rotation of the platform in its own axes."""
    r = q.copy()
    r[:3] += v[:3]
    r[7:] += v[6:]
    angle = np.linalg.norm(v[3:6])
    if angle > 0:
        w, u, s, x = np.cos(angle / 2), np.sin(angle / 2) * v[3:6] / angle, q[3], q[4:7]
        r[3] = s * w - x @ u
        r[4:7] = s * u + w * x + np.cross(x, u)
    return r


def joined(values):
    return " ".join(repr(float(x)) for x in values)


class Manifold:
    """Loops are closed by two hinges at the base and the slide of each leg."""

    def __init__(self, xml):
        self.xml = xml
        rest = Loaded(xml).arrays()
        self.q0, nv = numbers(rest, "QPOS").ravel(), len(numbers(rest, "QVEL"))
        per_leg = (nv - 6) // 6
        self.nv = nv
        self.dependent = [6 + leg * per_leg + k for leg in range(6) for k in range(3)]
        self.free = [i for i in range(nv) if i not in self.dependent]
        M = np.tril(numbers(rest, "QM"))
        self.N0 = self.allowed(numbers(rest, "EFC_J"))
        self.M = self.N0.T @ (M + M.T - np.diag(np.diag(M))) @ self.N0
        force = self.force(rest)
        self.unbalanced = np.abs(self.N0.T @ force).max() / max(np.abs(force).max(), 1.0)

    @staticmethod
    def force(arrays):
        return (numbers(arrays, "QFRC_PASSIVE") - numbers(arrays, "QFRC_BIAS")).ravel()

    def allowed(self, J):
        N = np.zeros((self.nv, len(self.free)))
        N[self.free, range(len(self.free))] = 1.0
        N[self.dependent] = -np.linalg.solve(J[:, self.dependent], J[:, self.free])
        return N

    def stiffness(self, h=1e-3):
        places = []
        for i in self.free:
            for c in (1, -1, 2, -2):
                v = np.zeros(self.nv)
                v[i] = c * h
                places.append(moved(self.q0, v))
        for _ in range(5):  # Newton closes the loops
            keys = "".join(f"<key qpos='{joined(q)}'/>" for q in places)
            at = Loaded(self.xml.replace("</mujoco>", f"<keyframe>{keys}</keyframe></mujoco>"))
            forces, gap = [], 0.0
            for k in range(len(places)):
                library.mj_resetDataKeyframe(at.model, at.data, k)
                arrays = at.arrays()
                J, error = numbers(arrays, "EFC_J"), numbers(arrays, "EFC_POS").ravel()
                forces.append(self.allowed(J).T @ self.force(arrays))
                v = np.zeros(self.nv)
                v[self.dependent] = -np.linalg.solve(J[:, self.dependent], error)
                places[k] = moved(places[k], v)
                gap = max(gap, np.abs(error).max())
            if gap < 1e-14:
                break
        f = np.array(forces).reshape(len(self.free), 4, -1)
        K = -(8 * (f[:, 0] - f[:, 1]) - (f[:, 2] - f[:, 3])) / (12 * h)
        return 0.5 * (K + K.T)


def export(model, to, *more):
    path = os.path.join(folder.name, "out." + to)
    done = subprocess.run([program, "export", model, "--to", to, "-o", path, "--force", *more],
                          capture_output=True, text=True)
    if done.returncode != 0:
        raise SystemExit(f"{model} {more}: {done.stderr}")
    return path


def check(what, error, limit):
    print(f"{what}: {error:.2e} (limit {limit:.0e})")
    if not error <= limit:
        failures.append(what)


def frequencies(model, limit, *more):
    what = " ".join([os.path.basename(model), *more])
    manifold = Manifold(open(export(model, "mjcf", *more)).read())
    check(what + ": unbalanced force", manifold.unbalanced, 1e-9)
    stem = export(model, "mtx", *more)[:-4]
    K, M = (scipy.io.mmread(f"{stem}.{k}.mtx").toarray() for k in "KM")
    ours = scipy.linalg.eigh(K, M, eigvals_only=True)
    theirs = scipy.linalg.eigh(manifold.stiffness(), manifold.M, eigvals_only=True)
    check(what + ": squares of frequencies", np.abs(theirs / ours - 1).max(), 2 * limit)


def free_motion(model, *more):
    """A platform that is let go with a small velocity; the linear model by its exponential."""
    xml = open(export(model, "mjcf", *more)).read()
    A = np.load(export(model, "npz", *more))["A"]
    at = Manifold(xml)
    v = np.zeros(at.nv)
    v[:6] = np.array([1.3, -0.7, 0.4, 0.3, 0.5, -0.2]) * 1e-6  # far below where it is nonlinear
    v = at.N0 @ v[at.free]
    key = f"<keyframe><key qpos='{joined(at.q0)}' qvel='{joined(v)}'/></keyframe></mujoco>"
    run = Loaded(xml.replace("</mujoco>", key))
    library.mj_resetDataKeyframe(run.model, run.data, 0)
    p_PC = np.array([float(x) for x in re.search("<inertial pos='([^']*)' quat", xml)[1].split()])
    step = float(re.search("timestep='([^']*)'", xml)[1])
    n = len(A) // 2
    x = np.zeros(2 * n)
    x[n:n + 3], x[n + 3:n + 6] = v[:3] + np.cross(v[3:6], p_PC), v[3:6]
    power, errors, sizes = scipy.linalg.expm(A * step), [], []
    steps = round(1.0 / step)
    for k in range(1, steps + 1):
        library.mj_step(run.model, run.data)
        x = power @ x
        if k % (steps // 50) == 0:
            q = numbers(run.arrays(), "QPOS").ravel()
            turn = 2 * np.sign(q[3]) * q[4:7]
            errors.append(np.abs(q[:3] - at.q0[:3] + np.cross(turn, p_PC) - x[:3]).max())
            sizes.append(np.abs(x[:3]).max())
    check(f"{os.path.basename(model)}: free motion over 1 s", max(errors) / max(sizes), MOTION)


def random_models(count):
    """Half of them without gravity; those that cannot stand under it are drawn anew."""
    generator, made, tries = random.Random(712), 0, 0
    while made < count:
        gravity = made % 2 == 1
        path = os.path.join(folder.name, f"random{made}.toml")
        with open(path, "w") as file:
            file.write(random_machine(generator, gravity))
        tries += 1
        stands = subprocess.run([program, "modes", path], capture_output=True, text=True)
        if stands.returncode != 0:
            if not gravity or "equilibrium" not in stands.stderr or tries > 2 * count:
                raise SystemExit(f"random machine {made}: {stands.stderr}")
            continue
        made += 1
        yield path, WITH_GRAVITY if gravity else WITHOUT_GRAVITY


heavy = os.path.join(models, "heavy-platform.toml")
published = os.path.join(models, "zhang-jiang-2021.toml")
generator = random.Random(20261125)


def pose():
    u = generator.uniform
    return (f"x={u(-20, 20):.3f} mm, y={u(-20, 20):.3f} mm, z={u(-10, 10):.3f} mm, rx={u(-2, 2):.3f} deg, "
            f"ry={u(-2, 2):.3f} deg, rz={u(-3, 3):.3f} deg")


def random_legs():
    """Legs and platform that are not those of the file; stiff enough to stand."""
    u = generator.uniform
    return ["--set", f"legs.guide_sleeve.stiffness={u(3e6, 3e7):.6g}", "--set", f"legs.rod.mass={u(20, 60):.6g}",
            "--set", f"platform.mass={u(4e3, 1.5e4):.6g}"]


frequencies(published, WITHOUT_GRAVITY)
frequencies(published, WITHOUT_GRAVITY, "--model", "rigid", "--pose", pose())
for _ in range(3):
    frequencies(published, WITHOUT_GRAVITY, "--pose", pose())
    frequencies(heavy, WITH_GRAVITY, "--pose", pose(), *random_legs())
frequencies(heavy, WITH_GRAVITY)
frequencies(heavy, WITH_GRAVITY, "--set", "legs.guide_sleeve.gap=0.0002")  # the rods lie on their guide rings
frequencies(heavy, WITH_GRAVITY, "--model", "full", "--set", "legs.piston_ring.stiffness=3.1e7", "--pose", pose(),
            *random_legs())
free_motion(published, "--set", "damping.modal_ratio=0")
for number, (path, limit) in enumerate(random_models(50)):
    frequencies(path, limit)
    if number in (0, 20):
        free_motion(path, "--set", "damping.modal_ratio=0")
if failures:
    raise SystemExit("\n".join(["FAILED:", *failures]))
