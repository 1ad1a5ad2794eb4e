# %% [markdown]
# # Own data from CSV
# A record is a table with a column of time and a column per channel. Titles have units.

# %%
import pathlib
import tempfile

import numpy as np

import hydrapod

folder = pathlib.Path(tempfile.mkdtemp())
rate, seconds = 200.0, 120.0
time = np.arange(int(rate * seconds)) / rate
rng = np.random.default_rng(8)

# %% [markdown]
# The data are those of one mass of 250 kg on a spring, 5 Hz with 3 % damping, driven by a random force. The exact
# response to held forces comes from SciPy; noise of 1 % is added to the acceleration.

# %%
from scipy.signal import cont2discrete, dlsim  # noqa: E402

mass, omega, zeta = 250.0, 2 * np.pi * 5.0, 0.03
A = np.array([[0.0, 1.0], [-omega**2, -2 * zeta * omega]])
system = cont2discrete((A, np.array([[0.0], [1 / mass]]), A[1:], np.array([[1 / mass]])), 1 / rate)
force = 400.0 * rng.standard_normal(len(time))
acceleration = dlsim((*system[:4], 1 / rate), force)[1][:, 0]
acceleration += 0.01 * acceleration.std() * rng.standard_normal(len(time))
path = folder / "own.csv"
np.savetxt(path, np.column_stack([time, force, acceleration]), delimiter=",", comments="", fmt="%.9g",
           header="time [s],force [N],a1 [m/s^2]")

# %%
record = hydrapod.read_record(path)
print(record, record.units)

# %% [markdown]
# Which channel is the excitation is said once. The record may also be made from arrays, without a file.

# %%
identified = hydrapod.identify(path, inputs="force", outputs="a1", from_=2.0, to=12.0)
print(f"{identified.frequency_hz[0]:.4f} ± {1.96 * identified.frequency_deviation_hz[0]:.4f} Hz, "
      f"{100 * identified.damping_ratio[0]:.2f} ± {196 * identified.damping_deviation[0]:.2f} %")
own = hydrapod.Record(np.column_stack([force, acceleration]), rate, ["force", "a1"], units=["N", "m/s^2"],
                      roles=["excitation", "response"])
same = hydrapod.identify(own, from_=2.0, to=12.0)
print(f"from arrays: {same.frequency_hz[0]:.4f} Hz")
assert abs(identified.frequency_hz[0] - 5.0) < 4 * identified.frequency_deviation_hz[0]

# %%
responses = hydrapod.frf(path, inputs="force", outputs="a1")
print(responses.H.shape, "lines × outputs × inputs; highest coherence",
      f"{np.nanmax(responses.coherence):.3f}")
figure = hydrapod.plot_fit(identified)
