# %% [markdown]
# # Monte Carlo
# The stiffness of the seals scatters from leg to leg. How probable is it that the lowest mode is below 4 Hz?

# %%
import pathlib

import numpy as np

import hydrapod

root = pathlib.Path(__file__).resolve().parents[2]
machine = hydrapod.read_machine(root / "models" / "heavy-platform.toml")
study = hydrapod.montecarlo(
    machine, {"legs.guide_sleeve.stiffness": "lognormal ± 1 % per leg", "platform.mass": "uniform ± 0.5 %"},
    want=["lowest >= 4 Hz"], samples=4000, seed=11)
low, high = study.probability_interval[0]
print(f"probability of missing '{study.requirements[0]}': {study.probability_of_missing[0]:.3f} "
      f"({low:.3f} … {high:.3f})")

# %% [markdown]
# Columns are arrays. A sample without a frequency is NaN, and `status` says why.

# %%
lowest = study["lowest"]
print(f"5 %: {np.nanquantile(lowest, 0.05):.3f} Hz, median: {np.nanmedian(lowest):.3f} Hz, "
      f"{np.isnan(lowest).sum()} without a value")
worst = study.machine(int(study.worst_rows[0]))
print(f"worst sample: {hydrapod.modes(worst).frequency_hz[0]:.3f} Hz, platform {worst.platform.mass:.0f} kg")
assert np.nanmin(lowest) == lowest[study.worst_rows[0]]

# %% [markdown]
# The lowest mode over the workspace.

# %%
field = hydrapod.workspace_map(machine, {"x": "-150:150:25 mm", "z": "-150:50:25 mm"})
figure = hydrapod.plot_map(field)
