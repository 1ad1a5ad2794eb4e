"""Exports of machines that nobody drew: each format holds the machine, or says why it cannot."""

import json
import random
import re
import sys
import xml.etree.ElementTree as ElementTree
import zipfile

import numpy as np
import pytest
import scipy.io

import hydrapod

from conftest import root, sanitized

sys.path.insert(0, str(root / "tests/exchange"))
from random_machines import random_machine  # noqa: E402

NAMES = ["crane", "<a & \"b\">", "it's ]]> --", "Prüfstand 试验台", "two\nlines", "%s {0} $x \\", "-1\n    55"]


def features(generator):
    """Overrides, each with a chance of its own."""
    u = generator.uniform
    chances = [
        {"legs.guide_sleeve.gap": u(1e-4, 2e-3)},
        {"legs.guide_sleeve.elastomer.dynamic_ratio": u(1.3, 3.0), "legs.guide_sleeve.elastomer.loss_factor": u(0.1, 0.3),
         "legs.guide_sleeve.elastomer.frequency": u(5.0, 20.0)},
        {"legs.piston_ring.stiffness": 10.0 ** u(6.0, 8.5)},
        {"legs.gimbal_stiffness": 10.0 ** u(7.0, 9.0)},
        {"legs.added_axial_inertia": u(0.0, 30.0)},
        {"legs.rod.diameter": u(0.03, 0.08), "legs.case.diameter": u(0.1, 0.14), "legs.case.wall": u(0.005, 0.02),
         "legs.bending": "elastic"},
        {f"base.mount.stiffness.{generator.choice(['x', 'z', 'ry'])}": 10.0 ** u(6.0, 9.0)},
        {"base.mount.mass": u(100.0, 3000.0), "base.mount.stiffness.z": 10.0 ** u(7.0, 9.0)},
        {"payload_modes.cabin.frequency": u(5.0, 20.0), "payload_modes.cabin.mass": u(1.0, 20.0)},
        {"damping.modal_ratio": u(0.0, 0.1)},
        {"damping.rayleigh_mass": u(0.0, 1.0)},
        {"damping.rayleigh_stiffness": u(0.0, 1e-4)},
        {"damping.oil": generator.choice(["viscous", "automatic"])},
        {"environment.gravity": [u(-1.0, 1.0), u(-1.0, 1.0), u(-12.0, 0.0)]},
    ]
    chosen = {}
    for some in chances:
        if generator.random() < 0.25:
            chosen.update(some)
    return chosen


def is_finite(text):
    """No number of a text is none."""
    return not re.search(r"(?<![\w.])[-+]?(nan|inf)(?![\w])", text, re.IGNORECASE)


def check_state_space(arrays):
    A, B, C, D = (np.asarray(arrays[name]) for name in "ABCD")
    assert A.shape[0] == A.shape[1] == B.shape[0] == C.shape[1] and D.shape == (C.shape[0], B.shape[1])
    assert all(np.isfinite(x).all() for x in (A, B, C, D))


def check_xml(path):
    text = path.read_text(encoding="utf-8")
    assert is_finite(text)
    return ElementTree.fromstring(text)


def check_fmu(path):
    with zipfile.ZipFile(path) as archive:
        assert archive.testzip() is None
        description = archive.read("modelDescription.xml").decode()
        assert is_finite(description)
        ElementTree.fromstring(description)


def check_universal(path):
    text = path.read_text(encoding="utf-8")
    assert is_finite(text)
    delimiters = [line for line in text.splitlines() if line == "    -1"]
    assert delimiters and len(delimiters) % 2 == 0


def check_matrices(path):
    stem = str(path)[:-4]
    M, K, C = (np.asarray(scipy.io.mmread(f"{stem}.{name}.mtx").todense()) for name in "MKC")
    assert M.shape == K.shape == C.shape and all(np.isfinite(x).all() for x in (M, K, C))
    assert all(np.array_equal(x, x.T) for x in (M, K, C))


checks = {
    "npz": lambda path: check_state_space(np.load(path)),
    "mat": lambda path: check_state_space(scipy.io.loadmat(path)),
    "json": lambda path: check_state_space(json.loads(path.read_text(), parse_constant=pytest.fail)),
    "hdf5": lambda path: None if path.read_bytes()[:8] == b"\x89HDF\r\n\x1a\n" else pytest.fail("no HDF5"),
    "uff": check_universal,
    "unv": check_universal,
    "mtx": check_matrices,
    "dmig": lambda path: None if is_finite(path.read_text(encoding="utf-8")) else pytest.fail("not finite"),
    "mjcf": check_xml,
    "sdf": check_xml,
    "urdf": check_xml,
    "fmu2": check_fmu,
    "fmu3": check_fmu,
}


def options_of(generator, to):
    if to in ("npz", "mat", "json", "hdf5"):
        return generator.choice([{}, {}, {"sample_time": 10.0 ** generator.uniform(-5.0, -1.0)},
                                 {"reduce": generator.randrange(1, 40)}, {"system": "plant"}, {"system": "loop"},
                                 {"system": "loop", "sampled": True}, {"point": [0.3, -0.2, 0.1]}])
    if to in ("mtx", "dmig"):
        return generator.choice([{}, {"free_base": True}, {"leg_modes": generator.randrange(0, 14)},
                                 {"leg_modes": 3, "free_base": True, "point": [0.1, 0.2, -0.3]}])
    if to in ("fmu2", "fmu3"):
        return {"system": generator.choice(["mechanics", "plant", "loop"])}
    return {"approximate": generator.random() < 0.7}


def drawn(generator, heavy):
    """A machine of the random series, or the heavy one with hydraulics and other numbers; where it cannot be: None."""
    overrides = features(generator)
    if generator.random() < 0.4:
        overrides["platform.mass"] = generator.uniform(3e3, 1.5e4)
        text = heavy
    else:
        text = random_machine(generator, gravity=generator.random() < 0.5, damping=repr(generator.uniform(0.0, 0.05)))
    text = re.sub(r'^name = .*$', lambda _: "name = " + json.dumps(generator.choice(NAMES)), text, count=1, flags=re.M)
    try:
        machine = hydrapod.Machine(text, overrides=overrides)
    except hydrapod.InputError:
        return None
    models = ["rigid", "guide", "full"] if "legs.piston_ring.stiffness" in overrides else ["rigid", "guide"]
    try:
        return machine.at(generator.choice(machine.poses)).using(generator.choice(models))
    except (hydrapod.InputError, hydrapod.ComputationError):
        return None


@pytest.mark.parametrize("seed", range(6 if not sanitized else 1))
def test_of_random_machines(tmp_path, seed):
    generator = random.Random(900 + seed)
    heavy = (root / "models/heavy-platform.toml").read_text()
    written, refused, tries = {}, 0, 0
    while sum(written.values()) < 40:
        tries += 1
        assert tries < 400
        machine = drawn(generator, heavy)
        if machine is None:
            continue
        to = generator.choice(sorted(checks))
        path = tmp_path / f"{tries}.{'mtx' if to == 'mtx' else to}"
        try:
            done = hydrapod.export(machine, path, to=to, **options_of(generator, to))
        except (hydrapod.InputError, hydrapod.ComputationError) as error:
            assert len(str(error)) > 20 and not path.exists()
            refused += 1
            continue
        checks[to](path)
        assert done.parity and all(line.what and line.how for line in done.parity)
        assert not any(re.search(r"\b(nan|inf)\b", line.how) for line in done.parity), done.parity
        written[to] = written.get(to, 0) + 1
    assert len(written) >= 8  # of 13 formats
    assert refused < sum(written.values())  # most machines can be held
