"""State space for other libraries: scipy.signal and python-control."""

from __future__ import annotations

from typing import Any, Tuple

import numpy as np

from ._core import Modes, System
from ._tasks import LinearPlant

_inputs = {"command": "B_command", "valve": "B_valve", "wrench": "B_wrench"}


def _matrices(of: Any, input: str) -> Tuple[Any, Any, Any, Any]:
    if isinstance(of, LinearPlant):
        return of.A, of.B, of.C, of.D
    if isinstance(of, System):
        if input not in _inputs:
            raise ValueError(f"input: expected one of {', '.join(_inputs)}, got {input!r}")
        B = getattr(of, _inputs[input])
        return of.A, B, of.C, np.zeros((of.C.shape[0], B.shape[1]))
    if isinstance(of, Modes):
        model = of.flexible
        n = model.M.shape[0]
        zero, one = np.zeros((n, n)), np.eye(n)
        M_inverse = np.linalg.inv(model.M)
        A = np.block([[zero, one], [-M_inverse @ model.K, -M_inverse @ of.damping_matrix()]])
        B = np.vstack([np.zeros((n, 6)), M_inverse[:, :6]])
        C = np.hstack([np.eye(6, n), np.zeros((6, n))])
        return A, B, C, np.zeros((6, 6))
    raise TypeError(f"expected a System, a LinearPlant or Modes, got {type(of).__name__}")


def state_space(of: Any, *, input: str = "command") -> Any:
    """scipy.signal.StateSpace of a System, a LinearPlant (of Plant.linearise()) or Modes.

    input, of a System: command (displacement of the commanded pose, without its velocity), valve or wrench.
    Modes: M ÿ + C ẏ + K y = F with the wrench at the mass centre as input and its motion as output.
    """
    from scipy.signal import StateSpace  # type: ignore[import]

    return StateSpace(*(np.array(matrix) for matrix in _matrices(of, input)))


def to_control(of: Any, *, input: str = "command") -> Any:
    """The same as control.ss (needs python-control)."""
    import control  # type: ignore[import]

    return control.ss(*(np.array(matrix) for matrix in _matrices(of, input)))
