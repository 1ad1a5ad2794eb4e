"""Threads, arrays of all kinds, interrupts, the end of the interpreter: right or a clear exception."""

import gc
import os
import pickle
import signal
import subprocess
import sys
import threading
import time
import weakref
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from conftest import root, sanitized

import hydrapod

sleeve = "legs.guide_sleeve.stiffness"


def test_views_keep_their_result_alive_and_are_read_only(heavy):
    found = hydrapod.bode(heavy, points=11)
    H, copy = found.H, np.array(found.H)
    del found
    gc.collect()
    np.testing.assert_array_equal(H, copy)
    for array in (H, hydrapod.modes(heavy).M, hydrapod.simulate(heavy, until=0.02).motion):
        with pytest.raises(ValueError):
            array[0] = 1.0
        with pytest.raises(ValueError):
            array.setflags(write=True)


def test_weak_references(heavy):
    machine = heavy.with_({"platform.mass": "7 t"})
    reference = weakref.ref(machine)
    del machine
    gc.collect()
    assert reference() is None


def test_results_refuse_pickling_with_a_type_error(heavy):
    for result in (hydrapod.modes(heavy), hydrapod.modes(heavy).rigid, hydrapod.sweep(heavy, {sleeve: [1e6]}),
                   hydrapod.superelement(heavy)):
        with pytest.raises(TypeError, match="neither copied nor pickled; keep .*the machine"):
            pickle.dumps(result)


def test_threads_give_the_same_results(heavy):
    def one(k):
        return hydrapod.modes(heavy.with_({sleeve: 1e6 * (1 + k % 5)})).json

    with ThreadPoolExecutor(8) as pool:
        many = list(pool.map(one, range(60)))
    assert many == [one(k) for k in range(60)]


def test_one_plant_in_many_threads(heavy):
    plant = hydrapod.Plant(heavy)
    threads = [threading.Thread(target=lambda: [plant.step(None, 1e-3) for _ in range(50)]) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert plant.time == pytest.approx(0.2, rel=1e-9)


@pytest.mark.parametrize("make", [
    lambda a: a[::-1][::-1], lambda a: np.asfortranarray(a), lambda a: np.repeat(a, 2, axis=1)[:, ::2],
    lambda a: a.astype(">f8"), lambda a: a.tolist()])
def test_layouts_of_arrays(heavy, make):
    commands = np.random.default_rng(3).normal(0, 0.01, (30, 6))
    given = make(commands)
    if isinstance(given, np.ndarray):
        given.setflags(write=False)
    np.testing.assert_array_equal(hydrapod.Plant(heavy).run(given, 1e-3), hydrapod.Plant(heavy).run(commands, 1e-3))


@pytest.mark.parametrize("wrong", [np.zeros(6), np.zeros((3, 5)), np.zeros((2, 6, 1)), np.full((4, 6), np.nan),
                                   np.zeros((3, 6), complex), np.array([["a"] * 6]), np.zeros((2, 6), object)])
def test_wrong_arrays(heavy, wrong):
    with pytest.raises((ValueError, TypeError)):
        hydrapod.Plant(heavy).run(wrong, 1e-3)


def test_empty_arrays(heavy):
    assert hydrapod.Plant(heavy).run(np.zeros((0, 6)), 1e-3).shape == (0, 6)


@pytest.mark.parametrize("designs", [
    {}, {"no.such": [1.0]}, {"no.such": 1.0}, {sleeve: np.nan}, {sleeve: float("inf")}, {sleeve: [np.nan]}, {sleeve: np.ones((2, 2))},
    {sleeve: [1e6, 2e6], "platform.mass": [1.0, 2.0, 3.0]}])
def test_wrong_designs(heavy, designs):
    with pytest.raises(ValueError):
        hydrapod.frequencies(heavy, designs)


def test_records_from_arrays(tmp_path):
    samples = np.random.default_rng(4).normal(size=(500, 3))
    samples[17, 1] = np.nan
    record = hydrapod.Record(samples, 200.0, ["u", "a", "p"], units=["kN", "m/s^2", "bar"],
                             roles=["excitation", "response", "other"], directions=["x", "-z", ""])
    assert record.units == ["N", "m/s^2", "Pa"]
    np.testing.assert_allclose(record["p"], 1e5 * samples[:, 2], rtol=4e-16)
    for ending in ("h5", "mat", "csv", "uff"):
        path = tmp_path / f"r.{ending}"
        record.write(path)
        again = hydrapod.read_record(path)
        np.testing.assert_array_equal(again.samples, record.samples)
        assert again.channels == record.channels and again.roles == record.roles
    with pytest.raises(KeyError):
        record["v"]
    for wrong in (dict(samples=samples[:, :2]), dict(sample_rate=-1.0), dict(samples=samples.ravel()),
                  dict(channels=["u", "u", "p"]), dict(samples=samples.astype(complex))):
        arguments = {"samples": samples, "sample_rate": 200.0, "channels": ["u", "a", "p"], **wrong}
        with pytest.raises((ValueError, TypeError)):
            hydrapod.Record(**arguments)


def test_records_in_memory_are_as_good_as_files(run):
    record = hydrapod.read_record(run)
    kept = hydrapod.frf(hydrapod.Record(record.samples, record.sample_rate, record.channels,
                                        units=record.units, roles=record.roles,
                                        directions=record.directions),
                        block=256, machine=hydrapod.read_machine(record.machine_text), estimator="h1",
                        input_from="excitation")
    by_file = hydrapod.frf(run, block=256, estimator="h1", input_from="excitation")
    np.testing.assert_array_equal(kept.frequency_hz, by_file.frequency_hz)
    # a record in a file of its own has the same samples
    np.testing.assert_allclose(kept.H, by_file.H, atol=1e-12 * np.abs(by_file.H).max())


def test_progress_can_stop_and_its_exceptions_come_through(heavy):
    seen = []
    with pytest.raises(ZeroDivisionError):
        hydrapod.simulate(heavy, until=30.0, progress=lambda share: 1 / 0)
    stopped = hydrapod.simulate(heavy, until=30.0, progress=lambda share: seen.append(share) or len(seen) > 2)
    assert not stopped.finished and stopped.message == "interrupted" and stopped.simulated < 30.0
    assert seen == sorted(seen)
    with pytest.raises(TypeError):
        hydrapod.simulate(heavy, until=1.0, progress=3)


def test_progress_bar(heavy, capsys):
    bar = hydrapod.progress_bar("designs")
    hydrapod.frequencies(heavy, {sleeve: np.full(2000, 1.2e6)}, progress=bar)
    shown = capsys.readouterr().err
    assert bar.share == 1.0 and "designs" in shown and "100" in shown


def in_another(text, timeout=120):
    return subprocess.run([sys.executable, "-c", text], cwd=root, timeout=timeout, capture_output=True, text=True)


def test_interpreter_may_end_during_work():
    done = in_another("""
import threading, time, hydrapod
m = hydrapod.read_machine("models/heavy-platform.toml")
for k in range(3):
    threading.Thread(target=lambda: hydrapod.simulate(m, until=900.0), daemon=True).start()
threading.Thread(target=lambda: [hydrapod.modes(m) for _ in range(10**7)], daemon=True).start()
time.sleep(0.4)
print("end")
""")
    assert (done.returncode, done.stdout) == (0, "end\n"), done.stderr


looks = """
import numpy as np, hydrapod
m = hydrapod.read_machine("models/heavy-platform.toml")
commands, seen = np.zeros((30000, 6)), []
"""


@pytest.mark.parametrize("text", ["""
plant = hydrapod.Plant(m)
def look(share):
    seen.append((plant.time, len(plant.state), plant.outputs()["length"].shape, plant.linearise().A.shape[0]))
    repr(plant)
motion = plant.run(commands, 1e-3, progress=look)
times = [one[0] for one in seen]
assert times == sorted(times) and 0.0 < times[-1] < 30.0, times
assert (motion == hydrapod.Plant(m).run(commands, 1e-3)).all()
""", """
plants = [hydrapod.Plant(m) for _ in range(3)]
hydrapod.Plant.run_many(plants, commands, 1e-3, threads=2, progress=lambda share: seen.append([p.time for p in plants]))
assert max(seen[-1]) > 0.0, seen
"""], ids=["run", "run_many"])
def test_progress_may_look_at_its_plant(text):
    """It waited for the lock that its own run held, and Ctrl-C did not end that."""
    done = in_another(looks + text)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("change", ["plant.step(None, 1e-3)", "plant.reset()", "plant.run(commands, 1e-3)",
                                    "setattr(plant, 'state', plant.state)",
                                    "hydrapod.Plant.run_many([plant], commands, 1e-3)"])
@pytest.mark.parametrize("run", ["plant.run(commands, 1e-3, progress=change)",
                                 "hydrapod.Plant.run_many([other, plant], commands, 1e-3, progress=change)"])
def test_progress_changes_nothing_in_its_plant(run, change):
    done = in_another(looks + f"""
plant, other = hydrapod.Plant(m), hydrapod.Plant(m)
def change(share):
    hydrapod.Plant(m).step(None, 1e-3)  # another one is free
    {change}
try:
    {run}
except hydrapod.ComputationError as error:
    print(error)
plant.step(None, 1e-3)
""")
    assert done.returncode == 0 and "in a run" in done.stdout, done.stdout + done.stderr


def test_steps_from_two_threads_during_a_run(heavy):
    """The run is one turn: other steps come before or after it, whatever its progress does."""
    plant, commands = hydrapod.Plant(heavy), np.zeros((1500, 6))
    commands[:] = plant.rest_commands
    runs = [threading.Thread(target=lambda: plant.run(commands, 1e-3, progress=lambda share: time.sleep(1e-3)))
            for _ in range(2)]
    for thread in runs:
        thread.start()
    for _ in range(50):
        plant.step(None, 1e-3)
        plant.outputs()
    for thread in runs:
        thread.join()
    assert plant.time == pytest.approx(3.05, rel=1e-9)


def test_options_are_read_with_the_interpreter(run):
    """A wrong one raised its exception in a thread without the GIL, which tore the interpreter down."""
    with pytest.raises(TypeError, match="spectra"):
        hydrapod.show_record(run, spectra=[])
    with pytest.raises(TypeError, match="spectra"):
        hydrapod._core.show_record({"file": run, "spectra": []}, None)


def test_many_plants_at_once(heavy):
    """Each like one alone, whatever the number of threads."""
    rng = np.random.default_rng(6)
    commands = 0.02 * rng.standard_normal((5, 80, 6))
    alone = np.array([hydrapod.Plant(heavy, fixed_step="0.5 ms").run(one, 1e-3) for one in commands])
    for threads in (1, 3, 0):
        plants = [hydrapod.Plant(heavy, fixed_step="0.5 ms") for _ in range(5)]
        motions, messages = hydrapod.Plant.run_many(plants, commands, 1e-3, threads=threads)
        np.testing.assert_array_equal(motions, alone)
        assert messages == [""] * 5
    shared, _ = hydrapod.Plant.run_many([hydrapod.Plant(heavy, fixed_step="0.5 ms")], commands[0], 1e-3)
    np.testing.assert_array_equal(shared[0], alone[0])
    plant = hydrapod.Plant(heavy)
    for wrong in (commands[:2], commands[:, :, :5], np.full((5, 80, 6), np.nan), commands.astype(complex)):
        with pytest.raises((ValueError, TypeError)):
            hydrapod.Plant.run_many([hydrapod.Plant(heavy) for _ in range(5)], wrong, 1e-3)
    with pytest.raises(ValueError, match="the same"):
        hydrapod.Plant.run_many([plant, plant], commands[0], 1e-3)
    assert hydrapod.Plant.run_many([], np.zeros((0, 3, 6)), 1e-3)[0].shape == (0, 3, 6)


def test_a_plant_whose_model_ends_says_so(heavy):
    plants = [hydrapod.Plant(heavy, fixed_step="0.5 ms") for _ in range(2)]
    commands = np.zeros((2, 6000, 6))
    commands[1] = 1.0  # all legs out, as fast as they go
    motions, messages = hydrapod.Plant.run_many(plants, commands, 1e-3)
    assert messages[0] == "" and np.isfinite(motions[0]).all()
    if messages[1]:
        ended = np.isnan(motions[1]).all(axis=1)
        assert ended.any() and not ended[0] and np.array_equal(ended, np.sort(ended))


def test_views_of_studies_and_state_spaces_keep_them_alive(heavy):
    column = hydrapod.sweep(heavy, {"platform.mass": np.linspace(12e3, 15e3, 200)})["lowest"]
    A = hydrapod.machine_state_space(heavy).A
    copies = np.array(column), np.array(A)
    gc.collect()
    [np.zeros(200 * 40) for _ in range(50)]  # what was freed would be written over
    np.testing.assert_array_equal(column, copies[0])
    np.testing.assert_array_equal(A, copies[1])
    for array in (column, A):
        with pytest.raises(ValueError):
            array[0] = 1.0


def test_stopped_designs_are_no_numbers(heavy):
    with pytest.raises(hydrapod.ComputationError, match="interrupted"):
        hydrapod.frequencies(heavy, {sleeve: np.full(5000, 1.2e6)}, progress=lambda share: True)


def test_large_arrays(heavy):
    """300,000 poses in one call, and designs enough for all threads."""
    lengths = hydrapod.leg_lengths(heavy, np.zeros((300_000, 6)))
    assert lengths.shape == (300_000, 6) and (lengths == lengths[0]).all()
    found = hydrapod.frequencies(heavy, {sleeve: np.full(20_000, 1.2e6)})
    assert found.shape == (20_000, 18) and (found == found[0]).all()


@pytest.mark.parametrize("make", [
    lambda a: a[::-1][::-1], lambda a: np.asfortranarray(a), lambda a: np.repeat(a, 2, axis=1)[:, ::2],
    lambda a: a.astype(">f8"), lambda a: a.astype(np.longdouble), lambda a: a.tolist()])
def test_layouts_of_displacements(heavy, make):
    d = np.random.default_rng(3).normal(0, 0.01, (30, 6))
    given = make(d)
    if isinstance(given, np.ndarray):
        given.setflags(write=False)
    np.testing.assert_array_equal(hydrapod.leg_lengths(heavy, given), hydrapod.leg_lengths(heavy, d))


def test_results_can_be_weakly_referenced_or_say_that_they_cannot(heavy):
    for result in (hydrapod.modes(heavy), hydrapod.sweep(heavy, {"platform.mass": [1e4, 2e4]})):
        weakref.ref(result)


def test_copies_of_results(heavy):
    """A deep copy of an array is one's own; results themselves refuse."""
    import copy

    found = hydrapod.modes(heavy)
    own = copy.deepcopy(found.M)
    own[0, 0] = 0.0
    assert found.M[0, 0] != 0.0
    for result in (found, hydrapod.sweep(heavy, {"platform.mass": [1e4, 2e4]}), hydrapod.machine_state_space(heavy)):
        for attempt in (copy.copy, copy.deepcopy):
            with pytest.raises(TypeError):
                attempt(result)


def test_threads_of_studies_and_kinematics(heavy):
    def one(k):
        study = hydrapod.montecarlo(heavy, {sleeve: "normal ± 5 %"}, samples=200, seed=k % 3, threads=2)
        return study.values.tobytes(), hydrapod.leg_lengths(heavy, np.full(6, 1e-3 * (k % 3))).tobytes()

    with ThreadPoolExecutor(4) as pool:
        many = list(pool.map(one, range(9)))
    assert many == [one(k) for k in range(9)]


def test_studies_stop_with_the_interpreter():
    done = in_another("""
import threading, time, hydrapod
m = hydrapod.read_machine("models/heavy-platform.toml")
s = {"legs.guide_sleeve.stiffness": "normal ± 5 %"}
threading.Thread(target=lambda: hydrapod.montecarlo(m, s, samples=3_000_000), daemon=True).start()
plants = [hydrapod.Plant(m) for _ in range(3)]
import numpy as np
threading.Thread(target=lambda: hydrapod.Plant.run_many(plants, np.zeros((300_000, 6)), 1e-3), daemon=True).start()
time.sleep(0.5)
print("end")
""")
    assert (done.returncode, done.stdout) == (0, "end\n"), done.stderr


@pytest.mark.skipif(sanitized, reason="the sanitizer keeps freed memory for a while")
def test_no_leak(heavy):
    """Memory does not grow with calls."""
    import resource

    def many(count):
        for _ in range(count):
            hydrapod.modes(heavy).M.sum()
            hydrapod.bode(heavy, points=200).H.sum()
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

    many(100)
    before = many(1)
    after = many(200)  # 200 responses of 200 lines and two models: 46 MB if they stayed
    assert after - before < 10_000


def stopped_at(count):
    """A progress that stops at its call of that number."""
    calls = []
    return lambda share: calls.append(share) or len(calls) >= count


@pytest.mark.parametrize("count", [1, 2])
@pytest.mark.parametrize("task", [
    lambda m, run, stop: hydrapod.frf(run, progress=stop), lambda m, run, stop: hydrapod.identify(run, progress=stop),
    lambda m, run, stop: hydrapod.compare(m, run, progress=stop),
    lambda m, run, stop: hydrapod.report(m, measured=run, points=20, progress=stop),
    lambda m, run, stop: hydrapod.root_locus(m, "controller.gain", 3.0, 17.0, 1000, progress=stop)],
    ids=["frf", "identify", "compare", "report", "root locus"])
def test_stopped_tasks_give_no_part_as_if_it_were_the_whole(long_run, task, count):
    """They had responses of the first blocks of a record alone, or said that the record is too short."""
    machine = hydrapod.read_machine(root / "models" / "zhang-jiang-2021.toml")
    with pytest.raises(hydrapod.ComputationError, match="interrupted"):
        task(machine, long_run, stopped_at(count))


def test_a_stopped_diagnosis_says_so(long_run):
    machine = hydrapod.read_machine(root / "models" / "zhang-jiang-2021.toml")
    for count in (1, 4):
        with pytest.raises(hydrapod.ComputationError, match="interrupted"):
            hydrapod.diagnose(machine, long_run, progress=stopped_at(count))


def test_arrays_of_results_cannot_be_written(strong_run, heavy):
    """They are made anew at each access: what is written into one would be lost."""
    machine = hydrapod.read_machine(root / "models" / "zhang-jiang-2021.toml")
    identified, modes = hydrapod.identify(strong_run), hydrapod.modes(heavy)
    results = [modes, modes.rigid, identified, hydrapod.frf(strong_run), hydrapod.system(heavy), hydrapod.check(heavy),
               hydrapod.bode(heavy, points=5), hydrapod.bode(heavy, input="command", points=5),
               hydrapod.modes_at_poses(heavy, ["neutral", "low"]), hydrapod.modes_at_amplitudes(heavy, 1e-3),
               hydrapod.diagnose(machine, identified), hydrapod.sweep(heavy, {sleeve: [1e6]}),
               hydrapod.machine_state_space(heavy), hydrapod.root_locus(heavy, "controller.gain", 3, 5, 3)]
    seen = 0
    for result in results:
        for name in dir(result):
            array = None if name.startswith("_") else getattr(result, name)
            if isinstance(array, np.ndarray):
                seen += 1
                assert not array.flags.writeable, f"{type(result).__name__}.{name}"
    assert seen > 50
    plant = hydrapod.Plant(heavy)
    assert plant.state.flags.writeable and plant.outputs()["length"].flags.writeable  # copies, as their texts say


def test_the_child_of_a_fork_ends(heavy):
    """It has no threads of its parent, for whose calls it would wait."""
    done = in_another("""
import os, sys, threading, time, hydrapod
m = hydrapod.read_machine("models/heavy-platform.toml")
thread = threading.Thread(target=lambda: hydrapod.simulate(m, until=900.0, progress=lambda share: stop), daemon=True)
stop = False
thread.start()
time.sleep(0.3)
child = os.fork()
if child == 0:
    hydrapod.modes(m)
    sys.exit(7)
until = time.monotonic() + 20.0
while (ended := os.waitpid(child, os.WNOHANG))[0] == 0 and time.monotonic() < until:
    time.sleep(0.05)
if ended[0] == 0:
    os.kill(child, 9)
    ended = os.waitpid(child, 0)
print(os.waitstatus_to_exitcode(ended[1]))
stop = True
thread.join()
""", timeout=60)
    assert (done.returncode, done.stdout) == (0, "7\n"), done.stderr


def test_numpy_that_the_build_is_not_for():
    """pybind11 before 2.12 takes the arrays of NumPy 2 for others; newer versions do not."""
    done = in_another("import numpy; numpy.__version__ = '2.1.0'\nimport hydrapod; print('imported')")
    assert done.stdout == "imported\n" or "ImportError" in done.stderr and "numpy<2" in done.stderr, done.stderr


def test_control_c_stops_long_signals():
    began = time.monotonic()
    hydrapod.sample_signals("white z=1 mm", rate=1000, duration=100)
    whole = 100 * (time.monotonic() - began)  # of the 10,000 s below
    timer = threading.Timer(0.1, lambda: os.kill(os.getpid(), signal.SIGINT))
    began = time.monotonic()
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        hydrapod.sample_signals("white z=1 mm", rate=1000, duration=10_000)
    assert time.monotonic() - began < 0.5 * whole


def test_records_from_arrays_have_units_as_those_from_files(tmp_path):
    """"g" of a channel is the acceleration of gravity, not the gram."""
    samples = np.arange(12.0).reshape(4, 3) + 0.5
    units = ["g", "mg", "m/s**2"]
    table = tmp_path / "r.csv"
    rows = [",".join(repr(float(value)) for value in [k / 100, *row]) for k, row in enumerate(samples)]
    table.write_text("time [s],a1 [g],a2 [mg],a3 [m/s**2]\n" + "\n".join(rows) + "\n")
    by_file, by_array = hydrapod.read_record(table), hydrapod.Record(samples, 100.0, ["a1", "a2", "a3"], units=units)
    assert by_array.units == by_file.units == ["m/s^2"] * 3
    np.testing.assert_array_equal(by_array.samples, by_file.samples)
    np.testing.assert_allclose(by_array["a1"], 9.80665 * samples[:, 0], rtol=1e-15)
    assert any("9.80665" in text for text in by_array.warnings)
    assert any("EU" in text for text in hydrapod.Record(samples[:, :1], 100.0, "a", units="EU").warnings)
    assert hydrapod.Record(samples[:, :1], 100.0, "a", units="mm").units == ["m"]
