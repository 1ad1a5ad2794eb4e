"""The machine in real time and the rig on it, as from the command line."""

import importlib.util
import json
import os
import queue
import subprocess
import threading

import numpy as np
import pytest
from conftest import call_program, program, root

import hydrapod

spec = importlib.util.spec_from_file_location("client", root / "examples" / "realtime" / "client.py")
client = importlib.util.module_from_spec(spec)
spec.loader.exec_module(client)
by_the_clock = ("lateness", "command age", "deadline")


@pytest.fixture(scope="module")
def zhang():
    return hydrapod.read_machine(root / "models" / "zhang-jiang-2021.toml")


def follow(place, steps=60):
    """A client in lock-step: every command is one sample."""
    host, port = place.rsplit(":", 1)
    one = client.Client(host, int(port))
    positions = []
    for k in range(steps):
        one.send(client.POSE, (0.0, 0.0, 1e-3 * (1 - np.cos(0.05 * k)), 0.0, 0.0, 0.0))
        positions.append(one.receive()["platform"])
    one.send(client.LEAVE)
    return np.array(positions)


def served(machine, work, **options):
    """What serve() and work(place) give, side by side."""
    places, results = queue.Queue(), []
    thread = threading.Thread(target=lambda: results.append(
        hydrapod.serve(machine, 0, ready=places.put, **options)))
    thread.start()
    try:
        done = work(places.get(timeout=60))
    finally:
        thread.join(timeout=60)
    return results[0], done


def served_by_program(machine, work, *options):
    environment = {name: value for name, value in os.environ.items() if name != "LD_PRELOAD"}
    server = subprocess.Popen([program, "serve", machine.path, "--udp", "0", *options, "--format", "json"],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=root, env=environment)
    while "listening at " not in (line := server.stderr.readline()):
        assert line, "the server ended"
    done = work(line.split("listening at ")[1].strip())
    out, _ = server.communicate(timeout=60)
    return json.loads(out), done


def test_a_client_in_lock_step_gets_the_same_machine(zhang, tmp_path):
    """The same bits from both servers, in the packets, the record and the counters."""
    ours, theirs = tmp_path / "ours.h5", tmp_path / "theirs.h5"
    found, positions = served(zhang, follow, lock_step=True, once=True, record=ours)
    document, expected = served_by_program(zhang, follow, "--lock-step", "--once", "-o", str(theirs))
    np.testing.assert_array_equal(positions, expected)
    assert positions[-1, 2] > 1e-4  # it has moved
    a, b = hydrapod.read_record(ours), hydrapod.read_record(theirs)
    assert a.channels == b.channels
    same = [k for k, name in enumerate(a.channels) if not any(word in name for word in by_the_clock)]
    assert len(same) > 50
    np.testing.assert_array_equal(a.samples[:, same], b.samples[:, same])
    mine = found.to_dict()
    del document["reproduction"]
    assert list(mine) == list(document)
    for key in set(mine) - {"place", "step", "step_processor"}:
        assert mine[key] == document[key], key
    assert found.samples == document["samples"] and found.state == "parked" and found.finished
    assert found.record == str(ours) and found.place.startswith("127.0.0.1:")


def test_without_a_client_it_serves_for_its_duration(zhang):
    found, _ = served(zhang, lambda place: None, duration="0.2 s", accelerometers=[])
    assert found.finished and found.message == "" and found.state == "waiting"
    assert found.time == pytest.approx(0.2, abs=1e-9) and found.samples == round(0.2 / found.sample_time) + 1  # both ends
    assert "waiting" in repr(found)


def test_progress_stops_it(zhang):
    found, _ = served(zhang, lambda place: None, progress=lambda share: True)
    assert not found.finished and found.message == "interrupted"


def test_exceptions_of_ready_come_through(zhang):
    with pytest.raises(ZeroDivisionError):
        hydrapod.serve(zhang, 0, duration=5, ready=lambda place: 1 / 0)


def test_layout(zhang):
    printed = call_program("serve", zhang.path, "--print-layout").stdout
    assert hydrapod.packet_layout(zhang) == printed
    assert len(hydrapod.packet_layout(zhang, accelerometers=[])) < len(printed)


def test_rig_on_hardware(zhang, tmp_path):
    """The server stands for the machine; in lock-step each sample is one command, so that the record has the same bits
    as the one of the command line."""
    options = dict(duration="0.3 s", settling="0.1 s", excite="noise all=0.1 mm, to=60", accelerometers=[], seed=4,
                   limits={"length": "60 mm", "error": 0.02}, ramp="0.1 s", watchdog="5 s")
    run, done = served(zhang, lambda place: hydrapod.rig(zhang, tmp_path / "ours.h5", hardware=place, **options),
                       lock_step=True, once=True, accelerometers=[])
    assert done.finished and done.hardware["received"] > 300 and not done.hardware["ramped_down"]
    assert done.hardware["malformed"] == done.hardware["refused"] == 0
    assert done.samples == round(0.3 / zhang["controller.sample_time"]) and run.samples > done.samples
    _, theirs = served_by_program(zhang, lambda place: call_program(
        "rig", zhang.path, "--hardware", place, "--duration", "0.3 s", "--settling", "0.1 s", "--excite",
        "noise all=0.1 mm, to=60", "--accelerometer", "none", "--seed", "4", "--limit", "length=60 mm, error=0.02",
        "--ramp", "0.1 s", "--watchdog", "5 s", "-o", tmp_path / "theirs.h5"),
        "--lock-step", "--once", "--accelerometer", "none")
    assert theirs.returncode == 0, theirs.stderr
    a, b = hydrapod.read_record(tmp_path / "ours.h5"), hydrapod.read_record(tmp_path / "theirs.h5")
    assert a.channels == b.channels and len(a) == len(b) == done.samples
    if done.hardware["resent"] == 0 and "commands sent again: 0" in theirs.stderr:  # on a busy computer there are some
        np.testing.assert_array_equal(a.samples, b.samples)


@pytest.mark.parametrize("call, error, words", [
    (lambda m: hydrapod.serve(m, -1), ValueError, "address"),
    (lambda m: hydrapod.serve(m, 4747.0), TypeError, "address"),
    (lambda m: hydrapod.serve(m, "nowhere:"), ValueError, "address"),
    (lambda m: hydrapod.serve(m, 0, bind="0.0.0.0"), ValueError, "key"),
    (lambda m: hydrapod.serve(m, 0, bind="::1", shared_memory="x"), ValueError, "shared memory"),
    (lambda m: hydrapod.serve(m, 0, key=root / "none.key"), ValueError, "none.key"),
    (lambda m: hydrapod.serve(m, 0, layout=root / "README.md"), ValueError, "README.md"),
    (lambda m: hydrapod.serve(m, 0, hold=0), ValueError, "hold"),
    (lambda m: hydrapod.serve(m, 0, ramp="1 m"), ValueError, "ramp"),
    (lambda m: hydrapod.serve(m, 0, rest="up=3"), ValueError, "rest"),
    (lambda m: hydrapod.serve(m, 0, duration=-1), ValueError, "duration"),
    (lambda m: hydrapod.serve(m, 0, fifo=100), ValueError, "fifo"),
    (lambda m: hydrapod.serve(m, 0, busy="0.95 ms"), ValueError, "0.9 of the sample time"),
    (lambda m: hydrapod.serve(m, 0, once="yes"), TypeError, "once"),
    (lambda m: hydrapod.serve(m, 0, ready=3), TypeError, "ready"),
    (lambda m: hydrapod.serve(m, 0, tolerance=1.0), ValueError, "tolerance"),
    (lambda m: hydrapod.serve(m, 0, record="r.doc", duration=0.1), ValueError, r"\.h5"),
    (lambda m: hydrapod.serve("m.toml"), TypeError, "Machine"),
    (lambda m: hydrapod.packet_layout(m, accelerometers=["a, at=1"]), ValueError, "accelerometer"),
    (lambda m: hydrapod.rig(m, "r.h5", limits="length=2 mm"), ValueError, "limits: belongs to a rig on a real"),
    (lambda m: hydrapod.rig(m, "r.h5", hardware=1, drop_outs=0.1), ValueError, "drop_outs: belongs to the simulated"),
    (lambda m: hydrapod.rig(m, "r.h5", hardware=1, anti_alias=False), ValueError, "anti_alias: belongs"),
    (lambda m: hydrapod.rig(m, "r.h5", hardware=1, shared_memory="x"), ValueError, "in place of an address"),
    (lambda m: hydrapod.rig(m, "r.h5", hardware=1, limits="lenght=2 mm"), ValueError, "length"),
    (lambda m: hydrapod.rig(m, "r.h5", hardware=1, limits={"length": -1}), ValueError, "more than 0"),
    (lambda m: hydrapod.rig(m, "r.h5", hardware=1, limits=3), TypeError, "limits"),
    (lambda m: hydrapod.rig(m, "r.h5", hardware=70000), ValueError, "hardware"),
    (lambda m: hydrapod.rig(m, "r.h5", hardware=1.5), TypeError, "hardware"),
    (lambda m: hydrapod.rig(m, "r.h5", hardware=9, entry="wrench", duration="0.1 s"), ValueError, "wrench")])
def test_wrong_use(zhang, tmp_path, monkeypatch, call, error, words):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(error, match=words):
        call(zhang)
    assert list(tmp_path.iterdir()) == []


def test_a_rig_without_a_machine_says_so(zhang, tmp_path):
    with pytest.raises(hydrapod.InputError):
        hydrapod.rig(zhang, tmp_path / "r.h5", hardware=9, duration="0.1 s")
    assert list(tmp_path.iterdir()) == []
