"""hydrapod: dynamics of hydraulic hexapods (flight simulators, motion platforms, shake tables).

    import hydrapod
    machine = hydrapod.read_machine("machine.toml")
    hydrapod.modes(machine)                                    # table of modes; in notebooks too
    stiffer = machine.with_(**{"legs.guide_sleeve.stiffness": "20 kN/mm"})
    hydrapod.modes(stiffer).frequency_hz                       # NumPy array [Hz]

Numbers are in SI and radians; a quantity may also be a text with a unit ("2 kN/mm", "5 deg"). Results have
arrays as attributes; `.to_dict()` and `.json` are what the command line prints with --format json, but for
`reproduction`. Arrays of results are read-only views. Mistakes raise InputError, computations that cannot
give a result ComputationError. Long tasks take `progress`, a callable that gets the share done (0 to 1); when
it returns True the task stops. Ctrl-C stops them too. Tasks run without the interpreter lock (GIL).
"""

from ._core import (
    Bode,
    Calibrated,
    Check,
    CommandResponse,
    Diagnosed,
    Frf,
    Identified,
    Modes,
    Report,
    RootLocus,
    Sensitivity,
    Simulation,
    System,
)
from ._core import version as __version__
from ._errors import ComputationError, Diagnostic, InputError
from ._interop import state_space, to_control
from ._machine import Machine, Parameters, read_machine, starter_machine_file
from ._records import Record, read_record
from ._tasks import (
    LinearPlant,
    Plant,
    RigRun,
    bode,
    calibrate,
    check,
    diagnose,
    frequencies,
    frf,
    identify,
    modes,
    report,
    rig,
    root_locus,
    sensitivity,
    simulate,
    system,
)

__all__ = [
    "Bode",
    "Calibrated",
    "Check",
    "CommandResponse",
    "ComputationError",
    "Diagnosed",
    "Diagnostic",
    "Frf",
    "Identified",
    "InputError",
    "LinearPlant",
    "Machine",
    "Modes",
    "Parameters",
    "Plant",
    "Record",
    "Report",
    "RigRun",
    "RootLocus",
    "Sensitivity",
    "Simulation",
    "System",
    "bode",
    "calibrate",
    "check",
    "diagnose",
    "frequencies",
    "frf",
    "identify",
    "modes",
    "read_machine",
    "read_record",
    "report",
    "rig",
    "root_locus",
    "sensitivity",
    "simulate",
    "starter_machine_file",
    "state_space",
    "system",
    "to_control",
]
