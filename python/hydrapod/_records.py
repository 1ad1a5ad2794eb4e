"""Records: what a test rig measured, as arrays."""

from __future__ import annotations

import html
import importlib
import os
import shutil
import tempfile
from contextlib import contextmanager
from typing import Any, Dict, Iterable, Iterator, List, Optional, Sequence, Union

import numpy as np

from . import _checks, _core
from ._checks import Texts
from ._machine import Quantity
from ._tables import Table, is_table, read_table


class Record:
    """Channels sampled together, in SI and radians.

    samples: samples × channels, read-only; a missing sample is NaN. warnings: what was done with units and the like, a
    list of sentences. path: the file that was read; None: made from arrays. Made by read_record(), or from arrays:

        Record(samples, 1000.0, ["force", "a1"], units=["N", "m/s^2"], roles=["excitation", "response"])
        Record(table)

    A table of pandas is read as a file in CSV: names and units are those of its columns, "a1 [m/s^2]"; the times are
    its index of dates or durations, a column of these, or a column or an index called time, t, seconds or the like,
    in a unit of time or in seconds. Times that are not even, gaps and roles are treated as in files: see warnings.
    sample_rate, of a table with times, is checked with them; channels, units, roles, directions are those without
    the times.
    samples may be any array of real numbers; masked ones are missing. Units that are plain scales ("mm", "kN", "bar")
    are brought to SI; "g" is 9.80665 m/s². roles: excitation, drive, response or
    other. directions: "x" … "rz", "-x" …, "leg 1" …, "" for none. Raises InputError or ValueError.
    """

    __slots__ = ("_core_record", "warnings", "path", "__weakref__")

    _core_record: _core.Record
    warnings: List[str]

    def __init__(self, samples: Any, sample_rate: Optional[Quantity] = None, channels: Optional[Texts] = None, *,
                 units: Optional[Texts] = None, roles: Optional[Texts] = None,
                 directions: Optional[Texts] = None, start: Optional[Quantity] = None, title: str = "",
                 notes: str = ""):
        table = None if channels is not None and sample_rate is not None else _table_of(samples, sample_rate, channels)
        array = np.ascontiguousarray(table.samples if table else _checks.real_array(samples, "samples", missing=True))
        names = table.names if table and channels is None else _checks.words(channels, "channels")
        count = len(names)
        if table and table.times is not None and start is not None:
            raise ValueError("start: the times of the table state it; leave it out")
        if array.ndim == 2 and array.shape[1] != count:
            advice = "; transpose it" if array.shape[0] == count else ""
            raise ValueError(f"samples: expected an array of samples × {count} channels, got shape "
                             f"{array.shape}{advice}")

        def of_channels(given: Optional[Texts], name: str, otherwise: List[str]) -> List[str]:
            texts = otherwise if given is None else _checks.words(given, name)
            if len(texts) != count:
                raise ValueError(f"{name}: expected {count}, one for each channel, got {len(texts)}")
            return texts

        options = {"channels": names, "units": of_channels(units, "units", table.units if table else ["1"] * count),
                   "roles": None if table and roles is None else of_channels(roles, "roles", ["other"] * count),
                   "directions": of_channels(directions, "directions", [""] * count),
                   "sample_rate": sample_rate, "start": start, "title": _checks.word(title, "title"),
                   "notes": _checks.word(notes, "notes")}
        if table:
            options.update(of_table=True, has_unit_of_time=table.has_unit_of_time, date=table.date)
        self._core_record, self.warnings = _core.record(array, table.times if table else None, options)
        self.path: Optional[str] = None

    @classmethod
    def _of(cls, core: _core.Record, warnings: List[str], path: str) -> "Record":
        record = cls.__new__(cls)
        record._core_record = core
        record.warnings = warnings
        record.path = path
        return record

    @property
    def samples(self) -> Any:
        """(N, channels) [SI], read-only; NaN: missing."""
        return self._core_record.samples

    @property
    def channels(self) -> List[str]:
        """Their names."""
        return self._core_record.channels

    @property
    def units(self) -> List[str]:
        """Their SI units."""
        return self._core_record.units

    @property
    def roles(self) -> List[str]:
        """excitation, drive, response or other, of each channel."""
        return self._core_record.roles

    @property
    def directions(self) -> List[str]:
        """x … rz, -x …, leg 1 … of each channel; empty: none."""
        return self._core_record.directions

    @property
    def sample_rate(self) -> float:
        """[Hz]"""
        return self._core_record.sample_rate

    @property
    def start(self) -> float:
        """Time of the first sample [s]."""
        return self._core_record.start

    @property
    def time(self) -> Any:
        """[s]"""
        return self.start + np.arange(len(self)) / self.sample_rate

    @property
    def title(self) -> str:
        """Title of the record."""
        return self._core_record.title

    @property
    def notes(self) -> str:
        """Notes of who measured."""
        return self._core_record.notes

    @property
    def date(self) -> str:
        """When it was measured; empty: not known."""
        return self._core_record.date

    @property
    def machine_text(self) -> str:
        """Text of the machine file in the record; empty: none."""
        return self._core_record.machine

    def __getitem__(self, channel: str) -> Any:
        """Samples of the channel of that name."""
        if not isinstance(channel, str):
            raise TypeError(f"expected the name of a channel, got {_checks.shown(channel)}; samples[…] has rows, and "
                            "cut_record() makes a record of some")
        try:
            return self.samples[:, self.channels.index(channel)]
        except ValueError:
            raise KeyError(f"no channel {channel!r}; there are {', '.join(self.channels)}") from None

    def __contains__(self, channel: object) -> bool:
        return channel in self.channels

    __iter__ = None  # neither over samples nor over channels; say which

    def __len__(self) -> int:
        return int(self.samples.shape[0])

    def write(self, path: Union[str, "os.PathLike[str]"]) -> None:
        """Writes .h5, .mat, .csv, .uff or .rsp, whole or not at all."""
        self._core_record.write(_checks.path(path, "path"))

    def to_xarray(self) -> Any:
        """As an xarray.DataArray (needs xarray)."""
        xarray: Any = importlib.import_module("xarray")  # typed where it is there, which mypy would ask about
        return xarray.DataArray(
            self.samples, dims=("time", "channel"),
            coords={"time": self.time, "channel": self.channels, "unit": ("channel", self.units)})

    def __copy__(self) -> "Record":
        return self

    def __deepcopy__(self, memo: Any) -> "Record":
        return self

    def __reduce__(self) -> Any:
        raise TypeError("a Record cannot be pickled; write() it, and read_record() the file")

    def _repr_html_(self) -> str:
        """In notebooks: a row per channel, of the first 40."""
        rows = []
        for k, texts in enumerate(zip(self.channels[:40], self.units, self.roles, self.directions)):
            values = self.samples[np.isfinite(self.samples[:, k]), k]
            least, most = (f"{values.min():.4g}", f"{values.max():.4g}") if len(values) else ("–", "–")
            rows.append((*texts, least, most))
        body = "".join("<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in row) + "</tr>" for row in rows)
        titles = "".join(f"<th>{title}</th>" for title in ("channel", "unit", "role", "direction", "least", "most"))
        more = f"<p>and {len(self.channels) - 40} more channels</p>" if len(self.channels) > 40 else ""
        return (f"<div><b>Record</b>: {html.escape(repr(self)[8:-1])}<table><thead><tr>{titles}</tr></thead>"
                f"<tbody>{body}</tbody></table>{more}</div>")

    def __repr__(self) -> str:
        return (f"<Record {self.title!r}: {len(self)} samples × {len(self.channels)} channels "
                f"at {self.sample_rate:g} Hz>")


def read_record(path: Union[str, "os.PathLike[str]"], *, rate: Optional[Quantity] = None) -> Record:
    """The whole record at once.

    path: HDF5, MAT, CSV, Universal File or RPC III.
    rate: sample rate [Hz] of files that do not tell it. Raises InputError. Source: docs/howto/record.md.
    C++: data::read_record in hydrapod/data/record_io.hpp.
    """
    name = _checks.path(path, "path")
    core, warnings = _core.read_record(name, None if rate is None else _core.quantity(rate, "Hz", "rate"))
    return Record._of(core, warnings, name)


def _table_of(samples: Any, sample_rate: Optional[Quantity], channels: Optional[Texts]) -> Optional[Table]:
    """A table of pandas; arrays have neither names nor times."""
    if not is_table(samples):
        missing = "sample_rate" if sample_rate is None else "channels"
        expected = "a rate in Hz" if sample_rate is None else "a name for each channel"
        raise TypeError(f"{missing}: expected {expected}; a table of pandas alone tells it")
    table = read_table(samples)
    if table.times is None and sample_rate is None:
        raise ValueError("sample_rate: the table has no times; expected are a rate in Hz, an index of dates or "
                         "durations, or a column such as \"time [s]\", time, t or seconds")
    return table


Path = Union[str, "os.PathLike[str]"]
Measured = Union[Path, Record, _core.Result, Sequence[Union[Path, Record, _core.Result]]]


def _folder_for(size: int) -> Optional[str]:
    """Where temporary files of so many bytes are written: in memory, where there is enough of it."""
    memory = "/dev/shm"
    try:
        enough = os.access(memory, os.W_OK) and shutil.disk_usage(memory).free > 4 * size
    except OSError:
        return None
    return memory if enough else None


def _items(measured: Measured) -> List[Any]:
    """What was measured as a list."""
    if isinstance(measured, (str, os.PathLike, Record, _core.Result)):
        return [measured]
    if isinstance(measured, np.ndarray) or is_table(measured) or not isinstance(measured, Iterable):
        advice = "; Record(samples, rate, channels) makes a record" if isinstance(measured, np.ndarray) else \
            "; Record(table) makes a record" if is_table(measured) else ""
        raise TypeError(f"expected a file, a Record, a result or a list of these, got "
                        f"{_checks.shown(measured)}{advice}")
    return list(measured)


@contextmanager
def sources_of(measured: Measured) -> Iterator[Dict[str, Any]]:
    """What was measured, for tasks that take records from memory: their options files and records_in_memory."""
    items = _items(measured)
    if items and all(isinstance(item, Record) for item in items):
        names = [f"record {number + 1}" if len(items) > 1 else "record" for number in range(len(items))]
        yield {"files": names, "records_in_memory": [item._core_record for item in items]}
        return
    with files_of(items) as files:
        yield {"files": files}


@contextmanager
def files_of(measured: Measured) -> Iterator[List[str]]:
    """Paths of what was measured; records and results in memory are in files of their own for the time of a task."""
    items = _items(measured)
    size = sum(item.samples.nbytes for item in items if isinstance(item, Record))
    with tempfile.TemporaryDirectory(prefix="hydrapod-", dir=_folder_for(size)) as folder:
        paths = []
        for number, item in enumerate(items):
            if isinstance(item, Record):
                path = os.path.join(folder, f"record-{number + 1}.mat")
                item.write(path)
                paths.append(path)
            elif isinstance(item, _core.Result):
                paths.append(os.path.join(folder, f"result-{number + 1}.json"))
                with open(paths[-1], "w", encoding="utf-8") as file:
                    file.write(item.json)
            else:
                if not isinstance(item, (str, os.PathLike)):
                    raise TypeError(f"expected a file, a Record or a result, got {_checks.shown(item)}")
                paths.append(_checks.path(item, "a file"))
        yield paths
