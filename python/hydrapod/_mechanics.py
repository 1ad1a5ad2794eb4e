"""Kinematics at many poses, statics and buckling at one, signals as samples."""

from __future__ import annotations

from typing import Any, List, NamedTuple, Optional, Tuple

import numpy as np

from . import _checks, _core
from ._checks import Texts
from ._core import ModesAtAmplitudes
from ._machine import Machine, Quantity
from ._progress import all_or_none
from ._tasks import Progress, _core_of


_rest = (0.0,) * 6


def _rows(given: Any, name: str) -> Tuple[Any, bool]:
    """N × 6 numbers, and whether there was one row alone."""
    array = _checks.real_array(given, name)
    if array.ndim not in (1, 2) or array.shape[-1] != 6:
        raise ValueError(f"{name}: expected six numbers or an array of poses × 6, got shape {array.shape}")
    return np.ascontiguousarray(np.atleast_2d(array)), array.ndim == 1


def leg_lengths(machine: Machine, displacements: Any = None) -> Any:
    """Leg lengths between the joints [m] (6,) at the machine's pose, or (N, 6) at displacements from it.

    displacements: x, y, z [m], rx, ry, rz [rad]: roll, pitch and yaw, R = Rz Ry Rx, as in the text of a pose.
    Whether the legs reach is not checked; read_machine(…, pose=…) does.
    Raises TypeError or ValueError for arrays that are no rows of six finite numbers. Source: docs/notation.md.
    """
    rows, single = _rows(_rest if displacements is None else displacements, "displacements")
    lengths = _core.leg_lengths(_core_of(machine), rows)
    return lengths[0] if single else lengths


def leg_jacobian(machine: Machine, displacements: Any = None) -> Any:
    """J (6, 6), or (N, 6, 6) at displacements: rates of the legs from the platform's twist, l̇ = J (v; ω).

    v is the velocity of the platform frame's origin [m/s], ω the angular velocity [rad/s], in base axes.
    Raises as leg_lengths(). Source: docs/notation.md.
    """
    rows, single = _rows(_rest if displacements is None else displacements, "displacements")
    jacobians = _core.leg_jacobian(_core_of(machine), rows)
    return jacobians[0] if single else jacobians


def forward_kinematics(machine: Machine, lengths: Any, *, start: Any = None) -> Any:
    """Displacement (6,) from the machine's pose at which the legs have `lengths` [m]; (N, 6) for (N, 6).

    start: displacement to begin at, one or one for each row; a hexapod has up to 40 poses for the same lengths,
    and the one near the start is found, to 1e-12 m. A row is NaN where none is found.
    Raises as leg_lengths(). Source: docs/notation.md.
    """
    rows, single = _rows(lengths, "lengths")
    starts, _ = _rows(_rest if start is None else start, "start")
    poses, _residuals = _core.forward_kinematics(_core_of(machine), rows, starts)
    return poses[0] if single else poses


def modes_at_amplitudes(machine: Machine, amplitudes: Any, *, progress: Optional[Progress] = None) -> ModesAtAmplitudes:
    """Modes at amplitudes [m] of the platform joint that moves most, by harmonic balance.

    They show what guide rings, elastomers and friction make of the modes. amplitudes: of the platform joint that
    moves most [m], above 0, ascending; a number or (k,). Result, m branches of modes that move the platform:
    frequency_hz, damping_ratio, sleeve_amplitude [m], each (m, k), NaN where a branch does not have the amplitude,
    the first solution where it has several; amplitudes (k,); numbers (m,) of the undamped modes, counted from 0;
    directions (m); from_long_swings (m), of second branches of modes.
    Raises ValueError for amplitudes that do not ascend, ComputationError where progress stops.
    Source: docs/theory/amplitude.md.
    C++: tasks::modes_at_amplitudes in hydrapod/tasks/linear.hpp.
    """
    values = np.atleast_1d(_checks.real_array(amplitudes, "amplitudes"))
    if values.ndim != 1:
        raise ValueError(f"amplitudes: expected a number or a list, got shape {values.shape}")
    if not np.isfinite(values).all():
        raise ValueError("amplitudes: expected finite numbers")
    with all_or_none(progress) as told:
        return _core.modes_at_amplitudes(_core_of(machine), values.tolist(), told)


class PoseQuality(NamedTuple):
    """How well the legs hold the platform at a pose."""

    condition: float  #: of the Jacobian, lengths divided by characteristic_length; infinite at a singularity
    singular_values: Any  #: (6,), descending, dimensionless
    weakest_direction: Any  #: (6,), motion that the legs resist least, (v; ω)
    characteristic_length: float  #: [m]


def pose_quality(machine: Machine) -> PoseQuality:
    """Condition, singular values and weakest direction of the Jacobian at the machine's pose.

    Lengths are divided by characteristic_length [m]; see PoseQuality. Source: docs/notation.md.
    """
    return PoseQuality(**_core.pose_quality(_core_of(machine)))


class StaticEquilibrium(NamedTuple):
    """Rest under gravity with closed valves at a pose."""

    oil_force: Any  #: (6,) [N], positive where the leg is pulled
    flexible: Any  #: (6, 4): φ1, φ2 [rad] of the rod in its sleeve, u1, u2 [m] of the piston in its ring
    residual: float  #: largest unbalanced force, as a share of the weight
    iterations: int


def static_equilibrium(machine: Machine) -> StaticEquilibrium:
    """Oil forces and bends of the legs at rest at the machine's pose, with its model.

    Raises ComputationError where the machine does not stand: no equilibrium, or a leg that folds.
    oil_force [N], flexible [rad, m]: see StaticEquilibrium. Source: docs/theory/linear-model.md.
    """
    return StaticEquilibrium(**_core.static_equilibrium(_core_of(machine)))


class Buckling(NamedTuple):
    """When the legs give way."""

    status: str  #: found, not_found (up to 100 times the platform's mass, or no gravity) or buckled
    payload: float  #: [kg] on top of the platform's mass; negative: what must come off; NaN: not found
    limit_point: bool  #: it ended at a limit point, else with a mode at zero
    column_strength: Any  #: (6,) [N] of the leg as a column of case and rod; NaN: the rod's section is not known
    euler_force: Any  #: (6,) [N], the same without yielding


def buckling(machine: Machine) -> Buckling:
    """Payload at which seals and legs buckle at the machine's pose, and strengths of the legs as columns.

    payload [kg], column_strength and euler_force [N]: see Buckling. Source: docs/theory/linear-model.md.
    """
    return Buckling(**_core.buckling(_core_of(machine)))


class SampledSignals(NamedTuple):
    """Signals over time."""

    time: Any  #: (N,) [s]
    values: Any  #: (N, 6): x … rz
    rates: Any  #: (N, 6), exact derivatives; 0 of white noise and binary sequences
    texts: List[str]  #: the signals with all their keys
    period: Optional[int]  #: samples after which they repeat; None: they do not


def sample_signals(signals: Texts, *, rate: Quantity = 1000.0, duration: Optional[Quantity] = None,
                   unit: str = "displacement", excitation: bool = False, seed: int = 1) -> SampledSignals:
    """What commands and excitations are, sample by sample: "multisine z=2 mm, to=20 Hz", … They add up.

    rate: [Hz]. duration: default as long as the signals go on. unit: displacement [m, rad], drive [share] or
    wrench [N, N m]. excitation: defaults of `hydrapod rig` (levels as RMS values, directions in turn) instead
    of those of `hydrapod simulate`. The same texts, rate and seed give the same numbers. Raises InputError.
    Source: docs/howto/signals.md.
    """
    hertz = _core.quantity(rate, "Hz", "rate")
    if not hertz > 0:
        raise ValueError(f"rate: expected more than 0 Hz, got {hertz}")
    seconds = None if duration is None else _core.quantity(duration, "s", "duration")
    values, rates, texts, period = _core.sample_signals(
        _checks.words(signals, "signals"), hertz, seconds, _checks.word(unit, "unit"),
        _checks.flag(excitation, "excitation"), _checks.whole(seed, "seed", 0, 2**64 - 1))
    return SampledSignals(np.arange(len(values)) / hertz, values, rates, texts, period)
