# %% [markdown]
# # From the virtual rig to modes
# The simulated test rig excites the machine, and the modes are identified from the record, as from a measurement.

# %%
import pathlib
import tempfile

import hydrapod

root = pathlib.Path(__file__).resolve().parents[2]
machine = hydrapod.read_machine(root / "models" / "zhang-jiang-2021.toml")
path = pathlib.Path(tempfile.mkdtemp()) / "run.h5"
run = hydrapod.rig(machine, path, excite="white all=0.2 mm", duration="30 s", seed=3)
print(run.samples, "samples;", "finished" if run.finished else run.message)

# %%
record = hydrapod.read_record(path)
print(record)
print(record.channels[:8])

# %%
identified = hydrapod.identify(path)
print(identified)

# %% [markdown]
# The fit of the modes to the measured responses, and the poles over the model order.

# %%
figure = hydrapod.plot_fit(identified)

# %%
figure = hydrapod.plot_stabilisation(identified)

# %% [markdown]
# The machine that was simulated has these modes; the half intervals are 1.96 standard deviations.

# %%
calculated = hydrapod.modes(machine).frequency_hz
for frequency, deviation in zip(identified.frequency_hz, identified.frequency_deviation_hz):
    nearest = calculated[abs(calculated - frequency).argmin()]
    print(f"identified {frequency:7.3f} ± {1.96 * deviation:.3f} Hz, mechanics {nearest:7.3f} Hz")
    assert abs(frequency / nearest - 1) < 0.02
