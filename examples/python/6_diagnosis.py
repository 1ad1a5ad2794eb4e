# %% [markdown]
# # Diagnosis
# Measured frequencies are lower than calculated ones. Which part is the cause?

# %%
import pathlib
import tempfile

import hydrapod

root = pathlib.Path(__file__).resolve().parents[2]
machine = hydrapod.read_machine(root / "models" / "heavy-platform.toml")
nominal = machine.with_({"legs.guide_sleeve.stiffness": "20 kN/mm"})  # as the maker states the seals
path = pathlib.Path(tempfile.mkdtemp()) / "measured.csv"

# %% [markdown]
# The "measurement" is of the machine with soft seals, rounded to 0.01 Hz. Each mode has its direction.

# %%
measured = hydrapod.modes(machine)
rows = [f"neutral,{label.split(',')[0]},{frequency:.2f} Hz"
        for label, frequency in zip(measured.labels[:6], measured.frequency_hz)]
path.write_text("pose,direction,frequency\n" + "\n".join(rows) + "\n")
diagnosed = hydrapod.diagnose(nominal, path, model_error="0.3 %")
print("\n".join(diagnosed.summary[:6]))

# %% [markdown]
# Every hypothesis is fitted and ranked by its BIC.

# %%
figure = hydrapod.plot_diagnosis(diagnosed)
print("\n".join(diagnosed.hypotheses[:3]))
assert diagnosed.finding == "cause identified" and "guide sleeve" in diagnosed.hypotheses[0]

# %% [markdown]
# What the machine would have to be like: the stiffness of the seals for a drop of at most 2 % in x.

# %%
remedy = hydrapod.diagnose(machine, want="x=2 %")
print(remedy.summary[-1])
