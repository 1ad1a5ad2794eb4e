"""Many designs of one machine: Monte Carlo, sweeps, maps over the workspace."""

from __future__ import annotations

import os
import re
import tempfile
from typing import Any, Callable, Dict, List, Mapping, Optional, Tuple

import numpy as np

from . import _checks, _core
from ._checks import Texts
from ._core import Design, Study
from ._errors import ComputationError
from ._machine import Machine, Quantity
from ._records import Path
from ._tasks import Progress, _core_of

Over = Mapping[str, Any]
Outputs = Mapping[str, Callable[[Machine], float]]


def _paths(given: Any, name: str) -> Mapping[str, Any]:
    """A mapping with texts as keys."""
    if not isinstance(given, Mapping):
        raise TypeError(f"{name}: expected a dict with texts as keys, got {given!r}")
    _checks.words(given, name)
    return given


def _texts(varied: Over, name: str = "over") -> Dict[str, str]:
    """Ranges and lists as the command line has them; arrays are lists of numbers in SI."""
    texts = {}
    for path, given in _paths(varied, name).items():
        if isinstance(given, str):
            texts[path] = given
            continue
        values = np.atleast_1d(_checks.real_array(given, path))
        if values.ndim != 1 or not len(values) or not np.isfinite(values).all():
            raise ValueError(f"{path}: expected a text such as \"2:20:10 kN/mm\" or finite numbers in one dimension")
        texts[path] = ", ".join(repr(float(value)) for value in values)
    return texts


def _run(machine: Machine, kind: str, progress: Optional[Progress], results: Optional[Path],
         **options: Any) -> Study:
    shard = options.pop("shard", None)
    if shard is not None:
        pair = tuple(shard) if isinstance(shard, (tuple, list)) else ()
        if len(pair) != 2:
            raise ValueError(f"shard: expected (i, n), got {shard!r}")
        options["shard"] = tuple(_checks.whole(one, "shard") for one in pair)
    if results is None and (shard is not None or options.get("resume") or options.get("join")):
        raise ValueError("results: shard, resume and join need the file of the rows")
    with tempfile.TemporaryDirectory(prefix="hydrapod-") as folder:
        core = _core_of(machine)
        path = os.path.join(folder, "study.h5") if results is None else _checks.output(results, "results", core.path)
        for name in ("want", "only", "also", "correlate", "commands"):
            options[name] = _checks.words(options.get(name, ()), name)
        return _core.study(core, kind, _checks.options(results=path, **options), progress)


def _with_outputs(machine: Machine, kind: str, progress: Optional[Progress], results: Optional[Path],
                  outputs: Optional[Outputs], **options: Any) -> Study:
    """A study with columns of functions; the study is the first part of the progress, each column one more."""
    functions = _functions(outputs)
    if functions and options.get("shard") is not None and not options.get("join"):
        raise ValueError("outputs: a part has no rows for them; give outputs where join puts the parts together")
    for name in functions:
        if name in options.get("over", ()) or name in options.get("vary", ()) or _is_column(name):
            raise ValueError(f"outputs: {name}: the study has such a column itself")
    parts = 1 + len(functions)

    def part(k: int) -> Optional[Progress]:
        if progress is None:
            return None
        ask: Progress = progress
        return lambda share: ask((k + share) / parts)

    study = _run(machine, kind, progress if parts == 1 else part(0), results, **options)
    for k, (name, function) in enumerate(functions.items()):
        study.add(name, evaluate(study, function, progress=part(k + 1)) if study.complete else
                  np.full(len(study.values), np.nan))
    return study


def _functions(outputs: Optional[Outputs]) -> Dict[str, Callable[[Machine], float]]:
    functions = dict(_paths({} if outputs is None else outputs, "outputs"))
    for name, function in functions.items():
        _checked_function(function, name)
    return functions


def _is_column(name: str) -> bool:
    """Whether studies have a column of that name, or may have it."""
    return re.fullmatch(r"status|lowest|direction|((drop|share|peak|stiffness|force|velocity|acceleration|jerk|"
                        r"excursion|rms_error|peak_error|peak_motion|settling)_|pose\.)?r?[xyz]|drop|share|peak|"
                        r"condition|stroke|mac|mode\d+|buckling.*|power|sag|oil_force|peak_speed|peak_drive|limited",
                        name) is not None


def _checked_function(function: Any, name: str) -> None:
    if not callable(function):
        raise TypeError(f"{name}: expected a function of a Machine, got {function!r}")


def montecarlo(machine: Machine, vary: Mapping[str, str], *, want: Texts = (), outputs: Optional[Outputs] = None,
               samples: int = 10000, seed: int = 1, design: str = "random", indices: bool = False, modes: int = 6,
               only: Texts = (), also: Texts = (), correlate: Texts = (), commands: Texts = (),
               until: Optional[Quantity] = None, buckling: bool = False, threads: int = 0,
               results: Optional[Path] = None, resume: bool = False, shard: Optional[Tuple[int, int]] = None,
               join: bool = False, progress: Optional[Progress] = None) -> Study:
    """Scatter of numbers of the file: distributions of modes, probability of missing a requirement.

    vary: {PATH: "normal ± 10 %"}; normal, lognormal, uniform, triangular, "… per leg", "… per leg correlated 0.6".
    correlate: "PATH, PATH = 0.6", correlations of two that vary. want: requirements, "x >= 6 Hz". only: outputs
    besides which none is computed but those of want, also and commands: names of columns, or frequencies, modes,
    drops. also: outputs that are computed where they are asked for: stiffness, force, velocity, acceleration, jerk,
    excursion (six directions each), sag, oil_force, power, buckling. commands, until [s]: a motion as of simulate()
    that every sample makes: rms_error_x …, peak_error_x …, peak_motion_x …, settling_x …, peak_speed, peak_drive,
    limited. outputs: {NAME: function of a Machine} adds columns of your own, see Study.evaluate; where progress stops
    the study they are NaN.
    samples: rows. design: random, latin or sobol. indices: Sobol indices, with d + 2 rows a sample. modes: those of
    the platform that are followed. buckling: the same as also="buckling". results: HDF5 file of the rows, which
    resume (go on with it), shard=(i, n) (part i of n) and join (put the parts together) need.

    Result, N rows: values (N, columns) [SI, frequencies in Hz: undamped ones, with elastomers those of the damped
    modes], names, units, meanings; study["x"] is a column, NaN where it cannot be computed; study["status"] says
    why. requirements, probability_of_missing and probability_interval (95 %), worst_rows; machine(row);
    to_records(), to_pandas(); the rest in to_dict().
    Raises InputError for a path, a distribution or a requirement that cannot be, ValueError and TypeError for outputs
    that cannot be columns. Source: docs/theory/study.md. C++: tasks::prepare_study in hydrapod/tasks/study.hpp.
    """
    return _with_outputs(machine, "montecarlo", progress, results, outputs,
                         vary={path: _checks.word(text, path) for path, text in _paths(vary, "vary").items()},
                         want=want, only=only, also=also, correlate=correlate, commands=commands, until=until,
                         samples=samples, seed=seed, design=design, indices=indices, modes=modes, buckling=buckling,
                         threads=threads, resume=resume, shard=shard, join=join)


def sweep(machine: Machine, over: Over, *, refine: int = 0, want: Texts = (), outputs: Optional[Outputs] = None,
          design: str = "grid", samples: Optional[int] = None, seed: int = 1, modes: int = 6, only: Texts = (),
          also: Texts = (), commands: Texts = (), until: Optional[Quantity] = None, buckling: bool = False,
          threads: int = 0, results: Optional[Path] = None, resume: bool = False,
          shard: Optional[Tuple[int, int]] = None, join: bool = False, progress: Optional[Progress] = None) -> Study:
    """Modes over a grid of numbers, or over values that fill it evenly.

    over: {PATH: "2:20:10 kN/mm"}, a list "1, 2, 5 kN/mm", or an array in SI. outputs: {NAME: function of a
    Machine} adds columns of your own: see Study.evaluate; where progress stops the study they are NaN.
    design: grid, latin or sobol. samples: rows of latin and sobol [10000]; a grid has one per point. refine: so many
    times, 0 to 12, intervals of the grid between which modes cross or veer are halved. Others: see montecarlo().
    Result: as montecarlo(); of a grid, shape are the counts, study["x"].reshape(study.shape) the field.
    Raises as montecarlo(); ValueError and TypeError for outputs that cannot be columns. Source: docs/theory/study.md.
    C++: tasks::prepare_study in hydrapod/tasks/study.hpp.
    """
    return _with_outputs(machine, "sweep", progress, results, outputs, over=_texts(over),
                         refine=_checks.whole(refine, "refine"), want=want, only=only, also=also, commands=commands,
                         until=until, design=design, samples=samples, seed=seed, modes=modes, buckling=buckling,
                         threads=threads, resume=resume, shard=shard, join=join)


def workspace_map(machine: Machine, over: Over, *, worst_over: Optional[Over] = None, refine: int = 0,
                  want: Texts = (), outputs: Optional[Outputs] = None, modes: int = 6, only: Texts = (),
                  also: Texts = (), commands: Texts = (), until: Optional[Quantity] = None, buckling: bool = False,
                  threads: int = 0, results: Optional[Path] = None, resume: bool = False,
                  shard: Optional[Tuple[int, int]] = None, join: bool = False,
                  progress: Optional[Progress] = None) -> Study:
    """Modes over the workspace.

    over: {DIRECTION: "-100:100:41 mm"} or arrays [m, rad]; directions x … rz, from the machine's pose. worst_over:
    the same; every pose has the worst value over all these displacements, and none where one of them is not reached.
    refine: see sweep().
    Result: as sweep(); the columns of the displacements are "pose.x" …, for "x" is the first resonance in x.
    Raises as sweep(). outputs need a map from the pose neutral. Source: docs/theory/study.md.
    C++: tasks::prepare_study in hydrapod/tasks/study.hpp.
    """
    if outputs and machine.pose != "neutral":
        raise ValueError(f"outputs: need a map from the pose neutral, and the machine is at {machine.pose}")
    if outputs and worst_over:
        raise ValueError("outputs: cannot be the worst over poses; leave worst_over out")
    return _with_outputs(machine, "map", progress, results, outputs, over=_texts(over),
                         worst_over=_texts(worst_over or {}, "worst_over"), refine=_checks.whole(refine, "refine"),
                         want=want, modes=modes, only=only, also=also, commands=commands, until=until,
                         buckling=buckling, threads=threads, resume=resume, shard=shard, join=join)


def design(machine: Machine, change: Mapping[str, Any], *, minimise: Texts = (), maximise: Texts = (), want: Texts = (),
           poses: Texts = (), outputs: Optional[Outputs] = None, samples: int = 2048, seed: int = 1, starts: int = 6,
           trade_off: int = 11, threads: int = 0, progress: Optional[Progress] = None) -> Design:
    """Numbers of a machine that meet requirements at every pose with the least or largest aim.

    change: {PATH: "1:50 kN/mm"} or {PATH: (low, high)} in SI, what may change and its bounds. minimise, maximise:
    one aim, an output or a changed path; two in both together give a trade-off of `trade_off` points. want:
    requirements, "x >= 6 Hz". poses: names or displacements, the worst counts [the machine's pose]. outputs:
    {NAME: function of a Machine}, numbers of your own that want, minimise and maximise may name; a function gets the
    machine of a design at a pose, thousands of them, and gives no number by raising ComputationError. samples: Sobol
    points at which the search begins; starts: local searches from the best of them.

    Frequencies are undamped ones, with elastomers those of the damped modes.
    Result: feasible; machine, text (machine file, comments kept); paths, units, values and present (changes) [SI];
    aims, aim_values, aim_present; requirements, worst, worst_present, worst_poses; of a trade-off front_aims (n, 2)
    and front_values (n, changes); limits and the rest in to_dict(). Where no design meets all requirements,
    feasible is False, values are those of the least violation, and machine raises ComputationError.
    Raises InputError for a path, a range, a requirement, an output or an aim that cannot be, and what a function of
    outputs raises. Source: docs/theory/study.md. C++: tasks::prepare_design in hydrapod/tasks/study.hpp.
    """
    return _core.design(_core_of(machine), _checks.options(
        outputs={name: _own_output(name, function) for name, function in _functions(outputs).items()},
        change=_bounds(change), minimise=_checks.words(minimise, "minimise"),
        maximise=_checks.words(maximise, "maximise"), want=_checks.words(want, "want"),
        poses=_checks.words(poses, "poses"), samples=samples, seed=seed, starts=starts, trade_off=trade_off,
        threads=threads), progress)


def _own_output(name: str, function: Callable[[Machine], float]) -> Callable[[Any], Optional[float]]:
    """What the search calls: a number, or None where there is none."""
    def call(core: Any) -> Optional[float]:
        try:
            found = function(Machine._wrapped(core))
        except ComputationError:
            return None
        return _result_of(found, name)
    return call


def _bounds(change: Mapping[str, Any]) -> Dict[str, str]:
    """Ranges as the command line has them; pairs are bounds in SI."""
    texts = {}
    for path, given in _paths(change, "change").items():
        if isinstance(given, str):
            texts[path] = given
            continue
        bounds = _checks.real_array(given, path)
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
    _checks.word(name, "name")
    array = np.array(_checks.real_array(values, name, missing=True))  # one's own stays one's own
    array.setflags(write=False)
    if array.shape != (len(study.values),):
        raise ValueError(f"{name}: expected {len(study.values)} numbers, got an array of shape {array.shape}")
    if name in study.names or name in added_to(study):
        raise ValueError(f"{name}: there is such a column already")
    added_to(study)[name] = array


def machine(study: Any, row: int) -> Machine:
    """The machine of a row: its numbers, and of a map its pose. Raises InputError where it cannot be."""
    core = study.core_machine(_checks.whole(row, "row"))
    return Machine._wrapped(core)


def evaluate(study: Any, function: Callable[[Machine], float], *, progress: Optional[Progress] = None) -> Any:
    """function(machine) for every row (N,): a real number.

    NaN where the row has no machine or no frequencies, and where the function raises ComputationError; other
    exceptions come through. progress: gets the share done; True stops with ComputationError.
    """
    _checked_function(function, "function")
    status = column(study, "status")
    values = np.full(len(status), np.nan)
    rows = np.flatnonzero(status == 0)
    for done, row in enumerate(rows):
        if progress is not None and progress(done / len(rows)):
            raise ComputationError(f"interrupted: the function was computed for {done} of {len(rows)} rows")
        try:
            found = function(machine(study, int(row)))
        except ComputationError:
            continue
        values[row] = _result_of(found, f"row {row}")
    if progress is not None:
        progress(1.0)
    return values


def _result_of(found: Any, of: str) -> float:
    array = np.asarray(found)
    masked = isinstance(found, np.ma.MaskedArray) and bool(np.any(found.mask))
    if array.size != 1 or array.dtype.kind not in "fiub" or masked:
        raise TypeError(f"{of}: expected a function that returns a real number, it returned {found!r}")
    return float(array.reshape(())[()])


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
    cls.__contains__ = lambda study, name: name in study.names or name in added_to(study)
    cls.__iter__ = None  # neither over rows nor over columns; say which
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
        _core_of(machine)
        self.machine = machine
        self.paths = _checks.words(paths, "paths")
        self.modes = _checks.whole(modes, "modes")
        self.threads = _checks.threads_of(threads)
        count = self.sample([[machine[path] for path in self.paths]]).shape[1]
        if not 1 <= modes <= count:
            raise ValueError(f"modes: expected 1 to {count}, got {modes}")

    def __call__(self, x: Any) -> List[float]:
        design = np.atleast_1d(_checks.real_array(x, "x"))
        if design.shape != (len(self.paths),):
            raise ValueError(f"x: expected {len(self.paths)} numbers, got shape {design.shape}; sample(X) takes many "
                             "designs")
        return [float(value) for value in self.sample(design[np.newaxis])[0]]

    def sample(self, X: Any) -> Any:
        """(N, modes) of (N, paths) [SI]."""
        array = np.ascontiguousarray(_checks.real_array(X, "X"))
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
