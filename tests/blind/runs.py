"""Running the workflow as a user would: by its command line, in a folder of its own."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import yaml

ROOT = Path(__file__).resolve().parents[2]
# Error (%) of the analyst's model as one would state it: the mesh is the bench's own, modulus and
# density are known to 0.1 %, each half of which is frequency; with something to spare.
SEARCH = {"fe_bias_percent": {"1B": 0.15, "2B": 0.15}, "fe_offset_percent": {"1B": 0.0, "2B": 0.0}}
DISTURBED = """\
import os, runpy, sys
sys.argv.pop(0)
sys.path.insert(0, os.path.dirname(sys.argv[0]))
{before}
runpy.run_path(sys.argv[0], run_name="__main__")
"""


def environment() -> dict:
    library = str(ROOT / "workflow")
    return {**os.environ, "PYTHONPATH": library, "OMP_NUM_THREADS": "1"}


def make(house: Path, *targets: str, campaign: Path | None = None, jobs: int = 2) -> None:
    """Have Snakemake make `targets` (paths below results/) in `house`; RuntimeError if it fails."""
    house.mkdir(parents=True, exist_ok=True)
    named = (
        ["--config", f"campaigns={campaign}", f"search={json.dumps(SEARCH)}"] if campaign else []
    )
    done = _snakemake(house, f"-j{jobs}", "--quiet", *named, "--", *targets)
    if done.returncode:
        raise RuntimeError(f"snakemake failed for {targets}:\n{done.stdout}\n{done.stderr}")


def _snakemake(house: Path, *options: str) -> subprocess.CompletedProcess:
    command = [
        *(sys.executable, "-m", "snakemake", "--snakefile", str(ROOT / "Snakefile")),
        *("--directory", str(house), *options),
    ]
    return subprocess.run(command, env=environment(), capture_output=True, text=True)


def structures(house: Path) -> Path:
    """Folder of the structure's artifacts in a house: the checkout's own, if they are current."""
    own = Path("results/structures/dovetail-HB")
    targets = [str(own / f"{name}.nc") for name in ("reduced", "parametric")]
    if not (house / own).exists() and (ROOT / own).exists():
        planned = _snakemake(ROOT, "--dry-run", "--", *targets).stdout
        if "Nothing to be done" in planned:
            shutil.copytree(ROOT / own, house / own)
            return house / own
    make(house, *targets)
    return house / own


def diagnose(
    observations: Path, parametric: Path, settings: dict | None = None, before: str = ""
) -> dict:
    """The verdict on observations.nc, by the diagnosis' own script; written beside them.

    `before` is Python that its process runs first, to disturb it.
    """
    folder = observations.parent
    config = yaml.safe_load((ROOT / "config" / "config.yaml").read_text(encoding="utf-8"))
    chosen = {**config["diagnosis"], **SEARCH, **(settings or {})}
    command = [
        *(sys.executable, "-c", DISTURBED.format(before=before)),
        str(ROOT / "workflow" / "scripts" / "diagnosis.py"),
        *("--observations", str(observations), "--parametric", str(parametric)),
        *("--settings", json.dumps(chosen, sort_keys=True)),
        *("--diagnosis", str(folder / "diagnosis.nc"), "--verdict", str(folder / "verdict.json")),
    ]
    done = subprocess.run(command, env=environment(), capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(f"the diagnosis failed on {observations}:\n{done.stderr}")
    return json.loads((folder / "verdict.json").read_text(encoding="utf-8"))
