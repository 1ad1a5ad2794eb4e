"""hydrapod: dynamics of hydraulic hexapods (flight simulators, motion platforms, shake tables).

    import hydrapod
    machine = hydrapod.read_machine("machine.toml")
    hydrapod.modes(machine)                                    # table of modes; in notebooks too
    stiffer = machine.with_(**{"legs.guide_sleeve.stiffness": "20 kN/mm"})
    hydrapod.modes(stiffer).frequency_hz                       # NumPy array [Hz]

Numbers are in SI and radians; a quantity may also be a text with a unit ("2 kN/mm", "5 deg"). Results have
arrays as attributes; `.to_dict()` and `.json` are what the command line prints with --format json, but for
`reproduction`. Arrays of results are read-only views, or copies. Mistakes raise InputError, computations that cannot
give a result ComputationError. Long tasks take `progress`, a callable that gets the share done (0 to 1); when
it returns True the task stops; progress_bar() is one. Ctrl-C stops them too. Tasks run without the interpreter
lock (GIL).
"""

from ._core import (
    Bode,
    Calibrated,
    Check,
    CommandResponse,
    Compared,
    Design,
    Diagnosed,
    Frf,
    Identified,
    MachineStateSpace,
    ModelModes,
    Modes,
    ModesAtAmplitudes,
    ModesAtPoses,
    Report,
    RootLocus,
    Sensitivity,
    Simulation,
    Study,
    Superelement,
    System,
)
from ._core import version as __version__
from ._errors import ComputationError, Diagnostic, InputError
from ._exports import (
    Export,
    MultibodyText,
    ParityLine,
    export,
    machine_state_space,
    multibody_text,
    superelement,
    to_mujoco,
)
from ._interop import state_space, to_control, to_pyuff
from ._machine import Machine, Parameters, build_machine, read_machine, starter_machine_file
from ._mechanics import (
    Buckling,
    PoseQuality,
    SampledSignals,
    StaticEquilibrium,
    buckling,
    forward_kinematics,
    leg_jacobian,
    leg_lengths,
    modes_at_amplitudes,
    pose_quality,
    sample_signals,
    static_equilibrium,
)
from ._plant import LinearPlant, Plant
from ._plots import (
    plot_bode,
    plot_diagnosis,
    plot_fit,
    plot_map,
    plot_modes,
    plot_stabilisation,
)
from ._progress import ProgressBar, progress_bar
from ._records import Record, read_record
from ._studies import DesignFunction, design, montecarlo, sweep, workspace_map
from . import _texts
from ._tasks import (
    RigRun,
    bode,
    calibrate,
    check,
    compare,
    diagnose,
    frequencies,
    frf,
    identify,
    modes,
    modes_at_poses,
    report,
    rig,
    root_locus,
    sensitivity,
    simulate,
    system,
)

__all__ = [
    "Bode",
    "Buckling",
    "Calibrated",
    "Check",
    "CommandResponse",
    "Compared",
    "ComputationError",
    "Design",
    "DesignFunction",
    "Diagnosed",
    "Diagnostic",
    "Export",
    "Frf",
    "Identified",
    "InputError",
    "LinearPlant",
    "Machine",
    "MachineStateSpace",
    "ModelModes",
    "Modes",
    "ModesAtAmplitudes",
    "ModesAtPoses",
    "MultibodyText",
    "Parameters",
    "ParityLine",
    "Plant",
    "PoseQuality",
    "ProgressBar",
    "Record",
    "Report",
    "RigRun",
    "RootLocus",
    "SampledSignals",
    "Sensitivity",
    "Simulation",
    "StaticEquilibrium",
    "Study",
    "Superelement",
    "System",
    "bode",
    "buckling",
    "build_machine",
    "calibrate",
    "check",
    "compare",
    "design",
    "diagnose",
    "export",
    "forward_kinematics",
    "frequencies",
    "frf",
    "identify",
    "leg_jacobian",
    "leg_lengths",
    "machine_state_space",
    "modes",
    "modes_at_amplitudes",
    "modes_at_poses",
    "montecarlo",
    "multibody_text",
    "plot_bode",
    "plot_diagnosis",
    "plot_fit",
    "plot_map",
    "plot_modes",
    "plot_stabilisation",
    "pose_quality",
    "progress_bar",
    "read_machine",
    "read_record",
    "report",
    "rig",
    "root_locus",
    "sample_signals",
    "sensitivity",
    "simulate",
    "starter_machine_file",
    "state_space",
    "static_equilibrium",
    "superelement",
    "sweep",
    "system",
    "to_control",
    "to_mujoco",
    "to_pyuff",
    "workspace_map",
]
