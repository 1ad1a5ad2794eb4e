"""The test rig, simulated or real, and the virtual machine in real time."""

from __future__ import annotations

from typing import Any, Callable, Dict, List, Mapping, NamedTuple, Optional, Sequence, Union

from . import _checks, _core
from ._checks import Texts
from ._core import Served
from ._machine import Machine, Quantity
from ._records import Path
from ._tasks import Progress, _core_of


def _address(given: Union[int, str], name: str) -> str:
    """A port, or a text with one."""
    if isinstance(given, str):
        return _checks.word(given, name)
    return str(_checks.whole(given, name, 0, 65535))


def _accelerometers(given: Optional[Sequence[str]]) -> Dict[str, Any]:
    """Their texts as an option; without it the default ones."""
    return {} if given is None else {"accelerometers": _checks.words(given, "accelerometers")}


def serve(machine: Machine, address: Union[int, str] = 4747, *, bind: Optional[str] = None,
          shared_memory: Optional[str] = None, key: Optional[Path] = None, layout: Optional[Path] = None,
          lock_step: bool = False, once: bool = False, hold: Optional[Quantity] = None,
          ramp: Optional[Quantity] = None, patience: Optional[Quantity] = None, rest: Optional[str] = None,
          duration: Optional[Quantity] = None, fifo: Optional[int] = None,
          busy: Optional[Quantity] = None, accelerometers: Optional[List[str]] = None,
          integrator: str = "exponential", step: Quantity = 2e-4, tolerance: float = 1e-6, seed: int = 1,
          ideal_sensors: bool = False, record: Optional[Path] = None, ready: Optional[Callable[[str], Any]] = None,
          progress: Optional[Progress] = None) -> Served:
    """The machine in real time: commands in, sensors out, by UDP or shared memory.

    address: port or "ADDRESS:PORT" of the loopback; 0: any that is free. bind: another address of the computer to
    listen at; needs key, a file with 16 or more secret bytes. shared_memory: a name, in place of UDP. layout: file
    that describes the packets; default: packet_layout(). lock_step: the client's clock, one answer for every command.
    once: ends when the first client has gone. hold: how long the last command is held [s], 0.1. ramp: of the ramp
    down to rest [s], 1. rest: a displacement from the pose, "z=-20 mm". patience: for a client in lock-step [s], 10.
    duration: of the machine [s]; default: until progress stops it, or Ctrl-C. fifo: real-time priority, 1 to 99.
    busy: on the wall clock, how long to wait without sleeping before each sample [s], 0. accelerometers: texts as of
    `hydrapod rig --help`, [] for none. integrator, step [s], tolerance, seed, ideal_sensors: as of simulate().
    record: file to write. ready: called with the place ("127.0.0.1:4747") when clients can come. Other threads of
    Python that compute delay `ready` and `progress` alone, and so the sample in which they are called; a server for
    hardware is a process of its own.

    Result, a Served: place, samples, time [s], sample_time [s], state, finished, message, record, deadline_misses,
    warnings; counters of packets and times of steps in .to_dict().
    Raises InputError for addresses, layouts and keys that cannot be used, ComputationError where the machine cannot be
    held at its pose. Source: docs/howto/realtime.md. C++: tasks::serve in hydrapod/tasks/simulation.hpp.
    """
    if ready is not None and not callable(ready):
        raise TypeError(f"ready: expected a callable that gets the place, got {ready!r}")
    return _core.serve(_core_of(machine), {**_accelerometers(accelerometers), **_checks.options(
        address=_address(address, "address"), bind=bind, shared_memory=shared_memory,
        key=_checks.path_or_none(key, "key"), layout=_checks.path_or_none(layout, "layout"), lock_step=lock_step,
        once=once, hold=hold, ramp=ramp, patience=patience, rest=rest,
        duration=duration, fifo=fifo, busy=busy,
        integrator=integrator, step=step, tolerance=tolerance, seed=seed, ideal_sensors=ideal_sensors,
        record=_checks.output_or_none(record, "record", _core_of(machine).path))}, ready, progress)


def packet_layout(machine: Machine, *, accelerometers: Optional[List[str]] = None) -> str:
    """What stands where in the packets of serve(), byte by byte: the text of a layout file, with comments.

    accelerometers: as of serve(). The same as `hydrapod serve --print-layout`. Raises InputError for accelerometers
    that cannot be. Source: docs/howto/realtime.md.
    """
    return _core.packet_layout(_core_of(machine), _accelerometers(accelerometers))


class RigRun(NamedTuple):
    """A run of the test rig."""

    record: str  #: the file
    samples: int
    findings: List[str]  #: levels that do not fit
    finished: bool
    message: str
    hardware: Optional[Dict[str, Any]] = None  #: of a real machine: packets received, lost, late, …; scheduling


def _limits(given: Union[Mapping[str, Quantity], str, None]) -> Optional[str]:
    """As --limit has them."""
    if given is None or isinstance(given, str):
        return given
    if not isinstance(given, Mapping):
        raise TypeError(f"limits: expected a dict such as {{\"length\": \"20 mm\"}} or a text, got {given!r}")
    return ", ".join(f"{key}={value if isinstance(value, str) else repr(_checks.number(value, f'limits of {key}'))}"
                     for key, value in given.items())


def _one_kind_of_rig(is_hardware: bool, **given: Any) -> None:
    """Options of the other kind of rig are mistakes."""
    why = "belongs to the simulated rig: a machine has its own" if is_hardware else \
        "belongs to a rig on a real machine; give hardware or shared_memory"
    for name, value in given.items():
        if value is not None:
            raise ValueError(f"{name}: {why}")


def rig(machine: Machine, record: Optional[Path] = None, *, excite: Texts = (), entry: str = "command",
        duration: Optional[Quantity] = None, averages: int = 0, settling: Optional[Quantity] = None,
        rate: Optional[Quantity] = None, oversampling: int = 2, seed: int = 1, repeat: int = 1,
        accelerometers: Optional[Sequence[str]] = None, length_sensor: Optional[str] = None,
        pressure_sensor: Optional[str] = None, current_sensor: Optional[str] = None,
        torque_sensor: Optional[str] = None, speed_sensor: Optional[str] = None,
        drop_outs: Optional[Quantity] = None, anti_alias: bool = True, above_limits: bool = False,
        hardware: Union[int, str, None] = None, shared_memory: Optional[str] = None, layout: Optional[Path] = None,
        key: Optional[Path] = None, limits: Union[Mapping[str, Quantity], str, None] = None,
        ramp: Optional[Quantity] = None, ramp_down: Optional[Quantity] = None, watchdog: Optional[Quantity] = None,
        fifo: Optional[int] = None, progress: Optional[Progress] = None) -> RigRun:
    """Test rig, simulated or real: excites the machine in six directions and writes a record.

    record: file to write; None: only the levels are checked. excite: signals ("white all=0.1 mm"), default
    white noise. entry: command, drive or wrench. duration: of the record [s]. averages: periods of a periodic
    excitation, in place of duration. settling: before the record begins [s]. rate: samples per second [Hz].
    oversampling: simulated samples per sample of the record. repeat: number of this repetition, for the record.
    accelerometers: "name, at=X Y Z, along=x, noise=0.001, bandwidth=5 kHz, range=50", [] for none; default: three axes
    at the joints of legs 1, 3, 5. length_sensor, pressure_sensor, current_sensor, torque_sensor, speed_sensor:
    "resolution=5 um, noise=2 um, low=0.8 m, high=1.2 m". drop_outs: of 20 ms, per second and channel. anti_alias: the
    filter before sampling. above_limits: runs although the levels do not fit.
    hardware: [ADDRESS:]PORT of a real machine behind its controller, in place of the simulated one; shared_memory: the
    same by a name. layout, key: as of serve(). limits: {"length": "50 mm", "velocity": "0.5 m/s", "acceleration":
    "20 m/s^2", "error": "10 mm"} of each leg, beyond which it is ramped down. ramp, ramp_down, watchdog [s]: of the
    excitation, of an emergency, without sensors.
    Result, a RigRun: record, samples, findings, finished, message and, of a real machine, hardware (packets).
    Raises InputError for levels that do not fit, and where a real machine does not answer. Source: docs/howto/rig.md.
    C++: tasks::rig in hydrapod/tasks/simulation.hpp.
    """
    is_hardware = hardware is not None or shared_memory is not None
    if hardware is not None and shared_memory is not None:
        raise ValueError("shared_memory: is in place of an address; give hardware or shared_memory")
    if is_hardware:
        _one_kind_of_rig(True, length_sensor=length_sensor, pressure_sensor=pressure_sensor,
                         current_sensor=current_sensor, torque_sensor=torque_sensor, speed_sensor=speed_sensor,
                         drop_outs=drop_outs, anti_alias=None if anti_alias else anti_alias,
                         oversampling=None if oversampling == 2 else oversampling)
    else:
        _one_kind_of_rig(False, layout=layout, key=key, limits=limits, ramp=ramp, ramp_down=ramp_down,
                         watchdog=watchdog, fifo=fifo)
    return RigRun(**_core.rig(_core_of(machine), {**_accelerometers(accelerometers), **_checks.options(
        record=_checks.output_or_none(record, "record", _core_of(machine).path), excite=_checks.words(excite, "excite"), entry=entry,
        duration=duration, averages=averages, settling=settling, rate=rate, oversampling=oversampling,
        seed=seed, repeat=repeat,
        length_sensor=length_sensor,
        pressure_sensor=pressure_sensor, current_sensor=current_sensor, torque_sensor=torque_sensor,
        speed_sensor=speed_sensor, drop_outs=drop_outs, anti_alias=anti_alias, above_limits=above_limits,
        hardware=None if hardware is None else _address(hardware, "hardware"),
        shared_memory=shared_memory, layout=_checks.path_or_none(layout, "layout"),
        key=_checks.path_or_none(key, "key"), limits=_limits(limits), ramp=ramp,
        ramp_down=ramp_down, watchdog=watchdog, fifo=fifo)}, progress))
