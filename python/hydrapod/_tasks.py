"""The tasks: what the command line does, with keyword arguments in and arrays out."""

from __future__ import annotations

import os
import tempfile
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np

from . import _checks, _core, _show
from ._core import (
    Bode,
    Calibrated,
    Check,
    CommandResponse,
    Diagnosed,
    Frf,
    Identified,
    Compared,
    Modes,
    ModesAtPoses,
    Report,
    RootLocus,
    Sensitivity,
    Simulation,
    System,
)
from ._checks import Texts
from ._errors import ComputationError
from ._machine import Machine, Quantity, _lines
from ._progress import all_or_none
from ._records import Measured, Path, Record, files_of, sources_of

Progress = Callable[[float], Optional[bool]]

_show.attach()


def _core_of(machine: Machine) -> _core.Machine:
    if not isinstance(machine, Machine):
        raise TypeError(f"machine: expected a Machine (hydrapod.read_machine(path)), got {machine!r}")
    return machine._core_machine


def _point(given: Any) -> List[Quantity]:
    """Three lengths."""
    items = [] if isinstance(given, str) else list(given) if hasattr(given, "__len__") else []
    if len(items) != 3:
        raise ValueError(f"point: expected three lengths, such as (0, 0, \"250 mm\"), got {given!r}")
    return items


# --- the machine near rest ------------------------------------------------------------------------


def modes(machine: Machine, *, matrices: bool = False) -> Modes:
    """Modes at the machine's pose, of its model beside the rigid-leg model.

    matrices: put M, K and C into .to_dict() too, as `hydrapod modes --matrices` does.

    Result, n modes in ascending frequency, dof coordinates:
        frequency_hz, omega [rad/s], damping_ratio, poles [1/s]   (n,)
        shapes                                                    (dof, n), φᴴ M φ = 1
        M, K, C   [kg, N/m, N s/m and their rotational units]     (dof, dof)
        labels, moves_platform, coordinates                       lists
        damping_matrix()     C with the modal damping ratio in it (dof, dof)
        rigid                the same of the rigid-leg model
        answer               lowest mode the platform feels, in one sentence
    A machine that buckles at this pose has unstable modes: stable is False, their frequency is 0.
    Raises ComputationError where it has no equilibrium. Source: docs/theory/linear-model.md.
    C++: tasks::modes in hydrapod/tasks/linear.hpp.
    """
    return _core.modes(_core_of(machine), _checks.flag(matrices, "matrices"))


def modes_at_poses(machine: Machine, poses: Texts, *, progress: Optional[Progress] = None) -> ModesAtPoses:
    """Modes at several poses, two or more, each followed by its shape from pose to pose.

    poses: names of the file or displacements from the neutral pose ("z=50 mm"). Result, m followed modes,
    p poses: frequency_hz (m, p), NaN where there is no such mode; mac (m, p) with the mode at the pose before;
    numbers (m, p), counted from 0, -1 for none; labels, poses.
    frequency_hz [Hz], mac [1]. Raises InputError for a pose that is unknown or out of reach, ValueError for fewer
    than two, ComputationError where progress stops. Source: docs/theory/linear-model.md.
    C++: tasks::modes_at_poses in hydrapod/tasks/linear.hpp.
    """
    with all_or_none(progress) as told:
        return _core.modes_at_poses(_core_of(machine), _checks.words(poses, "poses"), told)


def system(machine: Machine, *, closed: bool = True, pade_order: int = 2) -> System:
    """Mechanics, hydraulics, controller and delay as one linear system at rest, and its poles.

    closed=False: without the controller, valves held. pade_order: 0 to 8, of the delay.

    Result: A, B_command, B_velocity, B_valve, B_wrench, C, C_ground (against the ground), states, sampled (the
    matrix of the sampled loop), poles [1/s] (least damped in time first, one of each pair), damping_ratio,
    participation, stable (of the sampled loop), verdict, delay [s], sample_time [s].
    Raises ComputationError where the supply cannot hold the machine at this pose, ValueError for an order that
    cannot be. Source: docs/theory/control.md. C++: tasks::system in hydrapod/tasks/linear.hpp.
    """
    return _core.system(_core_of(machine), _checks.flag(closed, "closed"), _checks.whole(pade_order, "pade_order"))


def root_locus(machine: Machine, key: str, start: float, stop: float, count: int = 11, *, closed: bool = True,
               pade_order: int = 2, progress: Optional[Progress] = None) -> RootLocus:
    """Poles over one number of the machine file.

    key: its path; `count` values from start to stop [SI]. closed, pade_order: see system().
    Result: key, values, poles (a list of arrays), limits (values at which stability changes).
    values [SI], poles [1/s]. Raises InputError for a path that is unknown and values that cannot be,
    ComputationError where progress stops. Source: docs/theory/control.md.
    C++: tasks::root_locus in hydrapod/tasks/linear.hpp.
    """
    with all_or_none(progress) as told:
        return _core.root_locus(
            _core_of(machine), _checks.word(key, "key"), _checks.number(start, "start"), _checks.number(stop, "stop"),
            _checks.whole(count, "count"), _checks.flag(closed, "closed"), _checks.whole(pade_order, "pade_order"),
            told)


def bode(machine: Machine, *, input: str = "wrench", output: str = "displacement",
         from_: Optional[Quantity] = None, to: Optional[Quantity] = None, points: int = 2000,
         point: Optional[Sequence[Quantity]] = None) -> Union[Bode, CommandResponse]:
    """6×6 frequency responses of the platform with flexible and with rigid legs.

    input: wrench at the point, actuator (forces mapped to its directions), or command: from the commanded to
    the true pose, hydraulics and controller included (then a CommandResponse). output: displacement,
    velocity or acceleration. from_, to: band, numbers in Hz or texts ("30 rad/s"); default: from the modes.
    point: three lengths in the platform frame; default: the mass centre.

    Result: frequency_hz [Hz], omega [rad/s] (points,), H and H_rigid (points, 6, 6): H[k, out, in], complex, of an
    input of 1 N or 1 N m [m, rad; per s, per s²]; stable: False where no steady vibration exists, and the responses
    are those of the linear equations. Raises InputError or ValueError for a band, a number of points or a point that
    cannot be, ComputationError where the machine has no equilibrium. Source: docs/theory/linear-model.md. C++:
    tasks::bode in hydrapod/tasks/linear.hpp.
    """
    result: Union[Bode, CommandResponse] = _core.bode(_core_of(machine), {"from": from_, **_checks.options(
        input=input, output=output, to=to, points=points, point=None if point is None else _point(point))})
    return result


def check(machine: Machine, *, all_poses: bool = True) -> Check:
    """Lengths, static forces and buckling loads of the legs, and whether the machine is sound.

    all_poses=False: at the machine's pose alone. Result, p poses: sound, verdict, warnings, poses, lengths [m],
    axial_force [N, + compression], oil_stiffness [N/m], tilt [rad] (p, 6), buckling_payload [kg] (p,), NaN
    where there is none.
    A machine that is not sound raises nothing: sound is False. Source: docs/theory/capability.md.
    C++: tasks::check in hydrapod/tasks/linear.hpp.
    """
    return _core.check(_core_of(machine), _checks.flag(all_poses, "all_poses"))


def sensitivity(machine: Machine, parameters: Texts = ()) -> Sensitivity:
    """Change of each frequency per change of each number of the machine file.

    d ln ω / d ln p. parameters: paths; default: all that matter.

    Result: parameters, omega (n,), percent_per_percent (n, p).
    omega: |λ| of the damped modes [rad/s]; percent_per_percent [1]; NaN for modes that buckle.
    Raises InputError for a path that is unknown. Source: docs/theory/linear-model.md. C++: tasks::sensitivity in hydrapod/tasks/linear.hpp.
    """
    return _core.sensitivity(_core_of(machine), _checks.words(parameters, "parameters"))


def frequencies(machine: Machine, designs: Mapping[str, Any], *, threads: int = 0,
                progress: Optional[Progress] = None) -> Any:
    """Frequencies [Hz] of many designs, (designs, n): NumPy arrays in, an array out, all processors.

    They are the undamped ones, with elastomers those of the damped modes.
    designs: {PATH: values in SI}; arrays of one length, or numbers that hold for all; a DataFrame too. A design
    that no machine can be (a mass below 0, a pose out of reach) or that has no equilibrium at the pose has NaN, a mode
    that buckles 0 Hz.
    Arrays are computed in SIMD lanes: as single ones to 1e-12 (gravity 1e-11, nearly rigid sleeves 5e-11).
    Raises InputError for a path that is unknown, ValueError for numbers that are not finite or arrays of several
    lengths, ComputationError where progress stops. Source: docs/theory/linear-model.md.
    """
    core = _core_of(machine)
    if type(designs) is not dict and hasattr(designs, "columns"):  # a pandas.DataFrame
        designs = {path: designs[path] for path in designs.columns}
    if not designs:
        raise ValueError("designs: expected at least one path with values")
    one = _core.one_design(core, designs) if type(designs) is dict else None  # one design of floats, quickly
    if one is not None:
        return one
    if not isinstance(designs, Mapping):
        raise TypeError(f"designs: expected {{PATH: values}}, got {designs!r}")
    columns = np.broadcast_arrays(*(_checks.real_array(values, path) for path, values in designs.items()))
    if columns[0].ndim > 1:
        raise ValueError("designs: expected numbers or arrays of one dimension")
    table = np.ascontiguousarray(np.stack([np.atleast_1d(column) for column in columns], axis=1))
    return _core.frequencies(core, _checks.words(designs, "designs"), table, _checks.threads_of(threads), progress)


# --- over time ------------------------------------------------------------------------------------


def simulate(machine: Machine, commands: Texts = (), *, wrench: Texts = (), initial: Optional[str] = None,
             actuators: str = "controlled", until: Optional[Quantity] = None,
             integrator: str = "exponential", tolerance: float = 1e-6, step: Quantity = 1e-4, seed: int = 1,
             ideal_sensors: bool = False, output_interval: Optional[Quantity] = None,
             trace_samples: int = 3000, record: Optional[Path] = None,
             progress: Optional[Progress] = None) -> Simulation:
    """Time simulation: mechanics, hydraulics, controller.

    commands: "step z=5 mm", "sine ry=2 deg, frequency=1 Hz", … (hydrapod simulate --help); they add up. wrench: force
    and moment about the mass centre [N, N m], "sine x=500 N, frequency=4 Hz". initial: displacement from the pose at
    which the platform is released, "x=1 mm, ry=0.1 deg". actuators: "controlled"; "held", valves that stay as at
    rest, or motors held at the speed 0; "springs", mechanics alone on oil springs, or with locked motors. until: end
    [s]; default: shortly after the commands. integrator: exponential, adaptive, adams or bdf with errors below
    tolerance (relative), or fixed with steps of step [s]. seed: of noise in sensors and commands. ideal_sensors:
    without noise, resolution and range. output_interval: between samples of the record [s]; default: the
    controller's. trace_samples: of the arrays of the result, at most. record: file to write (.h5, .mat, .csv, .uff).
    A run that ends early has everything up to there: see finished and message.

    Result, N samples: time [s] (N,), command and motion [m, rad] (N, 6), piston [m], drive, cap_pressure,
    rod_pressure [Pa] (N, 6), rms_error, peak_error (6,), record, warnings. Of electric cylinders nut [m],
    motor_speed [rad/s], torque [N m] (N, 6), and no pressures.
    Raises InputError for signals and options that cannot be, ComputationError where the machine cannot be held at
    its pose. Source: docs/theory/nonlinear.md. C++: tasks::simulate in hydrapod/tasks/simulation.hpp.
    """
    return _core.simulate(_core_of(machine), _checks.options(
        commands=_checks.words(commands, "commands"), wrench=_checks.words(wrench, "wrench"), initial=initial,
        actuators=actuators, until=until,
        integrator=integrator, tolerance=tolerance, step=step, seed=seed, ideal_sensors=ideal_sensors,
        output_interval=output_interval, trace_samples=trace_samples,
        record=_checks.output_or_none(record, "record", _core_of(machine).path)), progress)


# --- measurements ---------------------------------------------------------------------------------


def _measure_options(machine: Union[Machine, Path, None], options: Dict[str, Any]) -> Dict[str, Any]:
    if isinstance(machine, Machine):
        options["machine"] = machine._core_machine
    elif machine is not None:
        options["machine_file"] = _checks.path(machine, "machine")
    for name in ("inputs", "outputs", "instruments", "sensors"):
        if options.get(name) is not None:
            options[name] = _checks.words(options[name], name)
    if options.get("point") is not None:
        options["point"] = _point(options["point"])
    return _checks.options(**options)


def frf(measured: Measured, *, machine: Union[Machine, Path, None] = None, pose: Optional[str] = None,
        model: Optional[str] = None, inputs: Optional[Texts] = None, outputs: Optional[Texts] = None,
        instruments: Optional[Texts] = None, input_from: Optional[str] = None, estimator: str = "auto",
        window: str = "hann", block: Optional[int] = None, overlap: Optional[Quantity] = None,
        period: Optional[Quantity] = None, whole_record: bool = False, settling: Optional[Quantity] = None,
        rate: Optional[Quantity] = None, exponential_window: Optional[Quantity] = None,
        accelerometers: bool = False, sensors: Texts = (), point: Optional[Sequence[Quantity]] = None,
        progress: Optional[Progress] = None) -> Frf:
    """Frequency responses of records, averaged together, or half spectra.

    measured: files, Record objects or a list of these. inputs, outputs: names of channels; default: by their roles.
    instruments: names of the external excitations of a closed loop; default: of the role excitation. input_from:
    drive (the machine without its controller) or excitation (with it); default: as the record says. estimator: auto,
    h1, h2, hv or iv. window: hann, rectangular, hamming, blackman-harris, flat-top or blackman. block: samples; default: from
    the length of the record. overlap: a share. period: of the excitation [s]; 0: none; default: found out. settling:
    time at the beginning that is left out [s]. rate: sample rate [Hz] of files that do not tell it. accelerometers:
    outputs are the accelerometers, as accelerations of the platform. sensors: their places, "NAME, at=X Y Z,
    along=x"; default: those of the record. point: three lengths in the platform frame, whose motion is meant;
    default: the mass centre. pose, model: default: those of the record. whole_record: of a short one, modes from all
    of it at once, or an error where that cannot be. machine: what was measured, a Machine or a file; default: the one
    in the record. exponential_window: time constant of the window that an analyser applied after a hit [s].

    Result, L lines: frequency_hz (L,), H and deviation (L, outputs, inputs), coherence, inputs, outputs,
    warnings.
    H in the units of outputs per inputs (SI). Raises InputError for records that do not fit, ComputationError
    where a record is too short, an input has no excitation, or progress stops. Source: docs/theory/identification.md.
    C++: tasks::frf in hydrapod/tasks/measurement.hpp.
    """
    with sources_of(measured) as sources, all_or_none(progress) as told:
        return _core.frf(_measure_options(machine, dict(
            **sources, pose=pose, model=model, inputs=inputs, outputs=outputs, instruments=instruments,
            input_from=input_from, estimator=estimator, window=window, block=block, overlap=overlap,
            period=period, whole_record=whole_record, settling=settling, rate=rate, exponential_window=exponential_window,
            accelerometers=accelerometers, sensors=sensors, point=point)), told)


def identify(measured: Measured, *, machine: Union[Machine, Path, None] = None, pose: Optional[str] = None,
             model: Optional[str] = None, from_: Optional[Quantity] = None, to: Optional[Quantity] = None,
             order: int = 0, highest_damping: Quantity = 0.3, against: str = "auto", bootstrap: int = 0,
             output_only: bool = False, inputs: Optional[Texts] = None, outputs: Optional[Texts] = None,
             instruments: Optional[Texts] = None, input_from: Optional[str] = None, estimator: str = "auto",
             window: str = "hann", block: Optional[int] = None, overlap: Optional[Quantity] = None,
             period: Optional[Quantity] = None, whole_record: bool = False, settling: Optional[Quantity] = None,
             rate: Optional[Quantity] = None, exponential_window: Optional[Quantity] = None,
             accelerometers: bool = False, sensors: Texts = (), point: Optional[Sequence[Quantity]] = None,
             progress: Optional[Progress] = None) -> Identified:
    """Modes of records or responses, with their uncertainty, compared with the machine where it is known.

    from_, to: band [Hz]. order: highest order of the models; default: from the number of references. highest_damping: a
    share. against: the model to compare with: auto, mechanics, plant, system or none. bootstrap: draws to check the
    intervals with; 0: none. output_only: from the outputs alone, without measured excitation. Others: see frf().

    Result, n modes: frequency_hz, frequency_deviation_hz, damping_ratio, damping_deviation, quality (n,);
    shapes (outputs, n) as displacements; outputs, inputs, motion, warnings. Deviations are standard deviations.
    L lines: line_frequency_hz (L,), H and deviation (measured), H_modes (of the modes) (L, outputs, inputs),
    mode_indicator: singular values of H (L, k). With 95 % probability H is off by less than radius_95 deviations.
    Raises as frf() does. Where there is no mode, n is 0 and warnings say why. Source: docs/theory/identification.md.
    C++: tasks::identify in hydrapod/tasks/measurement.hpp.
    """
    with sources_of(measured) as sources, all_or_none(progress) as told:
        return _core.identify(_measure_options(machine, {"from": from_, **dict(
            **sources, pose=pose, model=model, to=to, order=order, highest_damping=highest_damping,
            against=against, bootstrap=bootstrap, output_only=output_only, inputs=inputs, outputs=outputs,
            instruments=instruments, input_from=input_from, estimator=estimator, window=window, block=block,
            overlap=overlap, period=period, whole_record=whole_record, settling=settling, rate=rate,
            exponential_window=exponential_window, accelerometers=accelerometers, sensors=sensors,
            point=point)}), told)


def calibrate(machine: Machine, targets: Union[Path, Record, Identified], free: Union[Mapping[str, Any], Texts] = (), *,
              priors: Optional[Mapping[str, Tuple[Quantity, Quantity]]] = None, alternatives: Texts = (),
              profiles: Texts = (), loss: Optional[str] = None, starts: Optional[int] = None,
              seed: Optional[int] = None, threads: int = 0, progress: Optional[Progress] = None) -> Calibrated:
    """Fits numbers of the machine file to measured modes.

    targets: an Identified, or a file: TOML, CSV, or what identify writes. free: paths, or
    {PATH: (lowest, highest) or None}; "a, b" ties two. priors: {PATH: (value, spread)}.
    alternatives: overrides to be tried, "PATH=VALUE". profiles: free paths over which the misfit is computed too. loss:
    automatic, squares, or cauchy (little weight of outliers). starts: per combination, all but one random.

    Result of the best combination: parameters, units, values, deviations, verdicts, misfit, remarks,
    interrupted; text: the calibrated machine file, with its comments.
    values and deviations [SI]. Raises InputError for targets, paths and bounds that cannot be, ComputationError
    where no fit is found. Source: docs/theory/calibration.md. C++: tasks::calibrate in hydrapod/tasks/measurement.hpp.
    """
    with files_of(targets) as files:
        return _core.calibrate(_core_of(machine), _checks.options(
            targets=_only(files, "targets"), free=_bounds(free),
            priors=None if priors is None else {
                path: _pair(pair, f"priors of {path}", "(value, spread)")
                for path, pair in _mapping(priors, "priors").items()},
            alternatives=_checks.words(alternatives, "alternatives"), profiles=_checks.words(profiles, "profiles"),
            loss=loss, starts=starts, seed=seed, threads=threads), progress)


def _only(files: List[str], name: str) -> str:
    if len(files) != 1:
        raise TypeError(f"{name}: expected one file or result, got {len(files)}")
    return files[0]


def _mapping(given: Any, name: str) -> Mapping[str, Any]:
    """A dict with paths as keys."""
    if not isinstance(given, Mapping):
        raise TypeError(f"{name}: expected a dict {{PATH: …}}, got {_checks.shown(given)}")
    return given


def _pair(given: Any, name: str, what: str) -> List[Quantity]:
    """Two quantities; numbers become floats."""
    items = [] if isinstance(given, str) else list(given) if hasattr(given, "__len__") else []
    if len(items) != 2:
        raise ValueError(f"{name}: expected a pair {what}, got {given!r}")
    return [item if isinstance(item, str) else _checks.number(item, name) for item in items]


def _bounds(free: Union[Mapping[str, Any], Texts]) -> Union[Dict[str, Any], List[str]]:
    if not isinstance(free, Mapping):
        return _checks.words(free, "free")
    return {path: None if pair is None else _pair(pair, f"free: bounds of {path}", "(lowest, highest)")
            for path, pair in free.items()}


def _is_file(machine: Machine) -> bool:
    """Whether the file at the machine's path is this machine."""
    if machine.overrides or "@" in machine.path:
        return False
    try:
        with open(machine.path, encoding="utf-8", newline="") as file:
            return file.read() == machine.text
    except (OSError, UnicodeError):
        return False


def compare(*things: Union[Machine, Record, Identified, Frf, Path], overrides: Mapping[str, Any] = {},
            poses: Texts = (), model: Optional[str] = None, against: str = "auto", level: Quantity = 0.05,
            progress: Optional[Progress] = None) -> Compared:
    """Machines, poses, records and identified modes side by side, the first with each other one.

    things: Machine and Record objects, results of identify() and frf(), or files (machine.toml@low, modes.json,
    run.h5); a machine that is no file is called by the path of a temporary one. overrides: for every machine file; of
    one machine alone: it is compared with the changed one. poses: of one machine alone, two or more. model: rigid,
    guide or full; default: that of the first machine. level: of all tests of one comparison together.

    Result: things, descriptions, test; to_records(): a row per pair of modes with mac, differences (second less
    first), p and verdicts (significant, not_significant, calculated, cannot_say); the rest in to_dict().
    frequency_hz and frequency_difference_hz [Hz], mac, p and damping as shares. Raises InputError for things that
    cannot be compared, ComputationError where progress stops. Source: docs/howto/compare.md.
    C++: tasks::compare in hydrapod/tasks/measurement.hpp.
    """
    lines = _lines(overrides)
    machines = [thing for thing in things if isinstance(thing, Machine)]
    if model is None and machines:
        model = machines[0].model
    with tempfile.TemporaryDirectory(prefix="hydrapod-") as folder:
        given: List[Any] = []
        for number, thing in enumerate(things):
            if not isinstance(thing, Machine):
                given.append(thing)
                continue
            if model is not None and thing.model != model:
                raise ValueError(f"model: thing {number + 1} is a machine with the model {thing.model}, not "
                                 f"{model}; one model holds for all")
            path = thing.path if _is_file(thing) else os.path.join(folder, f"machine-{number + 1}.toml")
            if path != thing.path:
                thing.write(path)
            given.append(path if thing.pose == "neutral" else f"{path}@{thing.pose}")
        with files_of(given) as files, all_or_none(progress) as told:
            return _core.compare(_checks.options(
                files=files, overrides=lines, poses=_checks.words(poses, "poses"), model=model, against=against,
                level=level), told)


def diagnose(machine: Machine, measured: Measured = (), *, against: str = "auto",
             want: Optional[Quantity] = None, poses: Optional[Texts] = None, model_error: Quantity = 0.002,
             common_share: Quantity = 0.0, shape_error: Quantity = 0.05, response_error: Quantity = 0.1,
             modes_only: bool = False, damping: bool = False, threads: int = 0, progress: Optional[Progress] = None) -> Diagnosed:
    """Cause of low frequencies, its uncertainty, and the stiffness that is required.

    measured: modes, responses or records ("run.h5@high" names the pose). want: a text as --want of the command line
    has it: a largest drop ("2 %", the default; "drop <= 2 %", "x=2 %") or a lowest frequency ("5 Hz", "x=5 Hz",
    "x >= 5 Hz"); a number, or a text without a unit, is a lowest frequency in Hz, and a number below 1 needs its unit,
    "2 %" or "0.5 Hz". poses: names, or "workspace". against: the system that was
    measured: auto, mechanics, plant or system. model_error, shape_error, response_error: uncertainty of a right model's
    frequencies, shapes and responses, as shares; common_share: of the variance of model_error, what all frequencies have
    in common. modes_only: without the responses. damping: damping ratios too.

    Result: summary (sentences), finding, hypotheses (best first), bic, warnings; the rest in to_dict().
    Raises InputError for a measurement without modes and goals that cannot be. A diagnosis that progress stopped
    says so in its summary, or raises ComputationError. Source: docs/theory/diagnosis.md.
    C++: tasks::diagnose in hydrapod/tasks/measurement.hpp.
    """
    with files_of(measured) as files, all_or_none(progress, parts=True) as told:
        return _core.diagnose(_core_of(machine), _checks.options(
            measured=files, want=want, against=against,
            poses=poses if poses is None or isinstance(poses, str) and poses == "workspace" else
            _checks.words(poses, "poses"), model_error=model_error, common_share=common_share,
            shape_error=shape_error, response_error=response_error, modes_only=modes_only, damping=damping,
            threads=threads), told)


def _refuse_idle(has: bool, what: str, **given: Any) -> None:
    """Options that have no meaning without others."""
    for name, value in given.items():
        if value is not None and not has:
            raise ValueError(f"{name}: belongs to {what}; give {what} too, or leave {name} out")


def _list(given: Any, name: str) -> List[Any]:
    if isinstance(given, str) or not hasattr(given, "__iter__"):
        raise TypeError(f"{name}: expected a list, got {_checks.shown(given)}")
    return list(given)


def report(machine: Machine, path: Optional[Path] = None, *, poses: Texts = (), title: str = "",
           theme: str = "auto", modes: Sequence[int] = (), points: int = 600,
           commands: Optional[Texts] = None, until: Optional[Quantity] = None, samples: int = 1500,
           measured: Optional[Measured] = None, from_: Optional[Quantity] = None, to: Optional[Quantity] = None,
           input_from: Optional[str] = None, against: str = "auto", diagnose: Optional[Measured] = None,
           want: Optional[Quantity] = None, compare: Union[Path, Compared, None] = None,
           progress: Optional[Progress] = None) -> Report:
    """One HTML page with moving modes, Bode diagrams and all numbers.

    path: file to write. title: of the page; default: the name of the machine. theme: auto, light or dark. points: of
    the responses. poses: names or displacements. modes: those shown in print, from 1. commands: also simulate, until
    that time [s]; samples: of each quantity of that run. measured: also identify this record, with from_, to,
    input_from and against of identify(). diagnose: also diagnose from this, with want of diagnose(). compare: also
    show this comparison, a Compared or the JSON of `hydrapod compare`. In a notebook the result shows the page in a
    frame. Result: html, write(path), to_dict(). Raises InputError for what cannot be read or written,
    ComputationError where progress stops. Source: docs/howto/report.md. C++: tasks::report_document in
    hydrapod/tasks/measurement.hpp.
    """
    _refuse_idle(commands is not None, "commands", until=until)
    _refuse_idle(measured is not None, "measured", from_=from_, to=to, input_from=input_from)
    _refuse_idle(diagnose is not None, "diagnose", want=want)
    _refuse_idle(measured is not None or diagnose is not None, "measured or diagnose",
                 against=None if against == "auto" else against)
    shown = [_checks.whole(mode, "modes") for mode in _list(modes, "modes")]
    with files_of(() if measured is None else measured) as records, \
            files_of(() if diagnose is None else diagnose) as causes, \
            files_of(() if compare is None else compare) as comparison, all_or_none(progress) as told:
        target = _checks.output_or_none(path, "path", _core_of(machine).path, *records, *causes, *comparison)
        result = _core.report(_core_of(machine), {"modes": shown, **_checks.options(
            poses=_checks.words(poses, "poses"), title=title, theme=theme, points=points,
            commands=None if commands is None else _checks.words(commands, "commands"), until=until, samples=samples,
            comparison=_only(comparison, "compare") if comparison else None,
            identification=_checks.options(**{"files": records, "from": from_, "to": to, "input_from": input_from,
                                              "against": against}) if records else None,
            diagnosis=_checks.options(measured=causes, want=want, against=against) if causes else None)}, told)
    if target is not None:
        result.write(target)
    return result
