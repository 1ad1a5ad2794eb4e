"""Studies against what single machines give, and columns of one's own."""

import numpy as np
import pytest

import hydrapod

sleeve = "legs.guide_sleeve.stiffness"


def test_rows_are_those_of_single_machines(heavy):
    study = hydrapod.sweep(heavy, {sleeve: "1:21:3 kN/mm", "platform.mass": [12e3, 14e3]})
    assert study.shape == [3, 2] and len(study) == 6 and study.values.shape == (6, len(study.names))
    for row in range(len(study)):
        machine = study.machine(row)
        assert machine["platform.mass"] == study["platform.mass"][row]
        undamped = hydrapod.frequencies(machine, {"platform.mass": machine["platform.mass"]})[0]
        # the lowest mode that the platform feels is one of the undamped ones, here the first
        assert study["lowest"][row] == pytest.approx(undamped[0], rel=1e-9)


def test_columns_of_ones_own(heavy):
    study = hydrapod.sweep(heavy, {"platform.mass": np.linspace(12e3, 15e3, 4)},
                           outputs={"ratio": lambda m: hydrapod.modes(m).frequency_hz[0] / m["platform.mass"]})
    # |λ| of the damped mode; dampers that are not proportional change it by a per mille
    np.testing.assert_allclose(study["ratio"] * study["platform.mass"], study["lowest"], rtol=5e-3)
    table = study.to_records()
    assert table.dtype.names[-1] == "ratio" and table.ratio[2] == study["ratio"][2]
    with pytest.raises(KeyError, match="ratio"):
        study["no such"]
    own = np.arange(4.0)
    study.add("own", own)
    own[:] = 9.0  # the study has a copy
    np.testing.assert_array_equal(study["own"], np.arange(4.0))
    assert not study["own"].flags.writeable
    with pytest.raises(ValueError):
        study.add("ratio", np.zeros(4))
    with pytest.raises(ValueError):
        study.add("short", np.zeros(3))
    with pytest.raises(ZeroDivisionError):
        study.evaluate(lambda machine: 1 / 0)


def test_map_poses(heavy):
    study = hydrapod.workspace_map(heavy, {"z": [0.0, -0.02], "ry": "0:1:2 deg"})
    machine = study.machine(3)
    lengths = hydrapod.leg_lengths(heavy, [0, 0, -0.02, 0, np.pi / 180, 0])
    np.testing.assert_allclose(hydrapod.leg_lengths(machine), lengths, atol=1e-12)
    assert hydrapod.modes(machine).frequency_hz[0] == pytest.approx(study["lowest"][3], rel=5e-3)
    with pytest.raises(IndexError):
        study.machine(4)


def test_motions_of_samples(heavy):
    study = hydrapod.sweep(heavy, {"platform.mass": [13.1e3, 14.9e3]}, commands="step z=1 mm, at=0.1", until="0.7 s",
                           want="peak_error_z <= 2 mm", also=["sag", "stiffness"])
    for row in range(2):
        run = hydrapod.simulate(study.machine(row), "step z=1 mm, at=0.1", until=0.7)
        assert study["rms_error_z"][row] == run.to_dict()["directions"][2]["rms_error"]
    assert study.probability_of_missing[0] == 0.0
    assert (study["stiffness_z"] > study["stiffness_x"]).all() and (study["sag"] > 1e-3).all()
    with pytest.raises(ValueError, match="worst over"):
        hydrapod.workspace_map(heavy, {"x": [0.0, 0.01]}, worst_over={"rx": [0.0, 0.01]}, outputs={"one": lambda m: 1.0})


def test_requirements_are_what_the_rows_say(heavy):
    study = hydrapod.montecarlo(heavy, {sleeve: "lognormal ± 1 % per leg"}, samples=400, want=["lowest >= 4 Hz"])
    assert (study["status"] == 0).all()
    missed = ~(study["lowest"] >= 4.0)
    assert study.probability_of_missing[0] == missed.mean()
    low, high = study.probability_interval[0]
    assert low < missed.mean() < high
    assert study["lowest"][study.worst_rows[0]] == np.nanmin(study["lowest"])
    text = study.machine_text(int(study.worst_rows[0]), "worst")
    from_text, worst = hydrapod.Machine(text), study.machine(int(study.worst_rows[0]))
    for path in study.names[:study.input_count]:
        assert worst[path] == study[path][study.worst_rows[0]]
        assert from_text[path] == pytest.approx(worst[path], rel=1e-9)  # the file is written for people


def test_interrupted_runs_go_on(heavy, tmp_path):
    path = tmp_path / "rows.h5"
    whole = hydrapod.montecarlo(heavy, {sleeve: "normal ± 10 %"}, samples=6000, threads=1)
    calls = []
    part = hydrapod.montecarlo(heavy, {sleeve: "normal ± 10 %"}, samples=6000, threads=1, results=path,
                               progress=lambda share: calls.append(share) or share > 0.3)
    assert not part.complete and 0 < len(part) < 6000
    again = hydrapod.montecarlo(heavy, {sleeve: "normal ± 10 %"}, samples=6000, results=path, resume=True)
    assert again.complete
    np.testing.assert_array_equal(again.values, whole.values)


def test_parts(heavy, tmp_path):
    path = tmp_path / "rows.h5"
    for k in (1, 2):
        part = hydrapod.montecarlo(heavy, {sleeve: "normal ± 10 %"}, samples=300, results=path, shard=(k, 2))
        assert part.complete
        with pytest.raises(hydrapod.ComputationError, match="join"):
            part.to_dict()
    joined = hydrapod.montecarlo(heavy, {sleeve: "normal ± 10 %"}, samples=300, results=path, shard=(1, 2), join=True)
    np.testing.assert_array_equal(
        joined.values, hydrapod.montecarlo(heavy, {sleeve: "normal ± 10 %"}, samples=300).values)


@pytest.mark.parametrize("call", [
    lambda m: hydrapod.montecarlo(m, {}), lambda m: hydrapod.montecarlo(m, {"no.such": "normal ± 1 %"}),
    lambda m: hydrapod.montecarlo(m, {sleeve: "normal ± 1 %"}, samples=1),
    lambda m: hydrapod.montecarlo(m, {sleeve: "normal ± 1 %"}, want="no >= 1 Hz"),
    lambda m: hydrapod.montecarlo(m, {sleeve: "normal ± 1 %"}, resume=True),
    lambda m: hydrapod.sweep(m, {sleeve: [np.nan]}), lambda m: hydrapod.sweep(m, {sleeve: []}),
    lambda m: hydrapod.sweep(m, {sleeve: np.ones((2, 2))}), lambda m: hydrapod.workspace_map(m, {"up": [0.0, 1.0]}),
    lambda m: hydrapod.sweep(m, {sleeve: "1:2:2 kN/mm"}, modes=0)])
def test_wrong_studies(heavy, call):
    with pytest.raises(ValueError):
        call(heavy)


def test_design_function(heavy):
    f = hydrapod.DesignFunction(heavy, [sleeve, "platform.mass"], modes=3)
    X = np.array([[1e6, 12e3], [2e6, 14e3]])
    np.testing.assert_allclose(f.sample(X), [f(x) for x in X], rtol=1e-11)
    np.testing.assert_allclose(
        f.sample(X), hydrapod.frequencies(heavy, {sleeve: X[:, 0], "platform.mass": X[:, 1]})[:, :3], rtol=1e-11)
    with pytest.raises(ValueError):
        f.sample(X[:, :1])
    for wrong in (X, X[:1], X[0, :1], 1e6):
        with pytest.raises(ValueError, match="sample"):
            f(wrong)  # of many it would be the first
    with pytest.raises(ValueError):
        hydrapod.DesignFunction(heavy, sleeve, modes=40)


def test_openturns(heavy):
    openturns = pytest.importorskip("openturns")
    f = hydrapod.DesignFunction(heavy, [sleeve, "platform.mass"], modes=2).to_openturns()
    np.testing.assert_array_equal(np.array(f(openturns.Sample([[1e6, 12e3]])))[0], list(f([1e6, 12e3])))


def designed(machine, **options):
    return hydrapod.design(machine, {sleeve: "1:50 kN/mm", "platform.mass": (12e3, 15e3)}, samples=64, starts=2,
                           **options)


def test_design_is_what_its_machine_has(heavy):
    found = designed(heavy, want="lowest >= 3.9 Hz", maximise="platform.mass")
    assert found.feasible and found.paths == [sleeve, "platform.mass"] and found.units == ["N/m", "kg"]
    machine = found.machine
    for path, value in zip(found.paths, found.values):
        assert machine[path] == pytest.approx(value, rel=1e-9)  # the file is written for people
    assert found.aim_values[0] == found.values[1] > 12e3
    assert found.worst[0] >= 3.9 and found.worst_poses == ["neutral"]
    row = hydrapod.sweep(machine, {"platform.mass": [machine["platform.mass"]]})
    assert row["lowest"][0] == pytest.approx(found.worst[0], rel=1e-9)
    assert "lowest >= 3.9 Hz" in repr(found) and found._repr_html_().startswith("<div>")


def test_trade_off_is_not_dominated(heavy):
    found = designed(heavy, maximise=["lowest", "platform.mass"], trade_off=4)
    assert found.front_aims.shape[1] == 2 and len(found.front_values) == len(found.front_aims) >= 2
    assert (np.diff(found.front_aims[:, 0]) > 0).all() and (np.diff(found.front_aims[:, 1]) < 0).all()


def test_design_that_cannot_be(heavy):
    found = designed(heavy, want="lowest >= 400 Hz", maximise="platform.mass")
    assert not found.feasible and found.text == "" and found.worst[0] < 400
    with pytest.raises(hydrapod.ComputationError, match="meets all requirements"):
        found.machine


def test_design_can_be_stopped(heavy):
    found = hydrapod.design(heavy, {sleeve: "1:50 kN/mm"}, maximise="lowest", samples=200000,
                            progress=lambda share: share > 0.02)
    assert found.interrupted and found.evaluations > 0
    with pytest.raises(hydrapod.ComputationError, match="interrupted"):
        designed(heavy, maximise="lowest", progress=lambda share: True)


@pytest.mark.parametrize("options, message", [
    ({"minimise": "lowest", "change": {}}, "change"), ({"change": {sleeve: "1:50 kN/mm"}}, "minimise"),
    ({"change": {"no.such": (1, 2)}, "minimise": "lowest"}, "no.such"),
    ({"change": {sleeve: (-1e6, 1e6)}, "minimise": "lowest"}, "stiffness"),
    ({"change": {sleeve: (1e6, np.nan)}, "minimise": "lowest"}, "two finite numbers"),
    ({"change": {sleeve: 1e6}, "minimise": "lowest"}, "two finite numbers"),
    ({"change": {sleeve: (1e6, 2e6)}, "minimise": "lowst"}, "lowest"),
    ({"change": {sleeve: (1e6, 2e6)}, "minimise": ["lowest", "x", "y"]}, "two for a trade-off"),
    ({"change": {sleeve: (1e6, 2e6)}, "minimise": "lowest", "want": "lowest is 4"}, "lowest"),
    ({"change": {sleeve: (1e6, 2e6)}, "minimise": "lowest", "poses": "z=50"}, "50"),
    ({"change": {sleeve: (1e6, 2e6)}, "minimise": "lowest", "samples": 3}, "16"),
    ({"change": {sleeve: (1e6, 2e6)}, "minimise": "lowest", "trade_off": 1}, "3 to 1000")])
def test_wrong_designs(heavy, options, message):
    with pytest.raises(ValueError, match=message):
        hydrapod.design(heavy, **options)


def test_functions_that_cannot_be_columns_are_refused_before_the_study(heavy):
    calls = []
    for outputs, message in (({"own": 3}, "function"), ({"x": lambda m: 1.0}, "such a column"),
                             ({"peak_rz": lambda m: 1.0}, "such a column"), ({"share": lambda m: 1.0}, "such a column"),
                             ({"platform.mass": lambda m: 1.0}, "such a column"), ([lambda m: 1.0], "dict")):
        with pytest.raises((TypeError, ValueError), match=message):
            hydrapod.sweep(heavy, {"platform.mass": [12e3]}, outputs=outputs, progress=calls.append)
        with pytest.raises((TypeError, ValueError), match=message):
            hydrapod.montecarlo(heavy, {"platform.mass": "normal ± 1 %"}, outputs=outputs, progress=calls.append)
    with pytest.raises(ValueError, match="neutral"):
        hydrapod.workspace_map(heavy.at("z=10 mm"), {"x": [0.0, 0.01]}, outputs={"own": lambda m: 1.0},
                               progress=calls.append)
    assert not calls


@pytest.mark.parametrize("result", [None, "3", 1j, np.complex128(1j), np.ones(3)])
def test_functions_return_real_numbers(heavy, result):
    with pytest.raises(TypeError, match="row 0.*real number"):
        hydrapod.sweep(heavy, {"platform.mass": [12e3]}, outputs={"own": lambda m: result})


def test_progress_of_columns(heavy):
    """The study is the first part, each column one more; True stops in all of them."""
    masses = {"platform.mass": np.linspace(12e3, 14e3, 8)}
    shares = []
    own = {"one": lambda m: np.float64(m["platform.mass"]), "two": lambda m: np.array([1.0])}
    study = hydrapod.sweep(heavy, masses, outputs=own, progress=shares.append)
    assert shares == sorted(shares) and shares[-1] == 1.0 and 1 / 3 in shares and any(0.4 < s < 0.6 for s in shares)
    np.testing.assert_array_equal(study["one"], masses["platform.mass"])
    with pytest.raises(hydrapod.ComputationError, match="of 8 rows"):
        hydrapod.sweep(heavy, masses, outputs=own, progress=lambda share: share > 0.5)


def test_every_column_of_a_study_is_known_as_one(heavy):
    from hydrapod._studies import _is_column

    study = hydrapod.sweep(heavy, {"platform.mass": [12e3]}, buckling=True)
    assert all(_is_column(name) for name in study.names if name != "platform.mass")
    groups = ["stiffness", "force", "velocity", "acceleration", "jerk", "excursion", "sag", "oil_force"]
    more = hydrapod.sweep(heavy, {"platform.mass": [12e3]}, also=groups, commands="step z=1 mm", until=0.2)
    assert len(more.names) > len(study.names) + 50
    assert all(_is_column(name) for name in more.names if name != "platform.mass")


def test_montecarlo_with_columns_of_ones_own(heavy):
    study = hydrapod.montecarlo(heavy, {"platform.mass": "uniform ± 10 %"}, samples=7, seed=3, threads=1,
                                outputs={"twice": lambda m: 2.0 * m["platform.mass"]})
    np.testing.assert_array_equal(study["twice"], 2.0 * study["platform.mass"])


def test_design_with_outputs_of_ones_own(heavy):
    """The least of a distance is where it is zero; a bound of it stops the mass; poses are told apart."""
    def distance(machine):
        if machine["platform.mass"] > 15e3:
            raise hydrapod.ComputationError("too heavy for the crane")
        return np.hypot(machine[sleeve] / 3.1e6 - 1.0, machine["platform.mass"] / 13.1e3 - 1.0)

    change = {sleeve: (1e6, 9e6), "platform.mass": (11e3, 16e3)}
    nearest = hydrapod.design(heavy, change, minimise="distance", outputs={"distance": distance}, samples=64, starts=2)
    assert nearest.feasible
    np.testing.assert_allclose(nearest.values, [3.1e6, 13.1e3], rtol=1e-4)
    assert nearest.machine["platform.mass"] == pytest.approx(13.1e3, rel=1e-4)
    heaviest = hydrapod.design(heavy, change, maximise="platform.mass", want="distance <= 0.1",
                               outputs={"distance": distance}, samples=64, starts=2)
    assert heaviest.feasible and heaviest.values[1] == pytest.approx(1.1 * 13.1e3, rel=1e-4)
    seen = set()
    poses = hydrapod.design(heavy, {sleeve: (1e6, 9e6)}, minimise="height", poses=["z=10 mm", "z=30 mm"], samples=16,
                            starts=1, outputs={"height": lambda m: seen.add(m.pose) or float(m.pose == "z=30 mm")})
    assert seen == {"z=10 mm", "z=30 mm"} and poses.aim_values[0] == 1.0


def test_functions_of_a_design_that_fail(heavy):
    change = {"platform.mass": (11e3, 16e3)}
    options = dict(minimise="own", samples=16, starts=1)
    with pytest.raises(ZeroDivisionError):
        hydrapod.design(heavy, change, outputs={"own": lambda m: 1 / 0}, **options)
    with pytest.raises(TypeError, match="own.*real number"):
        hydrapod.design(heavy, change, outputs={"own": lambda m: "3"}, **options)
    with pytest.raises(hydrapod.InputError, match="such an output"):
        hydrapod.design(heavy, change, outputs={"lowest": lambda m: 1.0}, **{**options, "minimise": "lowest"})
    with pytest.raises(TypeError, match="function"):
        hydrapod.design(heavy, change, outputs={"own": 3}, **options)

    def nowhere(machine):
        raise hydrapod.ComputationError("none")

    assert not hydrapod.design(heavy, change, outputs={"own": nowhere}, want="own <= 1", **options).feasible


def test_functions_may_have_no_result(heavy):
    def own(machine):
        if machine["platform.mass"] > 13e3:
            raise hydrapod.ComputationError("none here")
        return 1.0

    study = hydrapod.sweep(heavy, {"platform.mass": [12e3, 14e3]}, outputs={"own": own})
    np.testing.assert_array_equal(study["own"], [1.0, np.nan])
    assert "own" in study and "lowest" in study and "no such" not in study
    with pytest.raises(TypeError, match="iterable"):
        iter(study)


@pytest.mark.parametrize("path, value", [
    ("platform.mass", -1.0), ("platform.mass", 0.0), (sleeve, -1e6), ("platform.inertia.xx", 1.0),
    ("platform.inertia.xx", -5.0), ("legs.rod.length", -1.0), ("legs.rod.length", 100.0),
    ("legs.oil_spring.cylinder.bore", -0.1)])
def test_designs_that_no_machine_can_be_have_no_frequencies(heavy, path, value):
    """They had some: 27.6 Hz of a platform of -1 kg. Optimisers and samplers go there."""
    many = hydrapod.frequencies(heavy, {path: [heavy[path], value]})
    assert np.isfinite(many[0]).all() and np.isnan(many[1]).all()
    assert np.isnan(hydrapod.frequencies(heavy, {path: value})).all()
    assert np.isnan(hydrapod.DesignFunction(heavy, path, modes=2)([value])).all()
    assert hydrapod.sweep(heavy, {path: [value]})["status"][0] != 0.0


@pytest.mark.parametrize("task, over", [(hydrapod.sweep, {"platform.mass": np.linspace(13e3, 15e3, 600)}),
                                        (hydrapod.workspace_map, {"x": np.linspace(-0.05, 0.05, 600)})])
def test_grids_may_be_split(heavy, tmp_path, task, over):
    """Over several machines, as `hydrapod sweep --shard` and `--join` do."""
    whole, path = task(heavy, over), tmp_path / "rows.h5"
    for k in (1, 2):
        task(heavy, over, results=path, shard=(k, 2))
    np.testing.assert_array_equal(task(heavy, over, results=path, shard=(1, 2), join=True).values, whole.values)


def test_a_part_is_shown_as_a_part(heavy, tmp_path):
    """Neither its repr nor its page raise; it has no rows here, and says where they are."""
    over, path = {sleeve: np.linspace(1e6, 2e6, 6)}, tmp_path / "rows.h5"
    for i in (1, 2):
        part = hydrapod.sweep(heavy, over, results=path, shard=(i, 2))
        assert part.part == (i, 2) and len(part) == 0 and part.complete
        for text in (repr(part), part._repr_html_()):
            assert f"part {i} of 2" in text and part.rows_file in text and "join" in text
        with pytest.raises(hydrapod.ComputationError, match="join"):
            part.to_dict()
    with pytest.raises(ValueError, match="outputs"):
        hydrapod.sweep(heavy, over, results=path, shard=(1, 2), outputs={"own": lambda m: 1.0})
    joined = hydrapod.sweep(heavy, over, results=path, shard=(1, 2), join=True)
    assert joined.part is None and len(joined) == 6 and "6 rows" in repr(joined)
    assert hydrapod.sweep(heavy, over).part is None
