"""The machine: its file, its numbers by path and as attributes, and variants of it."""

from __future__ import annotations

import html
import json
import operator
import os
import re
from typing import Any, Iterator, List, Mapping, Optional, Tuple, Union

import numpy as np

from . import _checks, _core

Quantity = Union[float, int, str]
Value = Union[Quantity, bool, List[Any], Tuple[Any, ...], "Parameters"]


def _number(value: Any) -> str:
    """A real number as a file has it. Numbers of NumPy may be complex, or durations, and float() would take a part."""
    if getattr(getattr(value, "dtype", None), "kind", "f") not in "fiuO":
        raise TypeError
    return repr(float(value))


def _toml(value: Value) -> str:
    """`value` as an override has it."""
    if isinstance(value, str):
        return value
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, Parameters):
        value = list(value)
    if isinstance(value, (list, tuple)) or hasattr(value, "tolist") and getattr(value, "ndim", 1) > 0:
        items = value if isinstance(value, (list, tuple)) else value.tolist()
        texts = [json.dumps(v, ensure_ascii=False) if isinstance(v, str) else _toml(v) for v in items]
        return f"[{', '.join(texts)}]"
    try:
        return _number(value)
    except (TypeError, ValueError):
        raise TypeError(f"expected a number, a text with a unit or a list of these, got {value!r}") from None


def _pose(pose: Any) -> str:
    if not isinstance(pose, str):
        raise TypeError(f"pose: expected a pose of the file or displacements as a text, such as \"z=50 mm, ry=5 deg\", "
                        f"got {pose!r}")
    return _checks.word(pose, "pose")


def _lines(overrides: Mapping[str, Value]) -> List[str]:
    """As --set has them."""
    if not isinstance(overrides, Mapping):
        raise TypeError(f"overrides: expected a dict {{PATH: value}}, got {overrides!r}")
    return [_checks.word(f"{_checks.word(path, 'overrides')}={_toml(value)}", "overrides")
            for path, value in overrides.items()]


class Parameters:
    """Part of a machine's numbers: machine.legs.guide_sleeve.stiffness [SI]."""

    __slots__ = ("_machine", "_path")

    def __init__(self, machine: "Machine", path: str):
        self._machine = machine
        self._path = path

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return self._machine._at(f"{self._path}.{name}")

    def __setattr__(self, name: str, value: object) -> None:
        if name in self.__slots__:
            object.__setattr__(self, name, value)
            return
        path = f"{self._path}.{name}"
        raise AttributeError(f"a machine does not change; use machine.with_({{\"{path}\": {value!r}}}), "
                             "which gives another one")

    def __getitem__(self, key: Union[int, str]) -> Any:
        """An element of an array, counted from 0, or a key: machine.leg["3"]."""
        if isinstance(key, str):
            return self._machine._at(f"{self._path}.{key}")
        number, count = operator.index(key), self._count()
        if not -count <= number < count:
            raise IndexError(f"{self._path} has {count} elements, not one of number {number}")
        return self._machine._at(f"{self._path}[{number % count}]")

    def _count(self) -> int:
        """Elements of an array; 0: it is none."""
        ends = [path[len(self._path) + 1:].split("]")[0] for path in self._machine.paths
                if path.startswith(self._path + "[")]
        return len(set(ends))

    def __len__(self) -> int:
        return self._count() or len(self.__dir__())

    def __dir__(self) -> List[str]:
        return sorted(self._machine._keys_below(self._path))

    def __eq__(self, other: object) -> bool:
        """The same part of equal machines."""
        return isinstance(other, Parameters) and self._path == other._path and self._machine == other._machine

    def __hash__(self) -> int:
        return hash((self._path, self._machine))

    def __iter__(self) -> Iterator[Any]:
        """Elements of an array, else keys."""
        count = self._count()
        return iter([self[k] for k in range(count)] if count else self.__dir__())

    def __repr__(self) -> str:
        rows = [
            f"  {path} = {self._machine[path]:.6g} {self._machine.unit(path)}"
            for path in self._machine.paths
            if path == self._path or path.startswith((self._path + ".", self._path + "["))
        ]
        return f"Parameters {self._path}\n" + "\n".join(rows)


class Machine:
    """A machine at one pose, with one model (rigid, guide or full). It does not change.

    Numbers by path: machine["legs.rod.mass"] [SI]; as attributes: machine.legs.rod.mass.
    Variants: machine.with_(**{"platform.mass": "4 t"}), machine.at("z=50 mm"), machine.using("rigid").
    Machines can be copied, compared, hashed and pickled: they are their file's text and what was asked.
    """

    __slots__ = ("_core_machine", "_pose", "_model", "__weakref__")

    _core_machine: _core.Machine
    _pose: str
    _model: Optional[str]

    def __init__(self, text: str, *, path: str = "machine.toml", overrides: Mapping[str, Value] = {},
                 pose: str = "neutral", model: Optional[str] = None):
        """From the text of a machine file; `path`: what messages call it. See read_machine()."""
        lines = _lines(overrides)
        try:
            text.encode()
        except AttributeError:
            raise TypeError(f"text: expected the text of a machine file, got {_checks.shown(text)}") from None
        except UnicodeEncodeError:
            raise ValueError("text: is no text in UTF-8") from None
        self._read(path, text, lines, pose, model)

    def _read(self, path: str, text: Optional[str], overrides: List[str], pose: str, model: Optional[str]) -> None:
        pose, model = _pose(pose), None if model is None else _checks.word(model, "model")
        self._set(_core.read_machine(_checks.word(path, "path"), text, overrides, pose, model), pose, model)

    def _set(self, core: _core.Machine, pose: str, model: Optional[str]) -> None:
        object.__setattr__(self, "_core_machine", core)
        object.__setattr__(self, "_pose", pose)
        object.__setattr__(self, "_model", model)

    @classmethod
    def _made(cls, path: str, text: Optional[str], overrides: List[str], pose: str,
              model: Optional[str]) -> "Machine":
        machine = cls.__new__(cls)
        machine._read(path, text, overrides, pose, model)
        return machine

    @classmethod
    def _wrapped(cls, core: _core.Machine) -> "Machine":
        machine = cls.__new__(cls)
        machine._set(core, core.pose, core.model)
        return machine

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"a machine does not change; use machine.with_(**{{\"{name}…\": value}})")

    # --- what it is -------------------------------------------------------------------------------

    @property
    def name(self) -> str:
        """Name of the machine in its file."""
        return self._core_machine.name

    @property
    def description(self) -> str:
        """Its description in the file."""
        return self._core_machine.description

    @property
    def path(self) -> str:
        """Path of the file, as messages and results call it."""
        return self._core_machine.path

    @property
    def text(self) -> str:
        """Text of the file, without the overrides."""
        return self._core_machine.text

    @property
    def applied_text(self) -> str:
        """Text of a file with the overrides in it, comments kept."""
        return self._core_machine.applied_text

    def write(self, path: Union[str, "os.PathLike[str]"]) -> None:
        """Writes a machine file with the overrides in it. The pose is not part of it."""
        _core.write_text(_checks.path(path, "path"), self.applied_text)

    @property
    def overrides(self) -> List[str]:
        """PATH=VALUE, as --set of the command line."""
        return self._core_machine.overrides

    @property
    def pose(self) -> str:
        """Its pose: a name or displacements."""
        return self._core_machine.pose

    @property
    def model(self) -> str:
        """rigid, guide or full."""
        return self._core_machine.model

    @property
    def poses(self) -> List[str]:
        """Names of the poses of the file."""
        return self._core_machine.poses

    @property
    def warnings(self) -> List[str]:
        """What is doubtful in the file: a list of sentences."""
        return self._core_machine.warnings

    # --- numbers ----------------------------------------------------------------------------------

    @property
    def paths(self) -> List[str]:
        """Paths of all numbers that the machine holds."""
        return self._core_machine.paths

    def __getitem__(self, path: str) -> float:
        """The number at `path` [SI]. Raises InputError naming the nearest path."""
        return self._core_machine.value(_checks.word(path, "path"))

    def __contains__(self, path: object) -> bool:
        """Whether the machine holds a number at `path`."""
        return path in self.paths

    def __iter__(self) -> Iterator[str]:
        """Over `paths`."""
        return iter(self.paths)

    def unit(self, path: str) -> str:
        """Its SI unit, "1" for pure numbers."""
        return self._core_machine.unit(_checks.word(path, "path"))

    def _keys_below(self, path: str) -> List[str]:
        keys = set()
        for one in self.paths:
            if one.startswith(path + "."):
                keys.add(one[len(path) + 1:].split(".")[0].split("[")[0])
        return sorted(keys)

    def _at(self, path: str) -> Any:
        paths = self.paths
        if path in paths:
            return self[path]
        if any(one.startswith((path + ".", path + "[")) for one in paths):
            return Parameters(self, path)
        raise AttributeError(f"'{path}' is no number of this machine; machine.paths lists them")

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        return self._at(name)

    def __dir__(self) -> List[str]:
        return sorted(set(super().__dir__()) | {path.split(".")[0] for path in self.paths})

    # --- variants ---------------------------------------------------------------------------------

    def with_(self, overrides: Mapping[str, Value] = {}, /, **more: Value) -> "Machine":
        """The machine with other values: with_(**{"platform.mass": "4 t"}) or with_({"platform.mass": 4000}).

        A value is a number in SI, a text with a unit, or a list of these. They are laid over the file as
        --set of the command line is, and everything is checked again. Raises InputError.
        """
        lines = self.overrides + _lines({**overrides, **more})
        return self._made(self.path, self.text, lines, self._pose, self._model)

    def at(self, pose: str) -> "Machine":
        """At a pose of the file, or at displacements from the neutral pose: "z=50 mm, ry=5 deg"."""
        return self._made(self.path, self.text, self.overrides, pose, self._model)

    def using(self, model: Optional[str]) -> "Machine":
        """With the model rigid, guide (compliant guide sleeves) or full (piston rings too)."""
        return self._made(self.path, self.text, self.overrides, self._pose, model)

    # --- as a value -------------------------------------------------------------------------------

    def _key(self) -> Tuple[Any, ...]:
        return (self.path, self.text, tuple(self.overrides), self._pose, self.model)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Machine) and self._key() == other._key()

    def __hash__(self) -> int:
        return hash(self._key())

    def __reduce__(self) -> Tuple[Any, ...]:
        return (Machine._made, (self.path, self.text, self.overrides, self._pose, self._model))

    def __copy__(self) -> "Machine":
        return self

    def __deepcopy__(self, memo: Any) -> "Machine":
        return self

    def _repr_html_(self) -> str:
        """In notebooks: its masses and the poses."""
        rows = "".join(f"<tr><td>{html.escape(path)}</td><td>{self[path]:.6g} {html.escape(self.unit(path))}</td></tr>"
                       for path in ("platform.mass", "legs.rod.mass", "legs.case.mass", "legs.guide_sleeve.stiffness")
                       if path in self)
        return (f"<div><b>Machine</b>: {html.escape(repr(self)[9:-1])}<table><tbody>{rows}</tbody></table>"
                f"<p>poses: {html.escape(', '.join(self.poses))}; {len(self.paths)} numbers</p></div>")

    def __repr__(self) -> str:
        changed = f", with {'; '.join(self.overrides)}" if self.overrides else ""
        return f"<Machine {self.name!r}, pose {self.pose}, {self.model} model{changed}>"


def read_machine(path: Union[str, "os.PathLike[str]"], *, overrides: Mapping[str, Value] = {},
                 pose: str = "neutral", model: Optional[str] = None) -> Machine:
    """Reads the file and judges the machine at all its poses.

    path: a machine file (TOML), or the text of one (with line breaks).
    overrides: {PATH: value} laid over the file, as --set. pose: a pose of the file, or displacements from the
    neutral pose ("z=50 mm, ry=5 deg"). model: rigid, guide or full; default: full where the file has piston
    rings, else guide. Raises InputError with all mistakes, each with file, line, column and what would be
    accepted. Keys and units: docs/howto/machine-file.md. C++: tasks::read_machine in hydrapod/tasks/machine.hpp.
    """
    if isinstance(path, str) and "\n" in path:
        return Machine(path, overrides=overrides, pose=pose, model=model)
    lines = _lines(overrides)
    return Machine._made(_checks.path(path, "path"), None, lines, pose, model)


def _document(table: Mapping[str, Any], path: str = "") -> str:
    """The table as TOML; numbers and texts first, then the tables below it."""
    lines, below = [], []
    for key, value in table.items():
        if isinstance(key, (int, np.integer)) and not isinstance(key, bool):
            key = str(key)
        plain = re.fullmatch(r"[A-Za-z0-9_-]+", _checks.word(key, "a key"))
        name = key if plain else json.dumps(key, ensure_ascii=False)
        at = f"{path}.{name}" if path else name
        if isinstance(value, Mapping):
            below.append(f"\n[{at}]\n{_document(value, at)}")
        elif value is not None:
            lines.append(f"{name} = {_toml_value(value, at)}\n")
    return "".join([*lines, *below])


def _toml_value(value: Any, path: str) -> str:
    """A value as a file has it: texts in quotes, tables in a list in braces."""
    if isinstance(value, str):
        return json.dumps(_checks.word(value, path), ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{json.dumps(_checks.word(key, path))} = {_toml_value(one, path)}"
                                for key, one in value.items()) + " }"
    if isinstance(value, (list, tuple, np.ndarray, Parameters)):
        return f"[{', '.join(_toml_value(one, path) for one in value)}]"
    if hasattr(value, "__index__"):
        return str(operator.index(value))
    try:
        return _number(value)
    except (TypeError, ValueError):
        raise TypeError(f"{path}: expected a number, a text, a dict or a list of these, got {value!r}") from None


def build_machine(**tables: Any) -> Machine:
    """A machine from keyword arguments: the keys and tables of a machine file, tables as dicts.

        hydrapod.build_machine(name="mine", platform={"mass": "4 t", "inertia": {"xx": 900, "yy": 900, "zz": 1500}},
                               legs={"rod": {"length": 1.05, "mass": "22 kg"}}, leg={3: {"rod": {"mass": 25}}}, …)

    Numbers are in SI; texts may have a unit; None is left out. Keys and units: docs/howto/machine-file.md. The machine
    is at its neutral pose: at() and using() give others. Raises InputError with all mistakes, each with its key; lines
    are those of machine.text. Raises TypeError for values that no file can have.
    """
    return Machine(_document(tables) + "\n")


def starter_machine_file() -> str:
    """A commented machine file to start from; it is sound and describes a plausible motion platform.

    The same as `hydrapod init` writes. C++: model::starter_machine_file in hydrapod/model/machine_file.hpp.
    """
    return _core.starter_machine_file()


def parameter_reference() -> str:
    """The tables of docs/howto/machine-file.md, in Markdown.

    All keys of a machine file with their units, as `hydrapod init --reference` prints them.
    C++: model::parameter_reference in hydrapod/model/parameters.hpp.
    """
    return _core.parameter_reference()
