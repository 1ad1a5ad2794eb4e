"""Every result equals the JSON of the command line, number by number, bit for bit."""

import json
import math

import numpy as np
import pytest
from conftest import call_program, command_line, root
from conftest import program_of as program

import hydrapod

# Numbers come as the shortest text that reads back to the same double, so equal objects are equal bits.
# NaN stands as null in both.

tasks = {
    "modes": (["modes"], lambda m: hydrapod.modes(m)),
    "matrices": (["modes", "--matrices"], lambda m: hydrapod.modes(m, matrices=True)),
    "system": (["modes", "--system"], lambda m: hydrapod.system(m)),
    "open loop": (["modes", "--open-loop", "--pade", "3"],
                  lambda m: hydrapod.system(m, closed=False, pade_order=3)),
    "root locus": (["modes", "--root-locus", "controller.gain=3:17:4"],
                   lambda m: hydrapod.root_locus(m, "controller.gain", 3.0, 17.0, 4)),
    "bode": (["bode", "--points", "37"], lambda m: hydrapod.bode(m, points=37)),
    "bode at a point": (
        ["bode", "--points", "23", "--from", "1.3", "--to", "211 rad/s", "--output", "acceleration",
         "--input", "actuator", "--point", "0.1,0,250 mm"],
        lambda m: hydrapod.bode(m, points=23, from_=1.3, to="211 rad/s", output="acceleration",
                                input="actuator", point=(0.1, 0, "250 mm"))),
    "command": (["bode", "--input", "command", "--points", "19"],
                lambda m: hydrapod.bode(m, input="command", points=19)),
    "check": (["check"], lambda m: hydrapod.check(m)),
    "sensitivity": (["sensitivity"], lambda m: hydrapod.sensitivity(m)),
    "sensitivity to one": (["sensitivity", "--parameter", "platform.mass"],
                           lambda m: hydrapod.sensitivity(m, "platform.mass")),
    "simulation": (["simulate", "--command", "step z=1.7 mm", "--until", "0.31"],
                   lambda m: hydrapod.simulate(m, "step z=1.7 mm", until=0.31)),
    "other simulation": (
        ["simulate", "--command", "sine x=0.3 mm, frequency=2 Hz", "--until", "0.2", "--integrator", "fixed",
         "--step", "0.2 ms", "--ideal-sensors", "--seed", "3"],
        lambda m: hydrapod.simulate(m, ["sine x=0.3 mm, frequency=2 Hz"], until="200 ms", integrator="fixed",
                                    step="0.2 ms", ideal_sensors=True, seed=3)),
    "simulation without a controller": (
        ["simulate", "--actuators", "springs", "--initial", "x=0.2 mm", "--wrench", "sine z=90 N, frequency=3 Hz",
         "--until", "0.2"],
        lambda m: hydrapod.simulate(m, actuators="springs", initial="x=0.2 mm", until=0.2,
                                    wrench="sine z=90 N, frequency=3 Hz")),
    "modes at poses": (["modes", "--pose", "neutral", "--pose", "z=2 mm", "--pose", "z=4 mm, ry=0.1 deg"],
                       lambda m: hydrapod.modes_at_poses(m, ["neutral", "z=2 mm", "z=4 mm, ry=0.1 deg"])),
    "modes at amplitudes": (["modes", "--amplitude", "1 mm"],
                            lambda m: hydrapod.modes_at_amplitudes(m, 1e-3)),
    "comparison": (["compare", "--set", "platform.mass=1234.5"],
                   lambda m: hydrapod.compare(m.path, overrides={"platform.mass": 1234.5})),
    "comparison of poses": (
        ["compare", "--pose", "neutral", "--pose", "z=3 mm", "--model", "rigid", "--level", "1"],
        lambda m: hydrapod.compare(m.path, poses=["neutral", "z=3 mm"], model="rigid", level="1 %")),
    "design": (
        ["design", "--change", "platform.mass=700:1300 kg", "--change", "legs.guide_sleeve.stiffness=1:50 kN/mm",
         "--want", "lowest >= 4 Hz", "--pose", "neutral", "--pose", "z=3 mm", "--maximise", "platform.mass",
         "--samples", "64", "--starts", "2", "--seed", "5"],
        lambda m: hydrapod.design(m, {"platform.mass": (700, 1300), "legs.guide_sleeve.stiffness": "1:50 kN/mm"},
                                  want="lowest >= 4 Hz", poses=["neutral", "z=3 mm"], maximise="platform.mass",
                                  samples=64, starts=2, seed=5)),
    "attribution": (["diagnose", "--want", "x=3 %"], lambda m: hydrapod.diagnose(m, want="x=3 %")),
}


@pytest.mark.parametrize("task", tasks)
def test_task(model, task):
    arguments, call = tasks[task]
    result = call(hydrapod.read_machine(model))
    expected = command_line(arguments[0], model, *arguments[1:], "--format", "json")
    assert result.to_dict() == expected


def test_variants(model):
    machine = hydrapod.read_machine(model, pose="z=7 mm, ry=0.4 deg", model="rigid")
    machine = machine.with_({"platform.mass": 1234.5678901234567}).with_(**{"environment.gravity": "9.7 m/s^2"})
    assert hydrapod.modes(machine).to_dict() == command_line(
        "modes", model, "--pose", "z=7 mm, ry=0.4 deg", "--model", "rigid",
        "--set", "platform.mass=1234.5678901234567", "--set", "environment.gravity=9.7 m/s^2",
        "--format", "json")


@pytest.mark.parametrize("text", [
    "2 %", " 2 % ", "drop 2 %", "drop <= 2 %", "x <= 2 %", "x=2 %", "rx = 3 %", "6 Hz", "6", "0.05",
    "x=6 Hz", "x >= 6 Hz", "rz>=6", "lowest >= 5 Hz"])
def test_wants_are_those_of_the_command_line(text):
    machine = hydrapod.read_machine(root / "models" / "heavy-platform.toml")
    assert hydrapod.diagnose(machine, want=text).to_dict() == command_line(
        "diagnose", machine.path, "--want", text, "--format", "json")


@pytest.mark.parametrize("text", ["", "x", "x <= 5 Hz", "x >= 2 %", "lowest <= 2 %", "drop >= 5 Hz", "up=5 Hz", "0 %",
                                  "100 %", "-5 Hz", "0", "5 parsecs", "nonsense", "x >", "drop", "%"])
def test_wants_that_neither_takes(heavy, text):
    assert call_program("diagnose", heavy.path, f"--want={text}").returncode != 0
    with pytest.raises(hydrapod.InputError, match="want"):
        hydrapod.diagnose(heavy, want=text)


def test_many_poses_are_computed_in_parts():
    """As the command line does it at once."""
    machine = hydrapod.read_machine(root / "models" / "zhang-jiang-2021.toml")
    poses = [f"z={round(20 * np.sin(0.7 * k), 3)} mm, rx={round(2 * np.sin(1.9 * k), 3)} deg" for k in range(75)]
    found = hydrapod.modes_at_poses(machine, poses)
    asked = [word for pose in poses for word in ("--pose", pose)]
    assert found.to_dict() == command_line("modes", machine.path, *asked, "--format", "json")


def test_order_of_keys(model):
    done = hydrapod.modes(hydrapod.read_machine(model)).to_dict()
    assert list(done) == list(command_line("modes", model, "--format", "json"))


studies = {
    "montecarlo": (["montecarlo", "--vary", "platform.mass=uniform ± 10 %", "--vary",
                    "legs.rod.mass=normal ± 5 % per leg", "--want", "lowest >= 5 Hz", "--samples", "150",
                    "--seed", "9"],
                   lambda m: hydrapod.montecarlo(
                       m, {"platform.mass": "uniform ± 10 %", "legs.rod.mass": "normal ± 5 % per leg"},
                       want="lowest >= 5 Hz", samples=150, seed=9)),
    "indices": (["montecarlo", "--vary", "platform.mass=uniform ± 10 %", "--vary", "legs.rod.mass=uniform ± 10 %",
                 "--indices", "--samples", "32", "--design", "sobol", "--modes", "3"],
                lambda m: hydrapod.montecarlo(
                    m, {"platform.mass": "uniform ± 10 %", "legs.rod.mass": "uniform ± 10 %"}, indices=True,
                    samples=32, design="sobol", modes=3)),
    "sweep": (["sweep", "--over", "platform.mass=700:900:4 kg", "--over", "legs.rod.mass=11, 13, 17.5", "--buckling"],
              lambda m: hydrapod.sweep(m, {"platform.mass": "700:900:4 kg", "legs.rod.mass": [11, 13, 17.5]},
                                       buckling=True)),
    "sweep of some outputs": (["sweep", "--over", "platform.mass=700:900:4 kg", "--only", "drop_z", "--only", "modes",
                               "--only", "sag", "--want", "x >= 3 Hz"],
                              lambda m: hydrapod.sweep(m, {"platform.mass": "700:900:4 kg"},
                                                       only=("drop_z", "modes", "sag"), want="x >= 3 Hz")),
    "sweep that fills": (["sweep", "--over", "platform.mass=700:900 kg", "--design", "latin", "--samples", "20"],
                         lambda m: hydrapod.sweep(m, {"platform.mass": "700:900 kg"}, design="latin", samples=20)),
    "map": (["map", "--over", "x=-3:3:4 mm", "--over", "rz=-0.2:0.2:3 deg", "--want", "drop <= 3 %"],
            lambda m: hydrapod.workspace_map(m, {"x": "-3:3:4 mm", "rz": "-0.2:0.2:3 deg"}, want="drop <= 3 %")),
    "refined map": (["map", "--over", "x=-60:60:5 mm", "--over", "z=-50:30:4 mm", "--refine", "2"],
                    lambda m: hydrapod.workspace_map(m, {"x": "-60:60:5 mm", "z": "-50:30:4 mm"}, refine=2)),
    "map over the worst": (["map", "--over", "x=-3:3:3 mm", "--over", "z=-1:1:3 mm", "--worst-over", "rx=-0.2:0.2:3 deg",
                            "--also", "stiffness", "--want", "lowest >= 3 Hz"],
                           lambda m: hydrapod.workspace_map(
                               m, {"x": "-3:3:3 mm", "z": "-1:1:3 mm"}, worst_over={"rx": "-0.2:0.2:3 deg"},
                               also="stiffness", want="lowest >= 3 Hz")),
    "correlated": (["montecarlo", "--vary", "platform.mass=normal ± 1 %", "--vary",
                    "legs.rod.mass=normal ± 5 % per leg correlated 0.8", "--correlate",
                    "platform.mass, legs.rod.mass = -0.3", "--samples", "150"],
                   lambda m: hydrapod.montecarlo(
                       m, {"platform.mass": "normal ± 1 %", "legs.rod.mass": "normal ± 5 % per leg correlated 0.8"},
                       correlate="platform.mass, legs.rod.mass = -0.3", samples=150)),
}


@pytest.mark.parametrize("task", studies)
def test_study(model, task, tmp_path):
    arguments, call = studies[task]
    rows = tmp_path / "rows.csv"
    expected = command_line(arguments[0], model, *arguments[1:], "--results", tmp_path / "rows.h5", "--csv", rows,
                            "--format", "json")
    result = call(hydrapod.read_machine(model))
    assert result.to_dict() == expected
    lines = [line for line in rows.read_text().splitlines() if not line.startswith("#")]
    assert lines[0] == ",".join(f"{name} [{unit}]" for name, unit in zip(result.names, result.units))
    written = [[float(cell) if cell else math.nan for cell in line.split(",")] for line in lines[1:]]
    np.testing.assert_array_equal(result.values, np.array(written))  # 17 digits: every bit


exports = {"mat": ["machine.mat"], "npz": ["machine.npz"], "json": ["machine.json"], "uff": ["machine.uff"],
           "mtx": ["machine.M.mtx", "machine.K.mtx", "machine.C.mtx"], "dmig": ["machine.pch"],
           "mjcf": ["machine.xml"], "sdf": ["machine.sdf"], "urdf": ["machine.urdf", "machine.closures.json"]}


@pytest.mark.parametrize("format", exports)
def test_export(model, format, tmp_path):
    """The same bytes in the files."""
    ending = exports[format][0].rsplit(".", 1)[1]
    ours, theirs = tmp_path / "ours", tmp_path / "theirs"
    ours.mkdir(), theirs.mkdir()
    program("export", model, "--to", format, "--approximate", "-o", theirs / f"machine.{ending}")
    done = hydrapod.export(hydrapod.read_machine(model), ours / f"machine.{ending}", to=format, approximate=True)
    assert [path.rsplit("/", 1)[1] for path in done.files] == exports[format]
    for name in exports[format]:
        if format == "mat":  # its header has the time of writing
            assert (ours / name).read_bytes()[128:] == (theirs / name).read_bytes()[128:]
        else:
            assert (ours / name).read_bytes() == (theirs / name).read_bytes()


@pytest.mark.parametrize("options", [
    {"system": "loop", "pade_order": 3}, {"system": "plant", "inputs": "wrench.fz", "sample_time": "1 ms"},
    {"system": "loop", "sampled": True}, {"outputs": ["z", "x"], "point": (0.1, 0, "20 mm")}], ids=str)
def test_export_of_state_space(model, options, tmp_path):
    machine = hydrapod.read_machine(model)
    found = hydrapod.machine_state_space(machine, **options)
    flags = {"system": "--system", "pade_order": "--pade", "inputs": "--inputs", "sample_time": "--sample-time"}
    arguments = []
    for key, value in options.items():
        if key == "sampled":
            arguments.append("--sampled")
        elif key == "outputs":
            arguments += ["--outputs", ",".join(value)]
        elif key == "point":
            arguments += ["--point", "0.1,0,20 mm"]
        else:
            arguments += [flags[key], str(value)]
    program("export", model, "--to", "json", *arguments, "-o", tmp_path / "machine.json")
    written = json.loads((tmp_path / "machine.json").read_text())
    assert found.to_dict() == written
    np.testing.assert_array_equal(found.A, written["A"])


measurements = {
    "frf": (["frf"], lambda run: hydrapod.frf(run)),
    "frf h1": (["frf", "--estimator", "h1", "--block", "256", "--overlap", "25", "--settling", "0.5 s",
                "--from-excitation"],
               lambda run: hydrapod.frf(run, estimator="h1", block=256, overlap="25 %", settling=0.5,
                                        input_from="excitation")),
    "identify": (["identify"], lambda run: hydrapod.identify(run)),
    "identify in a band": (["identify", "--from", "3", "--to", "14 Hz", "--against", "none"],
                           lambda run: hydrapod.identify(run, from_=3, to="14 Hz", against="none")),
}


@pytest.mark.parametrize("task", measurements)
def test_measurement(run, task):
    arguments, call = measurements[task]
    expected = command_line(arguments[0], run, *arguments[1:], "--format", "json")
    assert call(run).to_dict() == expected


@pytest.mark.parametrize("task", measurements)
def test_measurement_in_memory(run, task, tmp_path):
    """Without a file, the same bits."""
    call = measurements[task][1]
    found, expected = (call(source).to_dict() for source in (hydrapod.read_record(run), run))
    assert found.pop("records") == ["record"] and expected.pop("records") == [run]
    assert found == expected


def test_several_records_in_memory(run):
    record = hydrapod.read_record(run)
    other = hydrapod.Record(record.samples[::-1], record.sample_rate, record.channels, units=record.units,
                            roles=record.roles, directions=record.directions)
    found = hydrapod.frf([record, other], machine=None)
    assert found.to_dict()["records"] == ["record 1", "record 2"]
    with pytest.raises(hydrapod.InputError, match="record 2.*twice"):
        hydrapod.frf([record, record])


@pytest.mark.parametrize("task, ending", [(task, ending) for task in ("frf", "identify")
                                          for ending in ("csv", "uff", "mat", "h5") if (task, ending) != ("identify", "h5")])
def test_results_are_written_as_the_command_line_writes_them(run, tmp_path, task, ending):
    program(task, run, "-o", tmp_path / f"theirs.{ending}")
    result = getattr(hydrapod, task)(run)
    result.write(str(tmp_path / f"ours.{ending}"))
    ours, theirs = ((tmp_path / f"{name}.{ending}").read_bytes() for name in ("ours", "theirs"))
    assert ours[128:] == theirs[128:] if ending == "mat" else ours == theirs  # a MAT file has the time of writing
    result.write(str(tmp_path / "ours.json"))
    assert json.loads((tmp_path / "ours.json").read_text()) == result.to_dict()
    with pytest.raises(hydrapod.InputError, match="json, csv, uff, mat"):
        result.write(str(tmp_path / "ours.txt"))


def test_a_whole_record_is_asked_for(run):
    """Of a loop it cannot be taken at once, which `--whole-record` says too."""
    with pytest.raises(hydrapod.ComputationError, match="from the whole record at once"):
        hydrapod.identify(run, whole_record=True)


@pytest.fixture(scope="module")
def targets(tmp_path_factory, heavy):
    """Modes of the machine with softer seals, as somebody would list them."""
    found = hydrapod.modes(heavy.with_({"legs.guide_sleeve.stiffness": "0.83 MN/m"}))
    path = tmp_path_factory.mktemp("targets") / "modes.csv"
    rows = [f"neutral,{f:.4f} Hz" for f in found.frequency_hz[:6]]
    path.write_text("pose,frequency\n" + "\n".join(rows) + "\n")
    return str(path)


def test_calibrate(heavy, targets):
    result = hydrapod.calibrate(heavy, targets, {"legs.guide_sleeve.stiffness": ("0.1 MN/m", "9 MN/m")},
                                starts=2, seed=5)
    assert result.to_dict() == command_line(
        "calibrate", heavy.path, "--targets", targets, "--free",
        "legs.guide_sleeve.stiffness=0.1 MN/m..9 MN/m", "--starts", "2", "--seed", "5", "--format", "json")
    # 0.83 MN/m was put in; frequencies are written to 1e-4 Hz of some 4 Hz
    assert result.values[0] == pytest.approx(0.83e6, rel=1e-3)


def test_diagnose(heavy, targets):
    result = hydrapod.diagnose(heavy, targets, model_error="0.3 %")
    assert result.to_dict() == command_line(
        "diagnose", heavy.path, "--measured", targets, "--model-error", "0.3", "--format", "json")
    assert result.summary and result.hypotheses


def test_comparison_of_records(strong_run):
    path = str(root / "models" / "zhang-jiang-2021.toml")
    assert hydrapod.compare(path, strong_run).to_dict() == command_line("compare", path, strong_run, "--format", "json")


@pytest.mark.parametrize("entry, excitation", [("command", "white all=0.05 mm"),
                                               ("wrench", "multisine all=90, to=40, period=1")])
def test_rig(model, entry, excitation, tmp_path):
    """The same samples in the record, and the same words about them but for the notes: the program names the file it read."""
    theirs, ours = (str(tmp_path / name) for name in ("theirs.h5", "ours.h5"))
    program("rig", model, "--excite", excitation, "--entry", entry, "--duration", "1.5", "--rate", "200", "--seed", "11",
            "--settling", "0.2", "--above-limits", "-o", theirs)
    done = hydrapod.rig(hydrapod.read_machine(model), ours, excite=excitation, entry=entry, duration="1.5 s", rate=200,
                        seed=11, settling=0.2, above_limits=True)
    assert done.finished and done.record == ours
    found, expected = hydrapod.read_record(ours), hydrapod.read_record(theirs)
    np.testing.assert_array_equal(found.samples, expected.samples)
    for name in ("channels", "units", "roles", "directions", "sample_rate", "start", "title", "machine_text"):
        assert getattr(found, name) == getattr(expected, name), name


reports = {
    "report": (["--points", "40", "--title", "A & B"], dict(points=40, title="A & B")),
    "report of two poses": (["--points", "20", "--pose", "neutral", "--pose", "z=3 mm", "--modes", "1,3", "--command",
                             "step z=1 mm", "--until", "0.2"],
                            dict(points=20, poses=["neutral", "z=3 mm"], modes=[1, 3], commands="step z=1 mm",
                                 until=0.2)),
}


@pytest.mark.parametrize("task", reports)
def test_report_of_a_model(model, task):
    arguments, options = reports[task]
    found = hydrapod.report(hydrapod.read_machine(model), **options).to_dict()
    assert found == command_line("report", model, *arguments, "--format", "json", "-o", "-")


def test_report_of_a_diagnosis(strong_run):
    path = str(root / "models" / "zhang-jiang-2021.toml")
    found = hydrapod.report(hydrapod.read_machine(path), measured=strong_run, diagnose=strong_run, want="x=5 Hz", points=20)
    assert found.to_dict() == command_line("report", path, "--measured", strong_run, "--diagnose", strong_run, "--want",
                                           "x=5 Hz", "--points", "20", "--format", "json", "-o", "-")


def test_report(heavy, tmp_path):
    path = tmp_path / "report.html"
    result = hydrapod.report(heavy, path, title="A & B", points=50)
    assert path.read_text().startswith("<!")
    assert result.to_dict()["title"] == "A & B"


def test_report_of_a_measurement(strong_run):
    """With the band, the inputs and the goal that `hydrapod report` takes."""
    machine = hydrapod.read_machine(root / "models" / "zhang-jiang-2021.toml")
    band = dict(from_=4, to="9 Hz", against="none", input_from="excitation")
    found = hydrapod.report(machine, measured=strong_run, diagnose=strong_run, want="x=5 Hz", points=20, **band).to_dict()
    alone = hydrapod.identify(strong_run, machine=machine, **band).to_dict()
    assert found["identification"]["band_hz"] == alone["band_hz"]
    assert found["identification"]["modes"] == alone["modes"]
    assert any("5.00 Hz in x" in sentence for sentence in found["diagnosis"]["summary"])


def test_results_are_inputs_as_their_files_are(heavy, strong_run, tmp_path):
    machine = hydrapod.read_machine(root / "models" / "zhang-jiang-2021.toml")
    identified, responses = hydrapod.identify(strong_run), hydrapod.frf(strong_run)
    modes, lines = tmp_path / "modes.json", tmp_path / "responses.json"
    modes.write_text(identified.json), lines.write_text(responses.json)
    free = {"legs.guide_sleeve.stiffness": (1e4, 1e7)}
    by_result, by_file = (hydrapod.calibrate(machine, given, free, starts=1) for given in (identified, modes))
    assert by_result.values == by_file.values and by_result.misfit == by_file.misfit
    assert hydrapod.diagnose(machine, identified).summary == hydrapod.diagnose(machine, modes).summary
    np.testing.assert_array_equal(hydrapod.identify(responses).frequency_hz, hydrapod.identify(lines).frequency_hz)
    compared = hydrapod.compare(machine, identified)
    np.testing.assert_array_equal(compared.to_records().mac, hydrapod.compare(machine, modes).to_records().mac)
    assert "comparison" in hydrapod.report(machine, compare=compared, points=20).to_dict()


def test_machines_of_files_are_called_by_their_files(heavy, strong_run):
    path = str(root / "models" / "zhang-jiang-2021.toml")
    machine = hydrapod.read_machine(path)
    assert hydrapod.compare(machine, strong_run).to_dict() == command_line("compare", path, strong_run, "--format",
                                                                           "json")
    changed = machine.with_({"platform.mass": 1000.0})
    assert hydrapod.compare(machine, changed).things[0] == path and hydrapod.compare(machine, changed).things[1] != path
    assert hydrapod.compare(hydrapod.Machine(machine.text, path=path + ".none"), changed).things[0] != path
