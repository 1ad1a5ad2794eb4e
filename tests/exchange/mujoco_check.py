#!/usr/bin/env python3
"""MJCF files of `hydrapod export` in MuJoCo (Debian's library, by ctypes): rest, frequencies, free motion.

usage: mujoco_check.py PROGRAM MODELS ARRAYS     (the shared object of mujoco_arrays.c)

Stiffness: differences of fourth order of its generalised force along the constraint manifold. What is compared with:
M and K of `export --to mtx`, A of `export --to npz`.
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

library = ctypes.CDLL(os.path.abspath(sys.argv[3]))  # MuJoCo's own functions are found through it
pointer = ctypes.c_void_p
library.mj_loadXML.restype = library.mj_makeData.restype = pointer
for function in ("mj_makeData", "mj_deleteData", "mj_deleteModel", "mj_step", "sizes", "place", "positions",
                 "mass", "force", "constraints"):
    getattr(library, function).argtypes = [pointer] * 4


class Loaded:
    def __init__(self, xml):
        path = os.path.join(folder.name, "m.xml")
        with open(path, "w") as file:
            file.write(xml)
        error = ctypes.create_string_buffer(1000)
        self.model = library.mj_loadXML(path.encode(), None, error, len(error))
        if not self.model or error.value:
            raise SystemExit("MuJoCo: " + error.value.decode())
        self.data = library.mj_makeData(self.model, None, None, None)
        self.nv = self.sizes()[1]

    def __del__(self):
        library.mj_deleteData(self.data, None, None, None)
        library.mj_deleteModel(self.model, None, None, None)

    def _filled(self, function, *shapes):
        arrays = [np.zeros(shape) for shape in shapes]
        function(self.model, self.data, *(x.ctypes.data for x in arrays), *[None] * (2 - len(shapes)))
        return arrays

    def sizes(self):
        counts = (ctypes.c_int * 3)()
        library.sizes(self.model, self.data, counts, None)
        return list(counts)

    def place(self, q, v=None):
        q, v = np.array(q, float), np.zeros(self.nv) if v is None else np.array(v, float)
        library.place(self.model, self.data, q.ctypes.data, v.ctypes.data)

    def step(self):
        library.mj_step(self.model, self.data, None, None)

    def positions(self):
        return self._filled(library.positions, self.sizes()[0])[0]

    def mass(self):
        return self._filled(library.mass, (self.nv, self.nv))[0]

    def force(self):
        return self._filled(library.force, self.nv)[0]

    def constraints(self):
        """Jacobian and gaps."""
        rows = self.sizes()[2]
        transposed, gaps = self._filled(library.constraints, (self.nv, rows), rows)
        return transposed.T, gaps


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


class Manifold:
    """Loops are closed by two hinges at the base and the slide of each leg."""

    def __init__(self, xml):
        self.at = at = Loaded(xml)
        self.q0, self.nv = at.positions(), at.nv
        at.place(self.q0)
        per_leg = (at.nv - 6) // 6
        self.dependent = [6 + leg * per_leg + k for leg in range(6) for k in range(3)]
        self.free = [i for i in range(at.nv) if i not in self.dependent]
        self.N0 = self.allowed(at.constraints()[0])
        self.M = self.N0.T @ at.mass() @ self.N0
        force = at.force()
        self.unbalanced = np.abs(self.N0.T @ force).max() / max(np.abs(force).max(), 1.0)

    def allowed(self, J):
        N = np.zeros((self.nv, len(self.free)))
        N[self.free, range(len(self.free))] = 1.0
        N[self.dependent] = -np.linalg.solve(J[:, self.dependent], J[:, self.free])
        return N

    def force_after(self, v):
        """Generalised force along the manifold after the motion v of the free coordinates."""
        q = moved(self.q0, v)
        for _ in range(5):  # Newton closes the loops
            self.at.place(q)
            J, gaps = self.at.constraints()
            if np.abs(gaps).max() < 1e-14:
                break
            v = np.zeros(self.nv)
            v[self.dependent] = -np.linalg.solve(J[:, self.dependent], gaps)
            q = moved(q, v)
        return self.allowed(J).T @ self.at.force()

    def stiffness(self, h=1e-3):
        K = []
        for i in self.free:
            unit = np.zeros(self.nv)
            unit[i] = h
            f = [self.force_after(c * unit) for c in (1, -1, 2, -2)]
            K.append((8 * (f[1] - f[0]) - (f[3] - f[2])) / (12 * h))
        return 0.5 * (np.array(K) + np.transpose(K))


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


def alone(xml, sdf):
    """The MJCF with what SDF holds: springs of single joints, which have no inertia of their own."""
    xml = re.sub(r"<fixed .*?</fixed>", "", xml, flags=re.S)
    xml = re.sub(r"armature='[^']*'", "armature='0'", xml)
    number = r"<spring_reference>([^<]*)</spring_reference><spring_stiffness>([^<]*)</spring_stiffness>"
    for leg in range(1, 7):
        for joint, hinges in (("s", ["s"]), ("tilt", ["tilt1", "tilt2"])):
            text = re.search(f"<joint name='leg{leg}_{joint}'.*?</joint>", sdf, flags=re.S)[0]
            for name, (reference, stiffness) in zip(hinges, re.findall(number, text), strict=True):
                xml, found = re.subn(rf"(<joint name='leg{leg}.{name}'[^>]*?) stiffness='[^']*' springref='[^']*'",
                                     rf"\1 stiffness='{stiffness}' springref='{reference}'", xml)
                assert found == 1, name
    return xml


def single_springs(model, *more):
    """What the export of SDF states of its six lowest frequencies."""
    path = os.path.join(folder.name, "alone.sdf")
    stated = subprocess.run([program, "export", model, "--to", "sdf", "-o", path, "--force", "--approximate", *more],
                            capture_output=True, text=True).stdout
    stated = float(re.search(r"six lowest frequencies, computed .*?within ([-+.e\d]+)", stated)[1])
    manifold = Manifold(alone(open(export(model, "mjcf", *more)).read(), open(path).read()))
    stem = export(model, "mtx", *more)[:-4]
    K, M = (scipy.io.mmread(f"{stem}.{k}.mtx").toarray() for k in "KM")
    ours = scipy.linalg.eigh(K, M, eigvals_only=True)[:6]
    theirs = scipy.linalg.eigh(manifold.stiffness(), manifold.M, eigvals_only=True)[:6]
    worst = np.abs(np.sqrt(theirs / ours) - 1).max()
    check(f"{os.path.basename(model)}: springs of single joints lose {worst:.1e}, stated {stated:.1e}",
          abs(stated - worst) / worst, 0.05)


def free_motion(model, *more):
    """A platform that is let go with a small velocity; the linear model by its exponential."""
    xml = open(export(model, "mjcf", *more)).read()
    A = np.load(export(model, "npz", *more))["A"]
    at = Manifold(xml)
    v = np.zeros(at.nv)
    v[:6] = np.array([1.3, -0.7, 0.4, 0.3, 0.5, -0.2]) * 1e-6  # far below where it is nonlinear
    v = at.N0 @ v[at.free]
    run = Loaded(xml)
    run.place(at.q0, v)
    p_PC = np.array([float(x) for x in re.search("<inertial pos='([^']*)' quat", xml)[1].split()])
    step = float(re.search("timestep='([^']*)'", xml)[1])
    n = len(A) // 2
    x = np.zeros(2 * n)
    x[n:n + 3], x[n + 3:n + 6] = v[:3] + np.cross(v[3:6], p_PC), v[3:6]
    power, errors, sizes = scipy.linalg.expm(A * step), [], []
    steps = round(1.0 / step)
    for k in range(1, steps + 1):
        run.step()
        x = power @ x
        if k % (steps // 50) == 0:
            q = run.positions()
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
single_springs(heavy)
single_springs(heavy, "--pose", "x=150 mm, ry=4 deg")
free_motion(published, "--set", "damping.modal_ratio=0")
for number, (path, limit) in enumerate(random_models(50)):
    frequencies(path, limit)
    if number in (0, 20):
        free_motion(path, "--set", "damping.modal_ratio=0")
if failures:
    raise SystemExit("\n".join(["FAILED:", *failures]))
