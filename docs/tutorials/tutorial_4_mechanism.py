"""
A mechanism of your own
=======================

A cause that the catalogue lacks is one Python file. It joins the ranking, with its own prior and limits.

Here a cable is plugged in half-way through a campaign and shifts every frequency of the records that follow,
as the laboratory's notes tell: a law of the record's time with a known place and an unknown size.
"""

import tempfile
from pathlib import Path

import bladeroot as br
import numpy as np
import yaml
from bladeroot.shipped_files import shipped

# %%
# The file: what it is, its parameter with prior and limits and where they are from, and a hook that returns the
# effect with its derivative, so that every fit is a Newton fit.

own = Path(tempfile.mkdtemp())
_ = (own / "cable.py").write_text('''
"""A cable that was plugged in half-way."""

import numpy as np

from bladeroot.mechanisms.mechanism import Mechanism, Parameter, StickEffect


def plugged(records, values):
    """All frequencies change by one factor from half the campaign's time on."""
    after = (records.time > 0.5 * records.span).astype(float)
    return StickEffect({"ln_f": values[0] * after}, {"ln_f": after[:, None]})


MECHANISM = Mechanism(
    id="cable",
    kind="time",
    sentence="a cable that was plugged in half-way stiffens or loads the specimen",
    parameters=(Parameter("shift", "1", 0.0, 0.002, -0.02, 0.02, "cables of other rigs"),),
    splitter="a record with the cable unplugged",
    stick=plugged,
    over=("time",),
)
''')

# %%
# The campaign (simulated): twenty-four blows, the cable from the thirteenth on.

folder = own / "with-cable"
folder.mkdir()
chance = np.random.default_rng(2)
rate = 4096
time = np.arange(3 * rate) / rate
lines = ["record,file,mode,clamping,time_s,sampling_Hz,quantity,unit"]
for k in range(24):
    frequency = 150.0 * (1.0 + 6e-4 * (k > 11)) * (1.0 + 2e-5 * chance.standard_normal())
    velocity = 0.02 * np.exp(-2.0 * time) * np.cos(2.0 * np.pi * frequency * time)
    velocity += 2e-6 * chance.standard_normal(time.size)
    np.savetxt(folder / f"r{k}.csv", velocity, fmt="%.8f")
    lines.append(f"r{k},r{k}.csv,first,c{k // 4},{600 * k},{rate},velocity,m/s")
(folder / "records.csv").write_text("\n".join(lines) + "\n")
_ = (folder / "campaign.yaml").write_text(
    "title: a cable (simulated)\nsimulation: none\nmodes: {first: {expected_Hz: 150}}\n"
)

# %%
# The settings name the folder of own mechanisms; in the workflow it is ``diagnosis.mechanisms``.

settings = yaml.safe_load(shipped("config/config.yaml").read_text())
settings["diagnosis"]["mechanisms"] = str(own)
verdict = br.diagnose(folder, settings)
verdict

# %%
# The ranking, own mechanism and shipped ones side by side:

verdict.diagnosis["log_evidence"].to_series().sort_values(ascending=False).head()
