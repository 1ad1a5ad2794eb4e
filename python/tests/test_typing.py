"""The package is typed: mypy finds nothing, and the stubs are what the extension has."""

import os
import pathlib
import re
import subprocess
import sys

import pytest
from conftest import root

import hydrapod

package = pathlib.Path(hydrapod.__file__).resolve().parent


def mypy(*arguments, cwd=None):
    return subprocess.run([sys.executable, "-m", *arguments], capture_output=True, text=True, cwd=cwd)


def test_mypy(tmp_path):
    pytest.importorskip("mypy")
    done = mypy("mypy", "--strict", "--python-version", "3.11", "--cache-dir", str(tmp_path), str(package))
    assert done.returncode == 0, done.stdout + done.stderr


def test_users_code(tmp_path):
    pytest.importorskip("mypy")
    code = tmp_path / "code.py"
    code.write_text("import hydrapod\nm = hydrapod.read_machine('a.toml')\n"
                    "x: str = hydrapod.modes(m).answer\ny: int = hydrapod.check(m).verdict\n")
    done = mypy("mypy", "--cache-dir", str(tmp_path / "cache"), str(code))
    assert "code.py:4" in done.stdout and "code.py:3" not in done.stdout, done.stdout


def test_stubs_name_what_there_is():
    import ast

    stubs = ast.parse((package / "_core.pyi").read_text())
    stubbed = {node.name: {item.name if isinstance(item, ast.FunctionDef) else item.target.id
                           for item in node.body if isinstance(item, (ast.FunctionDef, ast.AnnAssign))}
               for node in stubs.body if isinstance(node, ast.ClassDef)}
    core = hydrapod._core
    for name, members in stubbed.items():
        there = {m for m in vars(getattr(core, name)) if not m.startswith("_") and not m.startswith("pybind")}
        assert {m for m in members if not m.startswith("_")} == there, name
    classes = {name for name in vars(core) if isinstance(getattr(core, name), type)}
    assert classes == set(stubbed)


def test_everything_has_its_text():
    for name in hydrapod.__all__:
        thing = getattr(hydrapod, name)
        if callable(thing) and not isinstance(thing, type):
            assert thing.__doc__ and len(thing.__doc__) > 40, name


def test_results_say_what_their_attributes_are():
    """help(hydrapod.Modes) tells shapes and units."""
    missing = []
    for name in hydrapod.__all__:
        cls = getattr(hydrapod, name)
        if not isinstance(cls, type):
            continue
        if not cls.__doc__:
            missing.append(name)
        slots = {"path", "warnings"} if cls is hydrapod.Record else {"args"}
        missing += [f"{name}.{attribute}" for attribute in dir(cls) if not attribute.startswith("_")
                    and attribute not in slots and not getattr(cls, attribute).__doc__]
    assert not missing
    assert "(dof, n)" in hydrapod.Modes.shapes.__doc__ and "[N/m" in hydrapod.ModelModes.K.__doc__


def test_tasks_say_their_errors_and_sources():
    for name in ("modes", "modes_at_poses", "system", "root_locus", "bode", "sensitivity", "frequencies", "simulate",
                 "rig", "frf", "identify", "calibrate", "compare", "diagnose", "report", "montecarlo", "sweep",
                 "workspace_map", "design", "export", "machine_state_space", "superelement", "leg_lengths",
                 "leg_jacobian", "forward_kinematics", "static_equilibrium", "sample_signals", "read_machine",
                 "read_record", "show_record", "convert_record", "cut_record", "resample_record", "plot_record",
                 "verify_record", "recover_record", "serve", "packet_layout", "attach", "evaluate"):
        text = getattr(hydrapod, name).__doc__
        pages = re.findall(r"docs/[\w/-]+\.md", text)
        assert "Raises" in text and pages and all((root / page).is_file() for page in pages), name
