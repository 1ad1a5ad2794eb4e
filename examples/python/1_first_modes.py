# %% [markdown]
# # First modes
# A machine is read from its file. A result shows itself as a table, and its columns are NumPy arrays.

# %%
import pathlib

import numpy as np

import hydrapod

root = pathlib.Path(__file__).resolve().parents[2]  # of the repository
machine = hydrapod.read_machine(root / "models" / "heavy-platform.toml")
modes = hydrapod.modes(machine)
print(modes.answer)
print(modes.frequency_hz[:6].round(3))

# %% [markdown]
# The matrices are arrays too, with the platform's six coordinates first: M ÿ + C ẏ + K y = F. The moduli of the
# eigenvalues of this system are the frequencies above.

# %%
poles = np.linalg.eigvals(hydrapod.state_space(modes).A)
moduli = np.sort(np.abs(poles[poles.imag > 0])) / (2 * np.pi)
print(moduli[:6].round(3))
assert np.allclose(moduli[:6], modes.frequency_hz[:6], rtol=1e-5)

# %% [markdown]
# At several poses, modes are followed by their shape from pose to pose.

# %%
followed = hydrapod.modes_at_poses(machine, ["neutral", "z=-40 mm", "z=-80 mm"])
print(followed)

# %% [markdown]
# The blue dots are modes with flexible legs, the triangles those of the rigid-leg model.

# %%
figure = hydrapod.plot_modes(modes)
