"""Payloads of finite-element programs, Dakota's files, and a function for every command of the program."""

import re

import numpy as np
import pytest
from conftest import call_program, root

import hydrapod


def matrix_market(path, matrix):
    size = len(matrix)
    numbers = "\n".join(repr(float(matrix[i, j])) for j in range(size) for i in range(j, size))
    path.write_text(f"%%MatrixMarket matrix array real symmetric\n{size} {size}\n{numbers}\n")


@pytest.fixture(scope="module")
def structure(tmp_path_factory):
    """Three masses on springs from the platform along x, y and z: fixed at it, they swing at 11, 17 and 29 Hz."""
    folder = tmp_path_factory.mktemp("structure")
    masses, frequencies = np.array([30.0, 20.0, 10.0]), np.array([11.0, 17.0, 29.0])
    K, M = np.zeros((9, 9)), np.zeros((9, 9))
    for k, (mass, frequency) in enumerate(zip(masses, frequencies)):
        stretch = np.zeros(9)
        stretch[6 + k], stretch[k] = 1.0, -1.0
        K += mass * (2 * np.pi * frequency) ** 2 * np.outer(stretch, stretch)
        M[6 + k, 6 + k] = mass
        others = [j for j in range(3) if j != k]  # across its spring a mass moves with the platform
        M[others, others] += mass
    M[3:6, 3:6] = np.diag([0.5, 0.6, 0.7])
    matrix_market(folder / "K.mtx", K)
    matrix_market(folder / "M.mtx", M)
    return folder


def test_attach(heavy, structure, tmp_path):
    theirs = tmp_path / "theirs.toml"
    done = call_program("attach", heavy.path, "--stiffness", structure / "K.mtx", "--mass", structure / "M.mtx", "--at",
                        "0,0,100 mm", "--modes", "2", "--damping-ratio", "3 %", "--add-mass", "-o", theirs)
    assert done.returncode == 0, done.stderr
    found = hydrapod.attach(heavy, structure / "K.mtx", structure / "M.mtx", at=(0, 0, "100 mm"), modes=2,
                            damping_ratio="3 %", add_mass=True, path=tmp_path / "ours.toml")
    assert found.machine.text == theirs.read_text() == (tmp_path / "ours.toml").read_text()
    assert found.machine.path == str(tmp_path / "ours.toml") and found.names == ["mode_1", "mode_2"]
    np.testing.assert_allclose(found.frequency_hz, [11.0, 17.0], rtol=1e-9)
    np.testing.assert_array_equal(found.damping_ratio, [0.03, 0.03])
    np.testing.assert_allclose((found.participation**2).sum(axis=1), [30.0, 20.0], rtol=1e-9)
    assert found.mass == pytest.approx(60.0, rel=1e-9) and found.first_left_out_hz == pytest.approx(29.0, rel=1e-9)
    assert found.machine["platform.mass"] == pytest.approx(heavy["platform.mass"] + 60.0, rel=1e-9)
    modes = hydrapod.modes(found.machine)
    assert modes.coordinates[-2:] == ["payload.mode_1", "payload.mode_2"]
    assert len(modes.frequency_hz) == len(hydrapod.modes(heavy).frequency_hz) + 2


def test_attach_keeps_pose_and_model(heavy, structure):
    found = hydrapod.attach(heavy.at("low").using("rigid"), structure / "K.mtx", structure / "M.mtx")
    assert (found.machine.pose, found.machine.model, found.machine.path) == ("low", "rigid", heavy.path)
    assert len(found.names) == 3 and found.first_left_out_hz == 0.0


@pytest.mark.parametrize("call, error, words", [
    (lambda m, f: hydrapod.attach(m), ValueError, "expected one of"),
    (lambda m, f: hydrapod.attach(m, f / "K.mtx"), ValueError, "mass"),
    (lambda m, f: hydrapod.attach(m, f / "K.mtx", f / "M.mtx", punch=f / "a.pch"), ValueError, "expected one of"),
    (lambda m, f: hydrapod.attach(m, mass=f / "M.mtx", punch=f / "a.pch"), ValueError, "leave them out"),
    (lambda m, f: hydrapod.attach(m, f / "M.mtx", f / "none.mtx"), ValueError, "none.mtx"),
    (lambda m, f: hydrapod.attach(m, uff=f / "K.mtx"), ValueError, "K.mtx"),
    (lambda m, f: hydrapod.attach(m, f / "K.mtx", f / "M.mtx", at=(0, 1)), ValueError, "three lengths"),
    (lambda m, f: hydrapod.attach(m, f / "K.mtx", f / "M.mtx", modes=0), ValueError, "modes"),
    (lambda m, f: hydrapod.attach(m, f / "K.mtx", f / "M.mtx", modes=2.0), TypeError, "modes"),
    (lambda m, f: hydrapod.attach(m, f / "K.mtx", f / "M.mtx", damping_ratio=-0.1), ValueError, "damping_ratio"),
    (lambda m, f: hydrapod.attach(m, f / "K.mtx", f / "M.mtx", add_mass="no"), TypeError, "add_mass"),
    (lambda m, f: hydrapod.attach(m, 3, f / "M.mtx"), TypeError, "path|str"),
    (lambda m, f: hydrapod.attach("m.toml", f / "K.mtx", f / "M.mtx"), TypeError, "Machine")])
def test_wrong_payloads(heavy, structure, call, error, words):
    with pytest.raises(error, match=words):
        call(heavy, structure)


def test_a_payload_is_not_heavier_than_its_platform(heavy, structure):
    with pytest.raises(hydrapod.InputError, match="with add_mass"):
        hydrapod.attach(heavy.with_({"platform.mass": "30 kg"}), structure / "K.mtx", structure / "M.mtx")


parameters_file = """\
                    { DAKOTA_VARS = 2 }
                    { k = 2.3 }
                    { platform.mass = 14100.0 }
                    { DAKOTA_FNS = 2 }
                    { ASV_1:lowest = 3 }
                    { ASV_2:condition = 1 }
                    { DAKOTA_DER_VARS = 2 }
                    { DVV_1:k = 1 }
                    { DVV_2:platform.mass = 2 }
                    { DAKOTA_AN_COMPS = 0 }
                    { DAKOTA_EVAL_ID = 37 }
"""


def test_evaluate(heavy, tmp_path):
    (tmp_path / "params.in").write_text(parameters_file)
    done = call_program("evaluate", "--machine", heavy.path, "--variable", "k=legs.guide_sleeve.stiffness [kN/mm]",
                        tmp_path / "params.in", tmp_path / "theirs.out")
    assert done.returncode == 0, done.stderr
    found = hydrapod.evaluate(heavy, tmp_path / "params.in", tmp_path / "ours.out",
                              variables={"k": "legs.guide_sleeve.stiffness [kN/mm]"})
    assert found.text == (tmp_path / "theirs.out").read_text() == (tmp_path / "ours.out").read_text()
    assert (found.failure, found.id) == ("", "37")
    machine = heavy.with_({"legs.guide_sleeve.stiffness": "2.3 kN/mm", "platform.mass": 14100})
    lowest = float(found.text.split()[0])
    assert lowest == pytest.approx(hydrapod.frequencies(heavy, {
        "legs.guide_sleeve.stiffness": 2.3e6, "platform.mass": 14100.0})[0, 0], rel=1e-9)
    assert machine["legs.guide_sleeve.stiffness"] == pytest.approx(2.3e6)


def test_a_design_without_outputs_fails_as_dakota_wants_it(heavy, tmp_path):
    (tmp_path / "params.in").write_text(parameters_file.replace("14100.0", "-1"))
    found = hydrapod.evaluate(heavy, tmp_path / "params.in", variables={"k": "legs.guide_sleeve.stiffness [kN/mm]"})
    assert "FAIL" in found.text.upper() and found.failure


@pytest.mark.parametrize("options, error, words", [
    ({}, ValueError, "k"), ({"variables": {"k": "no.such"}}, ValueError, "no.such"),
    ({"variables": {"k": "legs.guide_sleeve.stiffness [kg]"}}, ValueError, "kg"),
    ({"variables": {"k": 3}}, TypeError, "variables of k"), ({"variables": ["k"]}, TypeError, "variables"),
    ({"variables": {"k": "legs.guide_sleeve.stiffness"}, "functions": ["lowst", "x"]}, ValueError, "lowest"),
    ({"functions": 3}, TypeError, "functions")])
def test_wrong_evaluations(heavy, tmp_path, options, error, words):
    (tmp_path / "params.in").write_text(parameters_file)
    with pytest.raises(error, match=words):
        hydrapod.evaluate(heavy, tmp_path / "params.in", tmp_path / "results.out", **options)
    assert not (tmp_path / "results.out").exists()
    with pytest.raises(hydrapod.InputError):
        hydrapod.evaluate(heavy, tmp_path / "none.in")


def test_reference_and_starter():
    assert hydrapod.parameter_reference() == call_program("init", "--reference").stdout
    assert hydrapod.starter_machine_file() == call_program("init", "-").stdout


# Commands that are no function of that name. demo writes modes, bode and report of a file in models; studio is a page
# with the program behind it, as a notebook is; help is help().
other_names = {"init": "starter_machine_file", "map": "workspace_map", "record show": "show_record",
               "record convert": "convert_record", "record cut": "cut_record", "record resample": "resample_record",
               "record plot": "plot_record", "record verify": "verify_record", "record recover": "recover_record"}
no_functions = {"demo", "studio", "help", "record"}


def commands_of(*words):
    shown = call_program(*words, "--help").stdout.partition("Subcommands:\n")[2].partition("\n\n")[0]
    return re.findall(r"^  (\w+) ", shown, re.MULTILINE)


def test_every_command_is_a_function():
    commands = commands_of()
    assert len(commands) > 20
    commands += [f"record {name}" for name in commands_of("record")]
    missing = [name for name in commands if name not in no_functions
               and not callable(getattr(hydrapod, other_names.get(name, name), None))]
    assert missing == [] and set(other_names) <= set(commands) and no_functions <= set(commands)
    assert (root / "models" / "zhang-jiang-2021.toml").is_file()
