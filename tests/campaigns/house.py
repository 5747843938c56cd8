"""A small copy of the house in which whole runs can be made, broken and repaired."""

import os
import re
import shutil
import subprocess
import sys
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SMALL = Path(__file__).parent / "small"


@dataclass(frozen=True)
class House:
    """A checkout with its own library, configuration and results."""

    folder: Path

    def run(self, *options: str, check: bool = True) -> subprocess.CompletedProcess:
        done = subprocess.run(
            self.command(*options),
            cwd=self.folder,
            env=self.environment,
            capture_output=True,
            text=True,
        )
        if check and done.returncode:
            pytest.fail(f"snakemake {' '.join(options)} failed:\n{done.stdout}\n{done.stderr}")
        return done

    @staticmethod
    def command(*options: str) -> list[str]:
        return [sys.executable, "-m", "snakemake", "-j2", *options]

    @property
    def environment(self) -> dict:
        # One BLAS thread, as in the workflow's jobs: another number rounds differently.
        return {**os.environ, "OMP_NUM_THREADS": "1"}

    def planned(self, *options: str) -> Counter:
        """The stages (with how many jobs each) that the next run would do: Snakemake's job table.

        Where a stage's batches have rules of their own, what stands before the dot is the stage.
        """
        text = self.run("--dry-run", *options).stdout
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

    def edit(self, path: str, old: str, new: str) -> None:
        file = self.folder / path
        text = file.read_text()
        assert old in text
        file.write_text(text.replace(old, new, 1))


def copy_house(folder: Path) -> House:
    """The workflow with the small campaign as its only one, and with short chains of draws."""
    folder.mkdir(parents=True, exist_ok=True)
    # What is compiled comes along; another process may be writing to it, under passing names.
    passing = shutil.ignore_patterns("*.pyc.*", "*.tmp.*")
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
    # How well a posterior is drawn is tested on the function; here chains were half of a run.
    house.edit("workflow/bladeroot/stiffness/sampler.py", "STEPS, THIN = 1000", "STEPS, THIN = 200")
    return house
