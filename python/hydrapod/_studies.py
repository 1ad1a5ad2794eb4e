"""Many designs of one machine: Monte Carlo, sweeps, maps over the workspace."""

from __future__ import annotations

import os
import tempfile
from typing import Any, Callable, Dict, List, Mapping, Optional, Tuple

import numpy as np

from . import _core
from ._core import Design, Study
from ._machine import Machine
from ._records import Path
from ._tasks import Progress, Texts, _core_of, _list, _options

Over = Mapping[str, Any]
Outputs = Mapping[str, Callable[[Machine], float]]


def _texts(varied: Over) -> Dict[str, str]:
    """Ranges and lists as the command line has them; arrays are lists of numbers in SI."""
    texts = {}
    for path, given in varied.items():
        if isinstance(given, str):
            texts[path] = given
            continue
        values = np.atleast_1d(np.asarray(given, dtype=float))
        if values.ndim != 1 or not len(values) or not np.isfinite(values).all():
            raise ValueError(f"{path}: expected a text such as \"2:20:10 kN/mm\" or finite numbers in one dimension")
        texts[path] = ", ".join(repr(float(value)) for value in values)
    return texts


def _run(machine: Machine, kind: str, progress: Optional[Progress], results: Optional[Path],
         **options: Any) -> Study:
    shard = options.pop("shard", None)
    if shard is not None:
        options["shard"] = tuple(shard)
    if results is None and (shard is not None or options.get("resume") or options.get("join")):
        raise ValueError("results: shard, resume and join need the file of the rows")
    with tempfile.TemporaryDirectory(prefix="hydrapod-") as folder:
        path = os.path.join(folder, "study.h5") if results is None else os.fspath(results)
        return _core.study(_core_of(machine), kind, _options(results=path, **options), progress)


def montecarlo(machine: Machine, vary: Mapping[str, str], *, want: Texts = (), samples: int = 10000, seed: int = 1,
               design: str = "random", indices: bool = False, modes: int = 6, buckling: bool = False,
               threads: int = 0, results: Optional[Path] = None, resume: bool = False,
               shard: Optional[Tuple[int, int]] = None, join: bool = False,
               progress: Optional[Progress] = None) -> Study:
    """Scatter of numbers of the file: distributions of modes, probability of missing a requirement.

    vary: {PATH: "normal ± 10 %"}; normal, lognormal, uniform, triangular, "… per leg". want: requirements,
    "x >= 6 Hz". design: random, latin or sobol. indices: Sobol indices, with d + 2 rows a sample. results:
    HDF5 file of the rows, which resume, shard=(i, n) and join need.

    Result, N rows: values (N, columns) [SI, frequencies in Hz], names, units, meanings; study["x"] is a column,
    NaN where it cannot be computed; study["status"] says why. requirements, probability_of_missing and
    probability_interval (95 %), worst_rows; machine(row); to_records(), to_pandas(); the rest in to_dict().
    Raises InputError for a path, a distribution or a requirement that cannot be.
    """
    return _run(machine, "montecarlo", progress, results, vary=dict(vary), want=_list(want), samples=samples,
                seed=seed, design=design, indices=indices, modes=modes, buckling=buckling, threads=threads,
                resume=resume, shard=shard, join=join)


def sweep(machine: Machine, over: Over, *, want: Texts = (), outputs: Optional[Outputs] = None,
          design: str = "grid", samples: int = 10000, seed: int = 1, modes: int = 6, buckling: bool = False,
          threads: int = 0, results: Optional[Path] = None, resume: bool = False,
          progress: Optional[Progress] = None) -> Study:
    """Modes over a grid of numbers of the file, or (design latin, sobol) over values that fill it evenly.

    over: {PATH: "2:20:10 kN/mm"}, a list "1, 2, 5 kN/mm", or an array in SI. outputs: {NAME: function of a
    Machine} adds columns of your own: see Study.evaluate. Result: as montecarlo(); of a grid, shape are the
    counts, study["x"].reshape(study.shape) the field.
    """
    study = _run(machine, "sweep", progress, results, over=_texts(over), want=_list(want), design=design,
                 samples=samples, seed=seed, modes=modes, buckling=buckling, threads=threads, resume=resume)
    for name, function in (outputs or {}).items():
        study.add(name, evaluate(study, function))
    return study


def workspace_map(machine: Machine, over: Over, *, want: Texts = (), outputs: Optional[Outputs] = None,
                  modes: int = 6, buckling: bool = False, threads: int = 0, results: Optional[Path] = None,
                  resume: bool = False, progress: Optional[Progress] = None) -> Study:
    """Modes over the workspace (`hydrapod map`).

    over: {DIRECTION: "-100:100:41 mm"} or arrays [m, rad]; directions x … rz, from the machine's pose.
    Result: as sweep(); the columns of the displacements are "pose.x" …, for "x" is the first resonance in x.
    """
    study = _run(machine, "map", progress, results, over=_texts(over), want=_list(want), modes=modes,
                 buckling=buckling, threads=threads, resume=resume)
    for name, function in (outputs or {}).items():
        study.add(name, evaluate(study, function))
    return study


def design(machine: Machine, change: Mapping[str, Any], *, minimise: Texts = (), maximise: Texts = (), want: Texts = (),
           poses: Texts = (), samples: int = 2048, seed: int = 1, starts: int = 6, trade_off: int = 11, threads: int = 0,
           progress: Optional[Progress] = None) -> Design:
    """Numbers of a machine that meet requirements at every pose with the least or largest aim.

    change: {PATH: "1:50 kN/mm"} or {PATH: (low, high)} in SI, what may change and its bounds. minimise, maximise:
    one aim, an output or a changed path; two in both together give a trade-off of `trade_off` points. want:
    requirements, "x >= 6 Hz". poses: names or displacements, the worst counts [the machine's pose]. samples: Sobol
    points at which the search begins; starts: local searches from the best of them.

    Result: feasible; machine, text (machine file, comments kept); paths, units, values and present (changes) [SI];
    aims, aim_values, aim_present; requirements, worst, worst_present, worst_poses; of a trade-off front_aims (n, 2)
    and front_values (n, changes); limits and the rest in to_dict(). Where no design meets all requirements,
    feasible is False, values are those of the least violation, and machine raises ComputationError.
    Raises InputError for a path, a range, a requirement or an aim that cannot be.
    """
    return _core.design(_core_of(machine), _options(
        change=_bounds(change), minimise=_list(minimise), maximise=_list(maximise), want=_list(want),
        poses=_list(poses), samples=samples, seed=seed, starts=starts, trade_off=trade_off, threads=threads), progress)


def _bounds(change: Mapping[str, Any]) -> Dict[str, str]:
    """Ranges as the command line has them; pairs are bounds in SI."""
    texts = {}
    for path, given in change.items():
        if isinstance(given, str):
            texts[path] = given
            continue
        bounds = np.asarray(given, dtype=float)
        if bounds.shape != (2,) or not np.isfinite(bounds).all():
            raise ValueError(f"{path}: expected a text such as \"1:50 kN/mm\" or two finite numbers")
        texts[path] = ":".join(repr(float(bound)) for bound in bounds)
    return texts


# --- what Study gets from Python ------------------------------------------------------------------


def column(study: Any, name: str) -> Any:
    """The column of that name (N,): an input, an output, or one that was added."""
    added = added_to(study)
    if name in added:
        return added[name]
    try:
        return study.values[:, study.names.index(name)]
    except ValueError:
        raise KeyError(f"no column {name!r}; there are {', '.join([*study.names, *added])}") from None


def added_to(study: Any) -> Dict[str, Any]:
    """Columns that were added."""
    found: Dict[str, Any] = study.__dict__.setdefault("_added", {})
    return found


def add(study: Any, name: str, values: Any) -> None:
    """Adds a column of your own: one number per row."""
    array = np.asarray(values, dtype=float)
    if array.shape != (len(study.values),):
        raise ValueError(f"{name}: expected {len(study.values)} numbers, got an array of shape {array.shape}")
    if name in study.names or name in added_to(study):
        raise ValueError(f"{name}: there is such a column already")
    added_to(study)[name] = array


def machine(study: Any, row: int) -> Machine:
    """The machine of a row: its numbers, and of a map its pose. Raises InputError where it cannot be."""
    core = study.core_machine(row)
    return Machine._wrapped(core)


def evaluate(study: Any, function: Callable[[Machine], float]) -> Any:
    """function(machine) for every row (N,); NaN where the row has no machine or no frequencies."""
    if not callable(function):
        raise TypeError(f"expected a function of a Machine, got {function!r}")
    status = column(study, "status")
    values = np.full(len(status), np.nan)
    for row in np.flatnonzero(status == 0):
        values[row] = float(function(machine(study, int(row))))
    return values


def to_records(study: Any) -> Any:
    """The rows as a NumPy record array."""
    names: List[str] = [*study.names, *added_to(study)]
    table = np.empty(len(study.values), dtype=[(name, float) for name in names])
    for name in names:
        table[name] = column(study, name)
    return table.view(np.recarray)


def to_pandas(study: Any) -> Any:
    """The rows as a pandas.DataFrame."""
    import pandas  # type: ignore[import]

    return pandas.DataFrame({name: column(study, name) for name in [*study.names, *added_to(study)]})


def attach() -> None:
    cls: Any = Study
    cls.__getitem__ = column
    cls.__len__ = lambda study: len(study.values)
    cls.add = add
    cls.machine = machine
    cls.evaluate = evaluate
    cls.to_records = to_records
    cls.to_pandas = to_pandas
    designed: Any = Design
    designed.machine = property(lambda found: Machine._wrapped(found.core_machine()),
                                doc="The machine with the numbers of the best design.")


attach()


class DesignFunction:
    """Frequencies as a function of numbers of the file, as OpenTURNS and optimisers want functions.

        f = hydrapod.DesignFunction(machine, ["legs.guide_sleeve.stiffness", "platform.mass"], modes=2)
        f([1e6, 14e3])                                    # list of the two lowest undamped frequencies [Hz]
        f.sample(X)                                       # (N, 2) of (N, paths), on all processors
        f.to_openturns()                                  # openturns.PythonFunction

    A design that does not stand has NaN.
    """

    def __init__(self, machine: Machine, paths: Texts, *, modes: int = 6, threads: int = 0):
        self.machine = machine
        self.paths = _list(paths)
        self.modes = modes
        self.threads = threads
        count = self.sample([[machine[path] for path in self.paths]]).shape[1]
        if not 1 <= modes <= count:
            raise ValueError(f"modes: expected 1 to {count}, got {modes}")

    def __call__(self, x: Any) -> List[float]:
        return [float(value) for value in self.sample([list(x)])[0]]

    def sample(self, X: Any) -> Any:
        """(N, modes) of (N, paths) [SI]."""
        array = np.ascontiguousarray(np.asarray(X, dtype=float))
        if array.ndim != 2 or array.shape[1] != len(self.paths):
            raise ValueError(f"X: expected an array of designs × {len(self.paths)}, got shape {array.shape}")
        found = _core.frequencies(_core_of(self.machine), self.paths, array, self.threads, None)
        return found[:, :self.modes]

    def to_openturns(self) -> Any:
        """openturns.PythonFunction with names of inputs and outputs (needs openturns)."""
        import openturns  # type: ignore[import]

        function = openturns.PythonFunction(len(self.paths), self.modes, self,
                                            func_sample=lambda X: self.sample(np.array(X)))
        function.setInputDescription(self.paths)
        function.setOutputDescription([f"mode {k + 1} [Hz]" for k in range(self.modes)])
        return function


