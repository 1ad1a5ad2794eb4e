"""HDF5 files: h5py and pandas read ours as the how-to pages say, hydrapod reads what h5py writes."""

import numpy as np
import pytest
from conftest import program_of, root

import hydrapod

h5py = pytest.importorskip("h5py")
heavy_file = root / "models" / "heavy-platform.toml"


def test_rows_of_a_study_are_a_table(heavy, tmp_path):
    pandas = pytest.importorskip("pandas")
    program_of("sweep", heavy_file, "--over", "platform.mass=13e3:17e3:7 kg", "--over",
               "legs.guide_sleeve.stiffness=3:11:5 kN/mm", "--results", tmp_path / "run.h5")
    with h5py.File(tmp_path / "run.h5") as f:
        table = pandas.DataFrame({name: column[:] for name, column in f["samples"].items()})
        units = {name: column.attrs["unit"] for name, column in f["samples"].items()}
        chunks = {name: (column.chunks, column.compression) for name, column in f["samples"].items()}
    study = hydrapod.sweep(heavy, {"platform.mass": "13e3:17e3:7 kg",
                                   "legs.guide_sleeve.stiffness": "3:11:5 kN/mm"})
    assert set(table.columns) == set(study.names) and len(table) == 35
    for name in study.names:
        np.testing.assert_array_equal(table[name].to_numpy(float), study[name], err_msg=name)
    assert (units["x"], units["platform.mass"], units["legs.guide_sleeve.stiffness"]) == ("Hz", "kg", "N/m")
    assert all(chunk is not None and way == "gzip" for chunk, way in chunks.values())


def test_records_are_arrays(run, tmp_path):
    program_of("record", "convert", run, "-o", tmp_path / "run.h5")
    record = hydrapod.read_record(run)
    with h5py.File(tmp_path / "run.h5") as f:
        names = [name.decode() for name in f["channels/name"]]
        assert f["samples"].dtype == np.float64 and names == record.channels
        np.testing.assert_array_equal(f["samples"][:], record.samples)
        assert f.attrs["sample_rate_hz"] == 400.0


def test_responses_are_complex(run, tmp_path):
    program_of("frf", run, "-o", tmp_path / "frf.h5")
    found = hydrapod.frf(run)
    with h5py.File(tmp_path / "frf.h5") as f:
        assert f["response"].dtype == np.complex128
        np.testing.assert_array_equal(f["response"][:], found.H)
        np.testing.assert_array_equal(f["frequency_hz"][:], found.frequency_hz)


def test_state_spaces_are_matrices(heavy, tmp_path):
    program_of("export", heavy_file, "--to", "hdf5", "-o", tmp_path / "m.h5")
    system = hydrapod.machine_state_space(heavy)
    with h5py.File(tmp_path / "m.h5") as f:
        for name in "ABCD":
            np.testing.assert_array_equal(f[name][:], getattr(system, name), err_msg=name)
        assert [one.decode() for one in f["output_names"]] == system.outputs


@pytest.mark.parametrize("options", [{}, {"compression": "gzip", "shuffle": True, "fletcher32": True}],
                         ids=["plain", "compressed"])
@pytest.mark.parametrize("number", [">f4", "<i2", "f8"])
def test_tables_of_h5py(tmp_path, number, options):
    values = np.random.default_rng(7).integers(-900, 900, (333, 2)).astype(number)
    table = np.zeros(333, dtype=[("force", number), ("valid", "?"), ("acceleration", number)])
    table["force"], table["valid"], table["acceleration"] = values[:, 0], True, values[:, 1]
    with h5py.File(tmp_path / "t.h5", "w") as f:
        f.create_dataset("run/table", data=table, **options)
        f.attrs["fs"] = 512.5
    record = hydrapod.read_record(tmp_path / "t.h5")
    assert record.sample_rate == 512.5
    for name in ("force", "acceleration"):
        column = next(k for k, one in enumerate(record.channels) if name in one)
        np.testing.assert_array_equal(record.samples[:, column], table[name].astype(float))


def test_responses_of_h5py(tmp_path):
    frequency = np.linspace(2.0, 9.0, 281)
    s = 2j * np.pi * frequency
    poles = 2 * np.pi * np.array([3.7, 5.9]) * (-0.013 + 1j)
    shapes = np.array([[1.0, 0.6], [-0.4, 1.1]])
    H = sum(np.einsum("i,j,f->fij", phi, phi, 1 / (s - pole) + 1 / (s - pole.conjugate()))
            for phi, pole in zip(shapes, poles))
    with h5py.File(tmp_path / "r.h5", "w") as f:
        f["frequency"], f["frf"] = frequency, H
    found = hydrapod.identify(tmp_path / "r.h5")
    np.testing.assert_allclose(found.frequency_hz, np.abs(poles) / (2 * np.pi), rtol=1e-5)
    np.testing.assert_allclose(found.damping_ratio, -poles.real / np.abs(poles), rtol=1e-3)
