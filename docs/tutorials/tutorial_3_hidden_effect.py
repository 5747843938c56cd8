"""
An effect hidden, and found
===========================

A campaign in which something happens that its simulation does not know: the specimen warms up. The
records are simulated; there is no finite-element model, so that linear modes are what is judged.
"""

import tempfile
from pathlib import Path

import bladeroot as br
import numpy as np
import pandas as pd

# %%
# Twenty-four blows within four hours, four to a clamping; every frequency rises by 0.115 % from first to last.

folder = Path(tempfile.mkdtemp()) / "warming"
folder.mkdir()
chance = np.random.default_rng(5)
rate = 8192
time = np.arange(4 * rate) / rate
rows = []
for k in range(24):
    frequency = 210.0 * (1.0 + 0.00115 * k / 23.0) * (1.0 + 2e-5 * chance.standard_normal())
    decay = np.pi * frequency * 0.004 * (1.0 + 0.01 * chance.standard_normal())
    velocity = 0.02 * np.exp(-decay * time) * np.cos(2.0 * np.pi * frequency * time + k)
    velocity += 2e-6 * chance.standard_normal(time.size)
    pd.DataFrame({"velocity": velocity}).to_csv(folder / f"blow{k}.csv", index=False)
    rows.append({"record": f"blow{k}", "file": f"blow{k}.csv", "mode": "first",
                 "clamping": f"c{k // 4}", "time_s": 600 * k, "sampling_Hz": rate,
                 "quantity": "velocity", "unit": "m/s"})  # fmt: skip
pd.DataFrame(rows).to_csv(folder / "records.csv", index=False)
_ = (folder / "campaign.yaml").write_text(
    "title: a beam that warms up (simulated)\nsimulation: none\nmodes: {first: {expected_Hz: 210}}\n"
)

# %%
# ``br.diagnose`` runs the workflow's stages in one process, from the folder to the verdict.

verdict = br.diagnose(folder)
verdict

# %%
# The size of the cause, with its standard deviation:

for cause in verdict.said["causes"]:
    for size in cause["parameters"]:
        print(cause["mechanism"], size["name"], f"{size['value']:.5f} +- {size['std']:.5f}")

# %%
# What is read off: the stick frequency of every record.

verdict.plot()
