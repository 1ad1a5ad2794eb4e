# %% [markdown]
# # A controller written in Python
# The plant is stepped with valve commands; a proportional controller in leg space holds the platform against
# a constant force of 3 kN.

# %%
import pathlib

import numpy as np

import hydrapod

root = pathlib.Path(__file__).resolve().parents[2]
machine = hydrapod.read_machine(root / "models" / "heavy-platform.toml")


def moved_after(seconds: float, gain: float) -> float:
    """Largest displacement at the end [m, rad]; gain: share of full drive per metre of leg."""
    plant = hydrapod.Plant(machine, fixed_step="0.2 ms")
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
