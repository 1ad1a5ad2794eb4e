# %% [markdown]
# # A controller in the loop from Python
# The plant is stepped with valve commands. A proportional controller in leg space holds the platform against a
# constant force of 3 kN.

# %%
import pathlib

import numpy as np

import hydrapod

root = pathlib.Path(__file__).resolve().parents[2]
machine = hydrapod.read_machine(root / "models" / "heavy-platform.toml")


def moved_after(seconds: float, gain: float) -> float:
    """Largest displacement at the end [m, rad]; gain: share of full drive per metre of leg."""
    plant = hydrapod.Plant(machine, fixed_step="0.5 ms")
    at_rest = plant.outputs()["length"]
    push = np.array([0.0, 0.0, -3000.0, 0.0, 0.0, 0.0])
    displacement = np.zeros(6)
    for _ in range(round(seconds / 1e-3)):
        error = at_rest - plant.outputs()["length"]
        displacement = plant.step(plant.rest_commands + gain * error, 1e-3, wrench=push)
    return float(np.abs(displacement).max())


free, held = moved_after(1.0, 0.0), moved_after(1.0, 8.0)
print(f"displacement after 1 s: {1e3 * free:.3f} mm without, {1e3 * held:.3f} mm with the controller")
assert held < free

# %% [markdown]
# The linearised plant for the design of a controller: A, B, C, D as scipy.signal.StateSpace.

# %%
plant = hydrapod.Plant(machine)
linear = plant.linearise()
system = hydrapod.state_space(linear)
print(system.A.shape, system.B.shape, linear.outputs[:6])

# %% [markdown]
# Many plants at once, each in one thread: 8 machines with other masses under the same commands.

# %%
plants = [hydrapod.Plant(machine.with_({"platform.mass": 12000.0 + 500.0 * k}), fixed_step="0.5 ms")
          for k in range(8)]
steps = np.arange(300)
commands = 0.05 * np.sin(2 * np.pi * 4.0 * 1e-3 * steps)[:, None] * np.array([1, -1, 1, -1, 1, -1])
motions, messages = hydrapod.Plant.run_many(plants, commands, 1e-3)
print(motions.shape, "largest rotation about z of each, mrad:", (1e3 * np.abs(motions[:, :, 5]).max(axis=1)).round(2))
assert not any(messages)
