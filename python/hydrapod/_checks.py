"""What was given: numbers, arrays and texts, or an exception that says what would be accepted."""

from __future__ import annotations

import math
import numbers
import operator
from typing import Any, Callable, Dict, List, Sequence, Tuple, Union

import numpy as np

Texts = Union[str, Sequence[str]]


def whole(value: Any, name: str, low: int = -2**31, high: int = 2**31 - 1) -> int:
    """A whole number. Floats are none: a count of 10.5 is a mistake."""
    if isinstance(value, (bool, np.bool_)) or not hasattr(value, "__index__"):
        advice = f"; write {int(value)}" if isinstance(value, float) and value.is_integer() else ""
        raise TypeError(f"{name}: expected a whole number, got {value!r}{advice}")
    number = operator.index(value)
    if not low <= number <= high:
        raise ValueError(f"{name}: expected a whole number of at least {low} and at most {high}, got {number}")
    return number


def number(value: Any, name: str) -> float:
    """A real, finite number."""
    if isinstance(value, (bool, np.bool_)) or not (isinstance(value, numbers.Real) or
                                                   isinstance(value, np.ndarray) and value.shape == () and
                                                   value.dtype.kind in "fiu"):
        raise TypeError(f"{name}: expected a number, got {value!r}")
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
    if hasattr(value, "__index__") and operator.index(value) in (0, 1):
        return bool(operator.index(value))
    raise TypeError(f"{name}: expected True or False, got {value!r}")


def word(value: Any, name: str) -> str:
    if not isinstance(value, str):
        raise TypeError(f"{name}: expected a text, got {value!r}")
    return str(value)


def words(given: Any, name: str) -> List[str]:
    """A text or several."""
    if isinstance(given, str):
        return [str(given)]
    try:
        items = list(given)
    except TypeError:
        raise TypeError(f"{name}: expected a text or a list of texts, got {given!r}") from None
    for item in items:
        if not isinstance(item, str):
            raise TypeError(f"{name}: expected a text or a list of texts, got {item!r} in it")
    return [str(item) for item in items]


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
       ("points", "pade_order", "averages", "oversampling", "repeat", "modes", "threads", "starts", "trade_off",
        "bootstrap", "order", "block", "reduce", "fifo", "grid")},
    "leg_modes": (0, 2**31 - 1)}
_flags = {"ideal_sensors", "anti_alias", "above_limits", "output_only", "modes_only", "damping", "indices",
          "buckling", "resume", "join", "whole_record", "sampled", "approximate", "accelerometers", "spectra",
          "lock_step", "once", "add_mass"}
_words = {"input", "output", "actuators", "integrator", "initial", "entry", "estimator", "window", "against",
          "input_from", "pose", "model", "loss", "title", "theme", "system", "design", "length_sensor",
          "pressure_sensor", "current_sensor", "torque_sensor", "speed_sensor", "format", "role", "direction",
          "address", "bind", "shared_memory", "hardware", "limits", "rest"}


def options(**given: Any) -> Dict[str, Any]:
    """Those that were given, each checked by its name; lists are checked by who makes them."""
    checked: Dict[str, Any] = {}
    for name, value in given.items():
        if value is None:
            continue
        check: Callable[[Any, str], Any] = (lambda same, _: same)
        if isinstance(value, list):
            pass
        elif name in _wholes:
            value = whole(value, name, *_wholes[name])
        elif name in _flags:
            check = flag
        elif name in _words:
            check = word
        elif name == "tolerance":
            check = number
        checked[name] = check(value, name)
    return checked
