# %% [markdown]
# # Calibrate from a table
# Measured frequencies stand in a table. The stiffness of the seals is fitted to them.

# %%
import pathlib
import tempfile

import hydrapod

root = pathlib.Path(__file__).resolve().parents[2]
machine = hydrapod.read_machine(root / "models" / "heavy-platform.toml")
sleeve = "legs.guide_sleeve.stiffness"
folder = pathlib.Path(tempfile.mkdtemp())

# %% [markdown]
# Here the table is computed from a machine with seals of 1.35 kN/mm, and rounded as a person would write it.

# %%
truth = hydrapod.modes(machine.with_({sleeve: "1.35 kN/mm"}))
table = folder / "measured.csv"
rows = [f"neutral,{frequency:.3f} Hz,0.005 Hz" for frequency in truth.frequency_hz[:6]]
table.write_text("pose,frequency,deviation\n" + "\n".join(rows) + "\n")
print(table.read_text())

# %%
fitted = hydrapod.calibrate(machine, table, {sleeve: ("0.2 kN/mm", "20 kN/mm")}, starts=4)
print(fitted)
assert abs(fitted.values[0] / 1.35e6 - 1) < 0.01 and fitted.verdicts == ["determined"]

# %% [markdown]
# The calibrated machine file keeps its comments. It is a machine like any other.

# %%
calibrated = hydrapod.Machine(fitted.text)
print(hydrapod.modes(calibrated).frequency_hz[:6].round(3))
print(truth.frequency_hz[:6].round(3))
