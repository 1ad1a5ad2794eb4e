"""What was given: numbers, arrays and texts, or an exception that says what would be accepted."""

from __future__ import annotations

import math
import numbers
import operator
import os
from typing import Any, Callable, Dict, List, Optional, Sequence, Tuple, Union

import numpy as np

Texts = Union[str, Sequence[str]]


def shown(value: Any) -> str:
    """A value in a message: its beginning."""
    text = repr(value)
    return text if len(text) <= 100 else f"{text[:100]}…"


def whole(value: Any, name: str, low: int = -2**31, high: int = 2**31 - 1) -> int:
    """A whole number. Floats are none: a count of 10.5 is a mistake."""
    try:
        if isinstance(value, (bool, np.bool_)):
            raise TypeError
        number = operator.index(value)
    except TypeError:
        advice = f"; write {int(value)}" if isinstance(value, float) and value.is_integer() else ""
        raise TypeError(f"{name}: expected a whole number, got {shown(value)}{advice}") from None
    if not low <= number <= high:
        raise ValueError(f"{name}: expected a whole number of at least {low} and at most {high}, got {number}")
    return number


def threads_of(value: Any) -> int:
    """A number of threads; 0: one per processor."""
    return whole(value, "threads", *_wholes["threads"])


def number(value: Any, name: str) -> float:
    """A real, finite number."""
    if isinstance(value, (bool, np.bool_, np.timedelta64)) or not (isinstance(value, numbers.Real) or
                                                   isinstance(value, np.ndarray) and value.shape == () and
                                                   value.dtype.kind in "fiu"):
        raise TypeError(f"{name}: expected a number, got {shown(value)}")
    found = float(value)
    if not math.isfinite(found):
        raise ValueError(f"{name}: expected a finite number, got {found}")
    return found


def flag(value: Any, name: str) -> bool:
    """True or False; 1 and 0 too."""
    if value is True or value is False:
        return value
    if isinstance(value, (bool, np.bool_)):
        return bool(value)
    try:
        if operator.index(value) in (0, 1):
            return bool(operator.index(value))
    except TypeError:
        pass
    raise TypeError(f"{name}: expected True or False, got {shown(value)}")


def word(value: Any, name: str) -> str:
    """A text that can be written."""
    if not isinstance(value, str):
        raise TypeError(f"{name}: expected a text, got {shown(value)}")
    try:
        value.encode()
    except UnicodeEncodeError:
        raise ValueError(f"{name}: {shown(value)} is no text in UTF-8") from None
    if "\0" in value:
        raise ValueError(f"{name}: {shown(value)} has a character 0")
    return str(value)


def path(value: Any, name: str) -> str:
    """A path of a file as a text: a text, or what os.fspath() makes one of."""
    try:
        found = os.fspath(value)
    except TypeError:
        raise TypeError(f"{name}: expected a text or a path, got {shown(value)}") from None
    if not isinstance(found, str):
        raise TypeError(f"{name}: expected a text or a path, got bytes; os.fsdecode() makes a text of them")
    if not found:
        raise ValueError(f"{name}: expected the path of a file, got an empty text")
    return word(found, name)


def path_or_none(value: Any, name: str) -> Optional[str]:
    return None if value is None else path(value, name)


def output(value: Any, name: str, *inputs: str) -> str:
    """The path of a file to write, which is none of those that are read."""
    target = path(value, name)
    for given in inputs:
        if given and os.path.exists(target) and os.path.exists(given) and os.path.samefile(target, given):
            raise ValueError(f"{name}: {target!r} is the input, and was left as it is; choose another name")
    return target


def output_or_none(value: Any, name: str, *inputs: str) -> Optional[str]:
    return None if value is None else output(value, name, *inputs)


def words(given: Any, name: str) -> List[str]:
    """A text or several."""
    if isinstance(given, str):
        return [word(given, name)]
    try:
        items = list(given)
    except TypeError:
        raise TypeError(f"{name}: expected a text or a list of texts, got {shown(given)}") from None
    for item in items:
        if not isinstance(item, str):
            raise TypeError(f"{name}: expected a text or a list of texts, got {shown(item)} in it")
    return [word(item, name) for item in items]


def real_array(given: Any, name: str, *, missing: bool = False) -> Any:
    """An array of doubles. Masked elements are NaN where samples may be missing, else a mistake."""
    array = np.asanyarray(given) if isinstance(given, np.ma.MaskedArray) else np.asarray(given)
    if array.dtype.kind not in "fiu":
        advice = {"O": "; a missing one is NaN" if missing else "", "U": "; they are in SI, without a unit"}.get(
            array.dtype.kind, "")
        raise TypeError(f"{name}: expected real numbers, got an array of {array.dtype}{advice}")
    if isinstance(array, np.ma.MaskedArray):
        mask = np.broadcast_to(np.asarray(array.mask), array.shape)
        if missing:
            return np.where(mask, np.nan, array.data)
        if mask.any():
            raise ValueError(f"{name}: an element is masked; give numbers for all")
        array = array.data
    return np.asarray(array, dtype=float)


_seeds = (0, 2**64 - 1)
#: options that are whole numbers, with the least and the most that a program of 64 bits can take
_wholes: Dict[str, Tuple[int, int]] = {
    "seed": _seeds, "trace_samples": _seeds, "samples": _seeds,
    **{name: (-2**31, 2**31 - 1) for name in
       ("points", "pade_order", "modes", "starts", "trade_off", "bootstrap", "order", "block", "reduce", "fifo",
        "grid")},
    "threads": (0, 1024), "averages": (0, 100000), "oversampling": (1, 64), "repeat": (1, 1000000),
    "leg_modes": (0, 2**31 - 1)}
_flags = {"ideal_sensors", "anti_alias", "above_limits", "output_only", "modes_only", "damping", "indices",
          "buckling", "resume", "join", "whole_record", "sampled", "approximate", "accelerometers", "spectra",
          "lock_step", "once", "add_mass"}
_words = {"input", "output", "actuators", "integrator", "initial", "entry", "estimator", "window", "against",
          "input_from", "pose", "model", "loss", "title", "theme", "system", "design", "length_sensor",
          "pressure_sensor", "current_sensor", "torque_sensor", "speed_sensor", "format", "role", "direction",
          "address", "bind", "shared_memory", "hardware", "limits", "rest"}


def options(**given: Any) -> Dict[str, Any]:
    """Those that were given, each checked by its name; lists and paths are checked by who makes them."""
    checked: Dict[str, Any] = {}
    for name, value in given.items():
        if value is None:
            continue
        check: Callable[[Any, str], Any] = (lambda same, _: same)
        if name in _wholes:
            value = whole(value, name, *_wholes[name])
        elif name in _flags:
            check = flag
        elif name in _words:
            check = word
        elif name == "tolerance":
            check = number
        checked[name] = check(value, name)
    return checked
