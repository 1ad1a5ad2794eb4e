# %% [markdown]
# # Why x and y are low
# The seals of the guide sleeves hold the piston rods. Soft seals lower the lowest frequencies.

# %%
import pathlib

import numpy as np

import hydrapod

root = pathlib.Path(__file__).resolve().parents[2]
machine = hydrapod.read_machine(root / "models" / "heavy-platform.toml")
sleeve = "legs.guide_sleeve.stiffness"
soft = hydrapod.modes(machine)
stiff = hydrapod.modes(machine.with_({sleeve: "20 kN/mm"}))
frequencies = soft.frequency_hz[0], stiff.frequency_hz[0], soft.rigid.frequency_hz[0]
print("soft seals {:.2f} Hz, stiff seals {:.2f} Hz, rigid legs {:.2f} Hz".format(*frequencies))
assert frequencies[0] < 0.8 * frequencies[2] and abs(frequencies[1] / frequencies[2] - 1) < 0.01

# %% [markdown]
# The response to a force in x has two peaks where the rigid-leg model has one.

# %%
bode = hydrapod.bode(machine, from_=1.0, to=30.0, points=1500)
figure = hydrapod.plot_bode(bode, [("x", "x"), ("z", "z"), ("ry", "x")])

# %% [markdown]
# How the lowest mode depends on the stiffness of the seals. The direct computation of many designs is one call.

# %%
stiffness = np.geomspace(0.5e6, 50e6, 60)
study = hydrapod.sweep(machine, {sleeve: stiffness})
lowest = hydrapod.frequencies(machine, {sleeve: stiffness})[:, 0]
held = study["status"] == 0
print(f"{held.sum()} of {len(study)} designs stand")
assert np.allclose(lowest[held], study["lowest"][held], rtol=1e-9)
figure = hydrapod.plot_map(study)

# %% [markdown]
# Which numbers of the machine file matter: the change of the lowest frequency in per cent per per cent.

# %%
sensitivity = hydrapod.sensitivity(machine)
order = np.argsort(-np.abs(np.nan_to_num(sensitivity.percent_per_percent[0])))[:5]
for k in order:
    print(f"{sensitivity.parameters[k]:32s} {sensitivity.percent_per_percent[0, k]:+.3f}")
