"""`hydrapod record` from Python: the same numbers and bytes as from the command line, and wrong use."""

import re

import numpy as np
import pytest
from conftest import call_program, command_line

import hydrapod


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("records")


@pytest.fixture(scope="module")
def example(folder):
    """10 s at 1 kHz: a sine of 40 Hz, one of 7 Hz that is clipped, one with gaps."""
    t = 0.001 * np.arange(10_000)
    samples = np.stack([0.01 * np.sin(2 * np.pi * 40 * t), np.clip(3 * np.sin(2 * np.pi * 7 * t + 0.1), -2, 2),
                        np.cos(2 * np.pi * 3 * t)], axis=1)
    samples[::1000, 2] = np.nan
    path = folder / "run.h5"
    hydrapod.Record(samples, 1000.0, ["slow", "clipped", "gappy"], units=["m", "m/s^2", "Pa"],
                    roles=["excitation", "response", "response"], directions=["x", "z", "leg 2"], start=5.0,
                    title="Example").write(path)
    return str(path)


@pytest.mark.parametrize("spectra", [False, True])
def test_show(example, spectra):
    found = hydrapod.show_record(example, spectra=spectra)
    assert found.to_dict() == command_line("record", "show", example, "--format", "json",
                                           *(["--spectra"] if spectra else []))
    assert found.channels == ["slow", "clipped", "gappy"] and found.units == ["m", "m/s^2", "Pa"]
    assert (found.samples, found.sample_rate, found.start, found.duration) == (10_000, 1000.0, 5.0, 10.0)
    assert list(found.missing) == [0, 0, 10] and found.at_limit[0] == 0 and found.at_limit[1] > 4000
    assert found.strongest_frequency_hz[0] == pytest.approx(40.0, abs=0.25)
    assert found.rms[0] == pytest.approx(0.01 / np.sqrt(2), rel=1e-9)
    assert found.spectra.shape == (len(found.spectrum_frequency_hz), 3)
    # the variance is the integral of the density; a sine is spread over few lines
    step = found.spectrum_frequency_hz[1]
    assert found.spectra[:, 0].sum() * step == pytest.approx(found.rms[0] ** 2, rel=1e-5)
    assert "clipped" in repr(found) and "<table" in found._repr_html_()


def test_show_of_a_record_in_memory(example):
    by_file, in_memory = hydrapod.show_record(example), hydrapod.show_record(hydrapod.read_record(example))
    for name in ("mean", "rms", "lowest", "highest", "at_limit", "longest_hold", "missing", "strongest_frequency_hz"):
        np.testing.assert_array_equal(getattr(in_memory, name), getattr(by_file, name), name)


rewritten = {
    "csv": (["convert"], "csv", lambda record, path: hydrapod.convert_record(record, path)),
    "ascii": (["convert", "--format", "uff-ascii"], "uff",
              lambda record, path: hydrapod.convert_record(record, path, format="uff-ascii")),
    "short": (["convert", "--format", "rpc-short"], "rsp",
              lambda record, path: hydrapod.convert_record(record, path, format="rpc-short")),
    "part": (["cut", "--from", "6 s", "--to", "6500 ms", "--role", "response", "--channel", "*p*"], "csv",
             lambda record, path: hydrapod.cut_record(record, path, from_=6, to="6500 ms", role="response",
                                                      channels="*p*")),
    "leg": (["cut", "--direction", "leg 2"], "uff",
            lambda record, path: hydrapod.cut_record(record, path, direction="leg 2")),
    "slow": (["resample", "--new-rate", "170"], "csv",
             lambda record, path: hydrapod.resample_record(record, path, 170)),
    "recovered": (["recover"], "csv", lambda record, path: hydrapod.recover_record(record, path))}


@pytest.mark.parametrize("task", rewritten)
def test_written_files_have_the_same_bytes(example, tmp_path, task):
    arguments, ending, call = rewritten[task]
    ours, theirs = tmp_path / f"ours.{ending}", tmp_path / f"theirs.{ending}"
    done = call_program("record", arguments[0], example, *arguments[1:], "-o", theirs)
    assert done.returncode == 0, done.stderr
    found = call(example, ours)
    assert ours.read_bytes() == theirs.read_bytes()
    assert found.path == str(ours) and f"{found.samples} samples" in done.stderr
    assert all(text.replace("ours", "theirs") in done.stderr for text in found.warnings)


def test_verify(example, tmp_path):
    found = hydrapod.verify_record(example)
    assert (found.checksum, found.samples, found.channels) == ("holds", 10_000, 3)
    copy = tmp_path / "run.mat"
    hydrapod.convert_record(example, copy)
    damaged = bytearray(copy.read_bytes())
    damaged[-1001] ^= 4
    copy.write_bytes(damaged)
    assert hydrapod.verify_record(copy).checksum == "differs"
    table = tmp_path / "other.csv"
    table.write_text("time [s],a [m]\n0,1\n0.1,2\n0.2,3\n")
    assert hydrapod.verify_record(table).checksum == "none"
    with pytest.raises(hydrapod.InputError):
        hydrapod.verify_record(tmp_path / "none.h5")


def test_recover_says_how_much_there_was(example, tmp_path):
    whole = open(example, "rb").read()
    (tmp_path / "cut.h5").write_bytes(whole[:len(whole) * 6 // 10])
    found = hydrapod.recover_record(tmp_path / "cut.h5", tmp_path / "rest.h5")
    assert found.declared == 10_000 and 0 < found.samples < 10_000
    assert (found.has_checksum, found.checksum, found.uneven) == (True, "none", False)
    rest = hydrapod.read_record(tmp_path / "rest.h5")
    assert len(rest) == found.samples
    np.testing.assert_array_equal(rest.samples, hydrapod.read_record(example).samples[:found.samples])
    complete = hydrapod.recover_record(example, tmp_path / "same.h5")
    assert (complete.samples, complete.checksum, complete.unfinished) == (10_000, "holds", False)
    (tmp_path / "short.h5").write_bytes(whole[:300])
    with pytest.raises(hydrapod.InputError, match="nothing can be recovered"):
        hydrapod.recover_record(tmp_path / "short.h5", tmp_path / "none.h5")
    assert not (tmp_path / "none.h5").exists()


def test_plot(example, tmp_path):
    done = call_program("record", "plot", example, "-o", tmp_path / "theirs.svg")
    assert done.returncode == 0, done.stderr
    assert hydrapod.plot_record(example, tmp_path / "ours.svg") == []
    # the command line states its command in the picture
    ours, theirs = (re.sub("<title>.*?</title>\n|<desc>.*?</desc>", "", (tmp_path / name).read_text(), flags=re.S)
                    for name in ("ours.svg", "theirs.svg"))
    assert ours == theirs
    many = hydrapod.Record(np.random.default_rng(1).normal(size=(200, 25)), 100.0, [f"c{k}" for k in range(25)])
    assert hydrapod.plot_record(many, tmp_path / "many.svg") == [
        "the first 24 of 25 channels are shown; channels chooses others"]
    with pytest.raises(hydrapod.InputError, match="did you mean 'c1'"):
        hydrapod.plot_record(many, tmp_path / "many.svg", channels=["C1"])


def test_a_record_in_memory_is_written_in_any_format(example, tmp_path):
    record = hydrapod.read_record(example)
    for format in ("hdf5", "mat5", "mat73", "csv", "uff"):
        hydrapod.convert_record(record, tmp_path / "r", format=format)
        np.testing.assert_array_equal(hydrapod.read_record(tmp_path / "r").samples, record.samples, format)


@pytest.mark.parametrize("call, error, words", [
    (lambda r, p: hydrapod.convert_record(r, p / "r.h7"), ValueError, r"\.h5"),
    (lambda r, p: hydrapod.convert_record(r, p / "r.h5", format="hdf"), ValueError, "did you mean 'hdf5'"),
    (lambda r, p: hydrapod.convert_record(r, p / "r.h5", rate=2.0), ValueError, "1000"),
    (lambda r, p: hydrapod.convert_record([r, r], p / "r.h5"), TypeError, "expected one"),
    (lambda r, p: hydrapod.convert_record(3, p / "r.h5"), TypeError, "expected a file"),
    (lambda r, p: hydrapod.cut_record(r, p / "r.h5", from_=100), ValueError, "no sample lies there"),
    (lambda r, p: hydrapod.cut_record(r, p / "r.h5", from_=7, to="6 s"), ValueError, "no sample lies there"),
    (lambda r, p: hydrapod.cut_record(r, p / "r.h5", from_="7 m"), ValueError, "from"),
    (lambda r, p: hydrapod.cut_record(r, p / "r.h5", to=True), TypeError, "bool"),
    (lambda r, p: hydrapod.cut_record(r, p / "r.h5", channels="clippd"), ValueError, "did you mean 'clipped'"),
    (lambda r, p: hydrapod.cut_record(r, p / "r.h5", role="drive"), ValueError, "no channel matches"),
    (lambda r, p: hydrapod.cut_record(r, p / "r.h5", role=1), TypeError, "role"),
    (lambda r, p: hydrapod.cut_record(r, p / "r.h5", direction="up"), ValueError, "leg 1"),
    (lambda r, p: hydrapod.resample_record(r, p / "r.h5", 0), ValueError, "positive"),
    (lambda r, p: hydrapod.resample_record(r, p / "r.h5", np.nan), ValueError, "finite"),
    (lambda r, p: hydrapod.resample_record(r, p / "r.h5", None), TypeError, "new_rate"),
    (lambda r, p: hydrapod.resample_record(r, p / "r.h5", "1 GHz"), ValueError, "1:10000"),
    (lambda r, p: hydrapod.show_record(p / "none.h5"), ValueError, "none.h5"),
    (lambda r, p: hydrapod.show_record(r, spectra="yes"), TypeError, "spectra"),
    (lambda r, p: hydrapod.plot_record(r, p / "r.txt"), ValueError, "svg"),
    (lambda r, p: hydrapod.verify_record(b"run.h5"), TypeError, "path"),
    (lambda r, p: hydrapod.convert_record(r, r), ValueError, "is the input"),
    (lambda r, p: hydrapod.recover_record(r, r), ValueError, "is the input")])
def test_wrong_use(example, tmp_path, call, error, words):
    with pytest.raises(error, match=words):
        call(example, tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_stopped_tasks_raise(example, tmp_path):
    for call in (lambda stop: hydrapod.show_record(example, progress=stop),
                 lambda stop: hydrapod.convert_record(example, tmp_path / "r.h5", progress=stop),
                 lambda stop: hydrapod.verify_record(example, progress=stop)):
        with pytest.raises(hydrapod.ComputationError, match="interrupted"):
            call(lambda share: True)
        with pytest.raises(ZeroDivisionError):
            call(lambda share: 1 / 0)
