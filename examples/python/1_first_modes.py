# %% [markdown]
# # First modes, and why x and y are low
# The seals of the guide sleeves hold the piston rods. Soft seals lower the lowest frequencies.

# %%
import pathlib

import hydrapod

root = pathlib.Path(__file__).resolve().parents[2]
machine = hydrapod.read_machine(root / "models" / "heavy-platform.toml")
modes = hydrapod.modes(machine)
print(modes)

# %% [markdown]
# The same with seals of 20 kN/mm: the frequency of the rigid-leg model comes back.

# %%
stiff = hydrapod.modes(machine.with_(**{"legs.guide_sleeve.stiffness": "20 kN/mm"}))
soft_hz, stiff_hz, rigid_hz = (m.frequency_hz[0] for m in (modes, stiff, modes.rigid))
print(f"soft seals {soft_hz:.2f} Hz, stiff seals {stiff_hz:.2f} Hz, rigid legs {rigid_hz:.2f} Hz")
assert soft_hz < 0.8 * rigid_hz and abs(stiff_hz / rigid_hz - 1) < 0.01
