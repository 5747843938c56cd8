"""A small copy of the house in which whole runs can be made, broken and repaired."""

import json
import os
import re
import shutil
import subprocess
import sys
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from bladeroot.fem.mesh import build_mesh
from bladeroot.fem.prestress import prestress
from bladeroot.rom.external.export import export_matrices
from bladeroot.rom.file import load_structure
from decay_bench import ringing
from forked import forked, snakemake_main

ROOT = Path(__file__).resolve().parents[2]
SMALL = Path(__file__).parent / "small"
# What a campaign's texts may hold: to every page and report it is a text.
HOSTILE = (
    "</script><script>alert(1)</script>--><img src=x onerror=alert(1)> {{ 7 * 71917191 }}"
    " {% include 'secret.txt' %} {record} `a <javascript:alert(1)>`_ |x|\n\n.. raw:: html\n\n"
    "   <script>alert(1)</script>\n\n.. include:: secret.txt\n"
)


@dataclass(frozen=True)
class House:
    """A checkout with its own library, configuration and results; what its first run said."""

    folder: Path
    said: str = ""

    def run(self, *options: str, check: bool = True) -> subprocess.CompletedProcess:
        main, arguments = snakemake_main(), self.command(*options)[3:]
        done = forked(lambda: main(arguments), self.folder, self.environment)
        if check and done.returncode:
            pytest.fail(f"snakemake {' '.join(options)} failed:\n{done.stdout}\n{done.stderr}")
        return done

    @staticmethod
    def command(*options: str) -> list[str]:
        return [sys.executable, "-m", "snakemake", "-j2", *options]

    @property
    def environment(self) -> dict:
        # One BLAS thread, as in the workflow's jobs: another number rounds differently. What is
        # compiled is found by the code's hash, so that all houses and tests share it; bytecode is
        # kept, as for a user.
        compiled = ROOT / "workflow" / "bladeroot" / "__pycache__"
        own = {
            "OMP_NUM_THREADS": "1",
            "NUMBA_CACHE_DIR": compiled,
            "PYTHONPATH": self.folder / "no",
            "PYTHONDONTWRITEBYTECODE": "",
        }
        return os.environ | {name: str(value) for name, value in own.items()}

    def planned(self, *options: str) -> Counter:
        """The stages (with how many jobs each) that the next run would do."""
        return self.jobs(self.run("--dry-run", *options).stdout)

    @staticmethod
    def jobs(text: str) -> Counter:
        """Snakemake's job table of a dry run.

        Where a stage's batches have rules of their own, what stands before the dot is the stage.
        """
        table = re.search(r"^job +count\n[- ]+\n(.*?)^total", text, re.MULTILINE | re.DOTALL)
        if table is None:
            assert "Nothing to be done" in text
            return Counter()
        rows = (line.split() for line in table.group(1).splitlines() if line.strip())
        planned = Counter()
        for rule, count in rows:
            planned[rule.partition(".")[0]] += int(count)
        planned.pop("all", None)
        return planned

    def copied(self, place: Path) -> "House":
        """A copy with its times."""
        left = shutil.ignore_patterns("log")
        return House(shutil.copytree(self.folder, place, symlinks=True, ignore=left))

    def edit(self, path: str, old: str, new: str) -> None:
        file = self.folder / path
        text = file.read_text()
        assert old in text
        file.write_text(text.replace(old, new, 1))


def copy_house(folder: Path) -> House:
    """The workflow with the small campaign as its only one."""
    folder.mkdir(parents=True, exist_ok=True)
    # another process may be writing to caches, under passing names
    passing = shutil.ignore_patterns("compiled", "*.pyc.*", "*.tmp.*")
    for name in ("Snakefile", "workflow", "profiles", "config", "resources"):
        source = ROOT / name
        if source.is_dir():
            shutil.copytree(source, folder / name, ignore=passing)
        else:
            shutil.copy(source, folder / name)
    shutil.copytree(SMALL, folder / "resources" / "campaigns" / "small")
    # Where other campaigns find it: what is made of it in a finished house serves them as well.
    structures = folder / "resources" / "structures"
    shutil.move(folder / "resources" / "campaigns" / "small" / "tiny.yaml", structures)
    shutil.copy(SMALL / "config.yaml", folder / "config" / "config.yaml")
    house = House(folder)
    # another library is installed: a house takes the one that it holds
    (folder / "no" / "bladeroot").mkdir(parents=True)
    (folder / "no" / "bladeroot" / "__init__.py").write_text("raise ImportError('of another')\n")
    return house


def lab(folder: Path, rows: list[str], description: str | None = None) -> Path:
    """A campaign's folder outside the house, of recorded files; without more it has `tiny`."""
    folder.mkdir()
    simulated = (SMALL / "campaign.yaml").read_text()
    text = simulated.replace("bench: bench.yaml\n", "") if description is None else description
    (folder / "campaign.yaml").write_text(text)
    (folder / "records.csv").write_text("\n".join(rows) + "\n")
    return folder


def matrices_lab(folder: Path, structures: str) -> Path:
    """Published stick frequencies, with the small structure's matrices as of another program."""
    folder.mkdir()
    structure = load_structure(SMALL / "tiny.yaml")
    mesh = build_mesh(structure)
    export_matrices(structure, mesh, prestress(structure, mesh), folder, "own", "hb")
    description = (SMALL / "campaign.yaml").read_text().replace("bench: bench.yaml\n", "")
    (folder / "campaign.yaml").write_text(description.replace("[tiny]", structures))
    shutil.copy(ROOT / "resources" / "campaigns" / "thesis" / "stick.csv", folder)
    return folder


def floors_lab(folder: Path) -> Path:
    """Two modes, two sensors, two places of the blow, a spoilt file; no load, no structure.

    Its texts are hostile.
    """
    note = HOSTILE.replace("\n", " ")
    sheet = ["record,file,mode,channel,group,unit,note", f"bad,bad.csv,low,top,blow 1,m/s,{note}"]
    seen = ("top;foot", "top;foot", "top", "top")
    sheet += [f"b{k},b{k}.csv,all,{seen[k]},blow {k % 2 + 1},m/s,{note}" for k in range(4)]
    modes = "modes:\n  low: {expected_Hz: 20}\n  high: {expected_Hz: 55}\n"
    texts = {"title": f"Two floors {HOSTILE}", "notes": HOSTILE}
    lab(folder, sheet, "".join(f"{k}: {json.dumps(text)}\n" for k, text in texts.items()) + modes)
    (folder / "bad.csv").write_text("time_s,top,foot\n0,nan,1\n")
    t = np.arange(0, 12, 1e-3)
    rng = np.random.default_rng(0)
    for k in range(4):
        loss = (0.01, 0.013)[k % 2]
        low, high = (ringing(t, f, np.pi * f * loss, phase=-np.pi / 2) for f in (20, 55))
        velocity = np.array([5e-2 * low + 2e-2 * high, 2e-2 * low - 3e-2 * high])
        table = np.vstack([t, velocity + 1e-5 * rng.standard_normal((2, t.size))]).T
        head = "time_s,top,foot"
        np.savetxt(folder / f"b{k}.csv", table, delimiter=",", header=head, comments="")
    return folder
