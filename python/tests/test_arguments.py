"""Arguments that cannot be meant: a clear exception that names the argument, never another meaning."""

import copy
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
    (lambda m: hydrapod.read_record(b"run.h5"), "path")])
def test_wrong_arguments_are_named(heavy, call, name):
    with pytest.raises((TypeError, ValueError)) as raised:
        call(heavy)
    assert name in str(raised.value) and "incompatible" not in str(raised.value) and "cast" not in str(raised.value)


def test_numbers_of_numpy_are_numbers(heavy):
    assert len(hydrapod.bode(heavy, points=np.int64(5), from_=np.float32(2)).omega) == 5
    assert hydrapod.modes(heavy, matrices=np.True_).to_dict()["matrices"]
    seeded = hydrapod.sample_signals("white z=1 mm", duration="10 ms", seed=2**64 - 1)
    assert np.isfinite(seeded.values).all()
    with pytest.raises(hydrapod.InputError, match="boolean"):
        heavy.with_({sleeve: np.True_})
    # below 1 it is a drop, whatever the kind of float
    wanted = [hydrapod.diagnose(heavy, want=kind(0.125)).to_dict() for kind in (float, np.float32, np.float16)]
    assert wanted[0] == wanted[1] == wanted[2]


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
