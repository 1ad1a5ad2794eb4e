"""What other libraries get: the same system as the machine, in their shapes."""

import types

import numpy as np
import pytest

import hydrapod


def test_scipy_state_space_has_the_response_of_bode(heavy):
    bode = hydrapod.bode(heavy, points=7, from_=1.0, to=20.0)
    for of in (hydrapod.modes(heavy),
               hydrapod.machine_state_space(heavy, inputs=[f"wrench.{name}" for name in ("fx", "fy", "fz", "mx", "my", "mz")],
                                            outputs=["x", "y", "z", "rx", "ry", "rz"])):
        system = hydrapod.state_space(of)
        for k, omega in enumerate(bode.omega):
            H = system.C @ np.linalg.solve(1j * omega * np.eye(len(system.A)) - system.A, system.B) + system.D
            np.testing.assert_allclose(H[:6, :6], bode.H[k], atol=1e-7 * np.abs(bode.H[k]).max())


def test_discrete_time(heavy):
    continuous = hydrapod.machine_state_space(heavy)
    held = hydrapod.machine_state_space(heavy, sample_time="1 ms")
    system = hydrapod.state_space(held)
    assert system.dt == 1e-3 == held.sample_time
    from scipy.linalg import expm

    np.testing.assert_allclose(held.A, expm(1e-3 * continuous.A), atol=1e-9 * np.abs(held.A).max())


def test_control(heavy, monkeypatch):
    """python-control where it is there; else what ss() would be called with."""
    linear = hydrapod.machine_state_space(heavy, sample_time=1e-3)
    try:
        import control  # noqa: F401
    except ImportError:
        seen = []
        fake = types.ModuleType("control")
        fake.ss = lambda *arguments: seen.append(arguments) or "system"
        monkeypatch.setitem(__import__("sys").modules, "control", fake)
        assert hydrapod.to_control(linear) == "system"
        (arguments,) = seen
        for given, matrix in zip(arguments, (linear.A, linear.B, linear.C, linear.D)):
            np.testing.assert_array_equal(given, matrix)
        assert arguments[4] == 1e-3
        return
    np.testing.assert_array_equal(hydrapod.to_control(linear).A, linear.A)


def test_superelement_with_all_modes_has_the_machines_frequencies(heavy):
    element = hydrapod.superelement(heavy)
    assert element.first_left_out == 0.0 and element.M.shape == (len(element.coordinates),) * 2
    squares = np.sort(np.linalg.eigvals(np.linalg.solve(element.M, element.K)).real)
    undamped = hydrapod.frequencies(heavy, {"platform.mass": heavy["platform.mass"]})[0]
    np.testing.assert_allclose(np.sqrt(squares) / (2 * np.pi), undamped, rtol=1e-7)
    assert hydrapod.superelement(heavy, leg_modes=2).M.shape == (8, 8)


def test_a_reduction_keeps_its_bound(heavy):
    def static(system):
        return system.D - system.C @ np.linalg.solve(system.A, system.B)

    whole, small = hydrapod.machine_state_space(heavy), hydrapod.machine_state_space(heavy, reduce=24)
    reduction = small.to_dict()["reduction"]
    assert small.A.shape == (24, 24) and reduction["states_before"] == len(whole.A)
    allowed = reduction["bound"] * np.outer(reduction["output_scales"], reduction["input_scales"])
    assert np.all(np.abs(static(small) - static(whole)) <= allowed)


def test_pyuff_datasets(heavy, tmp_path):
    """Their fields have what pyuff requires, and the numbers of the results."""
    record = hydrapod.Record(np.arange(12.0).reshape(6, 2), 100.0, ["u", "a"], units=["N", "m/s^2"],
                             directions=["x", "-z"])
    sets = hydrapod.to_pyuff(record)
    assert [s["type"] for s in sets] == [58, 58] and sets[1]["rsp_dir"] == -3 and sets[0]["func_type"] == 1
    np.testing.assert_array_equal(sets[1]["data"], record["a"])
    np.testing.assert_allclose(sets[0]["x"], np.arange(6) / 100.0)
    required = {"type", "func_type", "rsp_node", "rsp_dir", "ref_node", "ref_dir", "data", "x"}
    bode = hydrapod.bode(heavy, points=5)
    functions = hydrapod.to_pyuff(bode)
    assert len(functions) == 36 and all(required <= set(one) for one in functions)
    at = functions[4 * 6 + 0]
    assert (at["rsp_dir"], at["ref_dir"]) == (5, 1)
    np.testing.assert_array_equal(at["data"], bode.H[:, 4, 0])
    modes = hydrapod.modes(heavy)
    for k, one in enumerate(hydrapod.to_pyuff(modes)):
        assert one["type"] == 55 and one["mode_n"] == k + 1
        shape = [one[f"r{d + 1}"][0] for d in range(3)]
        np.testing.assert_array_equal(shape, modes.shapes[:3, k])
        assert len(one["r1"]) == len(one["node_nums"])
    with pytest.raises(TypeError):
        hydrapod.to_pyuff(hydrapod.check(heavy))
    pyuff = pytest.importorskip("pyuff")
    path = str(tmp_path / "a.uff")
    pyuff.UFF(path).write_sets(sets + functions, "overwrite")
    assert len(pyuff.UFF(path).read_sets()) == 38


def test_mjcf_is_a_document_with_six_closures():
    import xml.etree.ElementTree as tree

    from conftest import root

    machine = hydrapod.read_machine(root / "models" / "zhang-jiang-2021-transverse.toml")
    found = hydrapod.multibody_text(machine, "mjcf")
    document = tree.fromstring(found.text)
    assert document.tag == "mujoco" and len(document.findall("./equality/connect")) == 6
    assert {line.held for line in found.parity} <= {"exact", "approximate", "absent"}
    mujoco = pytest.importorskip("mujoco")
    assert hydrapod.to_mujoco(machine).nbody == mujoco.MjModel.from_xml_string(found.text).nbody


def test_xarray():
    record = hydrapod.Record(np.ones((4, 1)), 10.0, ["a"], units=["mm"])
    xarray = pytest.importorskip("xarray")
    array = record.to_xarray()
    assert isinstance(array, xarray.DataArray) and list(array.channel.values) == ["a"]
    assert float(array[0, 0]) == 1e-3


def test_pandas(heavy):
    pandas = pytest.importorskip("pandas")
    study = hydrapod.sweep(heavy, {"platform.mass": [13e3, 14e3]})
    assert isinstance(study.to_pandas(), pandas.DataFrame) and len(study.to_pandas()) == 2
    assert list(hydrapod.modes(heavy).to_pandas().columns) == ["frequency_hz", "damping_ratio", "omega",
                                                               "moves_platform", "label"]


def test_rigid_legs_as_a_state_space(heavy):
    system, bode = hydrapod.state_space(hydrapod.modes(heavy).rigid), hydrapod.bode(heavy, from_=7, to=8, points=2)
    A, B, C = system.A, system.B, system.C
    response = C @ np.linalg.solve(2j * np.pi * bode.frequency_hz[0] * np.eye(len(A)) - A, B)
    np.testing.assert_allclose(response, bode.H_rigid[0], atol=1e-9 * np.abs(bode.H_rigid[0]).max())
