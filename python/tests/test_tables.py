"""A table of pandas is a record as its file in CSV is."""

import numpy as np
import pytest

import hydrapod

pandas = pytest.importorskip("pandas")

N, rate = 400, 200.0
times = np.arange(N) / rate
force, a1 = np.sin(0.3 * np.arange(N)), np.cos(0.7 * np.arange(N))


def table(**columns):
    return pandas.DataFrame({**columns, "force [kN]": force, "a1 [m/s^2]": a1})


def same(record, start=0.0):
    assert record.sample_rate == pytest.approx(rate, rel=1e-12) and record.start == pytest.approx(start, abs=1e-12)
    assert record.channels == ["force", "a1"] and record.units == ["N", "m/s^2"]
    np.testing.assert_allclose(record["force"], 1e3 * force, rtol=1e-15)
    np.testing.assert_array_equal(record["a1"], a1)


@pytest.mark.parametrize("title, factor", [
    ("time", 1.0), ("t", 1.0), ("Time", 1.0), ("time [s]", 1.0), ("time (ms)", 1e-3), ("time_ms", 1e-3), ("seconds", 1.0),
    ("elapsed [s]", 1.0), ("Zeit", 1.0)])
def test_a_column_of_times(tmp_path, title, factor):
    frame = table(**{title: times / factor})
    record = hydrapod.Record(frame)
    same(record)
    assert record.roles == ["excitation", "response"]
    frame.to_csv(tmp_path / "t.csv", index=False)
    of_file = hydrapod.read_record(tmp_path / "t.csv")
    assert (of_file.channels, of_file.units, of_file.roles) == (record.channels, record.units, record.roles)
    np.testing.assert_array_equal(of_file.samples, record.samples)
    assert of_file.sample_rate == pytest.approx(record.sample_rate, rel=1e-9)


def test_a_column_of_times_stands_anywhere():
    frame = table()
    frame.insert(1, "t", times)
    same(hydrapod.Record(frame))
    same(hydrapod.Record(frame, rate))
    same(hydrapod.Record(frame, "0.2 kHz"))


@pytest.mark.parametrize("kind", [np.float32, np.int64, "Float64", object])
def test_kinds_of_numbers(kind):
    frame = table(t=times)
    frame["n"] = pandas.Series(np.arange(N)).astype(kind)
    if kind is object:
        with pytest.raises(TypeError, match="'n'.*real numbers.*object"):
            hydrapod.Record(frame)
        return
    np.testing.assert_array_equal(hydrapod.Record(frame)["n"], np.arange(N))


def test_missing_numbers_and_booleans():
    frame = table(t=times)
    frame["n"] = pandas.array([None, *range(N - 1)], dtype="Int64")
    frame["on"] = np.arange(N) % 2 == 0
    frame["off"] = pandas.array([None, *[True] * (N - 1)], dtype="boolean")
    record = hydrapod.Record(frame)
    assert np.isnan(record["n"][0]) and record["n"][7] == 6.0
    assert np.isnan(record["off"][0]) and record["off"][1] == 1.0
    np.testing.assert_array_equal(record["on"], np.arange(N) % 2 == 0)


@pytest.mark.parametrize("column", [True, False], ids=["column", "index"])
@pytest.mark.parametrize("zone, ending", [(None, ""), ("Europe/Berlin", "Z")])
def test_dates(column, zone, ending):
    dates = pandas.date_range("2026-11-20T09:00:00.125", periods=N, freq="5ms", tz=zone)
    frame = table(when=dates) if column else table().set_index(dates)
    record = hydrapod.Record(frame)
    same(record)
    assert record.date == ("2026-11-20T08:00:00Z" if zone else "2026-11-20T09:00:00")


def test_durations_and_named_indices():
    same(hydrapod.Record(table().set_index(pandas.to_timedelta(2.0 + times, unit="s"))), start=2.0)
    same(hydrapod.Record(table().set_index(pandas.Index(1e3 * times, name="time [ms]"))))
    same(hydrapod.Record(table().set_index(pandas.Index(5 * np.arange(N), name="time_ms"))))
    same(hydrapod.Record(table().set_index(pandas.Index(3.0 + times))), start=3.0)
    counted = table().set_index(pandas.Index(np.arange(N), name="sample"))
    with pytest.raises(ValueError, match="no times"):
        hydrapod.Record(counted)
    same(hydrapod.Record(counted, rate))


def test_a_series_is_one_channel():
    series = pandas.Series(a1, index=times, name="a1 [m/s^2]")
    record = hydrapod.Record(series)
    assert record.channels == ["a1"] and record.sample_rate == rate


def test_gaps_and_times_that_are_not_even():
    frame = table(t=times).drop(index=[100, 101])
    record = hydrapod.Record(frame)
    assert len(record) == N and np.isnan(record["a1"][100:102]).all() and np.isnan(record["a1"]).sum() == 2
    assert any("1 gap" in one and "2 samples" in one for one in record.warnings)
    shaken = times + 0.15 / rate * np.random.default_rng(3).uniform(-1, 1, N)
    record = hydrapod.Record(table(t=shaken))
    assert any("interpolated" in one for one in record.warnings)
    assert record.sample_rate == pytest.approx(rate, rel=1e-3)
    scattered = np.cumsum(np.random.default_rng(3).exponential(1 / rate, N))
    with pytest.raises(hydrapod.InputError, match="not evenly spaced.*with sample_rate"):
        hydrapod.Record(table(t=scattered))
    with pytest.raises(hydrapod.InputError, match="goes back"):
        hydrapod.Record(table(t=times[::-1]))
    with pytest.raises(hydrapod.InputError, match="200 Hz, but sample_rate=50 says 50 Hz"):
        hydrapod.Record(table(t=times), 50.0)
    with pytest.raises(hydrapod.InputError, match="at least two times"):
        hydrapod.Record(table(t=times).head(1))
    with pytest.raises(hydrapod.InputError, match="at least two times"):
        hydrapod.Record(table(t=np.full(N, np.nan)))


def test_what_is_said_of_a_table():
    with pytest.raises(ValueError, match="no times.*time \\[s\\]"):
        hydrapod.Record(table())
    with pytest.raises(TypeError, match="'note'.*drop"):
        hydrapod.Record(table(t=times, note=["a"] * N))
    with pytest.raises(TypeError, match="to_datetime"):
        hydrapod.Record(table(time=[f"2026-11-20T09:00:{k / rate:06.3f}" for k in range(N)]))
    with pytest.raises(TypeError, match="'z'.*complex"):
        hydrapod.Record(table(t=times, z=np.exp(1j * times)))
    with pytest.raises(ValueError, match="besides the times"):
        hydrapod.Record(pandas.DataFrame({"t": times}))
    with pytest.raises(ValueError, match="start"):
        hydrapod.Record(table(t=times), start=1.0)
    with pytest.raises(ValueError, match="channels"):
        hydrapod.Record(table(t=times), channels=["force"])
    with pytest.raises(TypeError, match=r"Record\(table\)"):
        hydrapod.frf(table(t=times))
    assert any("taken for seconds" in one for one in hydrapod.Record(table(t=1e3 * times)).warnings)


def test_arguments_hold_for_the_channels_of_a_table():
    record = hydrapod.Record(table(t=times), channels=["u", "y"], units=["N", "g"], roles=["drive", "response"],
                             directions=["x", "-z"], title="run", notes="of a table")
    assert record.channels == ["u", "y"] and record.roles == ["drive", "response"] and record.title == "run"
    np.testing.assert_allclose(record["y"], 9.80665 * a1, rtol=1e-15)
    # with a rate and a name for each column it is an array like others
    record = hydrapod.Record(table(t=times), 100.0, ["t", "u", "y"])
    assert record.sample_rate == 100.0 and record.units == ["1"] * 3 and record.roles == ["other"] * 3
    twice = pandas.DataFrame(np.column_stack([times, force, a1]), columns=["t", "a", "a"])
    assert hydrapod.Record(twice).channels == ["a", "a (2)"]


def test_a_table_is_unchanged():
    frame = table(t=times)
    before = frame.copy()
    hydrapod.Record(frame)
    pandas.testing.assert_frame_equal(frame, before)


def test_arrays_need_a_rate_and_names():
    for arguments, name in [((np.zeros((9, 1)),), "sample_rate"), ((np.zeros((9, 1)), 10.0), "channels"),
                            ((np.zeros((9, 1)), None, "u"), "sample_rate")]:
        with pytest.raises(TypeError, match=name):
            hydrapod.Record(*arguments)
