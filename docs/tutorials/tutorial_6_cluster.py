"""
On a cluster
============

One campaign through a scheduler. Where this page was built there was none, so three short scripts stand in for
one: they start each job in the background and tell its state. With a scheduler of your own, its commands take
their place (``profiles/cluster-generic``); with Slurm there is a profile, and nothing to write.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pandas as pd
import yaml
from bladeroot.shipped_files import shipped

# %%
# A campaign: six blows on a simulated mode at 210 Hz.

place = Path(tempfile.mkdtemp())
folder = place / "blows"
folder.mkdir()
chance = np.random.default_rng(3)
rate = 4096
time = np.arange(3 * rate) / rate
rows = []
for k in range(6):
    velocity = 0.02 * np.exp(-2.6 * time) * np.cos(2.0 * np.pi * 210.0 * time + k)
    velocity += 2e-6 * chance.standard_normal(time.size)
    pd.DataFrame({"velocity": velocity}).to_csv(folder / f"blow{k}.csv", index=False)
    rows.append({"record": f"blow{k}", "file": f"blow{k}.csv", "mode": "first", "clamping": f"c{k // 2}",
                 "sampling_Hz": rate, "quantity": "velocity", "unit": "m/s"})  # fmt: skip
pd.DataFrame(rows).to_csv(folder / "records.csv", index=False)
_ = (folder / "campaign.yaml").write_text(
    "title: blows (simulated)\nsimulation: none\nmodes: {first: {expected_Hz: 210}}\n"
)

# %%
# The scheduler: ``submit`` gets cores, MB, minutes and the rule, and last the job's script, and prints the job's
# number; ``status`` says running, success or failed.

scripts = {
    "submit": '(sh "$5" > "$0.$$.log" 2>&1; echo $? > "$0.$$.code") > /dev/null 2>&1 &\necho "$0.$$"',
    "status": 'if [ ! -f "$1.code" ]; then echo running; '
    'elif [ "$(cat "$1.code")" = 0 ]; then echo success; else echo failed; fi',
    "cancel": "true",
}
for name, text in scripts.items():
    (place / name).write_text(f"#!/bin/sh\n{text}\n")
    (place / name).chmod(0o755)

# %%
# The profile is the shipped one with these scripts in place of Slurm's commands:

profile = yaml.safe_load(shipped("profiles/cluster-generic/config.yaml").read_text())
own = {
    "cluster-generic-submit-cmd": f"{place}/submit {{threads}} {{resources.mem_mb}} {{resources.runtime}} {{rule}}",
    "cluster-generic-status-cmd": f"{place}/status",
    "cluster-generic-cancel-cmd": f"{place}/cancel",
    "jobs": 2,
    "latency-wait": 10,
    "seconds-between-status-checks": 1,
}
(place / "profile").mkdir()
_ = (place / "profile" / "config.yaml").write_text(yaml.safe_dump(profile | own))

# %%
# The command is that of a run without a cluster, with the profile:

command = [sys.executable, "-m", "snakemake", "--snakefile", shipped("Snakefile"), "--workflow-profile", "profile",
           "--config", "campaigns=blows"]  # fmt: skip
run = subprocess.run(command, cwd=place, capture_output=True, text=True)
told = [line for line in run.stderr.splitlines() if line.startswith("Job ") or "steps" in line]
print(*(line for line in told if line != "Job stats:"), sep="\n")
run.check_returncode()

# %%
# What went through the scheduler, and what came of it:

print(len(list(place.glob("submit.*.code"))), "jobs submitted")
sorted(path.relative_to(place).as_posix() for path in (place / "results" / "blows").glob("*.*"))
