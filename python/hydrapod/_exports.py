"""The machine for other programs: files, state space, superelement, multibody model."""

from __future__ import annotations

import os
from typing import Any, List, NamedTuple, Optional, Sequence

from . import _checks, _core
from ._checks import Texts
from ._core import MachineStateSpace, Superelement
from ._machine import Machine, Quantity
from ._records import Path
from ._tasks import _core_of, _point

_formats = {"mat": "mat", "npz": "npz", "json": "json", "h5": "hdf5", "hdf5": "hdf5", "uff": "uff", "unv": "uff",
            "mtx": "mtx", "pch": "dmig", "xml": "mjcf", "mjcf": "mjcf", "sdf": "sdf", "urdf": "urdf"}


class ParityLine(NamedTuple):
    """What a format holds of the machine."""

    held: str  #: exact, approximate or absent
    what: str
    how: str


class Export(NamedTuple):
    """Files that were written, and what they hold."""

    files: List[str]
    parity: List[ParityLine]


def _names(texts: Optional[Texts], name: str) -> Optional[List[str]]:
    return None if texts is None else _checks.words(texts, name)


def _system(system: Optional[str], sample_time: Optional[Quantity], sampled: bool, pade_order: int,
            inputs: Optional[Texts], outputs: Optional[Texts], point: Optional[Sequence[Quantity]],
            reduce: Optional[int]) -> Any:
    return _checks.options(
        system=system, sample_time=sample_time, sampled=_checks.flag(sampled, "sampled") or None,
        pade_order=pade_order, inputs=_names(inputs, "inputs"), outputs=_names(outputs, "outputs"),
        point=None if point is None else _point(point), reduce=reduce)


def export(machine: Machine, path: Path, *, to: Optional[str] = None, system: Optional[str] = None,
           sample_time: Optional[Quantity] = None, sampled: bool = False, pade_order: int = 2,
           inputs: Optional[Texts] = None, outputs: Optional[Texts] = None,
           point: Optional[Sequence[Quantity]] = None, reduce: Optional[int] = None,
           leg_modes: Optional[int] = None, approximate: bool = False) -> Export:
    """Writes the machine as a file for another program, as `hydrapod export` does.

    to: mat, npz, json, hdf5 (state space), uff (modes), mtx, dmig (superelement), mjcf, sdf, urdf (multibody),
    fmu2, fmu3 (functional mock-up unit); default: by the ending. system: default mechanics for a state space,
    plant for an FMU. Other options: see machine_state_space() and superelement(). approximate: write also what
    the format holds only in part. Raises InputError where a format cannot hold the machine; nothing is written
    then. Source: docs/howto/exchange.md.
    """
    name = os.fspath(path)
    if to is None:
        ending = os.path.splitext(name)[1].lstrip(".").lower()
        if ending not in _formats:
            raise ValueError(f"path: the ending of {name!r} names no format; give to=, one of "
                             f"{', '.join(sorted({*_formats.values(), 'fmu2', 'fmu3'}))}")
        to = _formats[ending]
    _checks.word(to, "to")
    options = _system(system, sample_time, sampled, pade_order, inputs, outputs, point, reduce)
    files, parity = _core.export_machine(_core_of(machine), {
        **options, **_checks.options(path=name, to=to, leg_modes=leg_modes, approximate=approximate)})
    return Export(files, [ParityLine(*line) for line in parity])


def machine_state_space(machine: Machine, *, system: str = "mechanics", sample_time: Optional[Quantity] = None,
                        sampled: bool = False, pade_order: int = 2, inputs: Optional[Texts] = None,
                        outputs: Optional[Texts] = None, point: Optional[Sequence[Quantity]] = None,
                        reduce: Optional[int] = None) -> MachineStateSpace:
    """A, B, C, D with names of states, inputs and outputs.

    system: mechanics (states y, ẏ; inputs wrench at the point and forces of the oil columns), plant (with
    hydraulics or electric drives) or loop (with the controller). sample_time: discretised, inputs held [s].
    sampled: the loop as its controller samples it, exactly. point: three lengths in the platform frame; default: the mass centre.
    reduce: states of a balanced truncation; the bound of its error stands in to_dict()["reduction"].

    Result: A, B, C, D; states, inputs, outputs; state_units, …; state_rest, input_rest, output_rest (values at
    the operating point: x, u and y are small changes from them); sample_time [s], 0: continuous; delay [s].
    state_space() and to_control() take it.
    Raises InputError for signals and options that cannot be, ComputationError where the supply cannot hold the
    machine. Source: docs/howto/exchange.md.
    """
    return _core.machine_state_space(_core_of(machine), _system(system, sample_time, sampled, pade_order, inputs,
                                                                outputs, point, reduce))


def superelement(machine: Machine, *, leg_modes: Optional[int] = None,
                 point: Optional[Sequence[Quantity]] = None) -> Superelement:
    """M, K, C by Craig and Bampton: the platform's six coordinates at the point, then modes of the legs.

    leg_modes: how many are kept, the lowest; default: all, which is exact. Result: M, K, C (n, n) [SI],
    coordinates, units, first_left_out [rad/s] (0: all modes are kept).
    Raises InputError for more modes than the legs have. Source: docs/howto/exchange.md.
    """
    return _core.superelement(_core_of(machine), _checks.options(
        leg_modes=leg_modes, point=None if point is None else _point(point)))


class MultibodyText(NamedTuple):
    """A multibody file as text."""

    text: str
    sidecar: str  #: of URDF: JSON of closures and springs; else empty
    parity: List[ParityLine]


def multibody_text(machine: Machine, format: str = "mjcf") -> MultibodyText:
    """The mechanism at rest as MJCF, SDF or URDF; parity lists what the format holds. Nothing is written.

    Result: text [SI, rad], sidecar, parity; see MultibodyText. Raises InputError for a format that is unknown.
    Source: docs/howto/exchange.md.
    """
    text, sidecar, parity = _core.multibody(_core_of(machine), _checks.word(format, "format"))
    return MultibodyText(text, sidecar, [ParityLine(*line) for line in parity])


def to_mujoco(machine: Machine) -> Any:
    """mujoco.MjModel of the mechanism at rest (needs mujoco)."""
    import mujoco  # type: ignore[import]

    return mujoco.MjModel.from_xml_string(multibody_text(machine, "mjcf").text)
