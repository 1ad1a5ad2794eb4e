"""Arguments that cannot be meant: a clear exception that names the argument, never another meaning."""

import copy
import inspect
import os
import pickle

import numpy as np
import pytest

import hydrapod

sleeve = "legs.guide_sleeve.stiffness"


@pytest.mark.parametrize("call, name", [
    (lambda m: hydrapod.modes(m, matrices="yes"), "matrices"),
    (lambda m: hydrapod.bode(m, points=10.5), "points"), (lambda m: hydrapod.bode(m, points="10"), "points"),
    (lambda m: hydrapod.bode(m, points=10**12), "points"), (lambda m: hydrapod.bode(m, input=3), "input"),
    (lambda m: hydrapod.bode(m, point=3), "point"), (lambda m: hydrapod.bode(m, point="abc"), "point"),
    (lambda m: hydrapod.root_locus(m, "controller.gain", "3 1/s", 17), "start"),
    (lambda m: hydrapod.root_locus(m, "controller.gain", 3, 17, 5.0), "write 5"),
    (lambda m: hydrapod.system(m, pade_order=2.5), "pade_order"),
    (lambda m: hydrapod.simulate(m, None), "commands"), (lambda m: hydrapod.simulate(m, seed=-1), "seed"),
    (lambda m: hydrapod.simulate(m, trace_samples=-1), "trace_samples"),
    (lambda m: hydrapod.simulate(m, tolerance="1e-6"), "tolerance"),
    (lambda m: hydrapod.simulate(m, ideal_sensors="no"), "ideal_sensors"),
    (lambda m: hydrapod.sensitivity(m, 3), "parameters"), (lambda m: m.at([0, 0, 0.05, 0, 0, 0]), "pose"),
    (lambda m: m.using(3), "model"), (lambda m: hydrapod.read_machine("a\udcffb"), "UTF-8"),
    (lambda m: hydrapod.read_machine("a\0b"), "character 0"),
    (lambda m: hydrapod.forward_kinematics(m, None), "lengths"),
    (lambda m: hydrapod.sample_signals("sine x=1 mm", seed=1.5), "seed"),
    (lambda m: hydrapod.frequencies(m, [sleeve]), "designs"),
    (lambda m: hydrapod.frequencies(m, {sleeve: "20 kN/mm"}), "SI"),
    (lambda m: hydrapod.frequencies(m, {sleeve: True}), sleeve),
    (lambda m: hydrapod.frequencies(m, {sleeve: [1e6]}, threads=1.5), "threads"),
    (lambda m: hydrapod.montecarlo(m, f"{sleeve}=normal ± 1 %"), "vary"),
    (lambda m: hydrapod.montecarlo(m, {sleeve: 1e6}), sleeve),
    (lambda m: hydrapod.montecarlo(m, {sleeve: "normal ± 1 %"}, samples=1e3), "write 1000"),
    (lambda m: hydrapod.montecarlo(m, {sleeve: "normal ± 1 %"}, samples=-3), "samples"),
    (lambda m: hydrapod.montecarlo(m, {sleeve: "normal ± 1 %"}, results="rows.h5", shard=3), "shard"),
    (lambda m: hydrapod.frf(None), "a file, a Record"), (lambda m: hydrapod.frf(np.zeros((30, 2))), "Record"),
    (lambda m: hydrapod.frf([3]), "a Record"), (lambda m: hydrapod.frf("run.h5", block="256"), "block"),
    (lambda m: hydrapod.frf("run.h5", whole_record=True, block=256), "whole_record"),
    (lambda m: hydrapod.frf("run.h5", whole_record="no"), "whole_record"),
    (lambda m: hydrapod.calibrate(m, "modes.csv", {sleeve: 5}), sleeve),
    (lambda m: hydrapod.calibrate(m, "modes.csv", {sleeve: (np.nan, 1e6)}), sleeve),
    (lambda m: hydrapod.calibrate(m, "modes.csv", [sleeve], priors={sleeve: 5}), "priors"),
    (lambda m: hydrapod.report(m, modes="first"), "modes"),
    (lambda m: hydrapod.export(m, "machine.mtx", leg_modes=-1), "leg_modes"),
    (lambda m: hydrapod.rig(m, length_sensor=3), "length_sensor"), (lambda m: hydrapod.rig(m, seed=2**70), "seed"),
    (lambda m: hydrapod.Plant(m, hydraulics="no"), "hydraulics"),
    (lambda m: hydrapod.Plant(m, tolerance="small"), "tolerance"),
    (lambda m: hydrapod.Plant.run_many([hydrapod.Plant(m), 3], np.zeros((3, 6)), 1e-3), "plants"),
    (lambda m: m[3], "path"), (lambda m: m.unit(3), "path"), (lambda m: m.with_({3: 1.0}), "overrides"),
    (lambda m: hydrapod.read_machine("m.toml", overrides=["a=1"]), "overrides"),
    (lambda m: hydrapod.compare(m, overrides=["a=1"]), "overrides"),
    (lambda m: hydrapod.DesignFunction(m, sleeve, modes="2"), "modes"),
    (lambda m: hydrapod.sweep(m, {sleeve: [1e6]}).add(3, [1.0]), "name"),
    (lambda m: hydrapod.read_record(b"run.h5"), "path"), (lambda m: hydrapod.calibrate(m, "t.csv", priors=1), "priors"),
    (lambda m: hydrapod.frequencies(m, {sleeve: [1e6]}, threads=-1), "threads"),
    (lambda m: hydrapod.DesignFunction(m, sleeve, threads=-1), "threads"),
    (lambda m: hydrapod.DesignFunction("m.toml", sleeve), "machine"),
    (lambda m: hydrapod.montecarlo(m, {sleeve: "normal ± 1 %"}, threads=-1), "threads"),
    (lambda m: hydrapod.Plant.run_many([hydrapod.Plant(m)], np.zeros((3, 6)), 1e-3, threads=-1), "threads"),
    (lambda m: hydrapod.rig(m, averages=-1), "averages"), (lambda m: hydrapod.rig(m, oversampling=0), "oversampling"),
    (lambda m: hydrapod.modes_at_amplitudes(m, [np.inf]), "amplitudes"),
    (lambda m: hydrapod.modes_at_amplitudes(m, np.nan), "amplitudes"),
    (lambda m: hydrapod.sweep(m, {sleeve: [1e6]}, results=""), "results"),
    (lambda m: hydrapod.sweep(m, {sleeve: [1e6]}, modes=0), "modes"),
    (lambda m: hydrapod.sweep(m, {sleeve: [1e6]}, modes=43), "1 to 42"),
    (lambda m: hydrapod.report(m, points=-3), "points"), (lambda m: hydrapod.report(m, modes=1), "modes"),
    (lambda m: m.with_({sleeve: "\udc80"}), "UTF-8"), (lambda m: hydrapod.frequencies(m, {"\udc80": 1.0}), "designs"),
    (lambda m: hydrapod.diagnose(m, want=["x=5 Hz"]), "want"), (lambda m: hydrapod.diagnose(m, want=True), "want")])
def test_wrong_arguments_are_named(heavy, call, name):
    with pytest.raises((TypeError, ValueError)) as raised:
        call(heavy)
    assert name in str(raised.value) and "incompatible" not in str(raised.value) and "cast" not in str(raised.value)


run_options = {"measured": "run.h5", "record": "run.h5", "damaged": "run.h5", "to": "other.h5", "new_rate": 100,
               "path": "other.h5", "targets": "modes.csv", "vary": {sleeve: "normal ± 1 %"}, "over": {sleeve: [1e6]},
               "change": {sleeve: "1:50 kN/mm"}, "key": sleeve, "start": 1e6, "stop": 2e6, "signals": "sine x=1 mm",
               "designs": {sleeve: [1e6]}, "amplitudes": 1e-3, "parameters": "params.in", "stiffness": "K.mtx",
               "mass": "M.mtx"}
singles = {"str", "int", "bool", "float", "Quantity", "Path", *(f"Optional[{one}]" for one in ("str", "int", "bool",
                                                                                               "Quantity", "Path"))}


def single_values():
    """Functions with their options that are one value: a number, a text, a flag or a path."""
    for name in hydrapod.__all__:
        function = getattr(hydrapod, name)
        if inspect.isfunction(function) and not name.startswith(("plot_", "state_", "to_", "progress_")):
            for option, parameter in inspect.signature(function).parameters.items():
                if parameter.annotation in singles and parameter.kind == parameter.KEYWORD_ONLY:
                    yield name, option


@pytest.mark.parametrize("name, option", single_values())
@pytest.mark.parametrize("wrong", [[10], "\udc80"], ids=["list", "surrogate"])
def test_a_list_or_no_text_in_place_of_a_value(heavy, name, option, wrong):
    """Casts in C++ had said RuntimeError, without the name of the argument."""
    function = getattr(hydrapod, name)
    given = {"machine": heavy, **run_options, "over": {"x": "0:1:2 mm"} if name == "workspace_map" else {sleeve: [1e6]},
             "path": "other.npz" if name == "export" else "other.h5"}
    needed = {one: given[one] for one, parameter in inspect.signature(function).parameters.items()
              if parameter.default is parameter.empty and parameter.kind == parameter.POSITIONAL_OR_KEYWORD}
    related = {"until": {"commands": "step z=1 mm"}, "want": {"diagnose": "modes.csv"}, "mass": {"stiffness": "K.mtx"},
               **{one: {"measured": "run.h5"} for one in ("from_", "to", "input_from", "against")},
               **{one: {"hardware": 4747} for one in ("layout", "key", "fifo", "ramp", "ramp_down", "watchdog")}}
    if name in ("report", "rig"):
        needed.update(related.get(option, {}))
    if name == "attach":
        needed.update({"stiffness": "K.mtx", "mass": "M.mtx"} if option not in ("punch", "uff") else {})
    if option in ("resume", "join") and "results" in inspect.signature(function).parameters:
        needed["results"] = "rows.h5"
    with pytest.raises((TypeError, ValueError)) as raised:
        function(**{**needed, option: wrong})
    assert option in str(raised.value), str(raised.value)
    assert "incompatible" not in str(raised.value) and "cast" not in str(raised.value)


def test_samples_of_a_grid(heavy):
    """They were ignored."""
    over = {sleeve: "1:3:3 MN/m", "platform.mass": [12e3, 14e3]}
    with pytest.raises(hydrapod.InputError, match="samples=5.*a grid has one row per point, here 6; leave it out"):
        hydrapod.sweep(heavy, over, samples=5)
    assert hydrapod.sweep(heavy, over, samples=None).shape == [3, 2]
    assert len(hydrapod.sweep(heavy, {sleeve: "1:3 MN/m"}, design="latin", samples=5).values) == 5


def test_paths_are_texts_or_paths(heavy, strong_run, tmp_path):
    """pathlib.Path everywhere where a file is meant; bytes are refused by name."""
    report = hydrapod.report(heavy, points=5)
    record = hydrapod.Record(np.zeros((30, 1)), 100.0, "u")
    results = [(hydrapod.frf(strong_run), "csv"), (hydrapod.identify(strong_run), "csv"), (report, "html"),
               (record, "csv"), (heavy, "toml")]
    for number, (result, ending) in enumerate(results):
        path = tmp_path / f"{number}.{ending}"
        result.write(path)
        whole = path.read_bytes()
        path.unlink()
        result.write(str(path))
        assert whole and path.read_bytes() == whole
        for wrong in (os.fsencode(path), 3, None, "a\0b", "\udc80.csv"):
            with pytest.raises((TypeError, ValueError), match="path"):
                result.write(wrong)
    for call in (lambda: hydrapod.export(heavy, b"a.npz"), lambda: hydrapod.report(heavy, b"a.html", points=5),
                 lambda: hydrapod.simulate(heavy, until=0.01, record=b"a.h5"), lambda: hydrapod.frf(b"run.h5"),
                 lambda: hydrapod.sweep(heavy, {sleeve: [1e6]}, results=b"a.h5"), lambda: hydrapod.rig(heavy, b"a.h5"),
                 lambda: hydrapod.evaluate(heavy, b"params.in"), lambda: hydrapod.convert_record(record, b"a.h5"),
                 lambda: hydrapod.frf(strong_run, machine=b"machine.toml"), lambda: hydrapod.verify_record(b"a.h5")):
        with pytest.raises(TypeError, match="bytes|a file"):
            call()


def test_paths_that_no_file_can_have(heavy):
    """As open() says it."""
    for call in (lambda path: hydrapod.calibrate(heavy, path), lambda path: hydrapod.diagnose(heavy, path),
                 hydrapod.read_record, lambda path: hydrapod.sweep(heavy, {sleeve: [1e6]}, results=path)):
        with pytest.raises((OSError, ValueError), match="[Tt]oo long"):
            call("x" * 5000)


def test_options_without_what_they_belong_to(heavy):
    """The command line refuses them."""
    for options, word in [(dict(until="1 s"), "commands"), (dict(from_=3), "measured"), (dict(to=30), "measured"),
                          (dict(input_from="drive"), "measured"), (dict(want="x=5 Hz"), "diagnose"),
                          (dict(against="plant"), "measured or diagnose")]:
        with pytest.raises(ValueError, match=f"{next(iter(options))}.*{word}"):
            hydrapod.report(heavy, points=5, **options)


def test_idle_options_of_exports(heavy, tmp_path):
    for options in (dict(system="plant", point=(0, 0, 1)), dict(system="loop", point=(0, 0, 1)), dict(pade_order=2),
                    dict(system="plant", pade_order=3), dict(system="loop", sampled=True, pade_order=3)):
        for call in (lambda: hydrapod.machine_state_space(heavy, **options),
                     lambda: hydrapod.export(heavy, tmp_path / "a.npz", **options)):
            with pytest.raises(hydrapod.InputError, match="point" if "point" in options else "pade_order"):
                call()
    for name in ("a.uff", "a.xml", "a.sdf", "a.urdf"):
        with pytest.raises(hydrapod.InputError, match="point"):
            hydrapod.export(heavy, tmp_path / name, approximate=True, point=(0, 0, 1))
        with pytest.raises(hydrapod.InputError, match="pade_order"):
            hydrapod.export(heavy, tmp_path / name, approximate=True, pade_order=7)
    assert not list(tmp_path.iterdir())
    assert hydrapod.machine_state_space(heavy, system="loop", pade_order=3).pade_order == 3
    assert hydrapod.machine_state_space(heavy, system="loop").pade_order == 2
    hydrapod.export(heavy, tmp_path / "a.mtx", point=(0, 0, "1 m"))


def test_parts_of_a_machine_are_equal_where_they_are_the_same(heavy):
    again = hydrapod.read_machine(heavy.path)
    assert heavy.legs == heavy.legs == again.legs and hash(heavy.legs) == hash(again.legs)
    assert heavy.legs != heavy.platform and heavy.legs != heavy.at("low").legs and heavy.legs != "legs"


def test_modes_of_studies_are_as_many_as_machines_have(heavy):
    assert "mode14" in hydrapod.sweep(heavy, {sleeve: [1e6]}, modes=42).names


def test_numbers_of_numpy_are_numbers(heavy):
    assert len(hydrapod.bode(heavy, points=np.int64(5), from_=np.float32(2)).omega) == 5
    assert hydrapod.modes(heavy, matrices=np.True_).to_dict()["matrices"]
    seeded = hydrapod.sample_signals("white z=1 mm", duration="10 ms", seed=2**64 - 1)
    assert np.isfinite(seeded.values).all()
    with pytest.raises(hydrapod.InputError, match="boolean"):
        heavy.with_({sleeve: np.True_})
    # a frequency [Hz], whatever the kind of number; below 1 it could be meant as a drop
    wanted = [hydrapod.diagnose(heavy, want=one).to_dict() for one in (5.0, np.float16(5), np.int64(5), "5", "5 Hz")]
    assert all(one == wanted[0] for one in wanted)
    for kind in (float, np.float32, np.float16):
        with pytest.raises(hydrapod.InputError, match="2 %"):
            hydrapod.diagnose(heavy, want=kind(0.125))


masked = np.ma.masked_array([[1e-3] * 6, [9e9] * 6], [[False] * 6, [True] * 6])


@pytest.mark.parametrize("call", [
    lambda m, a: hydrapod.leg_lengths(m, a), lambda m, a: hydrapod.forward_kinematics(m, a),
    lambda m, a: hydrapod.Plant(m).run(a, 1e-3),
    lambda m, a: hydrapod.frequencies(m, {sleeve: a[:, 0]}), lambda m, a: hydrapod.sweep(m, {sleeve: a[:, 0]}),
    lambda m, a: hydrapod.DesignFunction(m, [sleeve]).sample(a[:, :1]),
    lambda m, a: hydrapod.modes_at_amplitudes(m, a[:, 0])])
@pytest.mark.parametrize("wrong", [masked, np.full((2, 6), 1e-3 + 1j), np.full((2, 6), True),
                                   np.full((2, 6), "0.001"), np.full((2, 6), 1e-3, object)],
                         ids=["masked", "complex", "bool", "texts", "objects"])
def test_arrays_that_are_no_real_numbers(heavy, call, wrong):
    """NumPy would drop the mask, the imaginary part or the quotes."""
    with pytest.raises((TypeError, ValueError)):
        call(heavy, wrong)


def test_masked_samples_are_missing():
    samples = np.ma.masked_array(np.arange(8.0).reshape(4, 2), mask=False)
    samples.mask[1, 0], samples.data[1, 0] = True, 9e9
    record = hydrapod.Record(samples, "1 kHz", ["u", "a"])
    assert record.sample_rate == 1000.0 and np.isnan(record["u"][1])
    assert np.isnan(record.samples).sum() == 1 and record.samples[3, 1] == 7.0
    whole_numbers = hydrapod.Record(np.ma.masked_array([[1], [2]], [[True], [False]]), 10, "u")
    assert np.isnan(whole_numbers["u"][0]) and whole_numbers["u"][1] == 2.0


def test_numbers_that_float_would_take_in_part(heavy):
    """The real part of a complex number, the count of a duration, the number below a mask."""
    plant, masked_six = hydrapod.Plant(heavy), np.ma.masked_array(np.full(6, 9e9), [True] + [False] * 5)
    for wrong in (np.complex128(1e-3), np.complex64(1e-3), np.timedelta64(1, "ns"), np.datetime64(1, "ns")):
        for call in (lambda: plant.step(None, wrong), lambda: hydrapod.simulate(heavy, until=wrong),
                     lambda: heavy.with_({"platform.mass": wrong}), lambda: hydrapod.Plant(heavy, tolerance=wrong),
                     lambda: hydrapod.Record(np.zeros((9, 1)), wrong, "u"),
                     lambda: hydrapod.build_machine(platform={"mass": wrong})):
            with pytest.raises(TypeError, match="expected"):
                call()
    for step in (lambda: plant.step(masked_six, 1e-3), lambda: plant.step(None, 1e-3, wrench=masked_six)):
        with pytest.raises(ValueError, match="masked"):
            step()
    assert plant.time == 0.0
    np.testing.assert_array_equal(plant.step(np.ma.masked_array(np.zeros(6)), 1e-3),
                                  hydrapod.Plant(heavy).step(np.zeros(6), 1e-3))
    for call in (lambda of: hydrapod.sweep(heavy, {sleeve: [1e6]}, outputs={"c": of}),
                 lambda of: hydrapod.design(heavy, {sleeve: "1:50 kN/mm"}, minimise="c", outputs={"c": of}, samples=16)):
        with pytest.raises(TypeError, match="real number"):
            call(lambda machine: np.ma.masked)


def test_arrays_of_numpy_are_lists_of_a_machine(heavy):
    centre = np.array([0.0, 0.001, -0.15], np.float32)
    for given in (centre, centre.astype(float), list(map(float, centre)), pytest.importorskip("pandas").Series(centre)):
        assert heavy.with_({"platform.mass_center": given})["platform.mass_center[1]"] == float(centre[1])
    for wrong in (np.ma.masked_array(centre, [False, True, False]), centre.astype(complex)):
        with pytest.raises(TypeError, match="expected a number"):
            heavy.with_({"platform.mass_center": wrong})


def test_records_say_what_does_not_fit():
    with pytest.raises(ValueError, match="transpose"):
        hydrapod.Record(np.zeros((2, 300)), 100.0, ["u", "a"])
    with pytest.raises(ValueError, match="channels"):
        hydrapod.Record(np.zeros((300, 3)), 100.0, "uva")  # one name, not three
    with pytest.raises(ValueError, match="units"):
        hydrapod.Record(np.zeros((300, 2)), 100.0, ["u", "a"], units="N")
    with pytest.raises(TypeError, match="channels"):
        hydrapod.Record(np.zeros((300, 1)), 100.0, [1])
    record = hydrapod.Record(np.zeros((300, 2)), 100.0, ["u", "a"])
    assert "a" in record and "b" not in record
    assert copy.copy(record) is record and copy.deepcopy(record) is record
    with pytest.raises(TypeError, match="iterable"):
        list(record)
    for wrong in (0, slice(0, 5), ("a", "u"), None):
        with pytest.raises(TypeError, match="name of a channel.*samples"):
            record[wrong]
    with pytest.raises(TypeError, match="write"):
        pickle.dumps(record)


def test_parameters_cannot_be_set(heavy):
    with pytest.raises(AttributeError, match=r"with_\(.*legs\.guide_sleeve\.stiffness"):
        heavy.legs.guide_sleeve.stiffness = 2e6
    assert heavy.legs.guide_sleeve.stiffness == heavy[sleeve]


def test_texts_in_lists_keep_their_quotes(heavy):
    path = "platform.mass_center"
    assert heavy.with_({path: ["1 mm", "0 m", "-15 cm"]})[f"{path}[0]"] == pytest.approx(1e-3)
    with pytest.raises(hydrapod.InputError, match="unit"):
        heavy.with_({path: ['1 "mm', "0 m", "0 m"]})


def test_machines_know_their_paths(heavy):
    assert sleeve in heavy and "no.such" not in heavy and 3 not in heavy and list(heavy) == heavy.paths


def test_arrays_of_the_machine_file_are_sequences(heavy):
    """They were empty when they were looped over."""
    centre = heavy.platform.mass_center
    assert list(centre) == [heavy[f"platform.mass_center[{k}]"] for k in range(3)] and len(centre) == 3
    np.testing.assert_array_equal(np.asarray(centre, dtype=float), list(centre))
    assert centre[np.int64(2)] == centre[-1] == centre[2] == heavy["platform.mass_center[2]"]
    for wrong in (3, -4):
        with pytest.raises(IndexError, match="3 elements"):
            centre[wrong]
    assert list(heavy.with_({"platform.mass_center": centre}).platform.mass_center) == list(centre)
    assert "guide_sleeve" in list(heavy.legs) and len(heavy.legs) == len(list(heavy.legs))


def test_designs_of_a_data_frame(heavy):
    pandas = pytest.importorskip("pandas")
    table = pandas.DataFrame({sleeve: [1e6, 2e6], "platform.mass": [12e3, 14e3]}, index=[7, 9])
    np.testing.assert_array_equal(hydrapod.frequencies(heavy, table),
                                  hydrapod.frequencies(heavy, {path: table[path].to_numpy() for path in table}))


@pytest.mark.parametrize("write", [
    lambda m, path: hydrapod.montecarlo(m, {sleeve: "normal ± 1 %"}, samples=20, results=path),
    lambda m, path: hydrapod.sweep(m, {sleeve: [7e6, 8e6]}, results=path),
    lambda m, path: hydrapod.workspace_map(m, {"x": "-3:3:2 mm"}, results=path),
    lambda m, path: hydrapod.report(m, path), lambda m, path: hydrapod.export(m, path, to="mjcf"),
    lambda m, path: hydrapod.rig(m, path, duration=0.5), lambda m, path: hydrapod.simulate(m, until=0.1, record=path),
    lambda m, path: hydrapod.serve(m, 0, record=path, duration=0.1),
    lambda m, path: hydrapod.evaluate(m, m.path, path)])
def test_no_output_is_an_input(heavy, tmp_path, write):
    """Whatever it is called: the files are compared."""
    machine_file, link = tmp_path / "machine.toml", tmp_path / "link.h5"
    heavy.write(machine_file)
    link.symlink_to(machine_file)
    machine, before = hydrapod.read_machine(machine_file), machine_file.read_bytes()
    for path in (machine_file, link):
        with pytest.raises(ValueError, match="is the input, and was left as it is"):
            write(machine, path)
    assert machine_file.read_bytes() == before


def test_a_report_does_not_replace_what_it_shows(heavy, tmp_path):
    record = tmp_path / "run.h5"
    hydrapod.rig(heavy, record, duration=20)
    before = record.read_bytes()
    with pytest.raises(ValueError, match="is the input, and was left as it is"):
        hydrapod.report(heavy, record, measured=record)
    assert record.read_bytes() == before


@pytest.mark.parametrize("call, words", [
    (lambda m: m.at("up"), "pose up"),
    (lambda m: m.with_({"platform.mas": 3.0}), "with_ platform.mas=3"),
    (lambda m: hydrapod.simulate(m, initial="x=1 mm", actuators="held"), "initial x=1 mm: "),
    (lambda m: hydrapod.simulate(m, "step z=1 mm", actuators="springs"), "commands: error: without the controller"),
    (lambda m: hydrapod.sensitivity(m, ["platform.mas"]), "parameters platform.mas"),
    (lambda m: hydrapod.design(m, {sleeve: "1:50 kN/mm"}, want="x >= 3 Hz", minimise="cost"), "minimise cost")])
def test_messages_call_arguments_by_their_names(heavy, call, words):
    """The library's messages name options of the command line; here they are keyword arguments."""
    with pytest.raises((hydrapod.InputError, hydrapod.ComputationError)) as error:
        call(heavy)
    assert words in str(error.value)
    assert "--" not in str(error.value)
