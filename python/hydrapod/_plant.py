"""The machine step by step, for controllers written in Python."""

from __future__ import annotations

from typing import Any, Dict, Iterable, List, NamedTuple, Optional, Tuple

import numpy as np

from . import _checks, _core
from ._machine import Machine, Quantity
from ._tasks import Progress, _core_of


class LinearPlant(NamedTuple):
    """δẋ = A δx + B δu, δy = C δx + D δu about a state; u: six valve commands, then a wrench (6)."""

    A: Any
    B: Any
    C: Any
    D: Any
    states: List[str]
    outputs: List[str]


class Plant:
    """The nonlinear machine without its controller, step by step: for controllers written in Python.

        plant = hydrapod.Plant(machine)
        for _ in range(1000):
            displacement = plant.step(commands, 1e-3)      # commands: six valves in [-1, 1]

    It starts at rest at the machine's pose. integrator: exponential (the default) or adaptive (errors below
    `tolerance`), or fixed (Runge-Kutta 4 with steps of at most `fixed_step`, equal work in every step; the default where
    fixed_step is given). hydraulics=False: legs on oil springs, no valves.
    Steps of one plant from several threads come one after the other; several plants run at once.
    """

    def __init__(self, machine: Machine, *, hydraulics: bool = True, integrator: Optional[str] = None,
                 fixed_step: Optional[Quantity] = None, tolerance: float = 1e-6):
        if integrator is None:
            integrator = "exponential" if fixed_step is None else "fixed"
        elif integrator != "fixed" and fixed_step is not None:
            raise ValueError(f"fixed_step: is for integrator=\"fixed\", not for {integrator!r}")
        step = 1e-4 if fixed_step is None else _core.quantity(fixed_step, "s", "fixed_step")
        tolerance = _checks.number(tolerance, "tolerance")
        if not 1e-7 <= step <= 1e-2:
            raise ValueError(f"fixed_step: expected 1e-7 s to 0.01 s, got {step}")
        if not 1e-13 <= tolerance <= 1e-2:
            raise ValueError(f"tolerance: expected 1e-13 to 0.01, got {tolerance}")
        self._plant = _core.Plant(_core_of(machine), _checks.flag(hydraulics, "hydraulics"),
                                  _checks.word(integrator, "integrator"), step, tolerance)
        self._machine = machine
        if type(self).step is Plant.step:
            self.__dict__["step"] = self._plant.step  # without the call between; classes that derive have their own

    def step(self, commands: Any, dt: Quantity, wrench: Any = None) -> Any:
        """One step: displacement (6,), x, y, z [m], rx, ry, rz [rad], from the machine's pose.

        commands: of the six valves, held for dt [s]; None: those of rest. wrench: force and moment about the
        mass centre (6,) [N, N m]. Raises ValueError for numbers that are not finite, ComputationError where the
        model ends (a piston leaves its guide); reset() begins again.
        """
        return self._plant.step(commands, dt, wrench)

    def run(self, commands: Any, dt: Quantity, *, progress: Optional[Progress] = None) -> Any:
        """One step of dt [s] per row of `commands` (N, 6): displacements (N, 6) [m, rad].

        progress: gets the share done; it may look at the plant (time, state, outputs()), not step or change it.
        """
        return self._plant.run(_checks.real_array(commands, "commands"), _core.quantity(dt, "s", "dt"), progress)

    @staticmethod
    def run_many(plants: Iterable["Plant"], commands: Any, dt: Quantity, *, threads: int = 0,
                 progress: Optional[Progress] = None) -> Tuple[Any, List[str]]:
        """Steps many plants at once, each in one thread: displacements (plants, N, 6), and a message for each.

        commands: (plants, N, 6), or (N, 6) for all. Where the model of a plant ends, its further rows are NaN
        and its message says why; else the message is empty. progress: see run().
        """
        cores = []
        for plant in [plants] if isinstance(plants, Plant) else plants:
            if not isinstance(plant, Plant):
                raise TypeError(f"plants: expected Plant objects, got {plant!r}")
            cores.append(plant._plant)
        array = _checks.real_array(commands, "commands")
        if array.ndim == 2:
            array = np.broadcast_to(array, (len(cores), *array.shape))
        return _core.run_plants(cores, np.ascontiguousarray(array), _core.quantity(dt, "s", "dt"),
                                _checks.threads_of(threads), progress)

    def reset(self) -> None:
        """Back to rest at time 0."""
        self._plant.reset()

    def linearise(self) -> LinearPlant:
        """About the present state and commands."""
        return LinearPlant(*self._plant.linearise())

    def outputs(self) -> Dict[str, Any]:
        """displacement, twist, acceleration, length, length_rate, pressures, spool, oil_force, …; a copy."""
        return self._plant.outputs()

    def __copy__(self) -> "Plant":
        raise TypeError("a Plant is not copied; make another one of the same machine and set its state")

    def __deepcopy__(self, memo: Any) -> "Plant":
        return self.__copy__()

    def __reduce__(self) -> Any:
        raise TypeError("a Plant cannot be pickled; pickle the machine and plant.state, and make another one of them")

    def __repr__(self) -> str:
        return f"<Plant of {self._machine.name!r}, pose {self._machine.pose}, at {self.time:.6g} s>"

    @property
    def time(self) -> float:
        """[s]"""
        return self._plant.time

    @property
    def state(self) -> Any:
        """All states (state_names, state_units); a copy. May be set."""
        return self._plant.state

    @state.setter
    def state(self, values: Any) -> None:
        self._plant.state = _checks.real_array(values, "state")

    @property
    def rest_commands(self) -> Any:
        """Of the six valves, that hold the machine at rest."""
        return self._plant.rest_commands

    @property
    def state_names(self) -> List[str]:
        """Names of the states."""
        return self._plant.state_names

    @property
    def state_units(self) -> List[str]:
        """Their units."""
        return self._plant.state_units
