"""Ctrl-C and progress stop long work at once."""

import os
import signal
import threading
import time

import numpy as np
import pytest

import hydrapod


def test_control_c_stops_reading_and_writing(tmp_path):
    samples = np.random.default_rng(1).standard_normal((400_000, 6))
    record = hydrapod.Record(samples, 1000.0, list("abcdef"))
    for call in (lambda: record.write(tmp_path / "r.csv"), lambda: hydrapod.read_record(tmp_path / "r.csv")):
        began = time.monotonic()
        call()
        whole = time.monotonic() - began
        before = (tmp_path / "r.csv").stat().st_mtime_ns
        timer = threading.Timer(0.1 * whole, lambda: os.kill(os.getpid(), signal.SIGINT))
        began = time.monotonic()
        timer.start()
        with pytest.raises(KeyboardInterrupt):
            call()
        assert time.monotonic() - began < 0.7 * whole
    # what stood there stays, and no part is left
    assert [path.name for path in tmp_path.iterdir()] == ["r.csv"] and (tmp_path / "r.csv").stat().st_mtime_ns == before
    np.testing.assert_array_equal(hydrapod.read_record(tmp_path / "r.csv").samples, samples)


def test_control_c_stops(heavy):
    timer = threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT))
    began = time.monotonic()
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        hydrapod.simulate(heavy, until=900.0)
    assert time.monotonic() - began < 20.0


def test_control_c_stops_modes_at_many_poses(heavy):
    poses = [f"z={-k / 1000} mm" for k in range(50_000)]
    timer = threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT))
    began = time.monotonic()
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        hydrapod.modes_at_poses(heavy, poses)
    assert time.monotonic() - began < 3.0
    shares = []
    with pytest.raises(hydrapod.ComputationError, match="interrupted"):
        hydrapod.modes_at_poses(heavy, poses, progress=lambda share: shares.append(share) or share > 0.0)
    assert shares == sorted(shares) and shares[-1] < 0.5


def test_control_c_stops_modes_at_amplitudes(heavy):
    contact = heavy.with_({"legs.guide_sleeve.gap": "3.6 mm"})
    amplitudes = np.geomspace(1e-6, 5e-3, 200_000)
    timer = threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT))
    began = time.monotonic()
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        hydrapod.modes_at_amplitudes(contact, amplitudes)
    assert time.monotonic() - began < 5.0
    shares = []
    with pytest.raises(hydrapod.ComputationError, match="interrupted"):
        hydrapod.modes_at_amplitudes(contact, amplitudes, progress=lambda share: shares.append(share) or len(shares) > 2)
    assert shares == sorted(shares) and len(shares) == 3 and shares[-1] < 0.5
    shares.clear()
    told = hydrapod.modes_at_amplitudes(contact, [1e-4, 1e-3], progress=shares.append)
    assert told.json == hydrapod.modes_at_amplitudes(contact, [1e-4, 1e-3]).json
    assert shares == sorted(shares) and all(0.0 <= share <= 1.0 for share in shares)
