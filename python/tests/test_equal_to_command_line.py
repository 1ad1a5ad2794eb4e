"""Every result equals the JSON of the command line, number by number, bit for bit."""

import pytest
from conftest import command_line

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


def test_order_of_keys(model):
    done = hydrapod.modes(hydrapod.read_machine(model)).to_dict()
    assert list(done) == list(command_line("modes", model, "--format", "json"))


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


def test_report(heavy, tmp_path):
    path = tmp_path / "report.html"
    result = hydrapod.report(heavy, path, title="A & B", points=50)
    assert path.read_text().startswith("<!")
    assert result.to_dict()["title"] == "A & B"
