"""The machine for other programs: files, state space, superelement, multibody model."""

from __future__ import annotations

import os
from typing import Any, List, NamedTuple, Optional, Sequence, Tuple

from . import _checks, _core
from ._checks import Texts
from ._core import MachineStateSpace, Superelement
from ._machine import Machine, Quantity
from ._records import Path
from ._tasks import _core_of, _point

_formats = {"mat": "mat", "npz": "npz", "json": "json", "h5": "hdf5", "hdf5": "hdf5", "uff": "uff", "unv": "unv",
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


def _system(system: Optional[str], sample_time: Optional[Quantity], sampled: bool, pade_order: Optional[int],
            inputs: Optional[Texts], outputs: Optional[Texts], point: Optional[Sequence[Quantity]],
            reduce: Optional[int]) -> Any:
    return _checks.options(
        system=system, sample_time=sample_time, sampled=_checks.flag(sampled, "sampled") or None,
        pade_order=pade_order, inputs=_names(inputs, "inputs"), outputs=_names(outputs, "outputs"),
        point=None if point is None else _point(point), reduce=reduce)


def export(machine: Machine, path: Path, *, to: Optional[str] = None, system: Optional[str] = None,
           sample_time: Optional[Quantity] = None, sampled: bool = False, pade_order: Optional[int] = None,
           inputs: Optional[Texts] = None, outputs: Optional[Texts] = None,
           point: Optional[Sequence[Quantity]] = None, reduce: Optional[int] = None,
           leg_modes: Optional[int] = None, free_base: bool = False, approximate: bool = False,
           measure: bool = True) -> Export:
    """Writes the machine as a file for another program.

    path: file to write. to: mat, npz, json, hdf5 (state space), uff, unv (modes), mtx, dmig (superelement), mjcf,
    sdf, urdf (multibody), fmu2, fmu3 (functional mock-up unit); default: by the ending. system: default mechanics for
    a state space, plant for an FMU. Other options: see machine_state_space() and superelement(). approximate: write
    also what the format holds only in part. measure: state in parity how far what is held is from the machine, which
    takes some ms, of plant and loop some tens. Raises InputError where a format cannot hold the machine; nothing is
    written then. Source: docs/howto/exchange.md. C++: tasks::export_machine in hydrapod/tasks/linear.hpp.
    """
    core = _core_of(machine)
    name = _checks.output(path, "path", core.path)
    if to is None:
        ending = os.path.splitext(name)[1].lstrip(".").lower()
        if ending not in _formats:
            raise ValueError(f"path: the ending of {name!r} names no format; give to=, one of "
                             f"{', '.join(sorted({*_formats.values(), 'fmu2', 'fmu3'}))}")
        to = _formats[ending]
    _checks.word(to, "to")
    options = _system(system, sample_time, sampled, pade_order, inputs, outputs, point, reduce)
    files, parity = _core.export_machine(core, {
        **options, **_checks.options(path=name, to=to, leg_modes=leg_modes, approximate=approximate,
                                     free_base=_checks.flag(free_base, "free_base"),
                                     measure=_checks.flag(measure, "measure"))})
    return Export(files, [ParityLine(*line) for line in parity])


def machine_state_space(machine: Machine, *, system: str = "mechanics", sample_time: Optional[Quantity] = None,
                        sampled: bool = False, pade_order: Optional[int] = None, inputs: Optional[Texts] = None,
                        outputs: Optional[Texts] = None, point: Optional[Sequence[Quantity]] = None,
                        reduce: Optional[int] = None) -> MachineStateSpace:
    """A, B, C, D with names of states, inputs and outputs.

    system: mechanics (states y, ẏ; inputs wrench at the point and forces of the oil columns), plant (with hydraulics
    or electric drives) or loop (with the controller). sample_time: discretised, inputs held [s]. pade_order: of the
    delay in a loop that is not sampled, 0 to 8; default: 2. sampled: the loop as its controller samples it, exactly.
    point: of the mechanics, three lengths in the platform frame; default: the mass centre. reduce: states of a
    balanced truncation; the bound of its error stands in to_dict()["reduction"].

    Result: A, B, C, D; states, inputs, outputs; state_units, …; state_rest, input_rest, output_rest (values at
    the operating point: x, u and y are small changes from them); sample_time [s], 0: continuous; delay [s].
    state_space() and to_control() take it.
    Raises InputError for signals and options that cannot be, ComputationError where the supply cannot hold the
    machine. Source: docs/howto/exchange.md.
    """
    return _core.machine_state_space(_core_of(machine), _system(system, sample_time, sampled, pade_order, inputs,
                                                                outputs, point, reduce))


def superelement(machine: Machine, *, leg_modes: Optional[int] = None,
                 point: Optional[Sequence[Quantity]] = None, free_base: bool = False) -> Superelement:
    """M, K, C by Craig and Bampton: the platform's six coordinates at the point, then modes of the legs.

    leg_modes: how many are kept, the lowest; default: all, which is exact. free_base: the base's six directions are
    coordinates behind those of the platform, without its mount and mass. Result: M, K, C (n, n) [SI], coordinates,
    units, first_left_out [rad/s] (0: all modes are kept).
    Raises InputError for more modes than the legs have. Source: docs/howto/exchange.md.
    """
    return _core.superelement(_core_of(machine), _checks.options(
        leg_modes=leg_modes, point=None if point is None else _point(point),
        free_base=_checks.flag(free_base, "free_base")))


class MultibodyText(NamedTuple):
    """A multibody file as text."""

    text: str
    sidecar: str  #: of URDF: JSON of closures and springs; else empty
    parity: List[ParityLine]


def multibody_text(machine: Machine, format: str = "mjcf") -> MultibodyText:
    """The mechanism at rest as MJCF, SDF or URDF; parity lists what the format holds. Nothing is written.

    format: mjcf, sdf or urdf. Result: text [SI, rad], sidecar, parity; see MultibodyText. Raises InputError for a
    format that is unknown, ComputationError where the machine does not stand at its pose. Source:
    docs/howto/exchange.md.
    """
    text, sidecar, parity = _core.multibody(_core_of(machine), _checks.word(format, "format"))
    return MultibodyText(text, sidecar, [ParityLine(*line) for line in parity])


def to_mujoco(machine: Machine) -> Any:
    """mujoco.MjModel of the mechanism at rest (needs mujoco)."""
    import mujoco  # type: ignore[import]

    return mujoco.MjModel.from_xml_string(multibody_text(machine, "mjcf").text)


class Attached(NamedTuple):
    """A machine with a structure on its platform, and the m modes that stand for the structure."""

    machine: Machine
    names: List[str]  #: of the modes in machine.text
    frequency_hz: Any  #: (m,) [Hz]
    damping_ratio: Any  #: (m,) shares of critical damping
    participation: Any  #: (m, 3) [√kg]: its square is the mass that moves along x, y, z
    mass: float  #: of the structure [kg]
    first_left_out_hz: float  #: lowest mode that is not kept [Hz]; its mass moves with the platform; 0: all are kept
    coupling: Tuple[float, float, float]  #: of two modes by the damping matrix: share, and their frequencies [Hz]


def attach(machine: Machine, stiffness: Optional[Path] = None, mass: Optional[Path] = None,
           damping: Optional[Path] = None, *, punch: Optional[Path] = None, uff: Optional[Path] = None,
           grid: Optional[int] = None, at: Sequence[Quantity] = (0.0, 0.0, 0.0), modes: Optional[int] = None,
           damping_ratio: Optional[Quantity] = None, add_mass: bool = False, path: Optional[Path] = None) -> Attached:
    """The machine with a structure on its platform that another program has reduced to a superelement.

    stiffness, mass, damping: Matrix Market files: x, y, z, rx, ry, rz of the interface, then inner coordinates. punch:
    a Nastran punch file (DMIG) in place of them. uff: a Universal File in place of them, with matrices (252, 2453) or
    modes (55). grid: point of a punch file, or node in a Universal File, that is the platform. at: the interface on the
    platform, three lengths [m] in its frame. modes: how many are kept, the lowest; default: six in all. damping_ratio:
    of modes whose damping the files do not state, 0.02 or "2 %". add_mass: adds mass and inertia of the structure to
    those of the platform. path: machine file to write; the new machine is then called by it.

    Result, an Attached: machine, names, frequency_hz (m,) [Hz], damping_ratio (m,), participation (m, 3) [√kg],
    mass [kg], first_left_out_hz [Hz], coupling.
    Raises InputError for matrices that are none, and for a payload that weighs more than the platform of the file.
    Source: docs/howto/exchange.md. C++: tasks::attach_payload in hydrapod/tasks/linear.hpp.
    """
    given = [(one, name) for one, name in ((stiffness, "stiffness"), (punch, "punch"), (uff, "uff")) if one is not None]
    if len(given) != 1:
        raise ValueError("expected one of stiffness with mass (Matrix Market), punch (Nastran) or uff (Universal File)")
    if stiffness is not None and mass is None:
        raise ValueError("mass: stiffness needs the mass matrix too")
    if stiffness is None and not (mass is None and damping is None):
        raise ValueError("mass, damping: punch and uff have them in their file; leave them out")
    target = _checks.path_or_none(path, "path")
    options = _checks.options(
        stiffness=_checks.path(*given[0]), mass=_checks.path_or_none(mass, "mass"),
        damping=_checks.path_or_none(damping, "damping"), grid=grid, point=_point(at), modes=modes,
        damping_ratio=damping_ratio, add_mass=add_mass)
    text, *found = _core.attach(_core_of(machine), {**options, "universal": uff is not None})
    attached = Machine(text, path=machine.path if target is None else target, pose=machine.pose,
                       model=machine.model)
    if target is not None:
        attached.write(target)
    return Attached(attached, *found)
