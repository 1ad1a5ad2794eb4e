"""Machines: numbers, variants, errors; arrays against what NumPy and SciPy make of them."""

import copy
import json
import pickle

import numpy as np
import pytest
from scipy.linalg import eigh
from conftest import root

import hydrapod

sleeve = "legs.guide_sleeve.stiffness"


def test_numbers_by_path_and_as_attributes(heavy):
    assert heavy["platform.mass"] == heavy.platform.mass == 14000.0 or heavy.platform.mass > 0
    assert heavy.legs.guide_sleeve.stiffness == heavy[sleeve]
    assert heavy.unit(sleeve) == "N/m"
    assert "stiffness" in dir(heavy.legs.guide_sleeve)
    assert sleeve in repr(heavy.legs.guide_sleeve)
    for path in heavy.paths:
        assert np.isfinite(heavy[path])


def test_variants_do_not_change_the_machine(heavy):
    before = heavy[sleeve]
    stiff = heavy.with_(**{sleeve: "20 kN/mm"})
    assert stiff[sleeve] == 20e6 and heavy[sleeve] == before
    assert stiff.with_({sleeve: before})[sleeve] == before
    with pytest.raises(AttributeError, match="with_"):
        heavy.legs = 3
    assert heavy.at("z=10 mm").pose == "z=10 mm"
    assert heavy.using("rigid").model == "rigid"


def test_machines_are_values(heavy):
    for other in (pickle.loads(pickle.dumps(heavy)), copy.copy(heavy), copy.deepcopy(heavy)):
        assert other == heavy and hash(other) == hash(heavy)
    variant = heavy.with_({"platform.mass": "4 t"}).at("z=3 mm")
    again = pickle.loads(pickle.dumps(variant))
    assert again == variant and again != heavy
    assert hydrapod.modes(again).json == hydrapod.modes(variant).json


def test_text_instead_of_a_file(heavy):
    machine = hydrapod.read_machine(heavy.text)
    np.testing.assert_array_equal(hydrapod.modes(machine).frequency_hz, hydrapod.modes(heavy).frequency_hz)
    assert hydrapod.read_machine(hydrapod.starter_machine_file()).name


def test_mistakes_have_places(tmp_path, heavy):
    path = tmp_path / "bad.toml"
    path.write_text(heavy.text.replace("[platform]", "[platform]\nmas = 3\n", 1))
    with pytest.raises(hydrapod.InputError) as caught:
        hydrapod.read_machine(path)
    error = caught.value
    line = path.read_text().splitlines().index("mas = 3") + 1
    assert (error.file, error.line) == (str(path), line)
    assert error.column >= 1 and "mas" in str(error) and error.advice
    assert isinstance(error, ValueError)
    again = pickle.loads(pickle.dumps(error))
    assert again.diagnostics == error.diagnostics and str(again) == str(error)


@pytest.mark.parametrize("wrong", [
    {"platform.mass": "4 N"}, {"platform.mas": 3}, {"platform.mass": -3.7}, {"platform.mass": float("nan")},
    {"platform.mass": float("inf")}, {"platform.mass": ""}, {"": 3}, {"platform.mass": [1, 2]}])
def test_wrong_values_are_refused(heavy, wrong):
    with pytest.raises(hydrapod.InputError):
        heavy.with_(wrong)


def test_what_cannot_be_computed_says_so(heavy):
    crushed = heavy.with_({"platform.mass": "900 t"})
    with pytest.raises(hydrapod.ComputationError):
        hydrapod.system(crushed)


@pytest.mark.parametrize("path", ["no.such.path", "", "platform", "legs.rod.masses"])
def test_unknown_paths(heavy, path):
    with pytest.raises(hydrapod.InputError):
        heavy[path]
    with pytest.raises(AttributeError):
        heavy.nothing_like_this


def test_modes_solve_the_eigenproblem_of_the_matrices(model):
    """SciPy's eigenvalues of K and M are the undamped frequencies; shapes are orthonormal in M."""
    machine = hydrapod.read_machine(model, overrides={"damping.modal_ratio": 0.013})
    found = hydrapod.modes(machine)
    for m in (found.flexible, found.rigid):
        squares = eigh(m.K, m.M, eigvals_only=True)
        undamped = hydrapod.frequencies(machine.using("rigid") if m.M.shape == (6, 6) else machine,
                                        {"platform.mass": machine["platform.mass"]})[0]
        # LAPACK loses some epsilons of the largest of them; they span ten decades at most
        scale = np.finfo(float).eps * squares.max() / np.abs(squares)
        np.testing.assert_allclose((2 * np.pi * undamped) ** 2 / squares, 1.0, atol=1e3 * scale.max() + 1e-10)
        if np.isrealobj(m.shapes):
            np.testing.assert_allclose(m.shapes.T @ m.M @ m.shapes, np.eye(len(squares)), atol=1e-9)


def test_state_space_has_the_poles_of_the_modes(heavy):
    found = hydrapod.modes(heavy)
    poles = np.linalg.eigvals(hydrapod.state_space(found).A)
    for pole in found.poles:  # 36×36 not normalised: a norm of 1e10 at 1e-16 leaves some 1e-6 of ω
        assert np.abs(poles - pole).min() < 1e-5 * abs(pole)


def test_system_is_the_one_that_scipy_sees(heavy):
    found = hydrapod.system(heavy)
    system = hydrapod.state_space(found)
    poles = np.linalg.eigvals(system.A)
    for pole in found.poles[:12]:
        assert np.abs(poles - pole).min() < 1e-4 * max(abs(pole), 1.0)
    assert found.stable == (np.abs(np.linalg.eigvals(found.sampled)).max() < 1.0)


def test_bode_is_the_response_of_the_matrices(heavy):
    found = hydrapod.bode(heavy, points=9, from_=1.1, to=23.0)
    m = hydrapod.modes(heavy)
    damping = m.damping_matrix()
    for k, omega in enumerate(found.omega):
        H = np.linalg.inv(m.K - omega**2 * m.M + 1j * omega * damping)[:6, :6]
        np.testing.assert_allclose(found.H[k], H, atol=1e-8 * np.abs(H).max())


def test_sensitivity_is_the_slope(heavy):
    found = hydrapod.sensitivity(heavy, [sleeve])
    h = 1e-4
    steps = heavy[sleeve] * np.array([1 - h, 1 + h])
    low, high = (np.log(hydrapod.modes(heavy.with_({sleeve: step})).omega) for step in steps)
    slope = (high - low) / (np.log(steps[1]) - np.log(steps[0]))
    single = np.diff(found.omega, prepend=0, append=np.inf)
    apart = (single[:-1] > 0.01 * found.omega) & (single[1:] > 0.01 * found.omega)  # not repeated
    np.testing.assert_allclose(found.percent_per_percent[apart, 0], slope[apart], atol=1e-6)


def test_frequencies_of_designs(heavy):
    stiffness = np.geomspace(0.7e6, 31e6, 7)
    all_at_once = hydrapod.frequencies(heavy, {sleeve: stiffness, "platform.mass": 13750.5})
    for value, row in zip(stiffness, all_at_once):
        machine = heavy.with_({sleeve: value, "platform.mass": 13750.5}).using("guide")
        one = hydrapod.frequencies(machine, {"platform.mass": 13750.5})[0]
        np.testing.assert_allclose(row, one, rtol=1e-11)  # SIMD lanes, under gravity
    assert hydrapod.frequencies(heavy, {sleeve: []}).shape == (0, 18)


def test_results_show_themselves(heavy):
    for result in (hydrapod.modes(heavy), hydrapod.system(heavy), hydrapod.check(heavy),
                   hydrapod.bode(heavy, points=5), hydrapod.sensitivity(heavy, sleeve),
                   hydrapod.root_locus(heavy, "controller.gain", 5, 9, 2),
                   hydrapod.simulate(heavy, until=0.05)):
        assert repr(result).startswith(f"<{type(result).__name__}")
        assert result._repr_html_().startswith("<div>")
        assert json.loads(result.json) == result.to_dict()
    assert hydrapod.modes(heavy).to_records().frequency_hz[0] == hydrapod.modes(heavy).frequency_hz[0]
    for part in (hydrapod.modes(heavy).rigid, hydrapod.superelement(heavy)):
        assert repr(part).startswith(f"<{type(part).__name__}") and part._repr_html_().startswith("<div>")
    assert "Hz" in repr(hydrapod.modes(heavy).rigid)


def test_named_tuples_are_tables_in_notebooks(heavy):
    import xml.etree.ElementTree as tree

    plant = hydrapod.Plant(heavy).linearise()
    for result in (hydrapod.pose_quality(heavy), hydrapod.static_equilibrium(heavy), hydrapod.buckling(heavy), plant,
                   hydrapod.sample_signals("step z=1 mm", duration=0.1)):
        rows = tree.fromstring(result._repr_html_()).findall("table/tbody/tr")
        assert [row.find("th").text for row in rows] == list(result._fields)
        assert all(row.find("td").text for row in rows)
    cells = [row.find("td").text for row in tree.fromstring(plant._repr_html_()).findall("table/tbody/tr")]
    assert cells[0] == " × ".join(map(str, plant.A.shape)) and cells[4].startswith(f"{len(plant.states)}: ")


def test_shapes_are_normalised_as_their_text_says(heavy):
    for found in (hydrapod.modes(heavy), hydrapod.modes(heavy).rigid):
        shapes = found.shapes
        np.testing.assert_allclose(np.einsum("ik,ij,jk->k", shapes.conj(), found.M, shapes), 1.0, atol=1e-12)
        np.testing.assert_allclose(2 * np.pi * found.frequency_hz, np.abs(found.poles), rtol=1e-12)


def test_responses_of_unstable_machines_say_so(heavy):
    """As the command line does."""
    buckled = heavy.with_({"platform.mass": "100 t"})
    assert not hydrapod.modes(buckled).stable
    unstable, sound = hydrapod.bode(buckled, points=5), hydrapod.bode(heavy, points=5)
    assert not unstable.stable and "no steady vibration" in repr(unstable)
    assert sound.stable and "vibration" not in repr(sound)
    assert hydrapod.bode(heavy, input="command", points=5).stable


def test_machines_are_built_from_keyword_arguments(model):
    """As their files say, number by number."""
    tomllib = pytest.importorskip("tomllib")
    machine = hydrapod.read_machine(model)
    built = hydrapod.build_machine(**tomllib.loads(machine.text))
    assert built.paths == machine.paths and all(built[path] == machine[path] for path in machine.paths)
    np.testing.assert_array_equal(hydrapod.modes(built).poles, hydrapod.modes(machine).poles)


def test_what_machines_are_built_from(heavy):
    tomllib = pytest.importorskip("tomllib")
    tables = tomllib.loads(heavy.text)
    tables["platform"] = {**tables["platform"], "mass": np.float32(13e3), "mass_center": np.array([0.0, 0.01, -0.2]),
                          "inertia": {"xx": 9000, "yy": np.int64(9500), "zz": "14 t m^2", "xy": None}}
    built = hydrapod.build_machine(**{**tables, "name": "a \"b\"\n\\ ü", "leg": {3: {"rod": {"mass": "61 kg"}}}})
    assert built.name == "a \"b\"\n\\ ü" and built["leg.3.rod.mass"] == 61.0 != built["leg.2.rod.mass"]
    assert built["platform.mass"] == 13e3 and built["platform.inertia.zz"] == 14e3
    assert list(built.platform.mass_center) == [0.0, 0.01, -0.2]
    with pytest.raises(hydrapod.InputError, match="mas"):
        hydrapod.build_machine(**{**tables, "platform": {"mas": 3}})
    for wrong in (object(), 3j, b"4 t"):
        with pytest.raises(TypeError, match="platform.mass"):
            hydrapod.build_machine(platform={"mass": wrong})
    with pytest.raises(TypeError, match="key"):
        hydrapod.build_machine(platform={None: 3})
    with pytest.raises(ValueError, match="UTF-8"):
        hydrapod.build_machine(name="\udcff")
    with pytest.raises(ValueError, match="UTF-8"):
        hydrapod.Machine("name = '\udcff'")


def test_results_have_pictures_in_notebooks(heavy):
    """Well-formed, and of finite numbers."""
    import xml.etree.ElementTree as tree

    record = hydrapod.Record(np.array([[1.0, np.nan], [2.0, np.nan], [-1.0, np.nan]]), 100.0, ["<a>", "b"])
    pictured = [hydrapod.modes(heavy), hydrapod.bode(heavy, points=700), hydrapod.bode(heavy, input="command", points=9),
                hydrapod.simulate(heavy, "step x=1 mm", until=0.2)]
    for result in [heavy, record, *pictured]:
        page = tree.fromstring(result._repr_html_())
        drawn = page.findall("{http://www.w3.org/2000/svg}svg")
        assert len(drawn) == (result in pictured)
        for path in page.iter("{http://www.w3.org/2000/svg}path"):
            points = np.array(path.get("d").replace("L", " ").replace("M", " ").split(), dtype=float)
            assert 4 <= len(points) <= 2 * 300 and (points >= 0).all() and (points <= 360).all()


def test_sentences_below_a_table_are_lines_of_the_page(heavy):
    """A line end is nothing in HTML."""
    checked = hydrapod.check(heavy)
    below = checked._repr_html_().split("<p>")[1]
    assert "\n" not in below and below.count("<br>") == len(checked.warnings) > 0
