"""Tables of pandas as samples: names, units and times of their columns and their index, as those of a file in CSV."""

from __future__ import annotations

from typing import Any, List, NamedTuple, Optional, Tuple

import numpy as np

from . import _core


class Table(NamedTuple):
    """Columns of numbers, and the times of their rows."""

    samples: Any  #: (N, channels)
    names: List[str]
    units: List[str]
    times: Optional[Any]  #: (N,) [s]; None: the table has none
    has_unit_of_time: bool
    date: str  #: of the first row, ISO 8601; empty: not known


class _Times(NamedTuple):
    """Times of the rows [s], NaT as NaN."""

    seconds: Any
    has_unit: bool = True
    date: str = ""


def is_table(given: Any) -> bool:
    """Whether it is a DataFrame or a Series of pandas, or works like one."""
    return hasattr(given, "iloc") and hasattr(given, "index") and (hasattr(given, "columns") or
                                                                   hasattr(given, "to_frame"))


def read_table(given: Any) -> Table:
    """Channels and times of a table. Raises TypeError or ValueError for columns that are no numbers."""
    table = given if hasattr(given, "columns") else given.to_frame()
    titles = [_title(one) for one in table.columns]
    columns = [table.iloc[:, k] for k in range(len(titles))]
    times = _times_of_index(table.index)
    if times is None:
        times = _take_times(titles, columns)
    if times is None and _kind(table.index) == "f":
        times = _Times(np.asarray(table.index, dtype=float), False)
    if not columns:
        raise ValueError("samples: the table has no column besides the times")
    names, units, _ = _core.columns_of_table(titles)
    samples = np.column_stack([_numbers(column, title) for title, column in zip(titles, columns)])
    if times is None:
        return Table(samples, names, units, None, False, "")
    return Table(samples, names, units, np.ascontiguousarray(times.seconds), times.has_unit, times.date)


def _title(name: Any) -> str:
    """Names of several levels are one text."""
    return " ".join(map(str, name)) if isinstance(name, tuple) else str(name)


def _kind(column: Any) -> str:
    """The letter of NumPy for the kind of its numbers; types of pandas have one too."""
    return str(getattr(column.dtype, "kind", "O"))


def _numbers(column: Any, title: str) -> Any:
    """Its samples; what is missing is NaN, booleans are 0 and 1, as in files."""
    if _kind(column) not in "fiub":
        advice = "; pandas.to_datetime() makes times of texts" if _kind(column) == "O" else ""
        raise TypeError(f"column {title!r}: expected real numbers, got {column.dtype}; leave it out: "
                        f"table.drop(columns=[…]){advice}")
    if isinstance(column.dtype, np.dtype):
        return np.asarray(column, dtype=float)
    return np.asarray(column.to_numpy(dtype=float, na_value=np.nan), dtype=float)


def _times_of_index(index: Any) -> Optional[_Times]:
    """Of an index of dates or of distances between them, or with a name of times."""
    if _kind(index) in "mM":
        return _of_calendar(index)
    if _kind(index) not in "fiu" or index.name is None:
        return None
    found = _core.columns_of_table(["", _title(index.name)])[2]
    return None if found is None else _Times(found[1] * np.asarray(index, dtype=float), found[2])


def _take_times(titles: List[str], columns: List[Any]) -> Optional[_Times]:
    """Of a column of dates, or with a name of times, which is one no longer."""
    dates = [k for k, column in enumerate(columns) if _kind(column) in "mM"]
    found: Optional[Tuple[int, float, bool]] = None if dates else _core.columns_of_table(titles)[2]
    if not dates and found is None:
        return None
    at = dates[0] if found is None else found[0]
    title, column = titles.pop(at), columns.pop(at)
    if found is None:
        return _of_calendar(column)
    return _Times(found[1] * _numbers(column, title), found[2])


def _of_calendar(given: Any) -> _Times:
    """Dates count from the first one, durations from 0."""
    has_zone = getattr(given.dtype, "tz", None) is not None
    values = np.asarray(given.values)  # those of a zone are in UTC
    kind = _kind(values)
    nanoseconds = values.astype(f"{kind}8[ns]")
    missing = np.isnat(nanoseconds)
    first = nanoseconds[~missing][:1]
    counts = nanoseconds.astype(np.int64)
    if kind == "M" and len(first):
        counts = counts - first.astype(np.int64)[0]
    seconds = np.where(missing, np.nan, 1e-9 * counts)
    if kind == "m" or not len(first):
        return _Times(seconds)
    return _Times(seconds, date=str(np.datetime_as_string(first[0], unit="s")) + ("Z" if has_zone else ""))
