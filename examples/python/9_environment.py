# %% [markdown]
# # An environment for reinforcement learning
# The class has the methods of Gymnasium's environments, `reset` and `step`, and needs no other package. With
# Gymnasium installed it may derive from `gymnasium.Env`, with two `Box` spaces.

# %%
import pathlib
from typing import Any, Dict, Optional, Tuple

import numpy as np

import hydrapod

root = pathlib.Path(__file__).resolve().parents[2]
machine = hydrapod.read_machine(root / "models" / "heavy-platform.toml")


class HoldStill:
    """Hold the platform at rest under random pushes; an action is six valve commands beside those of rest.

    Observation: displacement [mm, mrad] and twist [mm/s, mrad/s] of the platform, (12,). Reward: minus the squared
    displacement, and a little for the commands.
    """

    def __init__(self, machine: hydrapod.Machine, *, dt: float = 1e-3, steps: int = 500, push: float = 2000.0):
        self.plant = hydrapod.Plant(machine, fixed_step="0.5 ms")
        self.dt, self.steps, self.push = dt, steps, push
        self.at_rest = self.plant.outputs()["length"]

    def _observation(self) -> Any:
        out = self.plant.outputs()
        return 1e3 * np.concatenate([out["displacement"], out["twist"]])

    def reset(self, *, seed: Optional[int] = None) -> Tuple[Any, Dict[str, Any]]:
        if seed is not None or not hasattr(self, "rng"):
            self.rng = np.random.default_rng(seed)
        self.plant.reset()
        self.taken = 0
        self.wrench = np.concatenate([self.rng.normal(0.0, self.push, 3), np.zeros(3)])
        return self._observation(), {}

    def step(self, action: Any) -> Tuple[Any, float, bool, bool, Dict[str, Any]]:
        command = np.clip(np.asarray(action, dtype=float), -1.0, 1.0)
        self.taken += 1
        try:
            displacement = self.plant.step(self.plant.rest_commands + command, self.dt, wrench=self.wrench)
        except hydrapod.ComputationError as error:  # a piston leaves its guide
            return self._observation(), -1e3, True, False, {"message": str(error)}
        reward = -float(np.sum((1e3 * displacement) ** 2)) - 1e-3 * float(np.sum(command**2))
        return self._observation(), reward, False, self.taken >= self.steps, {}


# %% [markdown]
# A policy that does nothing, and one that opens the valves against the change of each leg's length.

# %%
def reward_of(environment: HoldStill, gain: float) -> float:
    observation, _ = environment.reset(seed=4)
    jacobian = hydrapod.leg_jacobian(machine)
    total, over = 0.0, False
    while not over:
        lengths = jacobian @ (1e-3 * observation[:6])  # to first order
        observation, reward, terminated, truncated, _ = environment.step(-gain * lengths)
        total += reward
        over = terminated or truncated
    return total


environment = HoldStill(machine)
idle, held = reward_of(environment, 0.0), reward_of(environment, 8.0)
print(f"sum of rewards: {idle:.1f} without, {held:.1f} with control")
assert held > idle
